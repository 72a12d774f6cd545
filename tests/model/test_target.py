import re

import pytest

from wsgen.errors import RequestError
from wsgen.model import facts
from wsgen.model.target import (
    DEFAULT_TARGET,
    SIMULATORS,
    TARGETS,
    Target,
    choose_target,
    end_of_life_note,
)

TODAY = "2026-11-21"
INSTEAD = "use --distro humble (until 2027-05) or --distro lyrical (until 2031-05)."
DATE = r"\d{4}-\d{2}(-\d{2})?"


def target(name: str) -> Target:
    distro, simulator = name.split("-")
    return choose_target(distro, simulator)


def test_the_eight_targets() -> None:
    assert [one.name for one in TARGETS] == [
        "humble-classic",
        "iron-classic",
        "humble-gz",
        "iron-gz",
        "jazzy-gz",
        "kilted-gz",
        "lyrical-gz",
        "rolling-gz",
    ]


@pytest.mark.parametrize("one", TARGETS, ids=lambda one: one.name)
def test_every_target_can_be_chosen_and_knows_all_of_itself(one: Target) -> None:
    assert choose_target(one.distro, one.simulator) is one
    assert one.cmake_minimum == "3.20"
    assert re.fullmatch(r"2\d\.04", one.ubuntu)
    assert re.fullmatch(r"3\.\d\d", one.fact("python"))
    assert re.fullmatch(r"1\.\d+", one.sdf_version)
    assert one.gazebo.startswith("Gazebo ")
    assert {"package", "launch_file", "spawner", "entity_flag"} <= set(one.programs)
    assert {"diff_drive", "joint_state_publisher", "ros2_control"} <= set(one.plugins)
    assert one.ros2_control_hardware.endswith("System")


@pytest.mark.parametrize(
    ("distro", "name"),
    [("iron", "iron-classic"), ("humble", "humble-gz"), ("jazzy", "jazzy-gz")],
)
def test_usual_simulator(distro: str, name: str) -> None:
    assert choose_target(distro).name == name
    assert DEFAULT_TARGET.name == "iron-classic"


def test_what_classic_and_sim_are_called() -> None:
    assert target("humble-classic").gazebo == "Gazebo Classic 11"
    assert target("humble-gz").gazebo == "Gazebo Fortress"
    assert target("jazzy-gz").plugins["physics"] == (
        "gz-sim-physics-system",
        "gz::sim::systems::Physics",
    )
    assert target("humble-classic").sdf_version == "1.7"
    assert target("humble-gz").sdf_version == "1.9"


@pytest.mark.parametrize(
    ("distro", "simulator", "reason", "nearest"),
    [
        (
            "jazzy",
            "classic",
            "Gazebo Classic is not released for ROS 2 jazzy, only for humble and iron.",
            "--distro jazzy --sim gz",
        ),
        ("jazy", None, "'jazy' is not a ROS 2 distribution", "--distro jazzy"),
        ("Humble", "classic", "'Humble' is not a ROS 2", "--distro humble --sim classic"),
        ("noetic", None, "'noetic' is not a ROS 2 distribution", "--distro lyrical"),
        ("noetic", "classic", "'noetic' is not a ROS 2", "--distro humble --sim classic"),
        ("", "gz", "'' is not a ROS 2 distribution", "--distro lyrical --sim gz"),
    ],
)
def test_no_such_target(distro: str, simulator: str | None, reason: str, nearest: str) -> None:
    with pytest.raises(RequestError, match=re.escape(reason)) as caught:
        choose_target(distro, simulator)
    assert nearest in caught.value.hint


def test_distribution_that_nobody_typed() -> None:
    with pytest.raises(RequestError, match="ROS_DISTRO=noetic in the environment") as caught:
        choose_target("noetic", is_from_environment=True)
    assert "--distro lyrical" in caught.value.hint
    assert "unset ROS_DISTRO" in caught.value.hint


@pytest.mark.parametrize(
    ("name", "today", "note"),
    [
        ("jazzy-gz", TODAY, None),
        ("rolling-gz", "2099-01-01", None),
        ("kilted-gz", "2026-12-31", None),  # the month that is announced is a whole one
        (
            "kilted-gz",
            "2027-01-01",
            (
                "ROS 2 Kilted has had no updates since 2026-12; use --distro jazzy (until 2029-05)"
                " or --distro lyrical (until 2031-05)."
            ),
        ),
        (
            "iron-gz",
            TODAY,
            (f"ROS 2 Iron has had no updates since 2024-12-04; {INSTEAD}"),
        ),
        (
            "iron-classic",
            TODAY,
            (f"ROS 2 Iron has had no updates since 2024-12-04; {INSTEAD}"),
        ),
        ("iron-classic", "2024-12-04", None),  # the last day
        (
            "humble-classic",
            TODAY,
            (
                "Gazebo Classic has had no updates since 2025-01; use --sim gz (Gazebo Fortress,"
                " until 2027-05)."
            ),
        ),
        (
            "jazzy-gz",
            "2040-01-01",
            (
                "ROS 2 Jazzy has had no updates since 2029-05; use --distro rolling"
                " (until further notice)."
            ),
        ),
    ],
)
def test_end_of_life(name: str, today: str, note: str | None) -> None:
    assert end_of_life_note(target(name), today) == note


def test_every_fact_has_its_source_and_a_value_for_every_distribution() -> None:
    sources: set[str | None] = {"ROSDISTRO"}  # of the packages
    for source, *values in facts.OF_DISTROS.values():
        sources.add(source)
        assert len(values) == len(facts.DISTROS)
    sources |= {source for source, _ in facts.OF_CLASSIC.values()}
    for programs in facts.PROGRAMS.values():
        sources |= {source for source, _ in programs.values()}
    for plugins in facts.PLUGINS.values():
        sources |= {source for source, *_ in plugins.values()}
    sources |= {source for source, _ in facts.ROS2_CONTROL_HARDWARE.values()}
    assert sources == set(facts.SOURCES)
    for simulators in (set(facts.PROGRAMS), set(facts.PLUGINS), set(facts.ROS2_CONTROL_HARDWARE)):
        assert simulators == set(SIMULATORS)


@pytest.mark.parametrize("fact", ["released", "end_of_life", "gz_end_of_life"])
def test_dates(fact: str) -> None:
    for value in facts.OF_DISTROS[fact][1:]:
        assert value is None or re.fullmatch(DATE, value)


def test_what_is_released_for_some_is_not_said_to_be_for_all() -> None:
    assert not set(facts.RELEASED_FOR) & set(facts.RELEASED_FOR_ALL)
    for distros in facts.RELEASED_FOR.values():
        assert set(distros) <= set(facts.DISTROS)
