"""What is in the wheel, and what pip would install with it on other machines."""

import email
import json
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import pytest
from packaging.requirements import Requirement

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", folder, ROOT],
        check=True,
        capture_output=True,
    )
    return next(folder.glob("wsgen-*.whl"))


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


PYTHONS = ("3.10", "3.11", "3.12", "3.13", "3.14")
# Variables of markers, and the tags of wheels, by the name of the platform.
PLATFORMS: dict[str, tuple[dict[str, str], tuple[str, ...]]] = {
    "linux-x86_64": (
        {"sys_platform": "linux", "platform_machine": "x86_64"},
        ("manylinux2014_x86_64", *(f"manylinux_2_{n}_x86_64" for n in (28, 27, 26, 24, 17))),
    ),
    "linux-aarch64": (
        {"sys_platform": "linux", "platform_machine": "aarch64"},
        ("manylinux2014_aarch64", *(f"manylinux_2_{n}_aarch64" for n in (28, 27, 26, 24, 17))),
    ),
    "macos-arm64": (
        {"sys_platform": "darwin", "platform_machine": "arm64"},
        ("macosx_14_0_arm64",),
    ),
    "macos-x86_64": (
        {"sys_platform": "darwin", "platform_machine": "x86_64"},
        ("macosx_13_0_x86_64",),
    ),
    "windows-amd64": (
        {"sys_platform": "win32", "platform_machine": "AMD64"},
        ("win_amd64",),
    ),
}
SYSTEMS = {"linux": ("posix", "Linux"), "darwin": ("posix", "Darwin"), "win32": ("nt", "Windows")}
# pip evaluates markers, those of what is depended on among them, with its own interpreter.
PIP_FOR_ANOTHER_MACHINE = """
import json, sys
from pip._internal.cli.main import main
from pip._vendor.packaging import markers
variables = json.loads(sys.argv[1])
markers.default_environment = lambda: dict(variables)
sys.exit(main(sys.argv[2:]))
"""
# An engine for everybody: PyBullet where it has wheels, otherwise MuJoCo.
ENGINES = {
    "linux-x86_64": ("pybullet", "pybullet", "pybullet-arm64", "pybullet-arm64", "mujoco-core"),
    "linux-aarch64": ("mujoco", "mujoco-core", "mujoco-core", "mujoco-core", "mujoco-core"),
    "macos-arm64": (*["pybullet-arm64"] * 4, "mujoco-core"),
    "macos-x86_64": ("mujoco",) * 5,
    "windows-amd64": (*["pybullet-arm64"] * 4, "mujoco-core"),
}


def marker_variables(platform: str, python: str) -> dict[str, str]:
    """The variables of markers on another machine."""
    variables, _ = PLATFORMS[platform]
    os_name, system = SYSTEMS[variables["sys_platform"]]
    return {
        **variables,
        "os_name": os_name,
        "platform_system": system,
        "platform_release": "",
        "platform_version": "",
        "platform_python_implementation": "CPython",
        "implementation_name": "cpython",
        "implementation_version": f"{python}.0",
        "python_version": python,
        "python_full_version": f"{python}.0",
    }


@pytest.fixture(scope="module")
def index(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with what has no wheel, built here; skips where pip has no index."""
    folder = tmp_path_factory.mktemp("index")
    build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", str(folder)]
    run = subprocess.run([*build, "empy>=3.3.4,<4"], capture_output=True, text=True, check=False)
    if run.returncode != 0:
        pytest.skip(f"pip gets nothing here: {run.stderr[-300:]}")
    # One file in Python: what is built here is what is built elsewhere.
    assert [file.name.endswith("-none-any.whl") for file in folder.iterdir()] == [True]
    return folder


def resolve(wheel: Path, extras: str, platform: str, python: str, index: Path) -> dict[str, Any]:
    """What pip would install on another machine: the metadata of each distribution by its name."""
    _, tags = PLATFORMS[platform]
    options = ["--dry-run", "--ignore-installed", "--report", "-", "--only-binary", ":all:"]
    options += ["--implementation", "cp", "--python-version", python]
    options += [word for tag in tags for word in ("--platform", tag)]
    options += ["--target", str(index / "nothing"), "--find-links", str(index)]
    pip = (sys.executable, "-c", PIP_FOR_ANOTHER_MACHINE)
    variables = json.dumps(marker_variables(platform, python))
    run = subprocess.run(
        [*pip, variables, "install", "--quiet", *options, f"{wheel}{extras}"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    found = [one["metadata"] for one in json.loads(run.stdout)["install"]]
    return {one["name"].lower().replace("_", "-"): one for one in found}


# pip takes ten seconds for each. On other machines than the usual one: the oldest Python, the
# newest, and the first of each engine.
MACHINES = [
    (platform, python)
    for platform, engines in ENGINES.items()
    for python, engine, before in zip(PYTHONS, engines, (None, *engines), strict=False)
    if platform == "linux-x86_64" or python == PYTHONS[-1] or engine != before
]


@pytest.mark.parametrize(("platform", "python"), MACHINES)
def test_pip_finds_wheels_for_every_machine(
    wheel: Path, index: Path, platform: str, python: str
) -> None:
    has_dart = platform.startswith("linux")
    extras = "[dart,video,report,sweep]" if has_dart else "[video,report,sweep]"
    found = resolve(wheel, extras, platform, python, index)
    assert ("dartpy" in found) == has_dart
    engines = {"pybullet", "pybullet-arm64", "mujoco", "mujoco-core"} & found.keys()
    assert engines == {ENGINES[platform][PYTHONS.index(python)]}
    assert ("ros-ament-cmake" in found) == (platform == "linux-x86_64")
    assert found.keys() >= {"ros-ament-package", "cmake", "numpy", "av", "plotly", "scipy"}
    assert found.keys() >= {"distributed", "pyarrow", "matplotlib"}
    # What others depend on is looked up with the variables of that machine, too.
    assert ("colorama" in found) == (platform == "windows-amd64")  # of click
    assert ("exceptiongroup" in found or "tomli" in found) == (python == "3.10")


@pytest.mark.parametrize(
    ("platform", "python"),
    [("linux-x86_64", "3.10"), ("macos-arm64", "3.11"), ("windows-amd64", "3.13")],
)
def test_mujoco_is_an_extra_elsewhere(wheel: Path, index: Path, platform: str, python: str) -> None:
    found = resolve(wheel, "[mujoco]", platform, python, index)
    assert {"mujoco", "mujoco-core"} & found.keys()


def test_no_machine_gets_what_it_has_no_wheel_for(wheel: Path) -> None:
    """Where pip has only sources of an engine or of ament_cmake, it would start a compiler."""
    with zipfile.ZipFile(wheel) as archive:
        name = next(one for one in archive.namelist() if one.endswith("/METADATA"))
        metadata = email.message_from_bytes(archive.read(name))
    requirements = [Requirement(line) for line in metadata.get_all("Requires-Dist", [])]
    without_wheels = {"sys_platform": "linux", "platform_machine": "armv7l"}
    variables = {**marker_variables("linux-aarch64", "3.12"), **without_wheels, "extra": ""}
    taken = {
        one.name for one in requirements if one.marker is None or one.marker.evaluate(variables)
    }
    assert {"click", "numpy"} <= taken
    assert not {one for one in taken if one.startswith(("pybullet", "mujoco", "ros-ament-cmake"))}
