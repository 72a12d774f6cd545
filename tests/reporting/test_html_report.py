"""The page of `wsgen validate --html`: valid HTML, complete, and nothing of a user is markup."""

from __future__ import annotations

import base64
import gzip
import json
import math
import re
from array import array
from dataclasses import replace
from datetime import datetime, timezone
from itertools import pairwise
from pathlib import Path
from typing import Any

import html5lib
import pytest

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.errors import NotFoundError
from wsgen.model.behavior import BehaviorOutcome, Drive, LaunchTask, Reach, Task, TimeSeries
from wsgen.model.outcome import (
    EngineOutcome,
    NotValidated,
    Outcome,
    PackageOutcome,
    Rest,
    RobotOutcome,
    SceneView,
    Simulated,
    ViewPart,
)
from wsgen.model.plan import Include, LaunchArgument, LaunchPlan, Process, Unresolved
from wsgen.model.robot import Box, Inertial, Joint, JointLimit, JointType, Link, Robot, Visual
from wsgen.model.transform import Pose
from wsgen.model.world import World
from wsgen.reporting import page_data
from wsgen.reporting.html_report import mark_code, render_page
from wsgen.reporting.page_data import LEVELS, Packer, pack_package, require_plotly
from wsgen.text.printable import clean

HOSTILE = "</script><script>alert(1)</script><!-- \"q\" 'a' &amp; \x00\x07\x7f \udce9 \u202e <b>ü漢"
SHOWN = HOSTILE.translate({0: "␀", 7: "␇", 0x7F: "␡", 0xDCE9: "\ufffd", 0x202E: "\ufffd"})
WHEN = datetime(2026, 11, 22, 12, 0, tzinfo=timezone.utc)
HTML = "{http://www.w3.org/1999/xhtml}"

SERIES = TimeSeries(
    seconds=(0.0, 1.0, 2.0),
    positions=((0.0, 0.0, 0.5), (0.1, 0.0, 0.25), (0.2, 0.0, 0.3)),
    speeds=(0.0, 1.0, 0.25),
    tilts=(0.0, 0.5, math.pi / 2),
    joint_positions={HOSTILE: (0.0, 0.1, 0.2), "lift": (0.0, -0.05, 0.01)},
)
DESCRIPTION = Robot(
    name="r",
    root="base",
    links=(
        Link(
            name="base",
            inertial=Inertial(mass=2.0, inertia=(0.1, 0, 0, 0.2, 0, 0.3)),
            visuals=(Visual(geometry=Box(size=(1, 1, 1))), Visual(geometry=Box(size=(1, 1, 1)))),
        ),
        Link(name=HOSTILE),
        Link(name="fork"),
    ),
    joints=(
        Joint(
            name=HOSTILE,
            type=JointType.REVOLUTE,
            parent="base",
            child=HOSTILE,
            limit=JointLimit(lower=-1.0, upper=math.inf, effort=5.0, velocity=1.0),
        ),
        Joint(name="lift", type=JointType.PRISMATIC, parent="base", child="fork"),
    ),
)
BEHAVIORS = (
    BehaviorOutcome(
        name=HOSTILE,
        task=Drive(linear=0.5, x=1.0, yaw=0.0),
        passed=True,
        moved=(0.98, 0.0, math.inf),
    ),
    BehaviorOutcome(
        name="reach", task=Reach(positions={HOSTILE: 0.5}), passed=False, positions={HOSTILE: 0.1}
    ),
)
ROBOT = RobotOutcome(
    entity=HOSTILE,
    spawn_pose=Pose((0.0, 0.0, 1.0)),
    links=3,
    joints=2,
    movable_joints=2,
    mass=math.inf,
    engines=(
        EngineOutcome(
            engine="bullet",
            simulated=Simulated(engine="bullet", links=3, movable_joints=2, mass=2.0),
            rest=Rest(
                pose_in_world=Pose((0.0, math.nan, 0.3)),
                settled_after=0.5,
                speed=0.0,
                joint_positions={HOSTILE: 0.2, "lift": 0.01},
            ),
            behaviors=BEHAVIORS,
            passed=True,
            time_series=(SERIES, replace(SERIES, behavior=HOSTILE)),
        ),
        EngineOutcome(engine="dart", behaviors=BEHAVIORS[:1]),
    ),
    behaviors=BEHAVIORS,
    description=DESCRIPTION,
)
PART = ViewPart(
    entity=HOSTILE,
    link=HOSTILE,
    rgba=(1.0, 0.5, 0.0, 1.0),
    low=(0.0, 0.0, 0.0),
    step=(1e-5, 1e-5, 1e-5),
    corners=base64.b64encode(array("H", range(9)).tobytes()).decode(),
    triangles=base64.b64encode(array("H", (0, 1, 2)).tobytes()).decode(),
)
VIEW = SceneView(
    picture="UklGRg==", picture_tile=0.5, parts=(PART,), triangles_before=9, triangles=1
)
PLAN = LaunchPlan(
    package="p",
    launch_file=Path("/s/l.launch.py"),
    arguments=(LaunchArgument(name=HOSTILE, default="a", value=HOSTILE, description=HOSTILE),),
    processes=(
        Process(package=None, executable=None, command=("echo", HOSTILE), name="echo"),
        Process(
            package="a",
            executable="b",
            name="n",
            namespace="/x",
            parameters={HOSTILE: HOSTILE, "robot_description": "<robot/>"},
            remappings=((HOSTILE, "to"),),
            starts="exit of echo",
            file=Path(f"/s/{HOSTILE.replace('/', '')}"),
            line=3,
            description_file=Path("/s/r.urdf"),
        ),
    ),
    includes=(Include(package=None, file=Path("/s/i.launch.py"), arguments={"a": HOSTILE}),),
    environment={HOSTILE: HOSTILE},
    unresolved=(Unresolved(what=HOSTILE, why=HOSTILE, file=Path("/s/x"), line=1),),
)
DIAGNOSTICS = (
    Diagnostic(
        code="SPN059", name="tips-over", severity=Severity.ERROR, message=f"It `tips` {HOSTILE}.",
        file=Path("/w/src") / HOSTILE.replace("/", ""), line=3, element=HOSTILE, hint=HOSTILE,
    ),
    *(
        Diagnostic(
            code="ROB050", name="implausible-inertia", severity=Severity.WARNING,
            message=f"{number}",
        )
        for number in range(5)
    ),
)  # fmt: skip
PACKAGE = PackageOutcome(
    package="p",
    share=Path("/s"),
    launch_file=Path("/s/l.launch.py"),
    world=World(name=HOSTILE, file=Path("/s/w.world")),
    robots=(ROBOT,),
    diagnostics=DIAGNOSTICS,
    plan=PLAN,
    view=VIEW,
    seconds={"launch": 0.5, "simulate": 0.25, "total": 1.0},
)
FAILED = PackageOutcome(
    package="broken", share=None, launch_file=None, diagnostics=DIAGNOSTICS[:1], seconds={}
)
FILE = PackageOutcome(
    package=None,
    file=Path("/w/caf\udce9.world"),
    share=None,
    launch_file=None,
    world=World(name="w", file=Path("/w/caf\udce9.world")),
    view=SceneView(problem="the disk is full"),
)
LEFT = NotValidated(package="q", reason=HOSTILE, robot_files=(Path("/q/q.urdf"),))
EVERYTHING = Outcome(packages=(PACKAGE, FAILED, FILE), not_validated=(LEFT,))


@pytest.fixture(autouse=True)
def _small_library(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A library that takes no time: `test_page_in_chromium.py` has the real one."""
    file = tmp_path / "plotly.min.js"
    file.write_text("/** plotly.js v4.1.1 */ '</script>'")
    monkeypatch.setattr(page_data, "_find", lambda: file)


def page_of(outcome: Outcome) -> str:
    page = render_page(outcome, Path("/w"), when=WHEN)
    page.encode()  # nothing that is no character
    return page


def parse(page: str) -> Any:
    """The tree of a page; fails where it is not valid HTML, by the standard's own parser."""
    return html5lib.HTMLParser(strict=True).parse(page)


def elements(page: str, tag: str) -> list[Any]:
    return list(parse(page).iter(f"{HTML}{tag}"))


def text_of(page: str) -> str:
    root = parse(page)
    for script in [*root.iter(f"{HTML}script"), *root.iter(f"{HTML}style")]:
        script.text = ""
    return " ".join("".join(root.itertext()).split())


def header_of(packed: str) -> tuple[dict[str, Any], bytes]:
    data = gzip.decompress(base64.b64decode(packed))
    length = int.from_bytes(data[:4], "little")
    return json.loads(data[4 : 4 + length]), data[4 + length :]


OUTCOMES = {
    "everything": EVERYTHING,
    "one package": Outcome(packages=(PACKAGE,)),
    "a package that fails": Outcome(packages=(FAILED,)),
    "a file": Outcome(packages=(FILE,)),
    "no robot": Outcome(packages=(), not_validated=(LEFT,)),
    "interrupted": Outcome(packages=(PACKAGE,), is_complete=False),
    "interrupted at once": Outcome(packages=(), is_complete=False),
}


@pytest.mark.parametrize("name", OUTCOMES)
def test_it_is_valid_html(name: str) -> None:
    page = page_of(OUTCOMES[name])
    assert page.startswith("<!DOCTYPE html>\n")
    root = parse(page)
    every = list(root.iter())
    ids = [one.get("id") for one in every if one.get("id")]
    assert len(ids) == len(set(ids))
    for one in every:
        for attribute in ("aria-labelledby", "popovertarget", "for"):
            assert one.get(attribute, ids[0]) in ids
        link = one.get("href", "data:")
        assert link.startswith("data:") or link.removeprefix("#") in ids
    assert root.get("lang") == "en"
    assert root.find(f".//{HTML}title").text
    levels = [int(one.tag[-1]) for one in every if re.fullmatch(rf"{HTML}h[1-6]", str(one.tag))]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))
    for heading in root.iter(f"{HTML}th"):
        assert heading.get("scope") in {"col", "row"}
    for image in root.iter(f"{HTML}img"):
        assert image.get("alt")


@pytest.mark.slow
def test_what_users_write_is_text() -> None:
    page = page_of(EVERYTHING)
    scripts = elements(page, "script")
    assert [one.get("type") for one in scripts] == [*["application/octet-stream"] * 2, None]
    assert not elements(page, "b")
    assert "alert(1)" not in "".join(one.text for one in scripts)
    text = text_of(page)
    assert text.count(" ".join(SHOWN.split())) > 20
    assert "caf\ufffd.world" in text


def test_characters_that_cannot_be_shown() -> None:
    assert clean("a\tb\nc\x1b[31m \x85\ufdd0\U0001ffff ü") == "a\tb\nc␛[31m \ufffd\ufffd\ufffd ü"
    assert mark_code("<i> `a<b` `\x00`") == "&lt;i&gt; <code>a&lt;b</code> <code>␀</code>"


@pytest.mark.slow
def test_nothing_is_loaded_from_anywhere() -> None:
    page = page_of(EVERYTHING)
    for one in parse(page).iter():
        for attribute in ("src", "href", "srcset", "action", "poster"):
            assert one.get(attribute, "data:").startswith(("data:", "#"))
    policy = next(
        one.get("content")
        for one in elements(page, "meta")
        if one.get("http-equiv") == "Content-Security-Policy"
    )
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe-eval" not in policy
    assert "http" not in policy


@pytest.mark.slow
def test_it_says_everything() -> None:
    text = text_of(page_of(EVERYTHING))
    for said in (
        "2 failed 1 of 3 passed",
        "2 errors 5 warnings",
        "stands after 0.5 s",
        "not simulated",
        "drive at 0.50 m/s, 0.00 rad/s",
        "1.00 m ahead, turned by 0.00 rad",
        "0.98 m ahead, 0.00 m to the left, turned by inf rad",
        "from 0.500 to 0.300 m, lowest 0.250",
        "from 0.0 to 90.0 degrees",
        "3 links of",
        "2 boxes",
        "on exit of echo",
        "8 characters from /s/r.urdf",
        "2 more of implausible-inertia",
        "evaluate launch files",
        "A square of the ground is 0.5 m. The 3D view is simplified: 1 of 9 triangles.",
        "Cannot draw it: the disk is full.",
        "validate its files by themselves: /q/q.urdf",
        "Why this is bad",  # of a rule
        "plotly.js",
        "2026-11-22 12:00",
    ):
        assert said in text, said


def test_what_passed_and_does_not_stand_is_not_green() -> None:
    (engine, _) = ROBOT.engines
    assert engine.rest is not None
    moving = replace(engine, rest=replace(engine.rest, settled_after=None))
    failed = replace(engine, passed=False)
    robot = replace(ROBOT, engines=(engine, moving, failed))
    page = page_of(Outcome(packages=(replace(PACKAGE, robots=(robot,)),)))
    tones = {one.text: one.get("class") for one in elements(page, "dd") if "class" in one.attrib}
    assert tones == {"stands after 0.5 s": "good", "did not settle": "mild", "fails": "bad"}


@pytest.mark.slow
def test_an_interrupted_run_says_so() -> None:
    assert "Interrupted. Only what is listed here was checked." in text_of(
        page_of(OUTCOMES["interrupted"])
    )


def test_a_page_without_plots_has_no_library(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    monkeypatch.setattr(page_data, "find_spec", lambda _: None)
    assert len(page_of(Outcome(packages=(FAILED,)))) < 100_000
    with pytest.raises(NotFoundError) as caught:
        require_plotly()
    assert "pip install 'wsgen[report]'" in (caught.value.hint or "")


def test_the_numbers_of_plots_and_views() -> None:
    packed = pack_package(PACKAGE, clean)
    assert packed is not None
    header, data = header_of(packed)
    (robot,) = header["robots"]
    assert robot["entity"] == SHOWN
    standing, behaving = robot["series"]
    assert (standing["engine"], standing["behavior"]) == ("bullet", None)
    assert behaving["behavior"] == SHOWN

    def column(one: dict[str, Any]) -> list[float]:
        return column_of(one, data)

    assert column(standing["height"]) == pytest.approx([0.5, 0.25, 0.3], abs=1e-4)
    assert column(standing["tilt"]) == pytest.approx([0.0, math.degrees(0.5), 90.0], abs=1e-2)
    assert column(standing["y"]) == [0.0, 0.0, 0.0]
    joints = {joint["name"]: joint for joint in standing["joints"]}
    assert [joint["slides"] for joint in joints.values()] == [False, True]  # most moved first
    assert column(joints["lift"]) == pytest.approx([0.0, -0.05, 0.01], abs=1e-5)
    (part,) = header["view"]["parts"]
    corners = data[part["corners"]["at"] :][: 2 * part["corners"]["n"]]
    assert list(array("H", corners)) == list(range(9))
    assert part["triangles"]["n"] == 3


def column_of(one: dict[str, Any], data: bytes) -> list[float]:
    levels = array("H", data[one["at"] : one["at"] + 2 * one["n"]])
    return [one["low"] + one["step"] * level for level in levels]


@pytest.mark.parametrize(
    ("task", "x", "y"),
    [
        (Drive(x=2.0, y=1.0), (5.78, 6.22), (7.78, 8.22)),
        (LaunchTask(x=2.0, y=1.0), (5.78, 6.22), (7.78, 8.22)),
        (LaunchTask(y=1.0), (5.9, 6.1), (5.9, 9.1)),  # as far as the way, which is 3 m
    ],
)
def test_the_area_in_which_a_behavior_has_to_end_is_seen_from_its_start(
    task: Task, x: tuple[float, float], y: tuple[float, float]
) -> None:
    """The robot begins at (7, 6) and looks along y: ahead is y, to the left is -x."""
    series = TimeSeries(
        behavior="goes",
        seconds=(-0.5, 1.0),
        positions=((7.0, 6.0, 0.0), (7.0, 9.0, 0.0)),
        heading=math.pi / 2,
        speeds=(0.0, 1.0),
        tilts=(0.0, 0.0),
        joint_positions={},
    )
    robot = replace(
        ROBOT,
        engines=(replace(ROBOT.engines[0], time_series=(series,)),),
        behaviors=(BehaviorOutcome(name="goes", task=task, passed=False),),
    )
    packed = pack_package(replace(PACKAGE, robots=(robot,)), clean)
    assert packed is not None
    header, data = header_of(packed)
    ((goal,),) = ([one["goal"] for one in robot["series"]] for robot in header["robots"])
    for axis, (low, high) in (("x", x), ("y", y)):
        corners = column_of(goal[axis], data)
        assert len(corners) == 5
        assert (min(corners), max(corners)) == pytest.approx((low, high), abs=0.005)


@pytest.mark.slow
def test_of_a_behavior_that_fails_the_page_shows_motion_and_what_was_printed() -> None:
    failed = BehaviorOutcome(
        name=HOSTILE, task=LaunchTask(travels=1.0), passed=False, seconds=2.5, printed=(HOSTILE,)
    )
    robot = replace(
        ROBOT, engines=(replace(ROBOT.engines[0], behaviors=(failed,)),), behaviors=(failed,)
    )
    page = parse(page_of(Outcome(packages=(replace(PACKAGE, robots=(robot,)),))))
    (option,) = [one for one in page.iter(f"{HTML}option") if one.get("selected") is not None]
    assert "".join(option.itertext()) == SHOWN
    (printed,) = page.iterfind(f".//{HTML}details[@class='printed']")
    assert SHOWN in "".join(printed.itertext())
    good = (replace(failed, passed=True, printed=()),)
    passed = replace(robot, engines=(replace(robot.engines[0], behaviors=good),), behaviors=good)
    page = parse(page_of(Outcome(packages=(replace(PACKAGE, robots=(passed,)),))))
    (option,) = [one for one in page.iter(f"{HTML}option") if one.get("selected") is not None]
    assert "".join(option.itertext()) == "the simulation"
    assert page.find(f".//{HTML}details[@class='printed']") is None


def test_nothing_to_plot_is_no_data() -> None:
    assert pack_package(FAILED, clean) is None


@pytest.mark.slow
def test_a_video_becomes_a_part_of_the_page(tmp_path: Path) -> None:
    for name, tag in (("video.gif", "img"), ("video.mp4", "video")):
        (tmp_path / name).write_bytes(b"1234")
        page = page_of(Outcome(packages=(replace(FAILED, video=tmp_path / name),)))
        (shown,) = elements(page, tag)
        assert shown.get("src").endswith(";base64,MTIzNA==")
    gone = Outcome(packages=(replace(FAILED, video=tmp_path / "gone.gif"),))
    assert not elements(page_of(gone), "img")


@pytest.mark.parametrize("high", [5e-324, 70_000 * 5e-324, 98_000 * 5e-324, 1e-300, 1e300])
def test_every_column_of_numbers_is_packed(high: float) -> None:
    one = Packer().column([0.0, high])
    assert one["n"] == 2
    assert one["low"] + one["step"] * LEVELS >= high * (1 - 1e-9) or high < 1e-300
