"""What to say of a shape that becomes a mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.robot import Extrusion, Heightmap

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from wsgen.model.robot import Link, Triangulated


class SolidUse(NamedTuple):
    """A shape in a link."""

    link: Link
    shape: Triangulated
    is_visual: bool

    @property
    def kind(self) -> str:
        """The element that it is in."""
        return "visual" if self.is_visual else "collision"

    @property
    def tag(self) -> str:
        """The element that it is."""
        return (
            "polyline" if isinstance(self.shape, Extrusion) else type(self.shape).__name__.lower()
        )


def find_in_use(
    use: SolidUse, answer: Mapping[str, Any], file: Path | None, *, is_static: bool
) -> Iterator[Diagnostic]:
    """What is wrong with a shape.

    Args:
        use: Where it is used.
        answer: What `solid_worker.build` says of it.
        file: The description.
        is_static: Whether the robot it belongs to does not move.
    """
    if answer["problem"] is not None:
        yield _finding(
            use,
            file,
            "WLD051" if isinstance(use.shape, Heightmap) else "WLD057",
            answer["problem"],
            answer["hint"],
            severity=Severity.WARNING if use.is_visual else Severity.ERROR,
        )
        return
    if not isinstance(use.shape, Heightmap) or answer["path"] is None:
        return
    pixels, rows = answer["pixels"], answer["rows"]
    if rows < pixels:
        yield _finding(
            use,
            file,
            "WLD053",
            f"has {pixels} × {pixels} pixels; the trial takes {rows} × {rows} of them",
            "Reduce the image, if that is fine enough for the robot's wheels.",
            severity=Severity.INFO,
        )
    if use.is_visual and not _is_power_of_two(pixels - 1):
        yield _finding(
            use,
            file,
            "WLD055",
            f"has {pixels} × {pixels} pixels: Gazebo draws none but 2ⁿ + 1 on each side, and "
            "Gazebo Classic ends on others",
            "Scale the image to 129, 257, 513 or 1025 pixels.",
        )
    if not use.is_visual and not is_static:
        yield _finding(
            use,
            file,
            "WLD056",
            "is in a model that can move, where Gazebo's engines do not move it",
            "Make the model static, and what moves another one.",
        )


def _is_power_of_two(number: int) -> bool:
    return number & (number - 1) == 0


def _finding(  # noqa: PLR0913, PLR0917  the fields of a diagnostic, once
    use: SolidUse,
    file: Path | None,
    code: str,
    what: str,
    hint: str,
    severity: Severity = Severity.WARNING,
) -> Diagnostic:
    """One sentence about the shape; `what` goes on after its name."""
    shape = use.shape
    name = f" `{shape.uri}`" if isinstance(shape, Heightmap) else ""
    line = shape.line if isinstance(shape, Heightmap | Extrusion) else None
    return Diagnostic(
        code=code,
        severity=severity,
        message=f"The {use.kind} {use.tag}{name} of the link `{use.link.name}` {what}.",
        file=file,
        line=line or use.link.line,
        element=f"link[@name='{use.link.name}']/{use.kind}/geometry/{use.tag}",
        hint=hint,
    )
