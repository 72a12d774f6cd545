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


def test_built_in_place(clone: KindOfWorkspace) -> None:
    """Then there are two launch files below its root, and the installed one counts."""
    assert clone.wsgen("build").code == 0
    answer = clone.wsgen("validate", "--format", "json")
    (package,) = answer.document["packages"]
    assert (answer.code, package["diagnostics"]) == (0, [])
    assert package["share"].endswith("install/sled/share/sled")
    (clone.root / "install/sled/share/ament_index/resource_index/packages/sled").unlink()
    answer = clone.wsgen("validate", "--format", "json")
    (package,) = answer.document["packages"]
    assert (answer.code, [found["code"] for found in package["diagnostics"]]) == (1, ["PKG065"])


def test_the_files_of_its_robot(clone: KindOfWorkspace) -> None:
    """The URDF is expanded as it uses xacro; the file that it includes is no robot."""
    answer = clone.wsgen("validate", "urdf/runners.xacro", "urdf/sled.urdf", "--format", "json")
    part, whole = answer.document["packages"]
    assert answer.code == 1
    (found,) = part["diagnostics"]
    assert (found["code"], whole["diagnostics"]) == ("PKG067", [])
    assert "macros (runners)" in found["message"]
    assert found["hint"].endswith("wsgen validate urdf/sled.urdf")
    assert whole["robots"][0]["mass"] == 2.5


def test_a_file_outside_finds_no_package_of_the_current_folder(
    clone: KindOfWorkspace, tmp_path: Path
) -> None:
    (tmp_path / "sled.urdf").write_text((clone.root / "urdf" / "sled.urdf").read_text())
    answer = clone.wsgen("validate", str(tmp_path / "sled.urdf"), "--format", "json")
    assert answer.document["packages"][0]["diagnostics"][0]["code"] == "ROB071"


def test_what_an_included_file_lacks(clone: KindOfWorkspace) -> None:
    runners = clone.root / "urdf" / "runners.xacro"
    runners.write_text(runners.read_text().replace("</xacro:macro>", "</xacro:macro>\n${width}"))
    answer = clone.wsgen("validate", "urdf/runners.xacro", "--format", "json")
    (found,) = answer.document["packages"][0]["diagnostics"]
    assert found["code"] == "ROB071"
    assert found["hint"].endswith(
        "Or validate the file that includes it: wsgen validate urdf/sled.urdf"
    )


def test_an_included_file_with_links(clone: KindOfWorkspace) -> None:
    runners = clone.root / "urdf" / "runners.xacro"
    runners.write_text(runners.read_text().replace("</robot>", '<link name="seat"/></robot>'))
    answer = clone.wsgen("validate", "urdf/runners.xacro", "--format", "json")
    (package,) = answer.document["packages"]
    assert [found["code"] for found in package["diagnostics"]] == ["PKG067"]
    assert package["robots"] == []
