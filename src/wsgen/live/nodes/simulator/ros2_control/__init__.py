"""ros2_control inside of the simulator: hardware, controller manager and controllers."""
