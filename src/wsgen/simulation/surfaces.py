"""Which shapes of a link an engine gets together: those of one friction, those that stand."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.robot import Inertial, Joint, JointType, Link
from wsgen.model.trees import split_trees
from wsgen.simulation.extents import inside_hull

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.model.robot import Robot

# MAX_DEGREE_OF_FREEDOM in PyBullet's SharedMemoryCommands.h; with more, reading a pose raises.
MOST_LINKS = 128

# Of one friction in one link; with more of them, those inside the convex hull do not touch the
# ground. A thousand boxes flat on the ground are 4000 contacts, of which four hold them.
MOST_STANDING = 16

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
        links.append(replace(link, collisions=tuple(link.collisions[place] for place in first)))
        for number, collisions in enumerate(others, 1):
            name = _unused(f"{link.name} surface {number}", owner)
            owner[name] = link.name
            part, joint = _part_of(link, name, collisions)
            links.append(part)
            joints.append(joint)
    return replace(tree, links=tuple(links), joints=tuple(joints)), owner


def most_parts(robot: Robot) -> int:
    """How many links with one friction each the largest of its trees has."""
    return max(
        (len(one_friction_a_link(tree)[0].links) for tree, _ in split_trees(robot)), default=0
    )


def inner_collisions(link: Link) -> set[int]:
    """The numbers of those collisions that level ground need not touch.

    A plane holds a body by the convex hull of what touches it. What of one friction does not span
    the hull of its kind is in the air, or on the ground between others that hold the body without
    it: then only the distribution of the friction is another one. In an ordinary robot it is none.
    """
    inner: set[int] = set()
    for numbers in _by_friction(link).values():
        if len(numbers) > MOST_STANDING:
            inside = inside_hull([link.collisions[number] for number in numbers])
            inner |= {numbers[place] for place in inside}
    return inner


def inner_apart(
    tree: Robot, owner: Mapping[str, str]
) -> tuple[Robot, dict[str, str], tuple[str, ...]]:
    """A tree and its owners, as of `one_friction_a_link`, with the inner collisions apart.

    They are in links without mass that are fixed to theirs; the names of these come with the tree.
    What is static, which the ground does not touch, stays as it is, and so does a tree that would
    have more than `MOST_LINKS`.
    """
    links: list[Link] = []
    joints = list(tree.joints)
    owner_of = dict(owner)
    apart: list[str] = []
    for link in tree.links:
        inner = set() if tree.is_static else inner_collisions(link)
        if not inner:
            links.append(link)
            continue
        outer = [shape for number, shape in enumerate(link.collisions) if number not in inner]
        name = _unused(f"{link.name} inside", owner_of)
        owner_of[name] = owner[link.name]
        apart.append(name)
        part, joint = _part_of(link, name, sorted(inner))
        links += [replace(link, collisions=tuple(outer)), part]
        joints.append(joint)
    if len(links) > MOST_LINKS:
        return tree, dict(owner), ()
    return replace(tree, links=tuple(links), joints=tuple(joints)), owner_of, tuple(apart)


def _part_of(link: Link, name: str, numbers: Iterable[int]) -> tuple[Link, Joint]:
    """A link without mass for some of a link's collisions, and what fixes it there."""
    part = Link(
        name=name,
        inertial=NOTHING,
        collisions=tuple(link.collisions[number] for number in numbers),
        self_collide=link.self_collide,
    )
    return part, Joint(name=name, type=JointType.FIXED, parent=link.name, child=name)


def _by_friction(link: Link) -> dict[float, list[int]]:
    """The numbers of the collisions of each friction."""
    groups: dict[float, list[int]] = {}
    for number, collision in enumerate(link.collisions):
        groups.setdefault(collision.surface.mu1, []).append(number)
    return groups


def _unused(name: str, taken: Mapping[str, str]) -> str:
    while name in taken:
        name += "'"
    return name
