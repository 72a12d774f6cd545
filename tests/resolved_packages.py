"""What pip would install with wsgen on one machine after another, found out once for all tests."""

from __future__ import annotations

import json
import platform as this_machine
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest
from packaging.requirements import Requirement
from packaging.utils import NormalizedName, canonicalize_name

from made_once import made_once, wheel_of_wsgen

if TYPE_CHECKING:
    from pathlib import Path

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
HOST = f"{sys.platform}-{this_machine.machine()}"
# One that takes itself for another one: wheels are those for what it is.
MADE_UP = "linux-aarch64-made-up"
if HOST in PLATFORMS:
    PLATFORMS[MADE_UP] = (PLATFORMS["linux-aarch64"][0], PLATFORMS[HOST][1])
SYSTEMS = {"linux": ("posix", "Linux"), "darwin": ("posix", "Darwin"), "win32": ("nt", "Windows")}
# Resolves for one machine after another. pip evaluates markers, those of what is depended on among
# them, with its own interpreter. One process for all machines does once what pip does again for
# each: it fetches and reads a page of the index or a wheel, and takes the name of a wheel apart.
# pip looks at each file of a page only to find that no machine here takes it: those are left out.
PIP_FOR_OTHER_MACHINES = """
import contextlib, functools, io, json, re, sys, tempfile
from pip._internal.cli.main import main
from pip._internal.index import package_finder
from pip._internal.index.collector import LinkCollector
from pip._internal.metadata.importlib import Distribution
from pip._internal.models import wheel
from pip._internal.network.download import Downloader
from pip._vendor.packaging import markers

fetch, parse = LinkCollector.fetch_response, package_finder.parse_links
open_wheel, download = Distribution.from_wheel, Downloader.__call__
elsewhere = re.compile(
    "musllinux|_(i686|armv[67]l|ppc64(le)?|s390x|riscv64)|win32|win_arm64"
    "|-pp3|-cp(2.|3[0-9])-cp|-cp3..-cp3..t-"  # other interpreters than those of PYTHONS
)
pages, links, opened, downloaded = {}, {}, {}, {}
kept = tempfile.TemporaryDirectory()

def fetch_once(self, location, *more, **options):
    if location.url not in pages:
        pages[location.url] = fetch(self, location, *more, **options)
    return pages[location.url]

def parse_once(page):
    if page.url not in links:
        links[page.url] = [
            link
            for link in parse(page)
            if link.path.endswith(".whl") and not elsewhere.search(link.path)
        ]
    return links[page.url]

def open_once(one, name):
    if one.location not in opened:
        opened[one.location] = open_wheel(one, name)
    return opened[one.location]

def download_once(self, link, location):
    if not link.path.endswith("-none-any.whl"):
        return download(self, link, location)  # large, and for few requests
    if link.url not in downloaded:
        downloaded[link.url] = download(self, link, kept.name)
    return downloaded[link.url]

LinkCollector.fetch_response = fetch_once
package_finder.parse_links = parse_once
Distribution.from_wheel = open_once
Downloader.__call__ = download_once
wheel.parse_wheel_filename = functools.cache(wheel.parse_wheel_filename)
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


# pip takes seconds for each: the oldest Python, the newest, and the first of PyBullet's fork.
MACHINES = [
    (platform, python)
    for platform, engines in ENGINES.items()
    for python, engine, before in zip(PYTHONS, engines, (None, *engines), strict=False)
    if python in {PYTHONS[0], PYTHONS[-1]} or (engine != before and engine == "pybullet-arm64")
]


# What is resolved: the extras, the platform and the Python.
Request = tuple[str, str, str]


# On one machine of each system the other engine comes as well.
WITH_MUJOCO = {("linux-x86_64", "3.10"), ("macos-arm64", "3.10"), ("windows-amd64", "3.10")}


def extras_for(platform: str, python: str) -> str:
    dart = "dart," if platform.startswith("linux") else ""
    mujoco = "mujoco," if (platform, python) in WITH_MUJOCO else ""
    return f"[{dart}{mujoco}video,report,sweep]"


RUNNING = f"{sys.version_info[0]}.{sys.version_info[1]}"
REQUESTS: list[Request] = [
    *((extras_for(*machine), *machine) for machine in MACHINES),
    *(("", platform, RUNNING) for platform in PLATFORMS if platform == MADE_UP),
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


def resolve_once(factory: pytest.TempPathFactory) -> Path:
    """A folder with what pip reports for each request; skips where pip has no index."""
    wheel = wheel_of_wsgen(factory)

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

    folder = made_once(factory, "resolved", resolve_all)
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


def install_arguments(factory: pytest.TempPathFactory, platform: str, python: str) -> list[str]:
    """What pip is told to install wsgen without extras, as it would on such a machine.

    Finding out what belongs together takes pip longer than installing it. `pip check` says whether
    something is missing. Where nobody has found it out, pip does.
    """
    requests = [one for one in REQUESTS if one[1:] == (platform, python)]
    if not requests:
        return ["install", str(wheel_of_wsgen(factory))]
    (request,) = requests
    report = json.loads((resolve_once(factory) / report_name(request)).read_text())
    assert "install" in report, report
    found = {canonicalize_name(one["metadata"]["name"]): one for one in report["install"]}
    metadata = {name: one["metadata"] for name, one in found.items()}
    needed = _needed(metadata, marker_variables(platform, python))
    return ["install", "--no-deps", *(_location(found[name]) for name in sorted(needed))]


def _needed(metadata: dict[NormalizedName, Any], variables: dict[str, str]) -> set[NormalizedName]:
    """What wsgen depends on without extras, and itself."""
    reached: set[tuple[NormalizedName, str]] = set()  # with an extra
    waiting = {(canonicalize_name("wsgen"), "")}
    while waiting:
        name, extra = waiting.pop()
        reached.add((name, extra))
        for line in metadata[name].get("requires_dist", ()):
            one = Requirement(line)
            if one.marker is None or one.marker.evaluate({**variables, "extra": extra}):
                wanted = canonicalize_name(one.name)
                waiting |= {(wanted, extra) for extra in ("", *one.extras)} - reached
    return {name for name, _ in reached}


def _location(found: dict[str, Any]) -> str:
    """Where pip has found a distribution, with what it has to be."""
    download = found["download_info"]
    (algorithm, digest), *_ = download["archive_info"]["hashes"].items()
    return f"{found['metadata']['name']} @ {download['url']}#{algorithm}={digest}"
