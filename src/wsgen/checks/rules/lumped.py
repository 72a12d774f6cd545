"""Rules about the bodies of a robot: its links, with those that fixed joints lump into them.

The parameters of a check are facts in SI units; a check yields what it reports.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks.rules.drives import turning_friction
from wsgen.checks.rules.robots import BEYOND
from wsgen.diagnostics import Rule, Severity
from wsgen.gazebo.sensors import FRAME_NAMES
from wsgen.model.robot import MOST_LINKS

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import GazeboTag, Joint, Link, Robot


# Times its own mass that a link carries in the next one. Of 94 robots on PyPI two have more, both
# chains of links without a counterpart in a machine; of machines the most are Unitree's G1 with 91
# and IHMC's Alex with 75, both at the waist, which is held by large gains.
MOST_CARRIED = 100.0


def check_lumped(written: Robot, lumped: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Everything about bodies; `written` is the robot before it is lumped."""
    yield from many_links(lumped, file)
    yield from mass_ratio(written.links, lumped, file)
    yield from lumped_frames(written, lumped, file)
    yield from turning_friction(written, lumped, file)


MANY_LINKS = Rule(
    code="ROB123",
    name="many-links",
    severity=Severity.INFO,
    summary="The robot has more links than PyBullet supports.",
    what="Counts the links that remain after fixed joints are lumped; reports more than "
    f"{MOST_LINKS}.",
    why="PyBullet refuses such a robot. Gazebo and other engines simulate it slowly.",
    example="A conveyor of 200 rollers, each with a `continuous` joint.",
    instead="The same conveyor with `fixed` joints for the rollers that nothing touches.",
)


def many_links(lumped: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Report a robot with more bodies than an engine takes."""
    number = len(lumped.links)
    if number > MOST_LINKS and not lumped.loose:  # else it is several trees, each with a limit
        yield MANY_LINKS.at(
            file,
            lumped.links[0].line,
            "robot",
            message=f"The robot has {number} links after fixed joints are lumped: PyBullet "
            f"supports at most {MOST_LINKS}.",
            hint='Write type="fixed" for joints that need not move, or simulate the robot with '
            "--engine mujoco.",
        )


MASS_RATIO = Rule(
    code="ROB124",
    name="mass-ratio",
    severity=Severity.INFO,
    summary="A light moving link carries a link that is more than 100 times as heavy.",
    what="Compares the masses on both sides of each movable joint, with the masses that fixed "
    "joints add. Only links that are themselves on a movable joint are reported.",
    why="Physics engines solve joints in a few iterations, which do not converge for such masses: "
    "the joint becomes soft or shakes.",
    example="""
<link name="gimbal">
  <inertial><mass value="0.001"/>…</inertial>
</link>
<joint name="tilt" type="revolute">
  <parent link="gimbal"/>
  <child link="telescope"/>  <!-- 5 kg -->
  …
</joint>
""",
    instead="""
<link name="gimbal">
  <inertial><mass value="0.3"/>…</inertial>
</link>
<joint name="tilt" type="revolute">
  <parent link="gimbal"/>
  <child link="telescope"/>  <!-- 5 kg -->
  …
</joint>
""",
)


def mass_ratio(written: Sequence[Link], lumped: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Report, in one diagnostic, light links that carry heavy ones."""
    if lumped.is_static:
        return
    links = {link.name: link for link in lumped.links}
    moving = {joint.child for joint in lumped.movable_joints}
    pairs: list[tuple[float, Joint, Link]] = []
    for joint in lumped.movable_joints:
        light, heavy = links.get(joint.parent), links.get(joint.child)
        if light is None or heavy is None or light.name not in moving:
            continue
        carrying, carried = _mass(light), _mass(heavy)
        if carrying is not None and carried is not None and carried > MOST_CARRIED * carrying:
            pairs.append((carried / carrying, joint, light))
    if not pairs:
        return
    _, joint, light = max(pairs, key=lambda pair: pair[0])
    carrying, carried = _mass(light) or 0.0, _mass(links[joint.child]) or 0.0
    others = len({link.name for _, _, link in pairs}) - 1
    more = f" The same holds for {others} other links." if others > 1 else ""
    more = " The same holds for another link." if others == 1 else more
    place = f"link[@name='{light.name}']"
    has_mass = any(link.name == light.name and link.inertial for link in written)
    yield MASS_RATIO.at(
        file,
        light.line,
        f"{place}/inertial/mass" if has_mass else place,
        message=f"The link `{light.name}` ({carrying:g} kg) carries `{joint.child}` ({carried:g} "
        f"kg) at the joint `{joint.name}`, which may be soft or shake in a simulation.{more}",
        hint="Check that both masses are in kilograms. If they are, write "
        f'<mass value="{carried / MOST_CARRIED:.2g}"/> or more for `{light.name}`, with a matching '
        "inertia.",
    )


def _mass(link: Link) -> float | None:
    """That of a link which has one that is meant, kg."""
    mass = link.inertial.mass if link.inertial is not None else 0.0
    is_meant = link.is_as_meant and not link.has_error
    return mass if is_meant and 0 < mass <= BEYOND else None


LUMPED_FRAMES = Rule(
    code="ROB128",
    name="lumped-frames",
    severity=Severity.INFO,
    summary="Gazebo lumps a link that a sensor or a plugin of the robot names.",
    what="Looks for links on fixed joints that `<gazebo reference=...>` of a sensor, or an element "
    "of a plugin, names. For a root link without mass see `massless-root`.",
    why="Gazebo does not have the link: the sensor belongs to the link that it is fixed to, whose "
    "name is in the topics and poses of Gazebo. In ROS, robot_state_publisher publishes all "
    "frames.",
    example="""
<joint name="lidar_joint" type="fixed">
  <parent link="base_link"/>
  <child link="lidar_link"/>
</joint>
<gazebo reference="lidar_link">
  <sensor name="lidar" type="gpu_lidar">…</sensor>
  <!-- /world/office/model/robot/link/base_link/sensor/lidar/scan -->
</gazebo>
""",
    instead="""
<gazebo reference="lidar_link">
  <sensor name="lidar" type="gpu_lidar">
    <topic>scan</topic>
    <gz_frame_id>lidar_link</gz_frame_id>
    …
  </sensor>
</gazebo>
""",
)


def lumped_frames(written: Robot, lumped: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Report, once for a robot, lumped links whose names something in Gazebo depends on."""
    root = next((link for link in written.links if link.name == written.root), None)
    if root is None or not _mass(root) or written.is_static:
        return
    bodies = _bodies(written, lumped)
    named = {
        name: tag.line
        for tag in reversed(written.gazebo)
        for name in _names_of(tag)
        if name in bodies
    }
    if not named:
        return
    names = [name for name in bodies if name in named]
    others = len(names) - 1
    more = f" and {others} more link{'s' if others > 1 else ''}" if others else ""
    before, after = written.mass, lumped.mass
    is_same = abs(before - after) <= SAME_MASS * before
    kept = "before and after" if is_same else f"as written, and {after:.4g} kg in Gazebo"
    yield LUMPED_FRAMES.at(
        file,
        named[names[0]],
        f"gazebo[@reference='{names[0]}']",
        message=f"Gazebo lumps `{names[0]}` into `{bodies[names[0]]}`{more}, with the content of "
        f"its <gazebo> elements. The robot weighs {before:.4g} kg {kept}.",
        hint=f"Where a topic or a pose of Gazebo names a link, write `{bodies[names[0]]}` for "
        f"`{names[0]}`; or write <preserveFixedJoint>true</preserveFixedJoint> for the joint of "
        f"`{names[0]}`.",
    )


SAME_MASS = 1e-6  # a part of the mass, for what adding up rounds
# That say in which frame of ROS the messages of a sensor are: these frames stay.
_FRAMES_OF_ROS = frozenset((*FRAME_NAMES, "frame_name", "frameName"))


def _names_of(tag: GazeboTag) -> Iterator[str]:
    """The links that a `<gazebo>` element needs in Gazebo by their names."""
    if tag.reference is not None and any("topic" not in one.values for one in tag.sensors):
        yield tag.reference
    for plugin in tag.plugins:
        for key, texts in plugin.values.items():
            if "link" in key.lower() and key not in _FRAMES_OF_ROS:
                yield from texts


def _bodies(written: Robot, lumped: Robot) -> dict[str, str]:
    """Lumped links, in their order, and the links that Gazebo lumps them into."""
    left = {link.name for link in lumped.links}
    above = {joint.child: joint.parent for joint in written.joints if not joint.is_movable}
    bodies: dict[str, str] = {}
    for link in written.links:
        name = link.name
        while name not in left and name in above:
            name = above[name]
        if name in left and name != link.name:
            bodies[link.name] = name
    return bodies
