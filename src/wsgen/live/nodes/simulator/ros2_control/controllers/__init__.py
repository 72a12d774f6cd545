"""The controllers that the simulator has, by their types."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.live.nodes.simulator.ros2_control.controllers.base import Controller

# Module -> the types that it has, and their classes where these have another name than the type.
_TYPES_OF: dict[str, dict[str, str]] = {
    "broadcasters": {
        "force_torque_sensor_broadcaster/ForceTorqueSensorBroadcaster": "",
        "imu_sensor_broadcaster/IMUSensorBroadcaster": "ImuSensorBroadcaster",
        "joint_state_broadcaster/JointStateBroadcaster": "",
    },
    "forward_command": {
        "effort_controllers/JointGroupEffortController": "EffortController",
        "forward_command_controller/ForwardCommandController": "",
        "forward_command_controller/MultiInterfaceForwardCommandController": (
            "MultiInterfaceController"
        ),
        "position_controllers/JointGroupPositionController": "PositionController",
        "velocity_controllers/JointGroupVelocityController": "VelocityController",
    },
    "gripper": {
        "effort_controllers/GripperActionController": "EffortGripperController",
        "parallel_gripper_action_controller/GripperActionController": "ParallelGripperController",
        "position_controllers/GripperActionController": "PositionGripperController",
    },
    "joint_trajectory": {"joint_trajectory_controller/JointTrajectoryController": ""},
    "steered_drives": {
        "ackermann_steering_controller/AckermannSteeringController": "",
        "bicycle_steering_controller/BicycleSteeringController": "",
        "tricycle_controller/TricycleController": "",
        "tricycle_steering_controller/TricycleSteeringController": "",
    },
    "wheel_drives": {
        "diff_drive_controller/DiffDriveController": "",
        "mecanum_drive_controller/MecanumDriveController": "",
    },
}
# Type -> module and class; in the order of the alphabet.
TYPES = dict(
    sorted(
        (kind, (module, name or kind.partition("/")[2]))
        for module, kinds in _TYPES_OF.items()
        for kind, name in kinds.items()
    )
)


def controller_class(kind: str) -> type[Controller] | None:
    """The class of a type of controllers; None of one that the simulator does not have."""
    if kind not in TYPES:
        return None
    module, name = TYPES[kind]
    found: type[Controller] = getattr(import_module(f"{__name__}.{module}"), name)
    return found
