"""Keep the dark line in the middle of the picture."""

import numpy as np
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import Image


class CameraFollower(Node):
    def __init__(self):
        super().__init__("camera_follower")
        self.speed = self.declare_parameter("speed", 0.3).value
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(Image, "eye/image_raw", self.look, qos_profile_sensor_data)

    def look(self, image):
        pixels = np.frombuffer(image.data, np.uint8).reshape(image.height, image.width, 3)
        dark = pixels[image.height // 2].max(axis=1) < 60
        command = Twist()
        if dark.any():
            error = np.flatnonzero(dark).mean() / image.width - 0.5
            command.linear.x = self.speed
            command.angular.z = -3.0 * error
        self.publisher.publish(command)


def main():
    rclpy.init()
    rclpy.spin(CameraFollower())
