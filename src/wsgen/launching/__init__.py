"""Launch files: evaluate them without ROS, and read from the plan what they spawn.

In: a launch file with its arguments. Out: `model.plan.LaunchPlan`, diagnostics. `shim` has our
`launch` and `launch_ros`, on the path of the child alone. It imports `packages` and what is below.
"""
