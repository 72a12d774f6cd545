"""See `wsgen.launching.moveit_configs`."""

from wsgen.launching.moveit_configs import (
    ParameterBuilderFileNotFoundError,
    raise_if_file_not_found,
)

__all__ = ["ParameterBuilderFileNotFoundError", "raise_if_file_not_found"]
