"""Public robots from PyPI, against what Gazebo's own parser makes of them.

The oracle is `ign sdf` of Debian (ignition-tools, libsdformat12 12.3.0). Everything that is known
to differ is written down here, with the reason; what no longer differs fails the test, too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
import xacro

from gazebo_oracle import IGN, differences, is_taken, model_of
from public_robots import CUT, MANY_PARTS, REFUSED, ROBOTS, find_robot
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from pathlib import Path


SINCE_1238 = (
    "a lumped link without mass no longer cuts off its children (sdformat's pull request 1238, "
    "March 2023, in 12.7.2, 13.5 and 14.0); the oracle is older"
)
NO_EXTENT = (
    "shapes with a size of 0: Gazebo's parser takes them, its engine (DART) ends the program on "
    "them; they are left out with an error, visuals with a warning"
)
ONE_SPACE_OF_NAMES = (
    "a joint and a link of one name: Gazebo Sim refuses the robot; nobody knows which simulator a "
    "bare file is for, and so ROB034 is a warning that names it"
)
# Robot -> the kinds of differences, how many there are, and why.
DIFFERENT = {
    "icub": ({"link": 8, "joint": 8, "mass": 1}, SINCE_1238),
    "icubgenova03": ({"link": 8, "joint": 8, "mass": 1}, SINCE_1238),
    "icubnancy01": ({"link": 8, "joint": 8, "mass": 1}, SINCE_1238),
    "upkie": ({"number of visuals": 5}, NO_EXTENT),
}
# Gazebo's answer is not followed, for the reason.
NOT_REFUSED = {"so100": ONE_SPACE_OF_NAMES}

pytestmark = [
    pytest.mark.oracle,
    pytest.mark.skipif(
        IGN is None, reason="ign (Debian: ignition-tools, libsdformat12) is missing"
    ),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("distribution", "path", "name"),
    [
        pytest.param(*one, marks=[pytest.mark.thorough] if one[2] in MANY_PARTS else [], id=one[2])
        for one in ROBOTS
    ],
)
def test_same_as_in_gazebo(distribution: str, path: str, name: str, tmp_path: Path) -> None:
    file = find_robot(distribution, path)
    if file is None:
        pytest.skip(f"{distribution} is not installed")
    text = file.read_text(encoding="utf-8")
    if "xmlns:xacro" in text and "$(" in text:  # as `wsgen validate FILE` does
        text = xacro.process_file(str(file)).toxml()
        file = tmp_path / file.name
        file.write_text(text, encoding="utf-8")
    robot, found = read_urdf(text, file=file)
    unlike: dict[str, int] = {}
    if robot is not None:
        lumped, dropped = lump(robot, file=file)
        found += dropped
        model = model_of(file, tmp_path)
        for difference in [] if model is None else differences(lumped, model):
            kind = difference.partition(":")[0]
            unlike[kind] = unlike.get(kind, 0) + 1
    errors = {diagnostic.code for diagnostic in found if diagnostic.severity is Severity.ERROR}
    if name in NOT_REFUSED:
        assert not is_taken(file, tmp_path)
        assert errors == set()
    elif name in REFUSED:
        assert not is_taken(file, tmp_path)
        assert errors == REFUSED[name]
    else:
        assert is_taken(file, tmp_path)
        assert errors == CUT.get(name, set())
    assert unlike == DIFFERENT.get(name, ({}, ""))[0]


def test_the_tables_are_about_robots_in_the_list() -> None:
    names = [name for _, _, name in ROBOTS]
    assert len(set(names)) == len(names) >= 60
    assert set(names) >= {*REFUSED, *CUT, *DIFFERENT, *NOT_REFUSED}
    assert all(reason for _, reason in DIFFERENT.values())
