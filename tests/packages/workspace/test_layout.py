"""Where a workspace begins, and which packages are in it."""

from pathlib import Path

import pytest

from building.building import PACKAGE_XML, write_package
from wsgen.building.colcon import refuse_empty
from wsgen.errors import NotFoundError, RequestError
from wsgen.packages.workspace.layout import (
    Workspace,
    find_launch_files,
    find_packages,
    find_source_tree,
    find_workspace,
    open_workspace,
    take_inventory,
    with_surroundings,
    workspace_around,
)


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A home folder with a workspace in it."""
    monkeypatch.setenv("HOME", str(tmp_path))
    write_package(tmp_path / "ws")
    return tmp_path / "ws"


@pytest.mark.parametrize("inside", [".", "src", "src/demo", "src/demo/model", "src/demo/src/code"])
def test_found_from_everywhere_inside(root: Path, inside: str) -> None:
    (root / inside).mkdir(exist_ok=True, parents=True)
    assert find_workspace(root / inside) == Workspace(root=root)


@pytest.mark.parametrize(
    ("inside", "mark"),
    [
        ("docs", "install/.colcon_install_layout"),
        ("build/demo", "build/.built_by"),
        ("install/demo/share", "install/.colcon_install_layout"),
        ("log", "log/latest_build"),
    ],
)
def test_found_from_beside_its_source_folder_once_it_is_built(
    inside: str, mark: str, root: Path
) -> None:
    (root / inside).mkdir(parents=True)
    assert find_workspace(root / inside) is None
    (root / mark).parent.mkdir(exist_ok=True)
    (root / mark).write_text("colcon\n")
    (root / inside.partition("/")[0] / "COLCON_IGNORE").touch()
    (root / "docs").mkdir(exist_ok=True)
    assert find_workspace(root / ("docs" if inside == "docs" else inside)) == Workspace(root=root)


def test_files_beside_its_source_folder_belong_to_the_workspace_of_the_current_folder(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (root / "worlds").mkdir()
    for here, found in ((root, root), (root / "src" / "demo", root), (root / "worlds", None)):
        monkeypatch.chdir(here)
        workspace = workspace_around(root / "worlds")
        assert (workspace and workspace.root) == found
    monkeypatch.chdir(root)
    assert workspace_around(root.parent) is None


def test_a_source_folder_above_captures_nobody(
    root: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """`src` of another folder, and `build` and `install` of other tools."""
    monkeypatch.setenv("HOME", str(tmp_path / "elsewhere"))
    write_package(tmp_path, "tool")
    for other in ("build/CMakeCache.txt", "install/bin/tool", "build/.built_by", "log/app.log"):
        (tmp_path / other).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / other).write_text("catkin build\n")
    demo = tmp_path / "project" / "demo"
    demo.mkdir(parents=True)
    assert find_workspace(demo) is None
    monkeypatch.chdir(demo)
    with pytest.raises(NotFoundError, match="is not in a colcon workspace") as raised:
        open_workspace(None)
    assert raised.value.hint == (
        f"demo is outside of the src of {tmp_path}. To use that workspace: -w {tmp_path}"
    )
    (demo / "src").mkdir()
    assert find_workspace(demo) == Workspace(root=demo)
    monkeypatch.chdir(root)
    assert open_workspace(None) == Workspace(root=root)


@pytest.mark.parametrize("inside", [".", "src", "src/notes", "src/notes/deep"])
@pytest.mark.parametrize("content", ["", "README.md", "robot/CMakeLists.txt"])
def test_nobody_is_taken_upwards_past_a_source_folder_without_packages(
    content: str, inside: str, tmp_path: Path
) -> None:
    write_package(tmp_path, "tool")
    inner = tmp_path / "src" / "experiments" / "ws"
    (inner / inside).mkdir(parents=True)
    (inner / "src").mkdir(exist_ok=True)
    if content:
        (inner / "src" / content).parent.mkdir(exist_ok=True)
        (inner / "src" / content).touch()
    assert find_workspace(inner / inside) == Workspace(root=inner)


def test_the_firmware_of_a_package_is_no_workspace(root: Path) -> None:
    firmware = root / "src" / "demo" / "firmware"
    (firmware / "src" / "main").mkdir(parents=True)
    assert find_workspace(firmware) == Workspace(root=root)
    assert find_workspace(firmware / "src" / "main") == Workspace(root=root)


def test_the_nearest_marks_count(root: Path) -> None:
    for folder in (root.parent, root.parent / "other", root.parent / "other" / "deep"):
        (folder / "install").mkdir(parents=True)
        (folder / "install" / ".colcon_install_layout").write_text("isolated\n")
    (root.parent / "other" / "deep" / "here").mkdir()
    found = find_workspace(root.parent / "other" / "deep" / "here")
    assert found == Workspace(root=root.parent / "other" / "deep")


def test_a_package_that_is_a_link_is_in_the_workspace_that_the_shell_shows(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = root.parent / "kept"
    (root / "src" / "demo").rename(kept)
    (root / "src" / "demo").symlink_to(kept)
    monkeypatch.chdir(root / "src" / "demo")
    monkeypatch.setenv("PWD", str(root / "src" / "demo"))
    assert open_workspace(None) == Workspace(root=root)
    monkeypatch.setenv("PWD", str(root))  # as a program that has changed the folder leaves it
    assert open_workspace(None) == Workspace(root=kept)


def test_the_folders(root: Path) -> None:
    workspace = Workspace(root=root)
    folders = (workspace.source, workspace.build, workspace.install, workspace.log)
    assert [folder.relative_to(root).as_posix() for folder in folders] == [
        "src",
        "build",
        "install",
        "log",
    ]


def test_not_from_outside(root: Path) -> None:
    assert find_workspace(root.parent) is None


def test_an_empty_source_folder_is_a_beginning(tmp_path: Path) -> None:
    (tmp_path / "ws" / "src").mkdir(parents=True)
    assert find_workspace(tmp_path / "ws" / "src") == Workspace(root=tmp_path / "ws")


@pytest.mark.parametrize(
    "marker", ["pyproject.toml", "Cargo.toml", "CMakeLists.txt", "package.xml"]
)
def test_the_source_folder_of_another_project(marker: str, tmp_path: Path) -> None:
    (tmp_path / "project" / "src" / "project").mkdir(parents=True)
    (tmp_path / "project" / marker).touch()
    assert find_workspace(tmp_path / "project" / "src") is None
    assert find_workspace(tmp_path / "project") is None


def test_the_source_folder_at_home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "src" / "linux").mkdir(parents=True)
    assert find_workspace(tmp_path / "src" / "linux") is None


def test_a_package_is_no_workspace(root: Path) -> None:
    (root / "src" / "demo" / "src").mkdir()
    assert find_workspace(root / "src" / "demo" / "src") == Workspace(root=root)


@pytest.mark.parametrize(
    ("marker", "text"),
    [("install/.colcon_install_layout", "isolated\n"), ("build/.built_by", "colcon\n")],
)
def test_what_colcon_left_is_evidence(tmp_path: Path, marker: str, text: str) -> None:
    (tmp_path / marker).parent.mkdir()
    (tmp_path / marker).write_text(text)
    (tmp_path / "robots").mkdir()
    assert find_workspace(tmp_path / "robots") == Workspace(root=tmp_path)


def test_a_build_in_the_source_folder_by_mistake_hides_nothing(root: Path) -> None:
    (root / "src" / "install").mkdir()
    (root / "src" / "install" / ".colcon_install_layout").write_text("isolated\n")
    assert find_workspace(root / "src" / "demo") == Workspace(root=root)


def test_the_inner_of_two_workspaces(root: Path) -> None:
    write_package(root / "src" / "vendor")
    assert find_workspace(root / "src" / "vendor") == Workspace(root=root / "src" / "vendor")


def test_the_home_folder_needs_evidence(root: Path) -> None:
    home = root.parent
    write_package(home, "loose")
    (home / "letters").mkdir()
    assert find_workspace(home / "letters") is None
    (home / "build").mkdir()
    (home / "build" / ".built_by").write_text("colcon\n")
    assert find_workspace(home / "letters") is None  # a build at home is a mistake more often
    assert find_workspace(home / "src" / "loose") == Workspace(root=home)
    assert find_workspace(home) == Workspace(root=home)


def test_a_folder_of_everybody_captures_nobody(tmp_path: Path) -> None:
    shared, own = tmp_path / "shared", tmp_path / "shared" / "own" / "demo"
    write_package(shared, "loose")
    own.mkdir(parents=True)
    (shared / "install").mkdir()
    (shared / "install" / ".colcon_install_layout").write_text("isolated\n")
    assert find_workspace(own) == Workspace(root=shared)
    shared.chmod(0o1777)  # as /tmp
    assert find_workspace(own) is None
    assert find_workspace(shared) == Workspace(root=shared)


def test_an_ignored_folder_is_no_workspace(root: Path) -> None:
    (root / "COLCON_IGNORE").touch()
    assert find_workspace(root) is None


def test_packages_are_those_that_colcon_finds(root: Path) -> None:
    write_package(root / "src" / "group", "second")
    write_package(root, "inside_package").rename(root / "src" / "demo" / "nested")
    (write_package(root, "ignored") / "COLCON_IGNORE").touch()
    write_package(root, ".hidden")
    (root / "src" / "group" / "loop").symlink_to(root / "src")
    assert [package.name for package in find_packages(Workspace(root=root))] == ["demo", "second"]


@pytest.mark.parametrize("marker", ["pyvenv.cfg", "conda-meta/history"])
def test_the_packages_of_an_environment_of_python_are_not_of_the_workspace(
    root: Path, marker: str
) -> None:
    write_package(root / "venv", "installed").parent.rename(root / "venv" / "share")
    assert [package.name for package in find_packages(Workspace(root=root))] == [
        "demo",
        "installed",
    ]
    for folder in (root / "venv", root):  # a workspace in an environment is one
        (folder / marker).parent.mkdir(exist_ok=True)
        (folder / marker).touch()
    assert [package.name for package in find_packages(Workspace(root=root))] == ["demo"]
    for folder in (root / "src" / "demo", root / "src" / "demo" / "env"):
        (folder / marker).parent.mkdir(exist_ok=True, parents=True)
        (folder / marker).touch()
        (folder / "robot.launch.py").touch()
    # A package that is one itself is still built, without what is in another one below it.
    assert [package.name for package in find_packages(Workspace(root=root))] == ["demo"]
    found = [file.parent.name for file in find_launch_files(root / "src" / "demo")]
    assert found == ["launch", "demo"]


def test_a_broken_manifest_is_reported_and_the_others_are_listed(root: Path) -> None:
    (write_package(root, "broken") / "package.xml").write_text("<package>\n<name>")
    broken, demo = find_packages(Workspace(root=root))
    assert (broken.name, broken.build_type) == ("broken", "")
    assert [(found.code, found.line) for found in broken.diagnostics] == [("PKG001", 2)]
    assert (demo.name, demo.build_type, demo.diagnostics) == ("demo", "ament_cmake", ())


@pytest.mark.parametrize(
    ("file", "others", "has_python"),
    [("CMakeLists.txt", 1, False), ("setup.py", 1, True), ("package.json", 0, False)],
)
def test_what_is_no_ros_package(root: Path, file: str, others: int, has_python: bool) -> None:
    (root / "src" / "other").mkdir()
    (root / "src" / "other" / file).touch()
    inventory = take_inventory(Workspace(root=root))
    assert (len(inventory.others), inventory.has_python) == (others, has_python)


def test_what_catkin_left_behind_hides_no_package(root: Path) -> None:
    file = root / "src" / "CMakeLists.txt"
    file.symlink_to("/opt/ros/noetic/share/catkin/cmake/no_such.cmake")
    assert [package.name for package in find_packages(Workspace(root=root))] == ["demo"]
    file.unlink()
    file.write_text("project(Project)\n# a comment\ncatkin_workspace()\n")
    inventory = take_inventory(Workspace(root=root))
    assert [package.name for package in inventory.packages] == ["demo"]
    assert not inventory.others
    file.write_text("project(other)\n")
    assert not find_packages(Workspace(root=root))


def test_a_package_xml_of_another_world(root: Path) -> None:
    (root / "src" / "pear").mkdir()
    (root / "src" / "pear" / "package.xml").write_text("<extension/>")
    assert [package.name for package in find_packages(Workspace(root=root))] == ["demo"]


def test_a_dead_link_is_no_package(root: Path) -> None:
    (root / "src" / "copy").mkdir(parents=True)
    (root / "src" / "copy" / "package.xml").symlink_to(root / "missing" / "package.xml")
    assert [package.name for package in find_packages(Workspace(root=root))] == ["demo"]


def test_a_python_package_is_noticed(root: Path) -> None:
    write_package(
        root, "scripts", package_xml=PACKAGE_XML.replace("ament_cmake</b", "ament_python</b")
    )
    assert take_inventory(Workspace(root=root)).has_python


def test_opening(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert open_workspace(str(root)) == Workspace(root=root)
    monkeypatch.chdir(root / "src")
    assert open_workspace(None) == Workspace(root=root)
    assert open_workspace("demo") == Workspace(root=root / "src" / "demo")
    with pytest.raises(NotFoundError, match="does not exist"):
        open_workspace(str(root / "nowhere"))


def test_opening_from_the_folder_in_which_new_was_called(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(root.parent)
    assert open_workspace(None) == Workspace(root=root)
    other = root.parent / "other"
    (other / "src" / "package").mkdir(parents=True)
    (other / "src" / "package" / "package.xml").touch()
    with pytest.raises(RequestError, match="several colcon workspaces") as raised:
        open_workspace(None)
    assert "other" in raised.value.hint


def test_opening_what_is_around_a_workspace(root: Path) -> None:
    with pytest.raises(RequestError, match="it contains ws") as raised:
        open_workspace(str(root.parent))
    assert raised.value.hint == f"Write: -w {root}"
    (root.parent / "build").mkdir()
    (root.parent / "build" / ".built_by").write_text("colcon\n")
    assert open_workspace(str(root.parent)) == Workspace(root=root.parent)  # as it was meant


def test_opening_the_src_of_a_workspace(root: Path) -> None:
    with pytest.raises(RequestError, match="is the folder src of a workspace") as raised:
        open_workspace(str(root / "src"))
    assert raised.value.hint == f"Name the workspace: -w {root}"
    (root / "src" / "src").mkdir()
    assert open_workspace(str(root / "src")) == Workspace(root=root / "src")


@pytest.mark.parametrize("inside", [".", "ws", "ws/src", "ws/src/demo"])
def test_opening_where_the_package_has_no_manifest(
    inside: str, root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (root / "src" / "demo" / "package.xml").unlink()
    monkeypatch.chdir(root.parent / inside)
    with pytest.raises(NotFoundError) as raised:
        refuse_empty(open_workspace(None))
    assert raised.value.message.startswith(f"{root / 'src' / 'demo'} has no package.xml")


def test_a_clone_is_taken_for_a_workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The package around, or what is below; what is beside it or in its repository is looked up."""
    home, clone = tmp_path / "home", tmp_path / "home" / "clone"
    monkeypatch.setenv("HOME", str(home))
    (home / ".git").mkdir(parents=True)
    inside = []
    for group in ("robots/rover", "robots/tools", "common/meshes"):
        (clone / group / "urdf").mkdir(parents=True)
        (clone / group / "package.xml").write_text(f"<package><name>{group[-5:]}</name></package>")
        inside.append(clone / group / "urdf")
    trees = [find_source_tree(folder) for folder in inside]
    assert [tree and tree.root for tree in trees] == [
        clone / "robots",
        clone / "robots",
        clone / "common" / "meshes",
    ]
    monkeypatch.chdir(clone)
    assert open_workspace(None) == Workspace(root=clone)
    monkeypatch.chdir(inside[0])
    place = open_workspace(None)
    assert place == Workspace(root=clone / "robots" / "rover")
    assert with_surroundings(place) == (Workspace(root=clone / "robots"), place)
    (clone / ".git").mkdir()
    assert open_workspace(None) == place
    assert with_surroundings(place) == (Workspace(root=clone), place)
    assert [find_source_tree(folder) for folder in inside] == [Workspace(root=clone)] * 3
    assert find_source_tree(home) is None
    (clone / "COLCON_IGNORE").touch()  # then colcon finds nothing from there
    assert find_source_tree(inside[0]) == Workspace(root=clone / "robots")


def test_opening_where_there_is_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "somewhere" / "src").mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(NotFoundError, match="is not in a colcon workspace"):
        open_workspace(None)
