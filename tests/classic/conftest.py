"""What the tests that ask Gazebo Classic share."""

import pytest

from classic.gazebo_classic import why_missing


@pytest.fixture(scope="session")
def gazebo_classic() -> None:
    """Skips where it cannot be asked."""
    if reason := why_missing():
        pytest.skip(reason)
