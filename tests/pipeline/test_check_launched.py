"""Launch files are checked with what they start: worlds, robots, bridges, controllers, frames."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from cart_package import SENSORS, USER_COMMANDS, check_cart

if TYPE_CHECKING:
    from pathlib import Path

# Rules about the robot and its packages, which are not meant here.
ELSEWHERE = ("ROB", "PKG", "BLD")


def reported(
    folder: Path, changes: dict[str, tuple[str, str]]
) -> list[tuple[str, str, int | None]]:
    package, outcome = check_cart(folder, changes)
    return [
        (one.name, "" if one.file is None else one.file.relative_to(package).as_posix(), one.line)
        for one in outcome.diagnostics
        if not one.code.startswith(ELSEWHERE)
    ]


@pytest.mark.slow
def test_what_is_right_is_silent(tmp_path: Path) -> None:
    assert reported(tmp_path, {}) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "change", "expected"),
    [
        (
            "worlds/office.sdf",
            ('name="office"', 'name="default"'),
            ("other-world-name", "launch/cart.launch.py", 24),
        ),
        (
            "worlds/office.sdf",
            (USER_COMMANDS, ""),
            ("missing-system-plugin", "worlds/office.sdf", 3),
        ),
        (
            "worlds/office.sdf",
            (SENSORS, ""),
            ("missing-sensor-system", "worlds/office.sdf", 3),
        ),
        (
            "launch/cart.launch.py",
            ("['-r ', world]", "'-r empty.sdf'"),
            ("missing-sensor-system", "launch/cart.launch.py", 21),
        ),
        (
            "launch/cart.launch.py",
            ("['-r ', world]", "'-r'"),
            ("missing-sensor-system", "launch/cart.launch.py", 21),
        ),
        (
            "launch/cart.launch.py",
            (
                "package='ros_gz_sim', executable='create'",
                "package='gazebo_ros', executable='spawn_entity.py'",
            ),
            ("spawner-of-other-simulator", "launch/cart.launch.py", 24),
        ),
        (
            "launch/cart.launch.py",
            (
                "/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock",
                "/a@std_msgs/msg/Bool[gz.msgs.Boolean",
            ),
            ("no-clock-bridge", "launch/cart.launch.py", 22),
        ),
        (
            "config/bridge.yaml",
            ("gz_topic_name: /scan", "gz_topic_name: /scn"),
            ("unknown-bridge-topic", "config/bridge.yaml", 1),
        ),
        (
            "config/controllers.yaml",
            ("    broadcaster:", "    joints:"),
            ("unknown-controller", "launch/cart.launch.py", 30),
        ),
        (
            "config/controllers.yaml",
            ("JointStateBroadcaster", "JointStatesBroadcaster"),
            ("unknown-controller-type", "config/controllers.yaml", 4),
        ),
        (
            "launch/cart.launch.py",
            ("cart.rviz", "robot.rviz"),
            ("missing-argument-file", "launch/cart.launch.py", 31),
        ),
        (
            "config/cart.rviz",
            ("base_link", "base_lnk"),
            ("unpublished-frame", "config/cart.rviz", 3),
        ),
        (
            "launch/cart.launch.py",
            ("'0.1'", "'0.0'"),
            ("spawned-in-ground", "launch/cart.launch.py", 24),
        ),
        (
            "launch/cart.launch.py",
            ("'-r '", "'-r'"),
            ("glued-arguments", "launch/cart.launch.py", 21),
        ),
    ],
)
def test_what_does_not_fit_is_reported(
    tmp_path: Path, file: str, change: tuple[str, str], expected: tuple[str, str, int]
) -> None:
    assert expected in reported(tmp_path, {file: change})
