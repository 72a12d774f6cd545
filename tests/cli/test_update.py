"""`wsgen update` on the command line, and the example of docs/update.md."""

import subprocess
from pathlib import Path

import pytest

from golden_support import MAINTAINER
from wsgen.cli import run

PAGE = Path(__file__).parents[2] / "docs" / "update.md"
NEW = ("new", "my_robot", "-t", "diff_drive", "--distro", "jazzy")


@pytest.fixture
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PWD", str(tmp_path))
    assert run([*NEW, "-q", *MAINTAINER]) == 0
    return tmp_path / "ws_gazebo" / "src" / "my_robot"


def test_the_example_of_the_page_is_what_happens(
    package: Path, capsys: pytest.CaptureFixture[str], *, regenerate: bool
) -> None:
    xacro = package / "model" / "robot.xacro"
    xacro.write_text(
        xacro.read_text().replace(
            '"wheel_radius" default="0.08"/>  <!-- m -->',
            '"wheel_radius" default="0.085"/>  <!-- m, measured -->',
        )
    )
    shown = [f"$ wsgen {' '.join(NEW)}", "$ # edit model/robot.xacro"]
    capsys.readouterr()
    words = ["update", "my_robot", "--set", "wheel_radius=0.1"]
    assert run(words) == 1
    shown += [f"$ wsgen {' '.join(words)}", *capsys.readouterr().out.splitlines()]
    lines = xacro.read_text().splitlines()
    first = next(place for place, line in enumerate(lines) if line.startswith("<<<<<<<"))
    shown += [
        "$ cat ws_gazebo/src/my_robot/model/robot.xacro",
        "...",
        *lines[first - 1 : first + 6],
    ]
    begin, end = "<!-- example -->\n", "<!-- end of example -->\n"
    page = PAGE.read_text(encoding="utf-8")
    before, _, rest = page.partition(begin)
    example = "\n".join(("```", *shown, "...", "```"))
    written = f"{before}{begin}{example}\n{end}{rest.partition(end)[2]}"
    if regenerate:
        PAGE.write_text(written, encoding="utf-8")
        page = written
    assert page == written


def test_diff_writes_nothing(package: Path, capsys: pytest.CaptureFixture[str]) -> None:
    before = (package / "wsgen.toml").read_text()
    capsys.readouterr()
    assert run(["update", "--set", "wheel_radius=0.1", "--diff"]) == 0
    said = capsys.readouterr()
    assert "+wheel_radius = 0.1\n" in said.out
    assert "changed" in said.err
    assert (package / "wsgen.toml").read_text() == before


@pytest.mark.slow
def test_it_refuses_changes_that_git_does_not_have(
    package: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    subprocess.run(["git", "init", "-q", str(package)], check=True)
    words = ["update", "my_robot", "--set", "wheel_radius=0.1"]
    assert run(words) == 2
    assert "not committed" in capsys.readouterr().err
    assert "wheel_radius = 0.08" in (package / "wsgen.toml").read_text()
    assert run([*words, "--force", "-q"]) == 0
    assert "wheel_radius = 0.1" in (package / "wsgen.toml").read_text()


def test_the_package_is_found_or_asked_for(
    package: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for words in ([], ["my_robot"], [str(package)], ["-w", "ws_gazebo"]):
        capsys.readouterr()
        assert run(["update", *words]) == 0
        assert "Nothing to update: my_robot has" in capsys.readouterr().out
    assert run(["update", "my_robo"]) == 2
    assert "Did you mean `my_robot`?" in capsys.readouterr().err
    assert run(["new", "other", "-q", "--distro", "jazzy", *MAINTAINER]) == 0
    capsys.readouterr()
    assert run(["update"]) == 2
    assert "my_robot, other" in capsys.readouterr().err
    monkeypatch.chdir(package / "model")
    monkeypatch.setenv("PWD", str(package / "model"))
    assert run(["update"]) == 0
