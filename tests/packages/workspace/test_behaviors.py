"""`[[behavior]]` of `wsgen.toml`: what is read, and what is refused, with its place."""

from pathlib import Path

import pytest

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.behavior import Behavior, Drive, LaunchTask, Reach
from wsgen.packages.workspace.settings import read_settings

DRIVES = """[[behavior]]
name = "drives"
drive = { linear = 0.5 }
seconds = 2
moved = { x = 1, yaw = 0.0 }
"""
REACHES = """[[behavior]]
name = "reaches"
robot = "arm"
seconds = 3.5
within = 0.1
[behavior.joints]
joint_1 = -0.5
"a b" = 1
"""


def read(folder: Path, text: str) -> tuple[tuple[Behavior, ...], tuple[Diagnostic, ...]]:
    (folder / "wsgen.toml").write_text(text, encoding="utf-8")
    settings, found = read_settings(folder)
    return settings.behaviors, found


def test_what_is_written_is_read(tmp_path: Path) -> None:
    behaviors, found = read(tmp_path, f"schema = 1\n{DRIVES}\n{REACHES}")
    assert found == ()
    assert behaviors == (
        Behavior(
            name="drives",
            task=Drive(linear=0.5, x=1.0, yaw=0.0, tolerance=0.1),
            seconds=2.0,
            line=2,
        ),
        Behavior(
            name="reaches",
            task=Reach(positions={"joint_1": -0.5, "a b": 1.0}, within=0.1),
            seconds=3.5,
            robot="arm",
            line=8,
        ),
    )


def test_one_for_which_the_launch_file_runs(tmp_path: Path) -> None:
    text = """[[behavior]]
name = "wanders"
run = true
seconds = 10
travels = 2
moved = { x = 1 }
tolerance = 0.3
joints = { lift = 0.5 }
within = 0.1

[[behavior]]
name = "goes on"
run = true
seconds = 1

[[behavior]]
name = "drives"
run = false
drive = { linear = 0.5 }
seconds = 2
moved = { x = 1 }
"""
    behaviors, found = read(tmp_path, text)
    assert found == ()
    assert [one.task for one in behaviors] == [
        LaunchTask(x=1.0, tolerance=0.3, travels=2.0, positions={"lift": 0.5}, within=0.1),
        LaunchTask(),
        Drive(linear=0.5, x=1.0),
    ]


def test_none_are_none(tmp_path: Path) -> None:
    assert read(tmp_path, "behavior = []\n") == ((), ())
    assert read(tmp_path, "schema = 1\n") == ((), ())


@pytest.mark.parametrize(
    ("instead_of", "text", "line", "element", "message"),
    [
        ('name = "drives"', "", 1, "0.name", "has no name"),
        ('name = "drives"', "name = 3", 2, "0.name", "not a text"),
        ('name = "drives"', 'name = " "', 2, "0.name", "not a text"),
        ('name = "drives"', 'name = "a\\nb"', 2, "0.name", "not a text"),
        ('name = "drives"', f'name = "{"a" * 81}"', 2, "0.name", "more than 80"),
        ("seconds = 2", "", 1, "0.seconds", "no `seconds`"),
        ("seconds = 2", 'seconds = "2"', 4, "0.seconds", "is not a number"),
        ("seconds = 2", "seconds = true", 4, "0.seconds", "is not a number"),
        ("seconds = 2", "seconds = 0", 4, "0.seconds", "is 0"),
        ("seconds = 2", "seconds = -1", 4, "0.seconds", "is -1"),
        ("seconds = 2", "seconds = 61", 4, "0.seconds", "is 61"),
        ("seconds = 2", "seconds = nan", 4, "0.seconds", "is nan"),
        ("seconds = 2", "seconds = inf", 4, "0.seconds", "is inf"),
        ("{ linear = 0.5 }", "0.5", 3, "0.drive", "not a table of numbers"),
        ("{ linear = 0.5 }", "{}", 3, "0.drive", "not a table of numbers"),
        ("{ linear = 0.5 }", "{ linear = 1e9 }", 3, "0.drive.linear", "is 1e+09"),
        ("{ linear = 0.5 }", '{ linear = "a" }', 3, "0.drive.linear", "not a number"),
        ("{ linear = 0.5 }", "{ x = 0.5 }", 3, "0.drive.x", "`drive` has no key `x`"),
        ("moved = { x = 1, yaw = 0.0 }", "", 1, "0.moved", "no `moved`"),
        ("moved = { x = 1, yaw = 0.0 }", "moved = [1]", 5, "0.moved", "not a table of numbers"),
        ("yaw = 0.0", "z = 0.0", 5, "0.moved.z", "`moved` has no key `z`"),
        ("seconds = 2", "seconds = 2\ntolerance = 0", 5, "0.tolerance", "is 0"),
        ("seconds = 2", "seconds = 2\ntolerance = 2", 5, "0.tolerance", "is 2"),
        ("seconds = 2", "seconds = 2\nwithin = 1", 5, "0.within", "no key `within` here"),
        ("seconds = 2", "seconds = 2\nsecond = 1", 5, "0.second", "no key `second`."),
        ("seconds = 2", "seconds = 2\nrobot = 1", 5, "0.robot", "is not a name"),
        ("seconds = 2", 'seconds = 2\nrobot = ""', 5, "0.robot", "is not a name"),
        ("seconds = 2", "seconds = 2\njoints = { a = 1 }", 1, "0", "both `drive` and `joints`"),
        ("drive = { linear = 0.5 }", "", 1, "0", "neither `drive` nor `joints`"),
        ("seconds = 2", "seconds = 2\nrun = true", 1, "0", "both `drive` and `run`"),
        ("seconds = 2", "seconds = 2\nrun = 1", 5, "0.run", "must be true or false"),
        ("drive = { linear = 0.5 }", "run = true\ntravels = 0", 4, "0.travels", "is 0"),
        ("drive = { linear = 0.5 }", "run = true\njoints = 1", 4, "0.joints", "not a table"),
        ("seconds = 2", "seconds = 2\ntravels = 1", 5, "0.travels", "no key `travels` here"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(
    tmp_path: Path, instead_of: str, text: str, *, line: int, element: str, message: str
) -> None:
    written = DRIVES.replace(instead_of, text)
    assert written != DRIVES
    behaviors, found = read(tmp_path, written)
    assert behaviors == ()
    assert [(one.code, one.severity) for one in found] == [("PKG060", Severity.ERROR)]
    assert (found[0].line, found[0].element) == (line, f"behavior.{element}")
    assert message in found[0].message
    assert found[0].hint


def test_a_misspelled_key_is_asked_about(tmp_path: Path) -> None:
    _, found = read(tmp_path, DRIVES.replace("linear", "liner"))
    keys = "se its keys: `linear`, `angular`."
    assert [one.hint for one in found] == [f"Did you mean `linear`? If not, u{keys}"]
    _, found = read(tmp_path, DRIVES.replace("linear = 0.5", "linear = 0.5, liner = 1"))
    assert [one.hint for one in found] == [f"U{keys}"]  # there already
    _, found = read(tmp_path, DRIVES.replace("x = 1", "X = 1"))
    assert [one.hint for one in found] == [
        "Did you mean `x`? If not, use its keys: `x`, `y`, `yaw`."
    ]


def test_two_of_one_name(tmp_path: Path) -> None:
    behaviors, found = read(tmp_path, f"{DRIVES}\n{DRIVES}")
    assert [behavior.name for behavior in behaviors] == ["drives"]
    assert [(one.message, one.line) for one in found] == [("Two behaviors are named `drives`.", 8)]


def test_wrong_values_of_joints(tmp_path: Path) -> None:
    behaviors, found = read(tmp_path, REACHES.replace("-0.5", "nan").replace("0.1", "0"))
    assert behaviors == ()
    assert [(one.element, one.line) for one in found] == [
        ("behavior.0.joints.joint_1", 7),
        ("behavior.0.within", 5),
    ]


def test_what_is_right_counts_beside_what_is_wrong(tmp_path: Path) -> None:
    behaviors, found = read(tmp_path, DRIVES.replace("seconds = 2", "") + REACHES)
    assert [behavior.name for behavior in behaviors] == ["reaches"]
    assert len(found) == 1


@pytest.mark.parametrize("text", ["behavior = 3", "behavior = [1]", "[behavior]\nname = 'a'"])
def test_no_list_of_tables(tmp_path: Path, text: str) -> None:
    behaviors, found = read(tmp_path, text)
    assert behaviors == ()
    assert [(one.code, one.line) for one in found] == [("PKG060", 1)]


def test_too_many(tmp_path: Path) -> None:
    tables = "".join(DRIVES.replace("drives", f"d{number}") for number in range(51))
    behaviors, found = read(tmp_path, tables)
    assert behaviors == ()
    assert "51 behaviors" in found[0].message


@pytest.mark.parametrize("key", ["behaviors", "behaviour", "behavour", "Behavior"])
def test_a_key_that_is_nearly_right(tmp_path: Path, key: str) -> None:
    behaviors, found = read(tmp_path, DRIVES.replace("[[behavior]]", f"[[{key}]]"))
    assert behaviors == ()
    assert f"no key `{key}`" in found[0].message
    assert (found[0].severity, found[0].hint) == (Severity.ERROR, "Did you mean `behavior`?")


def test_what_is_allowed_is_read_beside_it(tmp_path: Path) -> None:
    (tmp_path / "wsgen.toml").write_text(f'{DRIVES}[validate]\nallow = ["massless-root"]\n')
    settings, found = read_settings(tmp_path)
    assert (len(settings.behaviors), settings.allow, found) == (1, ("massless-root",), ())
