"""Packages whose CMake cache is of another place."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.building.installed import find_relocated
from wsgen.packages.workspace.layout import PackageFolder, Workspace

if TYPE_CHECKING:
    from pathlib import Path


def test_two_packages_with_one_name_have_not_been_moved(tmp_path: Path) -> None:
    """That there are two is the error; the cache is of one of them."""
    workspace = Workspace(root=tmp_path)
    folder = workspace.build / "rover"
    folder.mkdir(parents=True)
    cache = f"CMAKE_CACHEFILE_DIR:INTERNAL={folder}\nCMAKE_HOME_DIRECTORY:INTERNAL={tmp_path}/src\n"
    (folder / "CMakeCache.txt").write_text(cache)
    one, other = (
        PackageFolder(path=tmp_path / name, name="rover", build_type="ament_cmake")
        for name in ("src", "src_of_yesterday")
    )
    assert find_relocated(workspace, [one, other], []) == ()
    assert [found.code for found in find_relocated(workspace, [other], [])] == ["BLD026"]
    assert find_relocated(workspace, [one], []) == ()
