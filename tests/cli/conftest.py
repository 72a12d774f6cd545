"""Fixtures of more than one module."""

from pathlib import Path

import pytest

from cli.packages import PACKAGE, wsgen


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A built workspace that no test changes."""
    root = tmp_path_factory.mktemp("built")
    made = wsgen(root, "new", PACKAGE, "--maintainer-name", "A", "--maintainer-email", "a@b.cd")
    assert made.returncode == 0, made.stderr
    workspace = root / "ws_gazebo"
    build = wsgen(workspace, "build")
    assert build.returncode == 0, build.stderr
    return workspace
