"""What a package's `wsgen.toml` says to wsgen."""

from pathlib import Path

import pytest

from wsgen.diagnostics import Severity
from wsgen.packages.workspace.settings import read_settings


def test_no_file_is_no_wish(tmp_path: Path) -> None:
    settings, diagnostics = read_settings(tmp_path)
    assert settings.allow == ()
    assert diagnostics == ()


def test_what_is_allowed(tmp_path: Path) -> None:
    (tmp_path / "wsgen.toml").write_text('schema = 1\n[validate]\nallow = ["massless-root"]\n')
    settings, diagnostics = read_settings(tmp_path)
    assert settings.allow == ("massless-root",)
    assert diagnostics == ()


@pytest.mark.parametrize(
    "content",
    [
        b"allow = [",
        b"\xff\xfe",
        b'[validate]\nallow = "massless-root"\n',
        b"[validate]\nallow = [1]\n",
        b"validate = 3\n",
        b'[validate]\nalow = ["massless-root"]\n',
    ],
)
def test_a_file_that_cannot_be_used_is_reported(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "wsgen.toml").write_bytes(content)
    settings, diagnostics = read_settings(tmp_path)
    assert settings.allow == ()
    assert [found.code for found in diagnostics] == ["PKG060"]


def test_a_file_that_is_not_toml_says_what_it_leaves_out(tmp_path: Path) -> None:
    (tmp_path / "wsgen.toml").write_text('schema = 1\n\n[[behavior]\nname = "a"\n')
    (found,) = read_settings(tmp_path)[1]
    assert (found.severity, found.line) == (Severity.ERROR, 3)
    assert found.message.endswith(
        "All of it is ignored: no behavior is checked, and no rule is allowed."
    )
    assert found.hint == "Close the name of the table: [[behavior]]"


def test_a_folder_in_its_place(tmp_path: Path) -> None:
    (tmp_path / "wsgen.toml").mkdir()
    assert [found.code for found in read_settings(tmp_path)[1]] == ["PKG060"]


@pytest.mark.parametrize(
    ("content", "line"),
    [
        ("schema = 1\n[validate\nallow = []\n", 2),
        ("schema = 1\n\n[validate]\nallow = 1\n", 4),
        ("schema = 1\n[validate]\nallow = []\nalow = []\n", 4),
        ("schema = 1\n[validat]\nallow = []\n", 2),
    ],
)
def test_a_mistake_is_reported_at_its_line(tmp_path: Path, content: str, line: int) -> None:
    (tmp_path / "wsgen.toml").write_text(content)
    assert [found.line for found in read_settings(tmp_path)[1]] == [line]


def test_the_line_of_what_is_allowed(tmp_path: Path) -> None:
    (tmp_path / "wsgen.toml").write_text('schema = 1\n[validate]\nallow = ["massless-rot"]\n')
    assert read_settings(tmp_path)[0].allow_line == 3


@pytest.mark.parametrize(
    ("line", "hint"),
    [
        ('distro = "jazzy"', "Write it below a line `[target]`."),
        ("run = true", "Write it below a line `[[behavior]]`."),
        ("[behaviour]", "Did you mean `behavior`?"),
    ],
)
def test_a_key_that_belongs_into_a_table(line: str, hint: str, tmp_path: Path) -> None:
    (tmp_path / "wsgen.toml").write_text(f"{line}\n")
    (found,) = read_settings(tmp_path)[1]
    assert (found.code, found.line, found.hint) == ("PKG060", 1, hint)
