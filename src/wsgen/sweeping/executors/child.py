"""A long-lived child process that computes calls one after the other.

Each call has its own limit of CPU time. A child that dies of a call is replaced, and the call is
made again; one that ends several children is given up.
"""

from __future__ import annotations

import importlib
import json
import pickle
import threading
from collections import OrderedDict
from concurrent.futures import CancelledError
from typing import TYPE_CHECKING, Any

from wsgen.isolation import channel
from wsgen.isolation.codec import encode
from wsgen.isolation.result import DEFAULT_LIMITS, Answered, Died, Limits
from wsgen.sweeping.executors.shared import Reference, Shared, named_as_before, relocated

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.isolation.channel import Endpoint


ATTEMPTS = 3  # children that a call may end
MOST_KEPT = 16  # shared arguments that a child keeps, the last that were used


class ChildDiedError(Exception):
    """A call ended each child that computed it; `death` is that of the last one."""

    def __init__(self, death: Died) -> None:
        super().__init__(death)
        self.death = death

    def __str__(self) -> str:
        return f"The child process {self.death.reason}."


def name_of(function: Callable[..., object]) -> str:
    """The `module:function` that a child imports."""
    return f"{function.__module__}:{function.__qualname__}"


class Child:
    """The parent's end: has calls computed by a child, which is started with the first one.

    It is for one thread; `stop` alone may be called by another one.
    """

    def __init__(self) -> None:
        self._channel: channel.Channel | None = None
        self._kept: OrderedDict[str, None] = OrderedDict()  # the last used is the last
        self._lock = threading.Lock()  # of what follows, and of starting the child
        self._is_stopped = False

    def call(
        self,
        function: str,
        arguments: Sequence[object],
        limits: Limits = DEFAULT_LIMITS,
        attempts: int = ATTEMPTS,
    ) -> Any:
        """Have `module:function` called; its result as JSON has it (`wsgen.isolation.codec`).

        Raises:
            ChildDiedError: The call ended so many children, or exceeded the limits as often.
            CancelledError: It was stopped.
            NotReadableError: The child cannot be started.
        """
        death: Died | None = None
        for _ in range(attempts):
            outcome = self._try(function, arguments, limits)
            if not isinstance(outcome, Died):
                return outcome.value
            self.close()
            if self._is_stopped:
                raise CancelledError
            death = outcome
        assert death is not None  # noqa: S101  there was an attempt
        raise ChildDiedError(death)

    def _try(self, function: str, arguments: Sequence[object], limits: Limits) -> Answered | Died:
        child = self._start(limits)
        for argument in arguments:
            if isinstance(argument, Shared):
                sent = self._send(child, argument, limits)
                if isinstance(sent, Died):
                    return sent
        given = tuple(
            Reference(argument.key) if isinstance(argument, Shared) else argument
            for argument in arguments
        )
        return child.call(
            "call", function, given, seconds=limits.seconds, wall_clock=limits.wall_clock
        )

    def _send(
        self, child: channel.Channel, shared: Shared, limits: Limits
    ) -> Answered | Died | None:
        """Have the child keep a shared argument, instead of the one that was used longest ago."""
        if shared.key in self._kept:
            self._kept.move_to_end(shared.key)
            return None
        forgotten = [self._kept.popitem(last=False)[0]] if len(self._kept) >= MOST_KEPT else []
        self._kept[shared.key] = None
        return child.call(
            "keep", shared.key, shared.pickled, shared.moved, forgotten, seconds=limits.seconds
        )

    def _start(self, limits: Limits) -> channel.Channel:
        with self._lock:
            if self._is_stopped:
                raise CancelledError
            if self._channel is None:
                self._kept.clear()
                self._channel = channel.Channel(
                    "wsgen.sweeping.executors.child:serve", memory=limits.memory
                )
            return self._channel

    def close(self) -> None:
        """End the child; the next call starts another one."""
        with self._lock:
            if self._channel is not None:
                self._channel.close()
            self._channel = None

    def stop(self) -> None:
        """End the child and the call that it computes, now; no other one is started."""
        with self._lock:
            self._is_stopped = True
            if self._channel is not None:
                self._channel.end()


def serve(endpoint: Endpoint) -> None:
    """In the child: compute calls until the parent closes its end."""
    kept: dict[str, Any] = {}
    moved: dict[str, Mapping[str, str]] = {}

    def keep(
        key: str, pickled: bytes, places: Mapping[str, str] | None, forgotten: Sequence[str]
    ) -> None:
        for one in forgotten:
            del kept[one], moved[one]
        value = pickle.loads(pickled)  # noqa: S301  the parent wrote it
        kept[key] = relocated(value, places) if places else value
        moved[key] = places or {}

    def call(function: str, arguments: Sequence[object]) -> object:
        module, _, name = function.partition(":")
        given = (
            kept[argument.key] if isinstance(argument, Reference) else argument
            for argument in arguments
        )
        answer = getattr(importlib.import_module(module), name)(*given)
        places = {
            old: new
            for argument in arguments
            if isinstance(argument, Reference)
            for old, new in moved[argument.key].items()
        }
        return named_as_before(json.loads(encode(answer)), places) if places else answer

    channel.serve(endpoint, {"keep": keep, "call": call})
