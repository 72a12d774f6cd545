"""The models of SDF become robots to be tried, or the scenery of others."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.lump import lump
from wsgen.description.meshes import find_meshes
from wsgen.description.reader import read_urdf
from wsgen.diagnostics import has_errors
from wsgen.pipeline.described import Described, complete
from wsgen.world.lookup import model_finder
from wsgen.world.models import read_model, read_sdf

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import Spawn
    from wsgen.model.robot import Robot
    from wsgen.pipeline.described import Workshop
    from wsgen.world.models import SdfFile


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
        scheme, _, name = uri.partition("://")
        is_local = scheme in {"model", "package"}
        return found or (workshop.share_of(name.partition("/")[0]) if is_local else None)

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

    Where the file has errors none of them is sound: the scene would be another one than described.
    """
    described: list[Described] = []
    diagnostics: list[Diagnostic] = []
    for model in found.models:
        if model.robot is None:
            continue
        robot, flawed = complete(model.robot, model.file, workshop)
        diagnostics += flawed
        described.append(
            Described(
                entity=model.name,
                written=model.robot,
                lumped=robot,
                is_sound=not has_errors((*found.diagnostics, *flawed)),
                spawn_pose=model.pose_in_world,
                on_the_ground=found.world is None and not model.is_static,
                is_scenery=is_scenery,
                may_move=found.world is not None,
            )
        )
    return described, tuple(dict.fromkeys(diagnostics))


def without_taken(scenery: Iterable[Described], taken: Iterable[str]) -> list[Described]:
    """The scenery without models whose names are taken by what is spawned: one scene, one name."""
    names = set(taken)
    return [model for model in scenery if model.entity not in names]
