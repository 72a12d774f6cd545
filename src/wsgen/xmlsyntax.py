"""Find the mistake in a file that is not well-formed XML; a parser notices it only further down.

It uses only expat of the standard library, which reads nothing but the bytes it is given.
"""

from __future__ import annotations

import re
from xml.parsers import expat

from wsgen.suggestions import nearest
from wsgen.values import NamedTuple, lazy_pattern

ERRORS = expat.errors
UNCLOSED = frozenset({ERRORS.XML_ERROR_NO_ELEMENTS, ERRORS.XML_ERROR_UNCLOSED_TOKEN})
LAST_TAG = lazy_pattern(rb"<([\w.:-]+)(?:[^<>\"']|\"[^\"]*\"|'[^']*')*$")  # up to the error
OPEN_VALUE = lazy_pattern(
    rb"<([\w.:-]+)(?:[^<>\"']|\"[^\"]*\"|'[^']*')*?([\w.:-]+)\s*=\s*[\"'][^<]*$"
)
# The closing quote is missing, and the value goes on up to the quote of the next attribute.
LONG_VALUE = lazy_pattern(rb"([\w.:-]+)\s*=\s*([\"'])(?:(?!\2).)*\s[\w.:-]+\s*=\s*\2$", re.DOTALL)
BARE_VALUE = lazy_pattern(rb"([\w.:-]+)\s*=\s*$")
LONGEST_TAG = 2000  # bytes; the patterns take their time


class Mistake(NamedTuple):
    """Why a file is not well-formed XML."""

    message: str  # without a full stop
    line: int  # 1-based, of what has to be changed
    hint: str


def find_mistake(data: bytes, encoding: str | None = None) -> Mistake | None:
    """The mistake in a file: where it is, and what to do; None where expat finds none.

    Args:
        data: the file.
        encoding: what it is in; None where the file says it.
    """
    if not data.strip():
        return Mistake("the file is empty", 1, "Write the root element, or remove the file.")
    parser = expat.ParserCreate(encoding)
    opened: list[tuple[str, int]] = []  # elements with their lines, the root first
    parser.StartElementHandler = lambda tag, _: opened.append((tag, parser.CurrentLineNumber))
    parser.EndElementHandler = lambda _: opened.pop()
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        place = min(max(parser.ErrorByteIndex, 0), len(data))
        return _explain(data, place, error, opened)
    except ValueError:  # an encoding that is not known
        return None
    return None


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
