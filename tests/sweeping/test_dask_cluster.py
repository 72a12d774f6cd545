"""Calls computed by workers of Dask, all on the loopback interface; one cluster for all tests."""

from __future__ import annotations

import contextlib
import socket
import sys
from concurrent.futures import CancelledError, as_completed
from typing import TYPE_CHECKING

import pytest

from sweeping import calls
from sweeping.blueprints import blueprint, variant
from sweeping.processes import have_ended, is_alive, wait_for
from wsgen.errors import NotFoundError, RequestError
from wsgen.sweeping.children import ChildDiedError, LocalExecutor, share
from wsgen.sweeping.runner import run_all

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.sweep import Row
    from wsgen.sweeping.dask_cluster import DaskExecutor
    from wsgen.sweeping.runner import RunExecutor

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(sys.platform != "linux", reason="reads /proc"),
]
dask_cluster = pytest.importorskip("wsgen.sweeping.dask_cluster")
SECONDS = 600.0  # wall-clock: on a busy machine a worker takes long to come again


def rows_of(executor: RunExecutor) -> list[Row]:
    """The rows of a few variants in their order."""
    made = blueprint()
    variants = [variant(number, world__slope=0.02 * number) for number in range(12)]
    rows = run_all(executor, lambda _: made, variants, seconds=0.2, engine="bullet")
    return sorted(rows, key=lambda row: row.number)


def test_workers_compute_what_this_machine_computes(executor: DaskExecutor) -> None:
    with LocalExecutor(1) as local:
        assert rows_of(executor) == rows_of(local)


def test_calls_are_shared_by_the_workers(executor: DaskExecutor) -> None:
    futures = [executor.submit(calls.own_id) for _ in range(20)]
    assert len({future.result() for future in as_completed(futures)}) == 2
    assert executor.window == 2 * dask_cluster.CALLS_A_THREAD


def test_files_go_with_what_names_them(executor: DaskExecutor, tmp_path: Path) -> None:
    file = tmp_path / "mesh.stl"
    for text in ("one", "other"):
        file.write_text(text)
        shared = share({"file": str(file)}, [str(file)])
        answer = executor.submit(calls.content, shared).result()
        assert answer == {"text": text, "place": str(file)}


def test_a_call_that_ends_children_is_given_up_as_on_this_machine(
    executor: DaskExecutor, tmp_path: Path
) -> None:
    marker = tmp_path / "crashes"
    with pytest.raises(ChildDiedError) as caught:
        executor.submit(calls.crash_and_count, str(marker)).result()
    assert caught.value.death.reason == "crashed (SIGSEGV)"
    assert marker.read_text() == "xxx"
    with pytest.raises(ChildDiedError, match="ValueError: It is wrong"):
        executor.submit(calls.wrong).result()


def test_calls_of_a_lost_worker_are_made_again(executor: DaskExecutor, tmp_path: Path) -> None:
    futures = [executor.submit(calls.double, number) for number in range(4)]
    killer = executor.submit(calls.end_worker_first, str(tmp_path / "killed"))
    futures += [executor.submit(calls.double, number) for number in range(4, 40)]
    assert sorted(future.result(SECONDS) for future in futures) == [2 * one for one in range(40)]
    assert killer.result(SECONDS) == "done"


def test_a_call_that_ends_workers_is_given_up(executor: DaskExecutor) -> None:
    with pytest.raises(ChildDiedError, match=r"ended 3 workers of Dask"):
        executor.submit(calls.end_worker).result(SECONDS)
    assert executor.submit(calls.double, 2).result(SECONDS) == 4


def test_what_is_left_at_the_end_is_ended(executor: DaskExecutor, tmp_path: Path) -> None:
    marker = tmp_path / "numbers"
    address = executor.address
    with contextlib.suppress(KeyboardInterrupt), dask_cluster.connect(address) as other:
        waiting = other.submit(calls.start_and_wait, str(marker))
        numbers = wait_for(marker)
        assert all(map(is_alive, numbers))
        raise KeyboardInterrupt
    with pytest.raises(CancelledError):
        waiting.result(SECONDS)
    assert have_ended(numbers)
    assert executor.submit(calls.double, 3).result(SECONDS) == 6


def test_nobody_there() -> None:
    with pytest.raises(NotFoundError, match=r"No Dask scheduler answers at tcp://127\.0\.0\.1:9: "):
        dask_cluster.connect("tcp://127.0.0.1:9")


def test_somebody_else_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dask_cluster, "CONNECT_SECONDS", 1.0)
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(NotFoundError, match=f"at {address} is not a Dask scheduler"):
            dask_cluster.connect(address)


@pytest.mark.parametrize(
    "address", ["", "x", "nonsense://x:1", "127.0.0.1:99999", "host:port", ":8786", "http://a:1"]
)
def test_what_is_no_address(address: str) -> None:
    with pytest.raises(RequestError, match=f"^`{address}` is not the address of a Dask scheduler"):
        dask_cluster.connect(address)


def test_another_version_is_refused(
    executor: DaskExecutor, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(dask_cluster, "__version__", "99.0")
    with pytest.raises(RequestError, match=r"has wsgen .*, and this machine wsgen 99\.0"):
        dask_cluster.connect(executor.address)
