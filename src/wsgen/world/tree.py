"""Links and joints of a model to one tree, with the frames where URDF has them.

In SDF, links and joints have frames of their own, placed as the author likes. In a `Robot`, the
frame of a link is that of the joint above it; only the root keeps its own.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.robot import Joint, JointType, Link, Robot
from wsgen.model.transform import compose, invert
from wsgen.world.frames import canonical_link, pose_in
from wsgen.world.joints import read_joint
from wsgen.world.scopes import WORLD

if TYPE_CHECKING:
    from wsgen.world.joints import Edge
    from wsgen.world.scopes import Node, Scope


class Tree:
    """Links joined one after the other, as long as no link has two parents."""

    def __init__(self, model: Scope, nodes: dict[str, Node], name_of: dict[int, str]) -> None:
        self.model = model
        self.nodes = nodes
        self.name_of = name_of
        self.edge_of: dict[str, tuple[str, Edge]] = {}  # child -> its joint
        self._above = {name: name for name in (*nodes, WORLD)}  # some link nearer to the root

    def root_of(self, link: str) -> str:
        """The root of the tree that a link is in."""
        way = [link]
        while self._above[way[-1]] != way[-1]:
            way.append(self._above[way[-1]])
        for passed in way:
            self._above[passed] = way[-1]
        return way[-1]

    def join(self, name: str, edge: Edge) -> None:
        """Add a joint, unless it closes a chain, which is reported."""
        parent, child = self._parent(edge), self.name_of[id(edge.child)]
        if child in self.edge_of or self.root_of(parent) == self.root_of(child):
            other = self.edge_of.get(child)
            edge.node.source.warning(
                "WLD025",
                f"The joint `{name}` is left out of the trial: it closes a chain"
                + (f" (`{child}` hangs on the joint `{other[0]}` already)." if other else "."),
                at=edge.node.element,
                hint="Gazebo Sim leaves such a joint out as well; Gazebo Classic has it.",
            )
            return
        self.edge_of[child] = (name, edge)
        self._above[child] = self.root_of(parent)

    def report_left_out(self, name: str, edge: Edge) -> None:
        """Report a joint of a type that is left out, and what that sets free."""
        child = self.name_of[id(edge.child)]
        edge.node.source.warning(
            "WLD024",
            f"The joint `{name}` is left out of the trial: no engine of wsgen has "
            f"{edge.node.element.get('type')} joints."
            + ("" if child in self.edge_of else f" The link `{child}` is loose without it."),
            at=edge.node.element,
            hint="Gazebo has them; the trial says nothing about this joint.",
        )

    def frame(self, link: str) -> Pose:
        """The pose in the model of a link's frame, where URDF has it."""
        if link == WORLD:
            return IDENTITY
        node = self.edge_of[link][1].node if link in self.edge_of else self.nodes[link]
        return pose_in(self.model, node)

    def robot(self, links: dict[str, Link], edges: dict[str, Edge]) -> Robot:
        """All links and joints; a world, if there is one, is the first link and the root."""
        is_fixed = any(edge.parent is None for _, edge in self.edge_of.values())
        root = self._root(is_fixed=is_fixed)
        frames = {name: self.frame(name) for name in links}
        frames[WORLD] = IDENTITY
        joint_of = dict(self.edge_of.values())
        loose = [name for name in links if name not in self.edge_of and name != root]
        return Robot(
            name=self.model.name,
            root=root,
            links=(
                *([Link(name=WORLD)] if is_fixed else []),
                *(self._seen_from(frames[name], link) for name, link in links.items()),
            ),
            joints=tuple(
                self._joint(name, joint_of[name], frames) for name in edges if name in joint_of
            ),
            loose=tuple(
                Joint(
                    name=f"{name} (loose)",
                    type=JointType.FLOATING,
                    parent=root,
                    child=name,
                    pose_in_parent=_from(frames[root], frames[name]),
                    line=links[name].line,
                )
                for name in loose
            ),
            fixed_to_world=is_fixed,
            is_static=self.model.is_static,
        )

    def _root(self, *, is_fixed: bool) -> str:
        if is_fixed:
            return WORLD
        canonical = self.name_of.get(id(canonical_link(self.model)))
        return self.root_of(canonical or next(iter(self.nodes)))

    def _parent(self, edge: Edge) -> str:
        return WORLD if edge.parent is None else self.name_of[id(edge.parent)]

    def _joint(self, name: str, edge: Edge, frames: dict[str, Pose]) -> Joint:
        parent, child = self._parent(edge), self.name_of[id(edge.child)]
        return read_joint(
            edge, self.model, (name, parent, child), _from(frames[parent], frames[child])
        )

    def _seen_from(self, frame: Pose, link: Link) -> Link:
        """The link with all that is in it seen from the frame instead of its own."""
        own = pose_in(self.model, self.nodes[link.name])
        if own == frame:
            return link
        offset = _from(frame, own)
        return replace(
            link,
            inertial=link.inertial
            and replace(link.inertial, pose_in_link=compose(offset, link.inertial.pose_in_link)),
            visuals=tuple(
                replace(visual, pose_in_link=compose(offset, visual.pose_in_link))
                for visual in link.visuals
            ),
            collisions=tuple(
                replace(collision, pose_in_link=compose(offset, collision.pose_in_link))
                for collision in link.collisions
            ),
        )


def _from(frame: Pose, pose: Pose) -> Pose:
    """The pose seen from a frame, when both are seen from the same one."""
    return IDENTITY if frame == pose else compose(invert(frame), pose)
