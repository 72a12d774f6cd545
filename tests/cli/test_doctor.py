import functools
import json
import os
import shutil
from pathlib import Path

import pytest

from wsgen.building import machine
from wsgen.building.machine import DoctorReport
from wsgen.cli import run, terminal
from wsgen.model.target import TARGETS, Target


@pytest.fixture(autouse=True)
def no_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("ROS_DISTRO", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)


# Ten children import libraries, for 1.5 s of CPU time: what that shows is the same for each target.
why_not_loaded = functools.cache(machine._why_not_loaded)
why_no_picture = functools.cache(machine._why_no_picture)


@pytest.fixture
def loaded_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine, "_why_not_loaded", why_not_loaded)
    monkeypatch.setattr(machine, "_why_no_picture", why_no_picture)


@pytest.mark.slow
def test_this_machine(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["doctor"]) == 0
    printed = capsys.readouterr()
    lines = printed.out.splitlines()
    assert printed.err == ""
    assert lines[0] == "ROS 2 Iron with Gazebo Classic 11, on Ubuntu 22.04"
    assert lines[1].startswith("note: ROS 2 Iron has had no updates since 2024-12-04")
    assert lines.index(
        "Requirements of wsgen: wsgen new, wsgen build, wsgen validate"
    ) < lines.index("Requirements of ROS: ros2 launch")
    assert sum("apt install ros-iron-ros-core" in line for line in lines) >= 1
    assert lines[-1] == "wsgen has all it needs."


@pytest.mark.slow
@pytest.mark.usefixtures("loaded_once")
def test_a_narrow_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(terminal, "_is_terminal", lambda **_: True)
    size = os.terminal_size((60, 24))
    monkeypatch.setattr(shutil, "get_terminal_size", lambda *_, **__: size)
    assert run(["doctor"]) == 0
    lines = capsys.readouterr().out.splitlines()
    # Commands are not broken, as they are to be copied.
    broken = [line for line in lines if "try: " not in line and "apt install" not in line]
    assert max(map(len, broken)) <= 60
    # Both tables have the same layout: what was found is in the next line, or it is beside.
    marked = [line for line in lines if line.startswith(("  ok  ", "  -   ", "  error"))]
    assert len({len(line.rstrip()) > 30 for line in marked if "colcon" in line}) == 1


@pytest.mark.slow
@pytest.mark.usefixtures("loaded_once")
@pytest.mark.parametrize("place", [".", "src/my_robot"])
def test_the_target_of_the_packages_here(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    place: str,
) -> None:
    folder = tmp_path / place
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "wsgen.toml").write_text('[target]\ndistro = "jazzy"\n')
    monkeypatch.chdir(tmp_path)
    assert run(["doctor"]) == 0
    assert capsys.readouterr().out.startswith("ROS 2 Jazzy ")
    assert run(["doctor", "--distro", "humble"]) == 0
    assert capsys.readouterr().out.startswith("ROS 2 Humble ")


@pytest.mark.slow
@pytest.mark.usefixtures("loaded_once")
@pytest.mark.parametrize(
    ("takes_apt", "title", "command"),
    [
        (True, "except the editor:", "  sudo apt install ros-iron-ros-core "),
        (
            False,
            "in a container of ros:iron-ros-base (not on this machine):",
            "  apt update && apt install ros-iron-ros-core ",
        ),
    ],
)
def test_the_apt_line_says_where_it_works(
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    *,
    takes_apt: bool,
    title: str,
    command: str,
) -> None:
    monkeypatch.setattr(DoctorReport, "takes_apt", takes_apt)
    assert run(["doctor"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[-4].endswith(title)
    assert lines[-3].startswith(command)


@pytest.mark.usefixtures("loaded_once")
@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_json(target: Target, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--distro", target.distro, "--sim", target.simulator, "--format", "json"]
    assert run(["doctor", *arguments]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert list(printed) == ["version", "passed", "target", "notes", "wsgen", "ros", "apt"]
    assert printed["passed"] is True
    assert printed["target"]["simulator"] == target.simulator
    assert printed["apt"].startswith(f"sudo apt install ros-{target.distro}-ros-core ")
    assert {"name", "met", "required", "text", "fix"} == set(printed["wsgen"][0])
    assert not any(found["required"] for found in printed["ros"])


@pytest.mark.usefixtures("loaded_once")
def test_every_key_is_documented(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["doctor", "--format", "json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    page = Path(__file__).parents[2].joinpath("docs", "doctor.md").read_text(encoding="utf-8")
    keys = [f"{key}[]" if isinstance(value, list) else key for key, value in printed.items()]
    keys += [f"target.{key}" for key in printed["target"]]
    for key in (*keys, *printed["wsgen"][0]):
        assert f"| `{key}` |" in page


@pytest.mark.usefixtures("loaded_once")
def test_something_is_missing(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("CMAKE_COMMAND", "/gone/cmake")
    assert run(["doctor", "-q", "--color", "never"]) == 1
    printed = capsys.readouterr().out
    assert "  error  CMake  missing: CMAKE_COMMAND=/gone/cmake is not a program\n" in printed
    assert "  CMake: try: unset CMAKE_COMMAND\n" in printed
    assert "ninja" not in printed
    assert printed.endswith("Fix the errors above before using wsgen.\n")
    assert run(["doctor", "--format", "json"]) == 1
    assert json.loads(capsys.readouterr().out)["passed"] is False


@pytest.mark.slow
def test_no_path(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.delenv("PATH")
    # The wheels bring what wsgen needs, wherever PATH leads.
    assert run(["doctor"]) == 0
    assert "note: PATH is empty" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--distro", "noetic"], "'noetic' is not a ROS 2 distribution"),
        (["--distro", "jazzy", "--sim", "classic"], "not released for ROS 2 jazzy"),
        (["--distro", ""], "'' is not a ROS 2 distribution"),
        (["--sim", "gazebo"], "Invalid value for '--sim'"),
        (["here"], "unexpected extra argument"),
    ],
)
def test_wrong_request(
    arguments: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["doctor", *arguments]) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert message in printed.err


@pytest.mark.usefixtures("loaded_once")
def test_the_ros_of_the_environment(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROS_DISTRO", "lyrical")
    assert run(["doctor"]) == 0
    printed = capsys.readouterr().out
    assert printed.startswith("ROS 2 Lyrical with Gazebo Jetty, on Ubuntu 26.04\n\n")
    monkeypatch.setenv("ROS_DISTRO", "galactic")
    assert run(["doctor"]) == 2
    assert "ROS_DISTRO=galactic" in capsys.readouterr().err
