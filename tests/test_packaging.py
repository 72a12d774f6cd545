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

from made_once import made_once, wheel_of_wsgen

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[1]


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
# Resolves for one machine after another. pip evaluates markers, those of what is depended on among
# them, with its own interpreter. In one process for all machines, which fetches and reads each page
# of the index once, it takes half of the time.
PIP_FOR_OTHER_MACHINES = """
import contextlib, functools, io, json, sys
from pip._internal.cli.main import main
from pip._internal.index.collector import LinkCollector
from pip._vendor.packaging import markers

fetch = LinkCollector.fetch_response
pages = {}

def fetch_once(self, location, *more, **options):
    location.cache_link_parsing = True
    if location.url not in pages:
        pages[location.url] = fetch(self, location, *more, **options)
    return pages[location.url]

LinkCollector.fetch_response = fetch_once
for line in sys.stdin:
    variables, report, arguments = json.loads(line)
    markers.default_environment = functools.partial(dict, variables)
    with contextlib.redirect_stderr(io.StringIO()) as said:
        code = main(arguments)
    if code:
        with open(report, "w") as file:
            json.dump({"failed": said.getvalue()}, file)
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


# pip takes seconds for each. On other machines than the usual one: the oldest Python, the
# newest, and the first of each engine.
MACHINES = [
    (platform, python)
    for platform, engines in ENGINES.items()
    for python, engine, before in zip(PYTHONS, engines, (None, *engines), strict=False)
    if platform == "linux-x86_64" or python == PYTHONS[-1] or engine != before
]


# What is resolved: the extras, the platform and the Python.
Request = tuple[str, str, str]


def extras_for(platform: str) -> str:
    return "[dart,video,report,sweep]" if platform.startswith("linux") else "[video,report,sweep]"


WITH_MUJOCO = [("linux-x86_64", "3.10"), ("macos-arm64", "3.11"), ("windows-amd64", "3.13")]
REQUESTS: list[Request] = [
    *((extras_for(platform), platform, python) for platform, python in MACHINES),
    *(("[mujoco]", platform, python) for platform, python in WITH_MUJOCO),
]


def pip_arguments(request: Request, wheel: Path, folder: Path) -> list[str]:
    extras, platform, python = request
    _, tags = PLATFORMS[platform]
    report = str(folder / report_name(request))
    options = ["--quiet", "--dry-run", "--ignore-installed", "--report", report]
    options += ["--only-binary", ":all:", "--implementation", "cp", "--python-version", python]
    options += [word for tag in tags for word in ("--platform", tag)]
    options += ["--target", str(folder / "nothing"), "--find-links", str(folder)]
    return ["install", *options, f"{wheel}{extras}"]


def report_name(request: Request) -> str:
    return "-".join(request) + ".json"


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory, wheel: Path) -> Path:
    """A folder with what pip reports for each request; skips where pip has no index."""

    def resolve_all(folder: Path) -> None:
        # empy has no wheel.
        build = [sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "-w", str(folder)]
        run = subprocess.run(
            [*build, "empy>=3.3.4,<4"], capture_output=True, text=True, check=False
        )
        if run.returncode != 0:
            (folder / "skipped.txt").write_text(f"pip gets nothing here: {run.stderr[-300:]}")
            return
        # One file in Python: what is built here is what is built elsewhere.
        assert [file.name.endswith("-none-any.whl") for file in folder.iterdir()] == [True]
        lines = [
            json.dumps(
                (
                    marker_variables(*request[1:]),
                    str(folder / report_name(request)),
                    pip_arguments(request, wheel, folder),
                )
            )
            for request in REQUESTS
        ]
        subprocess.run(
            [sys.executable, "-c", PIP_FOR_OTHER_MACHINES],
            input="\n".join(lines),
            text=True,
            check=True,
            capture_output=True,
        )

    folder = made_once(tmp_path_factory, "resolved", resolve_all)
    skipped = folder / "skipped.txt"
    if skipped.exists():
        pytest.skip(skipped.read_text())
    return folder


def resolved(reports: Path, request: Request) -> dict[str, Any]:
    """What pip would install on another machine: the metadata of each distribution by its name."""
    report = json.loads((reports / report_name(request)).read_text())
    assert "install" in report, report
    found = [one["metadata"] for one in report["install"]]
    return {one["name"].lower().replace("_", "-"): one for one in found}


@pytest.mark.parametrize(("platform", "python"), MACHINES)
def test_pip_finds_wheels_for_every_machine(reports: Path, platform: str, python: str) -> None:
    has_dart = platform.startswith("linux")
    found = resolved(reports, (extras_for(platform), platform, python))
    assert ("dartpy" in found) == has_dart
    engines = {"pybullet", "pybullet-arm64", "mujoco", "mujoco-core"} & found.keys()
    assert engines == {ENGINES[platform][PYTHONS.index(python)]}
    assert ("ros-ament-cmake" in found) == (platform == "linux-x86_64")
    assert found.keys() >= {"ros-ament-package", "cmake", "numpy", "av", "plotly", "scipy"}
    assert found.keys() >= {"distributed", "pyarrow", "matplotlib"}
    # What others depend on is looked up with the variables of that machine, too.
    assert ("colorama" in found) == (platform == "windows-amd64")  # of click
    assert ("exceptiongroup" in found or "tomli" in found) == (python == "3.10")


@pytest.mark.parametrize(("platform", "python"), WITH_MUJOCO)
def test_mujoco_is_an_extra_elsewhere(reports: Path, platform: str, python: str) -> None:
    found = resolved(reports, ("[mujoco]", platform, python))
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
