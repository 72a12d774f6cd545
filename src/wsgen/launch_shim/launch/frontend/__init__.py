"""Launch files in XML and YAML; imported only where one is met."""

from launch._finder import names_on_demand

_HOMES = {
    "Entity": "parser",
    "InvalidFrontendLaunchFileError": "parser",
    "get_launch_description_from_frontend_launch_file": "parser",
}
__all__ = list(_HOMES)
__getattr__ = names_on_demand(__name__, _HOMES)
