"""A clone whose root is the package, validated where it is."""

from pathlib import Path

import pytest

from kind_workspaces import KindOfWorkspace, copy_workspace

pytestmark = pytest.mark.slow


@pytest.fixture
def clone(tmp_path: Path) -> KindOfWorkspace:
    return copy_workspace("bare_repository", tmp_path)


@pytest.mark.parametrize("inside", [".", "launch"])
def test_validated_in_place(clone: KindOfWorkspace, inside: str) -> None:
    answer = clone.wsgen("validate", "--format", "json", folder=clone.root / inside)
    (package,) = answer.document["packages"]
    assert (answer.code, package["package"]) == (0, "sled")
    assert [found["code"] for found in package["diagnostics"]] == ["PKG065"]
    assert package["robots"][0]["rest"]["xyz"][2] == pytest.approx(0.05, abs=0.005)
    assert clone.wsgen("launch", str(clone.root / "launch/sled.launch.py"), "--play").code == 0
