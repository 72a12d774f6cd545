"""One friction a link, for engines that know no more."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.robot import Inertial, Joint, JointType, Link

if TYPE_CHECKING:
    from wsgen.model.robot import Collision, Robot

NOTHING = Inertial(mass=0.0, inertia=(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


def one_friction_a_link(tree: Robot) -> tuple[Robot, dict[str, str]]:
    """The same tree with one friction in every link.

    A caster that is lumped into its chassis has another friction than the chassis. Where a link has
    several, all but the first go into links without mass that are fixed to it. Gives with the tree
    the link that every link of it belongs to, by name.
    """
    links: list[Link] = []
    joints = list(tree.joints)
    owner = {link.name: link.name for link in tree.links}
    for link in tree.links:
        groups = _by_friction(link)
        if len(groups) < 2:  # noqa: PLR2004  one friction, or none
            links.append(link)
            continue
        first, *others = groups.values()
        links.append(replace(link, collisions=tuple(first)))
        for number, collisions in enumerate(others, 1):
            name = _unused(f"{link.name} surface {number}", owner)
            owner[name] = link.name
            links.append(
                Link(
                    name=name,
                    inertial=NOTHING,
                    collisions=tuple(collisions),
                    self_collide=link.self_collide,
                )
            )
            joints.append(Joint(name=name, type=JointType.FIXED, parent=link.name, child=name))
    return replace(tree, links=tuple(links), joints=tuple(joints)), owner


def _by_friction(link: Link) -> dict[float, list[Collision]]:
    groups: dict[float, list[Collision]] = {}
    for collision in link.collisions:
        groups.setdefault(collision.surface.mu1, []).append(collision)
    return groups


def _unused(name: str, taken: dict[str, str]) -> str:
    while name in taken:
        name += "'"
    return name
