"""`tf2_py` for nodes where it is not installed: the buffer of transforms, and what it raises.

ROS has it as an extension in C++, which PyPI lacks. Semantics and messages are those of
`tf2::BufferCore` (geometry2, tf2/src/buffer_core.cpp) behind `tf2_py/src/tf2_py.cpp`.
"""

from __future__ import annotations

from typing import Any

from tf2_py._frames import (
    DEFAULT_CACHE_NANOSECONDS,
    SECOND,
    ConnectivityException,
    ExtrapolationException,
    Frames,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    Transform,
    TransformException,
)

__all__ = [
    "BufferCore",
    "ConnectivityException",
    "ExtrapolationException",
    "InvalidArgumentException",
    "LookupException",
    "TimeoutException",
    "TransformException",
]


class BufferCore:
    """Keeps transforms for a while, and says where frames are in other ones.

    Times and durations are those of rclpy or of builtin_interfaces; transforms are
    geometry_msgs/TransformStamped.
    """

    def __init__(self, cache_time: Any = None) -> None:
        nanoseconds = DEFAULT_CACHE_NANOSECONDS if cache_time is None else _nanoseconds(cache_time)
        self._frames = Frames(nanoseconds, _warn)

    def set_transform(self, transform: Any, authority: str) -> None:
        """Add a transform of a frame that may move."""
        self._set(transform, authority, is_static=False)

    def set_transform_static(self, transform: Any, authority: str) -> None:
        """Add a transform that holds at all times."""
        self._set(transform, authority, is_static=True)

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """Where the source frame is in the target frame; Time() stands for the latest."""
        found = self._frames.lookup(_text(target_frame), _text(source_frame), _nanoseconds(time))
        return _message(found, target_frame, source_frame)

    def lookup_transform_full_core(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> Any:
        """Where the source frame was in the target frame of another time."""
        found = self._frames.lookup_through(
            _text(target_frame),
            _nanoseconds(target_time),
            _text(source_frame),
            _nanoseconds(source_time),
            _text(fixed_frame),
        )
        return _message(found, target_frame, source_frame)

    def can_transform_core(
        self, target_frame: str, source_frame: str, time: Any
    ) -> tuple[bool, str]:
        """Whether a lookup would succeed, and why it would not."""
        reason = self._frames.refusal(_text(target_frame), _text(source_frame), _nanoseconds(time))
        return not reason, reason

    def can_transform_full_core(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> tuple[bool, str]:
        """Whether a lookup through a fixed frame would succeed, and why it would not."""
        reason = self._frames.refusal_through(
            _text(target_frame),
            _nanoseconds(target_time),
            _text(source_frame),
            _nanoseconds(source_time),
            _text(fixed_frame),
        )
        return not reason, reason

    def get_latest_common_time(self, target_frame: str, source_frame: str) -> Any:
        """The latest time at which a lookup between two frames succeeds."""
        from rclpy.time import Time

        stamp = self._frames.latest_common_stamp(_text(target_frame), _text(source_frame))
        return Time(nanoseconds=stamp)

    def all_frames_as_yaml(self) -> str:
        """Each frame with its parent, its broadcaster and its rate."""
        return self._frames.as_yaml()

    def all_frames_as_string(self) -> str:
        """A line for each frame with its parent."""
        return self._frames.as_text()

    def clear(self) -> None:
        """Forget all transforms that are not static."""
        self._frames.clear()

    def _frameExists(self, frame_id_str: str) -> bool:  # noqa: N802  tf2's name
        return frame_id_str in self._frames.names()

    def _getFrameStrings(self) -> list[str]:  # noqa: N802  tf2's name
        return self._frames.names()

    def _set(self, transform: Any, authority: str, *, is_static: bool) -> None:
        place, turn = transform.transform.translation, transform.transform.rotation
        self._frames.add(
            parent=transform.header.frame_id,
            child=transform.child_frame_id,
            stamp=_nanoseconds(transform.header.stamp),
            translation=(place.x, place.y, place.z),
            rotation=(turn.x, turn.y, turn.z, turn.w),
            authority=authority,
            is_static=is_static,
        )


def _nanoseconds(time: Any) -> int:
    """Of a time or a duration, whether rclpy's or a message."""
    if hasattr(time, "nanosec"):
        return int(time.sec) * SECOND + int(time.nanosec)
    if hasattr(time, "nanoseconds"):
        return int(time.nanoseconds)
    raise TypeError("time must have sec and nanosec, or nanoseconds.")


def _text(frame: str) -> str:
    if not isinstance(frame, str):
        raise TypeError(f"a frame must be a str, not {type(frame).__name__}")
    return frame


def _message(found: Transform, target: str, source: str) -> Any:
    from geometry_msgs.msg import TransformStamped

    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = target, source
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(found.stamp, SECOND)
    place, turn = message.transform.translation, message.transform.rotation
    place.x, place.y, place.z = found.translation
    turn.x, turn.y, turn.z, turn.w = found.rotation
    return message


def _warn(text: str) -> None:
    from rclpy.logging import get_logger

    logger = get_logger("tf2")
    if text.startswith("TF_OLD_DATA"):
        logger.warning(text)
    else:
        logger.error(text)
