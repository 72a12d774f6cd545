"""What is known about the plugins of Gazebo Classic and of Gazebo Sim: data.

Names and parameters are those that the sources of gazebo_plugins and of gz-sim's `src/systems`
(Fortress to Jetty) have; `wsgen.gazebo.systems` has the names of all systems.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.target import CLASSIC, SIM
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from wsgen.model.robot import Robot
    from wsgen.model.world import World


# Libraries of ROS 2 for Gazebo Classic, without `lib` and `.so`.
OF_CLASSIC = tuple(
    f"gazebo_ros_{name}"
    for name in (
        *("ackermann_drive", "bumper", "camera", "diff_drive", "elevator", "factory", "force"),
        *("force_system", "ft_sensor", "gps_sensor", "hand_of_god", "harness", "imu_sensor"),
        *("init", "joint_pose_trajectory", "joint_state_publisher", "p3d", "planar_move"),
        *("projector", "properties", "ray_sensor", "state", "template", "tricycle_drive"),
        *("vacuum_gripper", "video", "wheel_slip"),
    )
)
# Elements in the <ros> of a plugin of Gazebo Classic that remap. gazebo_ros hands an <argument> on
# as it is, and rcl takes `old:=new` for a remapping in its older form (gazebo_ros/src/node.cpp).
REMAPPINGS = ("remapping", "argument")
TWO_WHEELS = ("left_joint", "right_joint")
STILL = (0.0, 0.0, 0.0)
TRUE = ("true", "1")  # as sdformat reads a truth value; all else is false

Default = float | bool | str | tuple[float, ...] | None
# What a parameter that is not written is; None: nothing, or what its plugin finds elsewhere. A text
# may name the robot (`{model}`) and its root link (`{link}`).
Parameters = Mapping[str, Default]


class Topic(NamedTuple):
    """A topic of a plugin."""

    type: str  # of gz.msgs; of ROS for plugins of Gazebo Classic
    # Of Gazebo Sim absolute, of Gazebo Classic as nodes of ROS name it. `{model}` and `{world}` are
    # their names, others what parameters say.
    name: str
    parameter: str = ""  # that says another name
    is_read: bool = False  # by the plugin, which else publishes it
    # Where it is there: truth values among the parameters, all of which hold. `-a`: a is false;
    # `a|b`: one of both.
    when: str = ""
    suffix: str = ""  # after its name, whoever says it

    @property
    def deciding(self) -> list[str]:
        """The parameters that decide whether it is there."""
        return re.findall(r"\w+", self.when)


_NOTHING: Parameters = {}
_NO_TOPICS: Mapping[str, Topic] = {}


class GazeboPlugin(NamedTuple):
    """What is known of a plugin."""

    parameters: Parameters = _NOTHING  # all that it reads; none: not looked up
    not_simulated: tuple[str, ...] = ()  # those of them that live runs do not read
    joints: tuple[str, ...] = ()  # the parameters that name joints of the robot
    links: tuple[str, ...] = ()  # likewise, links
    required: tuple[str, ...] = ()  # the parameters without which it does nothing
    topics: Mapping[str, Topic] = _NO_TOPICS  # by what they are for
    needs: tuple[str, ...] = ()  # the other systems of Gazebo Sim without which it does nothing

    def topic_names(
        self, written: Callable[[str], str | None], names: Mapping[str, str | None]
    ) -> Iterator[tuple[str, Topic, str | None]]:
        """The topics that a plugin has, by what they are for, with their names.

        Args:
            written: Gives the text of a parameter.
            names: Those of the model and the world; None where they are not known. Neither is the
                name of a topic then.
        """
        for use, topic in self.topics.items():
            if not all(
                any(self._holds(condition, written) for condition in conditions.split("|"))
                for conditions in topic.when.split()
            ):
                continue
            pattern = topic.name
            if topic.parameter and (said := written(topic.parameter)):
                pattern = said if "/" in topic.type or said.startswith("/") else f"/{said}"
            elif (
                topic.parameter == "topic"
                and "sub_topic" in self.parameters
                and written("sub_topic")
            ):
                pattern = "/model/{model}/{sub_topic}"
            name = self._filled(pattern, names, written)
            yield use, topic, None if name is None else f"{name}{topic.suffix}"

    def _filled(
        self,
        pattern: str,
        names: Mapping[str, str | None],
        written: Callable[[str], str | None],
    ) -> str | None:
        for key in re.findall(r"{(\w+)}", pattern):
            known = names[key] if key in names else written(key) or self.parameters.get(key)
            if known is None:
                return None
            pattern = pattern.replace(f"{{{key}}}", str(known))
        return pattern

    def _holds(self, condition: str, written: Callable[[str], str | None]) -> bool:
        name = condition.removeprefix("-")
        text = (written(name) or "").lower()
        is_true = text in TRUE if text else bool(self.parameters[name])
        return is_true is not condition.startswith("-")


_COVARIANCES: Parameters = {"covariance_x": 1e-5, "covariance_y": 1e-5, "covariance_yaw": 1e-3}
_ODOMETRY_OF_CLASSIC: Parameters = {
    "odometry_frame": "odom",
    "robot_base_frame": "base_footprint",
    **_COVARIANCES,
}
_COMMAND_OF_CLASSIC = {"command": Topic("geometry_msgs/Twist", "cmd_vel", is_read=True)}
_TF = Topic("tf2_msgs/TFMessage", "/tf")
_ODOM = Topic("nav_msgs/Odometry", "odom", when="publish_odom")
_DRIVE_OF_CLASSIC = {
    **_COMMAND_OF_CLASSIC,
    "odometry": _ODOM,
    "tf": _TF._replace(when="publish_odom_tf|publish_wheel_tf"),
}


def _bounds(*motions: str) -> Parameters:
    """The limits of `gz::math::SpeedLimiter`; without a motion, they are for all of them."""
    return {
        f"{side}_{motion}{kind}": -math.inf if side == "min" else math.inf
        for side in ("min", "max")
        for motion in motions
        for kind in ("velocity", "acceleration", "jerk")
    }


_ODOMETRY_OF_SIM: Parameters = {
    "odom_publish_frequency": 50.0,
    "odom_topic": None,
    "tf_topic": None,
    "frame_id": "{model}/odom",
    "child_frame_id": "{model}/{link}",
}
_COMMAND_OF_SIM = Topic("Twist", "/model/{model}/cmd_vel", "topic", is_read=True)
_DRIVE_OF_SIM = {
    "command": _COMMAND_OF_SIM,
    "odometry": Topic("Odometry", "/model/{model}/odometry", "odom_topic"),
    "tf": Topic("Pose_V", "/model/{model}/tf", "tf_topic"),
}
_ACTUATORS: Parameters = {"use_actuator_msg": False, "actuator_number": None, "sub_topic": None}
_BY_ACTUATORS = Topic("Actuators", "/actuators", "topic", is_read=True, when="use_actuator_msg")


def _gains(p: float, i: float, d: float, *, most: float = 1000.0) -> Parameters:
    return {
        "p_gain": p,
        "i_gain": i,
        "d_gain": d,
        "i_max": 1.0,
        "i_min": -1.0,
        "cmd_max": most,
        "cmd_min": -most,
        "cmd_offset": 0.0,
    }


def _command_of_joint(ending: str) -> Mapping[str, Topic]:
    name = f"/model/{{model}}/joint/{{joint_name}}/{ending}"
    return {
        "command": Topic("Double", name, "topic", is_read=True, when="-use_actuator_msg"),
        "actuators": _BY_ACTUATORS,
    }


# Without limits: the upper one is below the lower one.
_GAINS_OF_TRAJECTORY: Parameters = {
    "p_gain": 0.0,
    "i_gain": 0.0,
    "d_gain": 0.0,
    "i_max": -1.0,
    "i_min": 0.0,
    "cmd_max": -1.0,
    "cmd_min": 0.0,
    "cmd_offset": 0.0,
}
_PHYSICS = ("Physics",)
_POSE = Topic("Pose_V", "/model/{model}/pose", "topic", when="use_pose_vector_msg")
_STATIC = _POSE._replace(suffix="_static", when="static_publisher use_pose_vector_msg")
_CONTROL = GazeboPlugin(
    parameters={
        "parameters": None,
        "controller_manager_name": "controller_manager",
        "ros": None,
        "hold_joints": True,
        "position_proportional_gain": 0.1,
        "robot_param": "robot_description",
        "robot_param_node": "robot_state_publisher",
    },
    # What asks robot_state_publisher for the URDF waits for its topic here.
    not_simulated=("robot_param", "robot_param_node"),
    needs=_PHYSICS,
)
_MECANUM = ("front_left_joint", "front_right_joint", "back_left_joint", "back_right_joint")
_STEERING = ("left_steering_joint", "right_steering_joint")
_CAR = (
    *("front_right_joint", "front_left_joint", "rear_right_joint", "rear_left_joint"),
    *("right_steering_joint", "left_steering_joint"),
)
_TRICYCLE = (
    *("steering_joint", "actuated_wheel_joint"),
    *("encoder_wheel_left_joint", "encoder_wheel_right_joint"),
)
# Plugin, as `stem` gives it.
PLUGINS: dict[str, GazeboPlugin] = {
    "gazebo_ros_ackermann_drive": GazeboPlugin(
        parameters={
            "ros": None,
            "update_rate": 100.0,
            **{name: name for name in (*_CAR, "steering_wheel_joint")},
            "max_speed": 20.0,
            "max_steer": 0.6,
            "max_steering_angle": 7.85,
            **{
                f"{name}_{kind}": default
                for name in ("right_steering", "left_steering", "linear_velocity")
                for kind, default in (("pid_gain", STILL), ("i_range", (0.0, 0.0)))
            },
            "publish_odom": False,
            "publish_odom_tf": False,
            "publish_wheel_tf": False,
            "publish_distance": False,
            "publish_steerangle": False,
            **_ODOMETRY_OF_CLASSIC,
        },
        joints=(*_CAR, "steering_wheel_joint"),
        topics={
            **_DRIVE_OF_CLASSIC,
            "distance": Topic("std_msgs/Float32", "distance", when="publish_distance"),
            "steerangle": Topic("std_msgs/Float32", "steerangle", when="publish_steerangle"),
        },
    ),
    "gazebo_ros_bumper": GazeboPlugin(parameters={"ros": None, "frame_name": "world"}),
    "gazebo_ros_camera": GazeboPlugin(
        parameters={
            **dict.fromkeys(("ros", "camera_name", "frame_name", "cx", "cy")),
            "focal_length": 0.0,
            "hack_baseline": 0.0,
            "border_crop": True,
            "rectification_matrix": (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
            **dict.fromkeys(("P_fx", "P_fy", "P_cx", "P_cy", "Tx")),
            "Ty": 0.0,
            "min_depth": 0.4,
            "max_depth": math.inf,
            "triggered": False,
        },
        not_simulated=("border_crop",),  # lenses do not distort
    ),
    "gazebo_ros_diff_drive": GazeboPlugin(
        parameters={
            **dict.fromkeys((*TWO_WHEELS, "ros")),
            "num_wheel_pairs": 1.0,
            "wheel_separation": 0.34,
            "wheel_diameter": 0.15,
            "max_wheel_torque": 5.0,
            "max_wheel_acceleration": 0.0,
            "update_rate": 100.0,
            "publish_odom": False,
            "publish_odom_tf": False,
            "publish_wheel_tf": False,
            "odometry_source": 1.0,
            **_ODOMETRY_OF_CLASSIC,
        },
        joints=TWO_WHEELS,
        required=TWO_WHEELS,
        topics=_DRIVE_OF_CLASSIC,
    ),
    "gazebo_ros_ft_sensor": GazeboPlugin(
        parameters={
            "ros": None,
            "update_rate": 0.0,
            "gaussian_noise": 0.0,
            "joint_name": None,
            "body_name": None,
            "frame_name": None,
        },
        joints=("joint_name",),
        links=("body_name",),
        topics={"wrench": Topic("geometry_msgs/WrenchStamped", "wrench")},
    ),
    "gazebo_ros_gps_sensor": GazeboPlugin(parameters=dict.fromkeys(("ros", "frame_name"))),
    "gazebo_ros_imu_sensor": GazeboPlugin(
        parameters={"ros": None, "frame_name": None, "initial_orientation_as_reference": False}
    ),
    "gazebo_ros_joint_pose_trajectory": GazeboPlugin(
        parameters={"ros": None, "update_rate": 100.0},
        topics={
            "command": Topic(
                "trajectory_msgs/JointTrajectory", "set_joint_trajectory", is_read=True
            )
        },
    ),
    "gazebo_ros_joint_state_publisher": GazeboPlugin(
        parameters={"ros": None, "update_rate": 100.0, "joint_name": None},
        joints=("joint_name",),
        required=("joint_name",),
        topics={"states": Topic("sensor_msgs/JointState", "joint_states")},
    ),
    "gazebo_ros_p3d": GazeboPlugin(
        parameters={
            "ros": None,
            "update_rate": 0.0,
            "gaussian_noise": 0.0,
            "body_name": None,
            "frame_name": "world",
            **dict.fromkeys(("xyz_offset", "rpy_offset", "xyz_offsets", "rpy_offsets"), STILL),
        },
        links=("body_name",),
        required=("body_name",),
        topics={"odometry": _ODOM._replace(when="")},
    ),
    "gazebo_ros_planar_move": GazeboPlugin(
        parameters={
            "ros": None,
            "update_rate": 20.0,
            "publish_rate": 20.0,
            "publish_odom": True,
            "publish_odom_tf": True,
            **_ODOMETRY_OF_CLASSIC,
        },
        topics={
            **_COMMAND_OF_CLASSIC,
            "odometry": _ODOM,
            "tf": _TF._replace(when="publish_odom_tf"),
        },
    ),
    "gazebo_ros_ray_sensor": GazeboPlugin(
        parameters={
            "ros": None,
            "frame_name": None,
            "output_type": "sensor_msgs/PointCloud2",
            "radiation_type": "infrared",
            "min_intensity": 0.0,
        }
    ),
    "gazebo_ros_state": GazeboPlugin(
        parameters={"ros": None, "update_rate": 100.0},
        topics={
            "models": Topic("gazebo_msgs/ModelStates", "model_states"),
            "links": Topic("gazebo_msgs/LinkStates", "link_states"),
        },
    ),
    "gazebo_ros_tricycle_drive": GazeboPlugin(joints=_TRICYCLE, topics=_COMMAND_OF_CLASSIC),
    "gazebo_ros_force": GazeboPlugin(links=("link_name",)),
    "gazebo_ros2_control": _CONTROL._replace(needs=()),
    **dict.fromkeys(("gz_ros2_control-system", "ign_ros2_control-system"), _CONTROL),
    "ackermann-steering": GazeboPlugin(
        parameters={
            **dict.fromkeys((*TWO_WHEELS, *_STEERING, "topic")),
            "wheel_separation": 1.0,
            "kingpin_width": 0.8,
            "wheel_base": 1.0,
            "wheel_radius": 0.2,
            "steering_limit": 0.5,
            "steer_p_gain": 1.0,
            "steering_only": False,
            **_ACTUATORS,
            **_bounds(""),
            **_ODOMETRY_OF_SIM,
        },
        joints=(*TWO_WHEELS, *_STEERING),
        topics={
            **{
                use: topic._replace(when="-steering_only -use_actuator_msg")
                for use, topic in _DRIVE_OF_SIM.items()
            },
            "angle": Topic(
                *("Double", "/model/{model}/steer_angle", "topic"),
                is_read=True,
                when="steering_only -use_actuator_msg",
            ),
            "actuators": _BY_ACTUATORS,
        },
        needs=_PHYSICS,
    ),
    "apply-joint-force": GazeboPlugin(
        parameters={"joint_name": None},
        joints=("joint_name",),
        required=("joint_name",),
        topics={
            "command": Topic("Double", "/model/{model}/joint/{joint_name}/cmd_force", is_read=True)
        },
        needs=_PHYSICS,
    ),
    "diff-drive": GazeboPlugin(
        parameters={
            **dict.fromkeys((*TWO_WHEELS, "topic")),
            "wheel_separation": 1.0,
            "wheel_radius": 0.2,
            **_bounds("", "linear_", "angular_"),
            **_ODOMETRY_OF_SIM,
        },
        joints=TWO_WHEELS,
        required=TWO_WHEELS,
        topics={
            **_DRIVE_OF_SIM,
            "enable": Topic("Boolean", "/model/{model}/enable", is_read=True),
        },
        needs=_PHYSICS,
    ),
    "joint-controller": GazeboPlugin(
        parameters={
            "joint_name": None,
            "topic": None,
            "initial_velocity": 0.0,
            "use_force_commands": False,
            **_gains(1.0, 0.0, 0.0),
            **_ACTUATORS,
        },
        joints=("joint_name",),
        required=("joint_name",),
        topics=_command_of_joint("cmd_vel"),
        needs=_PHYSICS,
    ),
    "joint-position-controller": GazeboPlugin(
        parameters={
            "joint_name": None,
            "topic": None,
            "joint_index": 0,
            "initial_position": 0.0,
            "use_velocity_commands": False,
            **_gains(1.0, 0.1, 0.01),
            **_ACTUATORS,
        },
        joints=("joint_name",),
        required=("joint_name",),
        topics=_command_of_joint("{joint_index}/cmd_pos"),
        needs=_PHYSICS,
    ),
    "joint-state-publisher": GazeboPlugin(
        parameters={"joint_name": None, "topic": None, "update_rate": 0.0},
        joints=("joint_name",),
        topics={
            "states": Topic("Model", "/world/{world}/model/{model}/joint_state", "topic"),
        },
        needs=_PHYSICS,
    ),
    "joint-trajectory-controller": GazeboPlugin(
        parameters={
            "joint_name": None,
            "topic": None,
            "initial_position": 0.0,
            **{
                f"{kind}_{name}": default
                for kind in ("position", "velocity")
                for name, default in _GAINS_OF_TRAJECTORY.items()
            },
        },
        joints=("joint_name",),
        topics={
            "command": Topic(
                "JointTrajectory", "/model/{model}/joint_trajectory", "topic", is_read=True
            ),
            "progress": Topic(
                "Float", "/model/{model}/joint_trajectory", "topic", suffix="_progress"
            ),
        },
        needs=_PHYSICS,
    ),
    "linearbatteryplugin": GazeboPlugin(
        parameters={
            **dict.fromkeys(("battery_name", "voltage", "initial_charge")),
            **dict.fromkeys(
                (
                    *("open_circuit_voltage_constant_coef", "open_circuit_voltage_linear_coef"),
                    *("capacity", "resistance", "power_load", "charging_time"),
                ),
                0.0,
            ),
            "smooth_current_tau": 1.0,
            "fix_issue_225": False,
            "invert_current_sign": False,
            "start_draining": False,
            "enable_recharge": False,
            "recharge_by_topic": None,
            **dict.fromkeys(("power_draining_topic", "stop_power_draining_topic")),
        },
        required=("battery_name", "voltage", "capacity"),
        topics={
            "state": Topic("BatteryState", "/model/{model}/battery/{battery_name}/state"),
            **{
                use: Topic(
                    *("Boolean", f"/model/{{model}}/battery/{{battery_name}}/recharge/{use}"),
                    is_read=True,
                    when="enable_recharge recharge_by_topic",
                )
                for use in ("start", "stop")
            },
        },
    ),
    "mecanum-drive": GazeboPlugin(
        parameters={
            **dict.fromkeys((*_MECANUM, "topic")),
            "wheel_separation": 1.0,
            "wheelbase": 1.0,
            "wheel_radius": 0.2,
            **_bounds(""),
            **_ODOMETRY_OF_SIM,
        },
        joints=_MECANUM,
        topics=_DRIVE_OF_SIM,
        needs=_PHYSICS,
    ),
    "odometry-publisher": GazeboPlugin(
        parameters={
            "odom_frame": "{model}/odom",
            "robot_base_frame": "{model}/base_footprint",
            **dict.fromkeys(("odom_topic", "odom_covariance_topic", "tf_topic")),
            "odom_publish_frequency": 50.0,
            "dimensions": 2.0,
            "gaussian_noise": 0.0,
            "xyz_offset": STILL,
            "rpy_offset": STILL,
        },
        topics={
            "odometry": _DRIVE_OF_SIM["odometry"],
            "covariance": Topic(
                *("OdometryWithCovariance", "/model/{model}/odometry_with_covariance"),
                "odom_covariance_topic",
            ),
            "tf": Topic("Pose_V", "/model/{model}/pose", "tf_topic"),
        },
    ),
    "pose-publisher": GazeboPlugin(
        parameters={
            "topic": None,
            "update_frequency": -1.0,
            "static_update_frequency": None,
            "use_pose_vector_msg": False,
            "static_publisher": False,
            # <publish_model_pose> is <publish_nested_model_pose> where it is not written.
            "publish_link_pose": True,
            "publish_model_pose": None,
            **dict.fromkeys(
                (
                    *("publish_nested_model_pose", "publish_visual_pose"),
                    *("publish_collision_pose", "publish_sensor_pose"),
                ),
                False,
            ),
        },
        topics={
            "poses": _POSE,
            "static": _STATIC,
            "pose": _POSE._replace(type="Pose", when="-use_pose_vector_msg"),
            "single static": _STATIC._replace(
                type="Pose", when="static_publisher -use_pose_vector_msg"
            ),
        },
    ),
    "velocity-control": GazeboPlugin(
        parameters={
            "topic": None,
            "link_name": None,
            "initial_linear": STILL,
            "initial_angular": STILL,
        },
        links=("link_name",),
        topics={"command": _COMMAND_OF_SIM},
        needs=_PHYSICS,
    ),
    # What wsgen does not simulate.
    "multicopter-motor-model": GazeboPlugin(joints=("jointName",), links=("linkName",)),
    "thruster": GazeboPlugin(joints=("joint_name",), required=("joint_name",)),
    "opticaltactileplugin": GazeboPlugin(needs=("Contact", "Sensors")),
    "touchplugin": GazeboPlugin(needs=("Contact",)),
    "thermal-sensor": GazeboPlugin(needs=("Sensors",)),
    "camera-video-recorder": GazeboPlugin(needs=("Sensors",)),
}


def stem(filename: str) -> str:
    """A plugin's file name without what the systems and generations put around it.

    `libgazebo_ros_camera.so` is `gazebo_ros_camera`, `ignition-gazebo-imu-system` is `imu`.
    """
    name = filename.rpartition("/")[2].removesuffix(".so").removesuffix(".dll")
    if name.startswith("lib") and name != "lib":
        name = name[3:]
    for prefix in ("gz-sim-", "ignition-gazebo-"):
        if name.startswith(prefix) and name.endswith("-system"):
            return name[len(prefix) : -len("-system")]
    return name


def node_name(text: str) -> str:
    """A name that ROS takes for a node: Gazebo Sim's plugins are called as their classes."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", text)
    return f"_{name}" if name[:1].isdigit() else name or "gazebo"


# Libraries that carry a model in water or air: those of gz-sim, Gazebo Classic, uuv_simulator, vrx
# and asv_wave_sim.
_CARRIES = lazy_pattern(
    r"(?i)buoyan|uuv_underwater_object|usv_gazebo_dynamics|lighter_than_air|^surface$"
    r"|^hydrodynamicsplugin$|^gz-waves\d*-hydrodynamics"
)


def carries(filename: str) -> bool:
    """Whether a plugin of a model carries it in water or air."""
    return _CARRIES.search(stem(filename)) is not None


def carried_by(robot: Robot, world: World | None) -> str | None:
    """The file name of the plugin that carries a robot in water or air, if one does.

    Gazebo Sim's system for buoyancy carries all models of its world.
    """
    own = (one.filename for tag in robot.gazebo for one in tag.plugins if carries(one.filename))
    of_world = () if world is None else world.plugins
    return next(iter((*own, *(one for one in of_world if stem(one) == "buoyancy"))), None)


def simulator_of(filename: str) -> str | None:
    """The simulator whose plugin it is, by its name; None where that does not show it."""
    name = filename.rpartition("/")[2].removeprefix("lib")
    if name.startswith(("gz-sim", "ignition-gazebo", "gz_ros2_control", "ign_ros2_control")):
        return SIM
    return CLASSIC if name.startswith(("gazebo_ros_", "gazebo_ros2_control")) else None
