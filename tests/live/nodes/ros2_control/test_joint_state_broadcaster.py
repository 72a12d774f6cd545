"""The order of joints in `/joint_states`, as the source of each distribution has it."""

from __future__ import annotations

import sys
import types
from typing import Any

import pytest

from live.nodes.ros2_control.controlled import controlled
from simulation.robots import body, joint, tree
from wsgen.live.nodes.simulator.ros2_control.hardware import unordered
from wsgen.model.robot import Box, JointType

KIND = "joint_state_broadcaster/JointStateBroadcaster"
NAMES = ("right_wheel_joint", "left_wheel_joint", "arm_joint")
BOX = Box(size=(0.1, 0.1, 0.1))
ROBOT = tree(
    body(BOX, name="base"),
    *(
        (
            joint("base", f"link_{name}", JointType.CONTINUOUS, name=name),
            body(BOX, name=f"link_{name}"),
        )
        for name in NAMES
    ),
)


class Values:
    """A message of control_msgs."""

    def __init__(self, **fields: Any) -> None:
        self.header = types.SimpleNamespace(frame_id="", stamp=None)
        self.joint_names: list[str] = []
        self.interface_values: list[Values] = []
        vars(self).update(fields)


@pytest.fixture
def control_msgs(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("control_msgs", "control_msgs.msg"):
        module = types.ModuleType(name)
        vars(module).update(DynamicJointState=Values, InterfaceValue=Values)
        monkeypatch.setitem(sys.modules, name, module)


@pytest.mark.usefixtures("messages", "control_msgs")
@pytest.mark.parametrize(
    ("is_former", "parameters", "expected"),
    [
        (True, {}, NAMES),
        (False, {}, sorted(NAMES)),
        (False, {"use_urdf_to_filter": False}, NAMES),
        (False, {"joints": NAMES[1:], "interfaces": ["position"]}, NAMES[1:]),
    ],
)
def test_the_order_of_joints(
    *, is_former: bool, parameters: dict[str, Any], expected: list[str]
) -> None:
    interfaces = dict.fromkeys(NAMES, ("velocity",))
    parameters = {**parameters, "extra_joints": ["caster"]}
    with controlled(ROBOT, KIND, parameters, interfaces, is_former=is_former) as found:
        found.run(0.02)
        assert found.ros.published("/joint_states")[-1].name == [*expected, "caster"]
        message = found.ros.published("/dynamic_joint_states")[-1]
    parts = NAMES if "joints" not in parameters else NAMES[1:]
    assert message.joint_names == ["caster", *parts]  # in the order of the map
    kinds = ["position", "velocity", "effort"] if parts == NAMES else ["position"]
    assert [one.interface_names for one in message.interface_values] == [
        ["effort", "velocity", "position"],
        *[kinds] * len(parts),
    ]


def test_the_order_of_keys_of_a_map() -> None:
    """These are what a program of GCC 12 prints that puts the names into a map."""
    assert unordered(["position", "velocity", "effort"]) == ["effort", "velocity", "position"]
    wheels = ["a_joint", "b_joint", "c_joint", "left_wheel_joint", "right_wheel_joint"]
    assert unordered(wheels) == [
        *("left_wheel_joint", "c_joint", "right_wheel_joint", "b_joint", "a_joint")
    ]
    many = unordered(f"joint_{number}" for number in range(15, 0, -1))
    numbers = (2, 15, 9, 13, 14, 5, 1, 11, 4, 12, 10, 7, 8, 6, 3)
    assert many == [f"joint_{number}" for number in numbers]
