"""What lies on the path of nodes alone is on that of these tests, too, and of no others."""

import sys
from pathlib import Path

import pytest

SHIM = str(Path(__file__).parents[3] / "src" / "wsgen" / "ros" / "shim")

sys.path.append(SHIM)  # while these modules are imported


def pytest_collection_finish() -> None:
    """Take it away: children of other tests are given the path of this process."""
    if SHIM in sys.path:
        sys.path.remove(SHIM)


@pytest.fixture(autouse=True)
def _path(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "path", [*sys.path, SHIM])
