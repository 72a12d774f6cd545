"""What `wsgen check` knows as an error of what a launch file starts, `wsgen validate` fails for."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from planted_examples import PLANTS
from planted_packages import check_all, complete, write
from wsgen.checks.rules.catalogue import all_rules
from wsgen.diagnostics import Severity
from wsgen.packages.workspace.layout import Workspace
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.validate import validate

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

pytestmark = pytest.mark.slow

BY_CODE = {rule.code: rule for rule in all_rules()}
# Between a launch file and what it starts: processes, worlds, bridges, controllers.
CODES = (
    *("LCH040", "LCH067", "LCH071", "LCH072", "LCH073", "LCH074", "LCH078", "LCH088", "LCH089"),
    *("ROB111", "ROB112", "ROB143", "SPN049"),
)
GOOD = "LCH078"  # the package that the others are made of
SLIPS = {  # name of the package -> file, what is right there, what is wrong, the rule
    "wrong_spawner": ("launch/robot.launch.py", "['diff_cont']", "['dif_cont']", "LCH078"),
    "wrong_type": (
        "config/controllers.yaml",
        "JointStateBroadcaster",
        "JointStatBroadcaster",
        "LCH079",
    ),
    "no_controllers": (
        "urdf/my_robot.urdf.xacro",
        "/controllers.yaml",
        "/controler.yaml",
        "ROB110",
    ),
    "build_file": ("CMakeLists.txt", "DESTINATION", "DESTNATION", "BLD071"),
    "not_installed": ("CMakeLists.txt", "urdf", "", "BLD054"),
    "manifest": ("package.xml", "<version>", "<version>v", "PKG005"),
}
# Declared and used, but not released for the target.
OF_IGNITION = ("of_ignition", "PKG070")


def errors(found: Iterable[Diagnostic]) -> set[tuple[str, int | None]]:
    return {(one.code, one.line) for one in found if one.severity is Severity.ERROR}


def test_each_error_of_check_is_one_of_validate(tmp_path: Path) -> None:
    folder = tmp_path / "src"
    for code in CODES:
        write(folder, code.lower(), complete(PLANTS[code].plant(BY_CODE[code].example), "jazzy"))
    good = complete(PLANTS[GOOD].plant(BY_CODE[GOOD].instead, is_good=True), "jazzy")
    write(folder, "good", good)
    for name, (file, right, wrong, _) in SLIPS.items():
        assert right in good[file]
        write(folder, name, {**good, file: good[file].replace(right, wrong)})
    of_ignition = {
        file: text.replace("ros_gz_sim", "ros_ign_gazebo").replace("gz_sim.l", "ign_gazebo.l")
        for file, text in good.items()
    }
    write(folder, "of_ignition", of_ignition)

    checked = check_all(folder, "jazzy")
    outcome = validate(
        Workspace(root=tmp_path),
        ValidateRequest(seconds=0.02, jobs=2),
        environment={"PATH": os.environ["PATH"], "ROS_DISTRO": "jazzy"},
    )
    validated = {one.package: errors(one.diagnostics) for one in outcome.packages}
    missing = {
        name: sorted(errors(found) - validated.get(name, set()))
        for name, found in checked.items()
        if errors(found) - validated.get(name, set())
    }
    assert not missing
    assert errors(checked.get("good", ())) == set()
    assert {code for code, _ in validated["good"]} <= {"SPN058"}  # 0.02 s is too short to settle
    for name, code in (*((name, slip[-1]) for name, slip in SLIPS.items()), OF_IGNITION):
        assert code in {one for one, _ in validated[name]}, name
    found = next(one for one in outcome.packages if one.package == OF_IGNITION[0]).diagnostics
    assert not any("ign_args" in (one.hint or "") for one in found)
    assert not any("<exec_depend>ros_ign_gazebo" in (one.hint or "") for one in found)
