"""Makes meshes of the shapes that no engine has: ellipsoids, cones, extrusions, heightmaps."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.meshes.requests import BuiltShape, UnbuildableShape
from wsgen.diagnostics import Diagnostic, Measured, Rule, Severity
from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died, Limits
from wsgen.model.robot import Extrusion, Heightmap, Mesh, Triangulated
from wsgen.model.transform import Pose, compose

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.isolation.parent import Run
    from wsgen.model.robot import Collision, Link, Robot, Visual


UNUSABLE_HEIGHTMAP = Rule(
    code="WLD051",
    name="unusable-heightmap",
    severity=Severity.ERROR,
    severity_varies="a warning in a `<visual>`",
    summary="The image of a heightmap is damaged, not square or too large.",
    what="Opens the PNG or JPEG file of every heightmap in a separate process.",
    why="Gazebo exits with an error if the image is not square, and has no terrain without one.",
    example="<heightmap><uri>model://hill/640_by_480.png</uri></heightmap>",
    instead="<heightmap><uri>model://hill/513_by_513.png</uri></heightmap>",
)

REDUCED_HEIGHTMAP = Rule(
    code="WLD053",
    name="reduced-heightmap",
    severity=Severity.INFO,
    summary="The simulation uses fewer pixels of a heightmap than its image has.",
    what="The simulation uses at most 513 by 513 heights; Gazebo uses all.",
    why="Finer bumps are missing in the simulation, but not in Gazebo.",
    example="A heightmap of 2049 by 2049 pixels.",
    instead="A heightmap of at most 513 by 513 pixels.",
)

HEIGHTMAP_NOT_DRAWN = Rule(
    code="WLD055",
    name="heightmap-not-drawn",
    severity=Severity.WARNING,
    summary="The image of a heightmap in a `<visual>` does not have 2ⁿ + 1 pixels on each side.",
    why="The terrain renderer of Gazebo needs 2ⁿ + 1 pixels on each side: Gazebo Sim does not draw "
    "other images, and Gazebo Classic exits with an error.",
    example="A heightmap of 512 by 512 pixels.",
    instead="The same image, scaled to 513 by 513 pixels.",
)

MOVING_HEIGHTMAP = Rule(
    code="WLD056",
    name="moving-heightmap",
    severity=Severity.WARNING,
    summary="A model with a heightmap as a collision is not static.",
    why="Gazebo's engines do not move a heightmap with its link: its visual and its collision are "
    "then at different places.",
    example='<model name="hill">\n  <link name="ground">…<heightmap>…',
    instead='<model name="hill">\n  <static>true</static>\n  <link name="ground">…<heightmap>…',
)

IMPOSSIBLE_SHAPE = Rule(
    code="WLD057",
    name="impossible-shape",
    severity=Severity.ERROR,
    severity_varies="a warning for a `<visual>`",
    measured=Measured(classic="simulates another model", sim="accepts it"),
    summary="A polyline does not enclose an area, or a shape cannot be converted to a mesh.",
    what="Converts polylines, ellipsoids and cones to meshes. An outline must have three points or "
    "more, and must not cross or touch itself or another one.",
    why="Gazebo does not create such a shape: the link is invisible, and objects pass through it.",
    example="<polyline>\n  <point>0 0</point>\n  <point>1 1</point>\n  <point>1 0</point>\n"
    "  <point>0 1</point>\n</polyline>",
    instead="<polyline>\n  <point>0 0</point>\n  <point>1 0</point>\n  <point>1 1</point>\n"
    "  <point>0 1</point>\n</polyline>",
)


class ShapeUse(NamedTuple):
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


def check_use(
    use: ShapeUse, answer: Answer, file: Path | None, *, is_static: bool
) -> Iterator[Diagnostic]:
    """What is wrong with a shape.

    Args:
        use: Where it is used.
        answer: What the child process says of it.
        file: The description.
        is_static: Whether the robot it belongs to does not move.
    """
    if isinstance(answer, UnbuildableShape):
        rule = UNUSABLE_HEIGHTMAP if isinstance(use.shape, Heightmap) else IMPOSSIBLE_SHAPE
        severity = Severity.WARNING if use.is_visual else Severity.ERROR
        yield _report(use, file, rule, answer.problem, answer.hint, severity)
        return
    if not isinstance(use.shape, Heightmap) or answer is None:
        return
    pixels, rows = answer.pixels, answer.rows
    if rows < pixels:
        yield _report(
            use,
            file,
            REDUCED_HEIGHTMAP,
            f"has {pixels} × {pixels} pixels; the simulation uses {rows} × {rows} of them",
            "Reduce the image, if that resolution is enough for the wheels of the robot.",
        )
    if use.is_visual and not _is_power_of_two(pixels - 1):
        yield _report(
            use,
            file,
            HEIGHTMAP_NOT_DRAWN,
            f"has {pixels} × {pixels} pixels: Gazebo draws only images of 2ⁿ + 1 pixels on each "
            "side, and Gazebo Classic exits with an error on others",
            "Scale the image to 129, 257, 513 or 1025 pixels.",
        )
    if not use.is_visual and not is_static:
        yield _report(
            use,
            file,
            MOVING_HEIGHTMAP,
            "is in a model that can move, but Gazebo's engines do not move heightmaps",
            "Make the model static, and move its movable parts to another model.",
        )


def _is_power_of_two(number: int) -> bool:
    return number & (number - 1) == 0


def _report(  # noqa: PLR0913, PLR0917  the fields of a diagnostic, once
    use: ShapeUse,
    file: Path | None,
    rule: Rule,
    problem: str,
    hint: str,
    severity: Severity | None = None,
) -> Diagnostic:
    """One sentence about the shape; `problem` goes on after its name."""
    shape = use.shape
    name = f" `{shape.uri}`" if isinstance(shape, Heightmap) else ""
    line = shape.line if isinstance(shape, Heightmap | Extrusion) else None
    return rule.at(
        file,
        line or use.link.line,
        f"link[@name='{use.link.name}']/{use.kind}/geometry/{use.tag}",
        message=f"The {use.kind} {use.tag}{name} of the link `{use.link.name}` {problem}.",
        hint=hint,
        severity=severity,
    )


TASK = "wsgen.descriptions.meshes.shape_worker:build"
LIMITS = Limits(seconds=30.0, memory=2 * 2**30)  # of all shapes of a robot
HINT = "Simplify the shape, or convert it to a mesh in another program."
DEATHS = 3  # after so many shapes that the child dies of, the others are not made

# What is made of a shape; nothing of a heightmap without an image, which the reader reports.
Answer = BuiltShape | UnbuildableShape | None


def build_shapes(
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
    answers = _ask(shapes, Path(tempfile.mkdtemp(prefix="shapes-", dir=folder)), run)
    found: dict[Diagnostic, None] = {}
    for use in uses:
        more = check_use(use, answers[_alone(use.shape)], file, is_static=robot.is_static)
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


def _uses(link: Link) -> Iterator[ShapeUse]:
    for collision in link.collisions:
        if isinstance(collision.geometry, Triangulated):
            yield ShapeUse(link, collision.geometry, is_visual=False)
    for visual in link.visuals:
        if isinstance(visual.geometry, Triangulated):
            yield ShapeUse(link, visual.geometry, is_visual=True)


def _alone(shape: Triangulated) -> Triangulated:
    """The shape, wherever it is: those that differ in their place alone have one mesh."""
    if isinstance(shape, Heightmap):
        return replace(shape, pos=(0.0, 0.0, 0.0), line=None)
    return replace(shape, line=None) if isinstance(shape, Extrusion) else shape


def _ask(shapes: Sequence[Triangulated], folder: Path, run: Run) -> Mapping[Triangulated, Answer]:
    """The child's answer for each shape; one that it dies of is not asked about again."""
    answers: dict[Triangulated, Answer] = {
        shape: None for shape in shapes if isinstance(shape, Heightmap) and shape.path is None
    }
    waiting = [shape for shape in shapes if shape not in answers]
    for _ in range(DEATHS if waiting else 0):
        outcome = run(TASK, waiting, folder, limits=LIMITS)
        if not isinstance(outcome, Died):
            made = decode(outcome.value, tuple[BuiltShape | UnbuildableShape, ...])
            return {**answers, **dict(zip(waiting, made, strict=True))}
        if not outcome.step.isdecimal():  # it died before it came to the first
            problem = f"was not made, because the child process {outcome.reason}"
            return {**answers, **_refused(waiting, problem, outcome.hint(HINT))}
        culprit = waiting.pop(int(outcome.step))
        problem = f"cannot be made: the child process {outcome.reason}"
        answers |= _refused([culprit], problem, outcome.hint(HINT))
    return {
        **answers,
        **_refused(
            waiting, f"was not made, because {DEATHS} other shapes crashed the child process"
        ),
    }


def _refused(
    shapes: Sequence[Triangulated], problem: str, hint: str = HINT
) -> dict[Triangulated, Answer]:
    return {shape: UnbuildableShape(problem=problem, hint=hint) for shape in shapes}


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
    if not isinstance(answer, BuiltShape):
        return Mesh(uri=uri)
    return Mesh(uri=uri, path=answer.path, bounds=(answer.low, answer.high))
