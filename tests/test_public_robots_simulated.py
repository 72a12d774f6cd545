"""The results for robots that other people have published, and the table of docs/robots.md.

Every error is listed with its reason; a new error, and one that no longer occurs, fail the test.
`--regenerate` writes the table.
"""

from __future__ import annotations

import functools
import json
import math
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from public_robots import CUT, MANY_PARTS, REFUSED, ROBOTS, find_robot
from wsgen.simulation.run import missing_engines

PAGE = Path(__file__).parents[1] / "docs" / "robots.md"

# Why an error of the description is right: what Gazebo does with such a robot.
WHY = {
    "ROB001": "the file is not well-formed XML",
    "ROB004": "Gazebo refuses a robot without a name",
    "ROB005": "the robot has no link",
    "ROB015": "URDF does not have this joint type",
    "ROB016": "Gazebo's parser refuses the number, or drops the element",
    "ROB024": "Gazebo does not know this shape in a URDF",
    "ROB151": "the physics engine of Gazebo Sim terminates on a mirrored collision mesh",
    "ROB037": "Gazebo refuses the inertia (Error 18)",
    "ROB040": "a link has no mass: Gazebo refuses the robot, or drops the link and all below it",
    "ROB041": "Gazebo computes a center of mass as 0/0 and refuses the robot",
}
# What only the simulation shows, and why it is right.
NO_COLLISION = {"ROB053"}, "it has no <collision> and falls through the ground, as in Gazebo"
NOT_BOLTED = {"SPN059"}, "it is not joined to a link `world` and falls over, as in Gazebo"
NO_MESHES = {"ROB060"}, "the package does not contain the meshes of the file"
IN_THE_SIMULATION = {
    "alexander_v1_lowerbodyonly": NO_COLLISION,
    "al5d_robot": NO_COLLISION,
    "double_pendulum": NOT_BOLTED,
    "double_pendulum_continuous": NOT_BOLTED,
    "talos_full_v2": NO_MESHES,
    "irb140": NO_MESHES,
    "kr120r2500pro": NO_MESHES,
    "kr210l150": NO_MESHES,
    "lbr_iiwa_14_r820": NO_MESHES,
}

HEAD = """\
# Published robots

Results of `wsgen validate FILE` for robots that other people have published on PyPI, each spawned
just above the ground of an empty world, in PyBullet, without a controller. Below the table is the
reason for every error. `pytest tests/test_public_robots_simulated.py --regenerate` writes this
page; a test compares what does not depend on the machine, for all with `--thorough`.

"Settled after" is the time when the robot stands still; "passive" means that gravity moved its
unactuated joints, "-" that it was not simulated. z is the final height of the root link. Errors are
bold; [rules.md](rules.md) lists the codes.

| robot | from | links | joints | kg | settled after | z, m | seconds | diagnostics |
|---|---|---|---|---|---|---|---|---|
"""

pytestmark = [pytest.mark.slow, pytest.mark.oracle]


@functools.cache
def check(engine: str, *, thorough: bool) -> dict[str, dict[str, Any]]:
    """What wsgen says, by the short name of the robot."""
    files = {
        name: file
        for package, path, name in ROBOTS
        if (file := find_robot(package, path)) and (thorough or name not in MANY_PARTS)
    }
    if not files:
        pytest.skip("the packages with robots are not installed")
    if missing_engines([engine]):
        pytest.skip(f"{engine} is not installed")
    done = subprocess.run(
        [
            *(sys.executable, "-m", "wsgen", "validate", "-q", "--format", "json"),
            *("--engine", engine),
            *("-j", str(os.cpu_count() or 1), *map(str, files.values())),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode in {0, 1}, done.stderr
    return dict(zip(files, json.loads(done.stdout)["packages"], strict=True))


def codes(package: dict[str, Any], severity: str) -> set[str]:
    return {found["code"] for found in package["diagnostics"] if found["severity"] == severity}


def test_every_error_has_its_reason_and_the_page_says_so(
    *, regenerate: bool, thorough: bool
) -> None:
    """One test, because one run of wsgen checks them all."""
    checked = check("bullet", thorough=thorough or regenerate)
    errors = {name: codes(package, "error") for name, package in checked.items()}
    expected = {name: expected_errors(name) for name in checked}
    wrong = {name: found for name, found in errors.items() if found != expected[name]}
    assert wrong == {}
    assert all(checked[name]["passed"] == (not errors[name]) for name in checked)
    names = {name for _, _, name in ROBOTS}
    if not names - MANY_PARTS <= checked.keys():
        pytest.skip("packages with robots are not installed: the page is not compared")
    left_out = names - checked.keys()
    assert all(expected_errors(name) == set() for name in left_out)  # or the page names reasons
    rows = [row(package, name, checked[name]) for package, _, name in ROBOTS if name in checked]
    reasons = [f"- {name}: {reason(name)}." for _, _, name in ROBOTS if errors.get(name)]
    text = HEAD + "\n".join(rows) + "\n\n## Errors\n\n" + "\n".join(reasons) + "\n"
    if regenerate:
        PAGE.write_text(text, encoding="utf-8")
    page = PAGE.read_text(encoding="utf-8").splitlines(keepends=True)
    compared = [line for line in page if not line.startswith(tuple(f"| {n} |" for n in left_out))]
    assert len(page) - len(compared) == len(left_out)
    assert what_must_hold("".join(compared)) == what_must_hold(text)


# How far apart robots may rest whose joints nothing moves: PyBullet's stand 0.01 mm too low.
SAME_HEIGHT = 0.0002  # m
SAME_TILT = math.radians(0.1)
# The one leans by a fraction of a degree, another one in each engine; the other stands on a hand
# whose wrist is held by friction alone.
LEANING = {"minitaur", "talos_left_arm"}


@pytest.mark.thorough
def test_mujoco_makes_the_same_of_them(*, thorough: bool) -> None:
    bullet, mujoco = (check(engine, thorough=thorough) for engine in ("bullet", "mujoco"))
    compared = rested = 0
    for name, package in mujoco.items():
        assert codes(package, "error") == codes(bullet[name], "error"), name
        for one, other in zip(package["robots"], bullet[name]["robots"], strict=True):
            if other["simulated"] is None:
                assert one["simulated"] is None, name
                continue
            compared += 1
            for count in ("links", "movable_joints"):
                assert one["simulated"][count] == other["simulated"][count], name
            mass = other["simulated"]["mass"]
            assert one["simulated"]["mass"] == pytest.approx(mass, rel=1e-6), name
            if name not in LEANING and all(map(stands, (package, bullet[name]))):
                rested += 1
                height = other["rest"]["xyz"][2]
                assert one["rest"]["xyz"][2] == pytest.approx(height, abs=SAME_HEIGHT), name
                assert one["rest"]["tilt"] == pytest.approx(other["rest"]["tilt"], abs=SAME_TILT)
    if len(bullet) >= len(ROBOTS) - len(MANY_PARTS):
        assert (compared, rested) > (50, 10)


def stands(package: dict[str, Any]) -> bool:
    """Whether the robot comes to rest, and gravity moves none of its joints."""
    rest = package["robots"][0]["rest"]
    return bool(rest and rest["settled_after"] is not None) and "SPN060" not in codes(
        package, "info"
    )


def expected_errors(name: str) -> set[str]:
    prepared = REFUSED.get(name, set()) | CUT.get(name, set())
    return prepared | IN_THE_SIMULATION.get(name, (set(), ""))[0]


def reason(name: str) -> str:
    prepared = sorted(REFUSED.get(name, set()) | CUT.get(name, set()))
    simulated = [IN_THE_SIMULATION[name][1]] if name in IN_THE_SIMULATION else []
    return "; ".join([*(f"{WHY[code]} ({code})" for code in prepared), *simulated])


def row(package: str, name: str, checked: dict[str, Any]) -> str:
    robot = checked["robots"][0] if checked["robots"] else {}
    simulated = robot.get("simulated")
    cells = [name, package]
    if simulated:
        rest = robot["rest"]
        is_passive = "SPN060" in codes(checked, "info")
        settled = rest["settled_after"]
        after = "did not settle" if settled is None else f"{settled:.1f} s"
        cells += [
            str(simulated["links"]),
            str(simulated["movable_joints"]),
            f"{simulated['mass']:.3f}",
            f"{after}, passive" if is_passive else after,
            f"{round(rest['xyz'][2], 2) + 0.0:.2f}" if not is_passive else "",
            f"{checked['seconds']['total']:.1f}",
        ]
    else:
        cells += ["-"] * 6
    found = sorted(codes(checked, "error")), sorted(codes(checked, "warning"))
    cells.append(" ".join([*(f"**{code}**" for code in found[0]), *found[1]]))
    return f"| {' | '.join(cells)} |"


def what_must_hold(page: str) -> list[list[str]]:
    """The page without what differs between machines: times, heights and warnings."""
    lines = []
    for line in page.splitlines():
        cells = line.split(" | ")
        is_row = len(cells) == len(HEAD.splitlines()[-2].split(" | "))
        errors = [word for word in cells[-1].split() if word.startswith("**")]
        lines.append([*cells[:5], *errors] if is_row else [line])
    return lines
