"""What is in the wheel, and what pip would install with it on other machines."""

import email
import zipfile
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from made_once import wheel_of_wsgen
from resolved_packages import (
    ENGINES,
    MACHINES,
    PYTHONS,
    WITH_MUJOCO,
    extras_for,
    marker_variables,
    resolve_once,
    resolved,
)

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]
ENGINE_NAMES = {"pybullet", "pybullet-arm64", "mujoco", "mujoco-core"}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return wheel_of_wsgen(tmp_path_factory)


def test_the_wheel_holds_every_module_and_template(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        shipped = {name for name in archive.namelist() if ".dist-info/" not in name}
    modules = {
        path.relative_to(ROOT / "src").as_posix()
        for path in (ROOT / "src" / "wsgen").rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    templates = {
        "wsgen/_templates/" + path.relative_to(ROOT / "templates").as_posix()
        for path in (ROOT / "templates").rglob("*")
        if path.is_file()
    }
    assert shipped == modules | templates


def test_no_template_is_a_python_file(wheel: Path) -> None:
    """pip would compile it, and pytest would collect it."""
    with zipfile.ZipFile(wheel) as archive:
        templates = [name for name in archive.namelist() if "/_templates/" in name]
    assert templates
    assert not [name for name in templates if name.endswith(".py")]


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return resolve_once(tmp_path_factory)


@pytest.mark.parametrize(("platform", "python"), MACHINES)
def test_pip_finds_wheels_for_every_machine(reports: Path, platform: str, python: str) -> None:
    has_dart = platform.startswith("linux")
    found = resolved(reports, (extras_for(platform, python), platform, python))
    assert ("dartpy" in found) == has_dart
    engines = ENGINE_NAMES & found.keys()
    if (platform, python) in WITH_MUJOCO:
        assert len(engines) == 2
        engines -= {"mujoco", "mujoco-core"}
    assert engines == {ENGINES[platform][PYTHONS.index(python)]}
    assert ("ros-ament-cmake" in found) == (platform == "linux-x86_64")
    assert found.keys() >= {"ros-ament-package", "cmake", "numpy", "av", "plotly", "scipy"}
    assert found.keys() >= {"distributed", "pyarrow", "matplotlib"}
    # What others depend on is looked up with the variables of that machine, too.
    assert ("colorama" in found) == (platform == "windows-amd64")  # of click
    assert ("exceptiongroup" in found or "tomli" in found) == (python == "3.10")


@pytest.fixture(scope="module")
def requirements(wheel: Path) -> list[Requirement]:
    with zipfile.ZipFile(wheel) as archive:
        name = next(one for one in archive.namelist() if one.endswith("/METADATA"))
        metadata = email.message_from_bytes(archive.read(name))
    return [Requirement(line) for line in metadata.get_all("Requires-Dist", [])]


def taken(requirements: list[Requirement], variables: dict[str, str]) -> set[str]:
    """The names of what comes on such a machine without extras."""
    environment = {**variables, "extra": ""}
    return {
        one.name for one in requirements if one.marker is None or one.marker.evaluate(environment)
    }


@pytest.mark.parametrize("platform", ENGINES)
def test_one_engine_comes_on_every_machine(requirements: list[Requirement], platform: str) -> None:
    for python, engine in zip(PYTHONS, ENGINES[platform], strict=True):
        found = taken(requirements, marker_variables(platform, python))
        assert found & ENGINE_NAMES == {engine}, python


def test_no_machine_gets_what_it_has_no_wheel_for(requirements: list[Requirement]) -> None:
    """Where pip has only sources of an engine or of ament_cmake, it would start a compiler."""
    without_wheels = {"sys_platform": "linux", "platform_machine": "armv7l"}
    found = taken(requirements, {**marker_variables("linux-aarch64", "3.12"), **without_wheels})
    assert {"click", "numpy"} <= found
    assert not {one for one in found if one.startswith(("pybullet", "mujoco", "ros-ament-cmake"))}
