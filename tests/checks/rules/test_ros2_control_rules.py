"""The rules over `<ros2_control>` and `<transmission>`, each with its facts and no files."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.checks.rules.ros2_control import ControlFacts, check_control, transmissions
from wsgen.diagnostics import Severity
from wsgen.model.robot import (
    ControlledPart,
    ControlSystem,
    Joint,
    JointType,
    Mimic,
    Plugin,
    Transmission,
)

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic

FILE = Path("arm.urdf")
GZ = Plugin("gz_ros2_control-system", {}, "gz_ros2_control::GazeboSimROS2ControlPlugin", 40)
CLASSIC = Plugin("libgazebo_ros2_control.so", {}, "gazebo_ros2_control", 41)
ELBOW = Joint(name="elbow", type=JointType.REVOLUTE, parent="a", child="b")
FOLLOWER = Joint(
    name="finger", type=JointType.PRISMATIC, parent="b", child="c", mimic=Mimic(joint="elbow")
)
FIXED = Joint(name="tool", type=JointType.FIXED, parent="b", child="d")


def part(name: str, *commands: str, mimic: str = "") -> ControlledPart:
    states = ("position",)
    return ControlledPart(
        kind="joint", name=name, commands=commands, states=states, mimic=mimic, line=22
    )


def system(*parts: ControlledPart, hardware: str | None = None) -> ControlSystem:
    return ControlSystem(
        name="arm",
        kind="system",
        hardware=hardware or "gz_ros2_control/GazeboSimSystem",
        parts=parts or (part("elbow", "position"),),
        line=20,
    )


FACTS = ControlFacts(controls=(system(),), joints=(ELBOW, FOLLOWER, FIXED), plugins=(GZ,))


def check(*systems: ControlSystem, facts: ControlFacts = FACTS) -> list[Diagnostic]:
    return list(check_control(facts._replace(controls=systems), FILE))


def test_a_sound_one_is_silent() -> None:
    assert not check(*FACTS.controls)
    assert not check(*FACTS.controls, facts=FACTS._replace(simulator="gz", distro="jazzy"))
    classic = system(hardware="gazebo_ros2_control/GazeboSystem")
    assert not check(classic, facts=FACTS._replace(plugins=(CLASSIC,)))
    assert not check(classic, facts=FACTS._replace(plugins=(CLASSIC, GZ)))
    of_a_maker = system(part("elbow", "torque"), hardware="maker_driver/Hardware")
    assert not check(of_a_maker)


def test_an_unknown_joint() -> None:
    (found,) = check(system(part("elbwo", "position")))
    assert (found.code, found.severity, found.line) == ("ROB087", Severity.ERROR, 22)
    assert found.element == "ros2_control[@name='arm']/joint[@name='elbwo']"
    assert found.hint == "Did you mean `elbow`?"


@pytest.mark.parametrize(
    ("distro", "hardware", "severity"),
    [
        (None, None, Severity.ERROR),
        ("humble", None, Severity.WARNING),
        ("jazzy", "maker_driver/Hardware", Severity.ERROR),
        (None, "maker_driver/Hardware", Severity.WARNING),
    ],
)
def test_a_fixed_joint(distro: str | None, hardware: str | None, severity: Severity) -> None:
    facts = FACTS._replace(distro=distro)
    (found,) = check(system(part("tool", "position"), hardware=hardware), facts=facts)
    assert (found.code, found.severity) == ("ROB088", severity)


def test_a_joint_that_mimics() -> None:
    elbow = part("elbow", "position")
    (found,) = check(system(elbow, part("finger", "position")))
    assert (found.code, found.severity) == ("ROB089", Severity.WARNING)
    (found,) = check(system(part("finger")), facts=FACTS._replace(distro="jazzy"))
    assert (found.code, found.severity) == ("ROB089", Severity.ERROR)
    assert 'Add <joint name="elbow">' in (found.hint or "")
    assert not check(system(elbow, part("finger")))
    assert not check(system(elbow, part("finger", "position", mimic="false")))
    followed = system(elbow, part("finger", "position"))
    assert not check(followed, facts=FACTS._replace(distro="humble"))


def test_what_is_missing() -> None:
    sound = system()
    bad = (
        replace(sound, name=""),
        replace(sound, kind=""),
        replace(sound, kind="sytem"),
        replace(sound, others=("joints",)),
        system(part("", "position")),
        system(part("elbow", "")),
    )
    for one in bad:
        (found,) = check(one)
        assert (found.code, found.severity) == ("ROB090", Severity.ERROR), one
    (found,) = check(replace(sound, hardware=None))
    assert (found.code, found.severity) == ("ROB090", Severity.WARNING)


def test_interfaces() -> None:
    (found,) = check(system(part("elbow", "positon")))
    assert (found.code, found.line) == ("ROB091", 22)
    assert found.hint == 'Write <command_interface name="position"/>.'
    (found,) = check(system(part("elbow", "acceleration")))
    assert found.code == "ROB091"
    (found,) = check(system(part("elbow", "velocty"), hardware="maker_driver/Hardware"))
    assert found.code == "ROB091"
    assert not check(system(part("elbow", "acceleration"), hardware="maker_driver/Hardware"))
    assert not check(system(part("elbow", "position_pid")))


@pytest.mark.parametrize(
    ("hardware", "facts", "expected"),
    [
        ("gz_ros2_control/GazeboSystem", FACTS, ("ROB092", Severity.ERROR)),
        ("gazebo_ros2_control/GazeboSystem", FACTS, ("ROB093", Severity.ERROR)),
        ("mock_components/GenericSystem", FACTS, ("ROB093", Severity.WARNING)),
        (
            "gazebo_ros2_control/GazeboSystem",
            FACTS._replace(plugins=(CLASSIC,), simulator="gz"),
            ("ROB093", Severity.ERROR),
        ),
        (
            "ign_ros2_control/IgnitionSystem",
            FACTS._replace(distro="kilted"),
            ("ROB093", Severity.ERROR),
        ),
    ],
)
def test_hardware(hardware: str, facts: ControlFacts, expected: tuple[str, Severity]) -> None:
    (found,) = check(system(hardware=hardware), facts=facts)
    assert (found.code, found.severity) == expected
    assert found.line == 20


def test_old_names_where_they_still_work() -> None:
    for distro in (None, "humble", "jazzy"):
        facts = FACTS._replace(distro=distro)
        assert not check(system(hardware="ign_ros2_control/IgnitionSystem"), facts=facts)


def test_one_without_the_other() -> None:
    (found,) = check(system(), facts=FACTS._replace(plugins=()))
    assert (found.code, found.line) == ("ROB094", 20)
    (found,) = check()
    assert (found.code, found.line) == ("ROB094", 40)
    assert not check(
        system(hardware="mock_components/GenericSystem"), facts=FACTS._replace(plugins=())
    )


def test_transmissions() -> None:
    one = Transmission(name="t", joints=("elbwo",), line=9)
    unknown, old = transmissions([one], [ELBOW], [], FILE)
    assert (unknown.code, unknown.line, unknown.hint) == ("ROB095", 9, "Did you mean `elbow`?")
    assert (old.code, old.severity) == ("ROB096", Severity.INFO)
    assert not list(transmissions([replace(one, joints=("elbow",))], [ELBOW], [system()], FILE))


def test_two_of_one_name() -> None:
    gripper = replace(system(part("elbow", "velocity")), line=30)
    (found,) = [one for one in check(system(), gripper) if one.code == "ROB133"]
    assert (found.severity, found.line) == (Severity.ERROR, 30)
    assert "in line 20 also has the name `arm`" in found.message
    assert 'name="${prefix}arm"' in (found.hint or "")
    for other in (replace(gripper, name="gripper"), replace(gripper, name="")):
        several = check(system(), other)
        assert "ROB133" not in {one.code for one in several}
    without = replace(system(), name="")
    assert "ROB133" not in {one.code for one in check(without, without)}
