"""`wsgen topic` and `wsgen node` hand what was asked for to the process that answers."""

from __future__ import annotations

import json
import os
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import wsgen.cli
from building.building import PACKAGE_XML
from test_start_up import loaded
from wsgen.cli.ros_tool import _is_sourced
from wsgen.ros.environment import RosEnvironment
from wsgen.ros.environment.processes import handed_over

if TYPE_CHECKING:
    from collections.abc import Iterator


class ReplacedError(BaseException):
    """The process would be another one now."""


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    """Call a command; returns its request, the packages of messages, and the variables."""
    seen: dict[str, Any] = {}

    def open_ros(_environment: object, *, messages: list[str], **_: object) -> RosEnvironment:
        seen["messages"] = messages
        variables = {"PYTHONPATH": "/ros"}
        return RosEnvironment(
            distro="kilted", is_sourced=False, python=Path(sys.executable), variables=variables
        )

    def replace(_path: str, command: list[str], variables: dict[str, str]) -> None:
        seen["request"], seen["variables"] = json.loads(handed_over(command[-1])), variables
        raise ReplacedError

    monkeypatch.setattr("wsgen.ros.environment.open_ros", open_ros)
    monkeypatch.setattr(os, "execve", replace)
    monkeypatch.chdir(tmp_path)

    def ask(*words: str) -> dict[str, Any]:
        with pytest.raises(ReplacedError):
            wsgen.cli.run(words)
        return seen

    return ask


def test_what_is_published(asked: Any) -> None:
    seen = asked("topic", "pub", "-1", "/go", "my_msgs/msg/Go", "{x: 1}", "--qos-depth", "3")
    options = seen["request"]["options"]
    assert (options["times"], options["subscriptions"], options["rate"]) == (1, 1, 1.0)
    assert (options["values"], options["qos"]) == ("{x: 1}", {"depth": 3})
    assert seen["messages"] == ["my_msgs"]
    assert seen["variables"]["PYTHONPATH"].split(os.pathsep)[0] == "/ros"
    assert seen["variables"]["PYTHONPATH"].endswith("ros/shim")


def test_a_large_message_is_no_argument(asked: Any) -> None:
    values = "[" + "1, " * 100_000 + "1]"
    seen = asked("topic", "pub", "-1", "/go", "my_msgs/msg/Go", values)
    assert seen["request"]["options"]["values"] == values


def test_an_install_space_with_a_longer_name_is_another_one() -> None:
    install = Path("/ws/install")
    for entry, is_sourced in {
        "/ws/install": True,
        "/ws/install/pkg": True,
        "/ws/install_old/pkg": False,
        "": False,
    }.items():
        assert _is_sourced(install, {"AMENT_PREFIX_PATH": f"/other:{entry}"}) == is_sourced


def test_what_is_shown(asked: Any) -> None:
    request = asked("topic", "echo", "/odom", "--once", "-f", "--no-daemon")["request"]
    assert (request["verb"], request["seconds"]) == ("topic echo", 2.0)
    assert request["options"]["truncate_length"] is None
    assert request["options"]["once"]
    request = asked("topic", "--include-hidden-topics", "list", "-t")["request"]
    assert request["options"]["with_hidden"]
    assert request["options"]["show_types"]
    request = asked("node", "info", "/a", "-s")["request"]
    assert (request["verb"], request["use_sim_time"]) == ("node info", True)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("topic", "pub", "-1", "-t", "2", "/a", "b"), "cannot be combined"),
        (("topic", "pub", "--max-wait-time-secs", "2", "/a", "b"), "has no effect without"),
        (("topic", "hz"), "TOPIC"),
        (("topic", "shout", "/a"), "shout"),
    ],
)
def test_what_makes_no_sense(
    words: tuple[str, ...], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert wsgen.cli.run(words) == 2
    assert message in capsys.readouterr().err


def test_help_needs_no_ros(tmp_path: Path) -> None:
    modules = loaded(tmp_path, "topic", "echo", "--help")
    assert not modules & {"rclpy", "numpy", "yaml", "subprocess", "wsgen.ros.environment"}


@pytest.fixture
def _signals() -> Iterator[None]:
    """Have the program that `wsgen run` does not become leave signals to this process."""
    ignored = {one: signal.getsignal(one) for one in (signal.SIGPIPE, signal.SIGXFSZ)}
    yield
    for one, handler in ignored.items():
        signal.signal(one, handler)


@pytest.mark.usefixtures("_signals")
def test_a_script_of_no_package(
    asked: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    commands = []

    def replace(_path: str, command: tuple[str, ...], _variables: dict[str, str]) -> None:
        commands.append(command)
        raise ReplacedError

    monkeypatch.setattr(os, "execvpe", replace)
    script, program = tmp_path / "drive.py", tmp_path / "drive"
    script.write_text("from my_msgs.msg import Go\n")
    program.write_text("#!/bin/sh\n")
    seen = asked("run", "drive.py", "-x", "--ros-args", "-p", "fast:=true")
    python = sys.executable
    assert commands.pop() == (python, str(script), "-x", "--ros-args", "-p", "fast:=true")
    assert set(seen["messages"]) == {"my_msgs"}
    assert wsgen.cli.run(("run", "./drive")) == 4  # it is not executable
    program.chmod(0o755)
    asked("run", "./drive")
    assert commands.pop() == (str(program),)


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        (("drive.py",), 4, "The file drive.py does not exist"),
        (("scripts/drive", "x"), 4, "The file scripts/drive does not exist"),
        (("robot",), 2, "wsgen run robot EXECUTABLE"),
    ],
)
def test_a_script_that_is_not_there(
    words: tuple[str, ...], code: int, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert wsgen.cli.run(("run", *words)) == code
    assert message in capsys.readouterr().err


@pytest.mark.usefixtures("_signals")
@pytest.mark.parametrize("inside", [".", "launch"])
@pytest.mark.parametrize("words", [("topic", "list"), ("run", "demo", "walk")])
def test_a_package_at_the_root_of_its_workspace(
    words: tuple[str, ...], inside: str, asked: Any, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    root = tmp_path / "demo"
    program = root / "install" / "demo" / "lib" / "demo" / "walk"
    for folder in (program.parent, root / "launch"):
        folder.mkdir(parents=True)
    (root / "package.xml").write_text(PACKAGE_XML)
    program.write_text("#!/bin/sh\n")
    program.chmod(0o755)
    install = root / "install"
    (install / "setup.sh").write_text(f"export AMENT_PREFIX_PATH={install / 'demo'}\n")
    commands = []

    def replace(_path: str, command: list[str], variables: dict[str, str]) -> None:
        commands.append((command, variables))
        raise ReplacedError

    monkeypatch.setattr(os, "execve", replace)
    monkeypatch.setattr(os, "execvpe", replace)
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    monkeypatch.chdir(root / inside)
    asked(*words)
    ((command, variables),) = commands
    assert str(install / "demo") in variables["AMENT_PREFIX_PATH"].split(os.pathsep)
    assert words[0] != "run" or command[0] == str(program)
