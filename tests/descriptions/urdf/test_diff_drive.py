"""The differential drive that plugins of both simulators describe."""

import math
import re
from dataclasses import replace

import pytest

from wsgen.descriptions.urdf.diff_drive import NoDrive, find_diff_drive
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.model.behavior import Bounds, DiffDrive, WheelPair
from wsgen.model.robot import Collision, Robot, Sphere, Surface

MASS = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
)
JOINTS = "<left_joint>l</left_joint><right_joint>r</right_joint>"
CLASSIC = "libgazebo_ros_diff_drive.so"
SIM = "gz-sim-diff-drive-system"


def robot(*plugins: tuple[str, str]) -> Robot:
    """A robot with two wheels, `l` and `r`, and one that is fixed, `f`."""
    wheels = "".join(
        f'<link name="{name}_link">{MASS}</link><joint name="{name}" type="{kind}">'
        f'<parent link="base"/><child link="{name}_link"/></joint>'
        for name, kind in (("l", "continuous"), ("r", "continuous"), ("f", "fixed"))
    )
    tags = "".join(
        f'<gazebo><plugin filename="{file}" name="p">{inside}</plugin></gazebo>'
        for file, inside in plugins
    )
    urdf = f'<robot name="r"><link name="base">{MASS}</link>{wheels}{tags}</robot>'
    written, found = read_urdf(urdf, file=None)
    assert written is not None
    assert found == ()
    return lump(written)[0]


def drive_of(file: str, inside: str) -> DiffDrive:
    found = find_diff_drive(robot((file, inside)))
    assert isinstance(found, DiffDrive), found
    return found


def problem_of(file: str, inside: str) -> str:
    found = find_diff_drive(robot((file, inside)))
    assert isinstance(found, NoDrive)
    assert found.is_there
    assert found.hint
    return found.reason


@pytest.mark.parametrize("file", [CLASSIC, SIM])
def test_the_friction_of_its_wheels_is_the_least(file: str) -> None:
    bare = robot((file, JOINTS))
    frictions = {"l_link": (1.0, 0.05), "r_link": (0.2,), "base": (0.0,)}  # by collision
    links = tuple(
        replace(
            link,
            collisions=tuple(
                Collision(geometry=Sphere(radius=0.1), surface=Surface(mu1=mu, mu2=mu))
                for mu in frictions.get(link.name, ())
            ),
        )
        for link in bare.links
    )
    found = find_diff_drive(replace(bare, links=links))
    assert isinstance(found, DiffDrive)
    assert found.grip == 0.2
    assert drive_of(file, JOINTS).grip == 1.0  # wheels without collisions


def test_the_plugin_of_gazebo_classic() -> None:
    drive = drive_of(
        CLASSIC,
        JOINTS + "<wheel_separation> 0.5 </wheel_separation><wheel_diameter>0.2</wheel_diameter>"
        "<max_wheel_torque>20</max_wheel_torque>"
        "<max_wheel_acceleration>1.5</max_wheel_acceleration>",
    )
    assert drive == DiffDrive(
        simulator="classic",
        pairs=(WheelPair(left="l", right="r", separation=0.5, radius=0.1),),
        torque=20.0,
        rim=Bounds(braking=-1.5, acceleration=1.5),
    )


@pytest.mark.parametrize(
    "file",
    [
        SIM,
        "libgz-sim-diff-drive-system.so",
        "ignition-gazebo-diff-drive-system",
        "libignition-gazebo-diff-drive-system.so",
    ],
)
def test_the_plugin_of_gazebo_sim(file: str) -> None:
    drive = drive_of(
        file,
        JOINTS + "<wheel_separation>0.5</wheel_separation><wheel_radius>0.1</wheel_radius>"
        "<max_velocity>2</max_velocity><max_linear_velocity>1</max_linear_velocity>"
        "<min_linear_acceleration>-3</min_linear_acceleration>"
        "<max_acceleration>4</max_acceleration>",
    )
    assert drive == DiffDrive(
        simulator="gz",
        pairs=(WheelPair(left="l", right="r", separation=0.5, radius=0.1),),
        linear=Bounds(fastest=1.0, braking=-3.0, acceleration=4.0),
        angular=Bounds(fastest=2.0, acceleration=4.0),
    )


def test_defaults_are_those_of_the_plugins() -> None:
    classic, sim = drive_of(CLASSIC, JOINTS), drive_of(SIM, JOINTS)
    assert (classic.pairs[0].separation, classic.pairs[0].radius) == (0.34, 0.075)
    assert (classic.torque, classic.rim.acceleration) == (5.0, math.inf)
    assert (sim.pairs[0].separation, sim.pairs[0].radius, sim.torque) == (1.0, 0.2, None)


def test_two_pairs_of_wheels() -> None:
    sizes = "<wheel_separation>0.5</wheel_separation><wheel_separation>0.6</wheel_separation>"
    classic = drive_of(CLASSIC, f"<num_wheel_pairs>2</num_wheel_pairs>{JOINTS}{JOINTS}{sizes}")
    assert [pair.separation for pair in classic.pairs] == [0.5, 0.6]
    sim = drive_of(SIM, f"{JOINTS}{JOINTS}{sizes}")
    assert [pair.separation for pair in sim.pairs] == [0.5, 0.5]


def test_gazebo_sim_turns_the_wheels_that_are_there() -> None:
    drive = drive_of(SIM, f"{JOINTS}<left_joint>x</left_joint><right_joint>l</right_joint>")
    assert [(pair.left, pair.right) for pair in drive.pairs] == [("l", "r"), ("l", "l")]


def test_of_two_plugins_that_of_the_simulator_counts() -> None:
    both = robot((SIM, JOINTS), (CLASSIC, JOINTS))
    for simulator, expected in (("gz", "gz"), ("classic", "classic"), (None, "gz")):
        drive = find_diff_drive(both, simulator=simulator)
        assert isinstance(drive, DiffDrive)
        assert drive.simulator == expected
    other = find_diff_drive(robot((CLASSIC, JOINTS)), simulator="gz")
    assert isinstance(other, NoDrive)
    assert other.reason == (
        "its diff drive plugin is for Gazebo Classic, but the launch file starts Gazebo Sim"
    )


def test_no_plugin() -> None:
    found = find_diff_drive(robot(("libgazebo_ros_camera.so", "")))
    assert isinstance(found, NoDrive)
    assert not found.is_there


@pytest.mark.parametrize(
    ("file", "inside", "reason"),
    [
        (SIM, "", "names 0 left and 0 right joints"),
        (SIM, "<left_joint>l</left_joint>", "names 1 left and 0 right joints"),
        (CLASSIC, JOINTS + JOINTS, "names 2 left and 2 right joints for 1 pairs of wheels"),
        (SIM, JOINTS.replace(">r<", ">x<"), "names the joint `x`"),
        (CLASSIC, JOINTS + "<left_joint>x</left_joint>", "names the joint `x`"),
        (SIM, JOINTS.replace(">r<", ">f<"), "names the joint `f`"),
        (SIM, JOINTS + "<wheel_radius>0</wheel_radius>", "the <wheel_radius> of .* is 0"),
        (CLASSIC, JOINTS + "<wheel_diameter>-1</wheel_diameter>", "<wheel_diameter> .* is -1"),
        (
            SIM,
            JOINTS + "<wheel_separation>wide</wheel_separation>",
            "`wide`, which is not a number",
        ),
        (SIM, JOINTS + "<wheel_separation>inf</wheel_separation>", "`inf`, which is not a number"),
    ],
)
def test_plugins_that_would_not_work(file: str, inside: str, reason: str) -> None:
    assert re.search(reason, problem_of(file, inside))


def test_a_static_robot_has_nothing_to_drive() -> None:
    found = find_diff_drive(replace(robot((SIM, JOINTS)), is_static=True))
    assert isinstance(found, NoDrive)


def test_bounds() -> None:
    free, bound = Bounds(), Bounds(slowest=-1, fastest=2, braking=-4, acceleration=3)
    assert free.next(0.0, 5.0, 0.01) == 5.0
    assert bound.next(0.0, 5.0, 0.1) == pytest.approx(0.3)
    assert bound.next(0.0, 5.0, 10.0) == 2.0
    assert bound.next(2.0, 0.0, 0.1) == pytest.approx(1.6)
    assert bound.next(0.0, -5.0, 10.0) == -1.0


@pytest.mark.parametrize(
    ("bounds", "wanted", "expected"),
    [
        (Bounds(), 3.0, 3.0),
        (Bounds(fastest=0.5), 3.0, 0.5),
        (Bounds(slowest=-0.2), -3.0, -0.2),
        (Bounds(acceleration=2.0), 3.0, 1.2),
        (Bounds(braking=-5.0), -3.0, 0.5),
        # It changed by 1 m/s² before, and may do so by 4 m/s² more after a tenth of a second.
        (Bounds(jerk=40.0), 3.0, 1.5),
        (Bounds(jerk=40.0, acceleration=3.0), 3.0, 1.3),
    ],
)
def test_bounds_with_jerk(bounds: Bounds, wanted: float, expected: float) -> None:
    assert bounds.next(1.0, wanted, 0.1, before=0.9) == pytest.approx(expected)


def test_speeds_of_rims() -> None:
    pair = WheelPair(left="l", right="r", separation=0.4, radius=0.1)
    assert pair.speeds(0.5, 1.0) == pytest.approx((0.3, 0.7))


def test_plugins_of_gazebo_sim_for_the_same_commands_drive_together() -> None:
    topic = "<topic>/cmd_vel</topic>"
    front = f"{JOINTS}<wheel_radius>0.1</wheel_radius>{topic}"
    rear = f"{JOINTS}<wheel_radius>0.2</wheel_radius>{topic}"
    found = find_diff_drive(robot((SIM, front), (SIM, rear)))
    assert isinstance(found, DiffDrive)
    assert [pair.radius for pair in found.pairs] == [0.1, 0.2]
    other = find_diff_drive(robot((SIM, front), (SIM, rear.replace("cmd_vel", "other"))))
    assert isinstance(other, DiffDrive)
    assert [pair.radius for pair in other.pairs] == [0.1]
