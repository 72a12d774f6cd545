"""Joints that mimic others: the others have to exist, and may not mimic back."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.model.robot import Joint
    from wsgen.world.scopes import Node


def with_leaders(joints: tuple[Joint, ...], nodes: dict[str, Node]) -> tuple[Joint, ...]:
    """The joints with the full names of those that they mimic.

    One that mimics no other joint, or itself by way of others, is reported and mimics nothing.
    `nodes` has the elements of the joints by their full names.
    """
    followers = {joint.name: joint.mimic for joint in joints if joint.mimic is not None}
    if not followers:
        return joints
    names = {id(nodes[joint.name]): joint.name for joint in joints}
    leader_of: dict[str, str] = {}
    for name, mimic in followers.items():
        leader = nodes[name].scope.lookup(mimic.joint)
        found = None if leader is None else names.get(id(leader))
        if found is None or _leads_to(found, name, leader_of):
            _report(nodes[name], name, mimic.joint)
        else:
            leader_of[name] = found
    return tuple(
        replace(
            joint,
            mimic=replace(joint.mimic, joint=leader_of[joint.name])
            if joint.mimic is not None and joint.name in leader_of
            else None,
        )
        for joint in joints
    )


def _leads_to(start: str, end: str, leader_of: dict[str, str]) -> bool:
    place: str | None = start
    while place is not None and place != end:
        place = leader_of.get(place)
    return place == end


def _report(node: Node, name: str, leader: str) -> None:
    node.source.error(
        "WLD028",
        f"The joint `{name}` mimics `{leader}`, which is no joint of the trial that moves by "
        "itself.",
        at=node.element,
        hint="Name another joint of this model: revolute, continuous or prismatic.",
    )
