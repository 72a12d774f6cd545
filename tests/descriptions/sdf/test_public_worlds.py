"""Worlds and models of other people against Gazebo's own parser.

Of the packages below those are looked at that are installed.
"""

from __future__ import annotations

import importlib.metadata
import math
import os
import subprocess
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from gazebo_oracle import IGN, ign_sdf
from wsgen.descriptions.sdf.models import SdfModel, read_sdf
from wsgen.diagnostics import Severity
from wsgen.model.inertia import about_link_axes
from wsgen.model.kinematics import split_trees
from wsgen.model.robot import Inertial, JointType, Robot
from wsgen.model.transform import IDENTITY, Pose, compose, rotate, rotation_of_rpy

MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
PACKAGES = (
    "drake",
    "example-robot-data",
    "gym-ignition-models",
    "pybullet",
    "pybullet-arm64",
    "pybullet-fleet",
)
ENDINGS = {".sdf", ".world"}
# What depends on where meshes are, and on the engines of a simulation, is not the parser's matter.
BEYOND_THE_PARSER = {"ROB060", "ROB028", "WLD034"}
# What Gazebo loads, and its checker refuses.
REFUSED_BY_THE_CHECKER = {"WLD044"}
# What wsgen has built in, for the parser to find.
BUILT_IN = {
    "sun": '<light name="sun" type="directional"/>',
    "ground_plane": '<model name="ground_plane"><static>true</static><link name="link"/></model>',
}

pytestmark = [
    pytest.mark.oracle,
    pytest.mark.skipif(
        IGN is None, reason="ign (Debian: ignition-tools, libsdformat12) is missing"
    ),
]


def shipped() -> list[Path]:
    found: set[Path] = set()
    for package in PACKAGES:
        try:
            files = importlib.metadata.files(package) or []
        except importlib.metadata.PackageNotFoundError:
            continue
        found |= {Path(str(file.locate())) for file in files if file.suffix in ENDINGS}
    return sorted(found)


def ign(option: str, file: Path, answer: Path) -> str:
    for name, content in BUILT_IN.items():
        folder = answer.parent / "built_in" / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "model.sdf").write_text(f'<sdf version="1.6">{content}</sdf>')
        (folder / "model.config").write_text('<model><sdf version="1.6">model.sdf</sdf></model>')
    with answer.open("w", encoding="utf-8") as output:
        subprocess.run(
            ign_sdf(option, file),
            stdout=output,
            stderr=subprocess.STDOUT,
            timeout=600,
            check=False,
            cwd=file.parent,
            env={**os.environ, "SDF_PATH": str(answer.parent / "built_in")},
        )
    return answer.read_text(encoding="utf-8")


def pose_of(element: ET.Element) -> Pose:
    """The pose as `ign` writes it; none of the files uses frames."""
    pose = element.find("pose")
    if pose is None:
        return IDENTITY
    assert not pose.get("relative_to")
    x, y, z, roll, pitch, yaw = map(float, (pose.text or "").split())
    return Pose((x, y, z), (roll, pitch, yaw))


def inertial_of(link: ET.Element) -> Inertial:
    moments = [
        float(link.findtext(f"inertial/inertia/{moment}") or default)
        for moment, default in zip(MOMENTS, (1, 0, 0, 1, 0, 1), strict=True)
    ]
    inertial = link.find("inertial")
    return Inertial(
        mass=float(link.findtext("inertial/mass") or 1),
        pose_in_link=IDENTITY if inertial is None else pose_of(inertial),
        inertia=(*moments,),  # type: ignore[arg-type]  # six of them
    )


def seen_from_outside(
    inertial: Inertial, link: Pose
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Center of mass, and the moments along the axes of the world."""
    placed = Inertial(
        mass=inertial.mass,
        pose_in_link=compose(link, inertial.pose_in_link),
        inertia=inertial.inertia,
    )
    return placed.pose_in_link.xyz, about_link_axes(placed)


def frames_of(model: SdfModel, robot: Robot) -> dict[str, Pose]:
    """Where the links are in the world, all joints at zero."""
    frames = {}
    for tree, pose in split_trees(robot):
        frames[tree.root] = compose(model.pose_in_world, pose)
        queue = [tree.root]
        for parent in queue:
            for joint in tree.joints:
                if joint.parent == parent:
                    frames[joint.child] = compose(frames[parent], joint.pose_in_parent)
                    queue.append(joint.child)
    return frames


@pytest.mark.slow
def test_there_is_something_to_compare() -> None:
    assert len(shipped()) > 10


@pytest.mark.slow
@pytest.mark.parametrize("file", shipped(), ids=lambda file: f"{file.parent.name}/{file.name}")
def test_same_models_links_and_joints(file: Path, tmp_path: Path) -> None:
    verdict = ign("-k", file, tmp_path / "verdict")
    ours = read_sdf(file, find_model=lambda _: None)
    errors = {
        found.code
        for found in ours.diagnostics
        if (found.severity is Severity.ERROR and found.code not in BEYOND_THE_PARSER)
        or found.code in REFUSED_BY_THE_CHECKER
    }
    assert (not errors) == ("Valid." in verdict), (errors, verdict)
    if errors - REFUSED_BY_THE_CHECKER:
        return
    text = ign("-p", file, tmp_path / "answer")
    root = ET.fromstring(text[text.index("<sdf") :])
    models = [*root.iterfind("model"), *root.iterfind("world/model")]
    names = {model.get("name") for model in models}
    assert names == {
        model.name for model in (ours.models if ours.world is None else ours.world.models)
    }
    ground = names - {model.name for model in ours.models}
    assert not ground or (ours.world is not None and ours.world.has_ground_plane)
    for theirs in models:
        if theirs.get("name") in ground:
            continue
        model = next(model for model in ours.models if model.name == theirs.get("name"))
        assert model.robot is not None
        assert model.is_static == (theirs.findtext("static") in {"1", "true"})
        compare_links(theirs, model, model.robot)
        compare_joints(theirs, model, model.robot, {found.message for found in ours.diagnostics})


def compare_links(theirs: ET.Element, model: SdfModel, robot: Robot) -> None:
    frames = frames_of(model, robot)
    links = {link.name: link for link in robot.links if link.name != "world"}
    assert set(links) == {link.get("name") for link in theirs.findall("link")}
    for element in theirs.findall("link"):
        link = links[element.get("name") or ""]
        expected = inertial_of(element)
        assert link.inertial is not None
        assert link.inertial.mass == pytest.approx(expected.mass, rel=1e-9)
        place = compose(pose_of(theirs), pose_of(element))
        center, moments = seen_from_outside(link.inertial, frames[link.name])
        their_center, their_moments = seen_from_outside(expected, place)
        assert center == pytest.approx(their_center, rel=1e-6, abs=1e-7)
        assert moments == pytest.approx(
            their_moments, rel=1e-6, abs=1e-6 * max(map(abs, their_moments))
        )
        assert len(element.findall("visual")) >= len(link.visuals)
        assert len(element.findall("collision")) >= len(link.collisions)


def compare_joints(theirs: ET.Element, model: SdfModel, robot: Robot, messages: set[str]) -> None:
    frames = frames_of(model, robot)
    joints = {joint.name: joint for joint in robot.joints}
    left_out = {message.split("`")[1] for message in messages if message.startswith("The joint `")}
    elements = {element.get("name") or "": element for element in theirs.findall("joint")}
    assert set(elements) == {*joints, *(left_out & set(elements))}
    for name, joint in joints.items():
        element = elements[name]
        assert (joint.parent, joint.child) == (
            element.findtext("parent"),
            element.findtext("child"),
        )
        kind = "revolute" if joint.type is JointType.CONTINUOUS else joint.type.value
        assert element.get("type") in {kind, joint.type.value}
        if joint.type in {JointType.FIXED, JointType.BALL}:
            continue
        xyz = element.find("axis/xyz")
        assert xyz is not None
        in_model = xyz.get("expressed_in") == "__model__"
        x, y, z = map(float, (xyz.text or "").split())
        length = math.hypot(x, y, z)
        seen = rotate(rotation_of_rpy(frames[joint.child].rpy), joint.axis_in_joint)
        around = pose_of(theirs) if in_model else frames[joint.child]
        assert seen == pytest.approx(
            [part / length for part in rotate(rotation_of_rpy(around.rpy), (x, y, z))], abs=1e-6
        )
        if joint.limit is not None:
            assert (joint.limit.lower, joint.limit.upper) == (
                float(element.findtext("axis/limit/lower") or -1e16),
                float(element.findtext("axis/limit/upper") or 1e16),
            )
