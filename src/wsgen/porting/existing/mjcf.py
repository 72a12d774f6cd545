"""MJCF, MuJoCo's format of robots: MuJoCo itself reads it, in a child, and a URDF is made of that.

The XML is read here, too: for the lines of what is left out, and to see which files it includes
before anything opens them.
"""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.sdf.source import line_of
from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died, Limits
from wsgen.model.robot import Robot  # noqa: TC001  decoded by type hints
from wsgen.porting.existing.description import Reference  # noqa: TC001  decoded by type hints
from wsgen.porting.existing.urdf_text import describe
from wsgen.porting.ported import Unported
from wsgen.text.files import read_regular_text, real_path
from wsgen.text.markup import without_comments
from wsgen.text.xmltree import Malformed, parse, parse_as_tinyxml

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.porting.existing.description import Description
    from wsgen.text.xmltree import Element


TASK = "wsgen.porting.existing.mjcf_compiled:compile_model"
LIMITS = Limits(seconds=60.0)  # convex hulls of meshes take most of it
SIZE_LIMIT = 2**25  # bytes of one XML file; points of a mesh may be in it
MOST_FILES = 500
MARKS = (".git", "package.xml", "pyproject.toml", "setup.py")  # of the folder of a project
MOST_ABOVE = 6  # folders in which these are looked for

_BAD_FORMAT = re.compile(r"bad format in attribute '(\w+)'\W+Element '(\w+)'")
_NUMBER = re.compile(r"[-+.\deE]+|[-+]?(?:inf|nan)", re.IGNORECASE)


class Said(NamedTuple):
    """Something that a URDF cannot say, as the child knows it."""

    tag: str  # of the element in the MJCF, or of the one around it; "": any
    name: str
    line: int  # in its file, 1-based; 0: unknown
    what: str
    advice: str


class Compiled(NamedTuple):
    """The answer of the child."""

    robot: Robot
    said: tuple[Said, ...]
    crosses: tuple[str, ...]  # the links between the joints of a body
    reference: Reference


def read_mjcf(file: Path, *, folder: Path | None = None) -> Description:
    """The robot of an MJCF as a URDF.

    The robot is the tree of bodies with the most joints. What is fixed to the world has a link
    `world`; joint positions are those of MuJoCo, also where a joint has a `ref`.

    Args:
        file: The MJCF.
        folder: All that it includes must be in there; None: the project around the file.

    Raises:
        NotFoundError: MuJoCo is not installed, or a file that is included is not there.
        NotReadableError: It is not XML, or MuJoCo refuses it.
        RequestError: It is another kind of file, or includes itself or one outside of the folder.
    """
    file = file.absolute()
    sources = _read_sources(file, folder or _project_of(file))
    if find_spec("mujoco") is None:
        raise NotFoundError(
            f"MuJoCo, which reads {file.name}, is not installed.",
            hint="Run: pip install 'wsgen[mujoco]'",
        )
    with parent.make_scratch() as scratch:
        outcome = parent.run(TASK, str(file), str(scratch), limits=LIMITS)
        if isinstance(outcome, Died):
            raise NotReadableError(
                f"MuJoCo {outcome.reason} while it read {file}.",
                hint=outcome.hint("Simplify its meshes, or open it in MuJoCo to see why."),
            )
        if isinstance(outcome.value, str):
            reason = " ".join(outcome.value.split()).removeprefix("Error: ").removesuffix(".")
            raise NotReadableError(
                f"MuJoCo makes no robot of {file}: {reason}.{_place_of(reason, sources)}",
                hint="Correct it, and check it with: python3 -m mujoco.viewer --mjcf=FILE",
            )
        compiled = decode(outcome.value, Compiled)
        notes = [_note(said, file, sources) for said in compiled.said]
        described = describe(
            compiled.robot, file=file, notes=notes, scratch=scratch, crosses=compiled.crosses
        )
        return described._replace(reference=compiled.reference)


def _project_of(file: Path) -> Path:
    around = list(file.parents)[:MOST_ABOVE]
    marked = (one for one in around if any((one / mark).exists() for mark in MARKS))
    return next(marked, around[min(1, len(around) - 1)])


def _read_sources(file: Path, folder: Path) -> dict[Path, Element]:
    """The MJCF and all files that it includes, each once, by their real paths."""
    top = Path(real_path(folder))
    sources: dict[Path, Element] = {}
    waiting: list[tuple[Path, str, tuple[Path, ...]]] = [(Path(real_path(file)), f"{file}", ())]
    while waiting:
        path, what, trail = waiting.pop()
        if path in trail:
            raise RequestError(
                f"{what} includes itself, through other files or directly.",
                hint="Remove one of the includes of this circle.",
            )
        if path in sources:
            continue
        if len(sources) == MOST_FILES:
            raise RequestError(
                f"{file} includes more than {MOST_FILES} files.",
                hint="Save it as one file in MuJoCo (mj_saveLastXML), and give that.",
            )
        root = sources[path] = _read(path, what)
        if path == Path(real_path(file)) and root.tag != "mujoco":
            raise RequestError(
                f"{file} is not an MJCF: its root element is <{root.tag}>.",
                hint="Give an MJCF, whose root element is <mujoco>.",
            )
        for element, written in _included(root):
            place = f"{path}:{element.sourceline}"
            beside = (Path(file.parent, written), Path(path.parent, written))
            found = Path(real_path(next((one for one in beside if one.is_file()), beside[-1])))
            if not found.is_relative_to(top):
                raise RequestError(
                    f"{place}: `{written}` is outside of {top}.",
                    hint="Copy the file into this folder, and include it from there.",
                )
            waiting.append((found, f"{place}: `{written}`", (*trail, path)))
    return sources


def _included(root: Element) -> Iterator[tuple[Element, str]]:
    for element in root.iter("include", "model"):
        written = element.get("file") or ""
        # An asset <model> may be of another format, which MuJoCo reads by itself.
        if written and (element.tag == "include" or written.endswith(".xml")):
            yield element, written


def _read(path: Path, what: str) -> Element:
    try:
        text = read_regular_text(path, SIZE_LIMIT, errors="replace")
    except FileNotFoundError:
        raise NotFoundError(
            f"{what} is not there.", hint="Check its spelling; give its folder as well."
        ) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise NotReadableError(
            f"{what} cannot be read: {reason}.", hint="Give a regular file in UTF-8."
        ) from None
    root = parse(text)
    if isinstance(root, Malformed):
        lenient = parse_as_tinyxml(without_comments(text))
        if lenient is None:
            raise NotReadableError(
                f"{path}:{root.line}: not well-formed XML: {root.message}.", hint=root.hint
            )
        return lenient
    return root


def _place_of(reason: str, sources: Mapping[Path, Element]) -> str:
    """Where an attribute is not numbers, for which MuJoCo often has no line; "" if not found."""
    named = _BAD_FORMAT.search(reason)
    for path, root in sources.items() if named else ():
        for element in root.iter(named[2] if named else ""):
            written = element.get(named[1] if named else "") or ""
            if not all(_NUMBER.fullmatch(word) for word in written.split()):
                return f" See {path}:{line_of(element) or 1}: `{written[:60]}`."
    return ""


def _note(said: Said, file: Path, sources: Mapping[Path, Element]) -> Unported:
    """With the place of the element that is meant: by its name, else by its line."""
    best = (0, file, said.line or 1)
    for path, root in sources.items():
        for element in root.iter():
            above = element.getparent()
            if above is None or said.tag not in {element.tag, above.tag, ""}:
                continue
            line = line_of(element) or 1
            is_named, is_there = element.get("name") == said.name != "", line == said.line
            best = max(best, (2 * is_named + is_there, path, line), key=lambda one: one[0])
    return Unported(file=best[1], line=best[2], what=said.what, advice=said.advice)
