"""What simulators refuse of a robot, or change: each fix, made with `--fix` and offered without.

A fix edits the URDF. Those of `wsgen check --fix` are made as they are; what a check would not
dare to decide is decided here, and said.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.plan import FIXERS
from wsgen.checks.fixes.source import Edit, SourceText, apply, children, overlap, read_tags
from wsgen.model.inertia import made_possible, moved, of_solid
from wsgen.model.robot import Box, Capsule, Cylinder, JointType, Mesh, Sphere
from wsgen.model.transform import multiply, rotate, rotation_of_rpy, transpose

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.checks.fixes.source import Tag
    from wsgen.descriptions.meshes.requests import Solid
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Geometry, Joint, Link, Robot
    from wsgen.model.transform import Pose, Vector


DENSITY = 1000.0  # kg/m³, of a link without a mass; that of water, and of many robots on average
HEAVY = 100_000  # triangles of a collision mesh
MOST_ROUNDS = 20  # one fix may show the next mistake, behind each dropped link another one
_SMALL = (0.01, 1e-5)  # kg and kg m², of a link without mass and shape
_FREE = (1000.0, 100.0)  # N m (N) and rad/s (m/s), of a joint without effort and velocity
_WIDE = 3.14159  # rad or m to both sides, of a joint whose limits are equal
_ROOTS = "several-roots"
_UNUSABLE = re.compile(r"[^\w./-]+", re.ASCII)
_SCALE = re.compile(r'scale="([^"]+)"')
_LINK = re.compile(r"link\[@name='([^']*)'\]")
_JOINT = re.compile(r"joint\[@name='([^']*)'\]")
# Attributes that name a link or a joint; `name` does so in some elements.
_NAMING = ("link", "joint", "reference", "parent", "child")


class Fix(NamedTuple):
    """A change of the text, and what it is."""

    sentence: str
    names: tuple[str, ...]  # of the links and joints that it changes
    edits: tuple[Edit, ...]


class Fixed(NamedTuple):
    """A text after its fixes."""

    text: str
    fixes: tuple[Fix, ...]
    links: dict[str, str]  # old name -> new name
    joints: dict[str, str]
    refused: tuple[str, ...]  # sentences: what could not be fixed


Mirrored = tuple[str, "Vector"]


class Meshes(NamedTuple):
    """What fixes may ask of meshes."""

    measure: Callable[[Sequence[tuple[str, Vector]]], list[Solid | None]]
    # Path and signs -> the name of the new mesh.
    mirror: Callable[[Sequence[Mirrored]], dict[Mirrored, str]]
    hull: Callable[[str], str | None]  # path -> the name of the new mesh


Diagnose = Callable[[str], "tuple[Robot | None, Iterable[Diagnostic]]"]


def fix(text: str, file: Path, diagnose: Diagnose, meshes: Meshes) -> Fixed:
    """Make all fixes of a URDF.

    Args:
        text: The URDF.
        file: What it is from.
        diagnose: Reads a text, with the paths and bounds of its meshes.
        meshes: Measures and writes meshes.
    """
    fixing = _Fixing(file, meshes)
    for _ in range(MOST_ROUNDS):
        robot, found = diagnose(text)
        after = fixing.make(text, robot, found)
        if after == text:
            break
        text = after
    refused = tuple(dict.fromkeys(fixing.refused))
    return Fixed(text, tuple(fixing.fixes), fixing.links, fixing.joints, refused)


def without_missing(text: str, missing: Iterable[str]) -> tuple[str, list[Fix]]:
    """A text without the visuals and collisions whose meshes do not exist."""
    lost = set(missing)
    fixes = []
    for tag in read_tags(text):
        named = tag.attributes.get("filename")
        shape = next((one for one in tag.path if one.name in {"visual", "collision"}), None)
        if tag.name == "mesh" and named and named.text in lost and shape is not None:
            whole = next(one for one in read_tags(text) if one.start == shape.start)
            link = _name_of(tag.path[1]) if len(tag.path) > 1 else ""
            fixes.append(
                Fix(
                    f"Left out the {shape.name} of `{link}`: its mesh `{named.text}` is missing.",
                    (link,),
                    (_removal(whole),),
                )
            )
    return apply(text, [edit for one in fixes for edit in one.edits]), fixes


class _Fixing:
    """The fixes of one text, round by round."""

    def __init__(self, file: Path, meshes: Meshes) -> None:
        self.file, self.meshes = file, meshes
        self.fixes: list[Fix] = []
        self.refused: list[str] = []
        self.links: dict[str, str] = {}
        self.joints: dict[str, str] = {}
        self.hulls: set[str] = set()  # names of meshes, with those that have none

    def make(self, text: str, robot: Robot | None, found: Iterable[Diagnostic]) -> str:
        """The text with the fixes of a round, which do not touch each other."""
        self.tags = read_tags(text)
        self.text = text
        planned: list[Fix] = []
        if robot is None:
            planned += self._roots(found)
        else:
            planned += self._names(robot)
        if not planned:  # names first: the others are found by them
            found = list(found)
            whole = {one.name: one for one in found if one.name in _WHOLE}
            for one in (*(one for one in found if one.name not in whole), *whole.values()):
                planned += self._fix_one(one, robot)
            planned += [] if robot is None else self._heavy(robot)
        edits: list[Edit] = []
        for fix_ in planned:
            if fix_.edits and not overlap(fix_.edits, edits):
                edits += fix_.edits
                self.fixes.append(fix_)
        return apply(text, edits)

    def _fix_one(self, found: Diagnostic, robot: Robot | None) -> Iterable[Fix]:
        special = _SPECIAL.get(found.name)
        if special is not None and robot is not None:
            yield from special(self, found, robot)
        fixer = FIXERS.get(found.name)
        if fixer is not None and special is None:
            edits = tuple(fixer(found, SourceText(self.file, self.text)))
            if edits:
                yield Fix(
                    f"{found.message} {found.hint or ''}".strip(), tuple(self._around(edits)), edits
                )

    def _around(self, edits: Iterable[Edit]) -> Iterable[str]:
        """The links and joints in which edits are."""
        for tag in self.tags:
            if tag.name in {"link", "joint"} and len(tag.path) == 1:
                end = _end_of(tag)
                if any(tag.start.start <= edit.start < end for edit in edits):
                    yield _name_of(tag)

    def element(self, kind: str, name: str) -> Tag | None:
        """The link or joint of the robot with a name."""
        return next(
            (
                one
                for one in self.tags
                if one.name == kind and len(one.path) == 1 and _name_of(one) == name
            ),
            None,
        )

    def _roots(self, found: Iterable[Diagnostic]) -> Iterable[Fix]:
        """Attach other roots to the root of the largest tree."""
        if not any(one.name == _ROOTS for one in found):
            return
        top = [one for one in self.tags if len(one.path) == 1]
        links = [_name_of(one) for one in top if one.name == "link"]
        below: dict[str, list[str]] = {}
        ends = {
            side: {
                one.path[-1].start: _attribute(one, "link") for one in self.tags if one.name == side
            }
            for side in ("parent", "child")
        }
        for place, child in ends["child"].items():
            below.setdefault(ends["parent"].get(place, ""), []).append(child)
        childs = {one for names in below.values() for one in names}
        roots = [one for one in links if one not in childs]

        def count(name: str, seen: frozenset[str] = frozenset()) -> int:
            if name in seen:
                return 0
            return 1 + sum(count(one, seen | {name}) for one in below.get(name, ()))

        first = max(roots, key=count, default=None)
        robot = next((one for one in self.tags if one.name == "robot" and one.end), None)
        if first is None or robot is None or robot.end is None:
            return
        for root in roots:
            if root != first:
                joint, end = f"{first}_to_{root}", robot.end.start
                text = (
                    f'  <joint name="{joint}" type="fixed">\n    <parent link="{first}"/>\n'
                    f'    <child link="{root}"/>\n  </joint>\n'
                )
                yield Fix(
                    f"Attached the second root `{root}` to the origin of `{first}` by the fixed"
                    f" joint `{joint}`: give it an <origin>.",
                    (root, joint),
                    (Edit(start=end, end=end, text=text),),
                )

    def _names(self, robot: Robot) -> Iterable[Fix]:
        """Names that a simulator or ROS cannot have, and joints that are called as a link is."""
        links = {one.name for one in robot.links}
        taken = links | {one.name for one in robot.joints}
        for kind, names, known in (
            ("link", [one.name for one in robot.links], self.links),
            ("joint", [one.name for one in robot.joints], self.joints),
        ):
            for old in names:
                name = _UNUSABLE.sub("_", old).strip("_") or kind
                if kind == "joint" and name in links:
                    name = f"{name}_joint"
                if name == old:
                    continue
                number, plain = 1, name
                while name in taken:
                    number += 1
                    name = f"{plain}_{number}"
                taken.add(name)
                known[old] = name
                edits = tuple(self._renaming(kind, old, name))
                yield Fix(f"Renamed the {kind} `{old}` to `{name}`.", (old,), edits)

    def _renaming(self, kind: str, old: str, new: str) -> Iterable[Edit]:
        """Where a name stands: in attributes, and as the text of an element."""
        other = "joint" if kind == "link" else "link"
        for tag in self.tags:
            for key, value in tag.attributes.items():
                is_name = (key == "name" and tag.name == kind) or (key in _NAMING and key != other)
                if (
                    is_name
                    and value.text.strip() == old
                    and not (key == "parent" and kind == "joint")
                ):
                    yield Edit(start=value.value.start, end=value.value.end, text=new)
            inside = tag.content()
            if (
                tag.end
                and self.text[inside.start : inside.end].strip() == old
                and len(tag.path) > 1
            ):
                yield Edit(start=inside.start, end=inside.end, text=new)

    def inertia(self, found: Diagnostic, robot: Robot) -> Iterable[Fix]:
        """A mass and an inertia for links that have none, from their shapes."""
        for name in dict.fromkeys(_LINK.findall(found.element or "")):
            link = next((one for one in robot.links if one.name == name), None)
            tag = self.element("link", name)
            if link is None or tag is None or (link.inertial and link.inertial.mass > 0):
                continue
            yield from self._fill(link, tag)

    def _fill(self, link: Link, tag: Tag) -> Iterable[Fix]:
        shapes = [(one.geometry, one.pose_in_link) for one in link.collisions or link.visuals]
        mass, center, six = self._of_shapes(shapes)
        what = f"from its shapes and a density of {DENSITY:g} kg/m³"
        if mass <= 0:
            mass, small = _SMALL
            center, six = (0.0, 0.0, 0.0), (small, 0.0, 0.0, small, 0.0, small)
            what = "of a small part, as it has no shape with a volume"
        written = (
            f'<inertial>\n      <origin xyz="{_numbers(center)}"/>\n'
            f'      <mass value="{mass:.9g}"/>\n      {_inertia(six)}\n    </inertial>'
        )
        before = next((one for one in children(self.tags, tag) if one.name == "inertial"), None)
        yield Fix(
            f"Gave the link `{link.name}` a mass of {mass:.4g} kg and an inertia {what}.",
            (link.name,),
            (_replacement(before, written) if before else _insertion(self.text, tag, written),),
        )

    def _of_shapes(
        self, shapes: Sequence[tuple[Geometry, Pose]]
    ) -> tuple[float, Vector, tuple[float, ...]]:
        """Mass, center and inertia of shapes that are filled."""
        meshes = [(one.path, one.scale) for one, _ in shapes if isinstance(one, Mesh) and one.path]
        solids = dict(zip(meshes, self.meshes.measure(meshes), strict=True)) if meshes else {}
        bodies = []
        for geometry, pose in shapes:
            body = _solid_of(geometry, solids)
            if body is not None:
                bodies.append((*body, pose))
        mass = sum(one[0] for one in bodies)
        if mass <= 0:
            return 0.0, (0.0, 0.0, 0.0), ()
        placed = []
        for own, at, six, pose in bodies:
            turn = rotation_of_rpy(pose.rpy)
            x, y, z = rotate(turn, at)
            matrix = ((six[0], six[1], six[2]), (six[1], six[3], six[4]), (six[2], six[4], six[5]))
            turned = multiply(multiply(turn, matrix), transpose(turn))
            placed.append((own, (pose.x + x, pose.y + y, pose.z + z), turned))
        center = tuple(sum(own * at[i] for own, at, _ in placed) / mass for i in range(3))
        total = [0.0] * 6
        for own, at, m in placed:
            offset = (at[0] - center[0], at[1] - center[1], at[2] - center[2])
            six = moved((m[0][0], m[0][1], m[0][2], m[1][1], m[1][2], m[2][2]), own, offset)
            total = [a + b for a, b in zip(total, six, strict=True)]
        return mass, (center[0], center[1], center[2]), tuple(total)

    def zero_masses(self, _found: Diagnostic, robot: Robot) -> Iterable[Fix]:
        """Leave out <inertial> of mass 0 of links that are fixed to others, which lump them."""
        fixed = {one.child for one in robot.joints if one.type is JointType.FIXED}
        for link in robot.links:
            tag = self.element("link", link.name)
            if tag is None or link.inertial is None or link.inertial.mass != 0:
                continue
            inertial = next(
                (one for one in children(self.tags, tag) if one.name == "inertial"), None
            )
            if inertial is not None and link.name in fixed:
                yield Fix(
                    f"Left out the <inertial> of `{link.name}`, whose mass is 0.",
                    (link.name,),
                    (_removal(inertial),),
                )

    def possible(self, found: Diagnostic, robot: Robot) -> Iterable[Fix]:
        """The nearest inertia that a body can have."""
        for name in dict.fromkeys(_LINK.findall(found.element or "")):
            link = next((one for one in robot.links if one.name == name), None)
            tag = self.element("link", name)
            if link is None or tag is None or link.inertial is None:
                continue
            if link.inertial.mass <= 0:
                yield from self._fill(link, tag)
                continue
            inertia = next(
                (one for one in self.tags if one.name == "inertia" and tag.start in _starts(one)),
                None,
            )
            six = made_possible(link.inertial.inertia)
            # A body of this mass has at least that of a ball with a radius of a centimeter.
            least = 0.4 * link.inertial.mass * 1e-4
            if max(map(abs, six)) <= 0:
                six = (least, 0.0, 0.0, least, 0.0, least)
            if inertia is None or six == link.inertial.inertia:
                continue
            yield Fix(
                f"Raised the moments of inertia of `{name}` to the nearest that a body can have.",
                (name,),
                (_replacement(inertia, _inertia(six)),),
            )

    def scale(self, found: Diagnostic, _robot: Robot) -> Iterable[Fix]:
        """The scale that the diagnostic suggests, for a mesh that is not in meters."""
        suggested = _SCALE.search(found.hint or "")
        names = _LINK.findall(found.element or "")
        uri = re.search(r"mesh `([^`]*)`", found.message)
        if suggested is None or not names or uri is None:
            return
        for tag in self.tags:
            written = tag.attributes.get("filename")
            if tag.name != "mesh" or written is None or written.text != uri[1]:
                continue
            yield Fix(
                f"Scaled the mesh `{uri[1].rpartition('/')[2]}` of `{_link_of(tag)}` by"
                f" {suggested[1]}: it is not in meters.",
                (_link_of(tag),),
                (_set(tag, "scale", suggested[1]),),
            )

    def mirror(self, _found: Diagnostic, robot: Robot) -> Iterable[Fix]:
        """Mirrored copies of meshes whose scale is negative."""
        paths = {
            (one.geometry.uri, one.geometry.scale): one.geometry.path
            for link in robot.links
            for one in link.collisions
            if isinstance(one.geometry, Mesh)
        }
        mirrored: list[tuple[Tag, str, Vector]] = []
        for tag in self.tags:
            if tag.name != "mesh" or not any(one.name == "collision" for one in tag.path):
                continue
            try:
                x, y, z = map(float, _attribute(tag, "scale").split())
            except ValueError:
                continue
            path = paths.get((_attribute(tag, "filename"), (x, y, z)))
            if path is not None and min(x, y, z) < 0:
                mirrored.append((tag, path, (x, y, z)))
        wanted = {
            (path, (math.copysign(1, x), math.copysign(1, y), math.copysign(1, z)))
            for _, path, (x, y, z) in mirrored
        }
        names = self.meshes.mirror(sorted(wanted))
        for tag, path, (x, y, z) in mirrored:
            signs = (math.copysign(1, x), math.copysign(1, y), math.copysign(1, z))
            name = names.get((path, signs))
            if name is None:
                continue
            short = _attribute(tag, "filename").rpartition("/")[2]
            yield Fix(
                f"Mirrored the collision mesh `{short}` of `{_link_of(tag)}` in a copy,"
                f" {name.rpartition('/')[2]}.",
                (_link_of(tag),),
                (_set(tag, "filename", name), _set(tag, "scale", _numbers(map(abs, (x, y, z))))),
            )

    def _heavy(self, robot: Robot) -> Iterable[Fix]:
        """Convex hulls in place of collision meshes with very many triangles."""
        heavy = {
            one.geometry.uri: one.geometry
            for link in robot.links
            for one in link.collisions
            if isinstance(one.geometry, Mesh) and (one.geometry.triangles or 0) > HEAVY
        }
        hulls: dict[str, str | None] = {}
        for tag in self.tags:
            written = tag.attributes.get("filename")
            if written is not None and written.text in self.hulls:
                continue
            mesh = heavy.get(written.text) if written and tag.name == "mesh" else None
            if mesh is None or written is None or mesh.path is None:
                continue
            if not any(one.name == "collision" for one in tag.path):
                continue
            if mesh.path not in hulls:
                hulls[mesh.path] = self.meshes.hull(mesh.path)
                self.hulls.add(hulls[mesh.path] or written.text)
            hull, short = hulls[mesh.path], written.text.rpartition("/")[2]
            if hull is None:
                self.refused.append(
                    f"The collision mesh `{short}` has {mesh.triangles:,} triangles: its convex"
                    " hull needs scipy (pip install scipy)."
                )
                continue
            yield Fix(
                f"Took the convex hull of `{short}` ({mesh.triangles:,} triangles) for the"
                f" collision of `{_link_of(tag)}`.",
                (_link_of(tag),),
                (Edit(start=written.value.start, end=written.value.end, text=hull),),
            )

    def limit(self, found: Diagnostic, robot: Robot) -> Iterable[Fix]:
        """Limits with which a joint can move."""
        for name in dict.fromkeys(_JOINT.findall(found.element or "")):
            joint = next((one for one in robot.joints if one.name == name), None)
            tag = self.element("joint", name)
            if joint is None or tag is None or joint.type not in _LIMITED:
                continue
            limit = next((one for one in children(self.tags, tag) if one.name == "limit"), None)
            values = _limits_of(joint)
            text = " ".join(f'{key}="{value:.9g}"' for key, value in values.items())
            written = f"<limit {text}/>"
            changed = ", ".join(
                f"{key} {value:g}"
                for key, value in values.items()
                if joint.limit is None or getattr(joint.limit, key) != value
            )
            if not changed:
                continue
            yield Fix(
                f"Gave the joint `{name}` a limit with which it can move: {changed}.",
                (name,),
                (_replacement(limit, written) if limit else _insertion(self.text, tag, written),),
            )


_LIMITED = (JointType.REVOLUTE, JointType.PRISMATIC, JointType.CONTINUOUS)
# These change all of their kind at once.
_WHOLE = ("mirrored-collision-mesh", "two-zero-masses")
_Special = Callable[["_Fixing", "Diagnostic", "Robot"], Iterable[Fix]]
_SPECIAL: dict[str, _Special] = {
    **dict.fromkeys(
        ("dropped-link", "incomplete-inertial", "negative-mass", "dropped-by-old-sdformat"),
        _Fixing.inertia,
    ),
    "two-zero-masses": _Fixing.zero_masses,
    "impossible-inertia": _Fixing.possible,
    "implausible-mesh-size": _Fixing.scale,
    "mirrored-collision-mesh": _Fixing.mirror,
    **dict.fromkeys(("no-range", "missing-limit", "zero-effort", "zero-velocity"), _Fixing.limit),
}


def _limits_of(joint: Joint) -> dict[str, float]:
    """The limits of a joint, with others where they are equal or 0."""
    limit = joint.limit
    effort, velocity = _FREE
    values = {
        "effort": limit.effort if limit and limit.effort > 0 else effort,
        "velocity": limit.velocity if limit and limit.velocity > 0 else velocity,
    }
    if joint.type is JointType.CONTINUOUS:
        return values
    lower, upper = (limit.lower, limit.upper) if limit else (0.0, 0.0)
    if lower == upper:
        lower, upper = lower - _WIDE, upper + _WIDE
    return {"lower": lower, "upper": upper, **values}


def _solid_of(
    geometry: Geometry, solids: dict[tuple[str, Vector], Solid | None]
) -> tuple[float, Vector, tuple[float, ...]] | None:
    """Mass, center and inertia (six numbers, about the center) of a filled shape in its frame."""
    if isinstance(geometry, Mesh):
        solid = solids.get((geometry.path or "", geometry.scale))
        if solid is None:
            return None
        return DENSITY * solid.volume, solid.center, tuple(DENSITY * one for one in solid.inertia)
    volume = _volume(geometry)
    moments = None if volume is None else of_solid(geometry, DENSITY * volume)
    if volume is None or moments is None:
        return None
    x, y, z = moments
    return DENSITY * volume, (0.0, 0.0, 0.0), (x, 0.0, 0.0, y, 0.0, z)


def _volume(geometry: Geometry) -> float | None:
    if isinstance(geometry, Box):
        return math.prod(geometry.size)
    if isinstance(geometry, Sphere):
        return 4 / 3 * math.pi * geometry.radius**3
    if isinstance(geometry, Cylinder | Capsule):
        ends = 4 / 3 * math.pi * geometry.radius**3 if isinstance(geometry, Capsule) else 0.0
        return math.pi * geometry.radius**2 * geometry.length + ends
    return None


def _attribute(tag: Tag, name: str) -> str:
    found = tag.attributes.get(name)
    return "" if found is None else found.text


def _name_of(tag: Tag) -> str:
    return _attribute(tag, "name")


def _link_of(tag: Tag) -> str:
    return next((_name_of(one) for one in tag.path if one.name == "link"), "")


def _starts(tag: Tag) -> set[object]:
    return {one.start for one in tag.path}


def _numbers(values: Iterable[float]) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def _end_of(tag: Tag) -> int:
    return tag.end.end if tag.end else tag.start.end


def _inertia(six: Sequence[float]) -> str:
    """An element <inertia>."""
    pairs = zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), six, strict=True)
    text = " ".join(f'{key}="{value:.9g}"' for key, value in pairs)
    return f"<inertia {text}/>"


def _removal(tag: Tag) -> Edit:
    return Edit(start=tag.start.start, end=_end_of(tag), text="")


def _replacement(tag: Tag, text: str) -> Edit:
    return Edit(start=tag.start.start, end=_end_of(tag), text=text)


def _insertion(text: str, tag: Tag, written: str) -> Edit:
    """Write an element into another one, at its beginning."""
    if tag.end is not None:
        place = tag.start.end
        return Edit(start=place, end=place, text=f"\n    {written}")
    opened = text[tag.start.start : tag.start.end].rstrip("/>").rstrip()
    return _replacement(tag, f"{opened}>\n    {written}\n  </{tag.name}>")


def _set(tag: Tag, name: str, value: str) -> Edit:
    """Write an attribute."""
    found = tag.attributes.get(name)
    if found is not None:
        return Edit(start=found.value.start, end=found.value.end, text=value)
    place = tag.start.start + 1 + len(tag.name)
    return Edit(start=place, end=place, text=f' {name}="{value}"')


def fixable(found: Iterable[Diagnostic]) -> list[str]:
    """The names of the rules that `fix` may have something for."""
    known = {*_SPECIAL, *FIXERS, _ROOTS}
    return sorted({one.name for one in found if one.name in known})
