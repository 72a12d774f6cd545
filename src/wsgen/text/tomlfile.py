"""Read TOML on every Python, and find the lines of keys."""

from __future__ import annotations

import re
import sys
from collections import Counter
from typing import TYPE_CHECKING, Any

from wsgen.text.files import read_regular_text
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path


if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib


SIZE_LIMIT = 2**20  # bytes; what people write by hand is far smaller
# A key of many words, for which tomllib needs the square of their number.
DEEP = lazy_pattern(r"(?m)(?:^|[\[{,])[ \t]*(?:[\w\"'-]+[ \t]*\.[ \t]*){100}")
INTEGERS = range(-(2**63), 2**63)
_WORD = r"""(?:"[^"]*"|'[^']*'|[\w-]+)"""
_DOTTED = rf"{_WORD}(?:\s*\.\s*{_WORD})*"
_HEADER = rf"\s*(\[\[?)\s*({_DOTTED})\s*\]"
_KEY = rf"\s*({_DOTTED})\s*="


def load(file: Path) -> dict[str, Any]:
    """Read the document of a file.

    Raises:
        OSError: the file cannot be read.
        ValueError: it is not TOML, or not UTF-8; the message says where.
    """
    return parse(read_regular_text(file, SIZE_LIMIT))


def parse(text: str) -> dict[str, Any]:
    """Read the document of a text.

    Raises:
        ValueError: it is not TOML; the message says where.
    """
    if DEEP.search(text):
        raise ValueError("Nested too deeply")
    try:
        document: dict[str, Any] = tomllib.loads(text)
    except RecursionError:
        raise ValueError("Nested too deeply") from None
    where = next(_too_large(document), None)
    if where is not None:
        line = find_line(text, where) or 1
        raise ValueError(f"Integer of more than 64 bits (at line {line}, column 1)")
    return document


def _too_large(document: dict[str, Any]) -> Iterator[tuple[str, ...]]:
    """Find the integers that TOML does not have; those of Python have any size, and no float."""
    waiting: list[tuple[tuple[str, ...], Any]] = [((), document)]
    while waiting:
        where, value = waiting.pop()
        if isinstance(value, dict):
            waiting += [((*where, name), inner) for name, inner in value.items()]
        elif isinstance(value, list):
            waiting += [((*where, str(number)), inner) for number, inner in enumerate(value)]
        elif isinstance(value, int) and value not in INTEGERS:
            yield where


def find_line(text: str, where: Sequence[str]) -> int | None:
    """Find the line (from 1) of a key, or of the nearest table around it.

    `where` is the path of keys, with the index of a table in an array as a number in digits. Keys
    of an inline table are on its line. None if nothing of the path is in the text. The parser of
    the standard library does not give the lines of values.
    """
    table: list[str] = []
    arrays: Counter[str] = Counter()
    best, found = 0, None
    for number, line in enumerate(text.splitlines(), start=1):
        header = re.match(_HEADER, line)
        if header is not None:
            table = _within_arrays(_split(header[2]), arrays, is_array=header[1] == "[[")
            path = table
        elif (key := re.match(_KEY, line)) is not None:
            path = table + _split(key[1])
        else:
            continue
        shared = _shared(path, where)
        # One path must contain the other: a sibling of the key is not its place.
        if shared > best and shared in {len(path), len(where)}:
            best, found = shared, number
    return found


def _within_arrays(words: list[str], arrays: Counter[str], *, is_array: bool) -> list[str]:
    """Return the path to a table, with the indices of the arrays around it, counted by `arrays`."""
    path: list[str] = []
    for place, word in enumerate(words, start=1):
        path.append(word)
        name = ".".join(path)
        if is_array and place == len(words):
            arrays[name] += 1
        if arrays[name]:
            path.append(str(arrays[name] - 1))
    return path


def _split(dotted: str) -> list[str]:
    return [word.strip("\"'") for word in re.findall(_WORD, dotted)]


def _shared(first: Sequence[str], second: Sequence[str]) -> int:
    """Count the words that two paths have in common at their start."""
    for index, (one, other) in enumerate(zip(first, second, strict=False)):
        if one != other:
            return index
    return min(len(first), len(second))


_AT = re.compile(r"at line (\d+), column (\d+)")
_BOOLEANS = {
    **dict.fromkeys(("true", "yes", "on"), "true"),
    **dict.fromkeys(("false", "no", "off"), "false"),
}
_NOTHING = frozenset({"none", "null", "nil"})
_SI_UNITS = frozenset({"m", "s", "kg", "N", "Nm", "rad", "m/s", "rad/s", "Hz", "m/s²", "m/s^2"})
_OTHER_UNITS = frozenset(
    {
        *("mm", "cm", "dm", "km", "in", "inch", "ft", "ms", "us", "ns", "min", "h", "g", "%"),
        *("deg", "degree", "degrees", "\N{DEGREE SIGN}", "deg/s", "rpm", "cm/s", "mm/s", "km/h"),
    }
)
_QUOTES = "\u201c\u201d\u201e\u2018\u2019\u00ab"  # of typography


def explain(text: str, error: ValueError) -> str | None:
    """Say what to write instead where a file is not TOML; None where that is not known.

    It knows the spellings of Python, YAML, JSON and C that people write. `text` is what the file
    holds, `error` what `load` raises.
    """
    reason, _, place = str(error).partition(" (at ")
    at, lines = _AT.search(f"at {place}"), text.splitlines()
    if at is None or int(at[1]) > len(lines):
        line, column = "", 0
    else:
        line, column = lines[int(at[1]) - 1], int(at[2]) - 1
    for words, explain_it in _EXPLAINED:
        if words in reason:
            return explain_it(line[:column], line[column:])
    return None


# Each takes what is before the place on its line, and what is behind it.


def _value(_before: str, rest: str) -> str | None:
    found = re.match(r"[^\s,\]}#]+", rest)
    word = found[0] if found else ""
    is_alone = re.match(r"\s*([,\]}#]|$)", rest[len(word) :]) is not None
    lower, number = word.lower(), word.replace(".", "0.")
    text = rest.partition("#")[0].strip() if not is_alone else word
    answers = (
        (is_alone and lower in _BOOLEANS, f"TOML writes {_BOOLEANS.get(lower)}, not {word}."),
        (is_alone and lower in _NOTHING, f"TOML has no {word}: remove the key."),
        (is_alone and lower.lstrip("+-") in {"nan", "inf"}, f"TOML writes {lower}, not {word}."),
        (re.match(r"[+-]?\.\d", word), f"Write a digit before the point: {number}"),
        (rest.startswith("="), "Write one `=`."),
        (rest[:1] in set(_QUOTES), 'Write straight quotes around the text: "..."'),
        (re.match(r"[^\W\d]", word), f"Write quotes around a text: {_quoted(text)}"),
    )
    return next((answer for is_so, answer in answers if is_so), None)


def _quoted(text: str) -> str:
    for quote in ('"', "'"):
        if text.count(quote) == 1:  # the other one is missing
            text = text.strip(quote)
    if not {'"', "\\"} & set(text):
        return f'"{text}"'
    return f"'{text}'" if "'" not in text else f"'''{text}'''"


def _key(before: str, rest: str) -> str | None:
    if rest.lstrip().startswith(":"):
        line = re.sub(r"\s*:\s*", " = ", (before + rest).strip())
        return f"TOML has `=` between a key and its value: {line}"
    return "Write KEY = VALUE; a key with blanks needs quotes." if rest else None


def _table(before: str, _rest: str) -> str | None:
    name = before.strip()
    return f"Close the name of the table: {name}{']]' if name.startswith('[[') else ']'}"


def _part(before: str, _rest: str) -> str | None:
    if before.count("{") > before.count("}"):
        return "Write a table in braces on one line, without a comma at its end."
    return None


def _end(before: str, rest: str) -> str | None:
    before, rest = before.rstrip(), rest.strip()
    found = re.search(r"(?<![\w.])[+-]?[\d.]+$", before)  # not that of 0xff
    number = found[0] if found else ""
    fraction = re.match(r"[.,](\d*)", rest)
    unit = rest.partition("#")[0].strip()
    whole = f"{number}.{(fraction and fraction[1]) or '0'}"
    answers = (
        (number and fraction, f"Write the number as {whole}"),
        (rest.startswith(("//", "/*")), "A comment begins with `#`."),
        (rest.startswith((";", ",")), f"Remove the `{rest[:1]}`."),
        (number == "0" and re.match(r"\d", rest), "Remove the zero before the number."),
        (number and unit in _SI_UNITS, f"Write the number without `{unit}`: units are SI."),
        (number and unit in _OTHER_UNITS, f"Write the number in an SI unit, without `{unit}`."),
        (before.endswith(("'", '"')), "Write the other kind of quotes around a text with quotes."),
    )
    return next((answer for is_so, answer in answers if is_so), None)


def _twice(before: str, rest: str) -> str | None:
    line = (before + rest).strip()
    if line.startswith("["):
        name = line.partition("#")[0].strip(" []")
        return f"`{name}` is defined twice: write [[{name}]] for each of several, or join them."
    return "The key is defined twice in its table: remove one of the two."


def _backslash(_before: str, _rest: str) -> str:
    return "Write a text with backslashes between single quotes."


_EXPLAINED: tuple[tuple[str, Callable[[str, str], str | None]], ...] = (
    ("64 bits", lambda _before, _rest: "Write it with a point, or an exponent: 1e20"),
    ("Nested too deeply", lambda _before, _rest: "Write fewer levels of lists and tables."),
    ("Invalid value", _value),
    ("Expected '=' after a key", _key),
    ("declaration", _table),
    ("initial character for a key", _part),
    ("end of document after a statement", _end),
    ("Cannot declare", _twice),
    ("overwrite a value", _twice),
    *((words, _backslash) for words in ("Unescaped", "Invalid hex value", "Escaped character")),
    ("Illegal character", lambda _before, _rest: "Close the text: its last quote is missing."),
    ("Unterminated string", lambda _before, _rest: "Close the text: its last quote is missing."),
    ("Unclosed array", lambda _before, _rest: "Close the list: its last `]` is missing."),
    ("Unclosed inline table", lambda _before, _rest: "Close the table: its last `}` is missing."),
)
