"""Robots and models for Gazebo Classic become such for Gazebo Sim; nothing else changes."""

# ruff: noqa: E501  elements as people write them

from __future__ import annotations

import re
from pathlib import Path
from textwrap import dedent
from typing import TYPE_CHECKING

import pytest

from wsgen.checks.fixes.source import SourceText, apply, overlap
from wsgen.checks.rules.check import check_robot
from wsgen.checks.rules.node_topics import topics_of
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.diagnostics import Severity
from wsgen.model.target import choose_target
from wsgen.porting.models import (
    bridge_rows,
    find_followers,
    find_paints,
    plugins_of,
    port_model,
)
from wsgen.porting.porter import Follower, Mounted, Robots
from wsgen.text.xmltree import Malformed, parse

if TYPE_CHECKING:
    from wsgen.model.target import Target

JAZZY, KILTED = choose_target("jazzy", "gz"), choose_target("kilted", "gz")
FILE = Path("robot.urdf.xacro")

DIFF_DRIVE = """
<robot>
  <gazebo>
    <!-- how it drives -->
    <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <ros>
        <namespace>demo</namespace>
        <!-- <remapping>cmd_vel:=other</remapping> -->
        <remapping>odom:=wheel_odom</remapping>
      </ros>
      <update_rate>30</update_rate>
      <left_joint>${prefix}left</left_joint>  <!-- seen from behind -->
      <right_joint>${prefix}right</right_joint>

      <wheel_separation>0.5</wheel_separation>
      <wheel_diameter>${2*radius}</wheel_diameter>

      <max_wheel_torque>20</max_wheel_torque>
      <max_wheel_acceleration>1.5</max_wheel_acceleration>
      <command_topic>cmd_vel</command_topic>
      <odometry_source>0</odometry_source>
      <publish_odom>true</publish_odom>
      <publish_odom_tf>true</publish_odom_tf>
      <odometry_frame>odom</odometry_frame>
      <robot_base_frame>base_link</robot_base_frame>
    </plugin>
  </gazebo>
</robot>
"""
DIFF_DRIVE_AFTER = """
<robot>
  <gazebo>
    <!-- how it drives -->
    <plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system">
      <!-- <remapping>cmd_vel:=other</remapping> -->
      <left_joint>${prefix}left</left_joint>  <!-- seen from behind -->
      <right_joint>${prefix}right</right_joint>

      <wheel_separation>0.5</wheel_separation>
      <wheel_radius>${radius}</wheel_radius>

      <max_linear_acceleration>1.5</max_linear_acceleration>
      <min_linear_acceleration>-1.5</min_linear_acceleration>
      <max_angular_acceleration>6</max_angular_acceleration>
      <min_angular_acceleration>-6</min_angular_acceleration>
      <topic>/demo/cmd_vel</topic>
      <odom_topic>/demo/wheel_odom</odom_topic>
      <tf_topic>/tf</tf_topic>
      <frame_id>odom</frame_id>
      <child_frame_id>base_link</child_frame_id>
      <odom_publish_frequency>30</odom_publish_frequency>
    </plugin>
  </gazebo>
</robot>
"""
SKID_STEER_OF_ROS_1 = """
<robot>
	<gazebo>
		<plugin name="skid" filename="libgazebo_ros_skid_steer_drive.so">
			<robotNamespace>/</robotNamespace>
			<updateRate>50</updateRate>
			<leftFrontJoint>fl</leftFrontJoint>
			<rightFrontJoint>fr</rightFrontJoint>
			<leftRearJoint>rl</leftRearJoint>
			<rightRearJoint>rr</rightRearJoint>
			<wheelSeparation>0.4</wheelSeparation>
			<wheelDiameter>0.2</wheelDiameter>
			<commandTopic>cmd</commandTopic>
			<broadcastTF>false</broadcastTF>
		</plugin>
	</gazebo>
</robot>
"""
SKID_STEER_AFTER = """
<robot>
	<gazebo>
		<plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system">
			<left_joint>fl</left_joint>
			<right_joint>fr</right_joint>
			<left_joint>rl</left_joint>
			<right_joint>rr</right_joint>
			<wheel_separation>0.4</wheel_separation>
			<wheel_radius>0.1</wheel_radius>
			<topic>/cmd</topic>
		</plugin>
		<plugin filename="gz-sim-odometry-publisher-system" name="gz::sim::systems::OdometryPublisher">
			<odom_topic>/odom</odom_topic>
			<odom_frame>odom</odom_frame>
			<robot_base_frame>base_footprint</robot_base_frame>
			<odom_publish_frequency>50</odom_publish_frequency>
		</plugin>
	</gazebo>
</robot>
"""


def in_robot(text: str) -> str:
    """A robot with this in it."""
    inner = "".join(f"  {line}\n" for line in dedent(text).strip().splitlines())
    return f"<robot>\n{inner}</robot>\n"


def in_link(text: str) -> str:
    """A robot with this for a link."""
    inner = "".join(f"  {line}\n" for line in dedent(text).strip().splitlines())
    return in_robot(f'<gazebo reference="camera_link">\n{inner}</gazebo>')


# What is ported -> what becomes of it, and its topics of ROS with their types, and of Gazebo if
# these are others.
PLUGINS = {
    "joint states": (
        """
        <gazebo>
          <plugin name="states" filename="libgazebo_ros_joint_state_publisher.so">
            <ros><remapping>~/out:=joint_states</remapping></ros>
            <joint_name>a</joint_name>
          </plugin>
        </gazebo>
        """,
        """
        <gazebo>
          <plugin name="gz::sim::systems::JointStatePublisher" filename="gz-sim-joint-state-publisher-system">
            <joint_name>a</joint_name>
            <update_rate>100</update_rate>
            <topic>/joint_states</topic>
          </plugin>
        </gazebo>
        """,
        ["/joint_states sensor_msgs/msg/JointState"],
    ),
    "planar move": (
        """
        <gazebo>
          <plugin name="move" filename="libgazebo_ros_planar_move.so"/>
        </gazebo>
        """,
        """
        <gazebo>
          <plugin name="gz::sim::systems::VelocityControl" filename="gz-sim-velocity-control-system">
            <topic>/cmd_vel</topic>
          </plugin>
          <plugin filename="gz-sim-odometry-publisher-system" name="gz::sim::systems::OdometryPublisher">
            <odom_topic>/odom</odom_topic>
            <tf_topic>/tf</tf_topic>
            <odom_frame>odom</odom_frame>
            <robot_base_frame>base_footprint</robot_base_frame>
            <odom_publish_frequency>20</odom_publish_frequency>
          </plugin>
        </gazebo>
        """,
        [
            "/cmd_vel geometry_msgs/msg/Twist",
            "/odom nav_msgs/msg/Odometry",
            "/tf tf2_msgs/msg/TFMessage",
        ],
    ),
    "p3d": (
        """
        <gazebo>
          <plugin name="truth" filename="libgazebo_ros_p3d.so">
            <ros>
              <namespace>$(arg ns)</namespace>
              <remapping>odom:=truth</remapping>
            </ros>
            <body_name>base_link</body_name>
            <xyz_offsets>0 0 1</xyz_offsets>
            <update_rate>10</update_rate>
          </plugin>
        </gazebo>
        """,
        """
        <gazebo>
          <plugin name="gz::sim::systems::OdometryPublisher" filename="gz-sim-odometry-publisher-system">
            <robot_base_frame>base_link</robot_base_frame>
            <xyz_offset>0 0 1</xyz_offset>
            <odom_publish_frequency>10</odom_publish_frequency>
            <odom_frame>world</odom_frame>
            <odom_topic>$(arg ns)/truth</odom_topic>
            <dimensions>3</dimensions>
          </plugin>
        </gazebo>
        """,
        None,
    ),
    "ros2_control": (
        """
        <ros2_control name="system" type="system">
          <hardware>
            <!-- gazebo_ros2_control/GazeboSystem -->
            <plugin>gazebo_ros2_control/GazeboSystem</plugin>
          </hardware>
        </ros2_control>
        <gazebo>
          <plugin filename="libgazebo_ros2_control.so" name="gazebo_ros2_control">
            <robot_sim_type>gazebo_ros2_control/GazeboSystem</robot_sim_type>
            <robot_param_node>/demo/robot_state_publisher</robot_param_node>
            <parameters>$(find demo)/config/controllers.yaml</parameters>
          </plugin>
        </gazebo>
        """,
        """
        <ros2_control name="system" type="system">
          <hardware>
            <!-- gazebo_ros2_control/GazeboSystem -->
            <plugin>gz_ros2_control/GazeboSimSystem</plugin>
          </hardware>
        </ros2_control>
        <gazebo>
          <plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin">
            <parameters>$(find demo)/config/controllers.yaml</parameters>
          </plugin>
        </gazebo>
        """,
        [],
    ),
    "ros2_control of Fortress": (
        """
        <plugin>ign_ros2_control/IgnitionSystem</plugin>
        <gazebo>
          <plugin filename="libign_ros2_control-system.so" name="ign_ros2_control::IgnitionROS2ControlPlugin"/>
        </gazebo>
        """,
        """
        <plugin>gz_ros2_control/GazeboSimSystem</plugin>
        <gazebo>
          <plugin filename="gz_ros2_control-system" name="gz_ros2_control::GazeboSimROS2ControlPlugin"/>
        </gazebo>
        """,
        [],
    ),
    "force and torque": (
        """
        <joint name="wrist" type="revolute">
          <child link="hand"/>
        </joint>
        <gazebo>
          <plugin name="ft" filename="libgazebo_ros_ft_sensor.so">
            <update_rate>50</update_rate>
            <joint_name>wrist</joint_name>
          </plugin>
        </gazebo>
        """,
        """
        <joint name="wrist" type="revolute">
          <child link="hand"/>
        </joint>
        <gazebo reference="wrist">
          <sensor name="ft" type="force_torque">
            <always_on>true</always_on>
            <update_rate>50</update_rate>
            <topic>/wrench</topic>
            <gz_frame_id>hand</gz_frame_id>
            <force_torque>
              <frame>child</frame>
              <measure_direction>child_to_parent</measure_direction>
            </force_torque>
          </sensor>
        </gazebo>
        """,
        ["/wrench geometry_msgs/msg/WrenchStamped"],
    ),
    "drive of a robot for both simulators": (
        """
        <gazebo>
          <plugin name="a" filename="libgazebo_ros_diff_drive.so">
            <left_joint>a</left_joint>
          </plugin>
          <plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system"/>
        </gazebo>
        """,
        """
        <gazebo>
          <plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system"/>
        </gazebo>
        """,
        [],
    ),
    "material": (
        """
        <gazebo reference="base_link">
          <mu1>0.2</mu1>
          <material>Gazebo/Grey</material>
        </gazebo>
        """,
        """
        <gazebo reference="base_link">
          <mu1>0.2</mu1>
          <visual>
            <material>
              <ambient>0.3 0.3 0.3 1</ambient>
              <diffuse>0.7 0.7 0.7 1</diffuse>
              <specular>0.01 0.01 0.01 1</specular>
            </material>
          </visual>
        </gazebo>
        """,
        [],
    ),
    "script of a material": (
        """
        <visual name="v">
          <material>
            <script>
              <uri>file://media/materials/scripts/gazebo.material</uri>
              <name>Gazebo/Orange</name>
            </script>
            <ambient>1 0 0 1</ambient>
          </material>
        </visual>
        """,
        """
        <visual name="v">
          <material>
            <diffuse>1 0.5088 0.0468 1</diffuse>
            <specular>0.5 0.5 0.5 1</specular>
            <ambient>1 0 0 1</ambient>
          </material>
        </visual>
        """,
        [],
    ),
}
WHEELS = """
<model name="m">
  <joint name="left" type="revolute">
    <axis>
      <xyz>0 1 0</xyz>
    </axis>
  </joint>
  <joint name="right" type="revolute">
    <axis>
      <limit><effort>1</effort></limit>
    </axis>
  </joint>
  <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
    <left_joint>left</left_joint>
    <right_joint>right</right_joint>
    <wheel_separation>1</wheel_separation>
    <wheel_diameter>1</wheel_diameter>
    <max_wheel_torque>20</max_wheel_torque>
  </plugin>
</model>
"""
WHEELS_AFTER = """
<model name="m">
  <joint name="left" type="revolute">
    <axis>
      <xyz>0 1 0</xyz>
      <limit>
        <effort>20</effort>
      </limit>
    </axis>
  </joint>
  <joint name="right" type="revolute">
    <axis>
      <limit><effort>20</effort></limit>
    </axis>
  </joint>
  <plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system">
    <left_joint>left</left_joint>
    <right_joint>right</right_joint>
    <wheel_separation>1</wheel_separation>
    <wheel_radius>0.5</wheel_radius>
    <topic>/cmd_vel</topic>
  </plugin>
</model>
"""
SOURCES = """
<robot>
  <gazebo>
    <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <left_joint>left</left_joint>
      <right_joint>right</right_joint>
      <wheel_separation>1</wheel_separation>
      <wheel_diameter>1</wheel_diameter>
      <publish_odom>true</publish_odom>
      <xacro:if value="${source == 'world'}">
        <odometry_source>1</odometry_source>
      </xacro:if>
      <xacro:unless value="${source == 'world'}">
        <odometry_source>0</odometry_source>
      </xacro:unless>
    </plugin>
  </gazebo>
</robot>
"""
SOURCES_AFTER = """
<robot>
  <gazebo>
    <plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system">
      <left_joint>left</left_joint>
      <right_joint>right</right_joint>
      <wheel_separation>1</wheel_separation>
      <wheel_radius>0.5</wheel_radius>
      <xacro:if value="${source == 'world'}">
      </xacro:if>
      <xacro:unless value="${source == 'world'}">
        <odom_topic>/odom</odom_topic>
        <frame_id>odom</frame_id>
        <child_frame_id>base_footprint</child_frame_id>
        <odom_publish_frequency>100</odom_publish_frequency>
      </xacro:unless>
      <topic>/cmd_vel</topic>
    </plugin>
    <xacro:if value="${source == 'world'}">
      <plugin filename="gz-sim-odometry-publisher-system" name="gz::sim::systems::OdometryPublisher">
        <odom_topic>/odom</odom_topic>
        <odom_frame>odom</odom_frame>
        <robot_base_frame>base_footprint</robot_base_frame>
        <odom_publish_frequency>100</odom_publish_frequency>
      </plugin>
    </xacro:if>
  </gazebo>
</robot>
"""
SENSORS = {
    "imu": (
        """
        <sensor name="imu" type="imu">
          <topic>__default_topic__</topic>
          <plugin name="imu_plugin" filename="libgazebo_ros_imu_sensor.so"/>
        </sensor>
        """,
        """
        <sensor name="imu" type="imu">
          <topic>/imu_plugin/out</topic>
          <imu>
            <orientation_reference_frame>
              <localization>ENU</localization>
            </orientation_reference_frame>
          </imu>
          <gz_frame_id>camera_link</gz_frame_id>
        </sensor>
        """,
        ["/imu_plugin/out sensor_msgs/msg/Imu"],
    ),
    "scan": (
        """
        <sensor name="lidar" type="ray">
          <ray><range><max>5</max></range></ray>
          <plugin name="scan" filename="libgazebo_ros_ray_sensor.so">
            <ros><remapping>~/out:=scan</remapping></ros>
            <output_type>sensor_msgs/LaserScan</output_type>
            <frame_name>laser</frame_name>
          </plugin>
        </sensor>
        """,
        """
        <sensor name="lidar" type="gpu_lidar">
          <lidar><range><max>5</max></range></lidar>
          <topic>/scan</topic>
          <gz_frame_id>laser</gz_frame_id>
        </sensor>
        """,
        ["/scan sensor_msgs/msg/LaserScan"],
    ),
    "cloud": (
        """
        <sensor name="lidar" type="gpu_ray">
          <plugin name="velodyne" filename="libgazebo_ros_ray_sensor.so"/>
        </sensor>
        """,
        """
        <sensor name="lidar" type="gpu_lidar">
          <topic>/velodyne/out</topic>
          <gz_frame_id>camera_link</gz_frame_id>
        </sensor>
        """,
        ["/velodyne/out sensor_msgs/msg/PointCloud2 /velodyne/out/points"],
    ),
    "cloud that is called points": (
        """
        <sensor name="lidar" type="gpu_ray">
          <plugin name="velodyne" filename="libgazebo_ros_ray_sensor.so">
            <ros><remapping>~/out:=/velodyne/points</remapping></ros>
          </plugin>
        </sensor>
        """,
        """
        <sensor name="lidar" type="gpu_lidar">
          <topic>/velodyne</topic>
          <gz_frame_id>camera_link</gz_frame_id>
        </sensor>
        """,
        ["/velodyne/points sensor_msgs/msg/PointCloud2"],
    ),
    "laser of ROS 1": (
        """
        <sensor name="lidar" type="gpu_ray">
          <plugin name="x" filename="libgazebo_ros_gpu_laser.so">
            <topicName>front/scan</topicName>
            <frameName>laser</frameName>
          </plugin>
        </sensor>
        """,
        """
        <sensor name="lidar" type="gpu_lidar">
          <topic>/front/scan</topic>
          <gz_frame_id>laser</gz_frame_id>
        </sensor>
        """,
        ["/front/scan sensor_msgs/msg/LaserScan"],
    ),
    "camera": (
        """
        <sensor name="cam" type="camera">
          <camera/>
          <plugin name="controller" filename="libgazebo_ros_camera.so">
            <camera_name>front</camera_name>
            <frame_name>optical</frame_name>
          </plugin>
        </sensor>
        """,
        """
        <sensor name="cam" type="camera">
          <camera/>
          <topic>/front/image_raw</topic>
          <gz_frame_id>optical</gz_frame_id>
        </sensor>
        """,
        ["/front/image_raw sensor_msgs/msg/Image", "/front/camera_info sensor_msgs/msg/CameraInfo"],
    ),
    "camera with its image elsewhere": (
        """
        <sensor name="cam" type="camera">
          <camera>
            <horizontal_fov>1</horizontal_fov>
          </camera>
          <plugin name="controller" filename="libgazebo_ros_camera.so">
            <ros>
              <namespace>a</namespace>
              <remapping>cam/image_raw:=image</remapping>
            </ros>
          </plugin>
        </sensor>
        """,
        """
        <sensor name="cam" type="camera">
          <camera>
            <horizontal_fov>1</horizontal_fov>
            <camera_info_topic>/a/cam/camera_info</camera_info_topic>
          </camera>
          <topic>/a/image</topic>
          <gz_frame_id>camera_link</gz_frame_id>
        </sensor>
        """,
        ["/a/image sensor_msgs/msg/Image", "/a/cam/camera_info sensor_msgs/msg/CameraInfo"],
    ),
    "depth camera": (
        """
        <sensor name="cam" type="depth">
          <camera>
            <clip><near>0.1</near><far>10</far></clip>
          </camera>
          <plugin name="controller" filename="libgazebo_ros_camera.so">
            <max_depth>3</max_depth>
          </plugin>
        </sensor>
        """,
        """
        <sensor name="cam" type="rgbd_camera">
          <camera>
            <clip><near>0.1</near><far>10</far></clip>
            <depth_camera>
              <clip>
                <near>0.4</near>
                <far>3</far>
              </clip>
            </depth_camera>
          </camera>
          <topic>/cam</topic>
          <gz_frame_id>camera_link</gz_frame_id>
        </sensor>
        """,
        [
            "/cam/image_raw sensor_msgs/msg/Image /cam/image",
            "/cam/camera_info sensor_msgs/msg/CameraInfo",
            "/cam/depth/camera_info sensor_msgs/msg/CameraInfo /cam/camera_info",
            "/cam/depth/image_raw sensor_msgs/msg/Image /cam/depth_image",
            "/cam/points sensor_msgs/msg/PointCloud2",
        ],
    ),
    "bumper": (
        """
        <sensor name="bumper" type="contact">
          <contact>
            <collision>c</collision>
          </contact>
          <plugin name="bumper" filename="libgazebo_ros_bumper.so"/>
        </sensor>
        """,
        """
        <sensor name="bumper" type="contact">
          <contact>
            <collision>c</collision>
            <topic>/bumper_states</topic>
          </contact>
        </sensor>
        """,
        ["/bumper_states ros_gz_interfaces/msg/Contacts"],
    ),
    "gps": (
        """
        <sensor name="gps" type="gps">
          <gps/>
          <plugin name="gps" filename="libgazebo_ros_gps_sensor.so">
            <ros><remapping>~/out:=fix</remapping></ros>
          </plugin>
        </sensor>
        """,
        """
        <sensor name="gps" type="navsat">
          <navsat/>
          <topic>/fix</topic>
          <gz_frame_id>camera_link</gz_frame_id>
        </sensor>
        """,
        ["/fix sensor_msgs/msg/NavSatFix"],
    ),
    "several cameras": (
        """
        <sensor name="stereo" type="multicamera">
          <update_rate>10</update_rate>
          <camera name="left">
            <horizontal_fov>1</horizontal_fov>
          </camera>
          <camera name="right">
            <!-- seen from behind -->
            <pose>0 -0.1 0 0 0 0</pose>
          </camera>
          <plugin name="controller" filename="libgazebo_ros_camera.so">
            <frame_name>optical</frame_name>
          </plugin>
        </sensor>
        """,
        """
        <sensor name="stereo_left" type="camera">
          <update_rate>10</update_rate>
          <camera name="left">
            <horizontal_fov>1</horizontal_fov>
          </camera>
          <topic>/stereo/left/image_raw</topic>
          <gz_frame_id>optical</gz_frame_id>
        </sensor>
        <sensor name="stereo_right" type="camera">
          <update_rate>10</update_rate>
          <camera name="right">
            <!-- seen from behind -->
            <pose>0 -0.1 0 0 0 0</pose>
          </camera>
          <topic>/stereo/right/image_raw</topic>
          <gz_frame_id>optical</gz_frame_id>
        </sensor>
        """,
        [
            "/stereo/left/image_raw sensor_msgs/msg/Image",
            "/stereo/left/camera_info sensor_msgs/msg/CameraInfo",
            "/stereo/right/image_raw sensor_msgs/msg/Image",
            "/stereo/right/camera_info sensor_msgs/msg/CameraInfo",
        ],
    ),
    "sensor that is ready for Gazebo Sim": (
        """
        <sensor name="imu" type="imu">
          <topic>mine</topic>
          <gz_frame_id>imu_link</gz_frame_id>
          <imu><orientation_reference_frame/></imu>
          <plugin name="imu_plugin" filename="libgazebo_ros_imu_sensor.so"/>
        </sensor>
        """,
        """
        <sensor name="imu" type="imu">
          <topic>mine</topic>
          <gz_frame_id>imu_link</gz_frame_id>
          <imu><orientation_reference_frame/></imu>
        </sensor>
        """,
        ["/imu_plugin/out sensor_msgs/msg/Imu /mine"],
    ),
    "sensor without a plugin": (
        """
        <sensor name="lidar" type="ray">
          <topic>__default_topic__</topic>
          <ray/>
        </sensor>
        """,
        """
        <sensor name="lidar" type="gpu_lidar">
          <lidar/>
        </sensor>
        """,
        [],
    ),
}
CASES = {
    "diff drive": (DIFF_DRIVE, DIFF_DRIVE_AFTER, None),
    "torque of wheels": (WHEELS, WHEELS_AFTER, ["/cmd_vel geometry_msgs/msg/Twist"]),
    "sources of odometry": (SOURCES, SOURCES_AFTER, None),
    "skid steer of ROS 1": (
        SKID_STEER_OF_ROS_1,
        SKID_STEER_AFTER,
        ["/cmd geometry_msgs/msg/Twist", "/odom nav_msgs/msg/Odometry"],
    ),
    **{
        name: (in_robot(before), in_robot(after), topics)
        for name, (before, after, topics) in PLUGINS.items()
    },
    **{
        name: (in_link(before), in_link(after), topics)
        for name, (before, after, topics) in SENSORS.items()
    },
}


def ported(text: str, target: Target = JAZZY) -> str:
    """The text after the port, of which no edit touches another one."""
    port = port_model(SourceText(FILE, text), target)
    for place, edit in enumerate(port.edits):
        assert not overlap([edit], port.edits[:place]), edit
    return apply(text, port.edits)


@pytest.mark.parametrize("name", CASES)
def test_becomes(name: str) -> None:
    before, after, _ = CASES[name]
    assert ported(before) == after


@pytest.mark.parametrize("name", CASES)
def test_is_ported_once(name: str) -> None:
    port = port_model(SourceText(FILE, CASES[name][1]), JAZZY)
    assert (port.edits, port.unported) == ((), ())


@pytest.mark.parametrize(
    "name", [name for name, (_, _, topics) in CASES.items() if topics is not None]
)
def test_keeps_the_topics_of_ros(name: str) -> None:
    rows = bridge_rows(CASES[name][0], JAZZY)
    assert [
        f"{row.ros_topic} {row.ros_type}"
        + ("" if row.gz_topic == row.ros_topic else f" {row.gz_topic}")
        for row in rows
    ] == CASES[name][2]


@pytest.mark.parametrize(
    "name", [name for name, (before, _, _) in CASES.items() if "$" not in before]
)
def test_bridges_what_gazebo_has(name: str) -> None:
    root = parse(CASES[name][1])
    assert not isinstance(root, Malformed)
    there = {(one.name, one.type, one.is_published) for one in topics_of(root, "robot", "world")}
    for row in bridge_rows(CASES[name][0], JAZZY):
        assert (row.gz_topic, row.gz_type, row.direction == "[") in there


@pytest.mark.parametrize(
    "name", [name for name, (before, _, _) in CASES.items() if "$" not in before]
)
def test_a_robot_of_several_has_topics_of_its_own(name: str) -> None:
    before = CASES[name][0]
    links = re.findall('reference="(.*?)"', before)
    sensors = re.findall('<sensor name="(.*?)"', before)
    mounted = frozenset(Mounted(one, link, link) for one in sensors for link in links)
    robots = Robots(mounted=mounted, scoped=frozenset(plugins_of(before)))
    after = apply(before, port_model(SourceText(FILE, before), JAZZY, robots).edits)
    # As sdformat makes a model of it.
    holder = "joint" if "force_torque" in after else "link"
    model = re.sub(
        '<gazebo reference="(.*?)">(.*?)</gazebo>',
        rf'<{holder} name="\1">\2</{holder}>',
        after,
        flags=re.DOTALL,
    )
    root = parse(model)
    assert not isinstance(root, Malformed)
    there = {(one.name, one.type, one.is_published) for one in topics_of(root, "robot", "world")}
    rows = bridge_rows(before, JAZZY, robots, namespace="{namespace}")
    assert len(rows) == len(bridge_rows(before, JAZZY))
    for row in rows:
        own = row.gz_topic.format(model="robot", world="world")
        assert "/model/robot/" in own
        assert (own, row.gz_type, row.direction == "[") in there
        # Names that begin with a slash are the same for all robots.
        assert row.ros_topic.startswith(("/{namespace}/", "/tf", "/velodyne/"))


def test_a_namespace_that_contains_elements_is_none() -> None:
    text = SKID_STEER_OF_ROS_1.replace("<robotNamespace>/<", "<robotNamespace><a>b</a><")
    assert ported(text) == SKID_STEER_AFTER


def test_a_model_of_a_world_keeps_its_name() -> None:
    model = (
        """<model name="rover"><plugin name="p" filename="libgazebo_ros_planar_move.so"/></model>"""
    )
    robots = Robots(scoped=frozenset({("p", "libgazebo_ros_planar_move.so")}))
    for text, name in (
        (f"<sdf>{model}</sdf>", "{model}"),
        (f'<sdf><world name="w">{model}</world></sdf>', "rover"),
    ):
        assert bridge_rows(text, JAZZY, robots)[0].gz_topic == f"/model/{name}/cmd_vel"


def test_lists_a_second_plugin_for_the_same_topic() -> None:
    plugin = '<plugin name="p{}" filename="libgazebo_ros_p3d.so"><ros><namespace>{}</namespace></ros></plugin>'
    text = in_robot(f"<gazebo>{plugin.format(1, 'a')}{plugin.format(2, 'b')}</gazebo>")
    robots = Robots(scoped=frozenset({("p1", "libgazebo_ros_p3d.so")}))
    port = port_model(SourceText(FILE, text), JAZZY, robots)
    assert ["Two plugins" in one.what for one in port.unported] == [True]


def wheel(side: str) -> str:
    """A wheel with its joint."""
    return f"""
  <link name="{side}_wheel">
    <inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><sphere radius="0.1"/></geometry></visual>
    <collision><geometry><sphere radius="0.1"/></geometry></collision>
  </link>
  <joint name="{side}" type="continuous">
    <parent link="camera_link"/>
    <child link="{side}_wheel"/>
    <origin xyz="0 {0.25 if side == "left" else -0.25} 0"/>
    <axis xyz="0 1 0"/>
  </joint>"""


def frame(name: str) -> str:
    """A link that is a frame alone."""
    return f"""
  <link name="{name}"/>
  <joint name="to_{name}" type="fixed">
    <parent link="camera_link"/>
    <child link="{name}"/>
  </joint>"""


WHOLE = f"""<robot name="whole">
  <link name="camera_link">
    <inertial><mass value="5"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.3 0.3 0.1"/></geometry></visual>
    <collision><geometry><box size="0.3 0.3 0.1"/></geometry></collision>
  </link>{wheel("left")}{wheel("right")}{"".join(map(frame, ("laser", "optical", "imu_link")))}
"""


@pytest.mark.parametrize("name", SENSORS)
def test_is_right_for_gazebo_sim(name: str) -> None:
    drive = re.sub(r"\$\{.*?\}(?=left|right)", "", DIFF_DRIVE).replace("${2*radius}", "0.2")
    parts = [re.sub("</?robot>", "", one) for one in (drive, CASES[name][0])]
    robot, found = read_urdf(ported("".join((WHOLE, *parts, "</robot>\n"))), file=FILE)
    assert robot is not None
    found = (*found, *check_robot(robot, FILE, simulator="gz", distro="jazzy"))
    wrong = [one for one in found if one.severity is not Severity.INFO]
    assert [one.message for one in wrong] == []


def test_keeps_the_line_ends() -> None:
    text = DIFF_DRIVE.replace("\n", "\r\n")
    assert ported(text) == DIFF_DRIVE_AFTER.replace("\n", "\r\n")


def test_names_the_frame_as_the_target_does() -> None:
    before, after, _ = CASES["scan"]
    assert ported(before, KILTED) == after.replace("gz_frame_id", "frame_id")


@pytest.mark.parametrize(
    ("written", "radius"),
    [
        ("0.3", "0.15"),
        ("${d}", "${d/2}"),
        ("${a + b}", "${(a + b)/2}"),
        ("${wheel_radius * 2.0}", "${wheel_radius}"),
        ("$(arg d)", "${float(xacro.arg('d'))/2}"),
    ],
)
def test_halves_the_diameter(written: str, radius: str) -> None:
    text = DIFF_DRIVE.replace("${2*radius}", written)
    assert f"<wheel_radius>{radius}</wheel_radius>" in ported(text)


def test_has_the_same_topics_before_and_after_xacro() -> None:
    text = in_link(
        """
        <sensor name="lidar" type="ray">
          <plugin name="scan" filename="libgazebo_ros_ray_sensor.so">
            <ros>
              <namespace>${ns}</namespace>
              <remapping>~/out:=${name}</remapping>
            </ros>
            <output_type>sensor_msgs/LaserScan</output_type>
          </plugin>
        </sensor>
        """
    )
    for values in (
        {"ns": "", "name": "scan"},
        {"ns": "a", "name": "b/scan"},
        {"ns": "/a", "name": "x"},
    ):

        def expanded(text: str, values: dict[str, str] = values) -> str:
            return re.sub(r"\$\{(\w+)\}", lambda found: values[found[1]], text)

        (row,) = bridge_rows(expanded(text), JAZZY)
        topic = re.search("<topic>(.*)</topic>", expanded(ported(text)))
        assert topic is not None
        assert f"/{topic[1].lstrip('/')}" == row.gz_topic == row.ros_topic


def test_bridges_commands_to_gazebo() -> None:
    text = """<robot><gazebo><plugin name="a" filename="{}"/></gazebo></robot>"""
    for stem, gz_type in {
        "planar_move": "Twist",
        "joint_pose_trajectory": "JointTrajectory",
    }.items():
        rows = bridge_rows(text.format(f"libgazebo_ros_{stem}.so"), JAZZY)
        assert [row.gz_type for row in rows if row.direction == "]"] == [gz_type]


CAMERA = """
<robot>
  <gazebo reference="{link}">
    <sensor name="{name}" type="camera">
      <plugin name="eye" filename="libgazebo_ros_camera.so"/>
    </sensor>
  </gazebo>
</robot>
"""


@pytest.mark.parametrize(
    ("link", "name", "mounted", "frame"),
    [
        ("eye", "cam", [], "eye"),
        ("eye", "cam", [("cam", "eye", "eye")], "eye"),
        ("eye", "cam", [("cam", "eye", "base"), ("scan", "laser", "top")], "base"),
        ("${p}eye", "cam", [("cam", "eye", "base")], "${p}base"),
        ("${p}eye", "cam", [("cam", "a/eye", "a/base"), ("cam", "b/eye", "b/base")], "${p}base"),
        ("${p}eye", "cam", [("cam", "eye", "eye"), ("scan", "laser_eye", "top")], "${p}eye"),
        ("${name}_link", "${name}", [("l", "l_link", "base"), ("r", "r_link", "base")], "base"),
        ("$(arg name)", "cam", [("cam", "eye", "base")], "base"),
    ],
)
def test_names_the_link_that_classic_has_lumped_the_one_of_a_sensor_into(
    link: str, name: str, mounted: list[tuple[str, str, str]], frame: str
) -> None:
    robots = Robots(mounted=frozenset(map(Mounted._make, mounted)))
    text = CAMERA.format(link=link, name=name)
    port = port_model(SourceText(FILE, text), JAZZY, robots)
    assert f"<gz_frame_id>{frame}</gz_frame_id>" in apply(text, port.edits)
    assert port.unported == ()


def test_lists_a_sensor_that_robots_have_on_different_links() -> None:
    mounted = {Mounted("cam", "eye", "base"), Mounted("cam", "eye", "head")}
    text = CAMERA.format(link="eye", name="cam")
    port = port_model(SourceText(FILE, text), JAZZY, Robots(mounted=frozenset(mounted)))
    assert ["was base or head" in one.what for one in port.unported] == [True]


def controlled(content: str, *, described: str = "", attribute: str = "") -> str:
    """A `<ros2_control>` with two fingers, and what else describes the second one."""
    return in_robot(
        f"""
        <joint name="${{p}}right" type="prismatic">{described}</joint>
        <ros2_control name="hand" type="system">
          <joint name="left">
            <command_interface name="position"/>
          </joint>
          <joint {attribute}name="right">{content}
            <state_interface name="position"/>
          </joint>
        </ros2_control>
        """
    )


COMMAND = '\n<command_interface name="position"/>'
FOLLOWS = '\n<param name="mimic">left</param>'
MIMIC = '\n    <mimic joint="left" multiplier="1"/>\n  '


@pytest.mark.parametrize(
    ("before", "followers", "after"),
    [
        (controlled(COMMAND + FOLLOWS), {"right": Follower("left", "")}, controlled("")),
        (controlled(COMMAND + FOLLOWS), {}, controlled("", described=MIMIC)),
        (
            controlled(COMMAND),
            {"right": Follower("${p}left", "2")},
            controlled(COMMAND, attribute='mimic="false" '),
        ),
        (
            controlled(""),
            {"right": Follower("other", "")},
            controlled("", attribute='mimic="false" '),
        ),
        (controlled(""), {"right": Follower("left", "")}, controlled("")),
        (controlled(COMMAND), {}, controlled(COMMAND)),
    ],
)
def test_has_joints_follow_others_as_in_classic(
    before: str, followers: dict[str, Follower], after: str
) -> None:
    port = port_model(SourceText(FILE, before), JAZZY, Robots(followers=followers))
    assert re.sub(r"\s+", " ", apply(before, port.edits)) == re.sub(r"\s+", " ", after)
    assert port.unported == ()


def test_finds_joints_that_follow_in_other_files() -> None:
    text = '<robot><joint name="${p}right"><mimic joint="left" multiplier="2"/></joint></robot>'
    assert [*find_followers(text)] == [("right", Follower("left", "2"))]


UNPORTED = {
    '<ros2_control><joint name="a"><param name="mimic">b</param></joint></ros2_control>': "It followed `b`",
    '<gazebo><plugin name="a" filename="libmy_plugin.so"/></gazebo>': "`libmy_plugin.so` is a plugin",
    '<gazebo><plugin name="a" filename="libgazebo_ros_tricycle_drive.so"/></gazebo>': "drives a",
    '<gazebo><plugin name="a" filename="${plugin}"/></gazebo>': "xacro computes the name",
    '<gazebo reference="a"><material>${color}</material></gazebo>': "xacro computes the name",
    '<gazebo reference="a"><material>Mine/Red</material></gazebo>': "script of the material `Mine/Red`",
    '<sensor name="a" type="sonar"><sonar/></sensor>': "sensors of the type sonar",
}


@pytest.mark.parametrize("text", UNPORTED)
def test_lists_what_it_cannot_port(text: str) -> None:
    (found,) = port_model(SourceText(FILE, f"<robot>\n{text}\n</robot>\n"), JAZZY).unported
    assert UNPORTED[text] in found.what
    assert (found.file, found.line) == (FILE, 2)


def test_makes_a_comment_of_what_has_no_counterpart() -> None:
    text = in_robot(
        """
        <gazebo>
          <plugin name="a" filename="libgazebo_ros_tricycle_drive.so">
            <!-- mine -->
            <steering_joint>a</steering_joint>
          </plugin>
        </gazebo>
        """
    )
    after = ported(text)
    assert (
        re.sub("<!--.*?-->|\\s", "", after, flags=re.DOTALL) == "<robot><gazebo></gazebo></robot>"
    )
    assert "<!-- mine -->" in after
    assert "<steering_joint>a</steering_joint>" in after


def test_names_the_systems_and_packages_that_are_needed() -> None:
    port = port_model(SourceText(FILE, CASES["imu"][0]), JAZZY)
    assert (port.systems, port.packages) == (frozenset({"Imu"}), frozenset())
    port = port_model(SourceText(FILE, CASES["ros2_control"][0]), JAZZY)
    assert (port.systems, port.packages) == (frozenset(), frozenset({"gz_ros2_control"}))


def test_leaves_plugins_of_worlds_alone() -> None:
    text = (
        '<sdf><world name="w"><plugin name="a" filename="libgazebo_ros_state.so"/></world></sdf>\n'
    )
    port = port_model(SourceText(FILE, text), JAZZY)
    assert (port.edits, port.unported) == ((), ())


PAIRS = """
<robot>
  <gazebo>
    <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <num_wheel_pairs>2</num_wheel_pairs>
      <left_joint>front_left</left_joint>
      <right_joint>front_right</right_joint>
      <left_joint>rear_left</left_joint>
      <right_joint>rear_right</right_joint>
      <wheel_separation>0.5</wheel_separation>
      <wheel_diameter>0.2</wheel_diameter>
      <max_wheel_acceleration>2</max_wheel_acceleration>
    </plugin>
  </gazebo>
</robot>
"""
PAIRS_AFTER = """
<robot>
  <gazebo>
    <plugin name="gz::sim::systems::DiffDrive" filename="gz-sim-diff-drive-system">
      <left_joint>front_left</left_joint>
      <right_joint>front_right</right_joint>
      <wheel_separation>0.5</wheel_separation>
      <wheel_radius>0.1</wheel_radius>
      <max_linear_acceleration>2</max_linear_acceleration>
      <min_linear_acceleration>-2</min_linear_acceleration>
      <max_angular_acceleration>8</max_angular_acceleration>
      <min_angular_acceleration>-8</min_angular_acceleration>
      <topic>/cmd_vel</topic>
    </plugin>
    <plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">
      <left_joint>rear_left</left_joint>
      <right_joint>rear_right</right_joint>
      <wheel_separation>0.34</wheel_separation>
      <wheel_radius>0.075</wheel_radius>
      <max_linear_acceleration>2</max_linear_acceleration>
      <min_linear_acceleration>-2</min_linear_acceleration>
      <max_angular_acceleration>11.76470588</max_angular_acceleration>
      <min_angular_acceleration>-11.76470588</min_angular_acceleration>
      <topic>/cmd_vel</topic>
    </plugin>
  </gazebo>
</robot>
"""


def test_a_pair_of_wheels_with_other_sizes_has_a_plugin_of_its_own() -> None:
    port = port_model(SourceText(FILE, PAIRS), JAZZY)
    assert apply(PAIRS, port.edits) == PAIRS_AFTER
    assert port.unported == ()
    sizes = "<wheel_separation>0.50</wheel_separation>\n      <wheel_diameter>0.2</wheel_diameter>"
    same = PAIRS.replace("    </plugin>", f"  {sizes}\n    </plugin>").replace(">0.5<", ">0.50<")
    assert apply(same, port_model(SourceText(FILE, same), JAZZY).edits).count("<plugin") == 1


SCRIPT = """
material Wall/Brick // of the house
{
  technique
  {
    pass
    {
      ambient 0.5 0.25 1.0 1.0
      diffuse 0.5 0.5 0.5 1.0
      specular 0.2 0.2 0.2 1.0 12.5
      texture_unit { texture brick.png }
      texture_unit
      {
        texture light.png
      }
    }
  }
}
material "Plain Red"
{
  diffuse 1 0 0
}
"""


def test_the_material_of_a_script_becomes_colors_and_an_image(tmp_path: Path) -> None:
    for name in ("house/model.config", "house/materials/textures/brick.png"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).touch()
    scripts = tmp_path / "house" / "materials" / "scripts"
    scripts.mkdir()
    (scripts / "a.material").write_text(SCRIPT)
    paints = {name: [paint] for name, paint in find_paints("p", tmp_path)}
    assert sorted(paints) == ["Plain Red", "Wall/Brick"]
    text = dedent(
        """
        <visual name="v">
          <material>
            <script>
              <uri>model://house/materials/scripts</uri>
              <name>Wall/Brick</name>
            </script>
          </material>
        </visual>
        """
    )
    port = port_model(SourceText(FILE, text), JAZZY, Robots(paints=paints))
    after = dedent(
        """
        <visual name="v">
          <material>
            <ambient>0.5 0.25 1.0 1</ambient>
            <diffuse>0.5 0.5 0.5 1</diffuse>
            <specular>0.2 0.2 0.2 1</specular>
            <pbr>
              <metal>
                <albedo_map>model://house/materials/textures/brick.png</albedo_map>
              </metal>
            </pbr>
          </material>
        </visual>
        """
    )
    assert apply(text, port.edits) == after
    assert port.unported == ()
    robot = "<robot>\n  <gazebo reference='a'>\n    <material>Plain Red</material>\n  </gazebo>\n</robot>\n"
    port = port_model(SourceText(FILE, robot), JAZZY, Robots(paints=paints))
    colors = "<diffuse>1 0 0 1</diffuse>\n        <specular>0 0 0 1</specular>\n      </material>"
    assert colors in apply(robot, port.edits)


def test_of_two_materials_that_of_the_named_model_counts(tmp_path: Path) -> None:
    paints = []
    for model in ("first", "second"):
        folder = tmp_path / model / "materials" / "scripts"
        folder.mkdir(parents=True)
        (tmp_path / model / "model.config").touch()
        (folder / "a.material").write_text(f"material same {{ diffuse 0.{len(model)} 0 0 1\n}}\n")
        paints = [paint for _, paint in find_paints("p", tmp_path)]
    text = (
        "<material><script><uri>model://second/materials</uri><name>same</name></script></material>"
    )
    port = port_model(SourceText(FILE, text), JAZZY, Robots(paints={"same": paints}))
    assert "<diffuse>0.6 0 0 1</diffuse>" in apply(text, port.edits)


@pytest.mark.parametrize("drive", ["d", "other"])
def test_wheels_that_a_macro_is_given(drive: str) -> None:
    """The robot that a launch file spawns says which joints they are."""
    joints = "".join(f'<joint name="{one}" type="continuous"/>' for one in ("l_joint", "r_joint"))
    text = f"""<robot name="r">
  {joints}
  <xacro:macro name="drive" params="l r">
    <gazebo>
      <plugin name="d" filename="libgazebo_ros_diff_drive.so">
        <left_joint>${{l}}</left_joint>
        <right_joint>${{r}}</right_joint>
        <max_wheel_torque>3</max_wheel_torque>
      </plugin>
    </gazebo>
  </xacro:macro>
</robot>
"""
    filename = "libgazebo_ros_diff_drive.so"
    robots = Robots(wheels={(drive, filename): frozenset(("l_joint", "r_joint"))})
    port = port_model(SourceText(FILE, text), JAZZY, robots)
    after = apply(text, port.edits)
    assert after.count('<limit effort="3" velocity="1000"/>') == (2 if drive == "d" else 0)
    assert len(port.efforts) == (0 if drive == "d" else 1)


_INERTIA = """<robot name="r">
  <link name="${side}_wheel">
    <inertial>
      <mass value="1"/>
      <inertia %s ixy="0" ixz="0" iyz="0"/>  <!-- measured -->
    </inertial>
  </link>
</robot>
"""


@pytest.mark.parametrize(
    ("before", "after"),
    [
        # A wheel turns about the axis of its largest moment as before.
        ('ixx="2" iyy="2" izz="10"', 'ixx="5.000005" iyy="5.000005" izz="10"'),
        ('ixx="1" iyy="9" izz="2"', 'ixx="4.0000045" iyy="9" izz="5.0000045"'),
        # Gazebo Classic takes this for what is not positive.
        ('ixx="1" iyy="0" izz="2"', 'ixx="1" iyy="1" izz="1"'),
        ('ixx="1" iyy="2" izz="2.5"', 'ixx="1" iyy="2" izz="2.5"'),
        ('ixx="${a}" iyy="2" izz="2.5"', 'ixx="${a}" iyy="2" izz="2.5"'),
    ],
)
def test_inertias_that_gazebo_sim_refuses(before: str, after: str) -> None:
    """They are what Gazebo Classic simulates, or near it."""
    source = SourceText(FILE, _INERTIA % before)
    assert port_model(source, JAZZY).edits == ()  # of links that are fixed to others
    made = port_model(source, JAZZY, Robots(refused=frozenset({"left_wheel"})))
    assert apply(source.text, made.edits) == _INERTIA % after
    if before != after:
        assert [one.is_note for one in made.unported] == [True]
        again = SourceText(FILE, _INERTIA % after)
        assert port_model(again, JAZZY, Robots(refused=frozenset({"left_wheel"}))).edits == ()


def test_inertias_of_models_that_gazebo_sim_refuses() -> None:
    text = (
        '<sdf version="1.7"><model name="m"><link name="l"><inertial><mass>2</mass>'
        "<inertia><ixx>1</ixx><iyy>5</iyy></inertia></inertial></link></model></sdf>"
    )
    raised = "<ixx>2.5000025</ixx><iyy>5</iyy><izz>2.5000025</izz>"
    assert raised in re.sub(r">\s+<", "><", ported(text))
    other = text.replace("<iyy>5</iyy>", "<iyy>2</iyy>")
    assert ported(other) == other


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (
            '<mesh filename="a.stl" scale="0 1 0.0"/>',
            '<mesh filename="a.stl" scale="0.001 1 0.001"/>',
        ),
        ("<mesh><scale>0 1 2</scale></mesh>", "<mesh><scale>0.001 1 2</scale></mesh>"),
        ("<mesh><scale>-1 1 2</scale></mesh>", None),
        ("<mesh><scale>${a} 1 2</scale></mesh>", None),
        ("<state><scale>0 0 0</scale></state>", None),
    ],
)
def test_meshes_without_a_thickness(before: str, after: str | None) -> None:
    text = "<robot><link><visual><geometry>%s</geometry></visual></link></robot>"
    assert ported(text % before) == text % (after or before)
