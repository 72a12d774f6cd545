"""The models of SDF become robots to be tried, or the scenery of others."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.description.lump import lump
from wsgen.description.meshes import find_meshes
from wsgen.description.reader import read_urdf
from wsgen.diagnostics import Diagnostic, Severity, has_errors
from wsgen.model.robot import Robot
from wsgen.pipeline.described import Described, complete
from wsgen.world.lookup import model_finder
from wsgen.world.models import read_model, read_sdf

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence
    from pathlib import Path

    from wsgen.model.plan import Spawn
    from wsgen.pipeline.described import Workshop
    from wsgen.world.models import SdfFile, SdfModel

MOST_MODELS = 1000  # a minute of simulation for 3 s; public worlds have some dozens


def read_file(file: Path, workshop: Workshop, environment: Mapping[str, str]) -> SdfFile:
    """An SDF file, with what it includes from where Gazebo looks and from around the file."""
    return read_sdf(
        file,
        find_model=_finder(file, workshop, environment),
        read_robot=lambda urdf: _read_included(urdf, workshop),
    )


def read_spawned(spawn: Spawn, workshop: Workshop, environment: Mapping[str, str]) -> SdfFile:
    """The model of a spawner that is given SDF."""
    file = spawn.description_file
    return read_model(
        spawn.description,
        file=file,
        find_model=_finder(file, workshop, environment),
        pose_in_world=spawn.pose_in_world,
    )


def _finder(
    file: Path | None, workshop: Workshop, environment: Mapping[str, str]
) -> Callable[[str], Path | None]:
    """A function from the address of a model to its folder."""
    find = None if file is None else model_finder(file, environment)

    def find_model(uri: str) -> Path | None:
        found = None if find is None else find(uri)
        scheme, _, rest = uri.partition("://")
        name = rest.partition("/")[0]
        is_local = scheme in {"model", "package"} and name not in {"", ".", ".."}
        return found or (workshop.share_of(name) if is_local else None)

    return find_model


def _read_included(file: Path, workshop: Workshop) -> tuple[Robot | None, tuple[Diagnostic, ...]]:
    """A URDF file that a world includes, as Gazebo has it."""
    written, found = read_urdf(file.read_bytes(), file=file)
    if written is None:
        return None, found
    located, missing = find_meshes(
        written, share_of=workshop.share_of, folder=file.parent, file=file
    )
    lumped, dropped = lump(located, file=file)
    return lumped, (*found, *missing, *dropped)


def describe_models(
    found: SdfFile, workshop: Workshop, *, is_scenery: bool = False
) -> tuple[list[Described], tuple[Diagnostic, ...]]:
    """The models that have links, ready for an engine, and what is wrong with their meshes.

    Scenery is there with all that can be had of it; of a file that is tried by itself nothing is
    sound where there are errors: the scene would be another one than described.
    """
    models = [model for model in found.models if model.robot is not None]
    if len(models) > MOST_MODELS:
        return [], (_too_many(len(models), found),)
    robots, flawed = _completed(models, workshop)
    is_sound = is_scenery or not has_errors((*found.diagnostics, *flawed))
    return [
        Described(
            entity=model.name,
            written=written,
            lumped=robot,
            is_sound=is_sound,
            spawn_pose=model.pose_in_world,
            on_the_ground=found.world is None and not model.is_static,
            is_scenery=is_scenery,
            may_move=found.world is not None,
            diagnostics=_about(model, models, (*found.diagnostics, *flawed)),
        )
        for model, robot in zip(models, robots, strict=True)
        if (written := model.robot) is not None
    ], flawed


def _about(
    model: SdfModel, models: Iterable[SdfModel], diagnostics: Iterable[Diagnostic]
) -> tuple[Diagnostic, ...]:
    """What has been reported of a model: where its file holds others, by its name."""
    is_alone = sum(other.file == model.file for other in models) == 1
    place = f"/model[@name='{model.name}']"
    return tuple(
        found
        for found in diagnostics
        if found.file == model.file and (is_alone or place in (found.element or ""))
    )


def _completed(
    models: Sequence[SdfModel], workshop: Workshop
) -> tuple[list[Robot], tuple[Diagnostic, ...]]:
    """The robots of the models, with files that engines read.

    The links of all models of one file are looked into together: a child process for each of some
    hundred models would take longer than to simulate them.
    """
    completed: dict[int, Robot] = {}
    diagnostics: list[Diagnostic] = []
    groups: dict[tuple[Path | None, bool], list[int]] = {}
    for number, model in enumerate(models):
        groups.setdefault((model.file, model.is_static), []).append(number)
    for (file, is_static), numbers in groups.items():
        robots = [robot for number in numbers if (robot := models[number].robot) is not None]
        names = [models[number].name for number in numbers] if len(numbers) > 1 else [None]
        together = Robot(
            name="",
            root="",
            links=tuple(
                link if name is None else replace(link, name=f"{name}::{link.name}")
                for robot, name in zip(robots, names, strict=True)
                for link in robot.links
            ),
            is_static=is_static,
        )
        whole, flawed = complete(together, file, workshop)
        diagnostics += flawed
        links = iter(whole.links)
        for number, robot in zip(numbers, robots, strict=True):
            own = (replace(next(links), name=link.name) for link in robot.links)
            completed[number] = replace(robot, links=tuple(own))
    return [completed[number] for number in range(len(models))], tuple(diagnostics)


def _too_many(models: int, found: SdfFile) -> Diagnostic:
    return Diagnostic(
        code="SPN035",
        severity=Severity.ERROR,
        message=f"The world holds {models:,} models: a trial takes at most {MOST_MODELS:,}.",
        file=found.world.file if found.world else None,
        hint="Make one static model of what never moves, or split the world.",
    )


def without_taken(scenery: Iterable[Described], taken: Iterable[str]) -> list[Described]:
    """The scenery without models whose names are taken by what is spawned: one scene, one name."""
    names = set(taken)
    return [model for model in scenery if model.entity not in names]
