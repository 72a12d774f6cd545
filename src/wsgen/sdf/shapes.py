"""`<visual>`, `<collision>` and `<geometry>` of SDF.

`<ellipsoid>`, `<polyline>` and `<heightmap>` of SDF: what becomes a mesh in a simulation.

`<material>` and `<surface>` of SDF: how shapes look, and how they touch.

Planes: half-spaces without end in Gazebo, the ground or large boxes in a simulation.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.colors import GAZEBO_COLORS
from wsgen.model.robot import (
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Extrusion,
    Heightmap,
    Mesh,
    Sphere,
    Surface,
    Visual,
)
from wsgen.model.transform import Pose, compose, multiply, rotation_of_rpy, rpy_of_rotation
from wsgen.sdf.frames import is_level_at_zero, pose_in
from wsgen.sdf.includes import how_to_have
from wsgen.sdf.lookup import instead_of_file, is_file
from wsgen.sdf.source import line_of
from wsgen.sdf.values import (
    FARTHEST,
    first,
    number,
    optional_number,
    read_numbers,
    read_pose,
    triple,
    word,
)
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.model.robot import Geometry
    from wsgen.model.transform import Matrix
    from wsgen.sdf.frames import Node, Scope
    from wsgen.sdf.includes import Includes
    from wsgen.sdf.source import Source
    from wsgen.xmltree import Element


IMAGES = (".png", ".jpg", ".jpeg")  # anything else Gazebo takes for elevation data
FEWEST_POINTS = 3  # of an outline
MOST_POINTS = 10_000  # of all outlines of a shape
FINEST = 16  # steps from pixel to pixel; Gazebo's own worlds have up to 4


def read_ellipsoid(source: Source, shape: Element) -> Ellipsoid | None:
    """The ellipsoid; None for one without extent, which is reported."""
    radii = triple(source, shape, "radii", default=(1.0, 1.0, 1.0))
    return Ellipsoid(radii=radii) if is_sized(source, shape, radii) else None


def read_extrusion(source: Source, shape: Element, link: str) -> Extrusion | None:
    """What the polylines of a geometry enclose; None, which is reported, if they cannot.

    The height is that of the first, for all.
    """
    height = number(source, shape, "height", default=1.0)
    if not is_sized(source, shape, (height,)):
        return None
    geometry = shape.getparent()
    outlines = []
    for polyline in [shape] if geometry is None else children(geometry, "polyline"):
        points = [
            read_numbers(source, point, 2, limit=FARTHEST) for point in children(polyline, "point")
        ]
        outline = tuple((point[0], point[1]) for point in points if point is not None)
        if len(outline) < len(points):
            return None
        if len(outline) < FEWEST_POINTS:
            source.error(
                "WLD057",
                f"A polyline of the link `{link}` has {len(outline)} points, and encloses nothing.",
                at=polyline,
                hint="Write a <point>x y</point> for each corner of the outline, three at least.",
            )
            return None
        outlines.append(outline)
    count = sum(map(len, outlines))
    if count > MOST_POINTS:
        source.error(
            "WLD057",
            f"The polyline of the link `{link}` has {count:,} points; wsgen takes {MOST_POINTS:,}.",
            at=shape,
            hint="Leave out points that make no difference, or make a mesh of it.",
        )
        return None
    return Extrusion(outlines=tuple(outlines), height=height, line=line_of(shape))


def read_heightmap(
    source: Source, includes: Includes, shape: Element, owner: Element, link: str
) -> Heightmap | None:
    """The heightmap; None, which is reported, where it is left out."""
    uri = word(shape, "uri")
    size = triple(source, shape, "size", default=(1.0, 1.0, 1.0))
    if not is_sized(source, shape, (*size[:2], abs(size[2]))):
        return None
    path = includes.path(source, uri) if uri else None
    if path is None or not is_file(path):
        report = source.warning if owner.tag == "visual" else source.error
        report(
            "WLD050",
            f"The image `{uri}` of a {owner.tag} heightmap of the link `{link}` is "
            f"{instead_of_file(path)}{'' if path is None else f' ({path})'}.",
            at=shape,
            hint="Check its spelling, capitals included; the folder of model://NAME is looked for "
            "in GAZEBO_MODEL_PATH, GZ_SIM_RESOURCE_PATH and around this file.",
        )
        return Heightmap(uri=uri) if uri else None
    if path.suffix.lower() not in IMAGES:
        source.warning(
            "WLD031",
            f"The heightmap `{uri}` ({owner.tag} of the link `{link}`) is not simulated: "
            f"it is no PNG or JPEG, so Gazebo takes it for elevation data, which wsgen reads not.",
            at=shape,
            hint="Convert it to a greyscale PNG (gdal_translate -ot UInt16 -scale), and say its "
            "<size> in meters.",
        )
        return None
    pos = triple(source, shape, "pos", default=(0.0, 0.0, 0.0))
    if owner.tag == "collision" and any(pos):
        source.warning(
            "WLD054",
            "The <pos> of this heightmap moves what is seen alone: Gazebo Sim's physics, and the "
            "simulation, leave the collision where it is.",
            at=shape,
            hint="Move it with the <pose> of the collision and of the visual.",
        )
    return Heightmap(
        uri=uri,
        path=str(path),
        size=size,
        pos=pos,
        sampling=_read_sampling(source, shape),
        line=line_of(shape),
    )


def _read_sampling(source: Source, shape: Element) -> int:
    sampling = number(source, shape, "sampling", default=1.0)
    if 1 <= sampling <= FINEST:
        return int(sampling)
    source.error(
        "WLD034",
        f"The sampling of this heightmap is {sampling:g}, not 1 to {FINEST}.",
        at=shape,
        hint="Say how many steps the surface has from one pixel to the next: 1 or 2.",
    )
    return 1


def is_sized(source: Source, shape: Element, sizes: tuple[float, ...]) -> bool:
    """Whether a shape has an extent in all directions; one without is reported."""
    if all(0 < size <= FARTHEST for size in sizes):
        return True
    source.error(
        "WLD034",
        f"A size of this {shape.tag} is not between 0 and {FARTHEST:g} m.",
        at=shape,
        hint="Give every length, radius and scale a sensible number of meters: Gazebo's "
        "physics engine ends the program on most shapes without extent.",
    )
    return False


Rgba = tuple[float, float, float, float]

MOST_CONTACTS = 10_000  # of two shapes; more is a slip


def read_color(source: Source, visual: Element) -> Rgba | None:
    """Diffuse, else what the name of a script stands for, else ambient."""
    material = first(visual, "material")
    if material is None:
        return None
    script = GAZEBO_COLORS.get(word(material, "script", "name"))
    color = _rgba(source, material, "diffuse") or script or _rgba(source, material, "ambient")
    transparency = number(source, visual, "transparency", default=0.0)
    if color is None or transparency == 0:
        return color
    return (*color[:3], min(1.0, max(0.0, color[3] * (1 - transparency))))


def read_surface(source: Source, collision: Element) -> Surface:
    """How a collision touches others."""
    surface = first(collision, "surface")
    contacts = optional_number(source, collision, "max_contacts")
    if surface is None and contacts is None:
        return Surface()
    place = collision if surface is None else surface
    return Surface(
        mu1=max(0.0, number(source, place, "friction", "ode", "mu", default=1.0)),
        mu2=max(0.0, number(source, place, "friction", "ode", "mu2", default=1.0)),
        kp=optional_number(source, place, "contact", "ode", "kp"),
        kd=optional_number(source, place, "contact", "ode", "kd"),
        min_depth=optional_number(source, place, "contact", "ode", "min_depth"),
        max_contacts=None if contacts is None else int(min(max(contacts, 0), MOST_CONTACTS)),
    )


def _rgba(source: Source, material: Element, tag: str) -> Rgba | None:
    element = first(material, tag)
    words = [] if element is None else (element.text or "").split()
    if element is None or not words:
        return None
    numbers = read_numbers(source, element, 3 if len(words) == 3 else 4)  # noqa: PLR2004  rgb or rgba
    if numbers is None:
        return None
    red, green, blue, alpha = (min(1.0, max(0.0, part)) for part in (*numbers, 1.0)[:4])
    return (red, green, blue, alpha)


ROUND: dict[str, type[Cylinder | Capsule | Cone]] = {
    "cylinder": Cylinder,
    "capsule": Capsule,
    "cone": Cone,
}
MESHED = ("ellipsoid", "polyline", "heightmap", "mesh")
LEFT_OUT = ("image",)
KNOWN = ("box", "sphere", *ROUND, *MESHED, "plane", "empty", *LEFT_OUT)


class ShapeReader:
    """Reads the shapes of one link; planes are not among them, see `planes`."""

    def __init__(self, source: Source, includes: Includes, link: str) -> None:
        self.source = source
        self.includes = includes
        self.link = link
        self._missing: set[tuple[str, str]] = set()  # reported once for each link

    def visuals(self, link: Element) -> tuple[Visual, ...]:
        """What there is to see of a link."""
        found = []
        for element in self._named(link, "visual"):
            pose = self._pose(element)
            geometry = self._geometry(element)
            if geometry is not None:
                found.append(
                    Visual(
                        geometry=geometry,
                        pose_in_link=pose,
                        rgba=read_color(self.source, element),
                        name=element.get("name"),
                    )
                )
        return tuple(found)

    def collisions(self, link: Element) -> tuple[Collision, ...]:
        """What there is to touch of a link."""
        found = []
        for element in self._named(link, "collision"):
            pose = self._pose(element)
            geometry = self._geometry(element)
            if geometry is not None:
                found.append(
                    Collision(
                        geometry=geometry,
                        pose_in_link=pose,
                        surface=read_surface(self.source, element),
                        name=element.get("name"),
                    )
                )
        return tuple(found)

    def _named(self, link: Element, tag: str) -> list[Element]:
        """The elements of a kind; names that are missing or used twice are reported."""
        seen: set[str] = set()
        for element in children(link, tag):
            name = element.get("name") or ""
            if not name:
                self.source.error(
                    "WLD013",
                    f"A {tag} of the link `{self.link}` has no name.",
                    at=element,
                    hint=f'Write <{tag} name="NAME">; Gazebo refuses the file without.',
                )
            elif name in seen:
                self.source.error(
                    "WLD015",
                    f"Two {tag}s of the link `{self.link}` are called `{name}`.",
                    at=element,
                    hint="Give each its own name; Gazebo Sim refuses the file otherwise.",
                )
            seen.add(name)
        return list(children(link, tag))

    def _pose(self, element: Element) -> Pose:
        pose, relative_to = read_pose(self.source, element)
        if relative_to and relative_to != self.link.rpartition("::")[2]:
            self.source.warning(
                "WLD020",
                f"The pose of this {element.tag} is relative to `{relative_to}`; "
                "it is taken as relative to its link.",
                at=element,
                hint="Write the pose as seen from the link, without relative_to.",
            )
        return pose

    def _geometry(self, owner: Element) -> Geometry | None:
        geometry = first(owner, "geometry")
        shape = None if geometry is None else next(children(geometry, *KNOWN), None)
        if shape is None:
            self.source.warning(
                "WLD030",
                f"This {owner.tag} of the link `{self.link}` has no shape that is known.",
                at=owner if geometry is None else geometry,
                hint=f"Put one of {', '.join(f'<{name}>' for name in KNOWN)} into <geometry>.",
            )
            return None
        if shape.tag == "plane":
            return None
        if shape.tag in LEFT_OUT:
            self.source.warning(
                "WLD031",
                f"The {shape.tag} ({owner.tag} of the link `{self.link}`) is left out of the "
                "simulation: no engine of wsgen has such a shape.",
                at=shape,
                hint="Make it of boxes, spheres, cylinders, capsules or a mesh.",
            )
            return None
        return self._read(shape, owner)

    def _read(self, shape: Element, owner: Element) -> Geometry | None:
        if shape.tag == "mesh":
            return self._mesh(shape, owner)
        if shape.tag == "heightmap":
            return read_heightmap(self.source, self.includes, shape, owner, self.link)
        if shape.tag == "polyline":
            return read_extrusion(self.source, shape, self.link)
        if shape.tag == "ellipsoid":
            return read_ellipsoid(self.source, shape)
        return self._solid(shape)

    def _solid(self, shape: Element) -> Geometry | None:
        """The shape with the sizes that SDF gives it by default."""
        if shape.tag == "empty":
            return None
        if shape.tag == "box":
            size = triple(self.source, shape, "size", default=(1.0, 1.0, 1.0))
            return Box(size=size) if is_sized(self.source, shape, size) else None
        radius = number(
            self.source,
            shape,
            "radius",
            default=0.5 if shape.tag in {"capsule", "cone"} else 1.0,
        )
        length = number(self.source, shape, "length", default=1.0)
        if shape.tag == "sphere":
            return Sphere(radius=radius) if is_sized(self.source, shape, (radius,)) else None
        if not is_sized(self.source, shape, (radius, length)):
            return None
        return ROUND[str(shape.tag)](radius=radius, length=length)

    def _mesh(self, shape: Element, owner: Element) -> Geometry | None:
        uri = word(shape, "uri")
        scale = triple(self.source, shape, "scale", default=(1.0, 1.0, 1.0))
        # What is only seen may be mirrored.
        is_visual = owner.tag == "visual"
        if not is_sized(self.source, shape, tuple(map(abs, scale)) if is_visual else scale):
            return None
        path = self.includes.path(self.source, uri) if uri else None
        if path is not None and is_file(path):
            return Mesh(uri=uri, scale=scale, path=str(path))
        if (uri, str(owner.tag)) not in self._missing:
            self._missing.add((uri, str(owner.tag)))
            report = self.source.warning if is_visual else self.source.error
            report(
                "WLD033" if is_visual else "WLD032",
                f"The {owner.tag} mesh `{uri}` of the link `{self.link}` is "
                f"{instead_of_file(path)}"
                f"{'' if path is None else f' ({path})'}.",
                at=shape,
                hint=how_to_have(uri),
            )
        return Mesh(uri=uri, scale=scale) if uri else None


EXTENT = (1000.0, 1000.0, 10.0)  # m, of the box that a plane is the upper side of, as the ground is
SHEET = 0.001  # m, how thick the box is that a plane is seen as
UP = (0.0, 0.0, 1.0)
DOWNWARD = -1 + 1e-9  # of a direction's z: from here on, every way there is the shortest


class Planes(NamedTuple):
    """What becomes of the planes of a link."""

    collisions: tuple[Collision, ...] = ()
    visuals: tuple[Visual, ...] = ()
    is_ground: bool = False  # one of them is the ground of the world, which the engine has itself


NONE = Planes()


def read_planes(node: Node, model: Scope, model_in_world: Pose) -> Planes:
    """The planes of a link of a model, seen from the link's own frame.

    One that is level, at z = 0 and of a static model is the ground. Others of static models carry
    as far as anybody goes in a simulation. What moves is left out, which is reported: no engine
    has a half-space that does.
    """
    found = list(_planes_of(node.element))
    if not found:
        return NONE
    source, is_static = node.source, node.scope.is_static
    link_in_world = compose(model_in_world, pose_in(model, node))
    collisions, visuals, is_ground = [], [], False
    for owner, shape in found:
        upward = _upward(source, owner, shape)
        if upward is None:
            continue
        is_level = is_static and is_level_at_zero(compose(link_in_world, upward))
        if owner.tag == "visual":
            size = _size(source, shape)
            if size is not None and not is_level:
                visuals.append(_seen(source, owner, upward, size))
        elif not is_static:
            source.warning(
                "WLD031",
                f"The plane of the link `{node.name}` is not simulated: Gazebo's planes "
                "have no end, and only one that is static can be tried.",
                at=shape,
                hint="Make the model static, or make a plate of a thin box.",
            )
        elif is_level:
            is_ground = True
        else:
            collisions.append(
                Collision(
                    geometry=Box(size=EXTENT),
                    pose_in_link=_below(upward, EXTENT[2]),
                    surface=read_surface(source, owner),
                    name=owner.get("name"),
                )
            )
    return Planes(tuple(collisions), tuple(visuals), is_ground)


def _planes_of(link: Element) -> Iterator[tuple[Element, Element]]:
    """The collisions and visuals whose shape is a plane, and their planes."""
    for owner in children(link, "collision", "visual"):
        geometry = first(owner, "geometry")
        shape = None if geometry is None else next(children(geometry, *KNOWN), None)
        if shape is not None and shape.tag == "plane":
            yield owner, shape


def _upward(source: Source, owner: Element, shape: Element) -> Pose | None:
    """The pose in the link of a frame in the plane whose z axis is the normal."""
    pose, _ = read_pose(source, owner)
    normal = triple(source, shape, "normal", default=UP)
    length = math.hypot(*normal)
    if not 0 < length < math.inf:
        source.error(
            "WLD034",
            "The normal of this plane has no direction.",
            at=shape,
            hint="A level plane has <normal>0 0 1</normal>.",
        )
        return None
    x, y, z = (part / length for part in normal)
    if (x, y, z) == UP:
        return pose
    rotation = multiply(rotation_of_rpy(pose.rpy), _turned_up(x, y, z))
    return Pose(pose.xyz, rpy_of_rotation(rotation))


def _turned_up(x: float, y: float, z: float) -> Matrix:
    """The shortest rotation that takes the z axis to a direction of length 1."""
    if z < DOWNWARD:
        return ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, -1.0))
    part = 1 / (1 + z)
    return (
        (1 - x * x * part, -x * y * part, x),
        (-x * y * part, 1 - y * y * part, y),
        (-x, -y, z),
    )


def _below(upward: Pose, thickness: float) -> Pose:
    """The pose of a box whose upper side is in the plane."""
    return compose(upward, Pose((0.0, 0.0, -thickness / 2)))


def _size(source: Source, shape: Element) -> tuple[float, float] | None:
    """What is seen of the plane; None where it is nothing, which is reported."""
    element = first(shape, "size") if word(shape, "size") else None
    numbers = (1.0, 1.0) if element is None else read_numbers(source, element, 2)
    if numbers is None:
        return None
    if all(0 < edge <= FARTHEST for edge in numbers):
        return (numbers[0], numbers[1])
    source.warning(
        "WLD034",
        f"The size of this plane is not between 0 and {FARTHEST:g} m.",
        at=shape,
        hint="Give both edges of what is to be seen a sensible number of meters.",
    )
    return None


def _seen(source: Source, owner: Element, upward: Pose, size: tuple[float, float]) -> Visual:
    return Visual(
        geometry=Box(size=(*size, SHEET)),
        pose_in_link=_below(upward, SHEET),
        rgba=read_color(source, owner),
        name=owner.get("name"),
    )
