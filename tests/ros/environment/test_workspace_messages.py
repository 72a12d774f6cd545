"""Types in the file of an interface that nobody has: where they are, and which may be meant."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.ros.environment.workspace_messages import mistakes_in

if TYPE_CHECKING:
    from pathlib import Path

DECLARED = "among DEPENDENCIES of rosidl_generate_interfaces() in CMakeLists.txt"
GOOD = """# A goal.
uint8 KIND=1  # a constant
string<=5 NAME="x"
float64[<=3] size
geometry_msgs/Pose[] way
geometry_msgs/msg/Pose pose
rover_msgs/Other[2] other
Other one
wstring text "a b"
"""


@pytest.fixture
def prefix(tmp_path: Path) -> Path:
    folder = tmp_path / "share" / "geometry_msgs" / "msg"
    folder.mkdir(parents=True)
    for name in ("Pose", "Twist"):
        (folder / f"{name}.idl").touch()
    return tmp_path


def mistakes(text: str, prefix: Path, name: str = "Goal.msg") -> list[tuple[int, str]]:
    file = prefix / name
    file.write_text(text, encoding="utf-8")
    return list(mistakes_in(file, "rover_msgs", {"geometry_msgs", "std_msgs"}, [prefix]))


def test_what_is_right(prefix: Path) -> None:
    assert mistakes(GOOD, prefix) == []
    assert mistakes(f"{GOOD}---\n{GOOD}", prefix, "Go.srv") == []
    assert mistakes("std_msgs/Hedder header\n", prefix) == []  # nobody knows what it has


@pytest.mark.parametrize(
    ("line", "text"),
    [
        ("flot32 x", "flot32 is not a type. Did you mean `float32`?"),
        ("zzz[3] x", "zzz is not a type."),
        ("double x", "double is not a type. Did you mean `float64`?"),
        (
            "geometry_msgs/Pos pose",
            "geometry_msgs has no message Pos. Did you mean `geometry_msgs/Pose`?",
        ),
        ("geometry_msgs/Wombat w", "geometry_msgs has no message Wombat."),
        (
            "geometry_msg/Pose pose",
            f"geometry_msg is used, but it is not {DECLARED}. Did you mean `geometry_msgs`?",
        ),
    ],
)
def test_what_is_wrong(line: str, text: str, prefix: Path) -> None:
    assert mistakes(f"{GOOD}{line}\n", prefix) == [(10, text)]
