"""Inspects the mesh files of a robot before an engine reads them, and reports what is wrong."""

from __future__ import annotations

import math
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.meshes.requests import InspectedMesh, MeshRequest, UnusableMesh
from wsgen.diagnostics import Diagnostic, Measured, Rule, Severity
from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died, Limits
from wsgen.model.robot import Mesh

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.descriptions.meshes.requests import ColoredMesh
    from wsgen.isolation.parent import Run
    from wsgen.model.robot import Collision, Link, MeshPart, Robot, Visual
    from wsgen.model.transform import Vector


BROKEN_COLLISION_MESH = Rule(
    code="ROB062",
    name="broken-collision-mesh",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates another robot", sim="accepts it"),
    summary="The mesh file of a `<collision>` cannot be used.",
    what="Reads every mesh file in a separate process: STL, OBJ, COLLADA, glTF, GLB and PLY. A "
    "file is broken if it is cut short or damaged, refers to vertices that it does not have, "
    "has no triangle, or takes too long to read.",
    why="Gazebo crashes on some of these files and does not load others: the link then passes "
    "through the ground.",
    example="An STL file whose header says 1000 triangles, and which ends after 900.",
    instead="The same mesh, exported again as binary STL or as OBJ.",
)

BROKEN_VISUAL_MESH = Rule(
    code="ROB063",
    name="broken-visual-mesh",
    severity=Severity.WARNING,
    summary="The mesh file of a `<visual>` cannot be used.",
    what="As `broken-collision-mesh`, for visuals; the simulation drops the visual.",
    why="Gazebo crashes on some of these files and does not load others: the link is invisible.",
    example="An OBJ file with 8 vertices, and a face `f 1 2 9`.",
    instead="The same mesh, exported again as COLLADA or OBJ.",
)

HEAVY_MESH = Rule(
    code="ROB064",
    name="heavy-mesh",
    severity=Severity.WARNING,
    summary="A mesh has more than 200,000 triangles.",
    why="Gazebo and the engines need a second or more to load each such mesh at every start.",
    example="A CAD export of 800,000 triangles as the <collision> of a link.",
    instead="A mesh of some thousand triangles, or a few <box> and <cylinder> elements.",
)

ENORMOUS_MESH = Rule(
    code="ROB065",
    name="enormous-mesh",
    severity=Severity.ERROR,
    severity_varies="a warning for a `<visual>`, which the simulation drops",
    summary="A mesh has more than a million triangles, or its file has more than 100 MB.",
    why="A physics engine needs 10 s or more to load it, at every start.",
    example="A 3D scan of 5,000,000 triangles.",
    instead="The scan, reduced to some thousand triangles.",
)

IMPLAUSIBLE_MESH_SIZE = Rule(
    code="ROB066",
    name="implausible-mesh-size",
    severity=Severity.WARNING,
    summary="A mesh of a robot is larger than 100 m or smaller than 0.1 mm.",
    what="Measures the longest edge of the bounding box of the mesh, with its `scale`.",
    why="STL and OBJ files have no unit: Gazebo reads their numbers as meters. CAD programs export "
    "millimeters, which makes the part 1000 times too large.",
    example='<mesh filename="package://my_robot/meshes/arm_in_mm.stl"/>',
    instead='<mesh filename="package://my_robot/meshes/arm_in_mm.stl" scale="0.001 0.001 0.001"/>',
)

INCONSISTENT_MESH = Rule(
    code="ROB067",
    name="inconsistent-mesh",
    severity=Severity.WARNING,
    summary="A mesh file contradicts itself, but Gazebo reads it.",
    what="Compares the counts in STL and COLLADA files with their contents.",
    why="Other programs refuse the file or crash: PyBullet, RViz, CAD programs.",
    example='<float_array count="24">0 0 0 1 0 0 0 1 0</float_array>',
    instead='<float_array count="9">0 0 0 1 0 0 0 1 0</float_array>',
)

MESH_FORMAT_NOT_READ_BY_ALL = Rule(
    code="ROB068",
    name="mesh-format-not-read-by-all",
    severity=Severity.WARNING,
    summary="Some versions of Gazebo do not read the format of a mesh.",
    why="Gazebo Classic and Fortress do not read glTF and GLB, and no version reads PLY: the part "
    "is missing there.",
    example='<mesh filename="package://my_robot/meshes/arm.glb"/>',
    instead='<mesh filename="package://my_robot/meshes/arm.dae"/>',
)

MANY_TRIANGLES = 200_000  # engines take a second or more for each such mesh
LARGEST = 100.0  # m, edge of the box around a part of a robot
LARGEST_STATIC = 1000.0  # m, of one around a terrain or a race track
SMALLEST = 1e-4  # m
USUAL = (0.005, 5.0)  # m, that of most parts
FACTORS = (0.001, 0.0254, 0.01, 0.1, 10.0, 100.0, 1000.0)  # mm, inches, cm …, and their opposites
RECENT_FORMATS = {
    ".glb": "Gazebo Classic and Fortress do not read GLB",
    ".gltf": "Gazebo Classic and Fortress do not read glTF",
    ".ply": "Gazebo does not read PLY",
}


Asked = tuple[str, "MeshPart | None"]  # a path, and a part of that file if it is not all of it


class MeshUse(NamedTuple):
    """A mesh in a link."""

    link: Link
    mesh: Mesh
    path: str
    is_visual: bool
    is_static: bool  # of a model that does not move

    @property
    def asked(self) -> Asked:
        """What of which file is inspected."""
        return self.path, self.mesh.part

    @property
    def kind(self) -> str:
        """The element that it is in."""
        return "visual" if self.is_visual else "collision"


def check_use(
    use: MeshUse, answer: InspectedMesh | UnusableMesh, file: Path | None
) -> Iterator[Diagnostic]:
    """What is wrong with a mesh.

    Args:
        use: Where it is used.
        answer: What the child process says of the file.
        file: The description.
    """
    if isinstance(answer, UnusableMesh):
        problem = f"{answer.problem} ({use.path})"
        if answer.is_enormous:
            severity = Severity.WARNING if use.is_visual else Severity.ERROR
            yield _report(use, file, ENORMOUS_MESH, problem, answer.hint, severity)
        else:
            broken = BROKEN_VISUAL_MESH if use.is_visual else BROKEN_COLLISION_MESH
            yield _report(use, file, broken, problem, answer.hint)
        return
    if answer.inconsistency is not None:
        hint = "Export the mesh again; the simulation reads it as Gazebo does."
        yield _report(use, file, INCONSISTENT_MESH, f"{answer.inconsistency} ({use.path})", hint)
    if answer.triangles > MANY_TRIANGLES:
        yield _report(
            use,
            file,
            HEAVY_MESH,
            f"has {answer.triangles:,} triangles and is slow to load",
            "Reduce its triangles; for a <collision>, use a few boxes or cylinders.",
        )
    lacking = RECENT_FORMATS.get(Path(use.path).suffix.lower())
    if lacking is not None:
        hint = "Convert it to STL, OBJ or COLLADA, which every Gazebo reads."
        problem = f"has a format with limited support: {lacking}"
        yield _report(use, file, MESH_FORMAT_NOT_READ_BY_ALL, problem, hint)
    yield from _check_extent(use, answer, file)
    for found in answer.material_problems if use.is_visual else ():
        yield _report(use, file, found.rule, found.problem, found.hint)


def _check_extent(use: MeshUse, answer: InspectedMesh, file: Path | None) -> Iterator[Diagnostic]:
    edges = zip(answer.low, answer.high, use.mesh.scale, strict=True)
    extent = max(abs(scale) * (high - low) for low, high, scale in edges)  # m
    largest = LARGEST_STATIC if use.is_static else LARGEST
    if SMALLEST <= extent <= largest or math.isnan(extent):  # the reader reports a scale of NaN
        return
    problem = f"is {extent:.3g} m {_size_word(extent)}"
    yield _report(use, file, IMPLAUSIBLE_MESH_SIZE, problem, _units_hint(use, extent))


def _size_word(extent: float) -> str:
    return "large: it is probably not in meters" if extent > LARGEST else "small"


def _units_hint(use: MeshUse, extent: float) -> str:
    """The scale that makes a usual part of it, if there is one."""
    for factor in FACTORS:
        if USUAL[0] <= extent * factor <= USUAL[1]:
            scale = " ".join(f"{part * factor:g}" for part in use.mesh.scale)
            return f'Write <mesh … scale="{scale}"/>, which makes it {extent * factor:.3g} m.'
    return "Check the scale, and the unit in which the mesh was exported."


def _report(  # noqa: PLR0913, PLR0917  the fields of a diagnostic, once
    use: MeshUse,
    file: Path | None,
    rule: Rule,
    problem: str,
    hint: str,
    severity: Severity | None = None,
) -> Diagnostic:
    """One sentence about the mesh; `problem` goes on after its name."""
    return rule.at(
        file,
        use.link.line,
        f"link[@name='{use.link.name}']/{use.kind}/geometry/mesh",
        message=f"The {use.kind} mesh `{use.mesh.uri}` of the link `{use.link.name}` {problem}.",
        hint=hint,
        severity=severity,
    )


TASK = "wsgen.descriptions.meshes.worker:inspect"
LIMITS = Limits(seconds=30.0, memory=2 * 2**30)  # of all meshes of a robot
HINT = "Open the mesh in a viewer; export it again or reduce its triangles."
DEATHS = 3  # after so many meshes that the child dies of, the others are not read

Answers = dict[Asked, InspectedMesh | UnusableMesh]
# By what is asked for, and whether it is painted in a color of the description.
Colored = dict[tuple[Asked, bool], tuple["ColoredMesh", ...]]


def inspect_meshes(
    robot: Robot,
    *,
    file: Path | None,
    folder: Path,
    run: Run = parent.run,
    with_colors: bool = False,
) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """Inspect every mesh that was found, and give each engine something it reads as Gazebo does.

    A collision that cannot be used keeps its uri and loses its path, and is an error; a visual is
    left out, and is a warning. A mesh that PyBullet does not read, or not as Gazebo does, is
    rewritten, and the robot that is returned has the path of the new file. All meshes get bounds
    and a number of triangles.

    With colors, a visual without a color of its own becomes one for each material of its file.

    Args:
        robot: The robot as written, its meshes with their paths.
        file: What the diagnostics name.
        folder: Where new files go; must be there as long as the returned robot is used.
        run: Starts the child process that reads the files.
        with_colors: Whether a picture is wanted.
    """
    requests = _requests(robot, with_colors=with_colors)
    if not requests:
        return robot, ()
    answers = _ask(requests, Path(tempfile.mkdtemp(prefix="meshes-", dir=folder)), run)
    colored: Colored = {
        ((request.path, request.part), is_painted): meshes
        for request in requests
        if isinstance(answer := answers[request.path, request.part], InspectedMesh)
        for is_painted, meshes in zip(request.showings, answer.colored, strict=True)
    }
    found: dict[Diagnostic, None] = {}  # one file may be seen several times in a link
    links = []
    for link in robot.links:
        visuals = [visual for one in link.visuals for visual in _new_visuals(one, answers, colored)]
        collisions = [_new_collision(one, answers) for one in link.collisions]
        for use in _uses(link, is_static=robot.is_static):
            found |= dict.fromkeys(check_use(use, answers[use.asked], file))
        links.append(replace(link, visuals=tuple(visuals), collisions=tuple(collisions)))
    return replace(robot, links=tuple(links)), tuple(found)


def _uses(link: Link, *, is_static: bool = False) -> Iterator[MeshUse]:
    collisions = [(collision.geometry, False) for collision in link.collisions]
    visuals = [(visual.geometry, True) for visual in link.visuals]
    for geometry, is_visual in (*collisions, *visuals):
        if isinstance(geometry, Mesh) and geometry.path is not None:
            yield MeshUse(link, geometry, geometry.path, is_visual=is_visual, is_static=is_static)


def _requests(robot: Robot, *, with_colors: bool) -> list[MeshRequest]:
    """Each file once, with what it is used for."""
    uses = [use for link in robot.links for use in _uses(link)]
    touched = {use.asked for use in uses if not use.is_visual}
    seen = {use.asked for use in uses if use.is_visual}
    showings: dict[Asked, dict[bool, None]] = {}
    for visual in (one for link in robot.links for one in link.visuals if with_colors):
        if isinstance(visual.geometry, Mesh) and visual.geometry.path is not None:
            asked = visual.geometry.path, visual.geometry.part
            showings.setdefault(asked, {})[visual.rgba is not None] = None
    return [
        MeshRequest(
            path=asked[0],
            part=asked[1],
            is_collision=asked in touched,
            is_visual=asked in seen and not with_colors,
            showings=tuple(showings.get(asked, ())),
        )
        for asked in dict.fromkeys(use.asked for use in uses)
    ]


def _ask(requests: Sequence[MeshRequest], folder: Path, run: Run) -> Answers:
    """The child's answer for each path; a mesh that it dies of is not asked about again."""
    answers: Answers = {}
    waiting = list(requests)
    for _ in range(DEATHS):
        outcome = run(TASK, waiting, folder, limits=LIMITS)
        if not isinstance(outcome, Died):
            decoded = decode(outcome.value, tuple[InspectedMesh | UnusableMesh, ...])
            asked = [(request.path, request.part) for request in waiting]
            return {**answers, **dict(zip(asked, decoded, strict=True))}
        if not outcome.step.isdecimal():  # it died before it came to the first
            problem = f"was not read, because the reader {outcome.reason}"
            return {**answers, **_refused(waiting, problem, outcome.hint(HINT))}
        culprit = waiting.pop(int(outcome.step))
        problem = f"cannot be read: the reader {outcome.reason}"
        answers |= _refused([culprit], problem, outcome.hint(HINT))
    return {
        **answers,
        **_refused(waiting, f"was not read, because {DEATHS} other meshes crashed the reader"),
    }


def read_surfaces(paths: Iterable[str], *, folder: Path, run: Run = parent.run) -> dict[str, str]:
    """The triangles of mesh files, each as an array that `wsgen.rendering.surfaces` loads.

    By the path of the mesh; what cannot be read is left out. The arrays are files in `folder`.
    """
    requests = [
        MeshRequest(path=path, is_collision=False, is_visual=False, showings=(True,))
        for path in dict.fromkeys(paths)
    ]
    if not requests:
        return {}
    answers = _ask(requests, Path(tempfile.mkdtemp(prefix="surfaces-", dir=folder)), run)
    return {
        path: meshes[0].path
        for (path, _), answer in answers.items()
        if isinstance(answer, InspectedMesh)
        for meshes in answer.colored
        if meshes
    }


def _refused(requests: Sequence[MeshRequest], problem: str, hint: str = HINT) -> Answers:
    refused = UnusableMesh(problem=problem, hint=hint)
    return {(request.path, request.part): refused for request in requests}


def _new_visuals(visual: Visual, answers: Answers, colored: Colored) -> Iterator[Visual]:
    """The visual with what to draw, for each color of its own; nothing if it cannot be drawn."""
    mesh = visual.geometry
    if not isinstance(mesh, Mesh) or mesh.path is None:
        yield visual
        return
    answer = answers[mesh.path, mesh.part]
    if isinstance(answer, UnusableMesh):
        return
    parts = colored.get(((mesh.path, mesh.part), visual.rgba is not None))
    if parts is None:  # its colors were not asked for
        yield replace(visual, geometry=_with_file(mesh, answer.visual, answer))
        return
    for part in parts:
        bounds = (part.low, part.high)
        yield replace(
            visual,
            geometry=_taken(mesh, part.path, bounds, part.triangles),
            rgba=visual.rgba if part.rgba is None else part.rgba,
            texture=part.texture,
        )


def _new_collision(collision: Collision, answers: Answers) -> Collision:
    mesh = collision.geometry
    if not isinstance(mesh, Mesh) or mesh.path is None:
        return collision
    answer = answers[mesh.path, mesh.part]
    if isinstance(answer, UnusableMesh):
        return replace(collision, geometry=replace(mesh, path=None))
    return replace(collision, geometry=_with_file(mesh, answer.collision, answer))


def _with_file(mesh: Mesh, path: str, answer: InspectedMesh) -> Mesh:
    return _taken(mesh, path, (answer.low, answer.high), answer.triangles)


def _taken(mesh: Mesh, path: str, bounds: tuple[Vector, Vector], triangles: int) -> Mesh:
    """The mesh with a file that has nothing but what is shown or touched."""
    return replace(mesh, path=path, part=None, bounds=bounds, triangles=triangles)
