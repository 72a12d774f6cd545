"""The lumped robot against Gazebo's own parser, on robots that PyBullet ships."""

from __future__ import annotations

import importlib.util
import shutil
import subprocess
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from wsgen.description.lump import lump
from wsgen.description.reader import read_urdf
from wsgen.model.inertia import about_link_axes
from wsgen.model.pose import Pose
from wsgen.model.robot import Inertial

IGN = shutil.which("ign")
SPEC = importlib.util.find_spec("pybullet_data")
DATA = Path(SPEC.origin).parent if SPEC and SPEC.origin else Path()
OUTPUT_LIMIT = 10 * 2**20  # bytes: on a cycle it prints without end
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")

ROBOTS = (
    "r2d2.urdf",
    "franka_panda/panda.urdf",
    "a1/a1.urdf",
    "aliengo/aliengo.urdf",
    "laikago/laikago_toes_zup.urdf",
    "quadruped/minitaur_fixed_all.urdf",
    "differential/diff_ring.urdf",
    "pr2_gripper.urdf",
    "xarm/xarm6_with_gripper.urdf",
)

pytestmark = [
    pytest.mark.oracle,
    pytest.mark.skipif(
        IGN is None, reason="ign (Debian: ignition-tools, libsdformat12) is missing"
    ),
]


def gazebo_reads(file: Path, answer: Path) -> ET.Element:
    """What Gazebo's parser makes of a URDF; on a bad one it may print without end."""
    limited = f"ulimit -f {OUTPUT_LIMIT // 512}; exec '{IGN}' sdf -p '{file}'"
    with answer.open("w", encoding="utf-8") as output:
        subprocess.run(["sh", "-c", limited], stdout=output, timeout=60, check=False)
    text = answer.read_text(encoding="utf-8")
    model = ET.fromstring(text[text.index("<sdf") :]).find("model")
    assert model is not None
    return model


def number(element: ET.Element, path: str) -> float:
    text = element.findtext(path)
    assert text is not None
    return float(text)


@pytest.mark.parametrize("name", ROBOTS)
def test_same_links_joints_masses_and_inertias(name: str, tmp_path: Path) -> None:
    model, _ = read_urdf((DATA / name).read_text(encoding="utf-8"), file=None)
    assert model is not None
    lumped, _ = lump(model)
    gazebo = gazebo_reads(DATA / name, tmp_path / "answer.sdf")
    inertials = {link.get("name"): link.find("inertial") for link in gazebo.findall("link")}
    links = [link for link in lumped.links if not (lumped.fixed_to_world and link.name == "world")]
    assert {link.name for link in links} == set(inertials)
    assert {joint.name for joint in lumped.joints} == {
        joint.get("name") for joint in gazebo.findall("joint")
    }
    for link in links:
        theirs = inertials[link.name]
        assert theirs is not None
        assert link.inertial is not None
        pose = [float(word) for word in (theirs.findtext("pose") or "").split()]
        moments = [number(theirs, f"inertia/{moment}") for moment in MOMENTS]
        turned = about_link_axes(
            Inertial(
                mass=1.0,
                pose_in_link=Pose(rpy=(pose[3], pose[4], pose[5])),
                inertia=(*moments,),  # type: ignore[arg-type]  # six of them
            )
        )
        assert link.inertial.mass == pytest.approx(number(theirs, "mass"), rel=1e-6)
        assert link.inertial.pose_in_link.xyz == pytest.approx(pose[:3], abs=1e-7)
        ours = about_link_axes(link.inertial)
        assert ours == pytest.approx(turned, rel=1e-6, abs=1e-6 * max(map(abs, turned)))
