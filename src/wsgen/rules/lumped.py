"""Rules about the bodies of a robot: its links, with those that fixed joints lump into them.

The parameters of a check are facts in SI units; a check yields what it reports.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.model.robot import MOST_LINKS
from wsgen.rules.robots import BEYOND

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Joint, Link, Robot


# Times its own mass that a link carries in the next one. Of 94 robots on PyPI two have more, both
# chains of links without a counterpart in a machine; of machines the most are Unitree's G1 with 91
# and IHMC's Alex with 75, both at the waist, which is held by large gains.
MOST_CARRIED = 100.0


def check_lumped(written: Sequence[Link], lumped: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Everything about bodies; `written` are the links before they are lumped."""
    yield from many_links(lumped, file)
    yield from mass_ratio(written, lumped, file)


MANY_LINKS = Rule(
    code="ROB123",
    name="many-links",
    severity=Severity.INFO,
    summary="The robot has more links than PyBullet simulates.",
    what=f"Counts the links that are left when fixed joints are lumped; reports more than "
    f"{MOST_LINKS}.",
    why="PyBullet does not simulate such a robot. Gazebo and other engines do, the slower the more "
    "links it has.",
    example="A conveyor of 200 rollers, each with a `continuous` joint.",
    instead="The same conveyor, in which the rollers that nothing touches have `fixed` joints.",
)


def many_links(lumped: Robot, file: Path | None) -> Iterator[Diagnostic]:
    """Report a robot with more bodies than an engine takes."""
    number = len(lumped.links)
    if number > MOST_LINKS and not lumped.loose:  # else it is several trees, each with a limit
        yield MANY_LINKS.at(
            file,
            lumped.links[0].line,
            "robot",
            message=f"The robot has {number} links after lumping: PyBullet simulates at most "
            f"{MOST_LINKS}.",
            hint='Write type="fixed" for joints that need not move, or simulate it with --engine '
            "mujoco.",
        )


MASS_RATIO = Rule(
    code="ROB124",
    name="mass-ratio",
    severity=Severity.INFO,
    summary="A light moving link carries a link that is more than 100 times as heavy.",
    what="Compares the masses on both sides of each movable joint, with the masses that fixed "
    "joints add. The link that carries must itself hang on a movable joint.",
    why="Physics engines solve joints in a few iterations, which do not converge for such masses: "
    "the joint gets soft, or shakes.",
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
    more = f" So do {others} other links." if others > 1 else ""
    more = " So does another link." if others == 1 else more
    place = f"link[@name='{light.name}']"
    has_mass = any(link.name == light.name and link.inertial for link in written)
    yield MASS_RATIO.at(
        file,
        light.line,
        f"{place}/inertial/mass" if has_mass else place,
        message=f"The link `{light.name}` ({carrying:g} kg) carries `{joint.child}` ({carried:g} "
        f"kg) by the joint `{joint.name}`: in a simulation the joint may be soft or shake.{more}",
        hint=f'Write <mass value="{carried / MOST_CARRIED:.2g}"/> or more for `{light.name}`, with '
        "an inertia that fits it.",
    )


def _mass(link: Link) -> float | None:
    """That of a link which has one that is meant, kg."""
    mass = link.inertial.mass if link.inertial is not None else 0.0
    is_meant = link.is_as_meant and not link.has_error
    return mass if is_meant and 0 < mass <= BEYOND else None
