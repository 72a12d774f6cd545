"""Who publishes joint states, from plans and robots alone."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from wsgen.checks.rules.frames import find_providers, no_joint_states
from wsgen.descriptions.sdf.source import read_document
from wsgen.model.plan import Include, LaunchPlan, Process, Unresolved

if TYPE_CHECKING:
    from wsgen.text.xmltree import Element

FILE = Path("robot.launch.py")
GZ = Include(package="ros_gz_sim", file=Path("gz_sim.launch.py"), evaluated=False)
CLASSIC = Include(package="gazebo_ros", file=Path("gazebo.launch.py"), evaluated=False)
RVIZ = Process(package="rviz2", executable="rviz2")
WHEELS = (
    '<joint name="left" type="continuous"/><joint name="right" type="continuous"/>'
    '<joint name="mast" type="fixed"/>'
    '<joint name="tip" type="revolute"><mimic joint="left"/></joint>'
)
OF_SIM = '<gazebo><plugin filename="gz-sim-joint-state-publisher-system">{}</plugin></gazebo>'
OF_CLASSIC = (
    '<gazebo><plugin filename="libgazebo_ros_joint_state_publisher.so">{}</plugin></gazebo>'
)
NAMES = "<joint_name>left</joint_name>"
BOTH_NAMES = NAMES + "<joint_name>right</joint_name>"
CONTROL = '<gazebo><plugin filename="gz_ros2_control-system"/></gazebo>'


def publisher(**more: Any) -> Process:
    return Process(
        package="robot_state_publisher", executable="robot_state_publisher", line=5, **more
    )


def node(package: str, executable: str, *arguments: str, **more: Any) -> Process:
    return Process(package=package, executable=executable, arguments=arguments, **more)


def bridge(topic: str, **more: Any) -> Process:
    word = f"{topic}@sensor_msgs/msg/JointState[gz.msgs.Model"
    return node("ros_gz_bridge", "parameter_bridge", word, **more)


def spawner(*names: str) -> Process:
    return node("controller_manager", "spawner", *names)


def robot_of(content: str) -> Element:
    root, _ = read_document(f'<robot name="r">{content}</robot>')
    assert root is not None
    return root


def check(
    content: str,
    *parts: Process | Include,
    unresolved: tuple[Unresolved, ...] = (),
    rsp: Process | None = None,
    is_spawned: bool = True,
) -> list[tuple[str, str]]:
    rsp = rsp or publisher()
    plan = LaunchPlan(
        package="p",
        launch_file=FILE,
        processes=(rsp, *(one for one in parts if isinstance(one, Process))),
        includes=tuple(one for one in parts if isinstance(one, Include)),
        unresolved=unresolved,
    )
    root = robot_of(content)
    providers = find_providers(plan, lambda package: package != "quiet", {"states"})
    found = no_joint_states(plan, [(rsp, root)], [root] if is_spawned else [], providers)
    return [(one.message, one.hint or "") for one in found]


@pytest.mark.parametrize(
    ("content", "parts", "message", "hint"),
    [
        (WHEELS, (RVIZ,), "`left`, `right` on joint_states", "package='joint_state_publisher'"),
        (WHEELS, (RVIZ, node("quiet", "drive")), "`left`, `right`", "joint_state_publisher"),
        (WHEELS, (CLASSIC,), "`left`, `right`", "libgazebo_ros_joint_state_publisher.so"),
        (WHEELS + OF_CLASSIC.format(NAMES), (CLASSIC,), "states of `right` on", "<joint_name>"),
        # Without their simulator plugins publish nothing.
        (WHEELS + OF_CLASSIC.format(BOTH_NAMES), (RVIZ,), "`left`, `right`", "Node(package='joint"),
        (WHEELS, (GZ,), "`left`, `right`", "gz-sim-joint-state-publisher-system"),
        (WHEELS + OF_SIM.format(""), (GZ,), "`left`, `right`", "arguments of parameter_bridge"),
        (
            WHEELS + OF_SIM.format(""),
            (GZ, bridge("/model/r/joint_state")),
            "`left`, `right`",
            "arguments of parameter_bridge",
        ),
        (WHEELS, (GZ, bridge("/joint_states")), "`left`, `right`", "Add <gazebo><plugin"),
        (
            WHEELS + OF_SIM.format(NAMES),
            (GZ, bridge("/joint_states")),
            "states of `right` on",
            "remove all of them",
        ),
        (WHEELS + CONTROL, (GZ, spawner("drive_controller")), "`left`", "joint_state_broadcaster"),
    ],
)
def test_joints_without_states(
    content: str, parts: tuple[Process | Include, ...], message: str, hint: str
) -> None:
    ((text, advice),) = check(content, *parts)
    assert message in text
    assert hint in advice


@pytest.mark.parametrize(
    ("content", "parts"),
    [
        ('<joint name="mast" type="fixed"/>', (RVIZ, GZ)),
        (WHEELS, ()),  # who starts it may start others, too
        (WHEELS, (RVIZ, node("joint_state_publisher_gui", "joint_state_publisher_gui"))),
        (WHEELS, (RVIZ, node("joint_state_publisher", "joint_state_publisher"))),
        (WHEELS + CONTROL, (GZ, spawner("joint_state_broadcaster"))),
        (WHEELS + CONTROL, (GZ, spawner("states"))),  # by its type
        (WHEELS + CONTROL, (GZ, spawner("joint_broad"), spawner("joint_state_controller"))),
        (
            WHEELS + CONTROL,
            (
                GZ,
                node(
                    "",
                    "",
                    command=("ros2", "control", "load_controller", "joint_state_broadcaster"),
                ),
            ),
        ),
        (WHEELS + OF_CLASSIC.format(BOTH_NAMES), (CLASSIC,)),
        (WHEELS + OF_SIM.format(""), (GZ, bridge("/joint_states"))),
        (WHEELS + OF_SIM.format(""), (GZ, bridge("/r/joint_states"))),  # in whatever namespace
        (
            WHEELS + OF_SIM.format(""),
            (GZ, bridge("/m", remappings=(("/m", "/joint_states"),))),
        ),
        # What is not known may publish them.
        (WHEELS, (RVIZ, node("driver_of_somebody", "driver"))),
        (WHEELS, (RVIZ, Process(package=None, executable=None, command=("python3", "a.py")))),
        (WHEELS, (RVIZ, Include(package="other", file=Path("b.launch.py"), evaluated=False))),
        (WHEELS + '<gazebo><plugin filename="libmine.so"/></gazebo>', (CLASSIC,)),
    ],
)
def test_joints_with_states(content: str, parts: tuple[Process | Include, ...]) -> None:
    parts = tuple(
        Process(package=None, executable=None, command=one.command)
        if isinstance(one, Process) and one.command
        else one
        for one in parts
    )
    assert check(content, *parts) == []


def test_the_topic_of_the_publisher_counts() -> None:
    moved = publisher(remappings=(("joint_states", "/states"),))
    ((text, _),) = check(WHEELS + OF_SIM.format(""), GZ, bridge("/joint_states"), rsp=moved)
    assert "on /states" in text
    assert check(WHEELS + OF_SIM.format(""), GZ, bridge("/states"), rsp=moved) == []


def test_a_robot_of_the_world_may_have_its_plugins_there() -> None:
    assert check(WHEELS, CLASSIC, is_spawned=False) == []
    assert check(WHEELS, GZ, bridge("/joint_states"), is_spawned=False) == []
    assert len(check(WHEELS, GZ, is_spawned=False)) == 1


def test_nothing_is_said_of_a_plan_that_is_not_whole() -> None:
    assert check(WHEELS, RVIZ, unresolved=(Unresolved(what="own", why="absent"),)) == []
