"""Templates of the user: what they may do, and what wsgen says of those that do something else."""

import os
from pathlib import Path

import pytest

from templating.broken_templates import FILES, HEAD, load, spec_for, write_template
from wsgen.diagnostics import Diagnostic
from wsgen.errors import BrokenTemplateError
from wsgen.templating.render import MAXIMUM_FILE, RenderedTree, render_tree
from wsgen.templating.render_apart import render_package_apart, render_tree_apart

pytestmark = pytest.mark.slow


def render(folder: Path) -> tuple[RenderedTree, tuple[Diagnostic, ...]]:
    """Here and now: what is tested is not harmful."""
    template = load(folder)
    return render_tree(spec_for(template), template)


def only_diagnostic(folder: Path) -> Diagnostic:
    _, (found,) = render(folder)
    assert found.hint
    return found


def test_what_base_brings_and_what_is_written(tmp_path: Path) -> None:
    folder = write_template(
        tmp_path / "mine",
        robot='{% include "link.xacro.j2" %}\n{{ package.name }} {{ files | length }}',
        link__xacro__j2="<link/>\n",
    )
    template = load(folder)
    tree = render_package_apart(spec_for(template), template)
    assert tree["model/robot.xacro"] == "<link/>\nsome_robot 10\n"
    assert 'template = "mine"' in tree["wsgen.toml"]
    assert "DIRECTORY launch model\n" in tree["CMakeLists.txt"]
    assert tree == render(folder)[0]


@pytest.mark.parametrize(
    ("robot", "line", "message"),
    [
        ("a\n{{ lenght }}", 2, "'lenght' is undefined"),
        ("a\n{{ package.answers.lenght }}", 2, "has no attribute 'lenght'"),
        ("a\n\n{% if %}", 3, "Expected an expression"),
        ("{% for a in files %}\n", 1, "Unexpected end of template"),
        ("a\n{{ 1 / 0 }}", 2, "ZeroDivisionError: division by zero"),
        ("a\n{{ files | nofilter }}", 2, "No filter named 'nofilter'"),
        ("a\n{{ files | random }}", 2, "No filter named 'random'"),
        ("a\n{{ lipsum() }}", 2, "'lipsum' is undefined"),
        ("a\n{% include 'none.j2' %}", 2, "The source 'none.j2' does not exist"),
        ("a\n{% include '../x.j2' %}", 2, "'../x.j2' is not a path below"),
        ("a\n{% include '/etc/passwd' %}", 2, "'/etc/passwd' is not a path below"),
        ("a\n{% include 'template.toml' %}", 2, "does not end in .j2"),
        ("a\n{% include 'wsgen:../pyproject.toml' %}", 2, "is not a path below"),
        ("a\n{% include 'wsgen:base/none.j2' %}", 2, "does not exist"),
        ("a\n{% include 'robot.xacro.j2' %}", 2, "includes or calls itself without end"),
        ("{% macro m() %}\n{{ m() }}{% endmacro %}{{ m() }}", 2, "calls itself without end"),
        ("a\n{{ package.__class__ }}", 2, "Access to attribute '__class__'"),
        ("a\n{{ ''.__class__.__mro__ }}", 2, "Access to attribute '__class__'"),
        ("a\n{{ files.append(1) }}", 2, "Access to attribute 'append'"),
        ("a\n{{ package.answers.update(a=1) }}", 2, "Access to attribute 'update'"),
        ("a\n{{ '{0.__class__}'.format(files) }}", 2, "Access to attribute '__class__'"),
        ("a\n{% for i in range(10**9) %}{% endfor %}", 2, "Range too big"),
        ("a\n{% for i in range(99999) %}\n{{ 'x' * 100 }}{% endfor %}", None, "is too large"),
    ],
)
def test_what_is_wrong_in_a_source_is_reported_with_its_line(
    tmp_path: Path, robot: str, line: int | None, message: str
) -> None:
    found = only_diagnostic(write_template(tmp_path, robot=robot))
    assert message in found.message
    assert (found.code, found.element) == ("TPL004", "model/robot.xacro")
    assert (found.file, found.line) == (tmp_path / "robot.xacro.j2", line)


def test_the_line_is_that_of_the_file_that_is_included(tmp_path: Path) -> None:
    folder = write_template(
        tmp_path, robot="\n\n{% include 'part.j2' %}", part__j2="a\n{{ nothing }}"
    )
    found = only_diagnostic(folder)
    assert (found.file, found.line) == (tmp_path / "part.j2", 2)


@pytest.mark.parametrize(
    ("robot", "words"),
    [
        (
            "a\n{% for i in range(99999) %}{% for j in range(99999) %}{% endfor %}{% endfor %}",
            "robot.xacro.j2:2: The template needs more than 0.3 s of CPU time",
        ),
        ("a\n{{ 'x' * 10**10 }}", "robot.xacro.j2:2: MemoryError"),
        ("{% set a = [0] * 10**8 %}", "robot.xacro.j2:1: MemoryError"),
        # One step of C code: nothing but the end of the process stops it.
        ("{{ (9**9)**(9**9) }}", "Rendering the template used more than 1 s of CPU time"),
    ],
)
def test_a_template_without_end_is_ended(
    tmp_path: Path, robot: str, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("wsgen.templating.render_apart.SPARE_SECONDS", 0.7)
    template = load(write_template(tmp_path, robot=robot))
    tree, diagnostics = render_tree_apart(spec_for(template), template, seconds=0.3)
    reported = [f"{found.file}:{found.line}: {found.message}" for found in diagnostics]
    assert any(words in one for one in reported), reported
    assert "model/robot.xacro" not in tree


def test_every_diagnostic_comes_back_from_the_child(tmp_path: Path) -> None:
    text = f'{HEAD}{FILES}"README.md" = "readme.j2"\n'
    folder = write_template(tmp_path, text, robot="{{ one }}", readme__j2="\n{{ two }}")
    template = load(folder)
    _, diagnostics = render_tree_apart(spec_for(template), template)
    assert diagnostics == render(folder)[1]
    assert [found.message for found in diagnostics] == [
        "'two' is undefined.",
        "'one' is undefined.",
    ]
    with pytest.raises(BrokenTemplateError) as caught:
        render_package_apart(spec_for(template), template)
    assert f"{folder}/readme.j2:2: 'two' is undefined." in caught.value.message
    assert "1 more" in caught.value.hint


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("none.j2", "does not exist"),
        ("../robot.xacro.j2", "is not a path below"),
        ("/etc/passwd.j2", "is not a path below"),
        ("a//b.j2", "is not a path below"),
        ("a\\\\b.j2", "is not a path below"),
        ("template.toml", "does not end in .j2"),
        ("folder.j2", "is not a file"),
        ("pipe.j2", "is not a file"),
        ("link.j2", "leads out of the template's folder"),
        ("circle.j2", "is not a file|leads out|does not exist"),
        ("linked/x.j2", "leads out of the template's folder"),
        ("wsgen:base/../../x.j2", "is not a path below"),
        ("wsgen:crane/x.j2", "does not exist"),
    ],
)
def test_source_that_is_none(tmp_path: Path, source: str, words: str) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (outside / "x.j2").write_text("secret")
    folder = write_template(tmp_path / "t", f'{HEAD}[files]\n"a.txt" = "{source}"\n')
    (folder / "folder.j2").mkdir()
    os.mkfifo(folder / "pipe.j2")
    (folder / "link.j2").symlink_to(outside / "x.j2")
    (folder / "circle.j2").symlink_to("circle.j2")
    (folder / "linked").symlink_to(outside)
    found = only_diagnostic(folder)
    assert found.code == "TPL003"
    assert any(word in found.message for word in words.split("|")), found.message


def test_links_within_the_folder_are_followed(tmp_path: Path) -> None:
    folder = write_template(tmp_path / "t", f'{HEAD}[files]\n"a.txt" = "link.j2"\n', robot="here\n")
    (folder / "link.j2").symlink_to("robot.xacro.j2")
    (tmp_path / "elsewhere").symlink_to(folder)
    assert render(tmp_path / "elsewhere")[0]["a.txt"] == "here\n"


def test_source_that_is_no_text(tmp_path: Path) -> None:
    folder = write_template(tmp_path)
    (folder / "robot.xacro.j2").write_bytes(b"\xff\xfe")
    assert "is not UTF-8 (byte 0)" in only_diagnostic(folder).message
    (folder / "robot.xacro.j2").write_bytes(b"x" * (MAXIMUM_FILE + 1))
    assert "is larger than" in only_diagnostic(folder).message


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ('"../evil" = "robot.xacro.j2"', "The path '../evil' cannot be in a package"),
        ('"{{ nothing }}" = "robot.xacro.j2"', "is not allowed in a path"),
        ('"readme.MD" = "robot.xacro.j2"', "'README.md' and 'readme.MD' exclude each other"),
        ('"model" = "robot.xacro.j2"', "'model' and 'model/"),
        ('"COLCON_IGNORE" = "robot.xacro.j2"', "colcon ignores a package"),
    ],
)
def test_path_that_cannot_be(tmp_path: Path, files: str, message: str) -> None:
    found = only_diagnostic(write_template(tmp_path, f"{HEAD}[files]\n{files}\n"))
    assert message in found.message
    assert (found.code, found.file) == ("TPL005", tmp_path / "template.toml")


def test_template_that_makes_no_package(tmp_path: Path) -> None:
    folder = write_template(tmp_path, 'schema = 1\ndescription = "x"\n' + FILES)
    _, diagnostics = render(folder)
    assert diagnostics[0].message == "The template does not create 'package.xml'."
    assert 'extends = "base"' in (diagnostics[0].hint or "")
