"""One SDF file that is being read: its elements, its version and the diagnostics about it.

Reading is as lenient as Gazebo's own parser: what that accepts gives elements and a warning.
Misspelled elements and attributes, which Gazebo ignores nearly silently, are reported here.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.rules import (
    MALFORMED_XML,
    MISSPELLED_ATTRIBUTE,
    MISSPELLED_ELEMENT,
    NOT_UTF_8,
    OVERSIZED_FILE,
    UNREADABLE_DESCRIPTION,
)
from wsgen.diagnostics import Diagnostic, Measured, Rule, Severity
from wsgen.text.files import irregular_kind, read_regular, save_as_utf8, wide_encoding
from wsgen.text.suggestions import did_you_mean, nearest
from wsgen.text.tables import read_markup_names
from wsgen.text.xmltree import Malformed, parse, parse_as_tinyxml

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

    from wsgen.text.xmltree import Element


# All that SDF 1.3 to 1.12 has in an element, of those that wsgen looks into.
KNOWN, ATTRIBUTES = read_markup_names(__file__, "known-names.txt")
ALIKE = 0.82  # as difflib counts; `stiction` is no `friction` (0.75)
ALIKE_INITIAL = 0.75  # with the same first letter, which few misspell; `sise` and `size` are at it
MOST_COMPARED = 2000  # unknown elements of a file; difflib takes its time
SHORT, ALIKE_SHORT = 3, 0.66  # letters; one of three other letters leaves two thirds alike


def check_spelling(source: Source) -> None:
    """Report elements and attributes of a file whose names are nearly those of known ones."""
    waiting = [source.root]
    compared = 0
    while waiting:
        element = waiting.pop()
        known = KNOWN.get(str(element.tag), ())
        written = {child.tag for child in element if isinstance(child.tag, str)}
        _check_attributes(source, element)
        for child in element:
            if child.tag in known:
                waiting.append(child)
            elif known and isinstance(child.tag, str) and "{" not in child.tag:
                compared += 1
                if compared > MOST_COMPARED:
                    return
                # A child that is already there is hardly meant a second time.
                meant = _meant(child.tag, [name for name in known if name not in written])
                meant = meant or _meant(child.tag, known)
                if meant is not None:
                    source.misspelled.setdefault((element, meant), len(source.diagnostics))
                    source.report(
                        MISSPELLED_ELEMENT,
                        f"<{child.tag}> is not an element of <{element.tag}>: Gazebo ignores it.",
                        at=child,
                        hint=f"Did you mean <{meant}>?",
                    )


def _check_attributes(source: Source, element: Element) -> None:
    known = ATTRIBUTES.get(str(element.tag), ())
    for name in map(str, element.attrib):
        meant = None if name in known else _meant(name, set(known).difference(element.attrib))
        if meant is not None:
            source.report(
                MISSPELLED_ATTRIBUTE,
                f"`{name}` is not an attribute of <{element.tag}>: Gazebo ignores it.",
                at=element,
                hint=did_you_mean(meant),
            )


def _meant(name: str, known: Collection[str]) -> str | None:
    """The name that is meant by a misspelled one; None if no known name is similar."""
    near = [other for other in sorted(known) if sorted(other) == sorted(name.lower())]
    if near:
        return near[0]
    alike = [other for other in known if other[0] == name[:1].lower()]
    return nearest(
        name.lower(), known, cutoff=ALIKE_SHORT if len(name) <= SHORT else ALIKE
    ) or nearest(name.lower(), alike, cutoff=ALIKE_INITIAL)


MARK = "\ufeff"  # of the order of bytes
DECLARATION = ("<?xml", "?>")
ENTITY = r"&(?!(?:lt|gt|amp|quot|apos|#\w+);)\w"
COMMENT = ("<!--", "-->")
AHEAD = {"<?": "?>", "<!--": "-->", "<!": ">"}  # what may be before the root element, and its end


DECLARED_ENTITIES = Rule(
    code="WLD046",
    name="declared-entities",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="An SDF file uses XML entities that it declares.",
    why="Gazebo's XML parser knows only the five predefined entities: it fails, or reads the "
    "reference as text where it expects a number.",
    example="""<!DOCTYPE sdf [<!ENTITY radius "0.1">]>
<sdf version="1.9">
  ...
  <radius>&radius;</radius>""",
    instead="""<sdf version="1.9">
  ...
  <radius>0.1</radius>""",
)

NO_SDF_VERSION = Rule(
    code="WLD011",
    name="no-sdf-version",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="`<sdf>` has no version, or one that is not a number.",
    what="Looks for a version of the form `MAJOR.MINOR`, as in 1.9.",
    why="Gazebo refuses the file: the version determines the meaning of the elements, and their "
    "conversion to the current version.",
    example="<sdf>",
    instead='<sdf version="1.6">',
)

UNKNOWN_SDF_VERSION = Rule(
    code="WLD012",
    name="unknown-sdf-version",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="The SDF version is older or newer than the versions that wsgen knows.",
    what="`wsgen` knows SDF 1.3 to 1.12. It reads other versions as the nearest of these.",
    why="Gazebo converts the versions that it knows, and refuses or misreads others: Gazebo "
    "Classic 11 reads up to 1.7, Fortress 1.9, Harmonic 1.11, Ionic and Jetty 1.12.",
    example='<sdf version="2.0">',
    instead='<sdf version="1.9">',
)


class Problem(NamedTuple):
    """Something wrong with the text of a document."""

    rule: Rule
    message: str
    line: int  # 1-based
    hint: str


class Document(NamedTuple):
    """What a text holds."""

    root: Element | None  # None: nothing that can be read
    problems: tuple[Problem, ...] = ()  # errors if there is no root, else warnings


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
    text, problems = _decoded(content) if isinstance(content, bytes) else (content, ())
    if text is None:
        return Document(None, problems)
    text = _without_declaration(text.removeprefix(MARK))
    if "<!ENTITY" in text and (used := re.search(ENTITY, text)):
        problem = Problem(
            DECLARED_ENTITIES,
            "The file uses XML entities that it declares; Gazebo's parser does not know them.",
            text.count("\n", 0, used.start()) + 1,
            "Write the values instead of the entities.",
        )
        return Document(None, (problem,))
    root = parse(text)
    if not isinstance(root, Malformed):
        _forget_namespace(root)
        return Document(root, problems)
    lenient = parse_as_tinyxml(_without_comments(text))
    if lenient is not None:
        problem = Problem(
            MALFORMED_XML,
            f"Not well-formed XML: {root.message}. Gazebo's parser accepts it; others do not.",
            root.line,
            root.hint,
        )
        return Document(lenient, (*problems, problem))
    problem = Problem(
        MALFORMED_XML,
        f"The SDF is not well-formed XML: {root.message}.",
        root.line,
        root.hint,
    )
    return Document(None, (*problems, problem))


def _forget_namespace(root: Element) -> None:
    """Gazebo's parser knows none: an element is called what is written."""
    if root.prefix is None and "}" in str(root.tag):
        for element in root.iter():
            if isinstance(element.tag, str) and element.prefix is None:
                element.tag = element.tag.rpartition("}")[2]


def _decoded(data: bytes) -> tuple[str | None, tuple[Problem, ...]]:
    data = data.rstrip(b"\0")  # where a text of C ends
    wide = wide_encoding(data)
    if wide:
        message = f"The file is encoded in {wide}; Gazebo reads only UTF-8."
        return None, (Problem(NOT_UTF_8, message, 1, save_as_utf8(wide)),)
    if b"\0" in data:
        message = "The file is not a text file: it contains null bytes."
        return None, (Problem(NOT_UTF_8, message, 1, "Give a text file in UTF-8."),)
    try:
        return data.decode("utf-8"), ()
    except UnicodeDecodeError as error:
        problem = Problem(
            NOT_UTF_8,
            "The file is not encoded in UTF-8, but Gazebo reads it as UTF-8.",
            data.count(b"\n", 0, error.start) + 1,
            save_as_utf8("ISO-8859-1"),
        )
    return data.decode("utf-8", "replace"), (problem,)


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
    # Where the diagnostic about a misspelled child stands, by the element and the name meant.
    misspelled: dict[tuple[Element, str], int]

    def report(  # noqa: PLR0913  the fields of a diagnostic
        self,
        rule: Rule,
        message: str,
        *,
        at: Element,
        hint: str,
        severity: Severity | None = None,
        reason: str | None = None,
    ) -> None:
        """Add a diagnostic about an element; the severity is that of the rule if none is given."""
        self.diagnostics.append(
            rule.at(
                self.file,
                line_of(at),
                path_of(at),
                message=message,
                hint=hint,
                severity=severity,
                reason=reason,
            )
        )

    def report_missing(  # noqa: PLR0913  as `report`, and the name of the child
        self,
        rule: Rule,
        message: str,
        *,
        at: Element,
        child: str,
        hint: str,
        severity: Severity | None = None,
    ) -> None:
        """Report that an element has no child of that name.

        Where one is misspelled, that has been reported: its diagnostic then says what its absence
        causes, with the severity of that.
        """
        place = self.misspelled.get((at, child))
        if place is None:
            self.report(rule, message, at=at, hint=hint, severity=severity)
            return
        cause = self.diagnostics[place]
        self.diagnostics[place] = replace(
            cause,
            severity=severity or rule.severity,
            message=f"{cause.message.partition(': ')[0]}: {message[0].lower()}{message[1:]}",
        )


def load(file: Path, diagnostics: list[Diagnostic]) -> Source | None:
    """The document of a file; None if it cannot be read, which is reported.

    The version is not checked yet: see `with_version`.
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
    root, problems = read_document(content)
    severity = Severity.ERROR if root is None else Severity.WARNING
    diagnostics += (
        problem.rule.at(
            file, problem.line, message=problem.message, hint=problem.hint, severity=severity
        )
        for problem in problems
    )
    if root is None:
        return None
    source = Source(file, root, NEWEST, diagnostics, {})
    if root.tag == "sdf":
        check_spelling(source)
    return source


def _read(file: Path) -> bytes | Diagnostic:
    """The content of a file, or why it cannot be read."""
    try:
        kind = irregular_kind(file)
        if kind is None:
            return read_regular(file, SIZE_LIMIT)
    except (OSError, ValueError) as error:
        return UNREADABLE_DESCRIPTION.at(
            file,
            message=f"The SDF file cannot be read: {_reason(error)}.",
            hint="Check that an install(DIRECTORY ...) rule of CMakeLists.txt installs its folder, "
            "then run `wsgen build`.",
        )
    return UNREADABLE_DESCRIPTION.at(
        file,
        message=f"The SDF file cannot be read: it is {kind}.",
        hint="Give the .sdf or .world file itself.",
    )


def _too_large(file: Path | None) -> Diagnostic:
    return OVERSIZED_FILE.at(
        file,
        message=f"The file has more than {SIZE_LIMIT} bytes, the most that wsgen reads.",
        hint="Move repeated parts to a model, and include it.",
    )


def _reason(error: OSError | ValueError) -> str:
    return (error.strerror or str(error)) if isinstance(error, OSError) else str(error)


def with_version(source: Source) -> Source:
    """The same file, read as the SDF version that it states; an invalid one is reported."""
    text = source.root.get("version")
    found = re.fullmatch(r"(\d{1,9})\.(\d{1,9})", (text or "").strip(), re.ASCII)
    hint = f'Write <sdf version="1.6">; wsgen knows {_words(OLDEST)} to {_words(NEWEST)}.'
    if found is None:
        source.report(
            NO_SDF_VERSION,
            "<sdf> has no version." if text is None else f"`{text[:40]}` is not an SDF version.",
            at=source.root,
            hint=hint,
        )
        return source
    version = (int(found[1]), int(found[2]))
    if not OLDEST <= version <= NEWEST:
        source.report(
            UNKNOWN_SDF_VERSION,
            f"SDF {text} is {'newer' if version > NEWEST else 'older'} than the versions that "
            "wsgen knows.",
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
