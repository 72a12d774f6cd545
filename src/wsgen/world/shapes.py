"""`<visual>`, `<collision>` and `<geometry>` of SDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.robot import Box, Capsule, Collision, Cone, Cylinder, Mesh, Sphere, Visual
from wsgen.world.included import how_to_have
from wsgen.world.lookup import instead_of_file, is_file
from wsgen.world.solids import is_sized, read_ellipsoid, read_extrusion, read_heightmap
from wsgen.world.surfaces import read_colour, read_surface
from wsgen.world.values import first, number, read_pose, triple, word
from wsgen.xmltree import children

if TYPE_CHECKING:
    from wsgen.model.pose import Pose
    from wsgen.model.robot import Geometry
    from wsgen.world.included import Includes
    from wsgen.world.source import Source
    from wsgen.xmltree import Element

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
                        rgba=read_colour(self.source, element),
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
                "trial: no engine of wsgen has such a shape.",
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
