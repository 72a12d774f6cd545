"""Shim of the `launch_yaml` package."""

from launch._finder import show_public_names
from launch.launch_description_sources import FrontendLaunchDescriptionSource


class YAMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    """A launch file in YAML."""


show_public_names(__name__)
