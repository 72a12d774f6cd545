"""See `wsgen.launch.parameter_builder`."""

from wsgen.launch.parameter_builder import (
    ParameterBuilderFileNotFoundError,
    raise_if_file_not_found,
)

__all__ = ["ParameterBuilderFileNotFoundError", "raise_if_file_not_found"]
