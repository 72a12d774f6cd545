"""What packages allow: comments, and [check.allow] in wsgen.toml."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.packages.workspace.settings import comments_in, find_comments, read_settings

FILE = Path("f")


@pytest.mark.parametrize(
    ("text", "rules", "lines"),
    [
        ("a\nb  # wsgen: allow no-visual: why\n", ["no-visual"], (2, 2)),
        ("# wsgen: allow no-visual, ROB001: why\n\nb\n", ["no-visual", "ROB001"], (3, 3)),
        ("<!-- wsgen: allow no-visual: why -->\n<link\n  name='a'/>\n", ["no-visual"], (2, 3)),
        ("<link\n  name='a'/> <!-- wsgen:allow no-visual:why-->", ["no-visual"], (1, 2)),
        ("# wsgen: allow a: why\n# wsgen: allow b: why\nc\n", ["a", "b"], (3, 3)),
        ("# what wsgen: allow a: why\n", [], None),
        ("wsgen: allow a: why\n", [], None),
    ],
)
def test_comments(text: str, rules: list[str], lines: tuple[int, int] | None) -> None:
    found = list(comments_in(text, FILE))
    assert [one.rule for one in found] == rules
    assert {one.reason for one in found} <= {"why"}
    assert {one.lines for one in found} <= {lines}
    with_carriage_returns = list(comments_in(text.replace("\n", "\r\n"), FILE))
    assert with_carriage_returns == found


def test_a_comment_without_a_reason() -> None:
    found = [
        *comments_in("<a/> <!-- wsgen: allow b -->\n", FILE),
        *comments_in("# wsgen: allow b:\n", FILE),
    ]
    assert [one.reason for one in found] == ["", ""]


def test_comments_of_a_package(tmp_path: Path) -> None:
    (tmp_path / "launch").mkdir()
    (tmp_path / ".git").mkdir()
    for name in ("launch/a.launch.py", ".git/b.py", "c.stl", "CMakeLists.txt"):
        (tmp_path / name).write_text("# wsgen: allow no-visual: why\n")
    (tmp_path / "binary.py").write_bytes(b"\xff\x00 # wsgen: allow no-visual: why\n")
    found = [one.file.name for one in find_comments(tmp_path)]
    assert found == ["CMakeLists.txt", "binary.py", "a.launch.py"]


def test_settings(tmp_path: Path) -> None:
    (tmp_path / "wsgen.toml").write_text(
        '[check.allow]\nno-visual = "why"\n'
        'ROB064 = { reason = " so ", files = ["meshes/*"] }\nheavy-mesh = ""\n'
    )
    settings, found = read_settings(tmp_path)
    assert found == ()
    assert [(one.rule, one.reason, one.line, one.patterns) for one in settings.allowances] == [
        ("no-visual", "why", 2, ()),
        ("ROB064", "so", 3, ("meshes/*",)),
        ("heavy-mesh", "", 4, ()),
    ]


@pytest.mark.parametrize(
    "text",
    [
        "[check]\nallow = ['no-visual']\n",
        "[check]\nalow = {}\n",
        "[check.allow]\nno-visual = 1\n",
        "[check.allow]\nno-visual = { reasn = 'why' }\n",
        "[check.allow]\nno-visual = { reason = 'why', files = 'a' }\n",
        "check = 1\n",
    ],
)
def test_invalid_settings(tmp_path: Path, text: str) -> None:
    (tmp_path / "wsgen.toml").write_text(text)
    settings, found = read_settings(tmp_path)
    assert settings.allowances == ()
    assert [one.name for one in found] == ["invalid-settings"]
    assert found[0].line is not None
