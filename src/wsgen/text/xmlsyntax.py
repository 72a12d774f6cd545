"""Find the mistake in a file that is not well-formed XML; a parser notices it only further down.

It uses only expat of the standard library, which reads nothing but the bytes it is given. What is
far larger than anything that people write is refused, before a tree is made of it.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple
from xml.parsers import expat

from wsgen.text.suggestions import nearest
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from typing import Any

# Prefix -> what files of ROS and Gazebo declare it to be. Others may be anything.
NAMESPACES = {"gz": "http://gazebosim.org/schema", "xacro": "http://www.ros.org/wiki/xacro"}

ERRORS = expat.errors
ENCODINGS = frozenset({ERRORS.XML_ERROR_UNKNOWN_ENCODING, ERRORS.XML_ERROR_INCORRECT_ENCODING})
DECLARED = lazy_pattern(rb"[^<]*<\?xml[^<>]*?\sencoding\s*=\s*[\"']([^\"']*)")
UNCLOSED = frozenset({ERRORS.XML_ERROR_NO_ELEMENTS, ERRORS.XML_ERROR_UNCLOSED_TOKEN})
LAST_TAG = lazy_pattern(rb"<([\w.:-]+)(?:[^<>\"']|\"[^\"]*\"|'[^']*')*$")  # up to the error
OPEN_VALUE = lazy_pattern(
    rb"<([\w.:-]+)(?:[^<>\"']|\"[^\"]*\"|'[^']*')*?([\w.:-]+)\s*=\s*[\"'][^<]*$"
)
# The closing quote is missing, and the value goes on up to the quote of the next attribute.
LONG_VALUE = lazy_pattern(rb"([\w.:-]+)\s*=\s*([\"'])(?:(?!\2).)*\s[\w.:-]+\s*=\s*\2$", re.DOTALL)
BARE_VALUE = lazy_pattern(rb"([\w.:-]+)\s*=\s*$")
LONGEST_TAG = 2000  # bytes; the patterns take their time

DEEPEST = 256  # elements inside of each other; libxml2 takes as many
MOST_ATTRIBUTES = 1000  # of an element; libxml2 looks each one up from the first
MOST_TAGS = 2_000_000  # opening and closing; the largest public worlds have 2 % of it
# `a=""` and a blank have five bytes: what is shorter has fewer attributes.
LONG_TAG = lazy_pattern(
    rb"<(?=[^<!?/][^<]{%d})(?:[^<>\"']+|\"[^\"<]*\"|'[^'<]*')*" % (5 * MOST_ATTRIBUTES)
)
QUOTED = lazy_pattern(rb"\"[^\"]*\"|'[^']*'")


class Mistake(NamedTuple):
    """Why a file is not well-formed XML."""

    message: str  # without a full stop
    line: int  # 1-based, of what has to be changed
    hint: str


class _TooDeepError(Exception):
    """Stops a parser; it does not leave this module."""


def find_excess(data: bytes, *, with_depth: bool = False) -> Mistake | None:
    """What of a document is larger than anything that people write; None where nothing is.

    It takes a millisecond for a megabyte. It looks at the depth only if it is asked to, because
    that takes longer, and libxml2 limits it.
    """
    if data.count(b"<") > MOST_TAGS:
        return Mistake(f"it has more than {MOST_TAGS:,} tags", 1, "Split the file.")
    for tag in LONG_TAG.finditer(data):
        if QUOTED.sub(b"", tag[0]).count(b"=") > MOST_ATTRIBUTES:
            return too_many_attributes(_line(data, tag.start()))
    # What is deep and well-formed closes as many elements.
    if not with_depth or data.count(b"</") < DEEPEST:
        return None
    mistake, is_deep = _read_with_lines(data, "utf-8")
    return mistake if is_deep else None


def too_many_attributes(line: int) -> Mistake:
    """An element that has more than `MOST_ATTRIBUTES`."""
    return Mistake(
        f"an element has more than {MOST_ATTRIBUTES} attributes", line, "Remove attributes."
    )


def too_deep(line: int) -> Mistake:
    """An element inside of more than `DEEPEST` others."""
    return Mistake(
        f"elements are nested more than {DEEPEST} deep",
        line,
        "Close the elements, or nest fewer of them.",
    )


def read_with(parser: Any, data: bytes) -> None:
    """Have expat read a document.

    Raises:
        ExpatError: it is not well-formed, or declares an encoding that expat cannot read.
    """
    try:
        parser.Parse(data, True)
    except (ValueError, LookupError) as error:  # what Python says of the encoding
        unknown = expat.ExpatError(str(error))
        unknown.code = expat.errors.codes[ERRORS.XML_ERROR_UNKNOWN_ENCODING]
        unknown.lineno, unknown.offset = 1, 0
        raise unknown from None


def find_mistake(data: bytes, encoding: str | None = None) -> Mistake | None:
    """The mistake in a file: where it is, and what to do; None where expat finds none.

    It may also be larger than anything that people write.

    Args:
        data: the file.
        encoding: what it is in; None where the file says it.
    """
    if not data.strip():
        return Mistake("the file is empty", 1, "Write the root element, or remove the file.")
    return find_excess(data) or _read_with_lines(data, encoding)[0]


def _read_with_lines(data: bytes, encoding: str | None) -> tuple[Mistake | None, bool]:
    """The mistake in a document, and whether it is its depth."""
    parser = expat.ParserCreate(encoding)
    opened: list[tuple[str, int]] = []  # elements with their lines, the root first

    def start(tag: str, _: object) -> None:
        opened.append((tag, parser.CurrentLineNumber))
        if len(opened) > DEEPEST:
            raise _TooDeepError

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: opened.pop()
    try:
        read_with(parser, data)
    except expat.ExpatError as error:
        place = min(max(parser.ErrorByteIndex, 0), len(data))
        return _explain(data, place, error, opened), False
    except _TooDeepError:
        return too_deep(opened[-1][1]), True
    finally:
        # They hold the parser, which holds them: only the garbage collector would free them.
        parser.StartElementHandler = parser.EndElementHandler = None
    return None, False


def _explain(
    data: bytes, place: int, error: expat.ExpatError, opened: list[tuple[str, int]]
) -> Mistake:
    what = expat.ErrorString(error.code)
    rest = data[place:]
    found = None
    if what == ERRORS.XML_ERROR_UNCLOSED_TOKEN:
        found = _unfinished(rest, error.lineno)
    if what in UNCLOSED and opened:
        found = found or _unclosed(*opened[-1])
    elif what == ERRORS.XML_ERROR_TAG_MISMATCH:
        found = _mismatch(rest, error.lineno, opened)
    elif what == ERRORS.XML_ERROR_INVALID_TOKEN:
        found = _invalid(data, place)
    elif what == ERRORS.XML_ERROR_MISPLACED_XML_PI:
        found = Mistake(
            "<?xml ...?> is not at the very beginning",
            error.lineno,
            "Remove what is before it, blank lines too.",
        )
    elif what in ENCODINGS:
        declared = DECLARED.match(data)
        found = Mistake(
            f"XML parsers do not read the encoding `{_text(declared[1])[:40]}`"
            if declared
            else "it is not in the encoding that it declares",
            1,
            'Save it as UTF-8, and write encoding="UTF-8" in the first line.',
        )
    elif what == ERRORS.XML_ERROR_JUNK_AFTER_DOC_ELEMENT:
        found = Mistake(
            "the root element ends before this line, and more follows",
            error.lineno,
            "Move the rest into the root element, or remove it.",
        )
    return found or Mistake(
        what,
        error.lineno,
        "Look at this line and the one before it; in a text, & is written &amp; and < is &lt;.",
    )


def _unclosed(tag: str, line: int) -> Mistake:
    return Mistake(f"<{tag}> is not closed", line, f"Add </{tag}> where the element ends.")


def _unfinished(rest: bytes, line: int) -> Mistake | None:
    """A comment or tag that the end of the file cuts off."""
    if rest.startswith(b"<!--"):
        return Mistake("the comment is not closed", line, "Add --> where the comment ends.")
    tag = re.match(rb"</?[\w.:-]+", rest)
    if tag is None:
        return None
    return Mistake(f"`{_text(tag[0])}` has no `>`", line, "Add `>`, or close the quotes.")


def _mismatch(rest: bytes, line: int, opened: list[tuple[str, int]]) -> Mistake:
    match = re.match(rb"(?:</)?([^\s>]*)", rest)
    closing = "" if match is None else _text(match[1])
    tag, opening_line = opened[-1]
    if any(name == closing for name, _ in opened):
        return _unclosed(tag, opening_line)
    if nearest(closing, [tag]) is not None:
        return Mistake(
            f"<{tag}> is closed by </{closing}>",
            line,
            f"Write </{tag}> here, or change <{tag}> on line {opening_line}.",
        )
    return Mistake(
        f"</{closing}> closes no open element; <{tag}> of line {opening_line} is open",
        line,
        f"Remove </{closing}>, or add </{tag}> before it.",
    )


def _invalid(data: bytes, place: int) -> Mistake | None:
    """A byte that cannot be where it is: the quote, `>` or escape before it is missing."""
    before = data[:place]
    comment = before.rfind(b"<!--")
    if comment >= 0 and b"-->" not in before[comment:]:
        line = _line(data, place)
        return Mistake("a comment contains `--`", line, "Write single hyphens in the comment.")
    for character, escaped in ((b"&", "&amp;"), (b"<", "&lt;")):
        if before.endswith(character):
            written = character.decode()
            return Mistake(
                f"`{written}` stands alone",
                _line(data, place),
                f"Write {escaped} for {written} in a text"
                + ("; in a tag, write the name right after it." if written == "<" else "."),
            )
    return _invalid_in_tag(data, place)


def _invalid_in_tag(data: bytes, place: int) -> Mistake | None:
    start = data.rfind(b"<", 0, place)
    tag = data[start:place] if start >= 0 else b""
    if len(tag) > LONGEST_TAG:
        return None
    value = OPEN_VALUE.match(tag) if data[place : place + 1] == b"<" else None
    complete = LAST_TAG.match(tag)
    if complete is None and value is not None:
        return _unquoted(value[2], value[1], _line(data, start + value.start(2)))
    if complete is None:
        return None
    name = complete[1]
    for pattern in (LONG_VALUE, BARE_VALUE):
        attribute = pattern.search(tag)
        if attribute is not None:
            return _unquoted(attribute[1], name, _line(data, start + attribute.start(1)))
    if data[place : place + 1] == b"<":
        line = _line(data, start)
        return Mistake(f"`<{_text(name)}` has no `>`", line, "Add `>` where the tag ends.")
    return None


def _unquoted(attribute: bytes, tag: bytes, line: int) -> Mistake:
    name = _text(attribute)
    return Mistake(
        f"the value of `{name}` in <{_text(tag)}> lacks a quote",
        line,
        f'Write {name}="VALUE", with a straight quote before and after the value.',
    )


def _line(data: bytes, place: int) -> int:
    return data.count(b"\n", 0, place) + 1


def _text(name: bytes) -> str:
    return name.decode("utf-8", "replace")
