"""Launch files in YAML."""

from launch.launch_description_sources.frontend_launch_description_source import (
    FrontendLaunchDescriptionSource,
)


class YAMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    """A launch file in YAML."""
