"""`message_filters` for nodes where it is not installed: messages that belong together.

Names and arguments are those of ROS's package (ros2/message_filters, src/message_filters).
"""

from __future__ import annotations

import threading
from bisect import bisect_left
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

__all__ = [
    "ApproximateTimeSynchronizer",
    "Cache",
    "SimpleFilter",
    "Subscriber",
    "TimeSynchronizer",
]

SECOND = 10**9


class SimpleFilter:
    """Calls who registered, with each message."""

    def __init__(self) -> None:
        self.callbacks: dict[int, tuple[Callable[..., Any], tuple[Any, ...]]] = {}

    def registerCallback(self, cb: Callable[..., Any], *args: Any) -> int:  # noqa: N802
        """Call `cb(message…, *args)` from now on; returns a number of the connection."""
        connection = len(self.callbacks)
        self.callbacks[connection] = (cb, args)
        return connection

    def signalMessage(self, *msg: Any) -> None:  # noqa: N802
        """Call all who registered."""
        for callback, arguments in self.callbacks.values():
            callback(*msg, *arguments)


class Subscriber(SimpleFilter):
    """A subscription of a node."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__()
        self.node, self.topic = args[0], args[2] if len(args) > 2 else kwargs.get("topic")  # noqa: PLR2004
        kwargs.setdefault("qos_profile", 10)
        self.sub = self.node.create_subscription(*args[1:], callback=self.callback, **kwargs)

    def callback(self, msg: Any) -> None:
        """Pass a message on."""
        self.signalMessage(msg)

    def getTopic(self) -> Any:  # noqa: N802
        """The topic."""
        return self.topic


class Cache(SimpleFilter):
    """The last messages of a filter, by the time of their headers."""

    def __init__(
        self, f: SimpleFilter | None = None, cache_size: int = 1, allow_headerless: bool = False
    ) -> None:
        super().__init__()
        self.cache_size, self.allow_headerless = cache_size, allow_headerless
        self.cache_msgs: list[Any] = []
        self.cache_times: list[int] = []
        if f is not None:
            self.connectInput(f)

    def connectInput(self, f: SimpleFilter) -> None:  # noqa: N802
        """Take messages of a filter."""
        f.registerCallback(self.add)

    def add(self, msg: Any) -> None:
        """Take a message."""
        stamp = _stamp(msg, allow_headerless=self.allow_headerless)
        if stamp is None:
            return
        place = bisect_left(self.cache_times, stamp)
        self.cache_times.insert(place, stamp)
        self.cache_msgs.insert(place, msg)
        del self.cache_times[: -self.cache_size], self.cache_msgs[: -self.cache_size]
        self.signalMessage(msg)

    def getInterval(self, from_stamp: Any, to_stamp: Any) -> list[Any]:  # noqa: N802
        """The messages between two times, both included."""
        start, end = from_stamp.nanoseconds, to_stamp.nanoseconds
        both = zip(self.cache_times, self.cache_msgs, strict=True)
        return [msg for stamp, msg in both if start <= stamp <= end]

    def getElemAfterTime(self, stamp: Any) -> Any:  # noqa: N802
        """The first message at or after a time; None where there is none."""
        place = bisect_left(self.cache_times, stamp.nanoseconds)
        return self.cache_msgs[place] if place < len(self.cache_msgs) else None

    def getElemBeforeTime(self, stamp: Any) -> Any:  # noqa: N802
        """The last message before or at a time; None where there is none."""
        place = bisect_left(self.cache_times, stamp.nanoseconds + 1)
        return self.cache_msgs[place - 1] if place else None

    def getLast(self) -> Any:  # noqa: N802
        """The newest message."""
        return self.cache_msgs[-1] if self.cache_msgs else None


class TimeSynchronizer(SimpleFilter):
    """Passes on messages of several filters whose headers have the same time."""

    def __init__(self, fs: Sequence[SimpleFilter], queue_size: int) -> None:
        super().__init__()
        self.queue_size = queue_size
        self.lock = threading.Lock()
        self.queues: list[dict[int, Any]] = []
        self.connectInput(fs)

    def connectInput(self, fs: Sequence[SimpleFilter]) -> None:  # noqa: N802
        """Take messages of filters."""
        self.queues = [{} for _ in fs]
        for index, one in enumerate(fs):
            one.registerCallback(self._take, index)

    def add(self, msg: Any, my_queue: dict[int, Any], my_queue_index: int | None = None) -> None:
        """Take a message of the filter with that queue."""
        index = my_queue_index
        if index is None:
            index = next(i for i, queue in enumerate(self.queues) if queue is my_queue)
        self._take(msg, index)

    def _take(self, msg: Any, index: int) -> None:
        stamp = self._stamp_of(msg)
        if stamp is None:
            return
        with self.lock:
            queue = self.queues[index]
            queue[stamp] = msg
            while len(queue) > self.queue_size:
                del queue[min(queue)]
            found = self._match(index, stamp) if stamp in queue else None
            if found is None:
                return
            messages = [queue.pop(found[place]) for place, queue in enumerate(self.queues)]
        self.signalMessage(*messages)

    def _stamp_of(self, msg: Any) -> int | None:
        return _stamp(msg, allow_headerless=False)

    def _match(self, index: int, stamp: int) -> list[int] | None:
        """The times of messages that belong to one, in the order of the queues."""
        del index
        if all(stamp in queue for queue in self.queues):
            return [stamp] * len(self.queues)
        return None


class ApproximateTimeSynchronizer(TimeSynchronizer):
    """Passes on messages of several filters whose times differ by at most `slop` seconds.

    With each message that comes, those of the other filters that are nearest to it are tried.
    """

    def __init__(
        self,
        fs: Sequence[SimpleFilter],
        queue_size: int,
        slop: float,
        allow_headerless: bool = False,
        sync_arrival_time: bool = False,
    ) -> None:
        self.slop = round(slop * SECOND)
        self.allow_headerless = allow_headerless
        self.sync_arrival_time = sync_arrival_time
        super().__init__(fs, queue_size)

    def _stamp_of(self, msg: Any) -> int | None:
        if self.sync_arrival_time:
            return _now()
        return _stamp(msg, allow_headerless=self.allow_headerless)

    def _match(self, index: int, stamp: int) -> list[int] | None:
        times = []
        for place, queue in enumerate(self.queues):
            nearest = stamp if place == index else _nearest(queue, stamp)
            if nearest is None or abs(nearest - stamp) > self.slop:
                return None
            times.append(nearest)
        return times if max(times) - min(times) <= self.slop else None


def _nearest(queue: dict[int, Any], stamp: int) -> int | None:
    return min(queue, key=lambda time: abs(time - stamp), default=None)


def _stamp(msg: Any, *, allow_headerless: bool) -> int | None:
    """The time of a message, ns: of its header, or the present."""
    header = getattr(msg, "header", None)
    if header is not None and hasattr(header, "stamp"):
        return int(header.stamp.sec) * SECOND + int(header.stamp.nanosec)
    from rclpy.logging import get_logger

    if not allow_headerless:
        get_logger("message_filters").warning(
            "can not use message filters messages without timestamp infomation when "
            "'allow_headerless' is disabled. auto assign ROSTIME to headerless messages once "
            "enabling constructor option of 'allow_headerless'."
        )
        return None
    return _now()


def _now() -> int:
    from rclpy.clock import ROSClock

    return int(ROSClock().now().nanoseconds)
