"""The diff_drive_controller, without ROS."""

from __future__ import annotations

import types
from typing import Any

import pytest

from live.nodes.fake_ros import FakeNode, FakeRos

pytestmark = pytest.mark.usefixtures("messages")

PARAMETERS: dict[str, Any] = {
    "left_wheel_names": ["left"],
    "right_wheel_names": ["right"],
    "wheel_separation": 0.4,
    "wheel_radius": 0.1,
    "enable_odom_tf": False,
    "use_stamped_vel": False,
    "pose_covariance_diagonal": [],
    "twist_covariance_diagonal": [],
}


class _Node(FakeNode):
    def get_name(self) -> str:
        return self.name

    def get_namespace(self) -> str:
        return f"/{self.namespace}"


def test_it_drives_and_publishes_after_the_time_began_again() -> None:
    from geometry_msgs.msg import Twist  # noqa: PLC0415  a fake

    from wsgen.live.nodes.simulator.ros2_control.controllers.base import (  # noqa: PLC0415
        Surroundings,
    )
    from wsgen.live.nodes.simulator.ros2_control.controllers.wheel_drives import (  # noqa: PLC0415
        DiffDriveController,
    )
    from wsgen.live.nodes.simulator.ros2_control.parameters import Parameters  # noqa: PLC0415

    ros, now = FakeRos(), [0.0]
    node = _Node("wheels", "", [])
    ros.nodes.append(node)
    states = {"left/position": 0.0, "right/position": 0.0}
    interfaces: Any = types.SimpleNamespace(commands={}, states=states)
    controller = DiffDriveController(
        Surroundings(
            node,
            ros,  # type: ignore[arg-type]
            Parameters(PARAMETERS),
            interfaces,
            (),
            clock=lambda: now[0],
            is_former=True,
        )
    )
    controller.configure()
    controller.activate()
    controller.is_active = True

    def drive(begin: float) -> int:
        """Half a second; gives how often it has published."""
        before = len(ros.published("/~/odom"))
        command = Twist()
        command.linear.x = 0.5
        ros.send("/~/cmd_vel_unstamped", command)
        for step in range(50):
            now[0] = begin + 0.01 * step
            states.update(dict.fromkeys(states, states["left/position"] + 0.05))
            controller.update(now[0], 0.01)
        return len(ros.published("/~/odom")) - before

    drive(100.0)
    assert ros.published("/~/odom")[-1].pose.pose.position.x == pytest.approx(0.25, abs=0.02)
    now[0] = 0.0
    states.update(dict.fromkeys(states, 0.0))
    controller.reset(0.0)
    controller.update(0.0, 0.01)
    assert set(interfaces.commands.values()) == {0.0}
    assert drive(0.01) > 20
    assert set(interfaces.commands.values()) == {5.0}
    assert ros.published("/~/odom")[-1].pose.pose.position.x == pytest.approx(0.25, abs=0.02)
