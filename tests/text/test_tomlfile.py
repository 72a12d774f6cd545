"""What is said of files that are not TOML."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.text import tomlfile

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize(
    ("text", "instead"),
    [
        ("run = True", "TOML writes true, not True."),
        ("run = yes  # please", "TOML writes true, not yes."),
        ("a = { b = FALSE, c = 1 }", "TOML writes false, not FALSE."),
        ("robot = None", "TOML has no None: remove the key."),
        ("x = NaN", "TOML writes nan, not NaN."),
        ("seconds = 2.", "Write the number as 2.0"),
        ("seconds = -0,5", "Write the number as -0.5"),
        ("seconds = .5", "Write a digit before the point: 0.5"),
        ("seconds = 02", "Remove the zero before the number."),
        ("seconds = 2.0 s", "Write the number without `s`: units are SI."),
        ("x = 2 m/s # fast", "Write the number without `m/s`: units are SI."),
        ("x = 250 mm", "Write the number in an SI unit, without `mm`."),
        ("x = 90deg", "Write the number in an SI unit, without `deg`."),
        ("moved = { x: 1 }", "between a key and its value: moved = { x = 1 }"),
        ("run: true", "between a key and its value: run = true"),
        ("run true", "Write KEY = VALUE"),
        ("moved = { x = 1, }", "on one line, without a comma at its end"),
        ("moved = { x = 1,\n  y = 2 }", "on one line, without a comma at its end"),
        ("name = drives straight", 'Write quotes around a text: "drives straight"'),
        ('name = drives"', 'Write quotes around a text: "drives"'),
        ("name = drives'  # so", 'Write quotes around a text: "drives"'),
        ("name = drives 'on'", "Write quotes around a text: \"drives 'on'\""),
        ('name = drives "on"', "Write quotes around a text: 'drives \"on\"'"),
        ("file = C:\\dir", "Write quotes around a text: 'C:\\dir'"),
        ("name = \u201cdrives\u201d", "Write straight quotes"),
        ("name = 'it's'", "the other kind of quotes"),
        ('name = "drives', "its last quote is missing"),
        ('path = "C:\\dir"', "between single quotes"),
        ('path = "C:\\users"', "between single quotes"),
        ('path = "C:\\Users"', "between single quotes"),
        ('path = "\\uD800"', "between single quotes"),
        ("a = 1 // one", "A comment begins with `#`."),
        ("a = 1;", "Remove the `;`."),
        ("a == 1", "Write one `=`."),
        ("a = [1, 2", "Close the list"),
        ("[[behavior]\na = 1", "Close the name of the table: [[behavior]]"),
        ("[validate\na = 1", "Close the name of the table: [validate]"),
        ("[a]\nx = 1\n[a]\ny = 1", "`a` is defined twice: write [[a]]"),
        ("[[b]]\na = 1\na = 2\n", "The key is defined twice in its table"),
        (f"a = 1{'0' * 400}", "Write it with a point"),
        (f"a = {'[' * 5000}{']' * 5000}", "fewer levels"),
    ],
)
def test_what_to_write_instead(text: str, instead: str, tmp_path: Path) -> None:
    file = tmp_path / "wsgen.toml"
    file.write_text(f"# settings\n{text}\n", encoding="utf-8")
    with pytest.raises(ValueError, match=r".") as caught:
        tomlfile.load(file)
    found = tomlfile.explain(file.read_text(encoding="utf-8"), caught.value)
    assert instead in (found or "")


@pytest.mark.parametrize("text", ["a = 0x", "a = 0xfg", "a = 0x1m", "a = 1 apple", "a = 0b2"])
def test_what_follows_a_number_need_not_be_a_unit(text: str, tmp_path: Path) -> None:
    file = tmp_path / "wsgen.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r".") as caught:
        tomlfile.load(file)
    assert tomlfile.explain(text, caught.value) is None


@pytest.mark.parametrize("text", ["= 1", "a =", "a = +-1", "a", "a = \x00", "\x00", "[", "a = {"])
def test_what_nobody_can_know_is_no_traceback(text: str, tmp_path: Path) -> None:
    file = tmp_path / "wsgen.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(ValueError, match=r".") as caught:
        tomlfile.load(file)
    assert tomlfile.explain(text, caught.value) != ""


def test_an_integer_that_is_too_large_has_its_line(tmp_path: Path) -> None:
    """TOML 1.0 has those of 64 bits; no float of Python holds one of 400 digits."""
    file = tmp_path / "wsgen.toml"
    file.write_text(f"a = [{2**63 - 1}, {-(2**63)}]")
    assert tomlfile.load(file) == {"a": [2**63 - 1, -(2**63)]}
    file.write_text(f"a = 1\n[[b]]\nc = 2\n[[b]]\nd = [0.5, {{ e = {2**63} }}]\n")
    with pytest.raises(ValueError, match=r"64 bits \(at line 5, column 1\)"):
        tomlfile.load(file)


@pytest.mark.parametrize(
    "text",
    [
        ".".join("a" * 20_000) + " = 1",
        "[" + " . ".join("a" * 20_000) + "]",
        "b = { " + ".".join("a" * 20_000) + " = 1 }",
    ],
)
def test_a_key_of_too_many_words(tmp_path: Path, text: str) -> None:
    """The library takes the square of their number in memory."""
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(ValueError, match="Nested too deeply"):
        tomlfile.load(tmp_path / "a.toml")


def test_a_file_that_is_too_large(tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text("#" * (tomlfile.SIZE_LIMIT + 1))
    with pytest.raises(OSError, match="too large"):
        tomlfile.load(tmp_path / "a.toml")


@pytest.mark.parametrize(
    "text", ["a = 9" + "9" * 500_000, " " * 500_000, "1, " * 99_999, "a." * 99]
)
def test_what_is_long_is_searched_in_linear_time(text: str) -> None:
    """A quadratic search would take minutes."""
    assert tomlfile.DEEP.search(text) is None
