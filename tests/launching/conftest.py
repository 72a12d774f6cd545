from pathlib import Path

import pytest

from install_space import InstallSpace


@pytest.fixture
def space(tmp_path: Path) -> InstallSpace:
    return InstallSpace(tmp_path / "install")
