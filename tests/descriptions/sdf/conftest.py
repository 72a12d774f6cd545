"""What the tests of worlds share: a text to an `SdfFile`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.sdf.lookup import model_finder
from wsgen.descriptions.sdf.models import SdfFile, read_sdf

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


@pytest.fixture
def models(tmp_path: Path) -> Path:
    """A folder in which models are found."""
    folder = tmp_path / "models"
    folder.mkdir()
    return folder


@pytest.fixture
def read(tmp_path: Path, models: Path) -> Callable[..., SdfFile]:
    """Reads what is in an <sdf>."""

    def reader(content: str, version: str = "1.9") -> SdfFile:
        file = tmp_path / "scene.sdf"
        file.write_text(f'<sdf version="{version}">\n{content}\n</sdf>', encoding="utf-8")
        environment = {"GAZEBO_MODEL_PATH": str(models)}
        return read_sdf(file, find_model=model_finder(file, environment))

    return reader
