"""Many variants of a robot, simulated one by one: what varies, the runs, and their table."""
