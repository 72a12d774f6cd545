"""`wsgen sweep`: what it prints, writes, refuses, and goes on with."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import wsgen.cli
from wsgen.cli.options import RUN_SECONDS
from wsgen.model.sweep import LONGEST_RUN, SHORTEST_RUN

BOX = """\
<robot name="box" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="height" default="0.2"/>
  <xacro:property name="h" value="$(arg height)"/>
  <link name="base">
    <inertial><mass value="1"/>
      <inertia ixx="${(0.01 + h * h) / 12}" ixy="0" ixz="0" iyy="${(0.01 + h * h) / 12}" iyz="0"
               izz="${0.02 / 12}"/>
    </inertial>
    <collision><geometry><box size="0.1 0.1 ${h}"/></geometry></collision>
    <visual><geometry><box size="0.1 0.1 ${h}"/></geometry></visual>
  </link>
</robot>
"""


@pytest.fixture
def box(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "box.urdf.xacro"
    file.write_text(BOX)
    return file


def sweep(*words: str) -> int:
    return wsgen.cli.run(["sweep", "box.urdf.xacro", "--seconds", "0.5", *words])


@pytest.mark.slow
def test_from_which_height_on_a_box_tips_on_a_slope(
    box: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By statics where the height is the width divided by the slope's tangent: 0.3732 m."""
    assert sweep("--over", "world.slope=15deg", "--over", "height=0.30:0.42:5") == 0
    out, err = capsys.readouterr()
    assert out.splitlines()[0] == "5 runs: 3 passed (60.0 %)"
    assert "height" in out
    assert "passes below 0.375 ± 0.015" in out
    assert "Table: box-sweep-world.slope-height.csv (5 runs)" in err
    lines = Path("box-sweep-world.slope-height.csv").read_text().splitlines()
    assert lines[0].startswith("run,world.slope,height,passed,codes,rest_x,")
    assert [line.split(",")[3] for line in lines[1:]] == ["true", "true", "true", "false", "false"]


@pytest.mark.slow
def test_the_same_command_does_nothing_again_and_another_one_is_refused(
    box: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ("--over", "height=0.1,0.2", "--out", "t.jsonl", "--format", "json", "-q")
    assert sweep(*words) == 0
    first = json.loads(capsys.readouterr().out)
    table = Path("t.jsonl").read_bytes()
    assert (first["was_complete"], first["runs"], first["passed"]) == (False, 2, 2)
    assert sweep(*words) == 0
    assert json.loads(capsys.readouterr().out) == {**first, "was_complete": True}
    box.write_text(BOX.replace('mass value="1"', 'mass value="2"'))
    assert sweep(*words) == 3
    out, err = capsys.readouterr()
    assert out == ""
    assert "the files of the robot and its world" in err
    assert Path("t.jsonl").read_bytes() == table


@pytest.mark.slow
def test_a_variant_that_does_not_expand_is_a_row(
    box: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    box.write_text(BOX.replace('value="$(arg height)"', 'value="${0.02 / $(arg height)}"'))
    assert sweep("--over", "height=0.1,0,0.2", "--out", "t.jsonl") == 0
    rows = [json.loads(line) for line in Path("t.jsonl").read_text().splitlines()]
    assert [row["passed"] for row in rows] == [True, False, True]
    assert "division" in rows[1]["diagnostic"]
    assert rows[1]["tilt"] is None
    assert "3 runs: 2 passed" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        ((), 2, "Nothing varies."),
        (("--over", "heigth=1,2"), 2, "Did you mean `height`?"),
        (("--over", "robot.mass_scale=0,1"), 2, "robot.mass_scale"),
        (("--over", "height=1:2"), 2, "height=1:2"),
        (("--random", "height=uniform(2, 1)"), 2, "uniform(2, 1)"),
        (("--over", "height=1,2", "--engine", "all"), 2, "one engine"),
        (("--over", "height=1,2", "--worst", "0"), 2, "--worst 0"),
        (("--over", "height=1,2", "--out", "t.xls"), 2, ".xls"),
        (("--over", "height=1,2", "--plot", "t.pdf"), 2, ".pdf"),
        (("--over", "height=1,2", "--out", "nowhere/t.csv"), 4, "nowhere"),
        (("--over", "height=1,2", "--set", "a=1"), 2, "--set has no effect"),
        (("--over", "height=1,2", "-t", "simple"), 2, "2 are given"),
        (
            ("--over", "height=1,2", "--arg", "height:=3"),
            2,
            "so that --arg height:=3 has no effect",
        ),
        (("--over", "world.slope=0:45:10"), 2, "Write 5deg if it is in degrees."),
        (("--over", "world.friction=0.1,high"), 2, "world.friction: high is not allowed"),
    ],
)
def test_what_is_refused_before_anything_runs(
    box: Path,
    capsys: pytest.CaptureFixture[str],
    words: tuple[str, ...],
    code: int,
    message: str,
) -> None:
    assert sweep(*words) == code
    out, err = capsys.readouterr()
    assert out == ""
    assert message in err
    assert "Traceback" not in err
    assert [file.name for file in box.parent.iterdir()] == [box.name]


@pytest.mark.slow
def test_what_a_push_cannot_move(box: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert sweep("--over", "push.force=0,1", "--over", "height=0.1") == 0
    assert "still acts at the end of runs of 0.5 s. Give --seconds 2" in capsys.readouterr().err
    assert sweep("--over", "push.force=0,1", "--over", "push.seconds=0.1,0.3", "-q") == 0
    assert "still acts" not in capsys.readouterr().err
    text = BOX.replace("<link name=", '<link name="world"/>\n  <link name=', 1)
    joint = '<joint name="bolt" type="fixed"><parent link="world"/><child link="base"/></joint>'
    box.write_text(text.replace("</robot>", f"{joint}</robot>"))
    assert sweep("--over", "push.force=0,1", "--out", "fixed.csv") == 2
    assert "push.force has no effect: box is fixed to the world." in capsys.readouterr().err


@pytest.mark.slow
def test_the_worst_variants_can_be_looked_at(box: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = (
        *("--over", "world.slope=15deg", "--over", "height=0.3:0.5:3"),
        *("--over", "robot.mass_scale=2", "--worst", "1", "--out", "t.csv"),
    )
    assert sweep(*words) == 0
    folder = Path("t-worst/run-2")
    assert f"{folder}  world.slope=" in capsys.readouterr().out
    assert sorted(file.name for file in folder.iterdir()) == [
        *("README.md", "box.urdf", "robot.gif", "robot.png", "variant.json"),
    ]
    text = (folder / "box.urdf").read_text()
    assert "0.1 0.1 0.5" in text
    assert '<mass value="2"/>' in text
    assert "tips-over" in (folder / "README.md").read_text()
    assert (folder / "robot.png").read_bytes()[:4] == b"\x89PNG"
    # Once more, and it is there already; with something else in its place, it is not lost.
    assert sweep(*words) == 0
    (folder / "variant.json").write_text("{}")
    assert sweep(*words) == 3
    assert "with something else than this variant" in capsys.readouterr().err
    assert wsgen.cli.run(["validate", str(folder / "box.urdf"), "-q"]) == 0


@pytest.mark.slow
def test_the_package_of_a_template_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["-t", "simple", "--over", "length=0.5,3.0", "--seconds", "1", "--worst", "2"]
    assert wsgen.cli.run(["sweep", *words, "-q", "--out", "t.csv"]) == 0
    package = tmp_path / "t-worst" / "run-1" / "src" / "simple"
    assert (package / "CMakeLists.txt").exists()
    assert "length = 3.0" in (package / "wsgen.toml").read_text()
    assert (tmp_path / "t-worst" / "COLCON_IGNORE").exists()
    assert wsgen.cli.run(["validate", "-w", str(package.parents[1]), "-q"]) == 0


@pytest.mark.slow
def test_interrupted_it_says_how_to_go_on(box: Path) -> None:
    command = [sys.executable, "-m", "wsgen", "sweep", "box.urdf.xacro", "--out", "t.csv"]
    command += ["--over", "height=0.1:0.5:2000", "--seconds", "2"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as child:
        journal = Path("t.csv.sweep")
        while child.poll() is None and not (
            journal.exists() and journal.read_bytes().count(b"\n") > 3
        ):
            pass
        child.terminate()
        _, err = child.communicate()
    assert child.returncode == 143
    assert "of 2,000 runs are done. Run the same command again to continue." in err
    assert "Traceback" not in err
    rows = Path("t.csv").read_text().splitlines()
    assert len(rows) > 3
    assert rows[1].startswith("0,0.1,")


@pytest.mark.slow
def test_a_misspelled_column_is_refused_before_anything_runs(
    box: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert sweep("--over", "height=0.1,0.2", "--worst", "1:dirft") == 2
    assert "Did you mean `drift`?" in capsys.readouterr().err
    assert [file.name for file in box.parent.iterdir()] == [box.name]


@pytest.mark.slow
def test_where_no_variant_has_a_robot_nothing_is_run(
    box: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    box.write_text(BOX.replace("$(arg height)", "$(arg hight)"))
    assert sweep("--over", "height=0.1,0.2") == 1
    out, err = capsys.readouterr()
    assert "hight" in out
    assert "Nothing was run." in err
    assert [file.name for file in box.parent.iterdir()] == [box.name]


@pytest.mark.slow
@pytest.mark.parametrize("edit", ["change", "swap"])
def test_files_that_only_some_variants_read_count(
    box: Path, capsys: pytest.CaptureFixture[str], edit: str
) -> None:
    small, large = box.with_name("small.xacro"), box.with_name("large.xacro")
    for file, size in ((small, 0.1), (large, 0.3)):
        file.write_text(
            f'<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:property name="h" '
            f'value="{size}"/></robot>'
        )
    box.write_text(
        BOX.replace('name="height" default="0.2"', 'name="part" default="small"').replace(
            '<xacro:property name="h" value="$(arg height)"/>',
            '<xacro:include filename="$(arg part).xacro"/>',
        )
    )
    words = ("--over", "part=small,large", "--out", "t.csv", "-q")
    assert sweep(*words) == 0
    if edit == "change":
        large.write_text(large.read_text().replace("0.3", "0.2"))
    else:
        texts = small.read_text(), large.read_text()
        large.write_text(texts[0])
        small.write_text(texts[1])
    assert sweep(*words) == 3
    assert "the files of the robot and its world" in capsys.readouterr().err


def test_a_run_takes_as_long_as_in_wsgen_toml() -> None:
    assert (RUN_SECONDS.min, RUN_SECONDS.max) == (SHORTEST_RUN, LONGEST_RUN)
