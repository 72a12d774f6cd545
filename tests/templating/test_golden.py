from pathlib import Path

import pytest

from golden_support import EXAMPLES, GOLDENS, WORKSPACE, compare_trees, generate
from wsgen.model.target import TARGETS
from wsgen.templating.manifest import template_names

CASES = {
    f"{template}-{target.name}": (
        "-t",
        template,
        "--distro",
        target.distro,
        "--sim",
        target.simulator,
    )
    for template in template_names()
    for target in TARGETS
}


@pytest.mark.parametrize("case", CASES)
def test_golden(case: str, tmp_path: Path, regenerate: bool) -> None:
    workspace = generate(tmp_path, *CASES[case])
    compare_trees(workspace, GOLDENS / case / WORKSPACE, regenerate=regenerate)
    assert (GOLDENS / case / "COLCON_IGNORE").exists()


def test_every_golden_has_a_case() -> None:
    assert {folder.name for folder in GOLDENS.iterdir()} == set(CASES)


def test_the_example_is_what_new_writes(
    tmp_path: Path, regenerate: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    compare_trees(generate(tmp_path), EXAMPLES / WORKSPACE, regenerate=regenerate)
    # At the folder above, so that the example itself can be built.
    assert (EXAMPLES / "COLCON_IGNORE").exists()
