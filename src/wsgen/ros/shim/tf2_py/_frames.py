"""The frames of tf2 with their history, without messages: times are nanoseconds.

What is accepted, what is refused and in which words is that of `BufferCore`, `TimeCache` and
`StaticCache` of geometry2 (tf2/src/buffer_core.cpp, cache.cpp, static_cache.cpp).
"""

from __future__ import annotations

import math
import threading
from bisect import bisect_left, bisect_right
from typing import TYPE_CHECKING, NamedTuple

from tf2_py._rotations import (
    NO_ROTATION,
    NO_TRANSLATION,
    add,
    invert,
    lerp,
    multiply,
    normalize,
    rotate,
    slerp,
    subtract,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from tf2_py._rotations import Quaternion, Vector


class TransformException(Exception):
    """Base of all."""


class ConnectivityException(TransformException):
    """Two frames are not in the same tree."""


class LookupException(TransformException):
    """A frame does not exist."""


class ExtrapolationException(TransformException):
    """The time is before or after what is known."""


class InvalidArgumentException(TransformException):
    """A name that cannot be one of a frame."""


class TimeoutException(TransformException):
    """A transform did not come in time."""


DEFAULT_CACHE_NANOSECONDS = 10 * 10**9
MAX_DEPTH = 1000  # frames between a frame and its root; more are a loop
SECOND = 10**9
SHORTEST_HISTORY = 100_000  # ns, for the rate of a frame with one transform
NO_PARENT = "NO_PARENT"  # what tf2 calls the parent of a frame that has none


class Transform(NamedTuple):
    """Where a frame is in another one at a time."""

    stamp: int  # ns
    parent: str
    translation: Vector  # m, in the parent's frame
    rotation: Quaternion  # x, y, z, w; unit


class _StaticHistory:
    """The one transform of a frame that does not move: at all times."""

    is_static = True
    oldest = latest = 0
    count = 1

    def __init__(self) -> None:
        self._transform: Transform | None = None

    def insert(self, transform: Transform) -> bool:
        self._transform = transform
        return True

    def at(self, stamp: int) -> Transform:
        del stamp
        assert self._transform is not None  # noqa: S101  inserted right after it is made
        return self._transform

    def clear(self) -> None:
        """It stays, as tf2's."""

    @property
    def last(self) -> Transform | None:
        return self._transform


class _History:
    """The transforms of a frame that moves, oldest first, as far back as the cache reaches."""

    is_static = False

    def __init__(self, nanoseconds: int) -> None:
        self._length = nanoseconds
        self._stamps: list[int] = []
        self._transforms: list[Transform] = []

    def insert(self, transform: Transform) -> bool:
        """Whether it is not older than what is kept."""
        stamps, stamp = self._stamps, transform.stamp
        if stamps:
            horizon = stamps[-1] - self._length
            if stamps[0] < horizon:
                old = bisect_left(stamps, horizon)
                del stamps[:old], self._transforms[:old]
            if stamp < horizon:
                return False
        place = bisect_right(stamps, stamp)
        if transform not in self._transforms[bisect_left(stamps, stamp) : place]:
            stamps.insert(place, stamp)
            self._transforms.insert(place, transform)
        return True

    def at(self, stamp: int) -> Transform:
        """The transform then, interpolated; the latest at 0. ExtrapolationException."""
        stamps, transforms = self._stamps, self._transforms
        if not stamps:
            raise _only_one(stamp, 0)
        if stamp in (0, stamps[-1]):
            return transforms[-1]
        if len(stamps) == 1:
            raise _only_one(stamp, stamps[0])
        if stamp == stamps[0]:
            return transforms[0]
        if stamp > stamps[-1]:
            raise ExtrapolationException(
                "Lookup would require extrapolation into the future.  Requested time "
                f"{seconds(stamp)} but the latest data is at time {seconds(stamps[-1])}"
            )
        if stamp < stamps[0]:
            raise ExtrapolationException(
                "Lookup would require extrapolation into the past.  Requested time "
                f"{seconds(stamp)} but the earliest data is at time {seconds(stamps[0])}"
            )
        place = bisect_right(stamps, stamp)
        before, after = transforms[place - 1], transforms[place]
        if before.parent != after.parent or before.stamp == stamp:
            return before
        ratio = (stamp - before.stamp) / (after.stamp - before.stamp)
        return Transform(
            stamp,
            before.parent,
            lerp(before.translation, after.translation, ratio),
            slerp(before.rotation, after.rotation, ratio),
        )

    def clear(self) -> None:
        self._stamps.clear()
        self._transforms.clear()

    @property
    def last(self) -> Transform | None:
        return self._transforms[-1] if self._transforms else None

    @property
    def latest(self) -> int:
        return self._stamps[-1] if self._stamps else 0

    @property
    def oldest(self) -> int:
        return self._stamps[0] if self._stamps else 0

    @property
    def count(self) -> int:
        return len(self._stamps)


class Frames:
    """The frames that transforms named, and how they are to each other.

    `warn` takes what is wrong with a transform that is refused. Safe to use from several threads.
    """

    def __init__(self, cache_nanoseconds: int, warn: Callable[[str], None]) -> None:
        self._length = cache_nanoseconds
        self._warn = warn
        self._lock = threading.RLock()
        # All frames, in the order in which they were named; None: only ever named as a parent.
        self._frames: dict[str, _History | _StaticHistory | None] = {}
        self._authorities: dict[str, str] = {}

    def add(
        self,
        *,
        parent: str,
        child: str,
        stamp: int,
        translation: Vector,
        rotation: Quaternion,
        authority: str,
        is_static: bool,
    ) -> bool:
        """Add a transform; False where it is refused, which is said."""
        parent, child = parent.removeprefix("/"), child.removeprefix("/")
        unit = normalize(rotation)
        wrong = list(_refusals(parent, child, authority, translation, unit))
        for text in wrong:
            self._warn(text)
        if wrong:
            return False
        with self._lock:
            history = self._frames.get(child)
            if history is None or history.is_static != is_static:
                history = _StaticHistory() if is_static else _History(self._length)
                self._frames[child] = history
            self._frames.setdefault(parent, None)
            if history.insert(Transform(stamp, parent, translation, unit)):
                self._authorities[child] = authority
                return True
        self._warn(
            f"TF_OLD_DATA ignoring data from the past for frame {child} at time {seconds(stamp)} "
            f"according to authority {authority}\n"
            "Possible reasons are listed at http://wiki.ros.org/tf/Errors%20explained"
        )
        return False

    def lookup(self, target: str, source: str, stamp: int) -> Transform:
        """Where `source` is in `target`; at 0 the latest time that all frames between have.

        LookupException, ConnectivityException, ExtrapolationException, InvalidArgumentException.
        """
        with self._lock:
            if target == source:
                history = self._frames.get(target)
                at = stamp or (history.latest if history else 0)
                return Transform(at, target, NO_TRANSLATION, NO_ROTATION)
            self._check("lookupTransform argument target_frame", target)
            self._check("lookupTransform argument source_frame", source)
            return self._walk(target, source, stamp)

    def lookup_through(
        self, target: str, target_stamp: int, source: str, source_stamp: int, fixed: str
    ) -> Transform:
        """Where `source` was in `target` at two times; `fixed` does not move between them."""
        with self._lock:
            for name, frame in (("target", target), ("source", source), ("fixed", fixed)):
                self._check(f"lookupTransform argument {name}_frame", frame)
            inner = self.lookup(fixed, source, source_stamp)
            outer = self.lookup(target, fixed, target_stamp)
        return Transform(
            outer.stamp,
            target,
            add(rotate(outer.rotation, inner.translation), outer.translation),
            normalize(multiply(outer.rotation, inner.rotation)),
        )

    def refusal(self, target: str, source: str, stamp: int) -> str:
        """Why a lookup would fail; empty where it would not."""
        if target == source:
            return ""
        with self._lock:
            return self._unknown(target=target, source=source) or self._failure(
                target, source, stamp
            )

    def refusal_through(
        self, target: str, target_stamp: int, source: str, source_stamp: int, fixed: str
    ) -> str:
        """Why a lookup through a fixed frame would fail; empty where it would not."""
        with self._lock:
            return (
                self._unknown(target=target, source=source, fixed=fixed)
                or self._failure(target, fixed, target_stamp)
                or self._failure(fixed, source, source_stamp)
            )

    def latest_common_stamp(self, target: str, source: str) -> int:
        """The latest time that all frames between two have; 0 where all are static."""
        with self._lock:
            self._check("get_latest_common_time", target)
            self._check("get_latest_common_time", source)
            return self._latest_common(target, source)

    def clear(self) -> None:
        """Forget what moves; the names of frames stay, as in tf2."""
        with self._lock:
            for history in self._frames.values():
                if history is not None:
                    history.clear()

    def names(self) -> list[str]:
        """All frames that were named."""
        with self._lock:
            return list(self._frames)

    def as_text(self) -> str:
        """A line for each frame with its parent."""
        with self._lock:
            return "".join(
                f"Frame {name} exists with parent "
                f"{history.last.parent if history.last else NO_PARENT}.\n"
                for name, history in self._frames.items()
                if history is not None
            )

    def as_yaml(self) -> str:
        """What `view_frames` shows of each frame."""
        with self._lock:
            if not self._frames:
                return "[]"
            return "".join(
                self._yaml_of(name, history, history.last)
                for name, history in self._frames.items()
                if history is not None and history.last is not None
            )

    def _yaml_of(self, name: str, history: _History | _StaticHistory, last: Transform) -> str:
        length = history.latest - history.oldest
        rate = history.count * SECOND / max(length, SHORTEST_HISTORY)
        authority = self._authorities.get(name, "no recorded authority")
        return (
            f"{name}: \n"
            f"  parent: '{last.parent}'\n"
            f"  broadcaster: '{authority}'\n"
            f"  rate: {rate:.3f}\n"
            f"  most_recent_transform: {seconds(history.latest)}\n"
            f"  oldest_transform: {seconds(history.oldest)}\n"
            f"  buffer_length: {length / SECOND:.3f}\n"
        )

    def _check(self, place: str, frame: str) -> None:
        reason = _invalid(frame)
        if reason:
            raise InvalidArgumentException(
                f'Invalid argument "{frame}" passed to {place} - {reason}'
            )
        if frame not in self._frames:
            raise LookupException(f'"{frame}" passed to {place} does not exist. ')

    def _unknown(self, **frames: str) -> str:
        for name, frame in frames.items():
            reason = _invalid(frame) or ("" if frame in self._frames else "frame does not exist")
            if reason:
                return (
                    f'Invalid frame ID "{frame}" passed to canTransform argument {name}_frame - '
                    f"{reason}"
                )
        return ""

    def _failure(self, target: str, source: str, stamp: int) -> str:
        if target == source:
            return ""
        try:
            self._walk(target, source, stamp)
        except TransformException as error:
            return str(error)
        return ""

    def _walk(self, target: str, source: str, stamp: int) -> Transform:
        """The way from both frames up to the frame where their ways meet."""
        if not stamp:
            stamp = self._latest_common(target, source)
        top, translation, rotation, extrapolation = self._up(source, target, stamp)
        if top == target:
            return Transform(stamp, target, translation, normalize(rotation))
        try:
            meeting, other_translation, other_rotation = self._up_to(target, {top, source}, stamp)
        except ExtrapolationException as error:
            raise ExtrapolationException(_when(str(error), source, target)) from None
        if meeting not in (top, source):
            if extrapolation is not None:
                raise ExtrapolationException(_when(str(extrapolation), source, target))
            raise _unconnected(source, target)
        if meeting == source:
            translation, rotation = NO_TRANSLATION, NO_ROTATION
        back = invert(other_rotation)
        difference = subtract(translation, other_translation)
        return Transform(
            stamp, target, rotate(back, difference), normalize(multiply(back, rotation))
        )

    def _up(
        self, frame: str, target: str, stamp: int
    ) -> tuple[str, Vector, Quaternion, ExtrapolationException | None]:
        """From a frame to its root, or to `target` if that is on the way.

        It ends earlier where a frame has no transform at that time: with the reason.
        """
        translation, rotation = NO_TRANSLATION, NO_ROTATION
        for _ in range(MAX_DEPTH + 1):
            history = self._frames.get(frame)
            if history is None or frame == target:
                return frame, translation, rotation, None
            try:
                step = history.at(stamp)
            except ExtrapolationException as error:
                return frame, translation, rotation, error
            translation = add(rotate(step.rotation, translation), step.translation)
            rotation = multiply(step.rotation, rotation)
            frame = step.parent
        raise self._loop()

    def _up_to(self, frame: str, ends: set[str], stamp: int) -> tuple[str, Vector, Quaternion]:
        """From a frame up to the first of `ends`, or to its root."""
        translation, rotation = NO_TRANSLATION, NO_ROTATION
        for _ in range(MAX_DEPTH + 1):
            history = self._frames.get(frame)
            if history is None or frame in ends:
                return frame, translation, rotation
            step = history.at(stamp)
            translation = add(rotate(step.rotation, translation), step.translation)
            rotation = multiply(step.rotation, rotation)
            frame = step.parent
        raise self._loop()

    def _latest_common(self, target: str, source: str) -> int:
        if target == source:
            history = self._frames.get(source)
            return history.latest if history else 0
        stamps_of_source = self._latest_up(source, target)
        if target in stamps_of_source:
            return _earliest(stamps_of_source[target])
        stamps_of_target = self._latest_up(target, source)
        for frame, stamps in stamps_of_target.items():
            if frame in stamps_of_source:
                return _earliest([*stamps, *stamps_of_source[frame]])
        raise _unconnected(source, target)

    def _latest_up(self, frame: str, end: str) -> dict[str, list[int]]:
        """The frames above one, nearest first, with the latest times on the way to each."""
        stamps: list[int] = []
        found: dict[str, list[int]] = {frame: []}
        for _ in range(MAX_DEPTH + 1):
            history = self._frames.get(frame)
            last = history.last if history else None
            if history is None or last is None or frame == end:
                return found
            if history.latest:
                stamps = [*stamps, history.latest]
            frame = last.parent
            if frame in found:
                break
            found[frame] = stamps
        raise self._loop()

    def _loop(self) -> LookupException:
        return LookupException(
            f"The tf tree is invalid because it contains a loop.\n{self.as_text()}\n"
        )


def seconds(stamp: int) -> str:
    """A time as tf2 writes it."""
    whole, rest = divmod(stamp, SECOND)
    return f"{whole + rest * 1e-9:.6f}"


def _earliest(stamps: list[int]) -> int:
    return min(stamps, default=0)


def _only_one(stamp: int, only: int) -> ExtrapolationException:
    return ExtrapolationException(
        f"Lookup would require extrapolation at time {seconds(stamp)}, but only time "
        f"{seconds(only)} is in the buffer"
    )


def _unconnected(source: str, target: str) -> ConnectivityException:
    return ConnectivityException(
        f"Could not find a connection between '{target}' and '{source}' because they are not part "
        "of the same tree.Tf has two or more unconnected trees."
    )


def _when(text: str, source: str, target: str) -> str:
    return f"{text}, when looking up transform from frame [{source}] to frame [{target}]"


def _invalid(frame: str) -> str:
    if not frame:
        return "in tf2 frame_ids cannot be empty"
    if frame.startswith("/"):
        return "in tf2 frame_ids cannot start with a '/'"
    return ""


def _refusals(
    parent: str, child: str, authority: str, translation: Vector, rotation: Quaternion
) -> list[str]:
    found = []
    if child == parent:
        found.append(
            f'TF_SELF_TRANSFORM: Ignoring transform from authority "{authority}" with frame_id and '
            f' child_frame_id "{child}" because they are the same'
        )
    if not child:
        found.append(
            f'TF_NO_CHILD_FRAME_ID: Ignoring transform from authority "{authority}" because '
            "child_frame_id not set "
        )
    if not parent:
        found.append(
            f'TF_NO_FRAME_ID: Ignoring transform with child_frame_id "{child}"  from authority '
            f'"{authority}" because frame_id not set'
        )
    if any(math.isnan(number) for number in (*translation, *rotation)):
        place = " ".join(f"{number:f}" for number in translation)
        turn = " ".join(f"{number:f}" for number in rotation)
        found.append(
            f'TF_NAN_INPUT: Ignoring transform for child_frame_id "{child}" from authority '
            f'"{authority}" because of a nan value in the transform ({place}) ({turn})'
        )
    if any(math.isnan(number) for number in rotation):
        turn = " ".join(f"{number:f}" for number in rotation)
        found.append(
            f'TF_DENORMALIZED_QUATERNION: Ignoring transform for child_frame_id "{child}" from '
            f'authority "{authority}" because of an invalid quaternion in the transform ({turn})'
        )
    return found
