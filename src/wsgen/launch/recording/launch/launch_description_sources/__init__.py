"""All sources of launch descriptions."""

from launch._lazy import finder

_HOMES = {
    "AnyLaunchDescriptionSource": "any_launch_description_source",
    "FrontendLaunchDescriptionSource": "frontend_launch_description_source",
    "InvalidPythonLaunchFileError": "python_launch_file_utilities",
    "PythonLaunchDescriptionSource": "python_launch_description_source",
    "get_launch_description_from_any_launch_file": "any_launch_description_source",
    "get_launch_description_from_python_launch_file": "python_launch_file_utilities",
    "load_python_launch_file_as_module": "python_launch_file_utilities",
}
__all__ = list(_HOMES)
__getattr__ = finder(__name__, _HOMES)
