"""What nodes execute at their start: two modules are changed when a node imports them.

rclpy makes any exception of `on_configure()` and the other callbacks of a transition an ERROR, and
says nothing about it. Here it is logged before rclpy takes it; all else is rclpy's. OpenCV ends a
node that shows a window where there is no screen: `opencv_windows` of the packages of wsgen, which
are on the path where no ROS is sourced, has it go on. Nothing happens in a process that imports
neither.

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

REGISTER = "_LifecycleNodeMixin__register_callback"


class ChangingFinder:
    """Finds the modules that are to be changed, and has it done when they were executed."""

    def __init__(self, changes: dict[str, Callable[[ModuleType], None]]) -> None:
        self._changes = changes  # by the name of the module
        # Those that other finders are asked for, or that are executed: OpenCV's package imports
        # its library by its own name.
        self._in_work: set[str] = set()

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """As `importlib.abc.MetaPathFinder`."""
        if name not in self._changes or name in self._in_work:
            return None
        self._in_work.add(name)
        try:
            spec = find_spec(name, path, target)
        finally:
            self._in_work.discard(name)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_change(module: ModuleType) -> None:
                self._in_work.add(name)
                try:
                    execute(module)
                finally:
                    self._in_work.discard(name)
                self._changes[name](module)

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
                notify(node, callback, error)
                raise

        return register(node, state, shown)

    setattr(mixin, REGISTER, register_shown)


def go_on_without_windows(module: ModuleType) -> None:
    """Have OpenCV's functions of windows do nothing where there are none."""
    try:
        import opencv_windows
    except ModuleNotFoundError:  # a ROS is sourced: all is as there
        return
    opencv_windows.put_in(module)


def notify(node: Any, callback: Callable[[Any], Any], error: Exception) -> None:
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
if not any(type(finder).__name__ == ChangingFinder.__name__ for finder in sys.meta_path):
    sys.meta_path.insert(
        0, ChangingFinder({"rclpy.lifecycle.node": show_exceptions, "cv2": go_on_without_windows})
    )
execute_next()
