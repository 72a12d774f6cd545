"""Hardware from <ros2_control>, and what becomes of commands."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest

from wsgen.descriptions.urdf.devices import read_devices
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.live.nodes.simulator.ros2_control.hardware import (
    Gains,
    Interfaces,
    Pid,
    read_hardware,
)
from wsgen.live.nodes.simulator.ros2_control.joints import FASTEST, JointSystem, Settings
from wsgen.model.devices import Element
from wsgen.model.robot import Joint, JointLimit, JointType, Link, Mimic, Robot
from wsgen.simulation.engine import Motor

if TYPE_CHECKING:
    from collections.abc import Mapping

PERIOD = 0.01  # s
LIMIT = JointLimit(lower=-1.0, upper=1.0, effort=10.0, velocity=2.0)


def joint(name: str, mimic: Mimic | None = None) -> Joint:
    return Joint(
        name=name,
        type=JointType.REVOLUTE,
        parent="base",
        child=f"{name}_link",
        limit=LIMIT,
        mimic=mimic,
    )


def element(tag: str, *children: Element, text: str = "", **attributes: str) -> Element:
    return Element(tag=tag, text=text, attributes=attributes, children=children)


def interface(kind: str, *names: str) -> list[Element]:
    return [element(f"{kind}_interface", name=name) for name in names]


def control(*parts: Element, plugin: str = "gz_ros2_control/GazeboSimSystem") -> Element:
    hardware = element("hardware", element("plugin", text=plugin))
    return element("ros2_control", hardware, *parts, name="all", type="system")


class Body:
    """Joints that do at once what motors say."""

    def __init__(self, *joints: Joint) -> None:
        links = tuple(Link(name=one.child) for one in joints)
        self.robot = Robot(name="r", root="base", links=(Link(name="base"), *links), joints=joints)
        self.positions = {one.name: 0.0 for one in joints}
        self.speeds = dict.fromkeys(self.positions, 0.0)
        self.motors: dict[str, Motor] = {}
        self.efforts: dict[str, float] = {}
        self.put: dict[str, float] = {}
        self.drives = 0

    def joint_positions(self) -> Mapping[str, float]:
        return dict(self.positions)

    def joint_velocities(self) -> Mapping[str, float]:
        return dict(self.speeds)

    def joint_efforts(self) -> Mapping[str, float]:
        return dict.fromkeys(self.positions, 0.5)

    def drive(self, motors: Mapping[str, Motor]) -> None:
        self.motors.update(motors)
        self.drives += 1

    def set_efforts(self, efforts: Mapping[str, float]) -> None:
        self.efforts.update(efforts)
        for name in efforts:
            self.motors.pop(name, None)

    def set_joint_positions(self, positions: Mapping[str, float]) -> None:
        self.put.update(positions)
        self.positions.update(positions)


def system(
    simulator: str, body: Body, *parts: Element, **options: Any
) -> tuple[JointSystem, Interfaces]:
    elements = [control(*parts)]
    hardware = read_hardware(elements, body.robot.joints)
    interfaces = Interfaces(hardware.components)
    settings = Settings(simulator, 1 / PERIOD, **options)
    made = JointSystem(body, hardware.components, interfaces, settings)
    made.begin()
    return made, interfaces


def part(name: str, *kinds: str, **attributes: str) -> Element:
    states = interface("state", "position", "velocity")
    return element("joint", *interface("command", *kinds), *states, name=name, **attributes)


def test_interfaces_of_a_real_description() -> None:
    inertial = """<inertial><mass value="1"/>
      <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>"""
    text = f"""<robot name="r"><link name="a">{inertial}</link><link name="b">{inertial}</link>
      <joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>
      <ros2_control name="s" type="system"><hardware>
        <plugin>gazebo_ros2_control/GazeboSystem</plugin></hardware>
        <joint name="j"><param name="pos_kp">10</param>
          <command_interface name="position"><param name="min">-1</param></command_interface>
          <state_interface name="position"><param name="initial_value">0.5</param></state_interface>
          <state_interface name="temperature"/></joint>
        <joint name="gone"><command_interface name="position"/></joint>
        <sensor name="imu"><state_interface name="orientation.x"/></sensor>
      </ros2_control></robot>"""
    robot, _ = read_urdf(text, file=None)
    assert robot is not None
    lumped, _ = lump(robot)
    devices = read_devices(text, robot, lumped)
    hardware = read_hardware(devices.ros2_control, lumped.joints)
    (component,) = hardware.components
    assert component.is_simulated
    assert component.commands == ("j/position",)
    assert component.states == ("j/position", "imu/orientation.x")
    assert component.joints[0].position_gains == Gains(p=10.0)
    assert "'gone'" in hardware.problems[0]
    assert Interfaces([component]).states["j/position"] == 0.5


def test_other_hardware_has_no_interfaces_here() -> None:
    elements = [control(part("a", "position"), plugin="my/Driver")]
    hardware = read_hardware(elements, [joint("a")])
    assert not hardware.components[0].is_simulated
    assert Interfaces(hardware.components).commands == {}


def test_mimic_joints_by_the_urdf_and_by_parameters() -> None:
    mimic = Mimic(joint="a", multiplier=-1.0, offset=0.1)
    plain = [control(part("a", "position"), part("b"))]
    (component,) = read_hardware(plain, [joint("a"), joint("b", mimic)]).components
    assert component.joints[1].follows == Mimic(joint="a", multiplier=-1.0, offset=0.1)
    off = [control(part("a", "position"), part("b", mimic="false"))]
    (component,) = read_hardware(off, [joint("a"), joint("b", mimic)]).components
    assert component.joints[1].follows is None
    former = element(
        "joint",
        element("param", text="a", name="mimic"),
        element("param", text="2", name="multiplier"),
        name="b",
    )
    (component,) = read_hardware([control(former)], [joint("b")]).components
    assert component.joints[0].follows == Mimic(joint="a", multiplier=2.0)


def test_gazebo_sim_goes_a_share_of_the_way_within_limits() -> None:
    body = Body(joint("a"))
    made, interfaces = system("gz", body, part("a", "position"))
    made.switch(["a/position"], [])
    interfaces.commands["a/position"] = 0.1
    made.write(PERIOD)
    assert body.motors["a"] == pytest.approx((0.1 * 0.1 / PERIOD, 10.0))
    interfaces.commands["a/position"] = 5.0  # beyond its end and its speed
    made.write(PERIOD)
    assert body.motors["a"] == Motor(2.0, 10.0)


def test_gazebo_classic_is_there_at_the_next_update_whatever_it_takes() -> None:
    body = Body(joint("a"))
    made, interfaces = system("classic", body, part("a", "position"))
    made.switch(["a/position"], [])
    interfaces.commands["a/position"] = 0.1
    made.write(PERIOD)
    assert body.motors["a"] == pytest.approx((0.1 / PERIOD, math.inf))
    interfaces.commands["a/position"] = 1.0
    made.write(PERIOD)
    assert 1.0 / PERIOD > FASTEST
    assert body.put == {"a": 1.0}
    made.write(PERIOD)
    assert body.motors["a"] == Motor(0.0, math.inf)


@pytest.mark.parametrize(
    ("simulator", "wanted"), [("gz", Motor(2.0, 10.0)), ("classic", Motor(3.0, math.inf))]
)
def test_velocities(simulator: str, wanted: Motor) -> None:
    body = Body(joint("a"))
    made, interfaces = system(simulator, body, part("a", "velocity"))
    made.switch(["a/velocity"], [])
    interfaces.commands["a/velocity"] = 3.0
    made.write(PERIOD)
    assert body.motors["a"] == wanted


def test_efforts_take_the_motor_out_and_keep_to_the_limit() -> None:
    body = Body(joint("a"))
    made, interfaces = system("gz", body, part("a", "effort"))
    assert body.motors == {"a": Motor(0.0, 10.0)}  # held
    made.switch(["a/effort"], [])
    interfaces.commands["a/effort"] = 4.0
    made.write(PERIOD)
    assert (body.motors, body.efforts) == ({}, {"a": 4.0})
    interfaces.commands["a/effort"] = 40.0
    made.write(PERIOD)
    assert body.efforts == {"a": 10.0}
    made.switch([], ["a/effort"])
    made.write(PERIOD)
    assert body.motors == {"a": Motor(0.0, 10.0)}


def test_joints_that_nobody_commands_are_free_where_the_plugin_says_so() -> None:
    body = Body(joint("a"), joint("b"))
    system("gz", body, part("a", "position"), part("b"), hold=False)
    assert body.motors == {}
    assert body.efforts == {"a": 0.0, "b": 0.0}


def test_a_mimic_joint_follows_without_a_controller() -> None:
    body = Body(joint("a"), joint("b", Mimic(joint="a", multiplier=-1.0)))
    made, _ = system("gz", body, part("a", "position"), part("b"))
    body.positions["a"] = 0.01
    made.write(PERIOD)
    assert body.motors["b"] == pytest.approx((-1.0, 10.0))


def test_initial_values_put_the_joints_there() -> None:
    state = element(
        "state_interface", element("param", text="0.3", name="initial_value"), name="position"
    )
    body = Body(joint("a"), joint("b", Mimic(joint="a")))
    described = element("joint", *interface("command", "position"), state, name="a")
    _, interfaces = system("gz", body, described, part("b"))
    assert body.put == {"a": 0.3, "b": 0.3}
    assert interfaces.commands["a/position"] == 0.3


def test_motors_are_set_when_something_changes_alone() -> None:
    body = Body(joint("a"))
    made, _ = system("gz", body, part("a", "position"))
    made.switch(["a/position"], [])
    made.write(PERIOD)
    before = body.drives
    for _ in range(5):
        made.read()
        made.write(PERIOD)
    assert body.drives == before


def test_classic_has_pid_controllers() -> None:
    gains = [
        element("param", text=text, name=f"pos_{name}") for name, text in (("kp", "5"), ("kd", "1"))
    ]
    described = element(
        "joint",
        *gains,
        *interface("command", "position"),
        *interface("state", "position"),
        name="a",
    )
    body = Body(joint("a"))
    made, interfaces = system("classic", body, described)
    made.switch(["a/position"], [])
    interfaces.commands["a/position"] = 0.5
    made.write(PERIOD)
    assert body.efforts == {"a": pytest.approx(2.5)}


def test_the_integral_of_a_pid_is_bound() -> None:
    pid = Pid(Gains(p=0.0, i=10.0, most=0.5, least=-0.5))
    assert [round(pid.command(1.0, 0.02), 3) for _ in range(4)] == [0.2, 0.4, 0.5, 0.5]
    pid.reset()
    assert pid.command(-1.0, 1.0) == -0.5
    assert pid.command(math.nan, 1.0) == 0.0
