"""Stand-in for lifecycle_msgs, where it is not installed: its numbers."""
