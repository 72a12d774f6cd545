"""Files of parameters that no node can read are reported, and other YAML is not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules.launch_files import malformed_parameter_files

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

SOUND = """\
drive:
  ros__parameters:
    wheels: [left, right]
    radius: 0.1
"""
BRIDGE = """\
- ros_topic_name: /scan
  gz_topic_name: /scan
"""


def check(folder: Path, text: str) -> list[Diagnostic]:
    file = folder / "parameters.yaml"
    file.write_text(text)
    return list(malformed_parameter_files(file, text.encode()))


@pytest.mark.parametrize(
    ("text", "old", "new", "line", "hint"),
    [
        (SOUND, "    radius", "\tradius", 4, "spaces"),
        (SOUND, "[left, right]", "[left, right", 4, "brackets"),
        (SOUND, "ros__parameters", "ros_parameters", 2, "two underscores"),
        (SOUND, "ros__parameters", "ros__params", 2, "two underscores"),
        (BRIDGE, "  gz_topic", "\tgz_topic", 2, "spaces"),
    ],
)
def test_a_mistake(  # noqa: PLR0917  the facts of a case
    tmp_path: Path, text: str, old: str, new: str, line: int, hint: str
) -> None:
    assert check(tmp_path, text) == []
    (found,) = check(tmp_path, text.replace(old, new))
    assert (found.code, found.line) == ("LCH099", line)
    assert hint in (found.hint or "")


@pytest.mark.parametrize(
    "text",
    ["a:\n\tb: 1\n", "{% if x %}\n" + SOUND, SOUND + "    ros_param: 3\n", "", "ros__parameters"],
)
def test_what_is_no_mistake(tmp_path: Path, text: str) -> None:
    assert check(tmp_path, text) == []
