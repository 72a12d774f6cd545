"""What all buffers can do: transform messages of the types that somebody has registered.

`tf2_geometry_msgs` and the like register theirs when they are imported, as in ROS
(tf2_ros_py/tf2_ros/buffer_interface.py of geometry2).
"""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, Any, ClassVar

from rclpy.duration import Duration
from std_msgs.msg import Header

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = [
    "BufferInterface",
    "ConvertRegistration",
    "NotImplementedException",
    "Stamped",
    "TransformRegistration",
    "TypeException",
    "convert",
]


class TypeException(Exception):
    """No conversion is registered for the type of a message."""

    def __init__(self, errstr: str) -> None:
        super().__init__(errstr)
        self.errstr = errstr


class NotImplementedException(Exception):
    """A buffer lacks what it must implement."""

    def __init__(self) -> None:
        super().__init__("CanTransform or LookupTransform not implemented")
        self.errstr = "CanTransform or LookupTransform not implemented"


class BufferInterface:
    """Transforms messages with a header by what `lookup_transform` of a subclass says."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(
        self,
        object_stamped: Any,
        target_frame: str,
        timeout: Any = Duration(),
        new_type: type | None = None,
    ) -> Any:
        """A message, seen from another frame at the time of its header."""
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = do_transform(
            object_stamped,
            self.lookup_transform(target_frame, header.frame_id, header.stamp, timeout),
        )
        return found if new_type is None else convert(found, new_type)

    def transform_full(
        self,
        object_stamped: Any,
        target_frame: str,
        target_time: Any,
        fixed_frame: str,
        timeout: Any = Duration(),
        new_type: type | None = None,
    ) -> Any:
        """A message, seen from another frame at another time; the fixed frame stays in between."""
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = do_transform(
            object_stamped,
            self.lookup_transform_full(
                target_frame, target_time, header.frame_id, header.stamp, fixed_frame, timeout
            ),
        )
        return found if new_type is None else convert(found, new_type)

    def lookup_transform(self, *_: Any, **__: Any) -> Any:
        """Where the source frame is in the target frame."""
        raise NotImplementedException

    def lookup_transform_full(self, *_: Any, **__: Any) -> Any:
        """Where the source frame was in the target frame of another time."""
        raise NotImplementedException

    def can_transform(self, *_: Any, **__: Any) -> Any:
        """Whether a lookup would succeed."""
        raise NotImplementedException

    def can_transform_full(self, *_: Any, **__: Any) -> Any:
        """Whether a lookup through a fixed frame would succeed."""
        raise NotImplementedException


def Stamped(obj: Any, stamp: Any, frame_id: str) -> Any:  # noqa: N802  tf2's name
    """The object with a header."""
    obj.header = Header(frame_id=frame_id, stamp=stamp)
    return obj


class TransformRegistration:
    """How messages of a type are transformed; one table for the process."""

    _callbacks: ClassVar[dict[type, Callable[[Any, Any], Any]]] = {}

    def print_me(self) -> None:
        """Print the table."""
        print(self._callbacks)  # noqa: T201  tf2's

    def add(self, key: type, callback: Callable[[Any, Any], Any]) -> None:
        """Register a type: `callback(message, transform)` gives the transformed message."""
        self._callbacks[key] = callback

    def get(self, key: type) -> Callable[[Any, Any], Any]:
        """What transforms a type; TypeException where nothing is registered."""
        return _registered(self._callbacks, key)


class ConvertRegistration:
    """How objects are converted to messages and back; one table for the process."""

    _from_messages: ClassVar[dict[type, Callable[[Any], Any]]] = {}
    _to_messages: ClassVar[dict[type, Callable[[Any], Any]]] = {}
    _conversions: ClassVar[dict[tuple[type, type], Callable[[Any], Any]]] = {}

    def add_from_msg(self, key: type, callback: Callable[[Any], Any]) -> None:
        """Register what makes an object of a type from a message."""
        self._from_messages[key] = callback

    def add_to_msg(self, key: type, callback: Callable[[Any], Any]) -> None:
        """Register what makes a message from an object of a type."""
        self._to_messages[key] = callback

    def add_convert(self, key: tuple[type, type], callback: Callable[[Any], Any]) -> None:
        """Register what makes an object of the second type from one of the first."""
        self._conversions[key] = callback

    def get_from_msg(self, key: type) -> Callable[[Any], Any]:
        """TypeException where nothing is registered."""
        return _registered(self._from_messages, key)

    def get_to_msg(self, key: type) -> Callable[[Any], Any]:
        """TypeException where nothing is registered."""
        return _registered(self._to_messages, key)

    def get_convert(self, key: tuple[type, type]) -> Callable[[Any], Any]:
        """TypeException where nothing is registered."""
        return _registered(self._conversions, key)


def convert(a: Any, b_type: type) -> Any:
    """An object of another type with the same content; a copy where it is of that type."""
    registration = ConvertRegistration()
    try:
        return registration.get_convert((type(a), b_type))(a)
    except TypeException:
        if type(a) is b_type:
            return deepcopy(a)
        return registration.get_from_msg(b_type)(registration.get_to_msg(type(a))(a))


def _registered(table: dict[Any, Callable[..., Any]], key: Any) -> Callable[..., Any]:
    if key not in table:
        raise TypeException(f"Type {key} is not loaded or supported")
    return table[key]
