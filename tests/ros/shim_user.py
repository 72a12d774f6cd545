"""What nodes do with tf2_ros and the other packages of `wsgen/ros/shim`; run where ROS is."""

import sys
import threading
import time
from typing import Any

import numpy as np
import pytest
import rclpy
from geometry_msgs.msg import (
    PointStamped,
    PolygonStamped,
    PoseStamped,
    PoseWithCovarianceStamped,
    TransformStamped,
    Vector3Stamped,
)
from rclpy.duration import Duration
from rclpy.executors import MultiThreadedExecutor
from rclpy.time import Time
from sensor_msgs.msg import Image
from std_msgs.msg import Header

import tf2_geometry_msgs
from cv_bridge import CvBridge, CvBridgeError
from rosidl_runtime_py import message_to_csv, message_to_yaml, set_message_fields
from rosidl_runtime_py.utilities import get_message
from sensor_msgs_py import point_cloud2
from tf2_ros import (
    Buffer,
    LookupException,
    StaticTransformBroadcaster,
    TransformBroadcaster,
    TransformException,
    TransformListener,
    TypeException,
)

HALF = 0.5**0.5


def transform(parent: str, child: str, stamp: Any, x: float) -> Any:
    """A quarter turn to the left, and a step."""
    found = TransformStamped()
    found.header.frame_id, found.child_frame_id = parent, child
    found.header.stamp = stamp
    found.transform.translation.x = x
    found.transform.rotation.z = found.transform.rotation.w = HALF
    return found


def listen(node: Any) -> None:
    buffer = Buffer(node=node)
    listener = TransformListener(buffer, node)
    executor = MultiThreadedExecutor(2)
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin)
    thread.start()
    future = buffer.wait_for_transform_async("map", "tool", Time())
    assert not buffer.can_transform("map", "tool", Time(), Duration(seconds=0.05))
    with pytest.raises(LookupException, match="argument target_frame does not exist"):
        buffer.lookup_transform("map", "tool", Time())
    stamp = node.get_clock().now().to_msg()
    StaticTransformBroadcaster(node).sendTransform(transform("base", "tool", stamp, 0.5))
    broadcaster = TransformBroadcaster(node)
    end = time.monotonic() + 60
    while not future.done() and time.monotonic() < end:
        broadcaster.sendTransform([transform("map", "base", stamp, 1.0)])
        time.sleep(0.05)
    found = future.result().transform
    np.testing.assert_allclose([found.translation.x, found.translation.y], [1.0, 0.5], atol=1e-12)
    np.testing.assert_allclose([found.rotation.z, found.rotation.w], [1.0, 0.0], atol=1e-12)
    common = buffer.get_latest_common_time("map", "tool")
    assert common.nanoseconds == Time.from_msg(stamp).nanoseconds
    moved = buffer.transform(PoseStamped(header=Header(frame_id="tool")), "map")
    assert moved.header.frame_id == "map"
    np.testing.assert_allclose(moved.pose.position.x, 1.0)
    with pytest.raises(TypeException, match="is not loaded or supported"):
        buffer.transform(Image(), "map")
    listener.unregister()
    executor.shutdown()
    thread.join()


def transform_messages() -> None:
    step = transform("map", "base", Time(seconds=3).to_msg(), 1.0)
    point = PointStamped()
    point.point.x = 2.0
    found = tf2_geometry_msgs.do_transform_point(point, step)
    np.testing.assert_allclose([found.point.x, found.point.y], [1.0, 2.0], atol=1e-12)
    assert (found.header.frame_id, found.header.stamp.sec) == ("map", 3)
    vector = Vector3Stamped()
    vector.vector.x = 2.0
    found = tf2_geometry_msgs.do_transform_vector3(vector, step)
    np.testing.assert_allclose([found.vector.x, found.vector.y], [0.0, 2.0], atol=1e-12)
    assert step.transform.translation.x == 1.0  # as it was
    pose = PoseWithCovarianceStamped()
    pose.pose.covariance[0], pose.pose.covariance[35] = 4.0, 9.0
    found = tf2_geometry_msgs.do_transform_pose_with_covariance_stamped(pose, step)
    np.testing.assert_allclose(
        np.diag(found.pose.covariance.reshape(6, 6)), [0, 4, 0, 0, 0, 9], atol=1e-12
    )
    polygon = PolygonStamped()
    polygon.polygon.points.append(point_cloud_corner())
    found = tf2_geometry_msgs.do_transform_polygon_stamped(polygon, step)
    np.testing.assert_allclose(found.polygon.points[0].y, 2.0)


def point_cloud_corner() -> Any:
    return get_message("geometry_msgs/msg/Point32")(x=2.0)


def convert_images() -> None:
    bridge = CvBridge()
    picture = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)
    message = bridge.cv2_to_imgmsg(picture, "bgr8", header=Header(frame_id="camera"))
    assert (message.width, message.height, message.step) == (3, 2, 9)
    assert message.header.frame_id == "camera"
    np.testing.assert_array_equal(bridge.imgmsg_to_cv2(message), picture)
    np.testing.assert_array_equal(bridge.imgmsg_to_cv2(message, "rgb8"), picture[..., ::-1])
    depth = np.array([[1.5, np.inf]], dtype=np.float32)
    message = bridge.cv2_to_imgmsg(depth)
    assert message.encoding == "32FC1"
    np.testing.assert_array_equal(bridge.imgmsg_to_cv2(message, "32FC1"), depth)
    with pytest.raises(CvBridgeError, match="incompatible type"):
        bridge.cv2_to_imgmsg(depth, "bgr8")
    gray = np.full((8, 8), 77, dtype=np.uint8)
    packed = bridge.cv2_to_compressed_imgmsg(gray, "png")
    np.testing.assert_array_equal(bridge.compressed_imgmsg_to_cv2(packed), gray)


def convert_clouds() -> None:
    points = [(1.0, 2.0, 3.0), (4.0, float("nan"), 6.0)]
    cloud = point_cloud2.create_cloud_xyz32(Header(frame_id="laser"), points)
    assert (cloud.width, cloud.height, cloud.point_step) == (2, 1, 12)
    assert point_cloud2.read_points_list(cloud, skip_nans=True) == [(1.0, 2.0, 3.0)]
    np.testing.assert_array_equal(point_cloud2.read_points_numpy(cloud, ["z"]), [[3.0], [6.0]])
    assert point_cloud2.read_points(cloud)["x"].tolist() == [1.0, 4.0]


def convert_messages() -> None:
    path = get_message("nav_msgs/Path")()
    values = {"header": "auto", "poses": [{"pose": {"position": {"x": 1}}}]}
    stamps = set_message_fields(path, values, expand_header_auto=True)
    for stamp in stamps:
        stamp(Time(seconds=7).to_msg())
    assert (path.header.stamp.sec, path.poses[0].pose.position.x) == (7, 1.0)
    text = message_to_yaml(path)
    assert text.startswith(
        "header:\n  stamp:\n    sec: 7\n    nanosec: 0\n  frame_id: ''\nposes:\n"
    )
    assert message_to_csv(path.header) == "7,0,"
    scan = get_message("sensor_msgs/msg/LaserScan")(ranges=[1.0] * 200)
    assert message_to_yaml(scan, truncate_length=3).count("- 1.0\n") == 3
    assert "ranges: '<sequence type: float, length: 200>'" in message_to_yaml(scan, no_arr=True)


def main() -> None:
    transform_messages()
    convert_images()
    convert_clouds()
    convert_messages()
    rclpy.init()
    node = rclpy.create_node("shim_user")
    try:
        listen(node)
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    assert issubclass(LookupException, TransformException)
    sys.stdout.write("all is well\n")


if __name__ == "__main__":
    main()
