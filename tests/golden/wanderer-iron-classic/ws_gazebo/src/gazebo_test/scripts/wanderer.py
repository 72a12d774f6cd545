#!/usr/bin/env python3
"""Wander: drive ahead while the way is free, turn to the freer side where it is not."""

from geometry_msgs.msg import Twist
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from sensor_msgs.msg import LaserScan


class Wanderer(Node):
    """Answers each scan of the lidar with a velocity."""

    def __init__(self):
        """Declare the parameters, in m/s, rad/s, m and rad."""
        super().__init__('wanderer')
        self.speed = self.declare_parameter('speed', 0.4).value
        self.turning = self.declare_parameter('turning', 1.0).value
        self.clearance = self.declare_parameter('clearance', 0.7).value
        self.view = self.declare_parameter('view', 0.7).value  # to either side
        self.side = 0  # where it turns to: 1 is left, -1 right, 0 if it drives ahead
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.create_subscription(LaserScan, 'scan', self.answer, qos_profile_sensor_data)

    def answer(self, scan):
        """Publish the velocity that the scan asks for."""
        angles = [scan.angle_min + i * scan.angle_increment for i in range(len(scan.ranges))]
        left = min(r for a, r in zip(angles, scan.ranges) if 0 <= a <= self.view)
        right = min(r for a, r in zip(angles, scan.ranges) if -self.view <= a <= 0)
        if min(left, right) > self.clearance:
            self.side = 0
        elif self.side == 0:  # it keeps turning to one side until the way is free
            self.side = 1 if left > right else -1
        velocity = Twist()
        velocity.linear.x = self.speed if self.side == 0 else 0.0
        velocity.angular.z = self.side * self.turning
        self.publisher.publish(velocity)


def main():
    """Answer scans until the node is interrupted."""
    rclpy.init()
    try:
        rclpy.spin(Wanderer())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == '__main__':
    main()
