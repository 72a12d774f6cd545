"""Launch files in XML."""

from launch.launch_description_sources.frontend_launch_description_source import (
    FrontendLaunchDescriptionSource,
)


class XMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    """A launch file in XML."""
