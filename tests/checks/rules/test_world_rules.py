"""The rules about worlds, from the world and its simulator alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.worlds import check_world
from wsgen.descriptions.sdf.source import read_document
from wsgen.gazebo.systems import remark_on, systems

FILE = Path("w.sdf")
PHYSICS = '<plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>'
COMMANDS = '<plugin filename="gz-sim-user-commands-system" name="gz::sim::systems::UserCommands"/>'
SCENE = (
    '<plugin filename="ignition-gazebo-scene-broadcaster-system" '
    'name="ignition::gazebo::systems::SceneBroadcaster"/>'
)
SYSTEMS = PHYSICS + COMMANDS + SCENE
LIDAR = '<model name="m"><link name="l"><sensor name="lidar" type="gpu_lidar"/></link></model>'
SUN = '<light name="sun" type="directional"/>'
CLASSIC_PLUGIN = '<plugin filename="libgazebo_ros_state.so" name="state"/>'
FUEL = "<include><uri>https://fuel.gazebosim.org/1.0/a/models/Table</uri></include>"
GROUND = "<include><uri>model://ground_plane</uri></include>"
SCRIPT = (
    '<model name="m"><link name="l"><visual name="v"><material><script><name>{}</name></script>'
    "{}</material></visual></link></model>"
)


def check(
    content: str,
    simulator: str | None = "gz",
    distro: str | None = "jazzy",
    *,
    version: str = "1.7",
    models: tuple[str, ...] = (),
) -> list[tuple[str, int | None]]:
    text = f'<sdf version="{version}">\n<world name="w">\n{content}\n</world>\n</sdf>'
    root, _ = read_document(text)
    assert root is not None
    found = check_world(
        root,
        FILE,
        simulator=simulator,
        distro=distro,
        is_spawned_into=False,
        has_model=lambda uri: uri in models,
    )
    return [(one.name, one.line) for one in found]


@pytest.mark.parametrize(
    ("content", "simulator", "distro", "name"),
    [
        (PHYSICS + SCENE + SUN, "gz", "jazzy", "missing-system-plugin"),
        (PHYSICS + SCENE + SUN, None, None, "missing-system-plugin"),
        (SYSTEMS + LIDAR + SUN, "gz", "kilted", "missing-sensor-system"),
        (CLASSIC_PLUGIN + SUN, "gz", "jazzy", "plugin-of-other-simulator"),
        (SYSTEMS.replace("<", "\n<", 1), "classic", None, "plugin-of-other-simulator"),
        (SYSTEMS.replace("Physics", "Phisics") + SUN, "gz", "jazzy", "unknown-system"),
        (FUEL + SUN, "gz", None, "model-from-network"),
        (GROUND + SUN, "gz", None, "model-of-classic"),
        ("", "gz", None, "no-light"),
        (SCRIPT.format("Gazebo/Red", "") + SUN, "gz", "humble", "material-script"),
        (SCRIPT.format("My/Own", "") + SUN, "gz", None, "material-script"),
        (
            "<physics><max_step_size>0.01</max_step_size></physics>",
            "classic",
            None,
            "not-in-real-time",
        ),
    ],
)
def test_what_is_wrong_with_a_world(
    content: str, simulator: str | None, distro: str | None, name: str
) -> None:
    found = check(content, simulator, distro)
    assert name in {one for one, _ in found}
    assert all(line in {2, 3, 4} for _, line in found)


@pytest.mark.parametrize(
    ("content", "simulator", "distro"),
    [
        (SYSTEMS + SUN, "gz", "jazzy"),
        (PHYSICS + SUN, "gz", "kilted"),
        (SUN, "gz", "humble"),
        ('<plugin filename="libOwn.so" name="own"/>' + SUN, "gz", "humble"),
        ('<plugin filename="gz-sim-own-system" name="own"/>' + SUN, "gz", "kilted"),
        ("<gui>" + CLASSIC_PLUGIN + "</gui>" + SYSTEMS + SUN, "gz", "humble"),
        (CLASSIC_PLUGIN, "classic", None),
        (CLASSIC_PLUGIN, None, None),
        ("<physics><real_time_update_rate>0</real_time_update_rate></physics>", "classic", None),
        (
            (
                "<physics><max_step_size>0.002</max_step_size>"
                "<real_time_update_rate>500.0</real_time_update_rate></physics>"
            ),
            "classic",
            None,
        ),
        ("<physics><max_step_size>fast</max_step_size></physics>", "classic", None),
        (SCRIPT.format("Gazebo/Red", "") + SUN, "gz", "jazzy"),
        (SCRIPT.format("Own", "<diffuse>1 0 0 1</diffuse>") + SUN, "gz", "humble"),
        (GROUND, "classic", None),
        ("", None, None),
    ],
)
def test_nothing_is_wrong_with_a_world(
    content: str, simulator: str | None, distro: str | None
) -> None:
    assert check(content, simulator, distro) == []


def test_models_that_are_here_are_found() -> None:
    models = ("model://ground_plane", "https://fuel.gazebosim.org/1.0/a/models/Table")
    assert check(GROUND + FUEL + SUN, models=models) == []


def test_the_version_is_that_of_the_target() -> None:
    assert check(SUN, version="1.12") == [("newer-sdf", 1)]
    assert check(SUN, distro="humble", version="1.10") == []  # Harmonic is released for it
    assert check(SUN, distro="lyrical", version="1.12") == []
    assert check(SUN, distro=None, version="1.12") == []
    assert check("", "classic", None, version="1.9") == [("newer-sdf", 1)]
    assert check(SUN, version="new") == []


def test_systems_have_classes() -> None:
    known = systems()
    assert known["log"] == ("LogPlayback", "LogRecord")
    assert known["diff-drive"] == ("DiffDrive",)


@pytest.mark.parametrize(
    ("filename", "name", "meant"),
    [
        ("gz-sim-imu-system", "gz::sim::systems::IMU", "gz::sim::systems::Imu"),
        ("gz-sim-diff-drive-system", "diff_drive", "gz::sim::systems::DiffDrive"),
        ("gz-sim-phisics-system", "x", "gz-sim-physics-system"),
        ("gz-sim-scene-broadcaster", "x", "gz-sim-scene-broadcaster-system"),
        (
            "ignition-gazebo-imu-system",
            "ignition::gazebo::systems::IMU",
            "ignition::gazebo::systems::Imu",
        ),
    ],
)
def test_names_of_systems_that_do_not_exist(filename: str, name: str, meant: str) -> None:
    remark = remark_on(filename, name)
    assert remark is not None
    assert remark.meant == meant


@pytest.mark.parametrize(
    ("filename", "name"),
    [
        ("gz-sim-physics-system", "gz::sim::systems::Physics"),
        ("libgz-sim-physics-system.so", "gz::sim::v8::systems::Physics"),
        ("ignition-gazebo6-imu-system", "ignition::gazebo::systems::Imu"),
        ("gz-sim-physics-system", ""),
        ("gz-sim-own-system", "own"),
        ("libgazebo_ros_state.so", "state"),
        ("gz_ros2_control-system", "gz_ros2_control::GazeboSimROS2ControlPlugin"),
    ],
)
def test_names_of_systems(filename: str, name: str) -> None:
    assert remark_on(filename, name) is None
