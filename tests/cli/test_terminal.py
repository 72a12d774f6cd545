"""Tables and trees: fitted to a terminal, whole in a pipe, and without rich where it is quiet."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import click
import pytest

from wsgen.cli import terminal
from wsgen.cli.terminal import Branch, draw_markdown, draw_table, draw_tree, fit_lines

LONG = "word " * 60 + "end"
TREE = Branch("top", (Branch("a\n    more", (Branch("[red]b[/red] :smile:"),)), Branch("c")))


@pytest.fixture
def columns(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> int:
    """A terminal with so many columns."""
    size = os.terminal_size((request.param, 24))
    monkeypatch.setattr(terminal, "_is_terminal", lambda **_: True)
    monkeypatch.setattr(shutil, "get_terminal_size", lambda *_, **__: size)
    return size.columns


def test_a_pipe_gets_every_cell_whole_on_a_line_of_its_own() -> None:
    lines = draw_table([("a", LONG), ("bbb", "x")], headings=("name", ""))
    assert [click.unstyle(line) for line in (lines[0], *lines[2:])] == [
        "  name",
        f"  a     {LONG}",
        "  bbb   x",
    ]
    assert set(lines[1]) == {" ", "─"}


@pytest.mark.parametrize("columns", [40, 80], indirect=True)
def test_a_terminal_gets_lines_that_fit(columns: int) -> None:
    lines = draw_table([("a", "1", LONG), ("bbb", "2", LONG)])
    assert max(map(len, lines)) <= columns
    assert " ".join(" ".join(lines).split()).count("end") == 2


@pytest.mark.parametrize("columns", [10], indirect=True)
def test_a_narrow_terminal_cuts_nothing_off(columns: int) -> None:
    lines = draw_table([("a_name_of_20_letters", "b" * 40)], headings=("name", "text"))
    text = "".join(click.unstyle("".join(lines)).split())
    assert "a_name_of_20_letters" in text
    assert text.count("b") == 40


@pytest.mark.parametrize("columns", [60], indirect=True)
def test_what_a_narrow_terminal_would_squeeze_is_below_its_row(columns: int) -> None:
    names, path = ("a_long_name_of_a_rule", "and_another_name"), "/opt/a/folder/far/below/cmake"
    assert draw_table([(*names, "A text that has some more words."), ("b", "c", "d")]) == [
        "  a_long_name_of_a_rule  and_another_name",
        "      A text that has some more words.",
        "  b  c",
        "      d",
    ]
    lines = draw_table([("ok", "CMake", "x"), ("no", "a requirement with a long name", path)])
    assert lines[3] == f"      {path}"  # not broken
    lines = draw_table([(*names, LONG), (*names, path)], headings=("one", "two", "three"))
    assert max(len(click.unstyle(line)) for line in lines) <= columns
    assert [click.unstyle(line) for line in lines[-4:]] == [
        "",
        "  one    a_long_name_of_a_rule",
        "  two    and_another_name",
        f"  three  {path}",
    ]


@pytest.mark.parametrize("columns", [30], indirect=True)
def test_lines_continue_below_what_they_say(columns: int) -> None:
    bold = click.style("speed", bold=True)
    assert list(fit_lines(["  short", f"  {bold}  no border from 0 to 1: it varies"])) == [
        "  short",
        f"  {bold}  no border from 0 to",
        "         1: it varies",
    ]
    long = "/a/path/that/is/longer/than/the/terminal"
    assert list(fit_lines([f"  world:={long}  World file of it"])) == [
        f"  world:={long}",
        "    World file of it",
    ]
    assert columns == 30


def test_lines_stay_whole_in_a_pipe() -> None:
    assert list(fit_lines([LONG])) == [LONG]


def test_names_are_not_markup() -> None:
    assert draw_table([("[bold]x[/bold]", "[/]", ":smile:", "\\[y]")]) == [
        "  [bold]x[/bold]  [/]  :smile:  \\[y]"
    ]
    assert "│   └── [red]b[/red] :smile:" in draw_tree(TREE)


def test_styles_are_those_of_click() -> None:
    red = click.style("x", fg="red")
    assert draw_table([(red, "y")]) == [f"  {red}  y"]


def test_a_tree() -> None:
    assert draw_tree(TREE) == [
        "top",
        "├── a",
        "│       more",
        "│   └── [red]b[/red] :smile:",
        "└── c",
    ]
    wide = draw_tree(Branch("top", (Branch(LONG),)))
    assert wide == ["top", f"└── {LONG}"]


def test_quiet_draws_the_same_without_alignment() -> None:
    assert draw_table(
        [("a", "", "b"), ("ccc", "d", "e")], headings=("x", "y", "z"), quiet=True
    ) == [
        "  a  b",
        "  ccc  d  e",
    ]
    assert draw_tree(TREE, quiet=True) == [
        "top",
        "  a",
        "      more",
        "    [red]b[/red] :smile:",
        "  c",
    ]


def test_nothing_is_drawn_of_nothing() -> None:
    assert draw_table([], headings=("name",)) == []


def test_markdown_stays_text_in_a_pipe() -> None:
    assert draw_markdown("# Title\n\n`code`\n") == ["# Title", "", "`code`"]


@pytest.mark.parametrize("columns", [80], indirect=True)
def test_markdown_is_drawn_on_a_terminal(columns: int) -> None:
    drawn = "\n".join(draw_markdown("## Title\n\n`code`\n"))
    assert "#" not in drawn
    assert "Title" in drawn


@pytest.mark.slow
@pytest.mark.parametrize(
    ("options", "is_loaded"),
    [
        (("doctor",), True),
        (("doctor", "-q"), False),
        (("doctor", "--format", "json"), False),
        (("templates",), True),
        (("templates", "-q"), False),
        (("templates", "simple", "-q"), False),
        (("rule", "--format", "json"), False),
        (("rule", "massless-root"), False),
    ],
)
def test_rich_is_loaded_where_something_is_drawn(
    tmp_path: Path, options: tuple[str, ...], *, is_loaded: bool
) -> None:
    script = (
        "import sys\nfrom wsgen.cli import run\n"
        f"run({list(options)!r})\nprint('rich' in sys.modules)"
    )
    run = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert run.stdout.splitlines()[-1] == str(is_loaded)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("color", "is_colored"), [("auto", False), ("always", True), ("never", False)]
)
def test_color_holds_for_tables(
    capsys: pytest.CaptureFixture[str], color: str, *, is_colored: bool
) -> None:
    from wsgen.cli import run  # noqa: PLC0415

    run(["doctor", "--color", color])
    assert ("\x1b[" in capsys.readouterr().out) is is_colored


@pytest.mark.slow
def test_no_other_module_imports_rich() -> None:
    sources = Path(terminal.__file__).parents[1]
    importing = {
        path.relative_to(sources).as_posix()
        for path in sources.rglob("*.py")
        if re.search(r"^\s*(?:import|from) rich\b", path.read_text(encoding="utf-8"), re.MULTILINE)
    }
    assert importing == {"cli/terminal.py"}
