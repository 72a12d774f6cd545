"""`<ellipsoid>`, `<polyline>` and `<heightmap>` of SDF: what becomes a mesh in a trial."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.robot import Ellipsoid, Extrusion, Heightmap
from wsgen.world.lookup import instead_of_file, is_file
from wsgen.world.source import line_of
from wsgen.world.values import FARTHEST, number, read_numbers, triple, word
from wsgen.xmltree import children

if TYPE_CHECKING:
    from wsgen.world.included import Includes
    from wsgen.world.source import Source
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
            f"The heightmap `{uri}` ({owner.tag} of the link `{link}`) is left out of the trial: "
            f"it is no PNG or JPEG, so Gazebo takes it for elevation data, which wsgen reads not.",
            at=shape,
            hint="Convert it to a greyscale PNG (gdal_translate -ot UInt16 -scale), and say its "
            "<size> in metres.",
        )
        return None
    pos = triple(source, shape, "pos", default=(0.0, 0.0, 0.0))
    if owner.tag == "collision" and any(pos):
        source.warning(
            "WLD054",
            "The <pos> of this heightmap moves what is seen alone: Gazebo Sim's physics, and the "
            "trial, leave the collision where it is.",
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
        hint="Give every length, radius and scale a sensible number of metres: Gazebo's "
        "physics engine ends the program on most shapes without extent.",
    )
    return False
