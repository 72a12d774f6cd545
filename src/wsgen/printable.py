"""Texts that every reader takes: UTF-8 without characters that cannot be shown."""

from __future__ import annotations

# What is not printable, or turns the direction in which the text after it is read.
_UNPRINTABLE = {
    **{code: chr(0x2400 + code) for code in range(0x20) if chr(code) not in "\t\n"},
    0x7F: "\u2421",
    **dict.fromkeys((*range(0x80, 0xA0), *range(0xD800, 0xE000)), "\ufffd"),
    **dict.fromkeys((*range(0x202A, 0x202F), *range(0x2066, 0x206A)), "\ufffd"),
    **dict.fromkeys(range(0xFDD0, 0xFDF0), "\ufffd"),
    **dict.fromkeys(
        (plane + end for plane in range(0, 0x110000, 0x10000) for end in (0xFFFE, 0xFFFF)), "\ufffd"
    ),
}


def clean(text: str) -> str:
    """A text that can be written as UTF-8 and shown: other characters are replaced by signs.

    Names of files may have bytes that are no characters, and launch files give any text.
    """
    return text.translate(_UNPRINTABLE)
