"""`wsgen validate --engine gazebo` with programs that answer as both Gazebos do."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from urdf_texts import joint, link, robot, shape
from wsgen.pipeline.real_gazebo import _WAITS_FOR_NODES, with_folders
from wsgen.simulation.real_gazebo import find_gazebo, first, read_message, read_model

FAKE = Path(__file__).with_name("fake_gazebo.py")
BOX = shape("collision", '<box size="0.4 0.4 0.2"/>')
INERTIAL = (
    '<inertial><mass value="2"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
# With one movable joint and a mass of 2 kg, as the programs say.
CRATE = robot(
    link("base", INERTIAL.replace('"2"', '"1"') + BOX)
    + link("wheel", INERTIAL.replace('"2"', '"1"'))
    + joint("j", "base", "wheel", '<axis xyz="0 0 1"/>', "continuous"),
    name="crate",
)
PROGRAMS = {"classic": ("gzserver", "gz"), "gz": ("gz",), "ign": ("ign",)}
# wsgen, which does not wait for long: what answers here is never busy.
WSGEN = f"""
import sys
sys.path.append({str(FAKE.parent)!r})
from wsgen.__main__ import main
from wsgen.pipeline import real_gazebo
real_gazebo.TASK = "hasty_gazebo:simulate"
main()
"""


@pytest.fixture
def installed(tmp_path: Path) -> Any:
    """A function that puts a Gazebo on a PATH: the environment with that."""

    def put(kind: str, mode: str = "") -> dict[str, str]:
        folder = tmp_path / "fake" / "bin"
        folder.mkdir(parents=True)
        for name in PROGRAMS[kind]:
            program = folder / name
            program.write_text(f"#!{sys.executable}\n{FAKE.read_text(encoding='utf-8')}")
            program.chmod(0o755)
        return {
            **os.environ,
            "PATH": f"{folder}{os.pathsep}{_without_gazebo()}",
            "FAKE_GAZEBO": str(folder.parent),
            "FAKE_GAZEBO_KIND": kind,
            "FAKE_GAZEBO_MODE": mode,
        }

    return put


def _without_gazebo() -> str:
    folders = os.environ["PATH"].split(os.pathsep)
    names = {name for programs in PROGRAMS.values() for name in programs}
    return os.pathsep.join(
        folder for folder in folders if not any(shutil.which(one, path=folder) for one in names)
    )


def validate(
    folder: Path, environment: dict[str, str], *words: str, text: str = CRATE
) -> tuple[int, dict[str, Any], str]:
    """The exit code, what the JSON says of the file, and what is printed besides."""
    (folder / "crate.urdf").write_text(text)
    command = [sys.executable, "-c", WSGEN, "validate", "crate.urdf", "--format", "json", *words]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    document = json.loads(done.stdout) if done.stdout else {"packages": [{}]}
    return done.returncode, document["packages"][0], done.stderr


def in_gazebo(package: dict[str, Any]) -> dict[str, Any]:
    (one,) = (one for one in package["robots"][0]["engines"] if one["engine"] == "gazebo")
    return dict(one)


def reported(package: dict[str, Any]) -> dict[str, dict[str, Any]]:
    return {found["code"]: found for found in package["diagnostics"]}


def has_ended(folder: Path) -> bool:
    pid = json.loads((folder / "fake" / "state.json").read_text())["pid"]
    return not Path(f"/proc/{pid}").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("kind", "version"), [("classic", "11.10.2"), ("gz", "8.6.0"), ("ign", "8.6.0")]
)
def test_a_robot_that_stands_there_too(
    kind: str, version: str, installed: Any, tmp_path: Path
) -> None:
    code, package, _ = validate(tmp_path, installed(kind), "--engine", "gazebo")
    assert [one["engine"] for one in package["robots"][0]["engines"]] == ["bullet", "gazebo"]
    one = in_gazebo(package)
    assert (code, one["passed"], one["version"]) == (0, True, version)
    assert one["rest"]["xyz"][2] == pytest.approx(0.105, abs=1e-3)  # where it was spawned
    assert one["rest"]["joint_positions"] == ({"j": 0.5} if kind == "classic" else {})
    assert "libnone.so" in reported(package)["SPN033"]["message"]
    assert "display" not in str(package)
    assert has_ended(tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["classic", "gz"])
def test_a_robot_that_rests_elsewhere(kind: str, installed: Any, tmp_path: Path) -> None:
    code, package, _ = validate(tmp_path, installed(kind, "sinks"), "--engine", "gazebo")
    found = reported(package)
    assert "PyBullet and Gazebo disagree: in Gazebo it rests 19" in found["SPN065"]["message"]
    assert "Gazebo is what the package runs in." in found["SPN065"]["hint"]
    assert code == 1  # it is stuck in the ground there
    assert found["SPN054" if "SPN054" in found else "SPN055"]["message"].startswith("In Gazebo: ")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["classic", "gz"])
def test_a_robot_that_it_refuses(kind: str, installed: Any, tmp_path: Path) -> None:
    code, package, _ = validate(tmp_path, installed(kind, "refuses"), "--engine", "gazebo")
    found = reported(package)["SPN032"]
    assert (code, found["severity"], found["element"]) == (1, "error", "crate")
    assert "does not spawn `crate`: " in found["message"]
    assert ("a reason" in found["message"]) == (kind == "classic")
    one = in_gazebo(package)
    assert (one["passed"], one["rest"]) == (False, None)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["classic", "gz"])
def test_a_server_that_crashes(kind: str, installed: Any, tmp_path: Path) -> None:
    code, package, _ = validate(tmp_path, installed(kind, "crashes"), "--engine", "gazebo")
    assert code == 1
    assert "ended (SIGSEGV)" in reported(package)["SPN031"]["message"]
    assert package["robots"][0]["rest"] is not None  # PyBullet's


@pytest.mark.slow
def test_a_message_that_is_lost_is_sent_again(installed: Any, tmp_path: Path) -> None:
    code, package, _ = validate(tmp_path, installed("classic", "loses"), "--engine", "gazebo")
    assert (code, in_gazebo(package)["passed"]) == (0, True)


@pytest.mark.slow
def test_all_engines_take_it_where_it_is_installed(installed: Any, tmp_path: Path) -> None:
    environment = installed("gz")
    _, package, _ = validate(tmp_path, environment, "--engine", "all")
    engines = [one["engine"] for one in package["robots"][0]["engines"]]
    assert engines[-1] == "gazebo"
    assert len(engines) > 2
    without = {**environment, "PATH": _without_gazebo()}
    _, package, _ = validate(tmp_path, without, "--engine", "all")
    assert [one["engine"] for one in package["robots"][0]["engines"]] == engines[:-1]
    assert "Gazebo" not in str(reported(package).get("SPN098"))


@pytest.mark.slow
def test_a_machine_without_one(tmp_path: Path) -> None:
    without = {**os.environ, "PATH": _without_gazebo()}
    code, _, printed = validate(tmp_path, without, "--engine", "gazebo")
    assert code not in {0, 1}
    assert "No Gazebo is installed" in printed
    assert "source ROS" in printed


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["classic", "gz"])
def test_nothing_is_left_after_ctrl_c(kind: str, installed: Any, tmp_path: Path) -> None:
    (tmp_path / "crate.urdf").write_text(CRATE)
    command = [sys.executable, "-m", "wsgen", "validate", "crate.urdf", "--engine", "gazebo"]
    process = subprocess.Popen(
        command,
        cwd=tmp_path,
        env=installed(kind, "hangs"),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    state = tmp_path / "fake" / "state.json"
    end = time.monotonic() + 300
    while not (state.exists() and json.loads(state.read_text())["models"]):
        assert time.monotonic() < end
        time.sleep(0.1)
    process.send_signal(signal.SIGINT)
    assert process.wait(300) == 130
    assert has_ended(tmp_path)


@pytest.mark.slow
def test_classic_has_a_gz_of_its_own(installed: Any) -> None:
    found = find_gazebo(installed("classic"))
    assert found is not None
    assert (found.kind, found.name) == ("classic", "Gazebo Classic 11.10.2")
    assert find_gazebo(installed_environment(found.server[0]), "gz") is None


def installed_environment(server: str) -> dict[str, str]:
    folder = Path(server).parent
    return {"PATH": str(folder), "FAKE_GAZEBO": str(folder), "FAKE_GAZEBO_KIND": "classic"}


def test_a_message_of_gazebo_is_read() -> None:
    message = read_message('name: "a: b"\npose {\n  x: -1e-3\n}\npose {\n}\n}\nx: 2')
    assert first(message, "name") == "a: b"
    assert first(first(message, "pose"), "x") == "-1e-3"
    assert first(message, "x") == "2"
    assert first(read_message("An instance of Gazebo is not running."), "pose") is None


# As https://gazebosim.org/api/sim/8/model_command.html shows it.
DOCUMENTED = """
Requesting state for world [diff_drive]...

            Model: [8]
            - Name: vehicle_blue
            - Pose [ XYZ (m) ] [ RPY (rad) ]:
                    [0.000000 | 2.000000 | 0.325000]
                    [0.000000 | 0.000000 | 3.141593]

            - Link [12]
                    - Name: left_wheel
                    - Parent: vehicle_blue [8]
                    - Mass (kg): [2.000000]
                    - Inertial Pose:
                            [9.000000 | 0.000000 | 0.000000]
                            [0.000000 | 0.000000 | 0.000000]
                    - Pose [ XYZ (m) ] [ RPY (rad) ]:
                            [0.500000 | 0.625000 | -0.025000]
                            [0.000000 | 0.000000 | 0.000000]
            - Joint [23]
                    - Name: caster_wheel
                    - Type: ball
"""


def test_a_model_of_gazebo_sim_is_read() -> None:
    model = read_model(DOCUMENTED)
    assert model is not None
    assert (model.mass, model.movable_joints) == (2.0, 1)
    assert model.links["left_wheel"].xyz == pytest.approx((-0.5, 1.375, 0.3), abs=1e-5)
    assert read_model("No model named <x> was found") is None


@pytest.mark.parametrize(
    ("text", "left"),
    [
        (
            '<a/><plugin filename="libgazebo_ros2_control.so" name="c"><p>x</p></plugin><b/>',
            "<a/><b/>",
        ),
        ('<plugin filename="gz_ros2_control-system" name="c"/><b/>', "<b/>"),
        ('<plugin filename="libgazebo_ros_imu.so" name="i"/><plugin name="ros2_control"/>', None),
        (
            '<ros2_control name="x"><plugin>ros2_control/System</plugin></ros2_control>',
            "",
        ),
    ],
)
def test_plugins_that_wait_for_nodes_are_left_out(text: str, left: str | None) -> None:
    expected = {None: '<plugin filename="libgazebo_ros_imu.so" name="i"/>', "": text}.get(
        left, left
    )
    assert _WAITS_FOR_NODES.sub("", text) == expected


def test_the_search_path_grows() -> None:
    found = with_folders({"GAZEBO_MODEL_PATH": "/a:/b"}, "classic", ["/b", "/c"])
    assert found == {"GAZEBO_MODEL_PATH": "/a:/b:/c"}
