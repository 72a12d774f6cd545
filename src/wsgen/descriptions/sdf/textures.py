"""The image on a visual: of Gazebo Classic's material scripts, or `<albedo_map>` of SDF.

A script names a material of an OGRE file `*.material`; what is read of it is the first `texture`.
Sources: gazebo (Classic), gazebo/rendering/Visual.cc (SetMaterial, with the <uri>s as folders of
resources); https://ogrecave.github.io/ogre/api/1.12/_material-_scripts.html; sdformat, sdf/1.12/
material.sdf. Images are put once on a plane, x to the right and y up (gazebo/common/MeshManager.cc,
CreatePlane), and on each face of a box. Other shapes, and meshes, keep their own colors.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.descriptions.sdf.lookup import is_file, is_folder
from wsgen.descriptions.sdf.values import first, word
from wsgen.model.robot import GAZEBO_COLORS
from wsgen.text.files import read_regular
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.descriptions.sdf.includes import Includes
    from wsgen.descriptions.sdf.source import Source
    from wsgen.text.xmltree import Element

IMAGES = (".png", ".jpg", ".jpeg")  # that a picture and a page can show
LONGEST = 1_000_000  # bytes of a script
_MATERIAL = re.compile(r"^\s*material\s+(?:\"([^\"]+)\"|([^\s:{]+))", re.MULTILINE)
_TEXTURE = re.compile(r"(?<!\S)texture\s+(?:\"([^\"]+)\"|(\S+))")


def read_texture(source: Source, includes: Includes, visual: Element) -> str | None:
    """The file of the image on a visual, if it has one that is there and can be shown."""
    material = first(visual, "material")
    if material is None:
        return None
    written = word(material, "pbr", "metal", "albedo_map")
    if written:
        return _shown(includes.path(source, written))
    script = first(material, "script")
    name = None if script is None else word(script, "name")
    if script is None or not name or name in GAZEBO_COLORS:
        return None
    places = [
        path
        for uri in children(script, "uri")
        if (path := includes.path(source, (uri.text or "").strip())) is not None
    ]
    for file in _scripts(places):
        image = _image_of(file, name)
        if image is not None:
            folders = [*places, file.parent, file.parent.parent / "textures"]
            found = (_shown(folder / image) for folder in folders)
            return next((one for one in found if one is not None), None)
    return None


def _scripts(places: list[Path]) -> Iterator[Path]:
    for place in places:
        if is_file(place):
            yield place
        elif is_folder(place):
            yield from sorted(place.glob("*.material"))


def _image_of(script: Path, name: str) -> str | None:
    """The first texture of a material, as it is written."""
    return next((image_in(text) for known, text in read_script(script) if known == name), None)


def read_script(file: Path) -> Iterator[tuple[str, str]]:
    """The materials of a script: their names, and what is said of them."""
    try:
        text = read_regular(file, LONGEST).decode("utf-8", "replace")
    except (OSError, ValueError):
        return
    text = re.sub(r"//[^\n]*", "", text)
    begins = list(_MATERIAL.finditer(text))
    ends = [*(one.start() for one in begins[1:]), len(text)]
    for begin, end in zip(begins, ends, strict=False):
        yield begin[1] or begin[2], text[begin.end() : end]


def image_in(text: str) -> str | None:
    """The first texture in what is said of a material, as it is written."""
    texture = _TEXTURE.search(text)
    return None if texture is None else texture[1] or texture[2]


def _shown(path: Path | None) -> str | None:
    if path is None or path.suffix.lower() not in IMAGES or not is_file(path):
        return None
    return str(path)
