"""Sourcing an install space."""

import os
import shutil
from pathlib import Path

import pytest

from building.building import build_here, link_programs, outside, write_package
from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.packages.source_shares import name_sources
from wsgen.packages.workspace.layout import Workspace
from wsgen.packages.workspace.overlay import open_overlay, require_share, source_overlay

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Workspace:
    """A workspace with a space in its name, built."""
    root = tmp_path_factory.mktemp("my ws")
    write_package(root)
    assert build_here(root).succeeded
    return Workspace(root=root)


def test_the_environment_of_a_user(workspace: Workspace) -> None:
    overlay = source_overlay(workspace, {**outside(), "MINE": "one\ntwo=2"})
    prefix = workspace.install / "demo"
    assert overlay.prefixes == (prefix,)
    assert overlay.environment["AMENT_PREFIX_PATH"] == str(prefix)
    assert overlay.environment["MINE"] == "one\ntwo=2"
    assert overlay.share("demo") == prefix / "share" / "demo"
    assert overlay.share("gazebo_ros") is None
    assert overlay.packages() == ("demo",)


def test_the_first_prefix_wins(workspace: Workspace, tmp_path: Path) -> None:
    write_package(tmp_path)
    write_package(tmp_path, "more")
    build_here(tmp_path)
    under = source_overlay(workspace, outside())
    over = source_overlay(tmp_path / "install", under.environment)
    assert over.share("demo") == tmp_path / "install" / "demo" / "share" / "demo"
    assert over.packages() == ("demo", "more")
    assert over.prefixes[-1] == workspace.install / "demo"


def test_without_bash(workspace: Workspace, tmp_path: Path) -> None:
    path = link_programs(tmp_path / "programs", "sh", "env", "python3", "uname")
    overlay = source_overlay(workspace, {**outside(), "PATH": str(path)})
    assert overlay.share("demo") is not None
    with pytest.raises(NotFoundError, match="Install bash"):
        source_overlay(workspace, {**outside(), "PATH": str(tmp_path)})


def test_not_built(tmp_path: Path) -> None:
    with pytest.raises(NotFoundError, match="wsgen build"):
        source_overlay(Workspace(root=tmp_path), outside())


@pytest.mark.parametrize("script", ["echo went wrong >&2; return 3", "exit 0"])
def test_a_setup_file_that_fails(script: str, tmp_path: Path) -> None:
    (tmp_path / "setup.bash").write_text(script)
    with pytest.raises(NotReadableError, match="cannot be sourced"):
        source_overlay(tmp_path, outside())


def test_what_a_setup_file_prints_is_no_variable(tmp_path: Path) -> None:
    (tmp_path / "setup.bash").write_text("echo A=1; export B=2")
    variables = source_overlay(tmp_path, outside()).environment
    assert (variables.get("A"), variables.get("B")) == (None, "2")


def test_a_package_that_is_there(workspace: Workspace) -> None:
    overlay = source_overlay(workspace, outside())
    assert require_share(overlay, workspace, "demo") == overlay.share("demo")


def test_the_source_of_a_package_that_was_not_built(workspace: Workspace) -> None:
    package = write_package(workspace.root, "late")
    broken = write_package(workspace.root, "broken")
    (broken / "package.xml").write_text("<package>")
    try:
        with open_overlay([workspace], outside()) as overlay:
            assert require_share(overlay, workspace, "late") == package
            assert overlay.share("demo") == workspace.install / "demo" / "share" / "demo"
            assert overlay.packages() == ("demo", "late")
            with pytest.raises(NotFoundError, match="package broken cannot be read"):
                require_share(overlay, workspace, "broken")
            path = overlay.environment["AMENT_PREFIX_PATH"]
            link = Path(path.split(os.pathsep)[-1], "share", "late")
            lib = f"{link.parents[1]}/lib"
            answer = {"paths": [f"{link}/launch", f"{link}_x", f"{link.parent}:{lib}", 3]}
            named = {"paths": [f"{package}/launch", f"{package}_x", f"{package.parent}:{lib}", 3]}
            assert name_sources(answer, overlay.environment) == named
        assert not link.exists()
    finally:
        shutil.rmtree(package)
        shutil.rmtree(broken)


def test_of_packages_with_one_name_the_nearest_counts(tmp_path: Path) -> None:
    first = write_package(tmp_path / "src" / "humble")
    second = write_package(tmp_path / "src" / "iron")
    workspace = Workspace(root=tmp_path)
    for near, found in ((None, first), (second / "urdf", second)):
        with open_overlay([workspace], outside(), near=near) as overlay:
            assert overlay.share("demo") == found


def test_packages_around_the_one_of_a_clone_are_looked_up(tmp_path: Path) -> None:
    beside = write_package(tmp_path / "clone" / "common", "common")
    write_package(tmp_path / "outside")
    package = write_package(tmp_path / "clone" / "robots", "robot")
    (tmp_path / "clone" / ".git").mkdir()
    with open_overlay([Workspace(root=package)], outside()) as overlay:
        found = {name: overlay.share(name) for name in ("robot", "common", "demo")}
    assert found == {"robot": package, "common": beside, "demo": None}


@pytest.mark.parametrize("known", [True, False])
def test_a_package_that_nobody_knows(workspace: Workspace, known: bool) -> None:
    overlay = source_overlay(workspace, outside())
    with pytest.raises(RequestError, match=r"Did you mean `demo`\?"):
        require_share(overlay, workspace if known else None, "dmeo")


@pytest.mark.parametrize(("known", "hint"), [(True, "Known: demo"), (False, "Go to the workspace")])
def test_a_package_of_another_workspace(workspace: Workspace, known: bool, hint: str) -> None:
    overlay = source_overlay(workspace, outside())
    with pytest.raises(RequestError, match=hint):
        require_share(overlay, workspace if known else None, "something_else")


def test_nothing_of_this_process_comes_in(workspace: Workspace) -> None:
    assert "PYTEST_CURRENT_TEST" in os.environ
    assert "PYTEST_CURRENT_TEST" not in source_overlay(workspace, outside()).environment
