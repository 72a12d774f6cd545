"""Long-lived child processes of this machine, each of which computes calls one after the other.

Each call has its own limit of CPU time. A child that dies of a call is replaced, and the call is
made again; one that ends several children is given up.
"""

from __future__ import annotations

import importlib
import json
import pickle
import threading
from collections import OrderedDict
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from wsgen.isolation import channel
from wsgen.isolation.codec import encode
from wsgen.isolation.result import DEFAULT_LIMITS, Answered, Died, Limits
from wsgen.sweeping.executors.shared import Reference, Shared, named_as_before, relocated

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from types import TracebackType

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


class LocalExecutor(Executor):
    """So many isolated children, each with a thread that waits for it.

    As an executor of the standard library, except: a function is importable by its name, and its
    result is what `wsgen.isolation.codec` makes of it as JSON. A call that ends three children
    raises `ChildDiedError`.

    Attributes:
        window: How many calls should be submitted so that no child waits for one.
    """

    def __init__(self, jobs: int) -> None:
        self.window = 2 * jobs
        self._pool = ThreadPoolExecutor(max_workers=jobs, thread_name_prefix="wsgen")
        self._children: list[Child] = []
        self._of_thread = threading.local()
        self._lock = threading.Lock()
        self._is_stopped = False

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Have a function called in a child; `Shared` arguments are sent to each child once.

        Keywords are `limits`, those of this call (`wsgen.isolation.result.Limits`), and `attempts`,
        how many children it may end.
        """
        return self._pool.submit(self._call, name_of(fn), args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002  as in the base class
        """End the children when all calls are computed; without waiting, at once."""
        if not wait:
            self.stop()
        self._pool.shutdown(wait=True, cancel_futures=cancel_futures or not wait)
        for child in self._children:
            child.close()

    def stop(self) -> None:
        """End all children now; the calls that they compute are canceled."""
        with self._lock:
            self._is_stopped = True
            children = list(self._children)
        for child in children:
            child.stop()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Wait for all calls; after an exception or a signal end them."""
        self.shutdown(wait=kind is None)

    def _call(
        self,
        function: str,
        arguments: tuple[object, ...],
        limits: Limits = DEFAULT_LIMITS,
        attempts: int = ATTEMPTS,
    ) -> Any:
        return self._child().call(function, arguments, limits, attempts)

    def _child(self) -> Child:
        """The child of this thread."""
        child: Child | None = getattr(self._of_thread, "child", None)
        if child is None:
            child = self._of_thread.child = Child()
            with self._lock:
                self._children.append(child)
                if self._is_stopped:
                    child.stop()
        return child
