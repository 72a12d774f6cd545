"""Shim of the `launch_xml` package."""

from launch._finder import show_public_names
from launch.launch_description_sources import FrontendLaunchDescriptionSource


class XMLLaunchDescriptionSource(FrontendLaunchDescriptionSource):
    """A launch file in XML."""


show_public_names(__name__)
