"""An engine that is installed and cannot be loaded is told apart from a robot that breaks it."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
import yaml._yaml

from simulation.robots import pendulum
from wsgen.isolation.codec import encode
from wsgen.isolation.result import Answered, Died
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.simulation.run import explain_not_loaded, run_simulation
from wsgen.simulation.scene import NotDrawn, Scene, SceneResult, SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Callable

LINKER = "libGL.so.1: cannot open shared object file: No such file"
NO_GL = f"failed (ImportError: {LINKER})"


def died(reason: str, step: str = "") -> Died:
    return Died(reason=reason, step=step, output="Traceback ...", cause="exception")


def test_the_library_its_package_and_the_engine_that_works_without() -> None:
    found = explain_not_loaded("dart", died(NO_GL), ["mujoco", "bullet"])
    assert found is not None
    assert found.code == "SPN097"
    assert found.message == ("The physics engine (dart) needs libGL.so.1, which the system lacks.")
    assert found.hint == "sudo apt install libgl1; or --engine mujoco, which works without it."


def test_no_other_engine() -> None:
    found = explain_not_loaded("dart", died(NO_GL), [])
    assert found is not None
    assert found.hint == "sudo apt install libgl1."


def test_a_library_that_python_loads_by_its_path() -> None:
    found = explain_not_loaded("mujoco", died(NO_GL.replace("ImportError", "OSError")), [])
    assert found is not None
    assert "libGL.so.1" in found.message


@pytest.mark.parametrize(
    "error", ["ImportError: undefined symbol: f", "ModuleNotFoundError: No module named 'glfw'"]
)
def test_another_error_of_its_import(error: str) -> None:
    found = explain_not_loaded("dart", died(f"failed ({error})"), [])
    assert found is not None
    assert found.message.endswith(f"failed ({error}).")
    assert "with pip" in (found.hint or "")


@pytest.mark.parametrize(
    "death", [died(NO_GL, "loading the robot"), died("crashed (SIGSEGV)"), died("failed (OSError)")]
)
def test_what_is_not_about_the_library(death: Died) -> None:
    assert explain_not_loaded("dart", death, []) is None


SWINGING = SpawnedRobot(entity="e", robot=pendulum(), pose_in_world=Pose((0.0, 0.0, 1.0)))
SCENE = Scene(world=World(name="w"), robots=(SWINGING,))


@pytest.fixture
def unloadable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], None]:
    """Puts a compiled module that needs what no system has in the place of another one."""
    if not sys.platform.startswith("linux"):
        pytest.skip("other systems link in other ways")

    def replace_module(name: str) -> None:
        compiled = Path(yaml._yaml.__file__)
        content = compiled.read_bytes().replace(b"libc.so.6\0", b"libQ.so.6\0")
        (tmp_path / (name + compiled.name.removeprefix("_yaml"))).write_bytes(content)
        monkeypatch.syspath_prepend(tmp_path)

    return replace_module


def test_the_encoder_of_videos() -> None:
    """Drawing is given up where it fails, and the simulation goes on."""

    def run(*_: object, **__: object) -> Answered:
        result = SceneResult(robot_runs=(), refused={}, seconds={}, video=NotDrawn(problem=LINKER))
        return Answered(value=json.loads(encode(result)), output="")

    (found,) = run_simulation(SCENE, run=run).diagnostics
    assert found.code == "SPN070"
    assert found.message.endswith("libGL.so.1 is not installed on this system.")
    assert found.hint == "sudo apt install libgl1; or record a .gif."


def test_the_simulation_says_so(unloadable: Callable[[str], None]) -> None:
    unloadable("dartpy")
    (found,) = run_simulation(replace(SCENE, engine="dart")).diagnostics
    assert found.code == "SPN097"
    assert "libQ.so.6" in found.message
    assert (found.hint or "").startswith("apt-file search libQ.so.6; or --engine ")
