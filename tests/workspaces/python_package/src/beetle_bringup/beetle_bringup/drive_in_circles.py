import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class DriveInCircles(Node):

    def __init__(self):
        super().__init__('drive_in_circles')
        self.declare_parameter('speed', 0.2)
        self.declare_parameter('turn', 0.5)
        self.publisher = self.create_publisher(Twist, 'cmd_vel', 10)
        self.timer = self.create_timer(0.1, self.publish)

    def publish(self):
        msg = Twist()
        msg.linear.x = self.get_parameter('speed').value
        msg.angular.z = self.get_parameter('turn').value
        self.publisher.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    node = DriveInCircles()
    rclpy.spin(node)
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
