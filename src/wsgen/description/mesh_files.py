"""What is in the mesh files of a robot, before an engine sees them."""

from __future__ import annotations

import tempfile
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.description.mesh_findings import MeshUse, find_in_use
from wsgen.isolation import parent
from wsgen.isolation.outcome import Died, Limits
from wsgen.model.robot import Mesh

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.protocol import Run
    from wsgen.model.robot import Collision, Link, Robot, Visual

TASK = "wsgen.description.mesh_worker:inspect"
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
    with_colours: bool = False,
) -> tuple[Robot, tuple[Diagnostic, ...]]:
    """Look into every mesh that was found, and give each engine something it reads as Gazebo does.

    A collision that cannot be used keeps its uri and loses its path, and is an error; a visual is
    left out, and is a warning. A mesh that PyBullet reads otherwise than Gazebo, or not at all, is
    written anew, and the robot that is returned has the path of that. All meshes get bounds and a
    number of triangles.

    With colours, a visual without a colour of its own becomes one for each material of its file,
    and what is seen has no more triangles than a picture shows.

    Args:
        robot: The robot as written, its meshes with their paths.
        file: What the diagnostics name.
        folder: Where new files go; must be there as long as the returned robot is used.
        run: Starts the child process that reads the files.
        with_colours: Whether a picture is wanted.
    """
    requests = _requests(robot, with_colours=with_colours)
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


def _requests(robot: Robot, *, with_colours: bool) -> list[Request]:
    """Each file once, with what it is used for."""
    uses = [use for link in robot.links for use in _uses(link)]
    touched = {use.path for use in uses if not use.is_visual}
    seen = {use.path for use in uses if use.is_visual}
    counts: dict[str, Counter[tuple[bool, tuple[float, float, float]]]] = {}
    for visual in (one for link in robot.links for one in link.visuals if with_colours):
        if isinstance(visual.geometry, Mesh) and visual.geometry.path is not None:
            counts.setdefault(visual.geometry.path, Counter())[_showing(visual)] += 1
    return [
        (
            path,
            path in touched,
            path in seen and not with_colours,
            [(*showing, times) for showing, times in counts.get(path, {}).items()],
        )
        for path in dict.fromkeys(use.path for use in uses)
    ]


def _showing(visual: Visual) -> tuple[bool, tuple[float, float, float]]:
    """Whether it has a colour of its own, and its scale."""
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
    """The visual with what to draw, for each colour of its own; nothing if it cannot be drawn."""
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
