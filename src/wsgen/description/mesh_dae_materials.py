"""COLLADA files: what Gazebo makes of their materials."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.description.mesh_content import (
    BrokenMeshError,
    Complaint,
    Material,
    parse_floats,
)
from wsgen.description.mesh_dae_tree import child

if TYPE_CHECKING:
    from wsgen.description.mesh_dae_tree import Ids
    from wsgen.xmltree import Element

    Rgba = tuple[float, float, float, float]

SHADERS = ("lambert", "phong", "blinn")  # Gazebo passes over <constant>
LUMINANCE = (0.212671, 0.71516, 0.072169)  # of red, green and blue, as the standard has it
WHITE: Rgba = (1.0, 1.0, 1.0, 1.0)


class Materials:
    """The materials of a file."""

    def __init__(self, ids: Ids) -> None:
        self.ids = ids
        self.complaints: dict[Complaint, None] = {}
        self._targets: dict[str, str] = {}  # of the names that geometries give their materials
        self._read: dict[str, Material] = {}

    def bind(self, instance: Element) -> None:
        """Take the materials that an <instance_geometry> gives to its geometry."""
        for inner in instance.iter("{*}instance_material"):
            self._targets[inner.get("symbol", "")] = inner.get("target", "")

    def find(self, symbol: str | None) -> Material:
        """The material that a geometry calls by this name; without one the default."""
        if symbol is None:
            return Material()
        target = self._targets.get(symbol, symbol).removeprefix("#")
        if target not in self._read:
            self._read[target] = self._material(target)
        return self._read[target]

    def _material(self, target: str) -> Material:
        material = self.ids.get(target, "material")
        instance = None if material is None else child(material, "instance_effect")
        if instance is None:
            return Material()
        url = instance.get("url", "")
        effect = self.ids.get(url.removeprefix("#"), "effect")
        if effect is None:
            complaint = Complaint(
                "ROB076",
                f"has a material `{target}` of an effect `{url}` that it does not have: Gazebo "
                "crashes on it",
                "Export the mesh anew.",
            )
            self.complaints[complaint] = None
            return Material()
        profile = child(effect, "profile_COMMON")
        technique = None if profile is None else child(profile, "technique")
        found = [] if technique is None else [child(technique, name) for name in SHADERS]
        shader = next((one for one in found if one is not None), None)
        return Material() if shader is None else self._shaded(shader, effect)

    def _shaded(self, shader: Element, effect: Element) -> Material:
        rgba, image = None, None
        diffuse = child(shader, "diffuse")
        if diffuse is not None:
            texture = child(diffuse, "texture")
            rgba = _colour(diffuse)
            if rgba is None and texture is not None:
                rgba, image = WHITE, self._image(texture.get("texture", ""), effect)
        opacity = _opacity(shader)
        if rgba is None:
            return Material()
        return Material(rgba=(*rgba[:3], opacity), image=image)

    def _image(self, name: str, effect: Element) -> str | None:
        """The address of an image, which an effect names by way of a sampler and a surface."""
        parameters = {one.get("sid"): one for one in effect.iter("{*}newparam")}
        for kind, inside in ("sampler2D", "source"), ("surface", "init_from"):
            if name not in parameters:
                break  # some name the image at once
            what = child(parameters[name], kind)
            source = None if what is None else child(what, inside)
            name = "" if source is None else (source.text or "").strip()
        image = self.ids.get(name, "image")
        address = None if image is None else child(image, "init_from")
        return None if address is None else (address.text or "").strip() or None


def _colour(element: Element) -> Rgba | None:
    """The <color> in an element; None where there is none that can be read."""
    colour = child(element, "color")
    try:
        numbers = parse_floats("" if colour is None else colour.text or "", "a colour").tolist()
    except BrokenMeshError:
        return None
    if len(numbers) not in {3, 4} or not all(map(math.isfinite, numbers)):
        return None
    red, green, blue, alpha = (min(1.0, max(0.0, part)) for part in (*numbers, 1.0)[:4])
    return (red, green, blue, alpha)


def _opacity(shader: Element) -> float:
    """From 0, invisible, to 1; it is 1 where <transparent> does not say how it is meant."""
    transparent = child(shader, "transparent")
    mode = None if transparent is None else transparent.get("opaque")
    colour = None if transparent is None else _colour(transparent)
    if mode is None or colour is None:
        return 1.0
    factor = _factor(shader)
    luminance = sum(part * weight for part, weight in zip(colour, LUMINANCE, strict=False))
    opacities = {
        "A_ONE": colour[3] * factor,
        "A_ZERO": 1 - colour[3] * factor,
        "RGB_ONE": luminance * factor,
        "RGB_ZERO": 1 - luminance * factor,
    }
    return min(1.0, max(0.0, opacities.get(mode, 1.0)))


def _factor(shader: Element) -> float:
    transparency = child(shader, "transparency")
    number = None if transparency is None else child(transparency, "float")
    try:
        numbers = parse_floats("" if number is None else number.text or "", "a number").tolist()
    except BrokenMeshError:
        return 1.0
    return min(1.0, max(0.0, numbers[0])) if len(numbers) == 1 else 1.0
