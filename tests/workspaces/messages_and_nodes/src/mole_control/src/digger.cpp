#include <mole_msgs/msg/tunnel.hpp>
#include <rclcpp/rclcpp.hpp>
