"""What to say of a mesh file where a link uses it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.diagnostics import Diagnostic, Severity

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.model.robot import Link, Mesh

MANY_TRIANGLES = 200_000  # engines take a second or more for each such mesh
LARGEST = 100.0  # m, edge of the box around a part of a robot
SMALLEST = 1e-4  # m
USUAL = (0.005, 5.0)  # m, that of most parts
FACTORS = (0.001, 0.0254, 0.01, 0.1, 10.0, 100.0, 1000.0)  # mm, inches, cm …, and their opposites
LOOKS = {"ROB075": Severity.INFO}  # of a mesh; other findings about it are warnings
RECENT_FORMATS = {
    ".glb": "Gazebo Classic and Fortress read no GLB",
    ".gltf": "Gazebo Classic and Fortress read no glTF",
    ".ply": "Gazebo reads no PLY",
}


class MeshUse(NamedTuple):
    """A mesh in a link."""

    link: Link
    mesh: Mesh
    path: str
    is_visual: bool

    @property
    def kind(self) -> str:
        """The element that it is in."""
        return "visual" if self.is_visual else "collision"


def find_in_use(use: MeshUse, answer: Mapping[str, Any], file: Path | None) -> Iterator[Diagnostic]:
    """What is wrong with a mesh.

    Args:
        use: Where it is used.
        answer: What `mesh_worker.inspect` says of the file.
        file: The description.
    """
    if answer["problem"] is not None:
        broken = "ROB063" if use.is_visual else "ROB062"
        yield _finding(
            use,
            file,
            "ROB065" if answer["is_enormous"] else broken,
            f"{answer['problem']} ({use.path})",
            answer["hint"],
            severity=Severity.WARNING if use.is_visual else Severity.ERROR,
        )
        return
    if answer["oddity"] is not None:
        hint = "The trial takes it as Gazebo reads it; export it anew."
        yield _finding(use, file, "ROB067", f"{answer['oddity']} ({use.path})", hint)
    if answer["triangles"] > MANY_TRIANGLES:
        yield _finding(
            use,
            file,
            "ROB064",
            f"has {answer['triangles']:,} triangles, and is slow to load",
            "Reduce it; for a <collision>, a few boxes or cylinders are best.",
        )
    lacking = RECENT_FORMATS.get(Path(use.path).suffix.lower())
    if lacking is not None:
        hint = "Convert it to STL, OBJ or COLLADA, which all read."
        yield _finding(use, file, "ROB068", f"is of a format that not all read: {lacking}", hint)
    yield from _judge_extent(use, answer, file)
    for code, what, hint in answer["complaints"] if use.is_visual else ():
        yield _finding(use, file, code, what, hint, severity=LOOKS.get(code, Severity.WARNING))


def _judge_extent(
    use: MeshUse, answer: Mapping[str, Any], file: Path | None
) -> Iterator[Diagnostic]:
    edges = zip(answer["low"], answer["high"], use.mesh.scale, strict=True)
    extent = max(abs(scale) * (high - low) for low, high, scale in edges)  # m
    if SMALLEST <= extent <= LARGEST or math.isnan(extent):  # a scale that is NaN is told elsewhere
        return
    yield _finding(
        use, file, "ROB066", f"is {extent:.3g} m {_size_word(extent)}", _units_hint(use, extent)
    )


def _size_word(extent: float) -> str:
    return "large: its unit seems not to be the metre" if extent > LARGEST else "small"


def _units_hint(use: MeshUse, extent: float) -> str:
    """The scale that makes a usual part of it, if there is one."""
    for factor in FACTORS:
        if USUAL[0] <= extent * factor <= USUAL[1]:
            scale = " ".join(f"{part * factor:g}" for part in use.mesh.scale)
            return f'Write <mesh … scale="{scale}"/>, which makes it {extent * factor:.3g} m.'
    return "Check the scale, and the unit that the mesh was exported in."


def _finding(  # noqa: PLR0913, PLR0917  the fields of a diagnostic, once
    use: MeshUse,
    file: Path | None,
    code: str,
    what: str,
    hint: str,
    severity: Severity = Severity.WARNING,
) -> Diagnostic:
    """One sentence about the mesh; `what` goes on after its name."""
    return Diagnostic(
        code=code,
        severity=severity,
        message=f"The {use.kind} mesh `{use.mesh.uri}` of the link `{use.link.name}` {what}.",
        file=file,
        line=use.link.line,
        element=f"link[@name='{use.link.name}']/{use.kind}/geometry/mesh",
        hint=hint,
    )
