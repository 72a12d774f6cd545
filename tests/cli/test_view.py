"""`wsgen view`, `wsgen launch --play --view`: what they refuse, where they listen, how they end."""

import os
import signal
import socket
import subprocess
import sys
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest

import wsgen.cli
from live_launch import is_alive, wait_until
from reporting.viewing.robots import ARM, write_crane
from wsgen.cli import view

SPAWNING = """\
import os
from launch import LaunchDescription
from launch_ros.actions import Node
def generate_launch_description():
    here = os.path.dirname(os.path.realpath(__file__))
    robot = os.path.join(here, "..", "urdf", "cart.urdf")
    return LaunchDescription([
        Node(package="ros_gz_sim", executable="create", arguments=["-file", robot, "-z", "0.3"]),
    ])
"""


@pytest.fixture
def crane(tmp_path: Path) -> Path:
    return write_crane(tmp_path / "crane")


@pytest.fixture
def taken() -> Iterator[int]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server.getsockname()[1]


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    code = wsgen.cli.run(list(arguments))
    captured = capsys.readouterr()
    assert captured.out == ""
    return code, captured.err


def test_a_taken_port_is_refused(
    crane: Path, taken: int, capsys: pytest.CaptureFixture[str]
) -> None:
    code, text = refused(capsys, "view", str(crane), "--port", str(taken))
    assert code == 2
    assert f"The port {taken} of 127.0.0.1 is taken." in text


def test_without_viser_the_extra_is_named(
    crane: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("wsgen.reporting.viewing.LIBRARY", "no_such_library")
    code, text = refused(capsys, "view", str(crane))
    assert code == 4
    assert "pip install 'wsgen[view]'" in text


def test_a_folder_is_no_robot(crane: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, text = refused(capsys, "view", f"{crane.parent}/")
    assert code == 2
    assert "wsgen view" in text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--view",), "Write --play --view, or --run --view"),
        (("--play", "--view", "--seconds", "4"), "--view and --seconds cannot be combined"),
        (("--play", "--view", "--picture", "."), "--view and --picture cannot be combined"),
        (("--play", "--view", "--record", "a.gif"), "--view and --record cannot be combined"),
        (("--play", "--view", "--format", "json"), "--view and --format cannot be combined"),
        (("--play", "--view", "--engine", "all"), "--view simulates in one engine"),
    ],
)
def test_options_that_do_not_go_together(
    options: tuple[str, ...], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "a.launch.py"
    file.write_text(SPAWNING)
    code, text = refused(capsys, "launch", str(file), *options)
    assert code == 2
    assert words in text


@pytest.mark.parametrize(
    ("host", "url"),
    [
        ("127.0.0.1", "http://127.0.0.1:8080"),
        ("0.0.0.0", "http://127.0.0.1:8080"),  # noqa: S104  it is not listened on
        ("::1", "http://[::1]:8080"),
        ("robot.local", "http://robot.local:8080"),
    ],
)
def test_the_address_can_be_opened_on_this_machine(host: str, url: str) -> None:
    assert view.url_of(host, 8080) == url


@pytest.mark.parametrize(
    ("environment", "opens", "is_opened"),
    [
        ({"DISPLAY": ":0"}, True, True),
        ({"WAYLAND_DISPLAY": "wayland-0"}, True, True),
        ({"DISPLAY": ":0"}, False, False),
        ({"DISPLAY": ":0", "CI": "true"}, True, False),
        ({}, True, False),
    ],
)
@pytest.mark.skipif(sys.platform != "linux", reason="other systems always have a display")
def test_a_browser_is_opened_where_somebody_sees_it(
    environment: dict[str, str],
    opens: bool,
    is_opened: bool,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "CI"):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    opened: list[str] = []

    def open_it(url: str) -> bool:
        opened.append(url)
        return True

    monkeypatch.setattr("webbrowser.open", open_it)
    view.announce("127.0.0.1", 8123, opens=opens, quiet=False)
    assert bool(opened) == is_opened
    captured = capsys.readouterr()
    assert captured.out == "http://127.0.0.1:8123\n"
    assert ("Open this address" in captured.err) != is_opened


@pytest.mark.slow
def test_a_robot_with_an_error_is_not_served(
    crane: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    crane.write_text(ARM.replace("</link>", "", 1))
    code, text = refused(capsys, "view", str(crane))
    assert code == 1
    assert "xacro-file-fails" in text


def listening_addresses(port: int) -> set[str]:
    """The addresses that a port of this machine is listened on, as /proc has them."""
    return {
        words[1].partition(":")[0]
        for file in ("tcp", "tcp6")
        for line in Path("/proc/net", file).read_text().splitlines()[1:]
        if (words := line.split())[3] == "0A" and int(words[1].rpartition(":")[2], 16) == port
    }


def children_of(pid: int) -> str:
    return Path(f"/proc/{pid}/task/{pid}/children").read_text()


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="it looks into /proc")
@pytest.mark.parametrize("command", ["view", "launch"])
def test_the_page_is_served_on_loopback_until_ctrl_c(
    command: str, crane: Path, tmp_path: Path
) -> None:
    arguments = ["view", str(crane)]
    if command == "launch":
        file = crane.parents[1] / "launch" / "spawn.launch.py"
        file.parent.mkdir()
        file.write_text(SPAWNING)
        crane.with_name("cart.urdf").write_text(
            '<robot name="cart"><link name="base"><inertial><mass value="1"/>'
            '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
            '<visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual>'
            '<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link></robot>'
        )
        arguments = ["launch", str(file), "--play", "--view"]
    scratch = tmp_path / "tmp"
    scratch.mkdir()
    process = subprocess.Popen(
        [sys.executable, "-m", "wsgen", *arguments, "--no-browser"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "TMPDIR": str(scratch)},
    )
    assert process.stdout is not None
    url = process.stdout.readline().strip()
    try:
        assert url.startswith("http://127.0.0.1:"), process.communicate(timeout=300)
        with urllib.request.urlopen(url) as answer:  # noqa: S310  it begins with http
            assert b"<html" in answer.read(1000)
        assert listening_addresses(int(url.rpartition(":")[2])) == {"0100007F"}
        # The engine stays; what has read the robot ends.
        wait_until(
            lambda: bool(children_of(process.pid)) == (command == "launch"),
            lambda: f"children: {children_of(process.pid)}",
        )
        children = children_of(process.pid).split()
        process.send_signal(signal.SIGINT)
        out, text = process.communicate(timeout=300)
    finally:
        process.kill()
    assert (process.returncode, out) == (0, "")
    assert "Press Ctrl-C to end." in text
    assert "Traceback" not in text
    assert "interrupted" not in text
    wait_until(lambda: not any(is_alive(int(child)) for child in children), lambda: f"{children}")
    assert list(scratch.iterdir()) == []
