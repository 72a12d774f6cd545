"""The controllers that the simulator has, by their types."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller

_HERE = __name__
# Type -> module and class.
TYPES: dict[str, tuple[str, str]] = {
    "ackermann_steering_controller/AckermannSteeringController": (
        "steered_drives",
        "AckermannSteeringController",
    ),
    "bicycle_steering_controller/BicycleSteeringController": (
        "steered_drives",
        "BicycleSteeringController",
    ),
    "diff_drive_controller/DiffDriveController": ("wheel_drives", "DiffDriveController"),
    "effort_controllers/JointGroupEffortController": ("forward_command", "EffortController"),
    "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster": (
        "broadcasters",
        "ForceTorqueSensorBroadcaster",
    ),
    "forward_command_controller/ForwardCommandController": (
        "forward_command",
        "ForwardCommandController",
    ),
    "forward_command_controller/MultiInterfaceForwardCommandController": (
        "forward_command",
        "MultiInterfaceController",
    ),
    "imu_sensor_broadcaster/IMUSensorBroadcaster": (
        "broadcasters",
        "ImuSensorBroadcaster",
    ),
    "joint_state_broadcaster/JointStateBroadcaster": (
        "broadcasters",
        "JointStateBroadcaster",
    ),
    "joint_trajectory_controller/JointTrajectoryController": (
        "joint_trajectory",
        "JointTrajectoryController",
    ),
    "mecanum_drive_controller/MecanumDriveController": (
        "wheel_drives",
        "MecanumDriveController",
    ),
    "parallel_gripper_action_controller/GripperActionController": (
        "gripper",
        "ParallelGripperController",
    ),
    "effort_controllers/GripperActionController": ("gripper", "EffortGripperController"),
    "position_controllers/GripperActionController": ("gripper", "PositionGripperController"),
    "position_controllers/JointGroupPositionController": ("forward_command", "PositionController"),
    "tricycle_controller/TricycleController": ("steered_drives", "TricycleController"),
    "tricycle_steering_controller/TricycleSteeringController": (
        "steered_drives",
        "TricycleSteeringController",
    ),
    "velocity_controllers/JointGroupVelocityController": ("forward_command", "VelocityController"),
}


def controller_class(kind: str) -> type[Controller] | None:
    """The class of a type of controllers; None of one that the simulator does not have."""
    if kind not in TYPES:
        return None
    module, name = TYPES[kind]
    found: type[Controller] = getattr(import_module(f"{_HERE}.{module}"), name)
    return found
