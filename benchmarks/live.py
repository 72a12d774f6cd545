"""Measure the simulator of live runs: a rover with lidar, IMU, odometry and tf, for one core.

    python -m benchmarks.live [SECONDS]

A node listens to all topics, so that all messages are made and sent. The first row is as fast as
the machine can, the second one at `--rate 1`. CPU time is that of the simulator alone; the clock's
is from its first message to its end.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

from wsgen.descriptions.urdf.devices import read_devices
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.isolation.codec import encode
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.ros.environment import open_ros
from wsgen.simulation.live_runs import FOLDER_VARIABLE, SCENE_FILE, LiveScene, socket_path
from wsgen.simulation.scene import Scene, SpawnedRobot

LEAST, MOST_OF_A_CORE, EXACT = 4.0, 1 / 3, 0.01  # what live runs must reach
SECONDS = 60.0
WHEEL = """
  <joint name="{side}" type="continuous">
    <origin xyz="0 {y} 0"/><parent link="base_link"/><child link="{side}_wheel"/>
    <axis xyz="0 1 0"/><limit effort="5" velocity="100"/>
  </joint>
  <link name="{side}_wheel">
    <inertial>
      <mass value="0.5"/><inertia ixx="0.001" iyy="0.002" izz="0.001" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <collision>
      <origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.1" length="0.02"/></geometry>
    </collision>
  </link>
"""
ROVER = f"""
<robot name="rover">
  <link name="base_link">
    <inertial>
      <origin xyz="-0.05 0 0"/>
      <mass value="5"/><inertia ixx="0.05" iyy="0.08" izz="0.1" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <collision>
      <origin xyz="0 0 0.05"/><geometry><box size="0.4 0.3 0.1"/></geometry>
    </collision>
    <collision>
      <origin xyz="-0.15 0 -0.05"/><geometry><sphere radius="0.05"/></geometry>
    </collision>
  </link>
  {WHEEL.format(side="left", y=0.2)}{WHEEL.format(side="right", y=-0.2)}
  <gazebo>
    <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <left_joint>left</left_joint><right_joint>right</right_joint><update_rate>50</update_rate>
      <wheel_separation>0.4</wheel_separation><wheel_diameter>0.2</wheel_diameter>
      <publish_odom>true</publish_odom><publish_odom_tf>true</publish_odom_tf>
    </plugin>
    <plugin name="joint_states" filename="libgazebo_ros_joint_state_publisher.so">
      <update_rate>50</update_rate><joint_name>left</joint_name><joint_name>right</joint_name>
    </plugin>
  </gazebo>
  <gazebo reference="base_link">
    <sensor name="lidar" type="ray">
      <always_on>true</always_on><update_rate>10</update_rate><pose>0 0 0.2 0 0 0</pose>
      <ray>
        <scan><horizontal>
          <samples>360</samples><min_angle>-3.14</min_angle><max_angle>3.14</max_angle>
        </horizontal></scan>
        <range><min>0.1</min><max>12</max></range>
        <noise><type>gaussian</type><stddev>0.01</stddev></noise>
      </ray>
      <plugin name="scan" filename="libgazebo_ros_ray_sensor.so">
        <ros><remapping>~/out:=scan</remapping></ros>
        <output_type>sensor_msgs/LaserScan</output_type>
      </plugin>
    </sensor>
    <sensor name="imu" type="imu">
      <always_on>true</always_on><update_rate>100</update_rate>
      <plugin name="imu" filename="libgazebo_ros_imu_sensor.so">
        <ros><remapping>~/out:=imu</remapping></ros>
      </plugin>
    </sensor>
  </gazebo>
</robot>
"""
LISTENER = """
import rclpy
from nav_msgs.msg import Odometry
from sensor_msgs.msg import Imu, JointState, LaserScan
from tf2_msgs.msg import TFMessage
rclpy.init()
node, counts = rclpy.create_node("listener"), {}
topics = {"odom": Odometry, "imu": Imu, "joint_states": JointState, "scan": LaserScan}
topics["tf"] = TFMessage
def count(topic):
    return lambda _: counts.__setitem__(topic, counts.get(topic, 0) + 1)
kept = [node.create_subscription(kind, topic, count(topic), 100) for topic, kind in topics.items()]
try:
    rclpy.spin(node)
except BaseException:
    print(", ".join(f"{topic} {number}" for topic, number in sorted(counts.items())))
"""


class Run(NamedTuple):
    """One run of the simulator."""

    simulated: float  # s
    wall: float
    cpu: float
    messages: str  # that the listener got


def live_scene(rate: float | None, seconds: float) -> LiveScene:
    """The rover in an empty world."""
    written, _ = read_urdf(ROVER, file=None)
    assert written is not None  # noqa: S101  it is that above
    lumped, _ = lump(written)
    robot = SpawnedRobot(
        entity="rover", robot=lumped, pose_in_world=Pose((0.0, 0.0, 0.1)), on_the_ground=True
    )
    return LiveScene(
        scene=Scene(world=World(name="w", has_ground_plane=True), robots=(robot,)),
        simulator="classic",
        devices={"rover": read_devices(ROVER, written, lumped)},
        in_world=("rover",),
        rate=rate,
        seconds=seconds,
    )


def measure(variables: dict[str, str], python: str, rate: float | None, seconds: float) -> Run:
    """Run the simulator for so many simulated seconds."""
    with tempfile.TemporaryDirectory(prefix="wsgen-benchmark-") as scratch:
        folder = Path(scratch)
        (folder / SCENE_FILE).write_text(encode(live_scene(rate, seconds)))
        variables = {**variables, FOLDER_VARIABLE: scratch}
        listener = subprocess.Popen(
            [python, "-c", LISTENER], env=variables, stdout=subprocess.PIPE, text=True
        )
        time.sleep(3.0)  # until it listens
        simulator = subprocess.Popen([python, "-m", "wsgen.live.nodes.simulator"], env=variables)
        while not socket_path(folder).exists():
            time.sleep(0.01)
        begun, before = time.perf_counter(), _cpu_of(simulator.pid)
        _, status, used = os.wait4(simulator.pid, 0)
        wall = time.perf_counter() - begun
        listener.terminate()
        messages, _ = listener.communicate()
        if status:
            sys.exit(f"The simulator ended with {status}.")
        return Run(seconds, wall, used.ru_utime + used.ru_stime - before, messages.strip())


def _cpu_of(process: int) -> float:
    """CPU time that it has taken so far, s."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main() -> None:
    """Measure and print a table in Markdown."""
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS
    ros = open_ros(os.environ, listener=lambda _: None)
    variables, python = {**os.environ, **ros.variables}, str(ros.python)
    print("| rate | simulated | wall-clock | CPU | times real time, one core | of a core |")
    print("|---|---|---|---|---|---|")
    runs = []
    for rate in (None, 1.0):
        run = measure(variables, python, rate, seconds)
        runs.append(run)
        print(
            f"| {rate or 'max'} | {run.simulated:g} s | {run.wall:.2f} s | {run.cpu:.2f} s | "
            f"{run.simulated / run.cpu:.1f} | {run.cpu / run.wall:.0%} |"
        )
        print(f"messages: {run.messages}", file=sys.stderr)
    fast, exact = runs
    if fast.simulated / fast.cpu < LEAST:
        sys.exit(f"Less than {LEAST:g} times real time.")
    if exact.cpu / exact.wall > MOST_OF_A_CORE or abs(exact.wall / exact.simulated - 1) > EXACT:
        sys.exit("At --rate 1: too much CPU time, or another rate.")


if __name__ == "__main__":
    main()
