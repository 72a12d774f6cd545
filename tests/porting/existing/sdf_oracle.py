"""What the reader of SDF has, against a URDF that was made of the same model.

The URDF is read with nothing of wsgen; where Gazebo's parser is installed, it converts it, too.
"""

from __future__ import annotations

import subprocess
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

import numpy as np

from porting.existing.urdf_oracle import frame_of, moved, poses, tensor, transform_of
from wsgen.descriptions.sdf.lookup import model_finder
from wsgen.descriptions.sdf.models import read_model
from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from pathlib import Path
    from typing import Any

    from wsgen.model.robot import Joint, Robot
    from wsgen.porting.existing.description import Description


def read(file: Path) -> Robot:
    """The robot of a model."""
    found = read_model(file.read_bytes(), file=file, find_model=model_finder(file, {}))
    (model,) = found.models
    assert model.robot is not None
    return model.robot


def plain(name: str) -> str:
    """How a URDF calls what a model has."""
    return name.replace("::", "_").replace(" (", "_").rstrip(")")


def compare(description: Description, configurations: int = 10) -> dict[str, float]:
    """The largest differences: of the mass (a share), positions (m) and inertias (a share)."""
    robot = read(description.file)
    written = ET.fromstring(description.text)
    links = {str(link.get("name")): link for link in written.findall("link")}
    total = sum(float(one.get("value") or 0) for one in written.iterfind("link/inertial/mass"))
    crosses = [link for link in robot.links if link.name.endswith(" (cross)")]
    meant = sum(link.inertial.mass for link in robot.links if link.inertial)
    meant -= sum(link.inertial.mass for link in crosses if link.inertial)
    found = {"mass": abs(total - meant) / meant, "position": 0.0, "inertia": 0.0}
    random = np.random.default_rng(1)
    for number in range(configurations):
        positions, at = _positions(robot, random if number else None)
        ours = poses(written, positions)
        theirs = _poses(robot, at)
        for link in robot.links:
            inertial = links[plain(link.name)].find("inertial")
            if inertial is None or link.inertial is None or link in crosses:
                continue
            mine = ours[plain(link.name)] @ frame_of(inertial)
            other = theirs[link.name] @ transform_of(
                link.inertial.pose_in_link.xyz, link.inertial.pose_in_link.rpy
            )
            found["position"] = max(found["position"], np.abs(mine - other)[:3, 3].max())
            scale = float(inertial.find("mass").get("value")) / link.inertial.mass  # type: ignore[union-attr, arg-type]
            xx, xy, xz, yy, yz, zz = (one * scale for one in link.inertial.inertia)
            meant_tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
            turned = other[:3, :3] @ meant_tensor @ other[:3, :3].T
            moments = tensor(inertial.find("inertia"))  # type: ignore[arg-type]
            difference = mine[:3, :3] @ moments @ mine[:3, :3].T - turned
            share = np.abs(difference).max() / max(np.abs(turned).max(), 1e-12)
            found["inertia"] = max(found["inertia"], share)
    return found


def _positions(robot: Robot, random: Any) -> tuple[dict[str, float], dict[str, Any]]:
    """Positions of the joints of the URDF, and the frames that those of the model then have."""
    positions: dict[str, float] = {}
    frames: dict[str, Any] = {}
    for joint in robot.joints:
        parts = [("", joint.axis_in_joint)]
        if joint.type is JointType.BALL:
            parts = [("_x", (1, 0, 0)), ("_y", (0, 1, 0)), ("_z", (0, 0, 1))]
        frame = np.eye(4)
        for end, axis in parts:
            position = 0.0 if random is None else float(random.uniform(-1, 1))
            positions[plain(joint.name) + end] = position
            frame = frame @ moved(axis, position, is_slide=joint.type is JointType.PRISMATIC)
        frames[joint.name] = np.eye(4) if joint.type is JointType.FIXED else frame
    return positions, frames


def _poses(robot: Robot, frames: dict[str, Any]) -> dict[str, Any]:
    above: dict[str, Joint] = {joint.child: joint for joint in (*robot.joints, *robot.loose)}
    found: dict[str, Any] = {}

    def place(link: str) -> Any:
        if link not in above:
            return np.eye(4)
        joint = above[link]
        at = transform_of(joint.pose_in_parent.xyz, joint.pose_in_parent.rpy)
        return place(joint.parent) @ at @ frames.get(joint.name, np.eye(4))

    for link in robot.links:
        found[link.name] = place(link.name)
    return found


def converted(description: Description, folder: Path) -> ET.Element:
    """The model that Gazebo's own parser makes of the URDF."""
    file = folder / "converted.urdf"
    file.write_text(description.text, encoding="utf-8")
    run = subprocess.run(["ign", "sdf", "-p", file], capture_output=True, text=True, check=True)
    (model,) = ET.fromstring(run.stdout).iterfind("model")
    return model
