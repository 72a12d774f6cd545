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
from wsgen.model.inertia import made_possible
from wsgen.model.robot import JointType, Mesh
from wsgen.porting.existing.inertias import DENSITY, filled, misplaced

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.checks.fixes.source import Tag
    from wsgen.descriptions.meshes.requests import Solid
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Joint, Link, Robot
    from wsgen.model.transform import Vector
    from wsgen.porting.existing.made_meshes import MadeMeshes


HEAVY = 100_000  # triangles of a collision mesh
MOST_ROUNDS = 20  # one fix may show the next mistake, behind each dropped link another one
NEEDS_EXTRA = "pip install 'wsgen[decompose]'"
_LIGHT = 1e-5  # kg, of a link that Gazebo Classic would drop; it keeps what has more than 1e-6
_SMALL = (0.01, 1e-5)  # kg and kg m², of a link without mass and shape
_FREE = (1000.0, 100.0)  # N m (N) and rad/s (m/s), of a joint without effort and velocity
_WIDE = 3.14159  # rad or m to both sides, of a joint whose limits are equal
_ROOTS = "several-roots"
_UNUSABLE = re.compile(r"[^\w./-]+", re.ASCII)
_SCALE = re.compile(r'scale="([^"]+)"')
_TOO_MANY = re.compile(r'(\w+)="([^"]*)": it has (\d+) instead of (\d+) numbers')
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


Diagnose = Callable[[str], "tuple[Robot | None, Iterable[Diagnostic]]"]


def fix(
    text: str, file: Path, diagnose: Diagnose, meshes: MadeMeshes, *, are_ranges_meant: bool = False
) -> Fixed:
    """Make all fixes of a URDF.

    Args:
        text: The URDF.
        file: What it is from.
        diagnose: Reads a text, with the paths and bounds of its meshes.
        meshes: Measures and writes meshes.
        are_ranges_meant: Whether joints with equal limits are to be held by them.
    """
    fixing = _Fixing(file, meshes, are_ranges_meant=are_ranges_meant)
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


def around(tags: Iterable[Tag], edits: Iterable[Edit]) -> Iterable[str]:
    """The links and joints in which edits are."""
    listed = list(edits)
    for tag in tags:
        if tag.name in {"link", "joint"} and len(tag.path) == 1:
            end = _end_of(tag)
            if any(tag.start.start <= edit.start < end for edit in listed):
                yield _name_of(tag)


class _Fixing:
    """The fixes of one text, round by round."""

    def __init__(self, file: Path, meshes: MadeMeshes, *, are_ranges_meant: bool) -> None:
        self.file, self.meshes = file, meshes
        self.are_ranges_meant = are_ranges_meant
        self.fixes: list[Fix] = []
        self.refused: list[str] = []
        self.links: dict[str, str] = {}
        self.joints: dict[str, str] = {}
        self.parts: dict[str, tuple[str, ...]] = {}  # of a mesh, by its path
        self.solids: dict[tuple[str, Vector], Solid | None] = {}  # by path and scale of a mesh
        self.hulls: set[str] = set()  # names of meshes, with those that have none
        self.are_inertias_known = False

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
            planned += [] if robot is None else self._misplaced(robot)
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
        if fixer is not None and special in {None, _Fixing.numbers}:
            edits = tuple(fixer(found, SourceText(self.file, self.text)))
            if edits:
                names = tuple(around(self.tags, edits))
                where = "".join(
                    f"`{one}`: " for one in names[:1] if f"`{one}`" not in found.message
                )
                yield Fix(f"{where}{found.message} {found.hint or ''}".strip(), names, edits)

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
                    and old in {value.text, value.text.strip()}
                    and not (key == "parent" and kind == "joint")
                ):
                    yield Edit(start=value.value.start, end=value.value.end, text=new)
            inside = tag.content()
            if (
                tag.end
                and self.text[inside.start : inside.end].strip() == old.strip()
                and len(tag.path) > 1
            ):
                yield Edit(start=inside.start, end=inside.end, text=new)

    def inertia(self, found: Diagnostic, robot: Robot) -> Iterable[Fix]:
        """A mass and an inertia for links that have none, from their shapes."""
        light = [one for one in robot.links if not (one.inertial and one.inertial.mass > 0)]
        shapes = (one.geometry for link in light for one in link.collisions or link.visuals)
        meshes = ((one.path, one.scale) for one in shapes if isinstance(one, Mesh) and one.path)
        self._measure([*meshes])  # in one child process
        for name in dict.fromkeys(_LINK.findall(found.element or "")):
            link = next((one for one in robot.links if one.name == name), None)
            tag = self.element("link", name)
            if link is None or tag is None or (link.inertial and link.inertial.mass > 0):
                continue
            yield from self._fill(link, tag)

    def _fill(self, link: Link, tag: Tag) -> Iterable[Fix]:
        shapes = [(one.geometry, one.pose_in_link) for one in link.collisions or link.visuals]
        body = filled(shapes, self._measure)
        mass, center, six = body.mass, body.center, body.inertia
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

    def _measure(self, requests: Sequence[tuple[str, Vector]]) -> list[Solid | None]:
        """Measure meshes, each one once."""
        new = [one for one in dict.fromkeys(requests) if one not in self.solids]
        if new:
            self.solids |= zip(new, self.meshes.measure(new), strict=True)
        return [self.solids[one] for one in requests]

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

    def numbers(self, found: Diagnostic, _robot: Robot) -> Iterable[Fix]:
        """The first numbers of an attribute that has too many, as other programs read it."""
        problem = _TOO_MANY.match(found.message)
        if problem is None or int(problem[3]) <= int(problem[4]):
            return
        name, text = problem[1], problem[2]
        kept = " ".join(text.split()[: int(problem[4])])
        for tag in self.tags:
            if _attribute(tag, name) == text:
                around = next((_name_of(one) for one in tag.path[1:2]), _name_of(tag))
                yield Fix(
                    f'Took {name}="{kept}" for {name}="{text}" in `{around}`.',
                    (around,),
                    (_set(tag, name, kept),),
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
        """Convex bodies in place of collision meshes with very many triangles."""
        heavy = heavy_collisions(robot)
        for tag in self.tags:
            uri = _attribute(tag, "filename")
            collision = next((one for one in tag.path if one.name == "collision"), None)
            mesh = heavy.get(uri) if tag.name == "mesh" and collision else None
            if mesh is None or mesh.path is None or uri in self.hulls:
                continue
            if mesh.path not in self.parts:
                self.parts[mesh.path] = self.meshes.parts(mesh.path)
                self.hulls.update(self.parts[mesh.path] or [uri])
            parts, short = self.parts[mesh.path], uri.rpartition("/")[2]
            what = f"`{short}` ({mesh.triangles:,} triangles)"
            if not parts:
                self.refused.append(
                    f"The collision mesh {what} stays as it is: {NEEDS_EXTRA} makes convex"
                    " bodies of it."
                )
                continue
            taken = f"{len(parts)} convex parts" if len(parts) > 1 else "the convex hull"
            other = f" ({NEEDS_EXTRA} finds its parts)" if parts[0].endswith("_hull.stl") else ""
            whole = next(one for one in self.tags if collision and one.start == collision.start)
            yield Fix(
                f"Took {taken} of {what} for the collision of `{_link_of(tag)}`{other}.",
                (_link_of(tag),),
                (_replacement(whole, "\n    ".join(self._copies(whole, tag, parts))),),
            )

    def _copies(self, whole: Tag, mesh: Tag, names: Sequence[str]) -> Iterable[str]:
        """An element <collision> for each mesh."""
        start, end = whole.start.start, _end_of(whole)
        written = whole.attributes.get("name")
        for number, name in enumerate(names, 1):
            place = mesh.attributes["filename"].value
            edits = [Edit(start=place.start - start, end=place.end - start, text=name)]
            if written is not None and number > 1:
                place = written.value
                text = f"{written.text}_{number}"
                edits.append(Edit(start=place.start - start, end=place.end - start, text=text))
            yield apply(self.text[start:end], edits)

    def _misplaced(self, robot: Robot) -> Iterable[Fix]:
        """The inertia about the center of mass, of links that have it about another point."""
        if self.are_inertias_known:
            return
        self.are_inertias_known = True
        for found in misplaced(robot, self.meshes.measure):
            link = self.element("link", found.link)
            inside = (one for one in self.tags if link and link.start in _starts(one))
            tag = next((one for one in inside if one.name == "inertia"), None)
            if tag is None:
                continue
            turned = [
                _set(one, "rpy", "0 0 0")
                for one in self.tags
                if one.name == "origin"
                and "rpy" in one.attributes
                and one.path[-1].start == tag.path[-1].start
            ]
            yield Fix(
                f"Moved the inertia of `{found.link}` to its center of mass: by its meshes, it was"
                f" that {found.where}.",
                (found.link,),
                (_replacement(tag, _inertia(found.inertia)), *turned),
            )

    def light(self, found: Diagnostic, robot: Robot) -> Iterable[Fix]:
        """A mass that Gazebo keeps; or, of one in grams, the mass that fits its inertia."""
        in_grams = re.search(r'<mass value="([^"]+)"', found.hint or "")
        for name in _LINK.findall(found.element or ""):
            link = next((one for one in robot.links if one.name == name), None)
            tag = self.element("link", name)
            inside = [one for one in self.tags if tag and tag.start in _starts(one)]
            mass = next((one for one in inside if one.name == "mass"), None)
            inertia = next((one for one in inside if one.name == "inertia"), None)
            if link is None or link.inertial is None or mass is None or inertia is None:
                continue
            if in_grams:
                yield Fix(
                    f"Divided the mass of `{name}` by 1000: it was in grams, as its"
                    " inertia and its shape show.",
                    (name,),
                    (_set(mass, "value", in_grams[1]),),
                )
            else:
                least, more = _LIGHT, _LIGHT - link.inertial.mass
                xx, xy, xz, yy, yz, zz = link.inertial.inertia
                moment = 0.4 * more * 1e-4  # of a ball with a radius of a centimeter
                six = (xx + moment, xy, xz, yy + moment, yz, zz + moment)
                yield Fix(
                    f"Raised the mass of `{name}` from {link.inertial.mass:g} to {least:g} kg, as"
                    " Gazebo drops what is lighter than a milligram.",
                    (name,),
                    (_set(mass, "value", f"{least:g}"), _replacement(inertia, _inertia(six))),
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
            if self.are_ranges_meant and joint.limit:
                values |= {"lower": joint.limit.lower, "upper": joint.limit.upper}
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
    "implausible-mass": _Fixing.light,
    "not-a-number": _Fixing.numbers,
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


def heavy_collisions(robot: Robot) -> dict[str, Mesh]:
    """The meshes of collisions with very many triangles, by their names."""
    return {
        one.geometry.uri: one.geometry
        for link in robot.links
        for one in link.collisions
        if isinstance(one.geometry, Mesh) and (one.geometry.triangles or 0) > HEAVY
    }


def fixable(found: Iterable[Diagnostic]) -> list[str]:
    """The names of the rules that `fix` may have something for."""
    known = {*_SPECIAL, *FIXERS, _ROOTS}
    return sorted({one.name for one in found if one.name in known})
