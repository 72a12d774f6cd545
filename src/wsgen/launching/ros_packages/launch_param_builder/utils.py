"""See `wsgen.launching.parameter_builder`."""

from wsgen.launching.parameter_builder import (
    ParameterBuilderFileNotFoundError,
    raise_if_file_not_found,
)

__all__ = ["ParameterBuilderFileNotFoundError", "raise_if_file_not_found"]
