"""Packages with tests in them, and pytest runs of these."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING

import pytest

from golden_support import golden_package

if TYPE_CHECKING:
    from pathlib import Path

Pytest = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace with a robot on two wheels and an arm, not built."""
    root = tmp_path_factory.mktemp("robots")
    for name, golden in (("rover", "diff_drive-jazzy-gz"), ("arm", "arm-jazzy-gz")):
        folder = root / "src" / name
        shutil.copytree(golden_package(golden), folder)
        for file in folder.rglob("*"):
            if file.is_file():
                text = file.read_text(encoding="utf-8")
                file.write_text(re.sub(r"\bgazebo_test\b", name, text), encoding="utf-8")
    return root


@pytest.fixture
def run_pytest(tmp_path: Path) -> Pytest:
    """Runs pytest on what is given, in an empty folder."""

    def run(*arguments: str | Path, **environment: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", "--color=no"]
        command += ["--basetemp", str(tmp_path / "pytest"), *map(str, arguments)]
        return subprocess.run(
            command,
            cwd=tmp_path,
            env={**os.environ, "COLUMNS": "200", **environment},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


def write_tests(workspace: Path, package: str, name: str, text: str) -> Path:
    """A file with tests in a package."""
    file = workspace / "src" / package / "test" / f"test_{name}.py"
    file.write_text(text, encoding="utf-8")
    return file
