from pathlib import Path

import pytest

from golden_support import CASES, EXAMPLES, GOLDENS, WORKSPACE, arguments, compare_trees, generate


@pytest.mark.parametrize("case", CASES)
def test_golden(case: str, tmp_path: Path, regenerate: bool) -> None:
    workspace = generate(tmp_path, *arguments(*CASES[case]))
    compare_trees(workspace, GOLDENS / case / WORKSPACE, regenerate=regenerate)
    assert (GOLDENS / case / "COLCON_IGNORE").exists()


def test_every_golden_has_a_case() -> None:
    assert {folder.name for folder in GOLDENS.iterdir()} == set(CASES)


def test_the_example_is_what_new_writes(
    tmp_path: Path, regenerate: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    compare_trees(generate(tmp_path), EXAMPLES / WORKSPACE, regenerate=regenerate)
    assert (EXAMPLES / "COLCON_IGNORE").exists()
