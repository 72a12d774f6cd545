"""Launch files in XML and YAML; imported only where one is met."""

from launch._lazy import finder

_HOMES = {
    "Entity": "parser",
    "InvalidFrontendLaunchFileError": "parser",
    "get_launch_description_from_frontend_launch_file": "parser",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
