"""The cluster that all tests share; its workers are processes of this machine."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.sweeping.dask_cluster import DaskExecutor


@pytest.fixture(scope="session")
def executor() -> Iterator[DaskExecutor]:
    """Two workers of Dask on the loopback interface."""
    dask_cluster = pytest.importorskip("wsgen.sweeping.dask_cluster")
    with dask_cluster.connect("local", 2) as made:
        yield made
