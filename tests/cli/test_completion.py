"""What shells complete, by click's interface and by the variable through which they ask."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.shell_completion import ShellComplete

import wsgen.cli

MANIFEST = """<package format="3"><name>{}</name><version>0.0.0</version>
<description>d</description><maintainer email="a@b.cd">a</maintainer><license>MIT</license>
<export><build_type>ament_cmake</build_type></export></package>
"""
# What completing names has no use for.
HEAVY = {"numpy", "pybullet", "PIL", "rich", "colcon_core", "catkin_pkg", "xacro", "jinja2"}


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A workspace of two packages, of which one is installed; the current folder is its source."""
    root = tmp_path / "ws"
    for name in ("rover", "robot_arm"):
        (root / "src" / name / "launch").mkdir(parents=True)
        (root / "src" / name / "package.xml").write_text(MANIFEST.format(name))
        (root / "src" / name / "launch" / f"{name}.launch.py").touch()
    installed = root / "install" / "rover" / "share" / "rover" / "launch"
    installed.mkdir(parents=True)
    for name in ("drive.launch.py", "world.launch.xml", "notes.txt"):
        (installed / name).touch()
    monkeypatch.chdir(root / "src")
    monkeypatch.delenv("AMENT_PREFIX_PATH", raising=False)
    return root


def completions(*words: str) -> list[str]:
    """The names that click gives for the last word; kinds of files in angle brackets."""
    shell = ShellComplete(wsgen.cli.wsgen, {}, "wsgen", wsgen.cli.COMPLETION)
    items = shell.get_completions(list(words[:-1]), words[-1])
    return [item.value if item.type == "plain" else f"<{item.type}>" for item in items]


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("",), list(wsgen.cli.COMMANDS)),
        (("va",), ["validate"]),
        (("build", ""), ["robot_arm", "rover"]),
        (("build", "ro"), ["robot_arm", "rover"]),
        (("build", "rov"), ["rover"]),
        (("build", "rover", ""), ["robot_arm"]),
        (("build", "--form"), ["--format"]),
        (("build", "--format", ""), ["text", "json"]),
        (("validate", ""), ["<file>", "robot_arm", "rover"]),
        (("validate", "rover", "--launch", ""), ["drive.launch.py", "world.launch.xml"]),
        (("launch", ""), ["<file>", "robot_arm", "rover"]),
        (("launch", "rover", ""), ["drive.launch.py", "world.launch.xml"]),
        (("launch", "rover", "w"), ["world.launch.xml"]),
        (("launch", "robot_arm", ""), ["robot_arm.launch.py"]),  # it is not built
        (("launch", "nothing", ""), []),
        (("launch", "rover", "drive.launch.py", ""), []),
        (("new", "my_robot", "-t", ""), ["<dir>", "arm", "diff_drive", "simple", "wanderer"]),
        (("templates", "s"), ["<dir>", "simple"]),
        (("build", "-w", ""), ["<dir>"]),
        (("validate", "--engine", ""), ["bullet", "dart", "mujoco", "gazebo", "all"]),
    ],
)
@pytest.mark.usefixtures("workspace")
def test_completions(words: tuple[str, ...], expected: list[str]) -> None:
    assert completions(*words) == expected


def test_the_workspace_that_is_named(
    workspace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir("/")
    assert completions("build", "") == []
    assert completions("build", "-w", str(workspace), "") == ["robot_arm", "rover"]
    assert completions("build", "-w", str(tmp_path / "nowhere"), "") == []


def ask(words: str, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """What a shell gets that asks for what follows the words."""
    return subprocess.run(
        [sys.executable, "-m", "wsgen"],
        cwd=folder,
        env={
            **os.environ,
            wsgen.cli.COMPLETION: "bash_complete",
            "COMP_WORDS": f"wsgen {words}",
            "COMP_CWORD": str(len(words.split()) + 1),
            **environment,
        },
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.slow
def test_what_a_shell_gets(workspace: Path) -> None:
    run = ask("launch rover", workspace)
    assert (run.returncode, run.stderr) == (0, "")
    assert run.stdout == "plain,drive.launch.py\nplain,world.launch.xml\n"


@pytest.mark.slow
def test_a_shell_reads_nothing_where_nothing_can_be_completed(tmp_path: Path) -> None:
    source = tmp_path / "ws" / "src" / "broken"
    source.mkdir(parents=True)
    (source / "package.xml").write_bytes(b"\xff\x00<package")
    (tmp_path / "template").mkdir()
    for words in ("build", "launch broken", "biuld x", "new a -t", "build --bogus"):
        run = ask(words, source)
        assert (run.returncode, run.stderr) == (0, ""), words


@pytest.mark.slow
def test_it_loads_little(workspace: Path) -> None:
    run = ask("launch rover", workspace, PYTHONPROFILEIMPORTTIME="1")
    loaded = {line.rpartition("|")[2].strip() for line in run.stderr.splitlines()}
    assert "wsgen.cli.options" in loaded
    assert not loaded & HEAVY


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("bash") is None, reason="there is no bash")
def test_bash_completes_with_the_script(workspace: Path) -> None:
    """The line of docs/completion.md, then what bash does when somebody presses Tab."""
    documentation = Path(__file__).parents[2] / "docs" / "completion.md"
    (line,) = (
        row.split("`")[3] for row in documentation.read_text().splitlines() if "~/.bashrc` |" in row
    )
    script = f"""
        wsgen() {{ '{sys.executable}' -m wsgen "$@"; }}
        {line}
        COMP_WORDS=(wsgen build rov) COMP_CWORD=2
        _wsgen_completion '{Path(sys.executable).with_name("wsgen")}'
        echo "${{COMPREPLY[@]}}"
    """
    run = subprocess.run(
        ["bash", "--norc", "-c", script], cwd=workspace, capture_output=True, text=True, check=False
    )
    assert (run.stdout, run.stderr) == ("rover\n", "")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_the_documentation_names_every_shell(shell: str, tmp_path: Path) -> None:
    documentation = Path(__file__).parents[2] / "docs" / "completion.md"
    assert f"_WSGEN_COMPLETE={shell}_source wsgen" in documentation.read_text()
    run = ask("", tmp_path, **{wsgen.cli.COMPLETION: f"{shell}_source"})
    assert run.returncode == 0
    assert f"{shell}_complete" in run.stdout
