"""What a URDF says of motors: `<ros2_control>`, and the `<transmission>` of ROS 1."""

from __future__ import annotations

from wsgen.text.values import dataclass


@dataclass(frozen=True, kw_only=True)
class ControlledPart:
    """A `<joint>`, `<sensor>` or `<gpio>` of a `<ros2_control>` element."""

    kind: str  # the name of the element
    name: str
    commands: tuple[str, ...] = ()  # names of the command interfaces, as written
    states: tuple[str, ...] = ()  # of the state interfaces
    mimic: str = ""  # its attribute of that name
    line: int | None = None  # of the element in the URDF text, 1-based


@dataclass(frozen=True, kw_only=True)
class ControlSystem:
    """A `<ros2_control>` element."""

    name: str
    kind: str  # its attribute `type`
    hardware: str | None  # the class that <plugin> in <hardware> names; None: no such element
    parts: tuple[ControlledPart, ...] = ()
    others: tuple[str, ...] = ()  # names of child elements that ros2_control does not know
    line: int | None = None
    hardware_line: int | None = None  # of <plugin>

    @property
    def joints(self) -> tuple[ControlledPart, ...]:
        """Its joints, in the order of the description."""
        return tuple(part for part in self.parts if part.kind == "joint")


@dataclass(frozen=True, kw_only=True)
class Transmission:
    """A `<transmission>` element beside the links and joints, which only ROS 1 reads."""

    name: str
    joints: tuple[str, ...] = ()  # that it names
    line: int | None = None
