"""The actions of ROS that XML and YAML know by name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.frontend.actions import build_all, command_line, pairs, process, reading, texts, values
from launch.frontend.template import parse_if_substitutions, parse_substitution
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.frontend.parser import Entity
    from launch_ros.utilities import ComposableNode

    Keywords = dict[str, Any]

_KINDS: dict[str, Any] = {
    "bool": bool,
    "float": float,
    "int": int,
    "str": str,
    "list_of_bool": list[bool],
    "list_of_float": list[float],
    "list_of_int": list[int],
    "list_of_str": list[str],
}


def _parameters(entity: Entity, name: str = "param") -> list[Any]:
    """One item for each element, as in the original."""
    found: list[Any] = []
    for parameter in entity.nested(name):
        with reading(parameter):
            found.append(_parameter_or_file(parameter))
    return found


def _parameter_or_file(parameter: Entity) -> Any:
    file = parameter.get("from", optional=True)
    if file is None:
        key, value = _parameter(parameter)
        return {key: value}
    if parameter.get("name", optional=True) is not None:
        raise RuntimeError("name and from attributes are mutually exclusive")
    allow = parameter.get("allow_substs", bool, optional=True)
    parameter.assert_entity_completely_parsed()
    return ParameterFile(
        parse_substitution(file),
        allow_substs=parse_substitution(allow) if isinstance(allow, str) else bool(allow),
    )


def _parameter(entity: Entity) -> tuple[tuple[Any, ...], Any]:
    name = entity.get("name", optional=True)
    if name is None:
        raise ValueError("param Entity should have name or from attribute")
    with reading(entity):
        return _parameter_in(entity, name)


def _parameter_in(entity: Entity, name: str) -> tuple[tuple[Any, ...], Any]:
    kind = _kind(entity.get("type", optional=True))
    value = entity.get("value", kind, optional=True)
    nested = entity.nested("param")
    entity.assert_entity_completely_parsed()
    key = tuple(parse_substitution(name))
    if value is not None and nested:
        raise RuntimeError("nested parameters and value attributes are mutually exclusive")
    if value is not None:
        return key, ParameterValue(parse_if_substitutions(value), value_type=kind)
    if not nested:
        raise RuntimeError("either a value attribute or nested params are needed")
    return key, dict(_parameter(one) for one in nested)


def _kind(name: str | None) -> Any:
    if name is not None and name not in _KINDS:
        raise ValueError(f"Unknown type '{name}'; it must be one of {', '.join(_KINDS)}")
    return None if name is None else _KINDS[name]


def _remappings(entity: Entity) -> list[Any]:
    return pairs(entity, "remap", "from", "to")


def _node(entity: Entity) -> Keywords:
    found = {
        **process(entity),
        **texts(
            entity,
            package="pkg?",
            executable="exec",
            name="name?",
            namespace="namespace?",
            exec_name="exec_name?",
        ),
    }
    for keyword, name in (("arguments", "args"), ("ros_arguments", "ros_args")):
        line = entity.get(name, optional=True)
        if line is not None:
            found[keyword] = command_line(line)
    return {**found, "remappings": _remappings(entity), "parameters": _parameters(entity)}


def _lifecycle_node(entity: Entity) -> Keywords:
    return {**_node(entity), **values(entity, bool, "autostart")}


def _composable_nodes(entity: Entity) -> list[ComposableNode]:
    from launch.frontend.actions import condition
    from launch_ros.utilities import ComposableNode

    found = []
    for node in entity.nested("composable_node"):
        keywords = {
            **condition(node),
            **texts(node, package="pkg", plugin="plugin", name="name?", namespace="namespace?"),
            "remappings": _remappings(node),
            "parameters": _parameters(node),
            "extra_arguments": _parameters(node, "extra_arg"),
        }
        node.assert_entity_completely_parsed()
        found.append(ComposableNode(**keywords))
    return found


def _lifecycle_transition(entity: Entity) -> Keywords:
    labels = {
        "configure": 1,
        "cleanup": 2,
        "activate": 3,
        "deactivate": 4,
        "unconfigured_shutdown": 5,
        "inactive_shutdown": 6,
        "active_shutdown": 7,
    }
    found: dict[str, list[Any]] = {"lifecycle_node_names": [], "transition_ids": []}
    for node in entity.nested("lifecycle_node"):
        found["lifecycle_node_names"].append(parse_substitution(node.get("name")))
        node.assert_entity_completely_parsed()
    for transition in entity.nested("transition"):
        label = transition.get("type")
        transition.assert_entity_completely_parsed()
        if label not in labels:
            raise ValueError(f"Unknown transition '{label}'; it must be one of {', '.join(labels)}")
        found["transition_ids"].append(labels[label])
    return found


def _node_container(entity: Entity) -> Keywords:
    keywords = _node(entity)
    keywords.setdefault("namespace", None)
    return {**keywords, "composable_node_descriptions": _composable_nodes(entity)}


def _load_composable_node(entity: Entity) -> Keywords:
    return {
        **texts(entity, target_container="target"),
        "composable_node_descriptions": _composable_nodes(entity),
    }


def _ros_timer(entity: Entity) -> Keywords:
    entity.get("period", float)  # it must be there
    return {**values(entity, float, "period"), "actions": build_all(entity)}


def _set_parameter(entity: Entity) -> Keywords:
    value = parse_if_substitutions(entity.get("value", None))
    return {**texts(entity, name="name"), "value": ParameterValue(value)}


def _set_use_sim_time(entity: Entity) -> Keywords:
    value = entity.get("value", bool)
    return {"value": parse_substitution(value) if isinstance(value, str) else value}


def _namespace(entity: Entity) -> Keywords:
    return texts(entity, namespace="namespace")


_ACTIONS = "launch_ros.actions:"
FORMS: dict[str, tuple[str, Callable[[Entity], Keywords]]] = {
    "lifecycle_node": (f"{_ACTIONS}LifecycleNode", _lifecycle_node),
    "lifecycle_transition": (f"{_ACTIONS}LifecycleTransition", _lifecycle_transition),
    "load_composable_node": (f"{_ACTIONS}LoadComposableNodes", _load_composable_node),
    "node": (f"{_ACTIONS}Node", _node),
    "node_container": (f"{_ACTIONS}ComposableNodeContainer", _node_container),
    "push-ros-namespace": (f"{_ACTIONS}PushROSNamespace", _namespace),
    "push_ros_namespace": (f"{_ACTIONS}PushROSNamespace", _namespace),
    "ros_timer": (f"{_ACTIONS}RosTimer", _ros_timer),
    "set_parameter": (f"{_ACTIONS}SetParameter", _set_parameter),
    "set_parameters_from_file": (
        f"{_ACTIONS}SetParametersFromFile",
        lambda entity: texts(entity, filename="filename", node_name="node?"),
    ),
    "set_remap": (f"{_ACTIONS}SetRemap", lambda entity: texts(entity, src="from", dst="to")),
    "set_ros_log_dir": (
        f"{_ACTIONS}SetROSLogDir",
        lambda entity: texts(entity, new_log_dir="new_log_dir"),
    ),
    "set_use_sim_time": (f"{_ACTIONS}SetUseSimTime", _set_use_sim_time),
}
