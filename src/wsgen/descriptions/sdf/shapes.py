"""`<visual>` and `<collision>` of SDF, with their `<geometry>`, `<material>` and `<surface>`.

Ellipsoids, polylines and heightmaps become meshes in a simulation. Planes, which are endless
half-spaces in Gazebo, become the ground or large boxes.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.descriptions.meshes.shape_meshes import IMPOSSIBLE_SHAPE
from wsgen.descriptions.rules import (
    MAKE_IT_THICK,
    MIRROR_IT,
    MIRRORED_MESH,
    MISSING_COLLISION_MESH,
    MISSING_VISUAL_MESH,
    NO_SHAPE,
    UNNAMED_ELEMENT,
    ZERO_SIZE,
)
from wsgen.descriptions.sdf.frames import DUPLICATE_SDF_NAME, is_level_at_zero
from wsgen.descriptions.sdf.includes import elsewhere, how_to_find
from wsgen.descriptions.sdf.lookup import instead_of_file, is_file
from wsgen.descriptions.sdf.source import line_of
from wsgen.descriptions.sdf.textures import read_texture
from wsgen.descriptions.sdf.values import (
    FARTHEST,
    first,
    number,
    optional_number,
    read_numbers,
    read_pose,
    triple,
    word,
)
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.model.robot import (
    GAZEBO_COLORS,
    Box,
    Capsule,
    Collision,
    Cone,
    Cylinder,
    Ellipsoid,
    Extrusion,
    Heightmap,
    Mesh,
    MeshPart,
    Rgba,
    Sphere,
    Surface,
    Visual,
    painted,
)
from wsgen.model.transform import Pose, compose, multiply, rotation_of_rpy, rpy_of_rotation
from wsgen.text.xmltree import children, gz_attribute

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.descriptions.sdf.frames import Node
    from wsgen.descriptions.sdf.includes import Includes
    from wsgen.descriptions.sdf.source import Source
    from wsgen.model.robot import Geometry, Paint
    from wsgen.model.transform import Matrix
    from wsgen.text.xmltree import Element


FRAME_IGNORED = Rule(
    code="WLD020",
    name="frame-ignored",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="The pose of a shape or an inertia is not relative to its link.",
    why="`wsgen` reads such a pose as relative to the link, so that the shape or center of mass "
    "is not where it is in Gazebo.",
    example='<visual name="visual">\n  <pose relative_to="arm_joint">0 0 0.1 0 0 0</pose>',
    instead='<visual name="visual">\n  <pose>0 0 0.3 0 0 0</pose>',
)

SHAPE_LEFT_OUT = Rule(
    code="WLD031",
    name="shape-left-out",
    severity=Severity.WARNING,
    summary="A shape of an unsupported type is not simulated.",
    what="Looks for `<image>`, for heightmaps from elevation data (only PNG and JPEG are read) "
    "and for planes in models that can move.",
    why="Gazebo has the shape, but in the simulation robots fall through it.",
    example="<heightmap>\n  <uri>model://hill/dem.tif</uri>\n</heightmap>",
    instead="<heightmap>\n  <uri>model://hill/hill.png</uri>\n  <size>100 100 10</size>\n"
    "</heightmap>",
)

GEOMETRY_OUT_OF_RANGE = Rule(
    code="WLD034",
    name="geometry-out-of-range",
    severity=Severity.ERROR,
    severity_varies="a warning for the `<size>` of a plane, which is only visible",
    measured=Measured(classic="simulates another model", sim="accepts it"),
    summary="A value of a `<geometry>` is outside the range of physics engines.",
    what="Sizes must be at most 1e9 m, the `<sampling>` of a heightmap 1 to 16, and the "
    "`<normal>` of a plane not 0 0 0.",
    why="Gazebo's physics engine terminates the program on some of these shapes; others need too "
    "much memory.",
    example="<plane>\n  <normal>0 0 0</normal>\n</plane>",
    instead="<plane>\n  <normal>0 0 1</normal>\n</plane>",
)

MISSING_HEIGHTMAP = Rule(
    code="WLD050",
    name="missing-heightmap",
    severity=Severity.ERROR,
    severity_varies="a warning for a `<visual>`",
    summary="The image file of a heightmap does not exist.",
    why="Gazebo prints an error and does not create the terrain: robots fall. A file in the source "
    "folder must also be installed.",
    example="<heightmap>\n  <uri>model://hill/Hill.png</uri>\n</heightmap>",
    instead="<heightmap>\n  <uri>model://hill/hill.png</uri>\n</heightmap>",
)

HEIGHTMAP_OFFSET = Rule(
    code="WLD054",
    name="heightmap-offset",
    severity=Severity.WARNING,
    summary="The `<pos>` of a heightmap does not move its collision.",
    why="Gazebo Sim moves only the visual: robots drive above or below the visible terrain.",
    example="<heightmap>\n  <uri>model://hill/hill.png</uri>\n  <pos>0 0 -2</pos>\n</heightmap>",
    instead="""<collision name="collision">
  <pose>0 0 -2 0 0 0</pose>
  <geometry>
    <heightmap>
      <uri>model://hill/hill.png</uri>
    </heightmap>
  </geometry>
</collision>""",
)

IMAGES = (".png", ".jpg", ".jpeg")  # Gazebo reads any other as elevation data
FEWEST_POINTS = 3  # of an outline
MOST_POINTS = 10_000  # of all outlines of a shape
FINEST = 16  # steps from pixel to pixel; Gazebo's own worlds have up to 4


def read_ellipsoid(source: Source, shape: Element) -> Ellipsoid | None:
    """The ellipsoid; None, with a diagnostic, for one without extent."""
    radii = triple(source, shape, "radii", default=(1.0, 1.0, 1.0))
    return Ellipsoid(radii=radii) if is_sized(source, shape, radii) else None


def read_extrusion(source: Source, shape: Element, link: str) -> Extrusion | None:
    """The solid of the polylines of a geometry; None, with a diagnostic, if they have none.

    All have the height of the first.
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
            source.report(
                IMPOSSIBLE_SHAPE,
                f"A polyline of the link `{link}` has {len(outline)} points and does not enclose "
                "an area.",
                at=polyline,
                hint="Write a <point>x y</point> for each corner of the outline, at least three.",
            )
            return None
        outlines.append(outline)
    count = sum(map(len, outlines))
    if count > MOST_POINTS:
        source.report(
            IMPOSSIBLE_SHAPE,
            f"The polyline of the link `{link}` has {count:,} points; wsgen reads {MOST_POINTS:,}.",
            at=shape,
            hint="Remove unnecessary points, or use a mesh.",
        )
        return None
    return Extrusion(outlines=tuple(outlines), height=height, line=line_of(shape))


def read_heightmap(
    source: Source, includes: Includes, shape: Element, owner: Element, link: str
) -> Heightmap | None:
    """The heightmap; None, with a diagnostic, if it is left out."""
    uri = word(shape, "uri")
    size = triple(source, shape, "size", default=(1.0, 1.0, 1.0))
    if not is_sized(source, shape, (*size[:2], abs(size[2]))):
        return None
    path = includes.path(source, uri) if uri else None
    if path is None or not is_file(path):
        source.report(
            MISSING_HEIGHTMAP,
            f"The image `{uri}` of a {owner.tag} heightmap of the link `{link}` is "
            f"{instead_of_file(path)}{'' if path is None else f' ({path})'}.",
            at=shape,
            hint="Check its spelling and upper and lower case; wsgen looks for the folder of "
            "model://NAME in GAZEBO_MODEL_PATH, GZ_SIM_RESOURCE_PATH and around this file.",
            severity=Severity.WARNING if owner.tag == "visual" else Severity.ERROR,
            reason=elsewhere(uri, path),
        )
        return Heightmap(uri=uri) if uri else None
    if path.suffix.lower() not in IMAGES:
        source.report(
            SHAPE_LEFT_OUT,
            f"The heightmap `{uri}` ({owner.tag} of the link `{link}`) is not simulated: "
            "it is not a PNG or JPEG, and wsgen cannot read elevation data.",
            at=shape,
            hint="Convert it to a grayscale PNG (gdal_translate -ot UInt16 -scale), and write its "
            "<size> in meters.",
        )
        return None
    pos = triple(source, shape, "pos", default=(0.0, 0.0, 0.0))
    if owner.tag == "collision" and any(pos):
        source.report(
            HEIGHTMAP_OFFSET,
            "The <pos> of this heightmap moves only its visual: Gazebo Sim and the simulation do "
            "not move the collision.",
            at=shape,
            hint="Use the <pose> of the collision and of the visual instead.",
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
    source.report(
        GEOMETRY_OUT_OF_RANGE,
        f"The sampling of this heightmap is {sampling:g}, not 1 to {FINEST}.",
        at=shape,
        hint="Write the number of samples per pixel: 1 or 2.",
    )
    return 1


def is_sized(source: Source, shape: Element, sizes: tuple[float, ...]) -> bool:
    """Whether a shape has a usable size in all directions; other shapes are reported.

    Gazebo Classic takes a negative size of a box or cylinder for a positive one; Gazebo Sim ends.
    """
    if all(0 < size <= FARTHEST for size in sizes):
        return True
    if shape.tag == "box" and min(sizes) == 0 and max(sizes) <= FARTHEST:
        source.report(
            ZERO_SIZE,
            "A size of this box is 0: it is not simulated.",
            at=shape,
            hint=MAKE_IT_THICK,
            severity=Severity.WARNING,
        )
        return False
    source.report(
        _size_rule(sizes),
        f"A size of this {shape.tag} is not between 0 and {FARTHEST:g} m.",
        at=shape,
        hint="Write every length, radius and scale as a positive number (m): Gazebo's physics "
        "engine terminates the program on most shapes without extent.",
    )
    return shape.tag in {"box", "cylinder"} and all(0 < abs(size) <= FARTHEST for size in sizes)


def _size_rule(sizes: tuple[float, ...]) -> Rule:
    return ZERO_SIZE if min(sizes) <= 0 else GEOMETRY_OUT_OF_RANGE


MOST_CONTACTS = 10_000  # of two shapes; more is a mistake


def read_color(source: Source, visual: Element) -> Rgba | None:
    """The diffuse color, else that of the script, else the ambient color."""
    material = first(visual, "material")
    if material is None:
        return None
    script = GAZEBO_COLORS.get(word(material, "script", "name"))
    color = _rgba(source, material, "diffuse") or script or _rgba(source, material, "ambient")
    transparency = number(source, visual, "transparency", default=0.0)
    if color is None or transparency == 0:
        return color
    return (*color[:3], min(1.0, max(0.0, color[3] * (1 - transparency))))


def read_paint(source: Source, visual: Element) -> Paint | None:
    """Its colors, where the diffuse one is not all that Gazebo Classic shows."""
    material = first(visual, "material")
    if material is None:
        return None
    ambient, diffuse, emissive = (
        _rgba(source, material, tag) for tag in ("ambient", "diffuse", "emissive")
    )
    return painted(word(material, "script", "name"), ambient, diffuse, emissive)


def read_surface(source: Source, collision: Element) -> Surface:
    """Friction and contact of a collision."""
    surface = first(collision, "surface")
    contacts = optional_number(source, collision, "max_contacts")
    if surface is None and contacts is None:
        return Surface()
    place = collision if surface is None else surface
    return Surface(
        mu1=max(0.0, number(source, place, "friction", "ode", "mu", default=1.0)),
        mu2=max(0.0, number(source, place, "friction", "ode", "mu2", default=1.0)),
        **_direction(source, place),
        kp=optional_number(source, place, "contact", "ode", "kp"),
        kd=optional_number(source, place, "contact", "ode", "kd"),
        min_depth=optional_number(source, place, "contact", "ode", "min_depth"),
        max_contacts=None if contacts is None else int(min(max(contacts, 0), MOST_CONTACTS)),
    )


def _direction(source: Source, place: Element) -> dict[str, Any]:
    """The first direction of friction, and the link that it turns with, if there is one."""
    element = first(place, "friction", "ode", "fdir1")
    numbers = None if element is None else read_numbers(source, element, 3)
    if element is None or numbers is None or not any(numbers):
        return {}
    return {"fdir1": numbers, "fdir1_in": gz_attribute(element, "expressed_in")}


def read_laser_retro(source: Source, owner: Element) -> float:
    """How much a collision or a visual reflects the rays of a lidar."""
    return number(source, owner, "laser_retro", default=0.0)


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
    """Reads the shapes of one link, but for planes: see `read_planes`."""

    def __init__(self, source: Source, includes: Includes, link: str) -> None:
        self.source = source
        self.includes = includes
        self.link = link
        self._missing: set[tuple[str, str]] = set()  # reported once for each link

    def visuals(self, link: Element) -> tuple[Visual, ...]:
        """The visuals of a link."""
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
                        paint=read_paint(self.source, element),
                        texture=read_texture(self.source, self.includes, element)
                        if isinstance(geometry, Box)
                        else None,
                        laser_retro=read_laser_retro(self.source, element),
                        name=element.get("name"),
                    )
                )
        return tuple(found)

    def collisions(self, link: Element) -> tuple[Collision, ...]:
        """The collisions of a link."""
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
                        laser_retro=read_laser_retro(self.source, element),
                        name=element.get("name"),
                    )
                )
        return tuple(found)

    def _named(self, link: Element, tag: str) -> list[Element]:
        """The elements of a kind; missing and duplicate names are reported."""
        seen: set[str] = set()
        for element in children(link, tag):
            name = element.get("name") or ""
            if not name:
                self.source.report(
                    UNNAMED_ELEMENT,
                    f"A {tag} of the link `{self.link}` has no name.",
                    at=element,
                    hint=f'Write <{tag} name="NAME">; Gazebo refuses the file without a name.',
                )
            elif name in seen:
                self.source.report(
                    DUPLICATE_SDF_NAME,
                    f"Two {tag}s of the link `{self.link}` have the name `{name}`.",
                    at=element,
                    hint="Give each a different name; otherwise Gazebo Sim refuses the file.",
                )
            seen.add(name)
        return list(children(link, tag))

    def _pose(self, element: Element) -> Pose:
        pose, relative_to = read_pose(self.source, element)
        if relative_to and relative_to != self.link.rpartition("::")[2]:
            self.source.report(
                FRAME_IGNORED,
                f"The pose of this {element.tag} is relative to `{relative_to}`; "
                "the simulation reads it as relative to its link.",
                at=element,
                hint="Write the pose in the frame of the link, without relative_to.",
            )
        return pose

    def _geometry(self, owner: Element) -> Geometry | None:
        geometry = first(owner, "geometry")
        shape = None if geometry is None else next(children(geometry, *KNOWN), None)
        if shape is None:
            self.source.report(
                NO_SHAPE,
                f"This {owner.tag} of the link `{self.link}` does not have a known shape.",
                at=owner if geometry is None else geometry,
                hint=f"Write one of {', '.join(f'<{name}>' for name in KNOWN)} in <geometry>.",
                severity=Severity.WARNING,
            )
            return None
        if shape.tag == "plane":
            return None
        if shape.tag in LEFT_OUT:
            self.source.report(
                SHAPE_LEFT_OUT,
                f"The {shape.tag} ({owner.tag} of the link `{self.link}`) is not simulated: the "
                "engines of wsgen do not support this shape.",
                at=shape,
                hint="Use boxes, spheres, cylinders, capsules or a mesh.",
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
        """The shape, with the default sizes of SDF."""
        if shape.tag == "empty":
            return None
        if shape.tag == "box":
            size = triple(self.source, shape, "size", default=(1.0, 1.0, 1.0))
            x, y, z = map(abs, size)
            return Box(size=(x, y, z)) if is_sized(self.source, shape, size) else None
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
        return ROUND[str(shape.tag)](radius=abs(radius), length=abs(length))

    def _mesh(self, shape: Element, owner: Element) -> Geometry | None:
        uri = word(shape, "uri")
        scale = triple(self.source, shape, "scale", default=(1.0, 1.0, 1.0))
        is_visual = owner.tag == "visual"
        if not is_sized(self.source, shape, tuple(map(abs, scale))):
            return None
        if min(scale) < 0 and not is_visual:
            self.source.report(
                MIRRORED_MESH,
                "A scale of this collision mesh is negative.",
                at=shape,
                hint=MIRROR_IT,
            )
        path = self.includes.path(self.source, uri) if uri else None
        if path is not None and is_file(path):
            return Mesh(uri=uri, scale=scale, path=str(path), part=_part_of_mesh(shape))
        is_gazebos = self.includes.leave_to_gazebo(self.source, shape, uri, is_solid=not is_visual)
        if not is_gazebos and (uri, str(owner.tag)) not in self._missing:
            self._missing.add((uri, str(owner.tag)))
            if not is_visual:
                self.includes.left_out.add(shape)
            self.source.report(
                MISSING_VISUAL_MESH if is_visual else MISSING_COLLISION_MESH,
                f"The {owner.tag} mesh `{uri}` of the link `{self.link}` is "
                f"{instead_of_file(path)}"
                f"{'' if path is None else f' ({path})'}.",
                at=shape,
                hint=how_to_find(uri),
                reason=elsewhere(uri, path),
            )
        return Mesh(uri=uri, scale=scale) if uri else None


def _part_of_mesh(shape: Element) -> MeshPart | None:
    """The <submesh> of a <mesh>, which Gazebo takes alone."""
    name = word(shape, "submesh", "name")
    is_centered = word(shape, "submesh", "center").lower() in {"true", "1"}
    return MeshPart(name, is_centered=is_centered) if name else None


EXTENT = (1000.0, 1000.0, 10.0)  # m, of the box whose upper side is the plane, like the ground
SHEET = 0.001  # m, thickness of the box that shows a plane
UP = (0.0, 0.0, 1.0)
DOWNWARD = -1 + 1e-9  # of a direction's z: from here on, every way there is the shortest


class Planes(NamedTuple):
    """The boxes that the planes of a link become."""

    collisions: tuple[Collision, ...] = ()
    visuals: tuple[Visual, ...] = ()
    ground_friction: float | None = None  # of one that is the world's ground, which engines have


NONE = Planes()


def read_planes(node: Node, link_in_world: Pose, includes: Includes) -> Planes:
    """The planes of a link of a model, in the link's own frame.

    In a static model, a level plane at z = 0 is the ground; others become boxes that are larger
    than the way of any robot in a simulation. A plane that can move is left out, which is
    reported: no engine has moving half-spaces.
    """
    found = list(_planes_of(node.element))
    if not found:
        return NONE
    source, is_static = node.source, node.scope.is_static
    collisions, visuals = [], []
    ground_friction = None
    for owner, shape in found:
        upward = _upward(source, owner, shape)
        if upward is None:
            continue
        is_level = is_static and is_level_at_zero(compose(link_in_world, upward))
        if owner.tag == "visual":
            size = _size(source, shape)
            if size is not None and not is_level:
                visuals.append(
                    replace(
                        _seen(source, owner, upward, size),
                        texture=read_texture(source, includes, owner),
                    )
                )
        elif not is_static:
            source.report(
                SHAPE_LEFT_OUT,
                f"The plane of the link `{node.name}` is not simulated: planes are infinite in "
                "Gazebo, and only static ones can be simulated.",
                at=shape,
                hint="Make the model static, or use a thin box as a plate.",
            )
        elif is_level:
            ground_friction = read_surface(source, owner).mu1
        else:
            collisions.append(
                Collision(
                    geometry=Box(size=EXTENT),
                    pose_in_link=_below(upward, EXTENT[2]),
                    surface=read_surface(source, owner),
                    laser_retro=read_laser_retro(source, owner),
                    name=owner.get("name"),
                )
            )
    return Planes(tuple(collisions), tuple(visuals), ground_friction)


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
        source.report(
            GEOMETRY_OUT_OF_RANGE,
            "The normal of this plane has length 0.",
            at=shape,
            hint="Write <normal>0 0 1</normal> for a level plane.",
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
    """The visible size of the plane; None, with a diagnostic, if it has none."""
    element = first(shape, "size") if word(shape, "size") else None
    numbers = (1.0, 1.0) if element is None else read_numbers(source, element, 2)
    if numbers is None:
        return None
    if all(0 < edge <= FARTHEST for edge in numbers):
        return (numbers[0], numbers[1])
    source.report(
        _size_rule(numbers),
        f"The size of this plane is not between 0 and {FARTHEST:g} m.",
        at=shape,
        hint="Write both edge lengths of the visible part in meters.",
        severity=Severity.WARNING,
    )
    return None


def _seen(source: Source, owner: Element, upward: Pose, size: tuple[float, float]) -> Visual:
    return Visual(
        geometry=Box(size=(*size, SHEET)),
        pose_in_link=_below(upward, SHEET),
        rgba=read_color(source, owner),
        paint=read_paint(source, owner),
        laser_retro=read_laser_retro(source, owner),
        name=owner.get("name"),
    )
