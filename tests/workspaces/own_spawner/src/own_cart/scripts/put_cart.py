#!/usr/bin/env python3
import rclpy
from gazebo_msgs.srv import SpawnEntity
from std_msgs.msg import String


def main():
    rclpy.init()
    node = rclpy.create_node('put_cart')
    client = node.create_client(SpawnEntity, '/spawn_entity')
    client.wait_for_service()

    def on_description(message):
        client.call_async(SpawnEntity.Request(name='cart', xml=message.data))

    node.create_subscription(String, 'robot_description', on_description, 1)
    rclpy.spin(node)


if __name__ == '__main__':
    main()
