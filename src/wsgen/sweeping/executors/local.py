"""Calls computed by child processes of this machine, several at a time."""

from __future__ import annotations

import threading
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from wsgen.isolation.result import DEFAULT_LIMITS, Limits
from wsgen.sweeping.executors.child import ATTEMPTS, Child, name_of

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import TracebackType


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
