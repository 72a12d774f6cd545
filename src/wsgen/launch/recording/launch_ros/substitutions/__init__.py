"""All substitutions of ROS."""

from launch._lazy import finder

_HOMES = {
    "ExecutableInPackage": "executable_in_package",
    "FindPackage": "find_package",
    "FindPackagePrefix": "find_package",
    "FindPackageShare": "find_package",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
