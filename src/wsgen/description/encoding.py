"""The characters of a file: Gazebo's parser knows UTF-8 alone."""

from __future__ import annotations

import codecs
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.description.findings import Findings

WIDE = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE, codecs.BOM_UTF32_BE)  # UTF-32-LE begins as 16


def decode(findings: Findings, data: bytes) -> str | None:
    """The text of a file; None where it is none, which is reported."""
    data = data.rstrip(b"\0")  # where a text of C ends
    if data.startswith(WIDE) or b"\0" in data:
        findings.error(
            "ROB057",
            "The file is no text in UTF-8.",
            hint="Save it as UTF-8 (iconv -f UTF-16 -t UTF-8), if it is a text at all.",
            at=1,
        )
        return None
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        findings.warning(
            "ROB057",
            "The file is not in UTF-8, which it is read as.",
            hint="Save it as UTF-8 (iconv -f ISO-8859-1 -t UTF-8).",
            at=data.count(b"\n", 0, error.start) + 1,
        )
    return data.decode("utf-8", "replace")


def storable(text: str) -> str:
    """The text without halves of characters, which no file can hold, and without C's end."""
    text = text.rstrip("\0")
    try:
        text.encode("utf-8")
    except UnicodeEncodeError:
        return text.encode("utf-8", "replace").decode("utf-8")
    return text
