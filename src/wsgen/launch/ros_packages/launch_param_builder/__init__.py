"""See `wsgen.launch.parameter_builder`."""

from wsgen.launch.parameter_builder import (
    ParameterBuilder,
    get_package_path,
    load_file,
    load_xacro,
    load_yaml,
)

__all__ = ["ParameterBuilder", "get_package_path", "load_file", "load_xacro", "load_yaml"]
