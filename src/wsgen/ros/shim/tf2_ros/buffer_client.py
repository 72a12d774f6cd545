"""A buffer that asks a `buffer_server` by its action (tf2_ros_py/tf2_ros/buffer_client.py)."""

from __future__ import annotations

import threading
from time import monotonic, sleep
from typing import Any

from builtin_interfaces.msg import Time as TimeMessage
from rclpy.action import ActionClient
from rclpy.duration import Duration
from rclpy.time import Time
from tf2_msgs.action import LookupTransform

from tf2_py import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TimeoutException,
    TransformException,
)
from tf2_ros.buffer_interface import BufferInterface

__all__ = ["BufferClient"]


class BufferClient(BufferInterface):
    """Looks transforms up in the buffer of another process; spin its node in another thread."""

    def __init__(
        self,
        node: Any,
        ns: str,
        check_frequency: float = 10.0,
        timeout_padding: Any = Duration(seconds=2.0),
    ) -> None:
        super().__init__()
        self.node = node
        self.action_client = ActionClient(node, LookupTransform, action_name=ns)
        self.check_frequency = check_frequency
        self.timeout_padding = timeout_padding

    def wait_for_server(self, timeout_sec: float | None = None) -> bool:
        """Whether the server is there before the timeout has passed."""
        return bool(self.action_client.wait_for_server(timeout_sec))

    def lookup_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Any = Duration(),
    ) -> Any:
        """Where the source frame is in the target frame; Time() stands for the latest."""
        goal = LookupTransform.Goal(
            target_frame=target_frame,
            source_frame=source_frame,
            source_time=_message(time),
            timeout=timeout.to_msg(),
            advanced=False,
        )
        return self._ask(goal)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = Duration(),
    ) -> Any:
        """Where the source frame was in the target frame of another time."""
        goal = LookupTransform.Goal(
            target_frame=target_frame,
            target_time=_message(target_time),
            source_frame=source_frame,
            source_time=_message(source_time),
            fixed_frame=fixed_frame,
            timeout=timeout.to_msg(),
            advanced=True,
        )
        return self._ask(goal)

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Any = Duration(),
    ) -> bool:
        """Whether a lookup succeeds."""
        try:
            self.lookup_transform(target_frame, source_frame, time, timeout)
        except TransformException:
            return False
        return True

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = Duration(),
    ) -> bool:
        """Whether a lookup through a fixed frame succeeds."""
        try:
            self.lookup_transform_full(
                target_frame, target_time, source_frame, source_time, fixed_frame, timeout
            )
        except TransformException:
            return False
        return True

    def _ask(self, goal: Any) -> Any:
        seconds = Duration.from_msg(goal.timeout) + self.timeout_padding
        limit = monotonic() + seconds.nanoseconds / 1e9
        answered = threading.Event()
        accepted = self.action_client.send_goal_async(goal)
        accepted.add_done_callback(lambda _: answered.set())
        self._wait(answered, limit)
        handle = accepted.result()
        if handle is None or not handle.accepted:
            raise TransformException("The buffer server did not accept the goal.")
        answered.clear()
        result = handle.get_result_async()
        result.add_done_callback(lambda _: answered.set())
        self._wait(answered, limit)
        return _checked(result.result().result)

    def _wait(self, answered: threading.Event, limit: float) -> None:
        while not answered.is_set():
            if monotonic() > limit:
                raise TimeoutException(
                    "The LookupTransform goal sent to the BufferServer did not come back in the "
                    "specified time. Something is likely wrong with the server."
                )
            sleep(1.0 / self.check_frequency)


def _message(time: Any) -> Any:
    if isinstance(time, TimeMessage):
        return time
    if isinstance(time, Time):
        return time.to_msg()
    raise TypeError("Must pass a rclpy.time.Time object.")


def _checked(result: Any) -> Any:
    """The transform of a result, or what the server says is wrong."""
    error = result.error
    if error.error == error.NO_ERROR:
        return result.transform
    kinds = {
        error.LOOKUP_ERROR: LookupException,
        error.CONNECTIVITY_ERROR: ConnectivityException,
        error.EXTRAPOLATION_ERROR: ExtrapolationException,
        error.INVALID_ARGUMENT_ERROR: InvalidArgumentException,
        error.TIMEOUT_ERROR: TimeoutException,
    }
    raise kinds.get(error.error, TransformException)(error.error_string)
