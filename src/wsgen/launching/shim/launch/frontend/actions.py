"""The actions that XML and YAML know by name, but for those of ROS."""

from __future__ import annotations

import copy
import importlib
import shlex
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from launch.actions import ForEach, ForLoop, OpaqueFunction
from launch.base import TextSubstitution
from launch.frontend.expose import action_parse_methods, load_extensions, registered
from launch.frontend.template import parse_substitution, unescape
from launch.launch_context import local_of
from wsgen.launching.record import RECORD, locate

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from launch.base import Action, LaunchDescriptionEntity, SomeSubstitutionsType, Substitution
    from launch.frontend.parser import Entity

    Keywords = dict[str, Any]
    from launch.launch_context import LaunchContext


def build(entity: Entity) -> Action:
    """The action of an entity, which remembers its line."""
    around, RECORD.reading = RECORD.reading, entity.location
    try:
        action, keywords = _parse(entity)
        entity.assert_entity_completely_parsed()
        made: Action = action(**keywords)
    except Exception as error:
        locate(error, entity.location)
        raise
    finally:
        RECORD.reading = around
    return made


def _parse(entity: Entity) -> tuple[Callable[..., Action], Keywords]:
    form = _forms().get(entity.type_name)
    if form is not None:
        name, read = form
        module, _, action = name.partition(":")
        return getattr(importlib.import_module(module), action), {
            **condition(entity),
            **read(entity),
        }
    parse = registered(entity.type_name, action_parse_methods)
    if parse is None:
        raise RuntimeError(f"Unrecognized entity of the type: {entity.type_name}")
    from launch.frontend.parser import Parser

    found: tuple[Callable[..., Action], Keywords] = parse(entity, Parser())
    return found


def keywords_of(action: type[Action], entity: Entity, ignore: Iterable[str] = ()) -> Keywords:
    """What an action takes from an entity, for actions of packages that go on from there."""
    readers = dict(_forms().values())
    bases = [f"{base.__module__}:{base.__name__}" for base in action.__mro__]
    nothing: Callable[[Entity], Keywords] = lambda _entity: {}  # noqa: E731  a default
    read = next((readers[base] for base in bases if base in readers), nothing)
    if read is _executable and "cmd" in ignore:
        read = process
    return {**condition(entity), **read(entity)}


@contextmanager
def reading(entity: Entity) -> Iterator[None]:
    """What is made in the context is written in this entity."""
    around, RECORD.reading = RECORD.reading, entity.location
    try:
        yield
    finally:
        RECORD.reading = around


def build_all(entity: Entity) -> list[Action]:
    """The actions of all nested entities."""
    return [build(child) for child in entity.children]


def condition(entity: Entity) -> Keywords:
    """What decides whether the action is executed."""
    holds = entity.get("if", optional=True)
    holds_not = entity.get("unless", optional=True)
    if holds is not None and holds_not is not None:
        raise RuntimeError("if and unless conditions can't be used simultaneously")
    if holds is not None:
        from launch.conditions import IfCondition

        return {"condition": IfCondition(parse_substitution(str(holds)))}
    if holds_not is not None:
        from launch.conditions import UnlessCondition

        return {"condition": UnlessCondition(parse_substitution(str(holds_not)))}
    return {}


def texts(entity: Entity, **names: str) -> Keywords:
    """Keywords whose attributes hold substitutions; a name that ends in `?` is optional."""
    found = {}
    for keyword, name in names.items():
        value = entity.get(name.rstrip("?"), optional=name.endswith("?"))
        if value is not None:
            found[keyword] = parse_substitution(value)
    return found


def values(entity: Entity, kind: Any, *names: str) -> Keywords:
    """Optional attributes that are no texts, under their own names; a text is a substitution."""
    found = {}
    for name in names:
        value = entity.get(name, kind, optional=True)
        if value is not None:
            found[name] = parse_substitution(value) if isinstance(value, str) else value
    return found


def pairs(
    entity: Entity, name: str, first: str, second: str
) -> list[tuple[tuple[Substitution, ...], list[Substitution]]]:
    """Two attributes each of nested entities; the first of a pair can be the key of a mapping."""
    found = []
    for nested in entity.nested(name):
        with reading(nested):
            one, other = nested.get(first), nested.get(second)
            nested.assert_entity_completely_parsed()
            found.append((tuple(parse_substitution(one)), parse_substitution(other)))
    return found


def command_line(text: str) -> list[list[Substitution]]:
    """The words of a text, which blanks separate unless they come out of substitutions."""
    words: list[list[Substitution]] = [[]]
    for part in parse_substitution(text):
        if not isinstance(part, TextSubstitution):
            words[-1].append(part)
            continue
        if part.text[:1].isspace():
            words.append([])
        for index, token in enumerate(shlex.split(part.text)):
            if index:
                words.append([])
            words[-1].append(TextSubstitution(text=token))
        if part.text[-1:].isspace():
            words.append([])
    return [word for word in words if word]


def process(entity: Entity) -> Keywords:
    """What all processes take, nodes too."""
    found = {
        **texts(entity, cwd="cwd?", prefix="launch-prefix?", output="output?"),
        **values(entity, float, "respawn_delay"),
        **values(entity, float, "sigterm_timeout", "sigkill_timeout"),
        **values(entity, bool, "shell", "emulate_tty", "respawn"),
        **values(entity, int, "respawn_max_retries"),
    }
    on_exit = entity.get("on_exit", optional=True)
    if on_exit is not None:
        if on_exit != "shutdown":
            raise ValueError(
                "Attribute on_exit of Entity node expected to be shutdown but got "
                f"`{on_exit}`Other on_exit actions not yet supported"
            )
        from launch.actions import Shutdown

        found["on_exit"] = [Shutdown()]
    environment = pairs(entity, "env", "name", "value")
    if environment:
        found["additional_env"] = dict(environment)
    return found


def _arg(entity: Entity) -> Keywords:
    found = {
        "name": unescape(entity.get("name")),
        **texts(entity, default_value="default?"),
    }
    description = entity.get("description", optional=True)
    if description is not None:
        found["description"] = unescape(description)
    choices = entity.nested("choice")
    if choices:
        found["choices"] = [unescape(choice.get("value")) for choice in choices]
    return found


def _executable(entity: Entity) -> Keywords:
    return {
        **process(entity),
        **texts(entity, name="name?"),
        "cmd": command_line(entity.get("cmd")),
    }


def _group(entity: Entity) -> Keywords:
    kept = pairs(entity, "keep", "name", "value")
    return {
        **values(entity, bool, "scoped", "forwarding"),
        **({"launch_configurations": dict(kept)} if kept else {}),
        "actions": [build(child) for child in entity.children if child.type_name != "keep"],
    }


def _include(entity: Entity) -> Keywords:
    given = [*pairs(entity, "arg", "name", "value"), *pairs(entity, "let", "name", "value")]
    return {
        **texts(entity, launch_description_source="file"),
        **({"launch_arguments": given} if given else {}),
    }


def _timer(entity: Entity) -> Keywords:
    entity.get("period", float)  # it must be there
    return {
        **values(entity, float, "period"),
        **values(entity, bool, "cancel_on_shutdown"),
        "actions": build_all(entity),
    }


def _for_each(entity: Entity) -> Keywords:
    return {**texts(entity, input_values="values"), "entities": build_all(entity)}


def _for(entity: Entity) -> Keywords:
    return {
        **texts(entity, length="len"),
        "name": entity.get("name"),
        "entities": build_all(entity),
    }


def _message(entity: Entity) -> Keywords:
    return texts(entity, msg="message")


def _name_and_value(entity: Entity) -> Keywords:
    return texts(entity, name="name", value="value")


def _append(entity: Entity) -> Keywords:
    return {
        **texts(entity, name="name", value="value", separator="separator?"),
        **values(entity, bool, "prepend"),
    }


def _reason(entity: Entity) -> Keywords:
    reason = entity.get("reason", optional=True)
    return {} if reason is None else {"reason": reason}


_ACTIONS = "launch.actions:"
_FORMS: dict[str, tuple[str, Callable[[Entity], Keywords]]] = {
    "append_env": (f"{_ACTIONS}AppendEnvironmentVariable", _append),
    "arg": (f"{_ACTIONS}DeclareLaunchArgument", _arg),
    "executable": (f"{_ACTIONS}ExecuteProcess", _executable),
    "for": ("launch.frontend.actions:ForLoopOfEntities", _for),
    "for_each": ("launch.frontend.actions:ForEachOfEntities", _for_each),
    "group": (f"{_ACTIONS}GroupAction", _group),
    "include": (f"{_ACTIONS}IncludeLaunchDescription", _include),
    "let": (f"{_ACTIONS}SetLaunchConfiguration", _name_and_value),
    "log": (f"{_ACTIONS}LogInfo", _message),
    "log_debug": (f"{_ACTIONS}LogDebug", _message),
    "log_error": (f"{_ACTIONS}LogError", _message),
    "log_info": (f"{_ACTIONS}LogInfo", _message),
    "log_warning": (f"{_ACTIONS}LogWarning", _message),
    "reset_env": (f"{_ACTIONS}ResetEnvironment", lambda _entity: {}),
    "set_env": (f"{_ACTIONS}SetEnvironmentVariable", _name_and_value),
    "shutdown": (f"{_ACTIONS}Shutdown", _reason),
    "timer": (f"{_ACTIONS}TimerAction", _timer),
    "unset": (f"{_ACTIONS}UnsetLaunchConfiguration", lambda entity: texts(entity, name="name")),
    "unset_env": (f"{_ACTIONS}UnsetEnvironmentVariable", lambda entity: texts(entity, name="name")),
}


def _forms() -> dict[str, tuple[str, Callable[[Entity], Keywords]]]:
    """The actions of launch and launch_ros by tag, and what reads their keywords."""
    from launch_ros.frontend import FORMS

    return {**_FORMS, **FORMS}


def known_tags() -> list[str]:
    """All tags, for the documentation."""
    load_extensions()
    return sorted({*_forms(), *action_parse_methods})


class ForEachOfEntities(ForEach):
    """The same from XML or YAML: nested entities, made anew for each."""

    def __init__(
        self, input_values: SomeSubstitutionsType, *, entities: list[Action], **kwargs: Any
    ) -> None:
        super().__init__(
            input_values, function=lambda **values: _with_locals(entities, values), **kwargs
        )


class ForLoopOfEntities(ForLoop):
    """The same from XML or YAML: nested entities, made anew for each."""

    def __init__(
        self, length: SomeSubstitutionsType, *, name: str, entities: list[Action], **kwargs: Any
    ) -> None:
        super().__init__(
            length, function=lambda i: _with_locals(entities, {name: i}), name=name, **kwargs
        )


def _with_locals(
    entities: list[Action], values: Mapping[str, Any]
) -> list[LaunchDescriptionEntity]:
    """Copies of the entities, between setting the variables and unsetting them."""
    locals_of_loop = {local_of(name): str(value) for name, value in values.items()}

    def begin(context: LaunchContext) -> None:
        context._push_locals()  # noqa: SLF001  a friend of the context
        context.extend_locals(locals_of_loop)

    def end(context: LaunchContext) -> None:
        context._pop_locals()  # noqa: SLF001  same

    return [
        OpaqueFunction(function=begin),
        *copy.deepcopy(entities),
        OpaqueFunction(function=end),
    ]
