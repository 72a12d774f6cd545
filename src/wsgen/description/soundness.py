"""What can only be said of a whole robot: names, mimic joints, inertias."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.lump import parts_of_impossible_sums
from wsgen.description.lumping import is_impossible
from wsgen.model.inertia import principal_moments
from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from wsgen.description.findings import Findings
    from wsgen.model.robot import Robot


def check_names(findings: Findings, robot: Robot) -> None:
    """Report a joint that is called like a link."""
    links = {link.name for link in robot.links}
    for joint in robot.joints:
        if joint.name in links:
            findings.warning(
                "ROB034",
                f"A link and a joint are both called `{joint.name}`.",
                hint=f"Rename the joint, to `{joint.name}_joint` for example: SDF has one space of "
                "names, and Gazebo before 2023 refuses the robot.",
                at=joint.line,
                path=f"joint[@name='{joint.name}']",
            )


def check_mimics(findings: Findings, robot: Robot) -> None:
    """Report a mimic joint whose leader does not exist, or that follows itself."""
    leaders = {joint.name: joint.mimic.joint for joint in robot.joints if joint.mimic}
    names = {joint.name for joint in robot.joints}
    for joint in robot.joints:
        if joint.mimic is None:
            continue
        path = f"joint[@name='{joint.name}']/mimic"
        if joint.mimic.joint not in names:
            findings.error(
                "ROB035",
                f"The joint `{joint.name}` mimics `{joint.mimic.joint}`, and there is none.",
                hint="Name a joint of this robot.",
                at=joint.line,
                path=path,
            )
            continue
        leader, steps = joint.mimic.joint, 0
        while leader in leaders and leader != joint.name and steps < len(leaders):
            leader, steps = leaders[leader], steps + 1
        if leader == joint.name:
            findings.error(
                "ROB036",
                f"The joint `{joint.name}` mimics itself.",
                hint="Let it follow a joint that does not follow it.",
                at=joint.line,
                path=path,
            )


def check_inertias(findings: Findings, robot: Robot) -> None:
    """Report an inertia that no body has.

    It is an error where Gazebo refuses the robot for it; that of a link which is lumped into
    another one counts only as a part of the sum.
    """
    impossible = [
        (link, link.inertial)
        for link in robot.links
        if link.inertial is not None and is_impossible(link.inertial)
    ]
    if not impossible:
        return
    lumped = {joint.child for joint in robot.joints if joint.type is JointType.FIXED}
    refused = parts_of_impossible_sums(robot) if robot.root else set()
    for link, inertial in impossible:
        low, middle, high = principal_moments(inertial.inertia)
        harmless = link.name in lumped and link.name not in refused
        report = findings.warning if harmless else findings.error
        report(
            "ROB037",
            f"No body has the inertia of the link `{link.name}`: its principal moments are "
            f"{low:.4g}, {middle:.4g} and {high:.4g} kg m².",
            hint="Each must be positive, and none larger than the other two together. Compute it "
            "from mass and shape, or export it from CAD about the centre of mass.",
            at=link.line,
            path=f"link[@name='{link.name}']/inertial/inertia",
        )
