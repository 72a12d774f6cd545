"""The examples of docs/testing.md and of README.md are tests that pass."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from testing.conftest import write_tests

if TYPE_CHECKING:
    from testing.conftest import Pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
EXAMPLE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def examples(page: str) -> list[str]:
    return EXAMPLE.findall((ROOT / page).read_text(encoding="utf-8"))


def test_the_examples_pass(workspace: Path, run_pytest: Pytest) -> None:
    documented = examples("docs/testing.md")
    assert len(documented) == 4
    texts = [*documented, *(text for text in examples("README.md") if "def test_" in text)]
    files = [
        write_tests(workspace, "rover", f"example_{number}", text)
        for number, text in enumerate(texts)
    ]
    run = run_pytest("-q", "--strict-markers", "-W", "error", *files)
    tests = sum(text.count("def test_") for text in texts)
    assert run.returncode == 0, run.stdout
    assert f"{tests} passed" in run.stdout
