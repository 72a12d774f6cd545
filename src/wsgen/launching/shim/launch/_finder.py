"""How the names of the real packages are found in the modules that are here.

The real `launch` has a file a class, `launch.actions.timer_action` and eighty more, and users
import from them. Here a package's classes are in one module. What `import launch.actions` shows is
what the original shows, not what the module needs for itself: a name that is missing there is
missing here, too.

A launch file uses a dozen of the hundred names; importing the rest would cost more than the
evaluation. So a package imports what a name needs when it is first asked for.
"""

from __future__ import annotations

import importlib
import os
import sys
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence


def _read_names() -> dict[str, dict[str, str]]:
    """By package, as `names.txt` describes it."""
    names: dict[str, dict[str, str]] = {}
    with open(os.path.join(os.path.dirname(__file__), "names.txt"), encoding="utf-8") as stream:
        for line in stream:
            name, _, home = line.strip().partition(" ")
            if line.startswith("  "):
                names[next(reversed(names))][name] = home
            elif name and name != "#":
                names[name] = {}
    return names


NAMES = _read_names()  # the public names of a package -> the modules that define them
# Likewise, of packages that import a module of their own when a name of it is asked for.
ON_DEMAND = {name: NAMES.pop(name) for name in ("launch", "launch.frontend", "launch_ros")}
HOMES = NAMES.pop("elsewhere")  # a module of the original -> that which has its content here


def names_on_demand(package: str) -> Callable[[str], Any]:
    """The `__getattr__` of a package of `ON_DEMAND`."""

    def find(name: str) -> Any:
        home = ON_DEMAND[package].get(name)
        if home is None:
            raise _missing(package, name)
        if home:
            value = getattr(importlib.import_module(f"{package}.{home}"), name)
        else:
            value = importlib.import_module(f"{package}.{name}")
        setattr(sys.modules[package], name, value)
        return value

    return find


def show_public_names(module: str) -> None:
    """Let a module show its public names alone; its functions see all of it."""
    sys.modules[module].__class__ = _Shown
    vars(sys.modules[module]).update(__path__=[], __all__=[*NAMES[module]])


class Finder:
    """A meta path finder for what `HOMES` and `NAMES` list."""

    @staticmethod
    def find_spec(
        name: str, _path: Sequence[str] | None = None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The spec of a module that is defined elsewhere; None for all others."""
        home = _home(name) if name.startswith("launch") else None
        if home is None:
            return None
        return ModuleSpec(
            name,
            _Loader(home),  # type: ignore[arg-type]  # `importlib.abc` takes longer than the rest
            is_package=name in NAMES,
        )


class _Loader:
    def __init__(self, home: str) -> None:
        self._home = home

    @staticmethod
    def create_module(_spec: ModuleSpec) -> None:
        """Take an ordinary module."""

    def exec_module(self, module: ModuleType) -> None:
        """Show in it what its home defines."""
        public = NAMES.get(module.__name__)
        namespace = vars(importlib.import_module(self._home))

        def find(name: str) -> Any:
            if public is not None and public.get(name) == "":
                return importlib.import_module(f"{module.__name__}.{name}")
            if name not in namespace or not (public is None or name in public):
                raise _missing(module.__name__, name)
            return namespace[name]

        vars(module)["__getattr__"] = find
        vars(module)["__all__"] = _names_of_star(module.__name__, namespace)


class _Shown(ModuleType):
    def __getattribute__(self, name: str) -> Any:
        if name.startswith("__"):
            return super().__getattribute__(name)
        module = super().__getattribute__("__name__")
        home = NAMES[module].get(name)
        if home == "":
            return importlib.import_module(f"{module}.{name}")
        if home or f"{module}.{name}" in sys.modules:
            return super().__getattribute__(name)
        raise _missing(module, name)


def _home(name: str) -> str | None:
    """The module that has what the module of that name has in the original."""
    if name in HOMES:
        return HOMES[name]
    package, _, module = name.rpartition(".")
    if module in NAMES.get(package, {}).values():
        return HOMES.get(package, package)
    return None


def _names_of_star(name: str, namespace: Mapping[str, Any]) -> list[str]:
    """What `import *` gives: a module below a package gives all that the package defines."""
    if name in NAMES:
        return [*NAMES[name]]
    package, _, module = name.rpartition(".")
    above = NAMES.get(package, {})
    if module in above.values():
        return [shown for shown, home in above.items() if home]
    return [shown for shown in namespace if not shown.startswith("_")]


def _missing(module: str, name: str) -> AttributeError:
    return AttributeError(f"module {module!r} has no attribute {name!r}")
