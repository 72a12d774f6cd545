"""`wsgen validate --engine gazebo` with the real Gazebo Classic on the PATH."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from typing import TYPE_CHECKING, Any

import pytest

from classic.gazebo_classic import NEEDS_CLASSIC
from gazebo_on_path import put_on_path
from urdf_texts import joint, link, robot, shape

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [
    pytest.mark.oracle,
    pytest.mark.slow,
    NEEDS_CLASSIC,
]
INERTIAL = (
    '<inertial><mass value="{}"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
BODY = INERTIAL.format(2)
BOX = '<box size="{}0.4 0.4 0.2"/>'
AXIS = '<axis xyz="0 0 1"/>'
CASES = {
    # It has no link `world`: what is seen from the root is seen from the model.
    "bolted": link("world", "")
    + link("base", BODY + shape("collision", BOX.format("")))
    + joint("foot", "world", "base", '<origin xyz="0 0 1"/>')
    + link("turret", BODY)
    + joint("turn", "base", "turret", AXIS, "continuous"),
    "without limit": link("base", BODY)
    + link("b", BODY)
    + joint("j", "base", "b", AXIS, "revolute"),
    "negative mass": link("base", INERTIAL.format(-1) + shape("collision", BOX.format(""))),
    "negative box": link("base", BODY + shape("collision", BOX.format("-"))),
    "nothing but a root without mass": link("base", ""),
}


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    programs = put_on_path(tmp_path_factory.mktemp("gazebo"))
    return {**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}


def wsgen(folder: Path, environment: dict[str, str], *words: str) -> str:
    command = [sys.executable, "-m", "wsgen", *words]
    done = subprocess.run(
        command, cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    assert "Traceback" not in done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def packages(environment: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Any:
    """What is said of each case, by its name."""
    folder = tmp_path_factory.mktemp("robots")
    files = []
    for name, text in CASES.items():
        files.append(f"{name}.urdf")
        (folder / files[-1]).write_text(robot(text))
    words = ("--engine", "gazebo", "-j", "2", "--format", "json")
    document = json.loads(wsgen(folder, environment, "validate", *files, *words))
    return dict(zip(CASES, document["packages"], strict=True))


def in_gazebo(package: dict[str, Any]) -> dict[str, Any]:
    bullet, gazebo = package["robots"][0]["engines"]
    assert (bullet["engine"], gazebo["engine"]) == ("bullet", "gazebo")
    return dict(gazebo)


def message(package: dict[str, Any], code: str) -> str:
    (found,) = (one for one in package["diagnostics"] if one["code"] == code)
    return str(found["message"])


def test_the_robot_of_the_tutorial(environment: dict[str, str], tmp_path: Path) -> None:
    person = ("--maintainer-name", "A", "--maintainer-email", "a@b.cd")
    wsgen(tmp_path, environment, "new", "rover", "--distro", "iron", *person)
    (workspace,) = (one for one in tmp_path.iterdir() if (one / "src").is_dir())
    words = ("--engine", "gazebo", "--format", "json")
    (package,) = json.loads(wsgen(workspace, environment, "validate", *words))["packages"]
    gazebo = in_gazebo(package)
    assert package["passed"]
    assert (gazebo["passed"], gazebo["version"]) == (True, "11.1.0")
    assert gazebo["rest"]["xyz"] == pytest.approx([0.0, 0.0, 0.25], abs=1e-3)
    assert "SPN065" not in {one["code"] for one in package["diagnostics"]}


def test_one_that_is_bolted_to_the_world(packages: Any) -> None:
    gazebo = in_gazebo(packages["bolted"])
    assert gazebo["passed"]
    assert gazebo["rest"]["joint_positions"] == {"turn": pytest.approx(0.0, abs=0.01)}
    assert "SPN065" not in {one["code"] for one in packages["bolted"]["diagnostics"]}


def test_one_that_it_refuses(packages: Any) -> None:
    package = packages["without limit"]
    said = message(package, "SPN032")
    assert said.startswith("Gazebo Classic 11.1.0 does not spawn `r`: ")
    assert "Joint [j] is of type REVOLUTE but it does not specify limits" in said
    assert (in_gazebo(package)["passed"], in_gazebo(package)["rest"]) == (False, None)


def test_one_of_which_nothing_is_left(packages: Any) -> None:
    assert "no link" in message(packages["nothing but a root without mass"], "SPN032")


def test_one_that_it_loads_half_and_may_crash_of(packages: Any) -> None:
    package = packages["negative mass"]
    found = [one for one in package["diagnostics"] if one["code"] in {"SPN031", "SPN032"}]
    (said,) = (one["message"] for one in found)
    assert "Setting custom link r::basemass to zero" in said
    assert not in_gazebo(package)["passed"]
    assert "SPN050" not in {one["code"] for one in package["diagnostics"]}


def test_one_that_wsgen_refuses_and_it_takes(packages: Any) -> None:
    package = packages["negative box"]
    assert not package["passed"]
    assert package["robots"][0]["rest"] is None
    gazebo = in_gazebo(package)
    assert gazebo["passed"]
    assert gazebo["rest"]["xyz"][2] == pytest.approx(0.1, abs=1e-3)
