"""See `wsgen.launching.moveit_configs`."""

from wsgen.launching.moveit_configs import (
    ParameterBuilder,
    get_package_path,
    load_file,
    load_xacro,
    load_yaml,
)

__all__ = ["ParameterBuilder", "get_package_path", "load_file", "load_xacro", "load_yaml"]
