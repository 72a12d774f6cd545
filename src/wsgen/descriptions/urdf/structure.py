"""Check a robot as a whole: the tree of its links, names, mimic joints and inertias.

PyBullet crashes on two roots, a cycle or two joints of one name, and check_urdf and sdformat print
without end on a cycle.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.descriptions.rules import (
    IMPOSSIBLE_INERTIA,
    ONE_NAME_FOR_LINK_AND_JOINT,
    RESERVED_NAME,
    SELF_JOINT,
    UNKNOWN_LINK,
    UNKNOWN_MIMICKED_JOINT,
)
from wsgen.descriptions.urdf.lumping import WORLD, is_impossible, parts_of_impossible_sums
from wsgen.descriptions.urdf.unknown_elements import nearest_element
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.model.inertia import as_attributes, if_filled, principal_moments
from wsgen.model.robot import JointType
from wsgen.text.suggestions import did_you_mean, some_named
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.descriptions.urdf.values import Collector
    from wsgen.model.robot import Joint, Robot
    from wsgen.text.xmltree import Element


RESERVED = lazy_pattern(r"__.*__", re.DOTALL)  # of SDF, as are `world` and a few that only SDF has
NAMED = 5  # at most so many names stand in a message

SEVERAL_ROOTS = Rule(
    code="ROB009",
    name="several-roots",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="More than one link has no parent.",
    why="A URDF is a tree with one root link. Gazebo and robot_state_publisher refuse the "
    "robot, and PyBullet crashes on it.",
    example='<link name="base_link"/>\n<link name="camera"/>',
    instead='<link name="base_link"/>\n'
    '<link name="camera"/>\n'
    '<joint name="camera_joint" type="fixed">\n'
    '  <parent link="base_link"/>\n'
    '  <child link="camera"/>\n'
    "</joint>",
)

LINK_CYCLE = Rule(
    code="ROB010",
    name="link-cycle",
    severity=Severity.ERROR,
    summary="The links form a cycle.",
    why="A URDF is a tree. With a cycle, `check_urdf` and `gz sdf` print endlessly, and PyBullet "
    "crashes.",
    example='<joint name="a" type="fixed"><parent link="arm"/><child link="hand"/></joint>\n'
    '<joint name="b" type="fixed"><parent link="hand"/><child link="arm"/></joint>',
    instead='<joint name="a" type="fixed"><parent link="base_link"/><child link="arm"/></joint>\n'
    '<joint name="b" type="fixed"><parent link="arm"/><child link="hand"/></joint>',
)

TWO_PARENTS = Rule(
    code="ROB011",
    name="two-parents",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates another robot", sim="refuses it"),
    summary="A link is the child of two joints.",
    why="A URDF is a tree: each link has one parent, and urdfdom refuses the robot. Closed "
    "chains need SDF.",
    example='<joint name="a" type="fixed"><parent link="left_arm"/><child link="hand"/></joint>\n'
    '<joint name="b" type="fixed"><parent link="right_arm"/><child link="hand"/></joint>',
    instead='<joint name="a" type="fixed"><parent link="left_arm"/><child link="hand"/></joint>',
)

MIMIC_CYCLE = Rule(
    code="ROB036",
    name="mimic-cycle",
    severity=Severity.ERROR,
    severity_varies="a warning in Gazebo Classic, where such joints move independently",
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A joint mimics itself, directly or through other joints.",
    why="The positions of these joints are not determined, and programs that follow the cycle may "
    "never finish.",
    example='<joint name="left_joint" type="revolute"><mimic joint="right_joint"/>…</joint>\n'
    '<joint name="right_joint" type="revolute"><mimic joint="left_joint"/>…</joint>',
    instead='<joint name="left_joint" type="revolute">…</joint>\n'
    '<joint name="right_joint" type="revolute"><mimic joint="left_joint"/>…</joint>',
)


def find_root(
    collector: Collector,
    robot: Element,
    links: dict[str, Element],
    joints: Sequence[tuple[Joint, Element]],
) -> str | None:
    """The root link; None where there is no tree, which is reported."""
    before = len(collector.errors)
    parent_of: dict[str, tuple[Joint, Element]] = {}
    for joint, element in joints:
        path = f"joint[@name='{joint.name}']"
        if _check_ends(collector, joint, element, path, links, robot):
            if joint.child in parent_of:
                other = parent_of[joint.child][0]
                collector.report(
                    TWO_PARENTS,
                    f"The link `{joint.child}` has two parents: `{other.parent}` through the joint "
                    f"`{other.name}`, and `{joint.parent}`.",
                    hint="Remove one of the joints: a URDF is a tree. Use SDF for closed chains.",
                    at=element,
                    path=path,
                )
            else:
                parent_of[joint.child] = (joint, element)
    if len(collector.errors) > before:
        return None
    roots = [name for name in links if name not in parent_of]
    _report_cycle(collector, parent_of)
    if len(roots) > 1 and len(collector.errors) == before:
        roots.sort(key=lambda root: -_size_below(root, parent_of))
    named = some_named(roots, NAMED)
    many = f"{len(roots)} links have no parent ({named}): a robot has exactly one root."
    if len(roots) > 1 and not collector.blame_misspelled(robot, "joint", many):
        collector.report(
            SEVERAL_ROOTS,
            many,
            hint=f"Add a joint whose child is `{roots[1]}`.",
            at=links[roots[1]],
            path=f"link[@name='{roots[1]}']",
        )
    return roots[0] if len(collector.errors) == before else None


def _size_below(root: str, parent_of: Mapping[str, tuple[Joint, Element]]) -> int:
    """How many links hang on a root: the largest tree is the robot, another one a loose part."""
    children: dict[str, list[str]] = {}
    for child, (joint, _) in parent_of.items():
        children.setdefault(joint.parent, []).append(child)
    below = [root]
    for name in below:
        below += children.get(name, ())
    return len(below)


def _check_ends(  # noqa: PLR0913, PLR0917  a joint, and what it is in
    collector: Collector,
    joint: Joint,
    element: Element,
    path: str,
    links: dict[str, Element],
    robot: Element,
) -> bool:
    for end, name in (("parent", joint.parent), ("child", joint.child)):
        message = f"The {end} of the joint `{joint.name}` is `{name}`, but no link has that name."
        if name not in links and not collector.blame_misspelled(robot, f"link {name}", message):
            near = next((link for link in links if link.strip() == name.strip()), None)
            near = near or nearest_element(collector, name, links)
            collector.report(
                UNKNOWN_LINK,
                message,
                hint=did_you_mean(near) if near else f'Add <link name="{name}">.',
                at=element,
                path=path,
            )
    if joint.parent == joint.child:
        collector.report(
            SELF_JOINT,
            f"The joint `{joint.name}` connects the link `{joint.parent}` to itself.",
            hint="Name two different links as parent and child.",
            at=element,
            path=path,
        )
    return joint.parent in links and joint.child in links and joint.parent != joint.child


def _report_cycle(collector: Collector, parent_of: dict[str, tuple[Joint, Element]]) -> None:
    """Report one cycle, if any: following parents from a link leads back to a link on the way."""
    harmless: set[str] = set()
    for start in parent_of:
        way: dict[str, None] = {}
        link = start
        while link in parent_of and link not in harmless and link not in way:
            way[link] = None
            link = parent_of[link][0].parent
        if link in way:
            names = list(way)
            cycle = names[names.index(link) :][::-1]
            joint, element = parent_of[link]
            collector.report(
                LINK_CYCLE,
                f"The links form a cycle: {some_named(cycle, NAMED)}, and back to `{cycle[0]}`.",
                hint="Remove the joint that closes the cycle: a URDF is a tree.",
                at=element,
                path=f"joint[@name='{joint.name}']",
            )
            return
        harmless.update(way)


def check_names(collector: Collector, robot: Robot, line_of_robot: int | None) -> None:
    """Report names that SDF reserves, and a joint that has the name of a link."""
    for name, line, path in (
        (robot.name, line_of_robot, "robot"),
        *((link.name, link.line, f"link[@name='{link.name}']") for link in robot.links),
        *((joint.name, joint.line, f"joint[@name='{joint.name}']") for joint in robot.joints),
    ):
        is_link = path.startswith("link")
        # Without a tree nobody knows whether it was meant to be the root.
        is_root = is_link and (robot.fixed_to_world or not robot.root)
        if (name == WORLD and not is_root) or RESERVED.fullmatch(name):
            _report_reserved(collector, name, line, path)
    links = {link.name for link in robot.links}
    for joint in robot.joints:
        is_lumped = joint.type is JointType.FIXED and not joint.kept_by
        if joint.name in links and (joint.parent == WORLD or not is_lumped):
            collector.report(
                ONE_NAME_FOR_LINK_AND_JOINT,
                f"A link and a joint have the same name `{joint.name}`: Gazebo Sim refuses "
                "the robot.",
                hint=f"Rename the joint, for example to `{joint.name}_joint`: SDF has one "
                "namespace for both.",
                at=joint.line,
                path=f"joint[@name='{joint.name}']",
            )


def _report_reserved(collector: Collector, name: str, line: int | None, path: str) -> None:
    collector.report(
        RESERVED_NAME,
        f"The name `{name}` is reserved: Gazebo Sim refuses the robot.",
        hint="Make it the root of the robot, which is then fixed to the world, or rename it."
        if name == WORLD and path.startswith("link")
        else "Use another name: not `world`, and no two underscores at the beginning and the end.",
        at=line,
        path=path,
    )


def check_mimics(collector: Collector, robot: Robot) -> None:
    """Report a mimic joint whose leader does not exist, or that follows itself."""
    leaders = {joint.name: joint.mimic.joint for joint in robot.joints if joint.mimic}
    names = {joint.name for joint in robot.joints}
    cyclic = _in_cycles(leaders)
    for joint in robot.joints:
        if joint.mimic is None:
            continue
        path = f"joint[@name='{joint.name}']/mimic"
        if joint.mimic.joint not in names:
            collector.report(
                UNKNOWN_MIMICKED_JOINT,
                f"The joint `{joint.name}` mimics `{joint.mimic.joint}`, which does not exist: it "
                "moves independently.",
                hint="Write the name of a joint of this robot.",
                at=joint.line,
                path=path,
                severity=Severity.WARNING,
            )
            continue
        if joint.name in cyclic:
            collector.report(
                MIMIC_CYCLE,
                f"The joint `{joint.name}` mimics itself.",
                hint="Write the name of another joint in <mimic>.",
                at=joint.line,
                path=path,
            )


def _in_cycles(leaders: Mapping[str, str]) -> set[str]:
    """The joints that follow themselves, directly or over others."""
    cyclic: set[str] = set()
    done: set[str] = set()
    for start in leaders:
        way: dict[str, None] = {}
        name = start
        while name in leaders and name not in done and name not in way:
            way[name] = None
            name = leaders[name]
        if name in way:
            names = list(way)
            cyclic.update(names[names.index(name) :])
        done.update(way)
    return cyclic


def check_inertias(collector: Collector, robot: Robot) -> None:
    """Report an inertia that no body has.

    It is an error where Gazebo refuses the robot for it: of links that are fixed together only the
    sum counts.
    """
    impossible = [
        (link, link.inertial)
        for link in robot.links
        if link.inertial is not None and is_impossible(link.inertial)
    ]
    if not impossible:
        return
    everything = {link.name for link in robot.links}
    refused = parts_of_impossible_sums(robot) if robot.root else everything
    for link, inertial in impossible:
        low, middle, high = principal_moments(inertial.inertia)
        filled = if_filled(link)
        collector.report(
            IMPOSSIBLE_INERTIA,
            f"The inertia of the link `{link.name}` is impossible: its principal moments are "
            f"{low:.4g}, {middle:.4g} and {high:.4g} kg m².",
            hint="Compute it from mass and shape, or export it from CAD about the center of mass: "
            "each moment must be positive, and none larger than the sum of the other two."
            if filled is None
            else f"Write {as_attributes(filled)} (kg m², products 0) for a homogeneous body: each "
            "moment must be positive, and none larger than the sum of the other two.",
            at=link.line,
            path=f"link[@name='{link.name}']/inertial/inertia",
            severity=Severity.ERROR if link.name in refused else Severity.WARNING,
        )
