"""Which packages a simulator finds by its search path, in an install space that is laid out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.model.plan import Include, LaunchPlan, Process
from wsgen.model.world import Simulator, Spawn
from wsgen.packages.source_shares import INDEX
from wsgen.packages.workspace.overlay import Overlay
from wsgen.pipeline.launched_simulator import check_search_path
from wsgen.pipeline.started import Started

if TYPE_CHECKING:
    from collections.abc import Mapping

EXPORT = '<gazebo_ros gazebo_model_path="{}"/>'
OWN = EXPORT.format("${prefix}/..")
SPAWNER = Process(package="ros_gz_sim", executable="create", file=Path("a.launch.py"), line=3)
SPAWN = Spawn(
    entity="r",
    description='<robot name="r"><mesh filename="package://looks/meshes/a.stl"/></robot>',
    process=SPAWNER,
)
GZ = Include(package="ros_gz_sim", file=Path("gz_sim.launch.py"), arguments={"gz_args": "-r"})
CLASSIC = Include(package="gazebo_ros", file=Path("gazebo.launch.py"))
PLAIN_GZ = Process(package=None, executable=None, command=("gz", "sim", "-r", "w.sdf"))
PLAIN_CLASSIC = Process(package=None, executable=None, command=("gzserver", "w.world"))


def install(folder: Path, package: str, export: str = "") -> Path:
    """A package in a prefix of its own, as colcon installs it."""
    prefix = folder / "install" / package
    share = prefix / "share" / package
    (share / "meshes").mkdir(parents=True)
    (prefix / INDEX).mkdir(parents=True)
    (prefix / INDEX / package).touch()
    (share / "package.xml").write_text(f"<package><export>{export}</export></package>")
    return prefix


def check(
    folder: Path,
    starter: Include | Process,
    *,
    export: str = "",
    of_other: str = "",
    sources: tuple[Path, ...] = (),
    environment: Mapping[str, str] | None = None,
) -> list[str]:
    environment = environment or {}
    prefixes = (install(folder, "looks", export), install(folder, "starts", of_other))
    plan = LaunchPlan(
        package="starts",
        launch_file=Path("a.launch.py"),
        processes=(SPAWNER, *([starter] if isinstance(starter, Process) else [])),
        includes=(starter,) if isinstance(starter, Include) else (),
        environment=environment,
    )
    simulator = Simulator(kind="gz", world=None)
    started = Started(plan, simulator, (SPAWN,), (), True, 0.0, True)
    overlay = Overlay(install=folder / "install", environment={}, prefixes=prefixes)
    return [one.message for one in check_search_path(started, overlay, environment, sources)]


@pytest.mark.parametrize(
    ("starter", "export", "of_other", "is_found"),
    [
        (GZ, "", "", False),
        (GZ, OWN, "", True),
        (CLASSIC, OWN, "", True),
        (GZ, EXPORT.format("${prefix}/models"), "", False),
        (GZ, EXPORT.format("${prefix}/models:${prefix}/.."), "", True),
        (GZ, "", OWN, False),  # of another package, with a prefix of its own
        # These start it without the launch file that reads the exports.
        (PLAIN_GZ, OWN, "", False),
        (PLAIN_CLASSIC, OWN, "", False),
    ],
)
def test_exports(
    tmp_path: Path, starter: Include | Process, export: str, of_other: str, is_found: bool
) -> None:
    found = check(tmp_path, starter, export=export, of_other=of_other)
    assert len(found) == (not is_found)


@pytest.mark.parametrize("starter", [GZ, PLAIN_GZ, CLASSIC, PLAIN_CLASSIC])
def test_variables(tmp_path: Path, starter: Include | Process) -> None:
    is_gz = starter is GZ or starter is PLAIN_GZ
    right, wrong = "GZ_SIM_RESOURCE_PATH", "GAZEBO_MODEL_PATH"
    if not is_gz:
        right, wrong = wrong, right
    share = str(tmp_path / "0" / "install" / "looks" / "share")
    assert check(tmp_path / "0", starter, environment={right: f"/elsewhere:{share}"}) == []
    (found,) = check(tmp_path / "1", starter, environment={right: "/elsewhere"})
    assert f"no folder of {right} has the package" in found
    share = str(tmp_path / "2" / "install" / "looks" / "share")
    (found,) = check(tmp_path / "2", starter, environment={wrong: share})
    assert f"it reads {right}, not {wrong}" in found


def test_the_environment_of_a_process_counts(tmp_path: Path) -> None:
    share = str(tmp_path / "install" / "looks" / "share")
    own = Process(
        package=None,
        executable=None,
        command=PLAIN_GZ.command,
        environment={"GZ_SIM_RESOURCE_PATH": share},
    )
    assert check(tmp_path, own) == []


@pytest.mark.parametrize(
    ("name", "text", "is_set"),
    [
        ("run.sh", "export GZ_SIM_RESOURCE_PATH=$PWD/src", True),
        ("run.sh", "# export GZ_SIM_RESOURCE_PATH=$PWD/src", False),
        ("run.sh", "export GAZEBO_MODEL_PATH=$PWD/src", False),
        ("hooks/path.sh.in", "export GZ_SIM_RESOURCE_PATH=a", False),  # nothing registers it
        ("hooks/path.dsv.in", "prepend-non-duplicate;GZ_SIM_RESOURCE_PATH;share", False),
    ],
)
def test_what_somebody_has_to_source(tmp_path: Path, name: str, text: str, is_set: bool) -> None:
    source = tmp_path / "src"
    (source / name).parent.mkdir(parents=True)
    (source / name).write_text(text)
    assert len(check(tmp_path, GZ, sources=(source,))) == (not is_set)


def test_other_robots_and_simulators(tmp_path: Path) -> None:
    (tmp_path / "install").mkdir()
    overlay = Overlay(install=tmp_path / "install", environment={}, prefixes=())
    plan = LaunchPlan(package="starts", launch_file=Path("a.launch.py"), includes=(GZ,))
    started = Started(plan, None, (SPAWN,), (), True, 0.0, True)
    # A package that is not of the workspace brings what it needs.
    assert not list(check_search_path(started, overlay, {}, ()))


@pytest.mark.parametrize("folder", ["{parent}", "{source}/..", "/elsewhere"])
def test_the_folder_of_a_package_that_is_not_built_may_have_any_name(
    tmp_path: Path, folder: str
) -> None:
    source = tmp_path / "clone"
    source.mkdir()
    overlay = Overlay(
        install=tmp_path / "install", environment={}, prefixes=(), sources={"looks": source}
    )
    plan = LaunchPlan(
        package="starts",
        launch_file=Path("a.launch.py"),
        includes=(GZ,),
    )
    started = Started(plan, None, (SPAWN,), (), True, 0.0, True)
    path = folder.format(parent=tmp_path, source=source)
    found = check_search_path(started, overlay, {"GZ_SIM_RESOURCE_PATH": path}, ())
    assert len(list(found)) == (folder == "/elsewhere")
