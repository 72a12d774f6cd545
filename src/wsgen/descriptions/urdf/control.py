"""`<ros2_control>` and `<transmission>` of a URDF, as they are written."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.descriptions.urdf.values import line_of
from wsgen.model.robot import ControlledPart, ControlSystem, Transmission
from wsgen.text.xmltree import child_text, children

if TYPE_CHECKING:
    from wsgen.text.xmltree import Element


PARTS = ("joint", "sensor", "gpio")
KNOWN = (*PARTS, "hardware", "transmission", "properties")


def read_controls(root: Element) -> tuple[ControlSystem, ...]:
    """The `<ros2_control>` elements of a robot."""
    return tuple(_read_system(element) for element in children(root, "ros2_control"))


def _read_system(element: Element) -> ControlSystem:
    hardware = next(children(element, "hardware"), None)
    plugin = None if hardware is None else next(children(hardware, "plugin"), None)
    return ControlSystem(
        name=element.get("name") or "",
        kind=element.get("type") or "",
        hardware=None if hardware is None else child_text(hardware, "plugin"),
        parts=tuple(_read_part(part) for part in children(element, *PARTS)),
        others=tuple(
            child.tag for child in element if isinstance(child.tag, str) and child.tag not in KNOWN
        ),
        line=line_of(element),
        hardware_line=None if plugin is None else line_of(plugin),
    )


def _read_part(element: Element) -> ControlledPart:
    commands, states = (
        tuple(interface.get("name") or "" for interface in children(element, tag))
        for tag in ("command_interface", "state_interface")
    )
    return ControlledPart(
        kind=str(element.tag),
        name=element.get("name") or "",
        commands=commands,
        states=states,
        mimic=element.get("mimic") or "",
        line=line_of(element),
    )


def read_transmissions(root: Element) -> tuple[Transmission, ...]:
    """The `<transmission>` elements of a robot."""
    return tuple(
        Transmission(
            name=element.get("name") or "",
            joints=tuple(
                joint.get("name") or (joint.text or "").strip()
                for joint in children(element, "joint")
            ),
            line=line_of(element),
        )
        for element in children(root, "transmission")
    )
