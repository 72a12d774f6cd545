"""Where the mistake is in a package.xml that is no XML: expat sees it later than it was made."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING
from xml.parsers import expat

if TYPE_CHECKING:
    from collections.abc import Sequence

UNCLOSED = frozenset({expat.errors.XML_ERROR_NO_ELEMENTS, expat.errors.XML_ERROR_UNCLOSED_TOKEN})


def find_mistake(
    data: bytes, error: expat.ExpatError, opened: Sequence[tuple[str, int]]
) -> tuple[str, int, str]:
    """Say what is wrong, on which line, and what to do.

    Args:
        data: the file.
        error: what expat says of it.
        opened: the elements that were open there, each with its 1-based line, the root first.
    """
    what = expat.ErrorString(error.code)
    if opened:
        tag, line = opened[-1]
        if what == expat.errors.XML_ERROR_TAG_MISMATCH:
            closing = _closing_tag(data, error)
            if closing not in {name for name, _ in opened}:
                return (
                    f"<{tag}> is closed by </{closing}>",
                    error.lineno,
                    f"Write </{tag}> here, or mend <{tag}> on line {line}.",
                )
            return f"<{tag}> is not closed", line, f"Add </{tag}> where the element ends."
        if what in UNCLOSED:
            return f"<{tag}> is not closed", line, f"Add </{tag}> where the element ends."
    if not data.strip():
        return "the file is empty", 1, "Write a manifest, or remove the file."
    return (
        what,
        error.lineno,
        ("Look at this line and the one before; in a text, & is written &amp; and < is &lt;"),
    )


def _closing_tag(data: bytes, error: expat.ExpatError) -> str:
    lines = data.splitlines()
    rest = lines[error.lineno - 1][error.offset :] if error.lineno <= len(lines) else b""
    match = re.match(rb"(?:</)?([^\s>]*)", rest)
    return match[1].decode("utf-8", "replace") if match else ""
