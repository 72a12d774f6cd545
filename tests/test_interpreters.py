"""The whole loop on every supported Python of this machine, installed as a user installs it.

Interpreters are looked for on the PATH, in pyenv's folder, and in WSGEN_TEST_PYTHONS, which lists
further folders as PATH does. `.ci/debian-python` unpacks one of Debian that is newer than others;
`.ci/run` does so while other tests run.
"""

import functools
import json
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from made_once import wait_for_unpacking
from resolved_packages import HOST, install_arguments

pytestmark = pytest.mark.slow

SUPPORTED = ((3, 10), (3, 11), (3, 12), (3, 13), (3, 14))
AT_THE_BORDERS = ("3.10", "3.14")  # on these with plain colcon, pictures and videos, too


def interpreters() -> Iterator[tuple[str, Path]]:
    """Version and path of one interpreter for each supported version but the running one."""
    listed = [os.environ.get(name, "") for name in ("WSGEN_TEST_PYTHONS", "PATH")]
    folders = [Path(entry) for entry in os.pathsep.join(listed).split(os.pathsep) if entry]
    for entry in listed[0].split(os.pathsep):
        wait_for_unpacking(Path(entry).parent.parent)  # of its usr/bin
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    folders += sorted(pyenv.glob("versions/*/bin"))
    for version in SUPPORTED:
        if version == sys.version_info[:2]:
            continue
        name = f"{version[0]}.{version[1]}"
        for folder in folders:
            python = folder / f"python{name}"
            # A shim of a version manager is there also for versions it does not have.
            if python.is_file() and works(python):
                yield name, python
                break


def works(python: Path) -> bool:
    run = subprocess.run([python, "-c", "import venv"], capture_output=True, check=False)
    return run.returncode == 0


@functools.cache
def found() -> dict[str, Path]:
    """Looked for by the first test, not while tests are collected: it starts some interpreters."""
    return dict(interpreters())


@pytest.mark.parametrize(
    "version",
    [
        pytest.param(
            f"{major}.{minor}",
            marks=[] if f"{major}.{minor}" in AT_THE_BORDERS else pytest.mark.thorough,
        )
        for major, minor in SUPPORTED
    ],
)
def test_new_build_validate(
    version: str, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    if version == f"{sys.version_info[0]}.{sys.version_info[1]}":
        pytest.skip("the other tests run on this one")
    if version not in found():
        pytest.skip(f"there is no Python {version} on this machine")
    environment = {
        name: value
        for name, value in os.environ.items()
        if name not in {"VIRTUAL_ENV", "PYTHONPATH", "AMENT_PREFIX_PATH"}
    }

    def call(*command: str | Path, folder: Path = tmp_path) -> str:
        run = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, check=False
        )
        assert run.returncode == 0, f"{command}\n{run.stdout}\n{run.stderr}"
        return run.stdout

    call(found()[version], "-m", "venv", "--without-pip", "environment")
    scripts = tmp_path / "environment" / "bin"
    # What is not compiled is compiled when it is used, which most of it is not.
    pip = (sys.executable, "-m", "pip", "--python", scripts / "python")
    arguments = install_arguments(tmp_path_factory, HOST, version)
    call(*pip, *arguments, "--quiet", "--no-compile")
    call(*pip, "check")
    # Plain colcon with the environment not activated finds the wheels' packages as well.
    is_at_border = version in AT_THE_BORDERS
    for tool in ("colcon", "wsgen") if is_at_border else ("wsgen",):
        call(scripts / "wsgen", "new", "gazebo_test", "-w", tool)
        call(scripts / tool, "build", folder=tmp_path / tool)
        said = call(scripts / "wsgen", "validate", "--format", "json", folder=tmp_path / tool)
        outcome = json.loads(said)
        (robot,) = outcome["packages"][0]["robots"]
        assert outcome["passed"]
        assert robot["simulated"] == {
            "engine": "mujoco" if version == "3.14" else "bullet",
            "links": 1,
            "movable_joints": 0,
            "mass": 1.0,
        }
        assert robot["rest"]["xyz"][2] == pytest.approx(0.25, abs=0.002)
    if is_at_border:
        draw(call, scripts, tmp_path / "wsgen")


def draw(call: Callable[..., str], scripts: Path, workspace: Path) -> None:
    """A picture and a video of it, and what `wsgen doctor` says about them."""
    said = call(scripts / "wsgen", "doctor", "--format", "json", folder=workspace)
    met = {found["name"]: found["met"] for found in json.loads(said)["wsgen"]}
    assert met["pictures"]
    made = call(
        *(scripts / "wsgen", "launch", "gazebo_test", "gazebo_model.launch.py", "--play"),
        *("--picture", ".", "--record", "video.gif", "--seconds", "0.2", "--format", "json"),
        folder=workspace,
    )
    (package,) = json.loads(made)["packages"]
    assert package["diagnostics"] == []
    with Image.open(workspace / "gazebo_test.png") as picture:
        assert is_drawn(picture, (960, 720))
    with Image.open(workspace / "video.gif") as video:
        assert video.n_frames == 5
        assert is_drawn(video, (480, 360))


def is_drawn(image: Image.Image, size: tuple[int, int]) -> bool:
    """Whether the robot is in the middle, and nothing of it at the top."""
    rows = np.asarray(image.convert("HSV"))[..., 1]
    height, width = rows.shape
    is_colored = rows > 120
    return bool(
        image.size == size and is_colored[height // 2, width // 2] and not is_colored[:9].any()
    )
