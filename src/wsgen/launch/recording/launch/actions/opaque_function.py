"""A function of the user."""

from __future__ import annotations

from collections.abc import Iterable as _Iterable
from typing import TYPE_CHECKING, Any

from launch.action import Action
from launch.utilities.ensure_argument_type_impl import ensure_argument_type

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from launch.launch_context import LaunchContext


class OpaqueFunction(Action):
    """Called with the context when it is visited; the list it gives is visited next."""

    def __init__(
        self,
        *,
        function: Callable[..., Any],
        args: Iterable[Any] | None = None,
        kwargs: Mapping[str, Any] | None = None,
        **left_over_kwargs: Any,
    ) -> None:
        super().__init__(**left_over_kwargs)
        if not callable(function):
            raise TypeError(
                f"OpaqueFunction expected a callable for 'function', got '{type(function)}'"
            )
        ensure_argument_type(args, [_Iterable, type(None)], "args", "OpaqueFunction")
        ensure_argument_type(kwargs, [dict, type(None)], "kwargs", "OpaqueFunction")
        self.__function = function
        self.__args = () if args is None else tuple(args)
        self.__kwargs = {} if kwargs is None else dict(kwargs)

    def execute(self, context: LaunchContext) -> Any:
        """Call it."""
        return self.__function(context, *self.__args, **self.__kwargs)
