"""See `wsgen.launching.parameter_builder`."""

from wsgen.launching.parameter_builder import (
    ParameterBuilder,
    get_package_path,
    load_file,
    load_xacro,
    load_yaml,
)

__all__ = ["ParameterBuilder", "get_package_path", "load_file", "load_xacro", "load_yaml"]
