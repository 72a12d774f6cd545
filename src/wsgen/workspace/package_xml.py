"""Whether ROS accepts a package.xml: catkin_pkg says, as it does to colcon and to CMake."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.workspace.manifest import read_manifest
from wsgen.workspace.manifest_hints import hint_for

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

REFUSED_MANIFEST = "PKG005"
QUESTIONABLE_MANIFEST = "PKG006"

ELEMENTS = ("maintainer", "author", "description", "license", "version", "name", "format")


def check_package_xml(file: Path) -> tuple[Diagnostic, ...]:
    """List what catkin_pkg refuses (errors) and what it merely dislikes (warnings)."""
    from catkin_pkg.package import (  # noqa: PLC0415  25 ms that only a failed build and checks pay
        InvalidPackage,
        parse_package_string,
    )

    manifest = read_manifest(file)
    if isinstance(manifest, Diagnostic):
        return (manifest,)
    text = file.read_text(encoding="utf-8", errors="replace")
    complaints: list[str] = []
    refusal = ""
    try:
        # As bytes: a text must not carry an encoding declaration.
        parse_package_string(file.read_bytes(), filename=str(file), warnings=complaints)
    except InvalidPackage as error:
        refusal = error.msg
    except (AssertionError, ValueError, UnicodeError) as error:
        refusal = f"catkin_pkg cannot read it ({error})"
    return (
        *(_refused(file, text, line) for line in _split_refusal(refusal)),
        *(_disliked(file, text, line) for line in complaints),
    )


def _split_refusal(message: str) -> Iterator[str]:
    """Yield the single complaints of a message that may hold several, a line each."""
    for line in message.splitlines():
        complaint = line.strip().removeprefix("- ")
        if complaint and complaint != "Error(s):":
            yield complaint


def _refused(file: Path, text: str, complaint: str) -> Diagnostic:
    return Diagnostic(
        code=REFUSED_MANIFEST,
        severity=Severity.ERROR,
        message=f"package.xml is not accepted: {_finish(complaint)}",
        file=file,
        line=_find_line(text, complaint),
        hint=hint_for(complaint, text),
    )


def _disliked(file: Path, text: str, complaint: str) -> Diagnostic:
    return Diagnostic(
        code=QUESTIONABLE_MANIFEST,
        severity=Severity.WARNING,
        message=f"package.xml is questionable: {_finish(complaint)}",
        file=file,
        line=_find_line(text, complaint),
        hint="The package builds all the same; REP-149 describes the format.",
    )


def _finish(sentence: str) -> str:
    return sentence if sentence.endswith((".", "!", "?")) else f"{sentence}."


def _find_line(text: str, complaint: str) -> int | None:
    """Guess the line meant: that of a tag, of a quoted value, or of the element that is named."""
    words = re.findall(r"\w+", complaint)
    quoted = [first or second for first, second in re.findall(r"\"([^\"]+)\"|'([^']+)'", complaint)]
    named = {word.lower().rstrip("s") for word in words}
    unknown = re.search(r"following tags: (.+?)\.?$", complaint)
    needles = (
        *(f"<{tag}" for tag in (unknown[1].split(", ") if unknown else ())),
        *(f"<{word}" for word in words if word.endswith("_depend")),
        *(f"<{word}" for word in quoted),
        *(word for word in quoted if word not in ELEMENTS),
        *(f"<{element}" for element in ELEMENTS if element in named),
        "<package",  # where something is missing
    )
    lines = text.splitlines()
    for needle in needles:
        for number, line in enumerate(lines, start=1):
            if needle in line and not line.startswith("<?xml"):
                return number
    return None
