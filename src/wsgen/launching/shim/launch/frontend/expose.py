"""Tags and substitutions that packages add to XML and YAML.

A package registers them when its module is imported; an entry point of its distribution names the
module. What a package of Gazebo adds is known where it is not installed, too.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import inspect
from typing import TYPE_CHECKING, Any

from wsgen.launching.record import RECORD, caller

if TYPE_CHECKING:
    from collections.abc import Callable

GROUP = "launch.frontend.launch_extension"
_KNOWN = ("ros_gz_sim.actions", "ros_gz_bridge.actions")

# Name -> what gives a class and its keywords, for an entity and a parser.
action_parse_methods: dict[str, Callable[..., Any]] = {}
# Name -> the same, for a list of arguments.
substitution_parse_methods: dict[str, Callable[..., Any]] = {}
_loaded: list[str] = []


def expose_action(name: str) -> Callable[[Any], Any]:
    """A decorator: a class with the method `parse`, or a function, is what the tag means."""
    return _decorator(name, action_parse_methods, "action")


def expose_substitution(name: str) -> Callable[[Any], Any]:
    """A decorator: a class with the method `parse`, or a function, is what `$(name)` means."""
    return _decorator(name, substitution_parse_methods, "substitution")


def _decorator(name: str, methods: dict[str, Callable[..., Any]], what: str) -> Callable[..., Any]:
    def register(exposed: Any) -> Any:
        method = exposed if inspect.isfunction(exposed) else getattr(exposed, "parse", None)
        if not callable(method):
            raise RuntimeError(  # noqa: TRY004  its type is that of the original
                f"Exposed {what} parser for {name} is not a callable or a class containing a "
                "parse method"
            )
        if methods.setdefault(name, method) != method:
            raise RuntimeError(f"Two {what} parsing methods exposed with the same name: [{name}].")
        return exposed

    return register


def registered(name: str, methods: dict[str, Callable[..., Any]]) -> Callable[..., Any] | None:
    """What a name means that launch itself does not know; packages are asked when one is met."""
    if name not in methods:
        load_extensions()
    return methods.get(name)


def load_extensions() -> None:
    """Import what packages add, once; one that cannot be imported is left out."""
    if _loaded:
        return
    RECORD.require_plain(lambda: False)
    points = importlib.metadata.entry_points(group=GROUP)
    for module in dict.fromkeys((*(point.module for point in points), *_KNOWN)):
        _loaded.append(module)
        try:
            importlib.import_module(module)
        except Exception as error:  # noqa: BLE001  foreign code
            why = f"the launch extension cannot be imported: {error}"
            RECORD.note_unresolved(module, why, caller())
