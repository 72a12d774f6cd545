"""What nodes execute at their start: rclpy is to show exceptions of lifecycle nodes.

rclpy makes any exception of `on_configure()` and the other callbacks of a transition an ERROR, and
says nothing about it. Here it is logged before rclpy takes it; all else is rclpy's. Nothing happens
in a process that does not import `rclpy.lifecycle`.

Python executes one module of this name, the first that it finds: that which it would have found
without this folder is executed, too.

Source: ros2/rclpy, rclpy/rclpy/lifecycle/node.py (`__register_callback`, `__execute_callback`).
"""

from __future__ import annotations

import sys

TYPE_CHECKING = False  # that of typing takes time at the start of every program
if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType
    from typing import Any

PATCHED = "rclpy.lifecycle.node"
REGISTER = "_LifecycleNodeMixin__register_callback"


class LifecycleFinder:
    """Finds rclpy's module, and has it changed when it was executed."""

    def __init__(self) -> None:
        self._is_asking = False  # the other finders

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """As `importlib.abc.MetaPathFinder`."""
        if name != PATCHED or self._is_asking:
            return None
        self._is_asking = True
        try:
            spec = find_spec(name, path, target)
        finally:
            self._is_asking = False
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_change(module: ModuleType) -> None:
                execute(module)
                show_exceptions(module)

            spec.loader.exec_module = execute_and_change  # type: ignore[method-assign]  # of this one
        return spec


def find_spec(
    name: str, path: Sequence[str] | None, target: ModuleType | None = None
) -> ModuleSpec | None:
    """Find a module as an import does."""
    for finder in list(sys.meta_path):
        find = getattr(finder, "find_spec", None)
        spec: ModuleSpec | None = None if find is None else find(name, path, target)
        if spec is not None:
            return spec
    return None


def show_exceptions(module: ModuleType) -> None:
    """Have the callbacks that nodes register log what they raise."""
    mixin = getattr(module, "LifecycleNodeMixin", None)
    register = getattr(mixin, REGISTER, None)
    if register is None:  # another rclpy
        return

    def register_shown(node: Any, state: int, callback: Callable[[Any], Any]) -> Any:
        def shown(previous: Any) -> Any:
            try:
                return callback(previous)
            except Exception as error:
                tell(node, callback, error)
                raise

        return register(node, state, shown)

    setattr(mixin, REGISTER, register_shown)


def tell(node: Any, callback: Callable[[Any], Any], error: Exception) -> None:
    """Log an exception with its traceback, from the callback on."""
    import traceback

    name = getattr(callback, "__name__", "the callback of the transition")
    frames = error.__traceback__ and error.__traceback__.tb_next  # without this module's
    text = "".join(traceback.format_exception(type(error), error, frames))
    node.get_logger().error(f"{name}() raised an exception, so the transition fails:\n{text}")


def execute_next() -> None:
    """Execute the module of this name that comes after this folder, if there is one.

    One before it may be another of this kind, which has executed this one.
    """
    folder = __file__.rpartition("/")[0]
    start = sys.path.index(folder) + 1 if folder in sys.path else 0
    spec = find_spec(__name__, sys.path[start:])
    if spec is not None and spec.loader is not None:
        from importlib.util import module_from_spec

        module = module_from_spec(spec)
        sys.modules[__name__] = module
        spec.loader.exec_module(module)


# Another wsgen may have begun what starts this Python.
if not any(type(finder).__name__ == LifecycleFinder.__name__ for finder in sys.meta_path):
    sys.meta_path.insert(0, LifecycleFinder())
execute_next()
