"""The buffer that nodes look transforms up in (tf2_ros_py/tf2_ros/buffer.py of geometry2)."""

from __future__ import annotations

import threading
from time import sleep
from typing import TYPE_CHECKING, Any

from rclpy.clock import Clock, JumpThreshold
from rclpy.duration import Duration
from rclpy.logging import get_logger
from rclpy.task import Future

from tf2_py import BufferCore
from tf2_ros.buffer_interface import BufferInterface

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["Buffer"]

POLL_SECONDS = 0.02
# A clock that went back further than this since the wait began belongs to a bag that starts again.
JUMP_BACK_SECONDS = 3.0


class Buffer(BufferCore, BufferInterface):
    """Keeps transforms for a while, and waits for those that are not there yet.

    With a node it offers the service `tf2_frames`, and is emptied when the node's clock jumps back.
    """

    def __init__(self, cache_time: Any = None, node: Any = None) -> None:
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        self._callbacks_lock = threading.RLock()
        self._new_data_callbacks: list[Callable[[], None]] = []
        if node is not None:
            from tf2_msgs.srv import FrameGraph

            def frames(request: Any, response: Any) -> Any:
                del request
                response.frame_yaml = self.all_frames_as_yaml()
                return response

            self.srv = node.create_service(FrameGraph, "tf2_frames", frames)
            self.clock = node.get_clock()
        else:
            self.clock = Clock()
        threshold = JumpThreshold(
            min_forward=None, min_backward=Duration(seconds=-1), on_clock_change=True
        )
        self.jump_handle = self.clock.create_jump_callback(
            threshold, post_callback=self.time_jump_callback
        )

    def time_jump_callback(self, time_jump: Any) -> None:
        """Forget what has not happened yet."""
        del time_jump
        # Not for each message, where two simulators publish /clock.
        get_logger("tf2_buffer").warning(
            "Detected jump back in time. Clearing tf buffer.", throttle_duration_sec=2.0
        )
        self.clear()

    def set_transform(self, transform: Any, authority: str) -> None:
        """Add a transform of a frame that may move."""
        super().set_transform(transform, authority)
        self._call_new_data_callbacks()

    def set_transform_static(self, transform: Any, authority: str) -> None:
        """Add a transform that holds at all times."""
        super().set_transform_static(transform, authority)
        self._call_new_data_callbacks()

    def lookup_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Any = Duration(),
    ) -> Any:
        """Where the source frame is in the target frame; Time() stands for the latest.

        It waits for as long as the timeout says, then raises what is wrong.
        """
        self.can_transform(target_frame, source_frame, time, timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

    async def lookup_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """As `lookup_transform`, and waits for as long as it takes."""
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform_core(target_frame, source_frame, time)

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
        frames = (target_frame, target_time, source_frame, source_time, fixed_frame)
        self.can_transform_full(*frames, timeout)
        return self.lookup_transform_full_core(*frames)

    async def lookup_transform_full_async(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> Any:
        """As `lookup_transform_full`, and waits for as long as it takes."""
        frames = (target_frame, target_time, source_frame, source_time, fixed_frame)
        await self.wait_for_transform_full_async(*frames)
        return self.lookup_transform_full_core(*frames)

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Any,
        timeout: Any = Duration(),
        return_debug_tuple: bool = False,
    ) -> Any:
        """Whether a lookup would succeed before the timeout has passed."""
        found = _wait_for(
            lambda: self.can_transform_core(target_frame, source_frame, time), timeout
        )
        return found if return_debug_tuple else found[0]

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
        timeout: Any = Duration(),
        return_debug_tuple: bool = False,
    ) -> Any:
        """Whether a lookup through a fixed frame would succeed before the timeout has passed."""
        frames = (target_frame, target_time, source_frame, source_time, fixed_frame)
        found = _wait_for(lambda: self.can_transform_full_core(*frames), timeout)
        return found if return_debug_tuple else found[0]

    def wait_for_transform_async(self, target_frame: str, source_frame: str, time: Any) -> Any:
        """A future that has the transform when it is there."""
        return self._when_possible(
            lambda: self.can_transform_core(target_frame, source_frame, time)[0],
            lambda: self.lookup_transform_core(target_frame, source_frame, time),
        )

    def wait_for_transform_full_async(
        self,
        target_frame: str,
        target_time: Any,
        source_frame: str,
        source_time: Any,
        fixed_frame: str,
    ) -> Any:
        """A future that has the transform through a fixed frame when it is there."""
        frames = (target_frame, target_time, source_frame, source_time, fixed_frame)
        return self._when_possible(
            lambda: self.can_transform_full_core(*frames)[0],
            lambda: self.lookup_transform_full_core(*frames),
        )

    def _when_possible(self, is_possible: Callable[[], bool], lookup: Callable[[], Any]) -> Any:
        future = Future()

        def try_it() -> None:
            if future.done():  # cancelled, by who waited
                return
            try:
                if is_possible():
                    future.set_result(lookup())
            except Exception as error:  # noqa: BLE001  it is for who waits
                future.set_exception(error)

        with self._callbacks_lock:
            try_it()
            if not future.done():
                self._new_data_callbacks.append(try_it)
                future.add_done_callback(lambda _: self._remove_callback(try_it))
        return future

    def _call_new_data_callbacks(self) -> None:
        with self._callbacks_lock:
            for callback in tuple(self._new_data_callbacks):
                callback()

    def _remove_callback(self, callback: Callable[[], None]) -> None:
        with self._callbacks_lock:
            if callback in self._new_data_callbacks:
                self._new_data_callbacks.remove(callback)


def _wait_for(is_possible: Callable[[], tuple[bool, str]], timeout: Any) -> tuple[bool, str]:
    """Ask until it is possible or the timeout has passed, by the clock of the wall."""
    found = is_possible()
    if timeout == Duration() or found[0]:
        return found
    clock = Clock()
    start = clock.now()
    jump = Duration(seconds=JUMP_BACK_SECONDS)
    while not found[0] and clock.now() < start + timeout and clock.now() + jump >= start:
        sleep(POLL_SECONDS)
        found = is_possible()
    return found
