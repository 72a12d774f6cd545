import json
import re
from pathlib import Path

import pytest

from templating.broken_templates import FILES, HEAD, write_template
from wsgen.cli import run
from wsgen.model.target import TARGETS

pytestmark = pytest.mark.slow

EXAMPLE = Path(__file__).parents[2] / "examples" / "templates" / "pendulum"


def test_list(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["templates"]) == 0
    printed = capsys.readouterr()
    assert re.search("^simple +The tutorial's robot: a green cylinder", printed.out, re.MULTILINE)
    assert "base" not in [line.split()[0] for line in printed.out.splitlines()]
    assert printed.err == ""


def test_variables(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["templates", "simple"]) == 0
    printed = capsys.readouterr().out
    assert "targets: humble-classic, iron-classic, humble-gz" in printed
    assert "length=0.5  a number from 0.001 to 100 m      Height of the cylinder" in printed


def test_variables_of_a_template_of_the_user(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["templates", str(EXAMPLE)]) == 0
    printed = capsys.readouterr().out
    assert "bob=sphere " in printed
    assert "one of sphere, box" in printed
    assert "joint_states=true" in printed


def test_template_without_variables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["templates", str(write_template(tmp_path))]) == 0
    assert "This template has no variables." in capsys.readouterr().out


def test_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["templates", "--format", "json"]) == 0
    every = json.loads(capsys.readouterr().out)
    assert every["version"] == 1
    assert "simple" in [template["name"] for template in every["templates"]]
    assert run(["templates", str(EXAMPLE), "--format", "json"]) == 0
    (template,) = json.loads(capsys.readouterr().out)["templates"]
    assert template["name"] == "pendulum"
    assert template["targets"] == [
        {"distro": target.distro, "simulator": target.simulator} for target in TARGETS
    ]
    variables = {variable.pop("name"): variable for variable in template["variables"]}
    assert variables["length"] == {
        "help": "From the hinge to the middle of the bob",
        "type": "number",
        "unit": "m",
        "default": 0.5,
        "minimum": 0.1,
        "maximum": 5.0,
        "choices": None,
    }
    assert variables["bob"] == {
        "help": "Shape of the bob",
        "type": "choice",
        "unit": None,
        "default": "sphere",
        "minimum": None,
        "maximum": None,
        "choices": ["sphere", "box"],
    }


def test_check_of_a_sound_template(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["templates", "--check", "simple"]) == 0
    assert capsys.readouterr().out == "simple: passed\n"


@pytest.mark.parametrize(
    ("manifest", "words"),
    [
        (f"{HEAD}color = 1\nabstract = 2\n", ["`color`", "`abstract`", "template.toml:4"]),
        (HEAD + FILES, ["'nothing' is undefined", "robot.xacro.j2:1"]),
    ],
)
def test_check_of_a_broken_template(
    tmp_path: Path, manifest: str, words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_template(tmp_path, manifest, robot="{{ nothing }}")
    assert run(["templates", "--check", str(folder)]) == 1
    printed = capsys.readouterr().out
    for word in (*words, f"{folder}: failed"):
        assert word in printed
    assert run(["templates", "--check", str(folder), "--format", "json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert (found["version"], found["passed"]) == (1, False)
    assert all(one["code"].startswith("TPL") for one in found["diagnostics"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["crane"], "'crane' does not exist"),
        (["base"], "is abstract"),
        (["--check"], "--check needs a template"),
        (["--check", "crane"], "'crane' does not exist"),
    ],
)
def test_wrong_request(
    arguments: list[str], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(["templates", *arguments]) == 2
    printed = capsys.readouterr()
    assert words in printed.err
    assert printed.out == ""


def test_new_from_a_template_of_the_user(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    given = ("--maintainer-name", "Ada", "--maintainer-email", "ada@example.com")
    command = ["new", "my_pendulum", "-t", str(EXAMPLE), "--distro", "jazzy", *given]
    assert run([*command, "--set", "bob=box", "--set", "joint_states=false"]) == 0
    package = tmp_path / "ws_gazebo" / "src" / "my_pendulum"
    assert "<box" in (package / "model" / "robot.xacro").read_text()
    assert not (package / "model" / "robot.gazebo").exists()
    assert 'template = "pendulum"' in (package / "wsgen.toml").read_text()
    capsys.readouterr()


def test_new_from_a_broken_template_writes_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = write_template(tmp_path / "mine", robot="\n{{ nothing }}")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    assert run(["new", "some_robot", "-t", "../mine"]) == 4
    printed = capsys.readouterr()
    assert f"{folder}/robot.xacro.j2:2: 'nothing' is undefined." in printed.err
    assert printed.out == ""
    assert not list((tmp_path / "here").iterdir())
