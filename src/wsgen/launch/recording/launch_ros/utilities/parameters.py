"""Parameters of nodes: what is written, what it becomes.

Texts that Python wrote stay texts; texts that substitutions give are read as YAML, which is
where a robot_description loses its line breaks, or the launch its life.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from launch.substitution import Substitution
from launch.utilities.normalize_to_list_of_substitutions_impl import (
    normalize_to_list_of_substitutions,
)
from launch.utilities.perform_substitutions_impl import perform_substitutions
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue
from wsgen.launch import codes
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext

    Pair = tuple[list[Substitution], Any]
    Normalized = list[list[Pair] | Parameter | ParameterFile]
    Location = tuple[str, int]

_SCALARS = (bool, int, float, str, bytes)


class _Texts:
    """A list of texts, each of which substitutions give."""

    def __init__(self, items: list[list[Substitution]]) -> None:
        self.items = items


def normalize_parameters(parameters: Sequence[Any]) -> Normalized:
    """Check what was written; TypeError for what can be no parameter."""
    if isinstance(parameters, str) or not isinstance(parameters, Sequence):
        raise TypeError(f"Expecting list of parameters, got {parameters}")
    normalized: Normalized = []
    for parameter in parameters:
        if isinstance(parameter, Mapping):
            normalized.append(_normalize_dict(parameter, ()))
        elif isinstance(parameter, (Parameter, ParameterFile)):
            normalized.append(parameter)
        elif isinstance(parameter, (str, os.PathLike, Substitution, Iterable)):
            normalized.append(ParameterFile(parameter))
        else:
            raise TypeError(
                "expected 'parameters' to be a path, a substitution or a dict, but got "
                f"'{parameter}' of type '{type(parameter)}'"
            )
    return normalized


def _normalize_dict(values: Mapping[Any, Any], prefix: tuple[Substitution, ...]) -> list[Pair]:
    pairs: list[Pair] = []
    for name, value in values.items():
        full_name = [*prefix, *normalize_to_list_of_substitutions(name)]
        if isinstance(value, Mapping):
            dot = normalize_to_list_of_substitutions(".")
            pairs += _normalize_dict(value, (*full_name, *dot))
        else:
            pairs.append((full_name, _normalize_value(value)))
    return pairs


def _normalize_value(value: Any) -> Any:
    """A plain value, a list of substitutions, `_Texts` or a `ParameterValue`."""
    if isinstance(value, (*_SCALARS, ParameterValue)):
        return value
    if isinstance(value, Substitution):
        return [value]
    if isinstance(value, Sequence):
        return _normalize_list(value)
    raise TypeError(f"Unexpected type for parameter value {value!r}")


def _normalize_list(values: Sequence[Any]) -> Any:
    kinds = {_kind(value) for value in values}
    if kinds in ({int}, {bool}, {str}):
        return tuple(values)
    if kinds and kinds <= {int, float}:
        return tuple(float(value) for value in values)
    if Substitution in kinds and kinds <= {str, Substitution, tuple}:
        return normalize_to_list_of_substitutions(values)
    return _Texts(
        [
            normalize_to_list_of_substitutions(
                _as_yaml(value) if isinstance(value, _SCALARS) else value
            )
            for value in values
        ]
    )


def _kind(value: Any) -> type:
    for kind in (Substitution, str, bool, int, float):
        if isinstance(value, kind):
            return kind
    if isinstance(value, Sequence):
        return tuple
    raise TypeError(
        "expected 'subvalue' to be one of [float, int, str, bool, Substitution, Iterable], but "
        f"got '{value}' of type '{type(value)}'"
    )


def _as_yaml(value: Any) -> str:
    import yaml  # see launch.utilities.type_utils

    return str(yaml.dump(value))


def evaluate_parameters(
    context: LaunchContext,
    parameters: Normalized,
    *,
    node: str,
    location: Location | None,
) -> dict[str, Any]:
    """The parameters that the node has, in the order in which they are given, as JSON values."""
    evaluated: dict[str, Any] = {}
    for parameter in parameters:
        if isinstance(parameter, Parameter):
            name, value = parameter.evaluate(context)
            evaluated[name] = _as_json(value)
        elif isinstance(parameter, ParameterFile):
            from launch_ros.utilities.parameter_files import read

            evaluated.update(read(context, parameter, node=node, location=location))
        else:
            for name_parts, value in parameter:
                name = perform_substitutions(context, name_parts)
                evaluated[name] = _as_json(_evaluate(context, name, value, location))
    return evaluated


def global_parameters(
    context: LaunchContext, *, node: str, location: Location | None
) -> dict[str, Any]:
    """The parameters that were set for all nodes, as this node has them."""
    found: dict[str, Any] = {}
    for entry in context.launch_configurations.get("global_params", ()):
        if isinstance(entry, ParameterFile):
            found.update(evaluate_parameters(context, [entry], node=node, location=location))
        else:
            found.update([entry])
    return found


def add_global_parameters(context: LaunchContext, entries: Iterable[Any]) -> None:
    """Set names with values, or files, for all nodes that come next in this scope."""
    earlier = context.launch_configurations.get("global_params", [])
    context.launch_configurations["global_params"] = [*earlier, *entries]


def _evaluate(context: LaunchContext, name: str, value: Any, location: Location | None) -> Any:
    if isinstance(value, ParameterValue):
        read = value.evaluate(context)
        if (
            value.value_type is None
            and isinstance(value.value, list)
            and _is_description(name, read)
        ):
            _warn_of_yaml(location)
        return read
    if isinstance(value, _Texts):
        values = [_read_yaml(name, perform_substitutions(context, item)) for item in value.items]
        return _require_uniform(values)
    if isinstance(value, list):
        text = perform_substitutions(context, value)
        read = _read_yaml(name, text)
        if _is_description(name, text):
            _warn_of_yaml(location)
        if read is None:
            return ""
        if isinstance(read, _SCALARS):
            return read
        if isinstance(read, list):
            return _require_uniform(read)
        # What would be needed to mend it is the same as where YAML cannot read it at all.
        raise _not_yaml(name)
    return value


def _read_yaml(name: str, text: str) -> Any:
    import yaml  # see launch.utilities.type_utils

    try:
        return yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise _not_yaml(name) from error


def _not_yaml(name: str) -> TypeError:
    return TypeError(
        f"Unable to parse the value of parameter {name} as yaml. If the parameter is meant to be "
        "a string, try wrapping it in "
        "launch_ros.parameter_descriptions.ParameterValue(value, value_type=str)"
    )


def _require_uniform(values: list[Any]) -> list[Any]:
    kinds = {type(value) for value in values}
    if len(kinds) != 1 or not kinds <= {bool, int, float, str}:
        raise TypeError(
            "Expected a non-empty sequence, with items of uniform type. Allowed sequence item "
            "types are bool, int, float, str."
        )
    return values


def _is_description(name: str, value: Any) -> bool:
    return (
        name.rpartition(".")[2] == "robot_description"
        and isinstance(value, str)
        and value.lstrip().startswith("<")
    )


def _warn_of_yaml(location: Location | None) -> None:
    RECORD.note_diagnostic(
        codes.DESCRIPTION_AS_YAML,
        "warning",
        "robot_description is read as YAML: its line breaks are folded, and a ': ' or ' #' in "
        "the robot, in a comment for example, stops the launch.",
        location,
        element="robot_description",
        hint="Wrap it: ParameterValue(Command([...]), value_type=str), from "
        "launch_ros.parameter_descriptions.",
    )


def _as_json(value: Any) -> Any:
    if isinstance(value, tuple):
        return list(value)
    if isinstance(value, bytes):
        return list(value)
    return value
