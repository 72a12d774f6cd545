"""Rules about addresses of meshes that a published robot has, and who reads it does not find."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.descriptions.meshes.lookup import ON_WINDOWS, address_in_package
from wsgen.diagnostics import Rule, Severity
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.text.markup import Written


RELATIVE_ADDRESS = Rule(
    code="ROB126",
    name="relative-mesh-address",
    severity=Severity.WARNING,
    summary="A robot that `robot_state_publisher` publishes has a mesh with a relative path.",
    what="In the robot that a launch file gives to `robot_state_publisher`, looks for mesh paths "
    "without a scheme that are relative to the file of the robot.",
    why="`robot_state_publisher` publishes the text of the robot, but not the path of its file. "
    "RViz, and Gazebo when it spawns from the topic, do not find the mesh and draw nothing.",
    example='<mesh filename="../meshes/base.stl"/>',
    instead='<mesh filename="package://my_robot/meshes/base.stl"/>',
)
MODEL_ADDRESS_IN_RVIZ = Rule(
    code="ROB127",
    name="model-address-in-rviz",
    severity=Severity.WARNING,
    summary="RViz does not draw meshes with `model://` addresses.",
    what="Looks for `model://` meshes in the robot that a launch file gives to "
    "`robot_state_publisher`, if the launch file also starts rviz2.",
    why="RViz supports `package://`, `file://` and `http://` addresses; `model://` is an address "
    "for Gazebo. RViz draws the robot without these meshes. Gazebo also supports `package://`.",
    example='<mesh filename="model://my_robot/meshes/base.stl"/>',
    instead='<mesh filename="package://my_robot/meshes/base.stl"/>',
)

RVIZ = "rviz2"  # the program
_MESH = lazy_pattern(r"<mesh\b[^>]*?\bfilename\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")


def mesh_addresses(text: str) -> tuple[str, ...]:
    """The addresses of meshes in a URDF, each once."""
    found = (match[1] or match[2] or "" for match in _MESH.finditer(text))
    return tuple(dict.fromkeys(one.strip() for one in found if one.strip()))


def relative_addresses(
    addresses: Iterable[str], file: Path, written: Sequence[Written]
) -> Iterator[Diagnostic]:
    """Report relative paths of a published robot; those without a file are reported anyway.

    Args:
        addresses: Of the meshes of the robot.
        file: The one that the robot is in, or is expanded from.
        written: The elements of that file, and of those that it includes.
    """
    for address in addresses:
        if "://" in address or address.startswith("/") or ON_WINDOWS.match(address):
            continue
        mesh = file.parent / address
        if not mesh.is_file():
            continue
        place, line = _place(address, file, written)
        own = address_in_package(mesh.name, mesh.parent)
        yield RELATIVE_ADDRESS.at(
            place,
            line,
            f"mesh[@filename='{address}']",
            message=f"The mesh `{address}` has a relative path, but robot_state_publisher "
            "publishes the robot without its folder: neither RViz nor Gazebo finds the file.",
            hint=f"Write {own or 'package://PACKAGE/' + mesh.name}",
        )


def model_addresses(
    addresses: Iterable[str], file: Path, written: Sequence[Written]
) -> Iterator[Diagnostic]:
    """Report `model://` addresses of a robot that RViz shows."""
    for address in addresses:
        if not address.startswith("model://"):
            continue
        place, line = _place(address, file, written)
        yield MODEL_ADDRESS_IN_RVIZ.at(
            place,
            line,
            f"mesh[@filename='{address}']",
            message=f"RViz does not find model:// addresses and does not draw `{address}`.",
            hint=f"Write package://{address.removeprefix('model://')}",
        )


def _place(address: str, file: Path, written: Sequence[Written]) -> tuple[Path, int | None]:
    """Where an address is written; it may be computed there, but for the name of its file."""
    name = f"/{address.rpartition('/')[2]}"
    meshes = [
        (one, one.attributes.get("filename", "").strip()) for one in written if one.tag == "mesh"
    ]
    same = [one for one, filename in meshes if filename == address]
    alike = [one for one, filename in meshes if filename.endswith(name)]
    for element in (*same, *alike):
        return element.file, element.line_of("filename")
    return file, None
