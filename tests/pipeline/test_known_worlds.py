"""A world that several launch files start is read once."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.descriptions.sdf.models import SdfFile
from wsgen.isolation import parent
from wsgen.model.plan import LaunchPlan
from wsgen.model.world import Simulator
from wsgen.pipeline.gazebo_models import KnownWorlds, ReadWorld
from wsgen.pipeline.prepare import PrepareContext
from wsgen.pipeline.started import Started

if TYPE_CHECKING:
    from collections.abc import Mapping


def started(world: str) -> Started:
    plan = LaunchPlan(package="p", launch_file=Path("p.launch.py"))
    simulator = Simulator(kind="gz", world=world)
    return Started(plan, simulator, (), (), has_spawner=True, seconds=0.1, is_evaluated=True)


def test_worlds_of_several_launch_files(tmp_path: Path) -> None:
    known = KnownWorlds(tmp_path, [started("w.sdf"), started("w.sdf"), started("own.sdf"), None])
    context = PrepareContext(share_of=lambda _: None, folder=Path("/own"), run=parent.run)
    folders = []

    def read(world: str, environment: Mapping[str, str] | None = None, kind: str = "gz") -> None:
        def make(context: PrepareContext) -> ReadWorld:
            folders.append((world, context.folder))
            return ReadWorld(SdfFile(world=None, models=(), diagnostics=()), [], ())

        known.read(world, Path("/worlds", world), kind, context, environment or {}, make)

    for world in ("w.sdf", "own.sdf", "own.sdf", "w.sdf"):
        read(world)
    # What one launch file alone starts is read into its own folder, which is soon removed.
    own = ("own.sdf", Path("/own"))
    assert folders == [("w.sdf", tmp_path), own, own]
    read("w.sdf", {"LANG": "C"})
    assert len(folders) == 3
    read("w.sdf", {"GZ_SIM_RESOURCE_PATH": "/models"})
    read("w.sdf", kind="classic")
    assert len(folders) == 5
