"""What launch files start beside their simulators, from plans alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules import simulators
from wsgen.diagnostics import Severity
from wsgen.launching.simulators import simulator_kinds
from wsgen.model.plan import Include, LaunchPlan, Process, Unresolved

FILE = Path("robot.launch.py")
CLASSIC_SPAWNER = Process(
    package="gazebo_ros", executable="spawn_entity.py", name="spawner", file=FILE, line=7
)


def create(*arguments: str) -> Process:
    return Process(package="ros_gz_sim", executable="create", arguments=arguments, line=8)


def gazebo(*words: str) -> Process:
    return Process(package=None, executable=None, command=("gazebo", *words), line=3)


def publisher(use_sim_time: object = None) -> Process:
    parameters = {} if use_sim_time is None else {"use_sim_time": use_sim_time}
    return Process(
        package="robot_state_publisher",
        executable="robot_state_publisher",
        parameters={"robot_description": "<robot/>", **parameters},
        line=5,
    )


def include(name: str, package: str, **values: str) -> Include:
    return Include(package=package, file=Path(name), arguments=values, evaluated=False)


GZ = include("gz_sim.launch.py", "ros_gz_sim", gz_args="-r w.sdf")
CLASSIC = include("gazebo.launch.py", "gazebo_ros", world="w")
UNKNOWN = (Unresolved(what="own", why="it is not installed"),)


def plan(*parts: Process | Include, unresolved: tuple[Unresolved, ...] = ()) -> LaunchPlan:
    return LaunchPlan(
        package="p",
        launch_file=FILE,
        processes=tuple(part for part in parts if isinstance(part, Process)),
        includes=tuple(part for part in parts if isinstance(part, Include)),
        unresolved=unresolved,
    )


def test_spawners_of_the_other_simulator() -> None:
    mixed = plan(GZ, CLASSIC_SPAWNER)
    (found,) = simulators.spawners_of_other_simulator(mixed, simulator_kinds(mixed))
    assert found.name == "spawner-of-other-simulator"
    assert (found.file, found.line) == (FILE, 7)
    assert "executable='create'" in (found.hint or "")
    mixed = plan(CLASSIC, create())
    (found,) = simulators.spawners_of_other_simulator(mixed, simulator_kinds(mixed))
    assert "spawn_entity.py" in (found.hint or "")


@pytest.mark.parametrize(
    "sound",
    [
        plan(GZ, create()),
        plan(CLASSIC, CLASSIC_SPAWNER),
        plan(create()),
        plan(CLASSIC, GZ, create()),
    ],
)
def test_spawners_of_the_simulator(sound: LaunchPlan) -> None:
    assert not list(simulators.spawners_of_other_simulator(sound, simulator_kinds(sound)))


@pytest.mark.parametrize(
    ("parts", "distro", "is_installed", "names"),
    [
        ((CLASSIC, CLASSIC_SPAWNER), "jazzy", False, "`gazebo.launch.py`, `spawn_entity.py` are"),
        ((gazebo("w.world"),), "kilted", False, "`gazebo` is"),
        ((CLASSIC_SPAWNER,), "jazzy", False, "`spawn_entity.py` is"),
        ((CLASSIC, CLASSIC_SPAWNER), "jazzy", True, None),  # somebody has built it
        ((CLASSIC, CLASSIC_SPAWNER), "humble", False, None),
        ((CLASSIC, CLASSIC_SPAWNER), None, False, None),
        ((GZ, create()), "jazzy", False, None),
        ((GZ, CLASSIC_SPAWNER), "jazzy", False, None),  # reported as that of another simulator
    ],
)
def test_gazebo_classic_where_there_is_none(
    parts: tuple[Process | Include, ...], distro: str | None, is_installed: bool, names: str | None
) -> None:
    found = list(simulators.no_classic(plan(*parts), distro, lambda _: is_installed))
    assert [one.severity for one in found] == ([] if names is None else [Severity.ERROR])
    assert all(f"ROS 2 {distro} has no Gazebo Classic: {names}" in one.message for one in found)


def test_gazebo_without_the_factory() -> None:
    for words in (("w.world",), ("-s", "libgazebo_ros_init.so")):
        wrong = plan(gazebo(*words), CLASSIC_SPAWNER)
        (found,) = simulators.no_factory(wrong, simulator_kinds(wrong), ())
        assert (found.name, found.line) == ("no-factory-plugin", 3)
    wrong = plan(include("gazebo.launch.py", "gazebo_ros", factory="false"), CLASSIC_SPAWNER)
    assert len(list(simulators.no_factory(wrong, simulator_kinds(wrong), ()))) == 1


def test_gazebo_with_the_factory() -> None:
    for sound in (
        plan(gazebo("-s", simulators.FACTORY), CLASSIC_SPAWNER),
        plan(gazebo(f"-s{simulators.FACTORY}"), CLASSIC_SPAWNER),
        plan(CLASSIC, CLASSIC_SPAWNER),
        plan(gazebo()),
        plan(GZ, CLASSIC_SPAWNER),
    ):
        assert not list(simulators.no_factory(sound, simulator_kinds(sound), ()))
    wrong = plan(gazebo(), CLASSIC_SPAWNER)
    assert not list(simulators.no_factory(wrong, simulator_kinds(wrong), None))
    assert not list(simulators.no_factory(wrong, simulator_kinds(wrong), (simulators.FACTORY,)))


@pytest.mark.parametrize("value", [None, False, "false"])
def test_nodes_with_the_time_of_the_computer(value: object) -> None:
    wrong = plan(GZ, publisher(value))
    (found,) = simulators.wall_clocks(wrong, simulator_kinds(wrong))
    assert (found.name, found.line) == ("wall-clock-beside-simulator", 5)


def test_nodes_with_the_time_of_the_simulator() -> None:
    in_words = Process(
        package="slam_toolbox", executable="x", arguments=("-p", "use_sim_time:=true")
    )
    for sound in (
        plan(GZ, publisher(use_sim_time=True)),
        plan(GZ, publisher("True")),
        plan(publisher()),
        plan(GZ, in_words),
        plan(GZ, publisher("$(own)"), unresolved=UNKNOWN),
        plan(GZ, Process(package="nav2_amcl", executable="amcl"), unresolved=UNKNOWN),
        plan(GZ, Process(package="robot_localization", executable="navsat_transform_node")),
    ):
        assert not list(simulators.wall_clocks(sound, simulator_kinds(sound)))


def test_nobody_brings_the_time() -> None:
    wrong = plan(GZ, publisher(use_sim_time=True), publisher(use_sim_time=True))
    (found,) = simulators.no_clock(wrong, simulator_kinds(wrong), ("/scan",))
    assert (found.name, found.line) == ("no-clock-bridge", 5)
    assert not list(simulators.no_clock(wrong, simulator_kinds(wrong), None))


@pytest.mark.parametrize(
    ("sound", "bridged"),
    [
        (plan(GZ, publisher(use_sim_time=True)), ("/clock",)),
        (plan(GZ, publisher()), ()),
        (plan(CLASSIC, publisher(use_sim_time=True)), ()),
        (plan(GZ, publisher(use_sim_time=True), unresolved=UNKNOWN), ()),
        (plan(GZ, publisher(use_sim_time=True), include("a.launch.py", "other")), ()),
        (
            plan(
                GZ,
                publisher(use_sim_time=True),
                Process(package="own", executable="own_bridge"),
            ),
            (),
        ),
    ],
)
def test_somebody_may_bring_the_time(sound: LaunchPlan, bridged: tuple[str, ...]) -> None:
    assert not list(simulators.no_clock(sound, simulator_kinds(sound), bridged))


def test_the_world_of_the_spawner() -> None:
    wrong = plan(GZ, create("-world", "office", "-name", "r"))
    (found,) = simulators.other_worlds(wrong, "default")
    assert (found.name, found.line, found.element) == ("other-world-name", 8, "office")
    assert found.hint == "Did you mean `default`?"
    service = Process(
        package=None,
        executable=None,
        command=("gz", "service", "-s", "/world/office/create", "--req", ""),
    )
    assert len(list(simulators.other_worlds(plan(GZ, service), "default"))) == 1
    for name in ("office", None):
        assert not list(simulators.other_worlds(wrong, name))
    assert not list(simulators.other_worlds(plan(GZ, create("-name", "r")), "default"))
    assert not list(
        simulators.other_worlds(plan(create("-world", "$(own)"), unresolved=UNKNOWN), "default")
    )


def test_arguments_of_gazebo(tmp_path: Path) -> None:
    file = tmp_path / "a.launch.py"
    file.write_text("x = {\n  'gz_args': ['-r', world]}\n")
    wrong = plan(include("gz_sim.launch.py", "ros_gz_sim", gz_args="-r/w/a.sdf -v 4"))
    wrong = LaunchPlan(package="p", launch_file=file, includes=wrong.includes)
    (found,) = simulators.glued_arguments(wrong)
    assert (found.name, found.file, found.line) == ("glued-arguments", file, 2)
    assert not list(simulators.starts_paused(wrong, ["gz"]))
    assert not list(simulators.glued_arguments(plan(GZ)))


@pytest.mark.parametrize("arguments", ["-v 4 w.sdf", "-s w.sdf", "w.sdf"])
def test_gazebo_starts_paused(arguments: str) -> None:
    paused = plan(include("gz_sim.launch.py", "ros_gz_sim", gz_args=arguments))
    (found,) = simulators.starts_paused(paused, ["gz"])
    assert found.name == "starts-paused"


@pytest.mark.parametrize("arguments", ["-r w.sdf", "-v4 -r w.sdf", "-sr w.sdf", "-g", ""])
def test_gazebo_runs(arguments: str) -> None:
    runs = plan(include("gz_sim.launch.py", "ros_gz_sim", gz_args=arguments))
    assert not list(simulators.starts_paused(runs, ["gz"]))
