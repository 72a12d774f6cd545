"""PackageSpec and Template -> the texts of the package's files. Writes nothing.

Paths of the files of a package: written with names in them, and fit for every disk.

An exception from within a template -> where it is wrong, and what to do about it.
"""

from __future__ import annotations

import re
import unicodedata
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen import __version__
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.package import WINDOWS_DEVICES
from wsgen.templating.environment import Environment, syntax_place, words_for
from wsgen.templating.manifest import MANIFEST, refuse
from wsgen.templating.sources import ENDING, SourceError, find_source

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from types import TracebackType

    from wsgen.model.package import PackageSpec
    from wsgen.templating.manifest import Template


MAXIMUM_BYTES = 255  # of one name, on most disks
MAXIMUM_PATH = 400  # characters: below the folders of a workspace it becomes longer
# Folders that colcon makes, and that of git: what lies there is not the package's.
RESERVED_FOLDERS = frozenset({"build", "install", "log", ".git"})
# colcon would pass the package over.
RESERVED_FILES = frozenset({"colcon_ignore", "ament_ignore", "catkin_ignore"})

_NAME = re.compile(r"\{\{ *([a-z_.0-9]+) *\}\}")
_WINDOWS_CANNOT = frozenset('<>:"|?*\\')


class PathError(Exception):
    """A path that no package can have; the message is a sentence about it."""


def fill_in(pattern: str, spec: PackageSpec) -> str:
    """The path that a pattern stands for: `{{ package.name }}` and the like become names.

    Raises:
        PathError: it names something else, or is no path that a package can have.
    """
    names = _names(spec)

    def name(match: re.Match[str]) -> str:
        try:
            return names[match[1]]
        except KeyError:
            raise PathError(
                f"{match[0]} is no name that a path may have in it: {', '.join(names)}"
            ) from None

    path = _NAME.sub(name, pattern)
    if "{" in path or "}" in path:
        raise PathError("a path has no logic in it, only names such as {{ package.name }}")
    problem = check_path(path)
    if problem is not None:
        raise PathError(problem)
    return path


def check_path(path: str) -> str | None:
    """What keeps a path from being one in a package; None if nothing does."""
    return next(_problems(path), None)


def _problems(path: str) -> Iterator[str]:
    parts = path.split("/")
    if not {"", ".", ".."}.isdisjoint(parts):
        yield "it is no path below the package's folder, written with single slashes"
    if not path.isprintable():
        yield "it has a character in it that does not print"
    elif len(path) > MAXIMUM_PATH or any(len(part.encode()) > MAXIMUM_BYTES for part in parts):
        yield "it is too long"
    for part in parts:
        if not _WINDOWS_CANNOT.isdisjoint(part) or part != part.strip(" ").rstrip("."):
            yield f"{part!r} is no name on Windows, where nobody could check the package out"
        if part.split(".")[0].lower() in WINDOWS_DEVICES:
            yield f"{part!r} is a device on Windows, where nobody could check the package out"
    if parts[0].lower() in RESERVED_FOLDERS:
        yield f"{parts[0]!r} is a folder that colcon or git makes"
    if parts[-1].lower() in RESERVED_FILES:
        yield f"with a file {parts[-1]!r} colcon passes the package over"


def find_collision(paths: Iterable[str]) -> tuple[str, str] | None:
    """Two paths that are one on some disks, or of which one needs the other to be a folder."""
    known: dict[str, str] = {}
    folders: dict[str, str] = {}
    for path in paths:
        # macOS and Windows do not tell capitals apart, macOS not how accents are written.
        same = unicodedata.normalize("NFC", path).casefold()
        if same in known:
            return known[same], path
        known[same] = path
        while "/" in same:
            same = same.rpartition("/")[0]
            folders.setdefault(same, path)
    for same, path in known.items():
        if same in folders:
            return path, folders[same]
    return None


def _names(spec: PackageSpec) -> dict[str, str]:
    """What may stand in a path: names, and answers that are texts."""
    return {
        "package.name": spec.name,
        "package.target.distro": spec.target.distro,
        "package.target.simulator": spec.target.simulator,
        **{
            f"package.answers.{name}": value
            for name, value in spec.answers.items()
            if isinstance(value, str)
        },
    }


def explain(error: Exception, *, path: str, source: str, folder: Path) -> Diagnostic:
    """What went wrong while the file at `path` in the package was rendered from `source`."""
    file, line = _find_place(error)
    if file is None:
        try:
            file = find_source(source, folder)
        except SourceError:  # it is what is missing
            file = folder
    message, hint = words_for(error)
    return Diagnostic(
        code="TPL004",
        severity=Severity.ERROR,
        message=message,
        file=file,
        line=line,
        element=path,
        hint=hint,
    )


def _find_place(error: Exception) -> tuple[Path | None, int | None]:
    """File and line of the innermost template that the exception passed through."""
    place: tuple[Path | None, int | None] = syntax_place(error)
    step: TracebackType | None = error.__traceback__
    while step is not None:
        name = step.tb_frame.f_code.co_filename
        # Jinja2 puts the lines of the sources in the place of those of its own code.
        if name.endswith(ENDING):
            place = (Path(name), step.tb_lineno)
        step = step.tb_next
    return place


# Path in the package, with slashes -> text of the file.
RenderedTree = dict[str, str]

MAXIMUM_FILE = 2**20  # characters: a loop that writes for ever is no template
MAXIMUM_TREE = 2**23
# Without them it is no package, or none that `wsgen update` could bring changes to.
NEEDED = ("package.xml", "wsgen.toml")
# Folders that the build reads and nobody after it.
ONLY_FOR_BUILDING = {"cmake", "hooks", "test"}


class TooLargeError(Exception):
    """More text came out of a template than a package can use."""


def render_package(spec: PackageSpec, template: Template) -> RenderedTree:
    """All files of a package, sorted by path; each text ends with a line end.

    This runs the template here and now: one of the user's is for `render_apart`.

    Raises:
        BrokenTemplateError: the template does not give files that can be written.
    """
    tree, faults = render_tree(spec, template)
    refuse(faults, template.folder)
    return tree


def render_tree(
    spec: PackageSpec, template: Template
) -> tuple[RenderedTree, tuple[Diagnostic, ...]]:
    """The files as far as they can be rendered, and what is wrong with the template."""
    sources, faults = _place(spec, template)
    if faults:
        return {}, tuple(faults)
    environment = Environment(template.folder)
    context = {
        "package": spec,
        "variables": template.variables,
        "files": sorted(sources),
        "folders": installed_folders(sources),
        "wsgen_version": __version__,
    }
    tree: RenderedTree = {}
    for path in sorted(sources):
        error = _render_into(tree, path, environment, sources[path], context)
        if error is not None:
            faults.append(explain(error, path=path, source=sources[path], folder=template.folder))
        if isinstance(error, TimeoutError):  # there is no time for the others
            break
    environment.keep_compiled()
    return tree, tuple(faults)


def installed_folders(files: Iterable[str]) -> list[str]:
    """The folders of a package that its users need, sorted."""
    folders = {path.partition("/")[0] for path in files if "/" in path}
    return sorted(folders - ONLY_FOR_BUILDING)


def _render_into(
    tree: RenderedTree,
    path: str,
    environment: Environment,
    source: str,
    context: Mapping[str, object],
) -> Exception | None:
    """Add a file to the tree, or say what keeps its source from being rendered."""
    left = min(MAXIMUM_FILE, MAXIMUM_TREE - sum(map(len, tree.values())))
    pieces = []
    try:
        for piece in environment.get_template(source).generate(context):
            left -= len(piece)
            if left < 0:
                return TooLargeError(
                    f"what is rendered is too large: {MAXIMUM_FILE} characters a file and"
                    f" {MAXIMUM_TREE} a package are the limits"
                )
            pieces.append(piece)
    except Exception as error:  # noqa: BLE001  expressions in templates raise anything
        return error
    text = "".join(pieces)
    tree[path] = text if text.endswith("\n") or not text else f"{text}\n"
    return None


def _place(spec: PackageSpec, template: Template) -> tuple[dict[str, str], list[Diagnostic]]:
    """Path in the package -> name of the source; and paths and sources that cannot be."""
    placed: dict[str, str] = {}
    faults = []
    for pattern, source in template.sources(spec.target, spec.answers).items():
        path = _place_one(pattern, source, spec, template)
        if isinstance(path, Diagnostic):
            faults.append(path)
        else:
            placed[path] = source
    collision = find_collision(placed)
    if collision is not None:
        one, other = collision
        faults.append(
            _misplaced(
                template, f"The paths {one!r} and {other!r} exclude each other on some disk."
            )
        )
    for path in NEEDED:
        if path not in placed and not faults:
            faults.append(_misplaced(template, f"The template makes no {path!r}."))
    return placed, faults


def _place_one(
    pattern: str, source: str, spec: PackageSpec, template: Template
) -> str | Diagnostic:
    try:
        path = fill_in(pattern, spec)
        find_source(source, template.folder)
    except PathError as error:
        return _misplaced(template, f"The path {pattern!r} cannot be in a package: {error}.")
    except SourceError as error:
        return _missing(template, pattern, f"The source {source!r} {error}.")
    return path


def _misplaced(template: Template, message: str) -> Diagnostic:
    return Diagnostic(
        code="TPL005",
        severity=Severity.ERROR,
        message=message,
        file=template.folder / MANIFEST,
        element="files",
        hint='Change [files]; `extends = "base"` brings what every package has.',
    )


def _missing(template: Template, pattern: str, message: str) -> Diagnostic:
    return Diagnostic(
        code="TPL003",
        severity=Severity.ERROR,
        message=message,
        file=template.folder / MANIFEST,
        element=f"files.{pattern}",
        hint=f"Write that file below {template.folder}, or change [files].",
    )
