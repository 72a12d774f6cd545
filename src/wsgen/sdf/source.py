"""One SDF file that is being read: its document, its version, and what is wrong with it.

The text of an SDF file to elements, as forgiving as Gazebo's own parser is.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.files import irregular_kind, read_regular, save_as_utf8, wide_encoding
from wsgen.sdf.unknown_elements import check_spelling
from wsgen.xmltree import Malformed, parse, parse_as_tinyxml

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.xmltree import Element


MARK = "\ufeff"  # of the order of bytes
DECLARATION = ("<?xml", "?>")
ENTITY = r"&(?!(?:lt|gt|amp|quot|apos|#\w+);)\w"
COMMENT = ("<!--", "-->")
AHEAD = {"<?": "?>", "<!--": "-->", "<!": ">"}  # what may be before the root element, and its end


class Slip(NamedTuple):
    """What is wrong with a document."""

    code: str
    message: str
    line: int  # 1-based
    hint: str


class Document(NamedTuple):
    """What a text holds."""

    root: Element | None  # None: nothing that can be read
    slips: tuple[Slip, ...] = ()  # errors where there is no root, else warnings


def is_sdf(text: str) -> bool:
    """Whether the root element of a text is <sdf>; all else may be a URDF, or nothing."""
    place = 0
    while True:
        while place < len(text) and (text[place].isspace() or text[place] == MARK):
            place += 1
        end = next((end for start, end in AHEAD.items() if text.startswith(start, place)), None)
        if end is None:
            return text.startswith("<sdf", place) and not text[place + 4 : place + 5].isalnum()
        found = text.find(end, place)
        if found < 0:
            return False
        place = found + len(end)


def read_document(content: str | bytes) -> Document:
    """The elements of a text; bytes are read as UTF-8, whatever they declare, as Gazebo does."""
    text, slips = _decoded(content) if isinstance(content, bytes) else (content, ())
    if text is None:
        return Document(None, slips)
    text = _without_declaration(text.removeprefix(MARK))
    if "<!ENTITY" in text and (used := re.search(ENTITY, text)):
        slip = Slip(
            "WLD046",
            "The file declares entities and uses them; Gazebo's parser knows none.",
            text.count("\n", 0, used.start()) + 1,
            "Write the values out.",
        )
        return Document(None, (slip,))
    root = parse(text)
    if not isinstance(root, Malformed):
        _forget_namespace(root)
        return Document(root, slips)
    lenient = parse_as_tinyxml(_without_comments(text))
    if lenient is not None:
        slip = Slip(
            "WLD002",
            f"Not well-formed XML: {root.message}. Gazebo's parser does not mind; others do.",
            root.line,
            "Write &amp; for &, no -- in comments, and declare prefixes with xmlns:PREFIX.",
        )
        return Document(lenient, (*slips, slip))
    is_deep = root.message.startswith("Excessive depth")
    slip = Slip(
        "WLD002",
        "Elements are nested more than 256 deep."
        if is_deep
        else f"The SDF is not well-formed XML: {root.message}.",
        root.line,
        root.hint,
    )
    return Document(None, (*slips, slip))


def _forget_namespace(root: Element) -> None:
    """Gazebo's parser knows none: an element is called what is written."""
    if root.prefix is None and "}" in str(root.tag):
        for element in root.iter():
            if isinstance(element.tag, str) and element.prefix is None:
                element.tag = element.tag.rpartition("}")[2]


def _decoded(data: bytes) -> tuple[str | None, tuple[Slip, ...]]:
    data = data.rstrip(b"\0")  # where a text of C ends
    wide = wide_encoding(data)
    if wide:
        message = f"The file is in {wide}: Gazebo reads UTF-8 alone."
        return None, (Slip("WLD047", message, 1, save_as_utf8(wide)),)
    if b"\0" in data:
        message = "The file is not a text: it has null bytes."
        return None, (Slip("WLD047", message, 1, "Name a text file in UTF-8."),)
    try:
        return data.decode("utf-8"), ()
    except UnicodeDecodeError as error:
        slip = Slip(
            "WLD047",
            "The file is not in UTF-8, which it is read as.",
            data.count(b"\n", 0, error.start) + 1,
            save_as_utf8("ISO-8859-1"),
        )
    return data.decode("utf-8", "replace"), (slip,)


def _without_declaration(text: str) -> str:
    """The text without <?xml …?>, which Gazebo's parser does not look into, nor what is before."""
    start = text.find(DECLARATION[0])
    end = text.find(DECLARATION[1], start)
    if start < 0 or end < 0 or text[:start].strip():
        return text
    return "\n" * text.count("\n", 0, end) + text[end + len(DECLARATION[1]) :]


def _without_comments(text: str) -> str:
    """The text with its line breaks, and nothing else of what is commented out."""
    parts, start = [], 0
    while (begin := text.find(COMMENT[0], start)) >= 0:
        end = text.find(COMMENT[1], begin + len(COMMENT[0]))
        if end < 0:
            break
        parts += [text[start:begin], "\n" * text.count("\n", begin, end)]
        start = end + len(COMMENT[1])
    return "".join((*parts, text[start:]))


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
    return parse_text(content, file, diagnostics)


def parse_text(
    content: str | bytes, file: Path | None, diagnostics: list[Diagnostic]
) -> Source | None:
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
