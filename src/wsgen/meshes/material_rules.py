"""Rules about the materials and textures of meshes.

The child process that reads the files checks them. They are here so that listing all rules loads
neither NumPy nor an XML parser.
"""

from __future__ import annotations

from wsgen.diagnostics import Rule, Severity

MISSING_TEXTURE = Rule(
    code="ROB073",
    name="missing-texture",
    severity=Severity.WARNING,
    summary="A mesh file names a texture that does not exist.",
    what=(
        "Looks for the images that a COLLADA or OBJ file names next to the mesh and in "
        "`../materials/textures`, as Gazebo does. It runs where a picture or a video is drawn."
    ),
    why=(
        "Gazebo draws the part without its texture. Often the image is in the source folder and "
        "is not installed, or the mesh names a path of the machine that it was exported on."
    ),
    example="<init_from>C:/Users/me/wood.png</init_from>",
    instead="<init_from>wood.png</init_from>",
)

UNUSABLE_TEXTURE = Rule(
    code="ROB074",
    name="unusable-texture",
    severity=Severity.WARNING,
    summary="A texture of a mesh is damaged, too large or of an unknown format.",
    what="Opens the images of the meshes where a picture or a video is drawn.",
    why="A renderer draws the part without its texture, or takes long to load it.",
    example="A PNG of 16384 by 16384 pixels.",
    instead="A PNG of at most 2048 by 2048 pixels.",
)

MISSING_MATERIAL_LIBRARY = Rule(
    code="ROB075",
    name="missing-material-library",
    severity=Severity.INFO,
    summary="The .mtl file that an OBJ file names cannot be read.",
    what="Opens what follows `mtllib`, where a picture or a video is drawn.",
    why="The colors and textures of an OBJ file are in its .mtl file: without it the part is gray.",
    example="mtllib /home/me/cad/arm.mtl",
    instead="mtllib arm.mtl",
)

MISSING_EFFECT = Rule(
    code="ROB076",
    name="missing-effect",
    severity=Severity.WARNING,
    summary="A material of a COLLADA file names an effect that the file does not have.",
    what="Resolves the materials of COLLADA files where a picture or a video is drawn.",
    why="Gazebo crashes when it loads such a file.",
    example='<material id="red"><instance_effect url="#missing"/></material>',
    instead='<material id="red"><instance_effect url="#red-effect"/></material>',
)
