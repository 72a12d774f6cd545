"""Long-lived child processes of this machine, each of which computes calls one after the other.

Each call has its own limit of CPU time. A child that dies of a call is replaced, and the call is
made again; one that ends several children is given up. Arguments that many calls have in common are
sent once to whoever computes these calls. Files that they name are copied to other machines, into a
scratch folder, by their content.
"""

from __future__ import annotations

import hashlib
import importlib
import json
import os
import pickle
import shutil
import threading
from collections import Counter, OrderedDict
from collections.abc import Mapping
from concurrent.futures import CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import fields
from pathlib import Path, PurePath, PurePosixPath
from typing import TYPE_CHECKING, Any

from wsgen.isolation import channel
from wsgen.isolation.codec import encode
from wsgen.isolation.result import DEFAULT_LIMITS, Answered, Died, Limits
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from types import TracebackType

    from wsgen.isolation.channel import Endpoint


@dataclass(frozen=True)
class Shared:
    """An argument of many calls, by its content; a function that is called gets the value."""

    key: str  # of the content
    pickled: bytes
    files: tuple[str, ...] = ()  # absolute paths of files that the value names
    # Where these files are instead; what a call answers names them as the value does.
    moved: Mapping[str, str] | None = None


@dataclass(frozen=True)
class Reference:
    """What stands for a shared argument that a child has."""

    key: str


def share(value: Any, files: Iterable[str] = ()) -> Shared:
    """Make an argument that is sent once to each child or worker; it is pickled now.

    `files` are paths of files that the value names, as it names them; other machines get copies.
    """
    pickled = pickle.dumps(value, pickle.HIGHEST_PROTOCOL)
    return Shared(hashlib.sha256(pickled).hexdigest(), pickled, tuple(dict.fromkeys(files)))


def relocated(value: Any, moved: Mapping[str, str]) -> Any:
    """A value of dataclasses, sequences and mappings with other paths where it names these."""
    if isinstance(value, PurePath):
        return type(value)(moved[str(value)]) if str(value) in moved else value
    if isinstance(value, tuple | list):
        parts = [relocated(part, moved) for part in value]
        if all(new is old for new, old in zip(parts, value, strict=True)):
            return value
        return type(value)(*parts) if hasattr(value, "_fields") else type(value)(parts)
    if isinstance(value, Mapping):
        return {key: relocated(part, moved) for key, part in value.items()}
    if hasattr(value, "__dataclass_fields__"):
        return _relocated_fields(value, moved)
    return moved.get(value, value) if type(value) is str else value


def _relocated_fields(value: Any, moved: Mapping[str, str]) -> Any:
    before = {field.name: getattr(value, field.name) for field in fields(value) if field.init}
    after = {name: relocated(part, moved) for name, part in before.items()}
    if all(after[name] is before[name] for name in before):
        return value
    return type(value)(**after)


def named_as_before(answer: Any, moved: Mapping[str, str]) -> Any:
    """An answer as JSON has it, with texts that name files by the paths that they were moved from.

    The values of `moved` are the paths where they are.
    """
    if isinstance(answer, str):
        for old, new in moved.items():
            answer = answer.replace(new, old)
        return answer
    if isinstance(answer, list):
        return [named_as_before(part, moved) for part in answer]
    if isinstance(answer, dict):
        return {key: named_as_before(part, moved) for key, part in answer.items()}
    return answer


MOST_FOLDERS = 32  # that are kept, the last that were used; those in use are never removed


class CopiedFiles:
    """Folders with copies; several threads may use them.

    Each has the files of one value under their own names, those of one folder together, for some
    name others beside them. What several folders have in common is on the disk once.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._used: Counter[str] = Counter()  # by how many calls, by key
        self._kept: OrderedDict[str, dict[str, str]] = OrderedDict()  # what was moved, by key
        self._lock = threading.Lock()

    @contextmanager
    def lent(self, key: str, files: Mapping[str, tuple[str, bytes]]) -> Iterator[dict[str, str]]:
        """The paths of the copies by those of the files, for as long as the context lasts.

        `files` has the hash of each file's content, and the content, by its path. `key` is that of
        the value and of all that they hold: the copies of one key are always at the same paths.

        Raises:
            OSError: The disk refuses them.
        """
        with self._lock:
            if key not in self._kept:
                self._kept[key] = self._write(key, files)
            self._kept.move_to_end(key)
            self._used[key] += 1
            moved = self._kept[key]
        try:
            yield moved
        finally:
            with self._lock:
                self._used[key] -= 1
                self._remove_oldest()

    def _write(self, key: str, files: Mapping[str, tuple[str, bytes]]) -> dict[str, str]:
        contents = self._folder / "contents"
        contents.mkdir(parents=True, exist_ok=True)
        folders: dict[str, Path] = {}
        moved = {}
        for path, (hashed, content) in files.items():
            original = PurePosixPath(path)
            folder = folders.setdefault(
                str(original.parent), self._folder / key / str(len(folders))
            )
            folder.mkdir(parents=True, exist_ok=True)
            copy, whole = folder / original.name, contents / hashed
            if not whole.exists():
                part = whole.with_suffix(".part")
                part.write_bytes(content)
                part.replace(whole)
            with suppress(FileExistsError):
                _link(whole, copy)
            moved[path] = str(copy)
        return moved

    def _remove_oldest(self) -> None:
        for key in list(self._kept):
            if len(self._kept) <= MOST_FOLDERS:
                return
            if not self._used[key]:
                del self._kept[key], self._used[key]
                shutil.rmtree(self._folder / key, ignore_errors=True)
                self._remove_unnamed()

    def _remove_unnamed(self) -> None:
        """Remove contents that no folder names any more."""
        for content in (self._folder / "contents").iterdir():
            with suppress(OSError):
                if content.stat().st_nlink == 1:
                    content.unlink()

    def remove(self) -> None:
        """Remove all."""
        with self._lock:
            self._kept.clear()
            shutil.rmtree(self._folder, ignore_errors=True)


def _link(content: Path, copy: Path) -> None:
    try:
        os.link(content, copy)
    except FileExistsError:
        raise
    except OSError:  # a file system without links
        shutil.copyfile(content, copy)


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
                    "wsgen.sweeping.children:serve", memory=limits.memory
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
