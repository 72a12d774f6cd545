"""Texts that every reader takes: UTF-8 without characters that cannot be shown."""

from __future__ import annotations

import re
from functools import cache


@cache
def _unprintable() -> dict[int, str]:
    """What is not printable, or turns the direction in which the text after it is read."""
    return {
        **{code: chr(0x2400 + code) for code in range(0x20) if chr(code) not in "\t\n"},
        0x7F: "\u2421",
        **dict.fromkeys((*range(0x80, 0xA0), *range(0xD800, 0xE000)), "\ufffd"),
        **dict.fromkeys((0x061C, 0x200E, 0x200F, *range(0x2028, 0x202F)), "\ufffd"),
        **dict.fromkeys(range(0x2066, 0x206A), "\ufffd"),
        **dict.fromkeys(range(0xFDD0, 0xFDF0), "\ufffd"),
        **dict.fromkeys(
            (plane + end for plane in range(0, 0x110000, 0x10000) for end in (0xFFFE, 0xFFFF)),
            "\ufffd",
        ),
    }


def clean(text: str) -> str:
    """A text that can be written as UTF-8 and shown: other characters are replaced by signs.

    Names of files may have bytes that are no characters, and launch files give any text.
    """
    return text if text.isprintable() else text.translate(_unprintable())


LARGEST = 0xFFFF  # that has one escape in JSON

# What `click.style` writes: colors and weight of what follows, and nothing that moves or hides it.
_STYLE = r"(\x1b\[(?:[0-2]|22|[39][0-79])m)"


def clean_line(text: str) -> str:
    """The same on one line: a name must not begin another line of a log or of a report."""
    return text if text.isprintable() else clean(" ".join(text.split("\n")).replace("\t", " "))


def clean_styled(text: str) -> str:
    """The same of a text with styles of `click.style`, which stay."""
    if "\x1b" not in text:
        return clean(text)
    return "".join(
        part if number % 2 else clean(part) for number, part in enumerate(re.split(_STYLE, text))
    )


def escape_json(text: str) -> str:
    """A JSON document without characters that cannot be shown: they are escaped, and stay data."""
    escaped = {code: f"\\u{code:04x}" for code in _unprintable() if ord("~") < code <= LARGEST}
    return text.translate(escaped)


def count_of(number: int, noun: str) -> str:
    """The number with its noun, in the plural where that is due."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
