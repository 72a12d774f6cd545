"""Shapes that no engine has become meshes: ellipsoids, cones, extrusions, heightmaps.

What to say of a shape that becomes a mesh.
"""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation import parent
from wsgen.isolation.outcome import Died, Limits
from wsgen.model.robot import Extrusion, Heightmap, Mesh, Triangulated
from wsgen.model.transform import Pose, compose

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.isolation.parent import Run
    from wsgen.model.robot import Collision, Link, Robot, Visual
    from wsgen.model.transform import Vector


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
            f"has {pixels} × {pixels} pixels; the simulation takes {rows} × {rows} of them",
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


TASK = "wsgen.meshes.shape_worker:build"
LIMITS = Limits(seconds=30.0, memory=2 * 2**30)  # of all shapes of a robot
HINT = "Make it smaller or simpler, or a mesh of it in another program."
DEATHS = 3  # after so many shapes that the child dies of, the others are not made

Answer = dict[str, Any]  # what `solid_worker.build` says of a shape


def build_solids(
    robot: Robot, *, file: Path | None, folder: Path, run: Run = parent.run
) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """Replace every shape that no engine has by a mesh of its surface.

    What cannot be made is an error in a collision, which becomes a mesh without a path, and a
    warning in a visual, which is left out.

    Args:
        robot: The robot as SDF has it.
        file: What the diagnostics name.
        folder: Where the meshes go; must be there as long as the returned robot is used.
        run: Starts the child process that makes them.
    """
    uses = [use for link in robot.links for use in _uses(link)]
    if not uses:
        return robot, ()
    shapes = list(dict.fromkeys(_alone(use.shape) for use in uses))
    answers = _ask(shapes, Path(tempfile.mkdtemp(prefix="solids-", dir=folder)), run)
    found: dict[Diagnostic, None] = {}
    for use in uses:
        more = find_in_use(use, answers[_alone(use.shape)], file, is_static=robot.is_static)
        found |= dict.fromkeys(more)
    links = tuple(
        replace(
            link,
            visuals=tuple(new for one in link.visuals if (new := _new_visual(one, answers))),
            collisions=tuple(_new_collision(one, answers) for one in link.collisions),
        )
        for link in robot.links
    )
    return replace(robot, links=links), tuple(found)


def _uses(link: Link) -> Iterator[SolidUse]:
    for collision in link.collisions:
        if isinstance(collision.geometry, Triangulated):
            yield SolidUse(link, collision.geometry, is_visual=False)
    for visual in link.visuals:
        if isinstance(visual.geometry, Triangulated):
            yield SolidUse(link, visual.geometry, is_visual=True)


def _alone(shape: Triangulated) -> Triangulated:
    """The shape, wherever it is: those that differ in their place alone have one mesh."""
    if isinstance(shape, Heightmap):
        return replace(shape, pos=(0.0, 0.0, 0.0), line=None)
    return replace(shape, line=None) if isinstance(shape, Extrusion) else shape


def _ask(shapes: Sequence[Triangulated], folder: Path, run: Run) -> Mapping[Triangulated, Answer]:
    """What the child says of each shape; what it dies of, it is asked about no more."""
    # Of an image that is not there, the reader of the world has told.
    answers: dict[Triangulated, Answer] = {
        shape: {"path": None, "problem": None}
        for shape in shapes
        if isinstance(shape, Heightmap) and shape.path is None
    }
    waiting = [shape for shape in shapes if shape not in answers]
    for _ in range(DEATHS if waiting else 0):
        outcome = run(TASK, waiting, str(folder), limits=LIMITS)
        if not isinstance(outcome, Died):
            return {**answers, **dict(zip(waiting, outcome.value, strict=True))}
        if not outcome.step.isdecimal():  # it died before it came to the first
            problem = f"was not made, as the child {outcome.reason}"
            return {**answers, **_refused(waiting, problem, outcome.hint(HINT))}
        culprit = waiting.pop(int(outcome.step))
        problem = f"cannot be made: the child process {outcome.reason}"
        answers |= _refused([culprit], problem, outcome.hint(HINT))
    return {**answers, **_refused(waiting, f"was not made, as the child died of {DEATHS} others")}


def _refused(
    shapes: Sequence[Triangulated], problem: str, hint: str = HINT
) -> dict[Triangulated, Answer]:
    return {shape: {"path": None, "problem": problem, "hint": hint} for shape in shapes}


def _new_visual(visual: Visual, answers: Mapping[Triangulated, Answer]) -> Visual | None:
    """The visual with a mesh to draw; None if there is none."""
    shape = visual.geometry
    if not isinstance(shape, Triangulated):
        return visual
    mesh = _mesh(shape, answers)
    if mesh.path is None:
        return None
    pose = visual.pose_in_link
    if isinstance(shape, Heightmap):
        pose = compose(pose, Pose(xyz=shape.pos))
    return replace(visual, geometry=mesh, pose_in_link=pose)


def _new_collision(collision: Collision, answers: Mapping[Triangulated, Answer]) -> Collision:
    shape = collision.geometry
    if not isinstance(shape, Triangulated):
        return collision
    return replace(collision, geometry=_mesh(shape, answers))


def _mesh(shape: Triangulated, answers: Mapping[Triangulated, Answer]) -> Mesh:
    answer = answers[_alone(shape)]
    uri = shape.uri if isinstance(shape, Heightmap) else type(shape).__name__.lower()
    if answer["path"] is None:
        return Mesh(uri=uri)
    return Mesh(
        uri=uri, path=answer["path"], bounds=(_corner(answer["low"]), _corner(answer["high"]))
    )


def _corner(numbers: Sequence[float]) -> Vector:
    x, y, z = numbers
    return (x, y, z)
