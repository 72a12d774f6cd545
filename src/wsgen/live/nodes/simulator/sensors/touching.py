"""What a contact sensor is touched by. No ROS in here.

An engine knows which links touch, not which of their collisions: a link with several is one here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.model.robot import Link, Robot
    from wsgen.simulation.engine import Contact

LUMPED = "_fixed_joint_lump__"  # sdformat's mark of what was on a lumped link
GROUND = "ground_plane::link::collision"


class Touched(NamedTuple):
    """All points where a sensor touches one other link."""

    own: str  # names of collisions, with their models and links
    other: str
    points: tuple[Contact, ...]


def collision_names(link: Link, *, is_urdf: bool) -> list[str]:
    """What Gazebo calls the collisions of a link, of URDF as sdformat names them."""
    if not is_urdf:
        return [shape.name or "" for shape in link.collisions]
    names = []
    for index, shape in enumerate(link.collisions):
        name = (shape.name or link.name) + "_collision" + (f"_{index}" if index else "")
        names.append(name if name.startswith(link.name) else link.name + LUMPED + name)
    return names


def touched(
    contacts: Iterable[Contact],
    link: str,
    own: str,
    entity: str,
    names: Mapping[tuple[str, str], str],
) -> list[Touched]:
    """The contacts of a link, by what it touches.

    Args:
        contacts: All contacts of its robot.
        link: The link.
        own: The collision of it.
        entity: Its robot.
        names: The first collision of each link, by entity and link.
    """
    by_other: dict[str, list[Contact]] = {}
    for contact in contacts:
        if contact.link == link:
            place = contact.other_entity, contact.other_link
            other = GROUND
            if place[0] is not None and place[1] is not None:
                other = scoped(place[0], place[1], names.get((place[0], place[1]), "collision"))
            by_other.setdefault(other, []).append(contact)
    name = scoped(entity, link, own)
    return [Touched(name, other, tuple(points)) for other, points in by_other.items()]


def scoped(entity: str, link: str, collision: str) -> str:
    """The name of a collision with its model and link."""
    return f"{entity}::{link}::{collision}"


def first_collisions(robots: Mapping[str, tuple[Robot, bool]]) -> dict[tuple[str, str], str]:
    """The first collision of each link; of each robot is given whether it is of URDF."""
    return {
        (entity, link.name): names[0]
        for entity, (robot, is_urdf) in robots.items()
        for link in robot.links
        if (names := collision_names(link, is_urdf=is_urdf))
    }
