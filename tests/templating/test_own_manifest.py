"""What wsgen says of a template.toml of the user."""

import os
from pathlib import Path

import pytest

from templating.broken_templates import FILES, HEAD, load, spec_for, write_template
from wsgen.errors import BrokenTemplateError, RequestError
from wsgen.model.target import DEFAULT_TARGET, choose_target
from wsgen.templating.template import read_template

VARIABLE = (
    '[variables.mass]\nhelp = "Mass"\ntype = "number"\nunit = "kg"\n'
    "default = 1\nminimum = 0\nmaximum = 2\n"
)


def test_a_template_takes_over_what_it_extends(tmp_path: Path) -> None:
    template = load(write_template(tmp_path / "mine"))
    sources = template.sources(DEFAULT_TARGET, {})
    assert sources["package.xml"] == "wsgen:base/package.xml.j2"
    assert sources["model/robot.xacro"] == "robot.xacro.j2"
    assert "gazebo_ros" in template.dependencies(DEFAULT_TARGET, {})["exec_depend"]
    assert (template.name, template.is_shipped) == ("mine", False)


def test_it_replaces_files_and_single_keys_of_variables(tmp_path: Path) -> None:
    text = (
        'schema = 1\nextends = "simple"\n[variables.mass]\ndefault = 3\n[files]\n'
        '"model/robot.xacro" = "robot.xacro.j2"\n"README.md" = "wsgen:simple/README.md.j2"\n'
    )
    template = load(write_template(tmp_path, text))
    assert template.description.startswith("The tutorial's robot")
    assert template.variables["mass"].default == 3.0
    assert template.variables["mass"].unit == "kg"
    sources = template.sources(DEFAULT_TARGET, {})
    assert sources["model/robot.xacro"] == "robot.xacro.j2"
    assert sources["model/robot.gazebo"] == "wsgen:simple/robot.gazebo.j2"
    assert sources["README.md"] == "wsgen:simple/README.md.j2"


def test_conditions(tmp_path: Path) -> None:
    text = (
        HEAD
        + '[variables.lidar]\nhelp = "Lidar"\ntype = "boolean"\ndefault = true\n'
        + FILES
        + '[[parts]]\nwhen = { lidar = true, distro = ["jazzy", "kilted"] }\n'
        + 'files."config/lidar.yaml" = "robot.xacro.j2"\n'
        + 'dependencies.exec_depend = ["rviz2"]\n'
    )
    template = load(write_template(tmp_path, text))
    jazzy = choose_target("jazzy")
    assert "config/lidar.yaml" in template.sources(jazzy, {"lidar": True})
    assert "rviz2" in template.dependencies(jazzy, {"lidar": True})["exec_depend"]
    assert "config/lidar.yaml" not in template.sources(jazzy, {"lidar": False})
    assert "config/lidar.yaml" not in template.sources(choose_target("humble"), {"lidar": True})


@pytest.mark.parametrize(
    ("targets", "names"),
    [
        ('["gz"]', "humble-gz iron-gz jazzy-gz kilted-gz lyrical-gz rolling-gz"),
        ('["humble"]', "humble-classic humble-gz"),
        ('["iron-classic", "jazzy"]', "iron-classic jazzy-gz"),
    ],
)
def test_targets(tmp_path: Path, targets: str, names: str) -> None:
    template = load(write_template(tmp_path, f"{HEAD}targets = {targets}\n{FILES}"))
    assert " ".join(target.name for target in template.targets) == names
    missing = choose_target("lyrical") if "gz" not in targets else DEFAULT_TARGET
    with pytest.raises(RequestError, match="is not made for ROS 2") as caught:
        spec_for(template, target=missing)
    assert f"it is made for {names.replace(' ', ', ')}." in caught.value.hint


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ('extends = "base"\ndescription = "x"\n', None, "`schema` is missing"),
        ('schema = 2\ndescription = "x"\n', 1, "`schema` is 2"),
        ('schema = 1\nextends = "base"\n', None, None),  # base has a description
        ("schema = 1\n", None, "`description` is missing"),
        ('schema = 1\nextends = "crane"\n', 2, "The template 'crane' to extend does not exist"),
        ('schema = 1\nextends = "../x"\n', 2, "The template '../x' to extend does not exist"),
        (f"schema = 1\nextends = 3\n{FILES}", 2, "`extends` is an integer; it must be a text"),
        (f'{HEAD}color = "red"\n', 4, "The key `color` is unknown here"),
        (f"{HEAD}abstract = 1\n", 4, "`abstract` is an integer; it must be true or false"),
        (f'{HEAD}targets = "gz"\n', 4, "`targets` is a text; it must be a list"),
        (f"{HEAD}targets = []\n", 4, "`targets` is empty"),
        (f'{HEAD}targets = ["noetic"]\n', 4, "The target 'noetic' is unknown"),
        (f"{HEAD}targets = [1]\n", 4, "`targets` is not a list of texts"),
        (f'{HEAD}files = ["a"]\n', 4, "`files` is a list; it must be a table"),
        (f'{HEAD}[files]\n"a.txt" = 1\n', 5, "The source of 'a.txt' is not a text"),
        (f"{HEAD}[dependencies]\nexec = []\n", 5, "The key `exec` is unknown here"),
        (
            f'{HEAD}[dependencies]\nexec_depend = ["Bad Name"]\n',
            5,
            "The dependency 'Bad Name' may have only",
        ),
        (f"{HEAD}[[parts]]\nwhen = 1\n", 5, "`when` is an integer; it must be a table"),
        (f'{HEAD}[[parts]]\nif = "x"\n', 5, "The key `if` is unknown here"),
        (f"{HEAD}parts = [1]\n", 4, "A part is not a table"),
        (
            f"{HEAD}[[parts]]\nwhen.x = 1\n[[parts]]\nwhen.lidar = true\n",
            5,
            "The condition names `x`",
        ),
        (
            f'{HEAD}[[parts]]\nwhen.distro = "noetic"\n',
            5,
            "`distro` is 'noetic'; it must be one of humble",
        ),
        (f"{HEAD}[variables]\nmass = 1\n", 5, "`mass` is an integer; it must be a table"),
        (f"{HEAD}{VARIABLE.replace('mass', 'Mass')}", 4, "A variable cannot be named `Mass`"),
        (f"{HEAD}{VARIABLE.replace('mass', 'class')}", 4, "cannot be named `class`"),
        (f"{HEAD}{VARIABLE.replace('mass', 'items')}", 4, "cannot be named `items`"),
        (f"{HEAD}{VARIABLE.replace('mass', 'distro')}", 4, "cannot be named `distro`"),
        (f"{HEAD}{VARIABLE.replace('number', 'float')}", 6, "The type 'float' is unknown"),
        (f"{HEAD}{VARIABLE.replace('unit', 'units')}", 7, "The key `units` is unknown here"),
        (
            f"{HEAD}{VARIABLE.replace('minimum = 0', '')}",
            4,
            "The variable `mass` has no `minimum`",
        ),
        (
            f"{HEAD}{VARIABLE.replace('default = 1', 'default = 3')}",
            8,
            "The default of `mass` is 3.0; it must be a number from 0 to 2 kg",
        ),
        (f"{HEAD}{VARIABLE.replace('= 2', '= true')}", 10, "`maximum` is not a number"),
        (f"{HEAD}{VARIABLE.replace('= 1', '= nan')}", 8, "must be a number from 0 to 2 kg"),
        (
            f'{HEAD}[variables.kind]\nhelp = ""\ntype = "choice"\nchoices = ["a"]\ndefault = "b"',
            8,
            "The default of `kind` is 'b'; it must be one of a",
        ),
    ],
)
def test_what_is_wrong_is_reported_with_its_line(
    tmp_path: Path, text: str, line: int | None, message: str | None
) -> None:
    folder = write_template(tmp_path, text)
    _, diagnostics = read_template(folder)
    if message is None:
        assert not diagnostics
        return
    first = diagnostics[0]
    assert message in first.message
    assert (first.code, first.file, first.line) == ("TPL002", folder / "template.toml", line)
    assert first.hint
    with pytest.raises(BrokenTemplateError) as caught:
        load(folder)
    assert caught.value.exit_code == 4
    assert str(folder / "template.toml") in caught.value.message


def test_all_mistakes_are_reported(tmp_path: Path) -> None:
    folder = write_template(tmp_path, f"{HEAD}color = 1\nabstract = 2\ntargets = 3\n")
    _, diagnostics = read_template(folder)
    assert [found.line for found in diagnostics] == [4, 6, 5]
    with pytest.raises(BrokenTemplateError) as caught:
        load(folder)
    assert f"2 more: wsgen templates --check {folder}" in caught.value.hint


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"schema = \n", "is not TOML"),
        (b"schema = 1\xff\n", "is not TOML"),
        (b"", "is empty or not a file"),
        (b"a = " + b"[" * 5000, "template.toml is"),
        (b"#" * (2**20 + 1), "is too large"),
    ],
)
def test_file_that_cannot_be_read(tmp_path: Path, content: bytes, words: str) -> None:
    (tmp_path / "template.toml").write_bytes(content)
    with pytest.raises(BrokenTemplateError, match=words):
        load(tmp_path)


def test_file_that_is_none(tmp_path: Path) -> None:
    for kind in ("folder", "pipe"):
        (tmp_path / kind).mkdir()
    (tmp_path / "folder" / "template.toml").mkdir()
    os.mkfifo(tmp_path / "pipe" / "template.toml")
    for kind in ("folder", "pipe"):
        with pytest.raises(BrokenTemplateError, match="is empty or not a file"):
            load(tmp_path / kind)


def test_folder_without_a_manifest(tmp_path: Path) -> None:
    _, (found,) = read_template(tmp_path)
    assert found.message == "template.toml does not exist."
    with pytest.raises(RequestError, match=r"has no template\.toml"):
        load(tmp_path)


def test_folder_whose_name_does_not_print(tmp_path: Path) -> None:
    with pytest.raises(BrokenTemplateError, match="characters that do not print"):
        load(write_template(tmp_path / "a\nb"))


def test_abstract_template_of_the_user(tmp_path: Path) -> None:
    with pytest.raises(RequestError, match="is abstract"):
        load(write_template(tmp_path, f"{HEAD}abstract = true\n"))
