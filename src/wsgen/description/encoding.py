"""The characters of a file: Gazebo's parser knows UTF-8 alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.files import save_as_utf8, wide_encoding

if TYPE_CHECKING:
    from wsgen.description.findings import Findings


def decode(findings: Findings, data: bytes) -> str | None:
    """The text of a file; None where it is none, which is reported."""
    data = data.rstrip(b"\0")  # where a text of C ends
    wide = wide_encoding(data)
    if wide or b"\0" in data:
        findings.error(
            "ROB057",
            f"The file is in {wide}: Gazebo and robot_state_publisher read UTF-8 alone."
            if wide
            else "The file is not a text: it has null bytes.",
            hint=save_as_utf8(wide) if wide else "Name a text file in UTF-8.",
            at=1,
        )
        return None
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        findings.warning(
            "ROB057",
            "The file is not in UTF-8, which it is read as.",
            hint=save_as_utf8("ISO-8859-1"),
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
