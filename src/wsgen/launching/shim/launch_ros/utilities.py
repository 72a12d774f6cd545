"""How nodes get names, parameters and remappings; the nodes that containers load."""

from __future__ import annotations

import functools
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from launch._utilities import (
    normalize_optional,
    normalize_to_list_of_substitutions,
    perform_substitutions,
    read_plain_yaml,
)
from launch.base import Substitution, TextSubstitution
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue
from wsgen.launching.live import ParameterGroup
from wsgen.launching.record import RECORD, caller, split_location
from wsgen.model.plan import Process
from wsgen.text.files import refuse_irregular
from wsgen.text.yamlfile import (
    flat_parameters,
    merge_repeated,
    parameter_sections,
    parameters_of,
)

if TYPE_CHECKING:
    from launch.base import Condition, SomeSubstitutionsType
    from launch.launch_context import LaunchContext
    from wsgen.model.plan import Origin

    Pair = tuple[list[Substitution], Any]
    Normalized = list[list[Pair] | Parameter | ParameterFile]
    Location = tuple[str, int]
    Rules = list[tuple[list[Substitution], list[Substitution]]]


class InvalidNameError(ValueError):
    """A name that ROS does not allow."""


def join_namespaces(base: str | None, namespace: str | None) -> str | None:
    """A namespace seen from another one; an absolute one stays as it is, None means none."""
    if namespace is None:
        joined = base
    elif base is None or namespace.startswith("/"):
        joined = namespace
    elif namespace:
        joined = f"{base.rstrip('/')}/{namespace}"
    else:
        joined = base
    if joined is None:
        return None
    joined = "/" + joined.lstrip("/")
    return joined.rstrip("/") or "/"


def validate_name(name: str) -> None:
    """Refuse what is no name of a node."""
    if RECORD.is_unknown(name):
        return
    if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name, re.ASCII) is None:
        raise InvalidNameError(
            f"Invalid node name: '{name}' must consist of letters, digits and underscores, and "
            "not start with a digit"
        )


def validate_namespace(namespace: str) -> None:
    """Refuse what is no absolute namespace."""
    if RECORD.is_unknown(namespace):
        return
    pattern = r"/|(/[A-Za-z_][A-Za-z0-9_]*)+"
    if re.fullmatch(pattern, namespace, re.ASCII) is None:
        raise InvalidNameError(
            f"Invalid namespace: the parts of '{namespace}' must consist of letters, digits and "
            "underscores, and not start with a digit"
        )


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


class Evaluated(dict[str, Any]):
    """Parameters by name, as JSON values, in the order in which they are given."""

    def __init__(self) -> None:
        super().__init__()
        self.places: dict[str, Location] = {}  # where they are written, as far as that is known
        self.groups: list[ParameterGroup] = []  # as they are given to the node, in order

    def put(
        self, name: str, value: Any, place: Location | None, *, is_for_all: bool = False
    ) -> None:
        """Set one, which comes after all that it has."""
        self._set(name, value, place)
        group = ParameterGroup(values={name: value}, is_for_all=is_for_all)
        self.groups.append(group)

    def add(self, others: Evaluated) -> None:
        """Set all of others, which come after those that it has."""
        for name, value in others.items():
            self._set(name, value, others.places.get(name))
        self.groups += others.groups

    def _set(self, name: str, value: Any, place: Location | None) -> None:
        self[name] = value
        self.places.pop(name, None)
        if place is not None:
            self.places[name] = place

    def origins(self) -> dict[str, Origin]:
        """Where each is written, for the plan; nothing if nobody asked for it."""
        found = {name: RECORD.origin(place) for name, place in self.places.items()}
        return {name: origin for name, origin in found.items() if origin is not None}


class Placed(tuple[Any, ...]):  # noqa: SLOT001  of a tuple, they cannot have names
    """A pair, as in the original, that knows where it is written."""

    wsgen_location: Location | None = None


def placed(pair: Sequence[Any], location: Location | None) -> Placed:
    """A pair that is written there."""
    made = Placed(pair)
    made.wsgen_location = location
    return made


def evaluate_parameters(
    context: LaunchContext,
    parameters: Normalized,
    *,
    node: str,
    location: Location | None,
    in_container: bool = False,
) -> Evaluated:
    """The parameters that the node has; `location` is that of the action they are written in."""
    evaluated = Evaluated()
    for parameter in parameters:
        if isinstance(parameter, Parameter):
            name, value = parameter.evaluate(context)
            place = parameter.wsgen_location or location
            evaluated.put(name, _as_json(value), place, is_for_all=True)
        elif isinstance(parameter, ParameterFile):
            evaluated.add(
                read(context, parameter, node=node, location=location, in_container=in_container)
            )
        else:
            for name_parts, value in parameter:
                name = perform_substitutions(context, name_parts)
                place = written_at(value) or written_at(name_parts)
                evaluated.put(
                    name,
                    _as_json(_evaluate(context, name, value, location)),
                    _literal_at(place or location, location, name),
                )
    return evaluated


def written_at(value: Any) -> Location | None:
    """Where a parameter's value, or the substitutions of a text, are written."""
    if isinstance(value, _Texts):
        value = [part for item in value.items for part in item]
    if isinstance(value, (list, tuple)):
        # A text was made into a substitution where the action was, which is known anyhow.
        parts = [part for part in value if isinstance(part, Substitution)]
        parts.sort(key=lambda part: isinstance(part, TextSubstitution))
        value = parts[0] if parts else None
    place: Location | None = getattr(value, "wsgen_location", None)
    return place


def _literal_at(place: Location | None, action: Location | None, name: str) -> Location | None:
    """The line of a plain value, which knows but that of the action it is written in."""
    if place is None or place != action or not RECORD.with_origins:
        return place
    from wsgen.launching.origins import line_of_parameter

    return place[0], line_of_parameter(place[0], place[1], name)


def global_parameters(context: LaunchContext, *, node: str, location: Location | None) -> Evaluated:
    """The parameters that were set for all nodes, as this node has them."""
    found = Evaluated()
    for entry in context.launch_configurations.get("global_params", ()):
        if isinstance(entry, ParameterFile):
            found.add(evaluate_parameters(context, [entry], node=node, location=location))
        else:
            name, value = entry
            found.put(name, value, getattr(entry, "wsgen_location", None), is_for_all=True)
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
            _report_description_as_yaml(location)
        return read
    if isinstance(value, _Texts):
        texts = [perform_substitutions(context, item) for item in value.items]
        if any(map(RECORD.is_unknown, texts)):
            return texts
        return _require_uniform([_read_yaml(name, text) for text in texts])
    if isinstance(value, list):
        return _read_value(name, perform_substitutions(context, value), location)
    return value


def _read_value(name: str, text: str, location: Location | None) -> Any:
    """The value that a text stands for."""
    if RECORD.is_unknown(text):
        return text
    read = _read_yaml(name, text)
    if _is_description(name, text):
        _report_description_as_yaml(location)
    if read is None:
        return ""
    if isinstance(read, _SCALARS):
        return read
    if isinstance(read, list):
        return _require_uniform(read)
    # What would be needed to fix it is the same as where YAML cannot read it at all.
    raise _not_yaml(name)


def _read_yaml(name: str, text: str) -> Any:
    plain = read_plain_yaml(text)
    if plain is not None:
        return plain
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


def _report_description_as_yaml(location: Location | None) -> None:
    from wsgen.launching.launch_warnings import report_description_as_yaml

    report_description_as_yaml(location)


def _as_json(value: Any) -> Any:
    if isinstance(value, tuple):
        return list(value)
    if isinstance(value, bytes):
        return list(value)
    return value


def normalize_remap_rules(rules: Iterable[Any]) -> Rules:
    """Pairs of what is remapped and what to."""
    normalized = []
    for rule in rules:
        pair = tuple(rule)
        if len(pair) != 2:  # noqa: PLR2004  a pair
            raise TypeError(f"remap rule must be a pair of substitutions, got '{rule}'")
        normalized.append(
            (
                normalize_to_list_of_substitutions(pair[0]),
                normalize_to_list_of_substitutions(pair[1]),
            )
        )
    return normalized


def perform_remap_rules(context: LaunchContext, rules: Rules) -> list[tuple[str, str]]:
    """The pairs as texts; those of `SetRemap` come first."""
    return [
        *context.launch_configurations.get("ros_remaps", ()),
        *(
            placed(
                (perform_substitutions(context, source), perform_substitutions(context, target)),
                written_at([*source, *target]),
            )
            for source, target in rules
        ),
    ]


def places_of(pairs: Iterable[Any]) -> list[Location | None]:
    """Where each pair is written, as far as it knows."""
    return [getattr(pair, "wsgen_location", None) for pair in pairs]


def item_origins(
    keyword: str, places: Sequence[Location | None], count: int, action: Location | None
) -> tuple[Origin | None, ...]:
    """Where the items of a list are written; nothing if nobody asked for it.

    Args:
        keyword: of the action, which gives the last `count` of the items.
        places: what is known; None for an item that is written with the action.
        count: how many of the items the action gives.
        action: where it is written.
    """
    if not RECORD.with_origins:
        return ()
    from wsgen.launching.origins import line_of_item

    found = [place or action for place in places]
    for number in range(count):
        index = len(found) - count + number
        if action is not None and found[index] == action:
            found[index] = (action[0], line_of_item(*action, keyword, number))
    return tuple(map(RECORD.origin, found))


class ComposableNode:
    """A node that a container loads."""

    def __init__(  # noqa: PLR0913  as the original
        self,
        *,
        package: SomeSubstitutionsType,
        plugin: SomeSubstitutionsType,
        name: SomeSubstitutionsType | None = None,
        namespace: SomeSubstitutionsType | None = None,
        parameters: list[Any] | None = None,
        remappings: Iterable[Any] | None = None,
        extra_arguments: list[Any] | None = None,
        condition: Condition | None = None,
    ) -> None:
        self.wsgen_location = caller()
        self.package = normalize_to_list_of_substitutions(package)
        self.plugin = normalize_to_list_of_substitutions(plugin)
        self.name = normalize_optional(name)
        self.namespace = normalize_optional(namespace)
        self.parameters = normalize_parameters(parameters or [])
        self.remappings = normalize_remap_rules(remappings or [])
        self.extra_arguments = normalize_parameters(extra_arguments or [])
        self.condition = condition


def note_composable_node(
    context: LaunchContext,
    node: ComposableNode,
    container: str,
    location: tuple[str, int] | None,
) -> None:
    """Note a node as something that starts in its container; its executable is its plugin."""
    if node.condition is not None and not node.condition.evaluate(context):
        return
    namespace = join_namespaces(
        context.launch_configurations.get("ros_namespace"),
        None if node.namespace is None else perform_substitutions(context, node.namespace),
    )
    name = None if node.name is None else perform_substitutions(context, node.name)
    full_name = f"{(namespace or '').rstrip('/')}/{name or ''}"
    file, line = split_location(location)
    place = node.wsgen_location or location
    parameters = global_parameters(context, node=full_name, location=place)
    parameters.add(
        evaluate_parameters(
            context, node.parameters, node=full_name, location=place, in_container=True
        )
    )
    remappings = perform_remap_rules(context, node.remappings)
    process = Process(
        package=perform_substitutions(context, node.package),
        executable=perform_substitutions(context, node.plugin),
        name=name,
        namespace=namespace or "",
        parameters=parameters,
        parameter_origins=parameters.origins(),
        remappings=tuple(remappings),
        remapping_origins=item_origins(
            "remappings", places_of(remappings), len(node.remappings), place
        ),
        container=container,
        starts=context.timeline.cause,
        start_time=round(context.timeline.now, 6),
        file=file,
        line=line,
    )
    RECORD.processes.append(process)
    if RECORD.live is not None:
        extra = evaluate_parameters(
            context, node.extra_arguments, node=full_name, location=place, in_container=True
        )
        RECORD.live.load(process, extra)


def read(
    context: LaunchContext,
    parameter_file: ParameterFile,
    *,
    node: str,
    location: tuple[str, int] | None,
    in_container: bool = False,
) -> Evaluated:
    """What a file says for a node, given by its full name; nothing where the file is missing.

    For a node that is loaded `in_container`, launch itself reads the file: it takes one without
    sections for parameters, and makes a list with numbers of both kinds one of floats, as it does
    with those that a launch file writes. A node refuses such a file.
    """
    path = parameter_file.evaluate(context)
    found = Evaluated()
    found.groups.append(ParameterGroup(file=path))
    if RECORD.is_unknown(str(path)):
        return found
    try:
        refuse_irregular(path)
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        from wsgen.launching.launch_warnings import report_parameter_file

        report_parameter_file(path, location)
        return found
    if parameter_file.may_have_substitutions(context):
        from launch.frontend.template import parse_substitution

        text = perform_substitutions(context, parse_substitution(text))
        found.groups = [ParameterGroup(text=text)]
    import yaml  # see launch.utilities.type_utils

    try:
        content = _parse(text, is_read_by_node=not in_container)
    except yaml.YAMLError as error:
        RECORD.note_unresolved(str(path), f"it is not YAML: {error}", location)
        return found
    lines = _lines_of(path, text, is_read_by_node=not in_container) if RECORD.with_origins else {}
    for name, value in _meant(content, node, in_container=in_container).items():
        found[name] = _with_one_kind(value) if in_container else value
    for name, line in _meant(lines, node, in_container=in_container).items():
        found.places[name] = (_original(path), line)
    return found


def _meant(content: Any, node: str, *, in_container: bool) -> dict[str, Any]:
    """The parameters of the node in the content of a file."""
    if in_container and isinstance(content, dict) and not any(parameter_sections(content)):
        return flat_parameters(content)
    return parameters_of(content, node)


def _with_one_kind(value: Any) -> Any:
    """A list with integers and floats as one of floats; all else as it is."""
    if isinstance(value, list) and {type(item) for item in value} == {int, float}:
        return [float(item) for item in value]
    return value


def _original(path: Path) -> str:
    """The file, or the one that it is made of; only that one is the user's."""
    absolute = os.path.abspath(path)
    return RECORD.made.get(absolute, absolute)


def _lines_of(path: Path, text: str, *, is_read_by_node: bool) -> Any:
    """The lines of the keys; those of the file that this one is made of, if it is made."""
    from wsgen.launching.origins import key_lines

    absolute = os.path.abspath(path)
    original = RECORD.made.get(absolute)
    RECORD.read[original or absolute] = "parameters"
    text = text if original is None else Path(original).read_text(encoding="utf-8")
    return key_lines(text, merges_repeated=is_read_by_node)


@functools.cache
def _parse(text: str, *, is_read_by_node: bool) -> Any:
    """The content of a parameter file, which several nodes read and none changes.

    A node merges repeated sections; launch, which reads the file for a container, does not.
    """
    import yaml  # see launch.utilities.type_utils

    # libyaml is ten times as fast, and what nodes read the file with themselves.
    class Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
        def get_single_node(self) -> Any:
            node = super().get_single_node()
            if is_read_by_node:
                merge_repeated(node)
            return node

    return yaml.load(text, Loader=Loader)  # noqa: S506  it is safe
