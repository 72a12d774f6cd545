"""Misspelled elements and attributes of SDF, which Gazebo ignores nearly silently."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description_rules import MISSPELLED_ATTRIBUTE, MISSPELLED_ELEMENT
from wsgen.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Collection

    from wsgen.sdf.source import Source
    from wsgen.xmltree import Element


ROUND = ("radius", "length")
# All that SDF 1.3 to 1.12 has in an element, of those that wsgen looks into.
KNOWN: dict[str, tuple[str, ...]] = {
    "sdf": ("world", "model", "actor", "light"),
    "world": (
        *("audio", "wind", "include", "gravity", "magnetic_field", "atmosphere", "gui", "physics"),
        *("scene", "light", "frame", "model", "actor", "plugin", "road", "spherical_coordinates"),
        *("state", "population", "joint"),
    ),
    "model": (
        *("static", "self_collide", "allow_auto_disable", "include", "model", "enable_wind"),
        *("frame", "pose", "link", "joint", "plugin", "gripper"),
    ),
    "include": ("uri", "name", "static", "pose", "placement_frame", "plugin", "merge"),
    "link": (
        *("gravity", "enable_wind", "self_collide", "kinematic", "must_be_base_link", "frame"),
        *("velocity_decay", "pose", "inertial", "collision", "visual", "sensor", "projector"),
        *("audio_sink", "audio_source", "battery", "light", "particle_emitter", "plugin"),
    ),
    "inertial": (
        *("mass", "density", "frame", "pose", "inertia", "auto_inertia_params"),
        "fluid_added_mass",
    ),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "collision": (
        *("laser_retro", "max_contacts", "density", "auto_inertia_params", "frame", "pose"),
        *("geometry", "surface"),
    ),
    "visual": (
        *("cast_shadows", "laser_retro", "transparency", "visibility_flags", "meta", "frame"),
        *("pose", "material", "geometry", "plugin"),
    ),
    "geometry": (
        *("empty", "box", "capsule", "cone", "cylinder", "ellipsoid", "heightmap", "image"),
        *("mesh", "plane", "polyline", "sphere"),
    ),
    "box": ("size",),
    "capsule": ROUND,
    "cone": ROUND,
    "cylinder": ROUND,
    "sphere": ("radius",),
    "plane": ("normal", "size"),
    "mesh": ("uri", "submesh", "scale", "convex_decomposition"),
    "joint": (
        *("parent", "child", "gearbox_ratio", "gearbox_reference_body", "thread_pitch", "axis"),
        *("screw_thread_pitch", "axis2", "physics", "frame", "pose", "sensor"),
    ),
    "axis": (*("initial_position", "xyz", "use_parent_model_frame", "mimic", "dynamics", "limit"),),
    "limit": ("lower", "upper", "effort", "velocity", "stiffness", "dissipation"),
    "dynamics": ("damping", "friction", "spring_reference", "spring_stiffness"),
}
ATTRIBUTES: dict[str, tuple[str, ...]] = {
    "sdf": ("version",),
    "world": ("name",),
    "model": ("name", "canonical_link", "placement_frame"),
    "include": ("merge",),
    "link": ("name",),
    "collision": ("name",),
    "visual": ("name",),
    "joint": ("name", "type"),
    "frame": ("name", "attached_to"),
    "pose": ("relative_to", "rotation_format", "degrees", "frame"),
}
ALIKE = 0.82  # as difflib counts; `stiction` is no `friction` (0.75)
ALIKE_INITIAL = 0.75  # with the same first letter, which few misspell; `sise` and `size` are at it
SHORT, ALIKE_SHORT = 3, 0.66  # letters; one of three other letters leaves two thirds alike


def check_spelling(source: Source) -> None:
    """Report elements and attributes of a file whose names are nearly those of known ones."""
    waiting = [source.root]
    while waiting:
        element = waiting.pop()
        known = KNOWN.get(str(element.tag), ())
        written = {child.tag for child in element if isinstance(child.tag, str)}
        _check_attributes(source, element)
        for child in element:
            if child.tag in known:
                waiting.append(child)
            elif known and isinstance(child.tag, str) and "{" not in child.tag:
                # A child that is already there is hardly meant a second time.
                meant = _meant(child.tag, [name for name in known if name not in written])
                meant = meant or _meant(child.tag, known)
                if meant is not None:
                    source.misspelled.setdefault((element, meant), len(source.diagnostics))
                    source.report(
                        MISSPELLED_ELEMENT,
                        f"<{element.tag}> has no <{child.tag}>: Gazebo ignores it.",
                        at=child,
                        hint=f"Did you mean <{meant}>?",
                    )


def _check_attributes(source: Source, element: Element) -> None:
    known = ATTRIBUTES.get(str(element.tag), ())
    for name in map(str, element.attrib):
        meant = None if name in known else _meant(name, set(known).difference(element.attrib))
        if meant is not None:
            source.report(
                MISSPELLED_ATTRIBUTE,
                f"<{element.tag}> has no attribute `{name}`: Gazebo ignores it.",
                at=element,
                hint=did_you_mean(meant),
            )


def _meant(name: str, known: Collection[str]) -> str | None:
    """The name that is meant by a misspelled one; None if no known name is similar."""
    near = [other for other in sorted(known) if sorted(other) == sorted(name.lower())]
    if near:
        return near[0]
    alike = [other for other in known if other[0] == name[:1].lower()]
    return nearest(
        name.lower(), known, cutoff=ALIKE_SHORT if len(name) <= SHORT else ALIKE
    ) or nearest(name.lower(), alike, cutoff=ALIKE_INITIAL)
