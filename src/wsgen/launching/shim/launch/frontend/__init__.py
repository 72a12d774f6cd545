"""Launch files in XML and YAML; imported only where one is met."""

from launch._finder import names_on_demand

_HOMES = {
    "Entity": "parser",
    "InvalidFrontendLaunchFileError": "parser",
    "Parser": "parser",
    "expose_action": "expose",
    "expose_substitution": "expose",
    "get_launch_description_from_frontend_launch_file": "parser",
    "type_utils": "",
}
__all__ = list(_HOMES)
__getattr__ = names_on_demand(__name__, _HOMES)
