"""The files that mesh addresses stand for."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.description.mesh_lookup import locate
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.robot import Mesh, Robot

if TYPE_CHECKING:
    from wsgen.description.mesh_lookup import ShareOf
    from wsgen.model.robot import Geometry, Link


def find_meshes(
    robot: Robot, *, share_of: ShareOf, folder: Path | None = None, file: Path | None = None
) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """Fill in the path of every mesh that is there, and report the others.

    `package://PACKAGE/…` and `model://PACKAGE/…` are looked up with `share_of`; a path that is not
    absolute is seen from `folder`. `file` is what the diagnostics name.
    """
    search = _Search(share_of, folder, file)
    links = tuple(
        replace(
            link,
            visuals=tuple(
                replace(visual, geometry=search.located(visual.geometry, link, is_visual=True))
                for visual in link.visuals
            ),
            collisions=tuple(
                replace(shape, geometry=search.located(shape.geometry, link, is_visual=False))
                for shape in link.collisions
            ),
        )
        for link in robot.links
    )
    return replace(robot, links=links), tuple(search.diagnostics.values())


class _Search:
    """Where to look, and what was not found."""

    def __init__(self, share_of: ShareOf, folder: Path | None, file: Path | None) -> None:
        self.share_of = share_of
        self.folder = folder
        self.file = file
        self.diagnostics: dict[
            tuple[str, str, bool], Diagnostic
        ] = {}  # one for each mesh of a link

    def located(self, geometry: Geometry, link: Link, *, is_visual: bool) -> Geometry:
        """The mesh with its path; any other geometry as it is."""
        if not isinstance(geometry, Mesh):
            return geometry
        found = locate(geometry.uri, self.share_of, self.folder)
        if isinstance(found, Path):
            # Engines make addresses of it, in which a relative path is the name of a machine.
            return replace(geometry, path=str(found.absolute()))
        problem, hint = found
        kind = "visual" if is_visual else "collision"
        self.diagnostics[link.name, geometry.uri, is_visual] = Diagnostic(
            code="ROB061" if is_visual else "ROB060",
            severity=Severity.WARNING if is_visual else Severity.ERROR,
            message=f"The {kind} mesh `{geometry.uri}` of the link `{link.name}` {problem}.",
            file=self.file,
            line=link.line,
            element=f"link[@name='{link.name}']/{kind}/geometry/mesh",
            hint=hint,
        )
        return geometry
