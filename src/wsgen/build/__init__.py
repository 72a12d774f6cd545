"""Run colcon on a workspace and explain why a build fails."""
