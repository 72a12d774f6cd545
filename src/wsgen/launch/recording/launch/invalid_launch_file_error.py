"""A launch file that cannot be loaded."""


class InvalidLaunchFileError(Exception):
    """Nothing could read the launch file."""
