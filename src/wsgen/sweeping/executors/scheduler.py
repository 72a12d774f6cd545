"""Connect to a Dask cluster, if the library is installed; the only way in for other packages."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from wsgen.sweeping.executors.dask_cluster import DaskExecutor


def connect(scheduler: str, jobs: int = 1) -> DaskExecutor:
    """See `wsgen.sweeping.executors.dask_cluster.connect`.

    Raises:
        NotFoundError: Also where Dask is not installed.
    """
    if find_spec("distributed") is None:
        raise NotFoundError(
            "Dask's `distributed`, which --scheduler needs, is not installed.",
            hint="Install it: pip install 'wsgen[sweep]'; or leave out --scheduler.",
        )
    from wsgen.sweeping.executors import dask_cluster  # noqa: PLC0415  an extra, which takes a second

    return dask_cluster.connect(scheduler, jobs)
