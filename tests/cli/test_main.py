"""How errors become words and exit codes."""

import errno
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path

import click
import pytest

import wsgen.cli
from wsgen.cli.options import Choice
from wsgen.errors import NotFoundError, NotReadableError, RequestError, WouldOverwriteError


def command_that(raises: BaseException) -> click.Command:
    def callback() -> None:
        raise raises

    return click.Command("new", callback=callback)


@pytest.mark.parametrize(
    ("raised", "code", "words"),
    [
        (RequestError("the name is bad", hint="take another"), 2, ("the name is bad", "take")),
        (WouldOverwriteError("it is there", hint="move it"), 3, ("it is there", "move it")),
        (NotFoundError("no cmake", hint="install it"), 4, ("no cmake", "install it")),
        (NotReadableError("disk full", hint="make room"), 4, ("disk full", "make room")),
        (KeyboardInterrupt(), 130, ("interrupted",)),
        (
            ImportError("libGL.so.1: cannot open shared object file: No such file", name="numpy"),
            4,
            ("numpy needs libGL.so.1, which the system lacks", "sudo apt install libgl1"),
        ),
        (ImportError("cannot import name"), 70, ("bug in wsgen",)),
        (ZeroDivisionError("division by zero"), 70, ("bug in wsgen", "WSGEN_TRACEBACK")),
    ],
)
def test_errors_are_printed_without_a_traceback(
    raised: BaseException,
    code: int,
    words: tuple[str, ...],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(
        wsgen.cli.CommandTable, "get_command", lambda *_: command_that(raises=raised)
    )
    assert wsgen.cli.run(["new"]) == code
    captured = capsys.readouterr()
    assert captured.out == ""
    assert "Traceback" not in captured.err
    for word in words:
        assert word in captured.err


def test_a_misspelled_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert wsgen.cli.run(["biuld"]) == 2
    assert "wsgen build" in capsys.readouterr().err


def test_a_wrong_option(capsys: pytest.CaptureFixture[str]) -> None:
    assert wsgen.cli.run(["build", "--fast"]) == 2
    assert "--fast" in capsys.readouterr().err


def test_the_table_of_commands_says_what_the_commands_say(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for name in wsgen.cli.COMMANDS:
        assert wsgen.cli.run([name, "--help"]) == 0
        assert f"wsgen {name}" in capsys.readouterr().out


def test_the_table_of_commands_says_what_starts_a_launch_file(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert wsgen.cli.run(["--help"]) == 0
    line = re.search(r"^ +launch .*\n(?: {8,}.*\n)*", capsys.readouterr().out, re.MULTILINE)
    assert line is not None
    named = re.findall(r"--\w+", line[0])
    assert named == ["--play", "--run"]
    command = wsgen.cli.wsgen.get_command(click.Context(wsgen.cli.wsgen), "launch")
    assert command is not None
    assert {*named} <= {option for one in command.params for option in one.opts}


def test_the_readme_lists_the_commands_in_the_order_of_the_help() -> None:
    readme = Path(__file__).parents[2].joinpath("README.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| `wsgen (\w+)", readme, re.MULTILINE) == list(wsgen.cli.COMMANDS)


def test_a_reader_that_goes_away_is_no_error() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    run = subprocess.run(
        [sys.executable, "-m", "wsgen", "--help"],
        stdout=writer,
        stderr=subprocess.PIPE,
        text=True,
        check=False,
    )
    os.close(writer)
    assert (run.returncode, run.stderr) == (0, "")


@pytest.mark.slow
def test_standard_error_that_is_closed(tmp_path: Path) -> None:
    run = subprocess.run(
        f"'{sys.executable}' -m wsgen validate 2>&-",
        shell=True,
        cwd=tmp_path,
        check=False,
    )
    assert run.returncode == 4


@pytest.mark.slow
@pytest.mark.parametrize(
    ("arguments", "environment", "colored"),
    [
        (("--color", "always"), {}, True),
        (("--color", "always"), {"NO_COLOR": "1"}, True),
        (("--color", "never"), {}, False),
        ((), {}, False),
    ],
)
def test_colors_of_an_error(
    tmp_path: Path, arguments: tuple[str, ...], environment: dict[str, str], *, colored: bool
) -> None:
    run = subprocess.run(
        [sys.executable, "-m", "wsgen", "validate", *arguments],
        cwd=tmp_path,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ("\x1b[" in run.stderr) is colored


@pytest.mark.slow
@pytest.mark.parametrize(
    ("environment", "colored"),
    [({"TERM": "xterm"}, True), ({"TERM": "dumb"}, False), ({"NO_COLOR": "1"}, False)],
)
def test_colors_on_a_terminal(
    tmp_path: Path, environment: dict[str, str], *, colored: bool
) -> None:
    controller, terminal = os.openpty()
    child = subprocess.Popen(
        [sys.executable, "-m", "wsgen", "validate"],
        cwd=tmp_path,
        env={**os.environ, "TERM": "xterm", **environment},
        stdout=terminal,
        stderr=terminal,
    )
    child.wait(timeout=300)
    os.close(terminal)
    printed = os.read(controller, 4000)
    os.close(controller)
    assert (b"\x1b[31m" in printed) is colored


def test_a_current_folder_that_is_gone(tmp_path: Path) -> None:
    gone = tmp_path / "gone"
    gone.mkdir()
    run = subprocess.run(
        f"cd '{gone}' && rmdir '{gone}' && '{sys.executable}' -P -m wsgen new some_robot"
        if sys.version_info >= (3, 11)
        else f"cd '{gone}' && rmdir '{gone}' && '{sys.executable}' -m wsgen new some_robot",
        shell=True,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 4
    assert "no longer exists" in run.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="only Linux has a full device")
def test_a_full_disk_behind_standard_output() -> None:
    run = subprocess.run(
        f"'{sys.executable}' -m wsgen --help > /dev/full",
        shell=True,
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 4
    assert "Traceback" not in run.stderr


@pytest.mark.slow
def test_an_interrupt_ends_with_130(tmp_path: Path) -> None:
    """A build is interrupted while CMake configures."""
    package = tmp_path / "src" / "slow"
    package.mkdir(parents=True)
    (package / "package.xml").write_text(
        '<package format="3"><name>slow</name><version>0.0.0</version><description>d</description>'
        '<maintainer email="a@b.cd">a</maintainer><license>MIT</license>'
        "<buildtool_depend>ament_cmake</buildtool_depend>"
        "<export><build_type>ament_cmake</build_type></export></package>"
    )
    (package / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.20)\nproject(slow LANGUAGES NONE)\n"
        f'file(TOUCH "{tmp_path}/configuring")\n'
        "execute_process(COMMAND sleep 600)\n"
    )
    child = subprocess.Popen(
        [sys.executable, "-m", "wsgen", "build"],
        cwd=tmp_path,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    deadline = time.monotonic() + 300
    while not (tmp_path / "configuring").exists():
        assert time.monotonic() < deadline
        assert child.poll() is None
        time.sleep(0.05)
    # A terminal sends it to the whole foreground group.
    os.killpg(child.pid, signal.SIGINT)
    _, words = child.communicate(timeout=300)
    assert child.returncode == 130
    assert "Traceback" not in words


@pytest.mark.parametrize(
    ("arguments", "message", "hint"),
    [
        (["new"], "Missing argument 'PACKAGE'.", "wsgen new [OPTIONS] PACKAGE"),
        (["new", "a", "b"], "unexpected extra argument (b).", "wsgen new --help"),
        (["new", "a", "--simm", "gz"], "wsgen new has no option --simm.", "Did you mean `--sim`?"),
        (["new", "a", "--sim", "gazebo"], "'gazebo' is not one of 'classic', 'gz'.", "wsgen new"),
        (["validate", "--seconds", "many"], "'many' is not a number.", "wsgen validate --help"),
        (
            ["validate", "--seconds"],
            "Option '--seconds' requires an argument.",
            "wsgen validate --help",
        ),
        (["validate", "--verbos"], "wsgen validate has no option --verbos.", "`--verbose`?"),
        (["validate", "--set", "a=1"], "has no option --set.", "wsgen validate [OPTIONS]"),
        (["launch"], "Missing argument", "wsgen launch [OPTIONS]"),
        (["topic", "eco"], "'eco' is not a command of wsgen topic.", "wsgen topic echo"),
        (["help", "vew"], "'vew' is not a command of wsgen.", "wsgen view"),
        (["check", "-j", "two"], "'two' is not an integer.", "wsgen check --help"),
        (["new", "ab", "--distro", "jazy"], "'jazy' is not a ROS 2", "`--distro jazzy`?"),
        (["new", "ab", "-t", "difdrive"], "Template 'difdrive' does not", "`diff_drive`?"),
        (["validate", "--engine", "bulet"], "'bulet' is not one of", "Did you mean `bullet`?"),
        (["validate", "--engine", "both"], "'both' is not one of", "Did you mean `all`?"),
        (["check", "--format", "jsn"], "'jsn' is not one of", "Did you mean `json`?"),
        (
            ["check", "--select", "LHC020"],
            "The rule or family 'LHC020' does not exist.",
            "Did you mean `LCH020`?",
        ),
        (["--bogus"], "wsgen has no option --bogus.", "wsgen --help"),
    ],
)
def test_errors_of_click_have_the_form_of_all_errors(
    arguments: list[str], message: str, hint: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert wsgen.cli.run(arguments) == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    said, simulated = printed.err.splitlines()
    assert said.startswith("error: ")
    assert message in said
    assert not said.endswith(("..", "?."))
    assert simulated.startswith("  try: ")
    assert hint in simulated


@pytest.mark.parametrize(
    ("words", "same"),
    [
        (["help"], ["--help"]),
        (["help", "help"], ["--help"]),
        (["help", "validate"], ["validate", "--help"]),
        (["help", "topic", "echo"], ["topic", "echo", "--help"]),
        (["topic", "help", "echo"], ["topic", "echo", "--help"]),
    ],
)
def test_help_is_a_command(
    words: list[str], same: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert wsgen.cli.run(words) == 0
    shown = capsys.readouterr().out
    assert wsgen.cli.run(same) == 0
    assert capsys.readouterr().out == shown


@pytest.mark.parametrize("name", wsgen.cli.COMMANDS)
def test_a_misspelled_value_of_an_option_is_met_with_the_nearest(name: str) -> None:
    command = wsgen.cli.wsgen.get_command(click.Context(wsgen.cli.wsgen), name)
    assert command is not None
    for one in (command, *getattr(command, "commands", {}).values()):
        for parameter in one.params:
            is_choice = isinstance(parameter.type, click.Choice)
            assert not is_choice or isinstance(parameter.type, Choice), parameter.name


@pytest.mark.parametrize("name", wsgen.cli.COMMANDS)
def test_the_help_ends_with_two_examples_that_parse(
    name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert wsgen.cli.run([name, "--help"]) == 0
    lines = capsys.readouterr().out.rstrip().splitlines()
    assert lines[-3] == "Examples:", "The command is an ExampleCommand with two examples."
    for line in lines[-2:]:
        program, called, *words = shlex.split(line)
        assert (program, called) == ("wsgen", name)
        command = wsgen.cli.wsgen.get_command(click.Context(wsgen.cli.wsgen), name)
        assert command is not None
        if isinstance(command, click.Group) and words[0] in command.commands:
            _, command, words = command.resolve_command(click.Context(command), words)
            assert command is not None
        assert command.make_context(name, words).params


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (OSError(errno.ENOSPC, "No space left on device", "/dev/x"), "/dev/x: the disk is full"),
        (OSError(errno.EROFS, "Read-only file system", "/dev/x"), "/dev/x: the file system is"),
        (OSError(errno.ENOSPC, "No space left on device"), "TMPDIR="),
        (FileNotFoundError(2, "No usable temporary directory found in ['/tmp']"), "TMPDIR="),
    ],
)
def test_a_full_disk_is_not_a_bug(
    error: OSError, words: str, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(
        wsgen.cli.CommandTable, "get_command", lambda *_: command_that(raises=error)
    )
    monkeypatch.setattr(wsgen.cli, "_drop_standard_output", lambda: None)
    assert wsgen.cli.run(["new"]) == 4
    printed = capfd.readouterr().err
    assert words in printed
    assert len(printed.splitlines()) == 2


@pytest.mark.slow
def test_what_the_encoding_of_a_pipe_does_not_have(tmp_path: Path) -> None:
    """Windows has such pipes: not even an arrow is in this encoding."""
    node = "Node(package='turtlesim', executable='draw', remappings=[('here', 'there')])"
    (tmp_path / "draw.launch.py").write_text(
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n"
        f"def generate_launch_description():\n    return LaunchDescription([{node}])\n"
    )
    run = subprocess.run(
        [sys.executable, "-m", "wsgen", "launch", "draw.launch.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONIOENCODING": "cp1252"},
        capture_output=True,
        check=False,
    )
    assert (run.returncode, b"here ? there" in run.stdout) == (0, True), run.stderr
