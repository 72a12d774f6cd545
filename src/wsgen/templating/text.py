"""Check text that users give, and escape it for each format.

Text of users goes only into package.xml, wsgen.toml, README.md and the license. All other files get
checked names and numbers.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from wsgen.model.package import Answer


# First and last of each range of characters in XML 1.0, without the control characters and the line
# ends of Unicode that break TOML, Python or a terminal.
_USABLE = (
    ("\t", "\n"),
    (" ", "~"),
    ("\xa0", "\u2027"),
    ("\u202a", "\ud7ff"),
    ("\ue000", "\ufffd"),
    ("\U00010000", "\U0010ffff"),
)
# ament_cmake writes the maintainer into a quoted CMake string as it is.
_BREAKS_CMAKE = ('"', "\\", "${", "$ENV{", "$CACHE{")
# EmailType of package_common.xsd.
_EMAIL = lazy_pattern(
    r"[-\w%+]+(\.[-\w%+]+)*@[-a-z0-9%]+(\.[-a-z0-9%]+)*\.[a-z]{2,}", re.ASCII | re.IGNORECASE
)
# Characters that are special in Markdown; the second group at the start of a paragraph.
_MARKDOWN = str.maketrans({character: f"\\{character}" for character in "\\`*_[]<>&|#~"})
_MARKDOWN_LIST = ("-", "+", "=", *(f"{digit}{sign}" for digit in "0123456789" for sign in ".)"))


def check_description(text: str) -> str:
    """Check a description of one or more lines, and strip it.

    Raises:
        RequestError: it is empty or has characters that package.xml cannot hold.
    """
    text = text.replace("\r\n", "\n").strip()
    if not text:
        raise RequestError(
            "The description is empty; package.xml requires one.",
            hint="Describe in a sentence what the package is for, or omit --description.",
        )
    _check_characters("description", text)
    return text


def check_maintainer_name(text: str) -> str:
    """Check a name on one line that package.xml and CMake can hold, and strip it.

    Raises:
        RequestError: it is invalid.
    """
    text = text.strip()
    if not text or "\n" in text or "\t" in text:
        raise RequestError(
            "The maintainer's name is empty or has several lines.",
            hint="Use --maintainer-name 'First Last'.",
        )
    _check_characters("maintainer's name", text)
    broken = [sign for sign in _BREAKS_CMAKE if sign in text]
    if broken:
        raise RequestError(
            f"The maintainer's name contains {broken[0]}, which breaks the string of CMake into"
            " which ament_cmake copies the name.",
            hint="Use a --maintainer-name without double quotes, backslashes and ${.",
        )
    return text


def check_maintainer_email(text: str) -> str:
    """Check an address against the schema of package.xml.

    Raises:
        RequestError: it is invalid.
    """
    if not _EMAIL.fullmatch(text):
        raise RequestError(
            f"{text!r} is not a valid e-mail address in package.xml.",
            hint="Use --maintainer-email name@example.com, in ASCII letters.",
        )
    return text


def xml_text(text: str) -> str:
    """Escape text between tags."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def toml_string(text: str) -> str:
    """Write a basic string with its quotes."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def toml_value(value: Answer) -> str:
    """Write a number, `true` or `false`, or a string with its quotes."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return toml_string(value) if isinstance(value, str) else repr(value)


def markdown_text(text: str) -> str:
    """Escape a paragraph that shows the text as it is."""
    line = " ".join(text.split()).translate(_MARKDOWN)
    # A digit and its sign would begin a numbered list; escaping the sign prevents it.
    if line.startswith(_MARKDOWN_LIST):
        sign = 1 if line[0].isdigit() else 0
        line = f"{line[:sign]}\\{line[sign:]}"
    return line


def _check_characters(what: str, text: str) -> None:
    for character in text:
        if not any(first <= character <= last for first, last in _USABLE):
            raise RequestError(
                f"The {what} contains the character U+{ord(character):04X}, which package.xml"
                " cannot hold.",
                hint="Remove it: control characters and bytes that are not UTF-8 are invalid.",
            )
