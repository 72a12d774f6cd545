"""Calls computed by the workers of a Dask cluster; no other module imports `distributed`.

Each thread of a worker has an isolated child of its own: engines may crash, and hold the lock of
the interpreter. Functions, and what is `Shared`, are those of `wsgen.sweeping.children`.
"""

from __future__ import annotations

import contextlib
import hashlib
import logging
import platform
import socket
import threading
import time
import uuid
from collections import OrderedDict
from concurrent.futures import CancelledError, Executor
from concurrent.futures import Future as StandardFuture
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import dask
import distributed
from distributed import Client, Future, KilledWorker, LocalCluster, WorkerPlugin, get_worker

from wsgen import __version__
from wsgen.errors import NotFoundError, NotReadableError, RequestError, WsgenError
from wsgen.isolation.result import DEFAULT_LIMITS, Died, Limits
from wsgen.sweeping.children import ATTEMPTS, Child, ChildDiedError, CopiedFiles, Shared, name_of
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import TracebackType


LOCAL = "local"  # instead of an address: workers of this machine
SCHEMES = ("", "tcp", "tls")  # without one it is tcp
MOST_PORTS = 1 << 16
CONNECT_SECONDS = 10.0
WORKER_SECONDS = 30.0  # for the first worker of a cluster to be there
COUNT_EVERY = 5.0  # s, between two looks at how many threads the workers have
CALLS_A_THREAD = 3  # that are submitted, so that no thread waits for the next one
IDLE_SECONDS = 60.0  # after that a worker ends a child that nobody calls
START_SECONDS = 120.0  # for the scheduler of a local cluster to answer, on a busy machine
# Of a local cluster: nobody looks at what it measures of itself ten to a hundred times a second. A
# worker that is lost comes again, however long that takes: Dask would give it up after 15 s, and
# wait without end for another one.
QUIET = {
    "distributed.scheduler.allowed-failures": ATTEMPTS - 1,
    "distributed.deploy.lost-worker-timeout": "24h",
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.admin.system-monitor.gil.enabled": False,
}
MOST_SENT = 16  # shared arguments that the cluster keeps, the last that were used
MOST_FILES = 4096  # likewise, of the files that they name


def connect(scheduler: str, jobs: int = 1) -> DaskExecutor:
    """Connect to a cluster, or start one on this machine.

    Args:
        scheduler: The address of a scheduler, `HOST:PORT`; or `local`, for a scheduler and workers
            of this machine that only it can reach.
        jobs: How many workers a local cluster has.

    Raises:
        NotFoundError: Nobody answers there, or the cluster has no worker.
        RequestError: The address is none, or the cluster has other versions of what both need.
    """
    for name in ("distributed", "bokeh", "tornado", "asyncio"):  # errors are raised, too
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with contextlib.ExitStack() as stack:
        cluster = stack.enter_context(_start(jobs)) if scheduler == LOCAL else None
        client = stack.enter_context(_connected(cluster or scheduler, scheduler))
        if cluster is None:
            _wait_for_workers(client, scheduler)
            _check_versions(client, scheduler)
        else:
            client.wait_for_workers(jobs)
        return DaskExecutor(client, scheduler, stack.pop_all())


def _start(jobs: int) -> LocalCluster:
    dask.config.set(QUIET)
    return LocalCluster(
        n_workers=jobs,
        threads_per_worker=1,
        processes=True,
        host="127.0.0.1",
        # Its server of statistics would take a port that another cluster may have.
        dashboard_address="127.0.0.1:0",
        worker_dashboard_address=None,
        scheduler_kwargs={"dashboard": False},
        silence_logs=logging.CRITICAL,
        memory_limit=0,  # what needs memory is in the children, which have their own limit
    )


def _connected(target: LocalCluster | str, scheduler: str) -> Client:
    if isinstance(target, str):
        _check_address(target)
    seconds = CONNECT_SECONDS if isinstance(target, str) else START_SECONDS
    clients: list[Client] = []
    # It waits for ever for the answer of who accepts connections and is no scheduler.
    thread = threading.Thread(target=_open, args=(target, clients, seconds), daemon=True)
    thread.start()
    thread.join(2 * seconds)
    if not clients:
        raise NotFoundError(
            f"What answers at {scheduler} is not a Dask scheduler.",
            hint="Give the address that `dask scheduler` prints: --scheduler tcp://HOST:8786",
        )
    return clients[0]


def _open(target: LocalCluster | str, clients: list[Client], seconds: float) -> None:
    client = Client.__new__(Client)
    try:
        client.__init__(target, timeout=seconds, set_as_default=False)
    except (OSError, ValueError):  # timeouts, too
        client.status = "closed"  # else it would wait again when it is deleted
    else:
        clients.append(client)


def _check_address(scheduler: str) -> None:
    """Refuse what is no address, or one where nobody answers."""
    scheme, _, place = scheduler.rpartition("://")
    host, _, port = place.strip("/").rpartition(":")
    if scheme not in SCHEMES or not host or not port.isdecimal() or not 0 < int(port) < MOST_PORTS:
        raise RequestError(
            f"`{scheduler}` is not the address of a Dask scheduler.",
            hint="Give the address that `dask scheduler` prints: --scheduler tcp://HOST:8786",
        )
    try:
        socket.create_connection((host.strip("[]"), int(port)), CONNECT_SECONDS).close()
    except OSError as error:
        raise NotFoundError(
            f"No Dask scheduler answers at {scheduler}: {error.strerror or 'no connection'}.",
            hint="Check the address and that `dask scheduler` runs there; `--scheduler local` "
            "starts workers on this machine.",
        ) from error


def _wait_for_workers(client: Client, scheduler: str) -> None:
    try:
        client.wait_for_workers(1, timeout=WORKER_SECONDS)
    except TimeoutError as error:
        raise NotFoundError(
            f"The Dask scheduler at {scheduler} has no workers.",
            hint=f"Start some, where wsgen is installed: dask worker {scheduler}",
        ) from error


def _check_versions(client: Client, scheduler: str) -> None:
    """Refuse a cluster with another Python, wsgen, dask or distributed.

    The scheduler takes part: it unpacks what is submitted.
    """
    found = client.get_versions(packages=["wsgen"])
    python = platform.python_version_tuple()[:2]
    ours = {
        "Python": ".".join(python),
        "wsgen": __version__,
        "distributed": str(distributed.__version__),
    }
    theirs = {f"the scheduler at {scheduler}": found["scheduler"]}
    theirs |= {f"the worker at {address}": one for address, one in found["workers"].items()}
    for who, versions in theirs.items():
        packages = versions["packages"]
        has = {
            "Python": ".".join(versions["host"]["python"].split(".")[:2]),
            "wsgen": packages.get("wsgen"),
            "distributed": packages.get("distributed"),
        }
        for name, version in ours.items():
            if has[name] != version:
                other = f"{name} {has[name]}" if has[name] else f"no {name}"
                raise RequestError(
                    f"{who[0].upper()}{who[1:]} has {other}, and this machine {name} {version}.",
                    hint="Install the same Python, wsgen and distributed everywhere: "
                    f"pip install 'wsgen[sweep]=={__version__}' "
                    f"'distributed=={ours['distributed']}'",
                )


@dataclass(frozen=True)
class _Parcel:
    """A shared argument on a worker, with the contents of its files."""

    shared: Shared
    hashes: tuple[str, ...]  # of its files, in their order
    contents: tuple[bytes, ...]


def _hold(content: bytes) -> bytes:
    """On a worker: what is kept as a result, and made again where a worker is lost."""
    return content


def _pack(shared: Shared, hashes: tuple[str, ...], *contents: bytes) -> _Parcel:
    """On a worker, as `_hold`."""
    return _Parcel(shared, hashes, contents)


def _compute(pool: str, function: str, limits: Limits, attempts: int, *arguments: object) -> Any:
    """On a worker: have a child call a function; a death is an answer, too."""
    plugin: _Pool = get_worker().plugins[pool]
    return plugin.compute(function, arguments, limits, attempts)


class _Pool(WorkerPlugin):  # type: ignore[misc]
    """On a worker: the children of its threads, and the files that they read."""

    def __init__(self, name: str) -> None:
        self.name = name

    def setup(self, worker: Any) -> None:
        """Begin; Dask calls it on each worker."""
        self._files = CopiedFiles(Path(worker.local_directory, self.name))
        self._children: dict[int, _Idler] = {}  # by thread
        self._lock = threading.Lock()
        self._is_closed = False

    def teardown(self, worker: Any) -> None:  # noqa: ARG002  as Dask calls it
        """End the children and remove the files."""
        with self._lock:
            self._is_closed = True
            children = list(self._children.values())
        for child in children:
            child.stop()
        self._files.remove()

    def compute(
        self, function: str, arguments: tuple[object, ...], limits: Limits, attempts: int
    ) -> Any:
        """Have a child call a function; gives its result, or how the last child died."""
        with contextlib.ExitStack() as stack:
            given = [
                self._unpack(one, stack) if isinstance(one, _Parcel) else one for one in arguments
            ]
            try:
                with self._child().lent() as child:
                    return child.call(function, given, limits, attempts)
            except ChildDiedError as error:
                return error.death
            except CancelledError:  # the calls of this client are over
                return None

    def _unpack(self, parcel: _Parcel, stack: contextlib.ExitStack) -> Shared:
        shared = parcel.shared
        if not shared.files:
            return shared
        named = zip(shared.files, zip(parcel.hashes, parcel.contents, strict=True), strict=True)
        moved = stack.enter_context(self._files.lent(shared.key, dict(named)))
        return replace(shared, moved=moved)

    def _child(self) -> _Idler:
        with self._lock:
            child = self._children.setdefault(threading.get_ident(), _Idler())
            if self._is_closed:
                child.stop()
        return child


class _Idler:
    """A child that ends when nobody calls it for a while."""

    def __init__(self) -> None:
        self._child = Child()
        self._lock = threading.Lock()  # of the child's calls
        self._timer: threading.Timer | None = None

    @contextlib.contextmanager
    def lent(self) -> Iterator[Child]:
        with self._lock:
            if self._timer is not None:
                self._timer.cancel()
            try:
                yield self._child
            finally:
                self._timer = threading.Timer(IDLE_SECONDS, self._rest)
                self._timer.daemon = True
                self._timer.start()

    def _rest(self) -> None:
        if self._lock.acquire(blocking=False):
            try:
                self._child.close()
            finally:
                self._lock.release()

    def stop(self) -> None:
        self._child.stop()
        with self._lock:
            if self._timer is not None:
                self._timer.cancel()
            self._child.close()


class DaskExecutor(Executor):
    """Calls computed by the workers of a cluster; see `local.LocalExecutor`.

    A worker that is lost is Dask's to replace: its calls are made again. A call that ends several
    workers raises `ChildDiedError`.
    """

    def __init__(self, client: Client, scheduler: str, stack: contextlib.ExitStack) -> None:
        """Prepare the workers; `stack` has what is closed in the end."""
        self._client = client
        self._scheduler = scheduler
        self._stack = stack
        self._pool = f"wsgen-{uuid.uuid4().hex}"
        self._sent: OrderedDict[str, Future] = OrderedDict()  # shared arguments, by key
        self._files: OrderedDict[tuple[str, int, int], tuple[str, Future]] = OrderedDict()
        self._running: dict[Future, StandardFuture[Any]] = {}
        self._counted = 0.0  # when the threads were counted
        self._threads = 1
        self._lock = threading.RLock()
        self._is_closed = False
        client.register_plugin(_Pool(self._pool), name=self._pool)

    @property
    def address(self) -> str:
        """That of the scheduler, for other clients."""
        return str(self._client.scheduler.address)

    @property
    def window(self) -> int:
        """How many calls should be submitted so that no thread of the workers waits for one."""
        if time.monotonic() > self._counted + COUNT_EVERY:
            with contextlib.suppress(OSError, TimeoutError):
                self._threads = sum(self._client.nthreads().values()) or self._threads
            self._counted = time.monotonic()
        return CALLS_A_THREAD * self._threads

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> StandardFuture[Any]:
        """Have a function called by a child of a worker; keywords are `limits` and `attempts`."""
        given = [self._send(one) if isinstance(one, Shared) else one for one in args]
        submitted = self._client.submit(
            _compute,
            self._pool,
            name_of(fn),
            kwargs.get("limits", DEFAULT_LIMITS),
            kwargs.get("attempts", ATTEMPTS),
            *given,
            key=f"wsgen-call-{uuid.uuid4().hex}",
            pure=False,
        )
        result: StandardFuture[Any] = StandardFuture()
        with self._lock:
            self._running[submitted] = result
        result.add_done_callback(lambda _: self._forget(submitted, result))
        submitted.add_done_callback(self._take)
        return result

    def _forget(self, submitted: Future, result: StandardFuture[Any]) -> None:
        with self._lock:
            self._running.pop(submitted, None)
        if result.cancelled() and not self._is_closed:
            submitted.cancel()

    def _take(self, submitted: Future) -> None:
        """Hand over what a call has become; Dask calls it in a thread of its own."""
        with self._lock:
            result = self._running.get(submitted)
        if result is None or not result.set_running_or_notify_cancel():
            return
        try:
            answer = submitted.result()
        except KilledWorker as error:
            result.set_exception(ChildDiedError(_death_of_workers(error)))
        except CancelledError:
            result.set_exception(CancelledError() if self._is_closed else self._lost())
        except Exception as error:  # noqa: BLE001  whatever it is, it is the call's
            result.set_exception(error)
        else:
            if isinstance(answer, Died):
                result.set_exception(ChildDiedError(answer))
            else:
                result.set_result(answer)

    def _lost(self) -> WsgenError:
        return NotReadableError(
            f"The connection to the Dask scheduler at {self._scheduler} was lost.",
            hint="Check that it still runs, and run the same command again.",
        )

    def _send(self, shared: Shared) -> Future:
        """The shared argument in the cluster."""
        files = [self._send_file(path) for path in shared.files]
        hashes = tuple(hashed for hashed, _ in files)
        contents = hashlib.sha256("".join((shared.key, *hashes)).encode()).hexdigest()
        with self._lock:
            if contents not in self._sent:
                self._sent[contents] = self._client.submit(
                    _pack,
                    replace(shared, key=contents),
                    hashes,
                    *(content for _, content in files),
                    key=f"wsgen-shared-{contents}",
                )
                if len(self._sent) > MOST_SENT:
                    self._sent.popitem(last=False)
            self._sent.move_to_end(contents)
            return self._sent[contents]

    def _send_file(self, path: str) -> tuple[str, Future]:
        """The hash of a file's content, and the content in the cluster."""
        file = Path(path)
        try:
            status = file.stat()
            key = path, status.st_mtime_ns, status.st_size
            with self._lock:
                if key not in self._files:
                    content = file.read_bytes()
                    hashed = hashlib.sha256(content).hexdigest()
                    held = self._client.submit(_hold, content, key=f"wsgen-file-{hashed}")
                    self._files[key] = hashed, held
                    if len(self._files) > MOST_FILES:
                        self._files.popitem(last=False)
                self._files.move_to_end(key)
                return self._files[key]
        except OSError as error:
            raise NotReadableError(
                f"Cannot read {path}: {error.strerror}.", hint="Check that the mesh is still there."
            ) from error

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: FBT001, FBT002  as in the base class
        """Disconnect when all calls are computed; without waiting, at once."""
        if self._is_closed:
            return
        with self._lock:
            running = dict(self._running)
        if wait and not cancel_futures:
            for result in running.values():
                with contextlib.suppress(BaseException):
                    result.result()
        self._is_closed = True
        for result in running.values():
            result.cancel()
        with contextlib.suppress(Exception):  # the scheduler may be gone
            self._client.cancel(list(running))
        self._sent.clear()
        self._files.clear()
        with contextlib.suppress(Exception):
            self._client.unregister_worker_plugin(self._pool)
        with contextlib.suppress(Exception):
            self._stack.close()

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Wait for all calls; after an exception or a signal cancel them."""
        self.shutdown(wait=kind is None)


def _death_of_workers(error: KilledWorker) -> Died:
    count = error.allowed_failures + 1
    return Died(reason=f"ended {count} workers of Dask, one after the other,", step="", output="")
