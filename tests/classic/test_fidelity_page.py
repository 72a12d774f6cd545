"""The tables of docs/fidelity.md are what the tests of this folder hold against Gazebo Classic."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from classic import (
    description_cases,
    test_cameras,
    test_classic_robots,
    test_descriptions,
    test_drives,
    test_joints,
    test_rest_poses,
    test_surfaces,
)
from classic.joint_cases import CASES
from classic.still_lifes import STILL_LIFES
from classic.test_commands import COMMANDS
from classic.worlds import ENGINES, SURFACES
from wsgen.checks.rules.settings import SETTINGS

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

PAGE = Path(__file__).parents[2] / "docs" / "fidelity.md"
RECORDED = Path(__file__).with_name("recorded")
NAMES = {"bullet": "PyBullet", "mujoco": "MuJoCo", "dart": "DART"}
BEGIN, END = "<!-- measured -->\n", "<!-- end of what is measured -->\n"
Different = dict[str, tuple[tuple[str, ...], str]]  # a case: the engines that differ, and why


def test_the_page_is_what_is_measured(*, regenerate: bool) -> None:
    page = PAGE.read_text(encoding="utf-8")
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    written = f"{before}{BEGIN}{measured()}{END}{after}"
    if regenerate:
        PAGE.write_text(written, encoding="utf-8")
    assert page == written


def measured() -> str:
    """The table of what is equal, and the lists of what is not."""
    robots = read("../robots.json")
    loaded = [name for name, one in robots.items() if "links" in one]
    surfaces = {case: (engines, why) for case, (why, engines) in test_surfaces.DIFFERENT.items()}
    joints: Different = {}
    for (case, engine), why in test_joints.DIFFERENT.items():
        engines, _ = joints.get(case, ((), ""))
        joints[case] = ((*engines, engine) if engine else tuple(NAMES), why)
    rest = {
        case: (tuple(NAMES) if engines == ENGINES else tuple(engines), why)
        for case, (engines, why) in test_rest_poses.DIFFERENT.items()
    }
    determined = {name for name, one in read("rest_poses.json").items() if "up" in one}
    cases = len(description_cases.CASES)
    others = test_descriptions.REFUSED | test_descriptions.OTHERWISE
    alike = cases - len(others)
    lines = [
        "| accepted or refused; links, joints, masses | cases | equal | test |",
        "|---|---|---|---|",
        f"| small URDFs and worlds, a mistake each | {cases} | {alike} | `test_descriptions.py` |",
        f"| robots of PyPI | {len(loaded)} | {len(loaded)} | `test_classic_robots.py` |",
        "",
        "| what | cases | PyBullet | MuJoCo | DART | test |",
        "|---|---|---|---|---|---|",
        row(
            "what slides, falls and bounces, within 0.5 % of its way",
            SURFACES,
            equal(SURFACES, surfaces),
            "surfaces",
        ),
        row(
            "worlds of our own at rest after 3 s, within 1 mm and 0.1 degrees",
            STILL_LIFES,
            equal(STILL_LIFES, rest),
            "rest_poses",
        ),
        row(
            "robots of PyPI that rest alike from five starts there, as above",
            determined,
            equal(determined, rest),
            "rest_poses",
        ),
        row(
            "joints for 3 s, within 2 % of the farthest they move",
            CASES,
            equal(CASES, joints),
            "joints",
        ),
        row("joints that `gz joint` commands", COMMANDS, equal(COMMANDS, {}), "commands"),
        row(
            "robots that drive ahead, turn and drive a curve, all within 2 %",
            {name for name, _ in test_drives.RUNS},
            [driven(engine) for engine in NAMES],
            "drives",
        ),
    ]
    losing = test_classic_robots.LOSING
    lost = [
        f"- {listed(name for name, codes in losing.items() if code in codes)}: {what}."
        for code, what in test_classic_robots.LOST.items()
    ]
    nothing = [f"- {listed(names)}: {why}." for why, names in test_classic_robots.NOTHING.values()]
    refused = [f"- `{case}`: {why.partition(': ')[2]}." for case, why in others.items()]
    page = "\n".join((
        *lines,
        "",
        "What Gazebo Classic loses of robots of PyPI is lost here, too, and an error:",
        "",
        *lost,
        "",
        "It loads these, and simulates nothing of them; here they are refused:",
        "",
        *nothing,
        "",
        "What is not equal, and why. What is loaded there, and refused here but for the last:",
        "",
        *refused,
        "",
        "Surfaces, rest and joints:",
        "",
        *reasons(surfaces | rest | joints),
        "",
        "Settings that not every engine follows; a run for Gazebo Classic names those that it has:",
        "",
        "| setting | there | followed by | named |",
        "|---|---|---|---|",
        *(
            f"| {one.elements} | {one.in_gazebo} |"
            f" {listed_engines(one.followed_by) or 'none'} | {one.matters or 'always'} |"
            for one in SETTINGS
        ),
        "",
        "Driving, and by how much a turn or the way in a curve differs at most:",
        "",
        *(
            f"- `{case}`{f' in {NAMES[engine]}' if engine else ''}, {100 * bound:g} %: {why}."
            for (case, engine), (bound, why) in test_drives.LEFT.items()
        ),
        "",
        "What cameras see in another color, by the name or the element of what it is painted with:",
        "",
        *(
            f"- {listed([paint for paint, its in test_cameras.DIFFERENT.items() if its == why])}:"
            f" {why}."
            for why in dict.fromkeys(test_cameras.DIFFERENT.values())
        ),
        "",
    ))  # fmt: skip
    return re.sub(r"(?<!`)<\w+>", r"`\g<0>`", page)


def read(name: str) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((RECORDED / name).read_text(encoding="utf-8"))
    return found


def row(what: str, cases: Collection[str], equal: Iterable[str], test: str) -> str:
    return f"| {what} | {len(cases)} | {' | '.join(equal)} | `test_{test}.py` |"


def equal(cases: Collection[str], different: Mapping[str, tuple[Iterable[str], str]]) -> list[str]:
    """For each engine, how many of the cases are as there."""
    others = [{*engines} for case, (engines, _) in different.items() if case in cases]
    return [str(len(cases) - sum(name in one for one in others)) for name in NAMES]


def driven(engine: str) -> str:
    """How many of those that the engine drives are as there."""
    names = [name for name, its_engine in test_drives.RUNS if its_engine == engine]
    left = test_drives.LEFT
    same = [name for name in names if (name, "") not in left and (name, engine) not in left]
    return f"{len(same)} of {len(names)}"


def reasons(different: Different) -> list[str]:
    """A line for each reason, with the cases that it holds for and the engines that differ."""
    grouped: dict[tuple[tuple[str, ...], str], list[str]] = {}
    for case, reason in different.items():
        grouped.setdefault(reason, []).append(case)
    return [
        f"- {listed(cases)}"
        f"{'' if {*engines} == {*NAMES} else f' in {listed_engines(engines)}'}: {why}."
        for (engines, why), cases in grouped.items()
    ]


def listed(cases: Iterable[str]) -> str:
    return "; ".join(f"`{one}`" for one in cases)


def listed_engines(engines: Iterable[str]) -> str:
    return " and ".join(NAMES[one] for one in engines)
