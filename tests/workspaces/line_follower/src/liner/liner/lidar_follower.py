"""Keep the line that reflects much in the middle of a scan of the ground."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan


class LidarFollower(Node):
    def __init__(self):
        super().__init__("lidar_follower")
        self.speed = self.declare_parameter("speed", 0.3).value
        self.publisher = self.create_publisher(Twist, "cmd_vel", 10)
        self.create_subscription(LaserScan, "floor", self.look, qos_profile_sensor_data)

    def look(self, scan):
        bright = [place for place, one in enumerate(scan.intensities) if one > 100.0]
        command = Twist()
        if bright:
            middle = scan.angle_min + scan.angle_increment * sum(bright) / len(bright)
            command.linear.x = self.speed
            command.angular.z = 3.0 * middle
        self.publisher.publish(command)


def main():
    rclpy.init()
    rclpy.spin(LidarFollower())
