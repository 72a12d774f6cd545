"""Every broken model gets a clear diagnostic, in 10 s and 1 GiB, and never a traceback."""

from __future__ import annotations

import dataclasses
import json
import math
import re
import subprocess
import sys
import time
from enum import Enum
from typing import TYPE_CHECKING

import pytest

from broken_models import HUGE, MODELS, Broken
from urdf_texts import MASS, joint, link, robot
from wsgen.checks.rules.check import check_robot
from wsgen.checks.rules.robots import implausible_mass, implausible_size, number_beyond_engines
from wsgen.descriptions.urdf.lumping import lump
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.diagnostics import Diagnostic, Severity, has_errors

if TYPE_CHECKING:
    from wsgen.model.robot import Robot


pytestmark = pytest.mark.slow

SECONDS = 10  # of CPU time
CHILD = f"""
import resource, sys, json
resource.setrlimit(resource.RLIMIT_AS, (2**30, 2**30))
resource.setrlimit(resource.RLIMIT_CPU, ({SECONDS}, {SECONDS}))
sys.path[:0] = json.loads(sys.argv[2])
from broken_models import HUGE
from test_broken_models import checked
model = HUGE[sys.argv[1]]()
_, found = checked(model.text)
missing = sorted(model.codes.difference(one.code for one in found))
has_errors = any(one.severity.value == "error" for one in found)
print(json.dumps({{"missing": missing, "has the right severity": has_errors == model.is_error}}))
"""


def checked(text: str | bytes) -> tuple[Robot | None, tuple[Diagnostic, ...]]:
    """Everything that is said of a robot before it is tried."""
    written, found = read_urdf(text, file=None)
    if written is None:
        return None, found
    lumped, dropped = lump(written)
    return lumped, (
        *found,
        *dropped,
        *check_robot(written, None),
        *number_beyond_engines(written.links, written.joints, None),
        *implausible_size(written.links, written.joints, None),
        *implausible_mass(written.links, written.joints, None),
    )


def numbers(value: object) -> list[float]:
    """All numbers in a robot."""
    if isinstance(value, float):
        return [value]
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = [getattr(value, field.name) for field in dataclasses.fields(value)]
        return [number for field in fields for number in numbers(field)]
    if isinstance(value, tuple) and not isinstance(value, Enum):
        return [number for part in value for number in numbers(part)]
    return []


@pytest.mark.parametrize("name", MODELS)
def test_clear_diagnostic(name: str) -> None:
    model: Broken = MODELS[name]
    start = time.process_time()
    lumped, found = checked(model.text)
    assert time.process_time() - start < SECONDS
    assert {one.code for one in found} >= model.codes
    assert has_errors(found) == model.is_error
    if not model.codes:
        assert [one for one in found if one.severity is not Severity.INFO] == []
    assert all(one.message and one.hint for one in found)
    if lumped is not None and name != "two masses of 1e308 kg":
        assert all(map(math.isfinite, numbers(lumped)))


@pytest.mark.parametrize("name", HUGE)
def test_huge_robots_in_time_and_memory(name: str) -> None:
    ended = subprocess.run(
        [sys.executable, "-c", CHILD, name, json.dumps([*sys.path, __file__.rpartition("/")[0]])],
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 0, ended.stderr[-2000:]
    assert json.loads(ended.stdout) == {"missing": [], "has the right severity": True}


EVERY_NUMBER = robot(
    '<material name="m"><color rgba="1 0.5 0.5 1"/></material>'
    + link(
        "a",
        MASS.replace("<mass", '<origin xyz="1 2 3" rpy="4 5 6"/><mass')
        + "<visual><origin xyz='1 2 3' rpy='4 5 6'/><geometry><cylinder radius='1' length='2'/>"
        "</geometry></visual><visual><geometry><mesh filename='a.stl' scale='1 2 3'/></geometry>"
        "</visual><collision><geometry><box size='1 2 3'/></geometry></collision>"
        "<collision><geometry><sphere radius='1'/></geometry></collision>",
    )
    + link("b")
    + link("c")
    + joint(
        "j",
        "a",
        "b",
        "<origin xyz='1 2 3' rpy='4 5 6'/><axis xyz='0 0.6 0.8'/>"
        "<limit lower='-1' upper='1' effort='1' velocity='1'/><dynamics damping='1' friction='1'/>"
        "<calibration rising='1'/><safety_controller k_velocity='1' k_position='1'/>",
        "revolute",
    )
    + joint("k", "b", "c", "<mimic joint='j' multiplier='2' offset='1'/>", "continuous")
    + '<gazebo reference="a"><mu1>1</mu1><mu2>1</mu2><kp>1</kp><kd>1</kd><minDepth>1</minDepth>'
    "<maxContacts>1</maxContacts><dampingFactor>1</dampingFactor></gazebo>"
    '<gazebo reference="j"><springStiffness>1</springStiffness></gazebo>'
)
NUMBER = re.compile(r"(?<=[\"' >])-?\d+(?:\.\d+)?(?=[\"' <])")


@pytest.mark.parametrize("text", ["nan", "-inf", "1e400", "x", "1,5", "", "1e308", "-1", "0", "٣"])
def test_every_number_in_turn(text: str) -> None:
    """Whatever is written for a number: no exception, and no robot with numbers that are none."""
    places = list(NUMBER.finditer(EVERY_NUMBER))
    assert len(places) > 70
    assert not has_errors(checked(EVERY_NUMBER)[1])
    for place in places:
        before, after = EVERY_NUMBER[: place.start()], EVERY_NUMBER[place.end() :]
        lumped, found = checked(before + text + after)
        assert lumped is None or all(map(math.isfinite, numbers(lumped))), place
        if text in {"nan", "-inf", "1e400", "x", "٣"}:
            assert found, place
        assert all(one.message and one.hint for one in found)
