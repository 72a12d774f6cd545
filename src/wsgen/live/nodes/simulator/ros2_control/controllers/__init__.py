"""The controllers that the simulator has, by their types."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller

# The types, in the order of the alphabet -> the module here, and the class that has another name.
TYPES = {
    "ackermann_steering_controller/AckermannSteeringController": "steered_drives",
    "bicycle_steering_controller/BicycleSteeringController": "steered_drives",
    "diff_drive_controller/DiffDriveController": "wheel_drives",
    "effort_controllers/GripperActionController": "gripper:EffortGripperController",
    "effort_controllers/JointGroupEffortController": "forward_command:EffortController",
    "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster": "broadcasters",
    "forward_command_controller/ForwardCommandController": "forward_command",
    "forward_command_controller/MultiInterfaceForwardCommandController": (
        "forward_command:MultiInterfaceController"
    ),
    "imu_sensor_broadcaster/IMUSensorBroadcaster": "broadcasters:ImuSensorBroadcaster",
    "joint_state_broadcaster/JointStateBroadcaster": "broadcasters",
    "joint_trajectory_controller/JointTrajectoryController": "joint_trajectory",
    "mecanum_drive_controller/MecanumDriveController": "wheel_drives",
    "parallel_gripper_action_controller/GripperActionController": (
        "gripper:ParallelGripperController"
    ),
    "position_controllers/GripperActionController": "gripper:PositionGripperController",
    "position_controllers/JointGroupPositionController": "forward_command:PositionController",
    "tricycle_controller/TricycleController": "steered_drives",
    "tricycle_steering_controller/TricycleSteeringController": "steered_drives",
    "velocity_controllers/JointGroupVelocityController": "forward_command:VelocityController",
}


def controller_class(kind: str) -> type[Controller] | None:
    """The class of a type of controllers; None of one that the simulator does not have."""
    if kind not in TYPES:
        return None
    module, _, name = TYPES[kind].partition(":")
    found: type[Controller] = getattr(
        import_module(f"{__name__}.{module}"), name or kind.partition("/")[2]
    )
    return found
