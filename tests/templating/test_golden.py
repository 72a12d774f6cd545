from pathlib import Path

import pytest

from golden_support import (
    CASES,
    EXAMPLES,
    GOLDENS,
    PACKAGE,
    WORKSPACE,
    arguments,
    compare_golden,
    compare_trees,
    generate,
    golden_package,
    read_tree,
)


@pytest.mark.parametrize("case", CASES)
def test_golden(case: str, tmp_path: Path, regenerate: bool) -> None:
    compare_golden(case, tmp_path, regenerate=regenerate)
    assert (GOLDENS / case / "COLCON_IGNORE").exists()


@pytest.mark.slow
@pytest.mark.parametrize("case", ["simple-humble-classic", "arm-rolling-gz"])
def test_a_golden_of_differences_is_completed(case: str, tmp_path: Path) -> None:
    workspace = generate(tmp_path, *arguments(*CASES[case]))
    assert read_tree(golden_package(case)) == read_tree(workspace / "src" / PACKAGE)


def test_every_golden_has_a_case() -> None:
    assert {folder.name for folder in GOLDENS.iterdir()} == set(CASES)


def test_the_example_is_what_new_writes(
    tmp_path: Path, regenerate: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    compare_trees(generate(tmp_path), EXAMPLES / WORKSPACE, regenerate=regenerate)
    assert (EXAMPLES / "COLCON_IGNORE").exists()
