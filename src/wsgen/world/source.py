"""One SDF file that is being read: its document, its version, and what is wrong with it."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.files import irregular_kind, read_regular
from wsgen.world.document import read_document
from wsgen.world.spelling import check_spelling

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.xmltree import Element

SIZE_LIMIT = 32 * 2**20  # bytes; the largest public worlds have 1 % of it

Version = tuple[int, int]

OLDEST: Version = (1, 3)  # with <pose>; before it there was <origin>, and another root element
NEWEST: Version = (1, 12)  # of Gazebo Jetty
MODEL_FRAME_AXES: Version = (1, 4)  # until here, the axis of a joint is seen from the model
POSE_FRAMES: Version = (1, 7)  # from here on, a pose can be relative to any frame


class Source(NamedTuple):
    """An SDF document; those that include each other share one list of diagnostics."""

    file: Path | None  # None: a text that comes from no file
    root: Element
    version: Version
    diagnostics: list[Diagnostic]
    # Where the diagnostic about a misspelt child stands, by the element and the name that is meant.
    misspelt: dict[tuple[Element, str], int]

    def error(self, code: str, message: str, *, at: Element, hint: str) -> None:
        """Gazebo refuses this, or makes another world of it."""
        self._report(code, Severity.ERROR, message, at, hint)

    def warning(self, code: str, message: str, *, at: Element, hint: str) -> None:
        """It works, and surely is not what was meant; or wsgen leaves it out."""
        self._report(code, Severity.WARNING, message, at, hint)

    def missing(self, code: str, message: str, *, at: Element, name: str, hint: str) -> None:
        """An error: the element has no child of that name.

        Where one is misspelt, that has been reported, and becomes the error.
        """
        if not self._blame_misspelt(at, name, Severity.ERROR, message):
            self.error(code, message, at=at, hint=hint)

    def lacking(self, code: str, message: str, *, at: Element, name: str, hint: str) -> None:
        """A warning: the element has no child of that name, and Gazebo takes a default.

        Where one is misspelt, the warning about that says so.
        """
        if not self._blame_misspelt(at, name, Severity.WARNING, message):
            self.warning(code, message, at=at, hint=hint)

    def _blame_misspelt(self, at: Element, name: str, severity: Severity, message: str) -> bool:
        """Say of what is misspelt what its absence causes; False where nothing is."""
        place = self.misspelt.get((at, name))
        if place is None:
            return False
        cause = self.diagnostics[place]
        self.diagnostics[place] = replace(
            cause,
            severity=severity,
            message=f"{cause.message.partition(': ')[0]}: {message[0].lower()}{message[1:]}",
        )
        return True

    def info(self, code: str, message: str, *, at: Element, hint: str) -> None:
        """Nothing is wrong with it; a person may want to know."""
        self._report(code, Severity.INFO, message, at, hint)

    def _report(
        self, code: str, severity: Severity, message: str, element: Element, hint: str
    ) -> None:
        self.diagnostics.append(
            Diagnostic(
                code=code,
                severity=severity,
                message=message,
                file=self.file,
                line=line_of(element),
                element=path_of(element),
                hint=hint,
            )
        )


def load(file: Path, diagnostics: list[Diagnostic]) -> Source | None:
    """The document of a file; None where it cannot be read, which is reported.

    The version is not looked at yet: see `with_version`.
    """
    content = _read(file)
    if isinstance(content, Diagnostic):
        diagnostics.append(content)
        return None
    return parse(content, file, diagnostics)


def parse(content: str | bytes, file: Path | None, diagnostics: list[Diagnostic]) -> Source | None:
    """The document of a text, and the file that it came from; like `load` otherwise."""
    if len(content) > SIZE_LIMIT:
        diagnostics.append(_too_large(file))
        return None
    root, slips = read_document(content)
    diagnostics += (
        Diagnostic(
            code=slip.code,
            severity=Severity.ERROR if root is None else Severity.WARNING,
            message=slip.message,
            file=file,
            line=slip.line,
            hint=slip.hint,
        )
        for slip in slips
    )
    if root is None:
        return None
    source = Source(file, root, NEWEST, diagnostics, {})
    if root.tag == "sdf":
        check_spelling(source)
    return source


def _read(file: Path) -> bytes | Diagnostic:
    """What is in a file, or why it cannot be had."""
    unreadable = Diagnostic(
        code="WLD001",
        severity=Severity.ERROR,
        message="The world file cannot be read: it is not a regular file.",
        file=file,
        hint="Name the .sdf or .world file itself.",
    )
    try:
        kind = irregular_kind(file)
        if kind is not None:
            return replace(unreadable, message=f"The world file cannot be read: it is {kind}.")
        content = read_regular(file, SIZE_LIMIT)
    except (OSError, ValueError) as error:
        return replace(
            unreadable,
            message=f"The world file cannot be read: {_reason(error)}.",
            hint="Is its folder in an install(DIRECTORY ...) rule of CMakeLists.txt? "
            "Then build again with `wsgen build`.",
        )
    return content


def _too_large(file: Path | None) -> Diagnostic:
    return Diagnostic(
        code="WLD010",
        severity=Severity.ERROR,
        message=f"The file has more than {SIZE_LIMIT} bytes; wsgen reads up to that.",
        file=file,
        hint="Put what is repeated into a model, and include it.",
    )


def _reason(error: OSError | ValueError) -> str:
    return (error.strerror or str(error)) if isinstance(error, OSError) else str(error)


def with_version(source: Source) -> Source:
    """The same file, read as the version of SDF that it says; one that is none is reported."""
    text = source.root.get("version")
    found = re.fullmatch(r"(\d{1,9})\.(\d{1,9})", (text or "").strip(), re.ASCII)
    hint = f'Write <sdf version="1.6">; wsgen knows {_words(OLDEST)} to {_words(NEWEST)}.'
    if found is None:
        source.error(
            "WLD011",
            "<sdf> has no version." if text is None else f"`{text[:40]}` is no version of SDF.",
            at=source.root,
            hint=hint,
        )
        return source
    version = (int(found[1]), int(found[2]))
    if not OLDEST <= version <= NEWEST:
        source.warning(
            "WLD012",
            f"SDF {text} is {'newer' if version > NEWEST else 'older'} than what wsgen knows.",
            at=source.root,
            hint=hint,
        )
    return source._replace(version=min(max(version, OLDEST), NEWEST))


def _words(version: Version) -> str:
    return f"{version[0]}.{version[1]}"


def line_of(element: Element) -> int | None:
    """The line of an element in its file, 1-based."""
    # lxml's stubs give it the type of a descriptor.
    line = element.sourceline
    return line if isinstance(line, int) else None


def path_of(element: Element) -> str:
    """Where an element is, as in XPath, with names where there are any: never a count."""
    parts = []
    place: Element | None = element
    while place is not None:
        name = place.get("name")
        parts.append(str(place.tag) if name is None else f"{place.tag}[@name='{name}']")
        place = place.getparent()
    return "/" + "/".join(reversed(parts))
