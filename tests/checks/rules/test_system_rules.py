"""The systems that a world of Gazebo Sim has, and what is missing there."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.systems import (
    missing_default_systems,
    missing_sensor_systems,
    needs_of,
    place_of,
    systems_of_world,
    systems_within,
)
from wsgen.descriptions.sdf.source import read_document
from wsgen.diagnostics import Severity
from wsgen.gazebo.systems import (
    DEFAULT_SYSTEMS,
    plugin_of,
)
from wsgen.text.xmltree import Element, children

ALL_DEFAULT = "".join(map(plugin_of, DEFAULT_SYSTEMS))
POLICY = (
    "<gz:policies><include_server_config_plugins>{}</include_server_config_plugins></gz:policies>"
)
SENSORS_SYSTEM = '<plugin filename="{}" name="{}"/>'
LIDAR = '<sensor name="lidar" type="gpu_lidar"/>'


def world_of(content: str) -> Element:
    root, _ = read_document(f'<sdf version="1.9"><world name="w">{content}</world></sdf>')
    assert root is not None
    return next(children(root, "world"))


def root_of(text: str) -> Element:
    root, _ = read_document(text)
    assert root is not None
    return root


@pytest.mark.parametrize(
    ("content", "distro", "lacking"),
    [
        ("", "humble", ""),  # a world without plugins has the default ones
        ("", None, ""),
        (plugin_of("Imu"), "humble", "Physics UserCommands SceneBroadcaster"),
        (plugin_of("Imu"), "jazzy", "Physics UserCommands SceneBroadcaster"),
        (plugin_of("Imu"), None, "Physics UserCommands SceneBroadcaster"),
        (plugin_of("Imu"), "kilted", ""),  # from Ionic on they are added
        (
            plugin_of("Imu") + POLICY.format("false"),
            "kilted",
            "Physics UserCommands SceneBroadcaster",
        ),
        (plugin_of("Imu") + POLICY.format("true"), "rolling", ""),
        # What Gazebo Sim cannot load does not count: there are the default ones.
        (SENSORS_SYSTEM.format("libgazebo_ros_state.so", "state"), "jazzy", ""),
        (SENSORS_SYSTEM.format("gz-sim-imu-sistem", ""), "jazzy", ""),
        # A system of somebody's own does.
        (
            SENSORS_SYSTEM.format("libmine.so", "mine::System"),
            "jazzy",
            "Physics UserCommands SceneBroadcaster",
        ),
    ],
)
def test_the_systems_of_a_world(content: str, distro: str | None, lacking: str) -> None:
    loaded = systems_of_world(world_of(content), distro).loaded
    assert [name for name in DEFAULT_SYSTEMS if name not in loaded] == lacking.split()


@pytest.mark.parametrize(
    ("filename", "name"),
    [
        ("gz-sim-sensors-system", "gz::sim::systems::Sensors"),
        ("libgz-sim-sensors-system.so", "gz::sim::systems::Sensors"),
        ("libgz-sim8-sensors-system.so", "gz::sim::systems::Sensors"),
        ("libignition-gazebo-sensors-system.so", "ignition::gazebo::systems::Sensors"),
        ("ignition-gazebo-sensors-system", "ignition::gazebo::systems::Sensors"),
        ("gz-sim-sensors-system", "ignition::gazebo::systems::Sensors"),
        ("gz-sim-sensors-system", ""),
    ],
)
def test_all_names_of_a_system_count(filename: str, name: str) -> None:
    plugin = SENSORS_SYSTEM.format(filename, name)
    assert "Sensors" in systems_of_world(world_of(plugin), "jazzy").loaded
    robot = f'<robot name="r"><gazebo>{plugin}</gazebo></robot>'
    assert "Sensors" in systems_within(root_of(robot))


def test_the_default_systems_do_not_work_in_a_robot() -> None:
    robot = f'<robot name="r"><gazebo>{ALL_DEFAULT}{plugin_of("Imu")}</gazebo></robot>'
    assert systems_within(root_of(robot)) == {"Imu"}


@pytest.mark.parametrize(
    ("content", "distro", "is_spawned_into", "severity"),
    [
        (plugin_of("Physics"), "jazzy", True, Severity.ERROR),
        (plugin_of("Physics") + plugin_of("UserCommands"), "jazzy", True, Severity.WARNING),
        (plugin_of("Physics"), None, True, Severity.WARNING),
        (plugin_of("Physics"), "jazzy", False, Severity.INFO),
        (ALL_DEFAULT, "jazzy", True, None),
        (SENSORS_SYSTEM.format("libmine.so", "mine::System"), "jazzy", True, None),
    ],
)
def test_a_world_without_default_systems(
    content: str, distro: str | None, is_spawned_into: bool, severity: Severity | None
) -> None:
    world = world_of(content)
    found = missing_default_systems(
        world, Path("w.sdf"), systems_of_world(world, distro), is_spawned_into=is_spawned_into
    )
    assert [one.severity for one in found] == ([] if severity is None else [severity])


@pytest.mark.parametrize(
    ("content", "robot", "names"),
    [
        (ALL_DEFAULT, f'<gazebo reference="l">{LIDAR}</gazebo>', "Sensors"),
        ("", f'<gazebo reference="l">{LIDAR}</gazebo>', "Sensors"),
        (plugin_of("Sensors"), f'<gazebo reference="l">{LIDAR}</gazebo>', ""),
        (
            "",
            f'<gazebo reference="l">{LIDAR}</gazebo><gazebo>{plugin_of("Sensors")}</gazebo>',
            "",
        ),
        ("", '<gazebo reference="l"><sensor name="i" type="imu"/></gazebo>', "Imu"),
        # Reported by themselves: Gazebo has no sensor of it.
        ("", '<gazebo reference="l"><sensor name="i" type="ray"/></gazebo>', ""),
        ("", '<gazebo><sensor name="i" type="imu"/></gazebo>', ""),
        ("", '<ros2_control><sensor name="i"/></ros2_control>', ""),
        ("", '<gazebo><plugin filename="gz-sim-touchplugin-system"/></gazebo>', "Contact"),
        ("", '<gazebo><plugin filename="gz-sim-diff-drive-system"/></gazebo>', ""),
    ],
)
def test_what_lacks_its_system(content: str, robot: str, names: str) -> None:
    world, root = world_of(content), root_of(f'<robot name="r">{robot}</robot>')
    found = missing_sensor_systems(
        place_of(world, Path("w.sdf")),
        systems_of_world(world, "jazzy"),
        systems_within(root),
        needs_of(root, "jazzy"),
        is_spawned_into=True,
    )
    assert [one.message.split("system ")[1].split(":")[0] for one in found] == names.split()


def test_the_hint_keeps_the_default_systems() -> None:
    """A world without plugins loses them to the first one that is added, up to Harmonic."""
    root = root_of(f'<robot name="r"><gazebo reference="l">{LIDAR}</gazebo></robot>')
    hints = {}
    for distro in ("jazzy", "kilted"):
        world = world_of("")
        (found,) = missing_sensor_systems(
            place_of(world, Path("w.sdf")),
            systems_of_world(world, distro),
            (),
            needs_of(root, distro),
            is_spawned_into=True,
        )
        hints[distro] = found.hint or ""
    assert hints["jazzy"].count("<plugin") == len(DEFAULT_SYSTEMS) + 1
    assert hints["kilted"].count("<plugin") == 1
