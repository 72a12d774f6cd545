"""What is in the mesh files of a robot, before an engine sees them.

What to say of a mesh file where a link uses it.
"""

from __future__ import annotations

import math
import tempfile
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation import parent
from wsgen.isolation.outcome import Died, Limits
from wsgen.model.robot import Mesh

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.isolation.parent import Run
    from wsgen.model.robot import Collision, Link, Robot, Visual


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
        hint = "The simulation takes it as Gazebo reads it; export it anew."
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
    yield from _check_extent(use, answer, file)
    for code, what, hint in answer["complaints"] if use.is_visual else ():
        yield _finding(use, file, code, what, hint, severity=LOOKS.get(code, Severity.WARNING))


def _check_extent(
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
    return "large: its unit seems not to be the meter" if extent > LARGEST else "small"


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


TASK = "wsgen.meshes.worker:inspect"
LIMITS = Limits(seconds=30.0, memory=2 * 2**30)  # of all meshes of a robot
HINT = "Look at the mesh in a viewer, and export it anew or reduce it."
DEATHS = 3  # after so many meshes that the child dies of, the others are not read

Request = tuple[str, bool, bool, list["Showing"]]  # the fields of `mesh_worker.Request`
Showing = tuple[bool, tuple[float, float, float], int]  # the fields of `mesh_looks.Showing`
Answer = dict[str, Any]  # what `mesh_worker.inspect` says of a file


def inspect_meshes(
    robot: Robot,
    *,
    file: Path | None,
    folder: Path,
    run: Run = parent.run,
    with_colors: bool = False,
) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """Look into every mesh that was found, and give each engine something it reads as Gazebo does.

    A collision that cannot be used keeps its uri and loses its path, and is an error; a visual is
    left out, and is a warning. A mesh that PyBullet reads otherwise than Gazebo, or not at all, is
    written anew, and the robot that is returned has the path of that. All meshes get bounds and a
    number of triangles.

    With colors, a visual without a color of its own becomes one for each material of its file,
    and what is seen has no more triangles than a picture shows.

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
    found: dict[Diagnostic, None] = {}  # one file may be seen several times in a link
    links = []
    for link in robot.links:
        visuals = [visual for one in link.visuals for visual in _new_visuals(one, answers)]
        collisions = [_new_collision(one, answers) for one in link.collisions]
        for use in _uses(link):
            found |= dict.fromkeys(find_in_use(use, answers[use.path], file))
        links.append(replace(link, visuals=tuple(visuals), collisions=tuple(collisions)))
    return replace(robot, links=tuple(links)), tuple(found)


def _uses(link: Link) -> Iterator[MeshUse]:
    collisions = [(collision.geometry, False) for collision in link.collisions]
    visuals = [(visual.geometry, True) for visual in link.visuals]
    for geometry, is_visual in (*collisions, *visuals):
        if isinstance(geometry, Mesh) and geometry.path is not None:
            yield MeshUse(link, geometry, geometry.path, is_visual=is_visual)


def _requests(robot: Robot, *, with_colors: bool) -> list[Request]:
    """Each file once, with what it is used for."""
    uses = [use for link in robot.links for use in _uses(link)]
    touched = {use.path for use in uses if not use.is_visual}
    seen = {use.path for use in uses if use.is_visual}
    counts: dict[str, Counter[tuple[bool, tuple[float, float, float]]]] = {}
    for visual in (one for link in robot.links for one in link.visuals if with_colors):
        if isinstance(visual.geometry, Mesh) and visual.geometry.path is not None:
            counts.setdefault(visual.geometry.path, Counter())[_showing(visual)] += 1
    return [
        (
            path,
            path in touched,
            path in seen and not with_colors,
            [(*showing, times) for showing, times in counts.get(path, {}).items()],
        )
        for path in dict.fromkeys(use.path for use in uses)
    ]


def _showing(visual: Visual) -> tuple[bool, tuple[float, float, float]]:
    """Whether it has a color of its own, and its scale."""
    geometry = visual.geometry
    scale = geometry.scale if isinstance(geometry, Mesh) else (1.0, 1.0, 1.0)
    return visual.rgba is not None, scale


def _ask(requests: Sequence[Request], folder: Path, run: Run) -> Mapping[str, Answer]:
    """What the child says of each path; what it dies of, it is asked about no more."""
    answers: dict[str, Answer] = {}
    waiting = list(requests)
    for _ in range(DEATHS):
        outcome = run(TASK, waiting, str(folder), limits=LIMITS)
        if not isinstance(outcome, Died):
            pairs = zip(waiting, outcome.value, strict=True)
            return {**answers, **{request[0]: _told(request, answer) for request, answer in pairs}}
        if not outcome.step.isdecimal():  # it died before it came to the first
            problem = f"was not read, as the reader {outcome.reason}"
            return {**answers, **_refused(waiting, problem, outcome.hint(HINT))}
        culprit = waiting.pop(int(outcome.step))
        problem = f"cannot be read: the reader {outcome.reason}"
        answers |= _refused([culprit], problem, outcome.hint(HINT))
    return {**answers, **_refused(waiting, f"was not read, as the reader died of {DEATHS} others")}


def _told(request: Request, answer: Answer) -> Answer:
    """The answer with the looks by what they were asked for."""
    showings = [(is_painted, scale) for is_painted, scale, _ in request[3]]
    return {**answer, "looks": dict(zip(showings, answer["looks"], strict=True))}


def _refused(requests: Sequence[Request], problem: str, hint: str = HINT) -> dict[str, Answer]:
    answer = {"problem": problem, "hint": hint, "is_enormous": False}
    return {request[0]: answer for request in requests}


def _new_visuals(visual: Visual, answers: Mapping[str, Answer]) -> Iterator[Visual]:
    """The visual with what to draw, for each color of its own; nothing if it cannot be drawn."""
    mesh = visual.geometry
    if not isinstance(mesh, Mesh) or mesh.path is None:
        yield visual
        return
    answer = answers[mesh.path]
    if answer["problem"] is not None:
        return
    looks = answer["looks"].get(_showing(visual))
    if looks is None:  # nobody asked for it
        yield replace(visual, geometry=_with_file(mesh, answer["visual"], answer))
        return
    for path, rgba, texture, low, high, triangles in looks:
        bounds = (tuple(low), tuple(high))
        yield replace(
            visual,
            geometry=replace(mesh, path=path, bounds=bounds, triangles=triangles),
            rgba=visual.rgba if rgba is None else tuple(rgba),
            texture=texture,
        )


def _new_collision(collision: Collision, answers: Mapping[str, Answer]) -> Collision:
    mesh = collision.geometry
    if not isinstance(mesh, Mesh) or mesh.path is None:
        return collision
    answer = answers[mesh.path]
    if answer["problem"] is not None:
        return replace(collision, geometry=replace(mesh, path=None))
    return replace(collision, geometry=_with_file(mesh, answer["collision"], answer))


def _with_file(mesh: Mesh, path: str, answer: Answer) -> Mesh:
    bounds = (tuple(answer["low"]), tuple(answer["high"]))
    return replace(mesh, path=path, bounds=bounds, triangles=answer["triangles"])
