"""Robots of worlds, and models that are spawned by their address."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.isolation import parent
from wsgen.launching.simulators import find_simulator
from wsgen.model.plan import LaunchPlan, Process
from wsgen.model.world import Spawn
from wsgen.packages.workspace.overlay import Overlay
from wsgen.pipeline.gazebo_models import (
    as_robots,
    find_robots,
    look_up_model,
    robots_of_world,
)
from wsgen.pipeline.prepare import PrepareContext, prepare_models, read_file

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.descriptions.sdf.models import SdfFile


def model(name: str, *, joint: str = "revolute", static: bool = False) -> str:
    links = "".join(
        f"<link name='{link}'><inertial><mass>1</mass></inertial><collision name='c'><geometry>"
        "<box><size>1 1 1</size></box></geometry></collision></link>"
        for link in ("a", "b")
    )
    joints = (
        f"<joint name='j' type='{joint}'><parent>a</parent><child>b</child>"
        "<axis><xyz>0 0 1</xyz></axis></joint>"
        if joint
        else ""
    )
    return f"<model name='{name}'><static>{str(static).lower()}</static>{links}{joints}</model>"


def world(folder: Path, *models: str) -> Path:
    file = folder / "w.sdf"
    file.write_text(f"<sdf version='1.8'><world name='w'>{''.join(models)}</world></sdf>")
    return file


def context(folder: Path) -> PrepareContext:
    return PrepareContext(share_of=lambda _: None, folder=folder, run=parent.run)


def read(file: Path, environment: Mapping[str, str]) -> SdfFile:
    return read_file(file, context(file.parent), environment)


def plan(file: Path | str, *processes: Process) -> LaunchPlan:
    gazebo = Process(package=None, executable=None, command=("gz", "sim", str(file)))
    return LaunchPlan(package="p", launch_file=Path("p.launch.py"), processes=(gazebo, *processes))


OVERLAY = Overlay(install=Path("install"), environment={}, prefixes=())


@pytest.mark.parametrize(
    ("written", "names"),
    [
        (model("m"), {"m"}),
        (model("m", joint="prismatic"), {"m"}),
        (model("m", static=True), set()),
        (model("m", joint="fixed"), set()),
        (model("m", joint=""), set()),
        (model("m") + model("n"), {"m", "n"}),
        ("<include><uri>model://cart</uri><name>mine</name></include>", {"mine"}),
        ("<include><uri>model://elsewhere</uri></include>", set()),
    ],
)
def test_robots_of_a_world(tmp_path: Path, written: str, names: set[str]) -> None:
    (tmp_path / "models" / "cart").mkdir(parents=True)
    (tmp_path / "models" / "cart" / "model.sdf").write_text(
        f"<sdf version='1.8'>{model('cart')}</sdf>"
    )
    file = world(tmp_path, written)
    assert robots_of_world(read(file, {}), {}) == names
    assert find_robots(plan(file), OVERLAY).are_meant == bool(names)


def test_what_may_have_a_robot_and_is_not_there(tmp_path: Path) -> None:
    sun = "<include><uri>model://sun</uri></include>"
    missing = "<include><uri>model://my_vessel</uri></include>"
    found = find_robots(plan(world(tmp_path, sun, missing)), OVERLAY)
    assert not found.lack_world
    assert "w.sdf: The model `model://my_vessel`" in (found.lack_model or "")
    assert find_robots(plan(world(tmp_path, sun, model("m"), missing)), OVERLAY).are_meant
    assert find_robots(plan(world(tmp_path, sun)), OVERLAY).lack_model is None
    for name in (tmp_path / "no.sdf", "no.sdf"):
        found = find_robots(plan(name), OVERLAY)
        assert found.lack_world
        assert not found.diagnostics
    for name in ("empty.sdf", "https://example.org/w.sdf", "/opt/ros/iron/share/other/w.world"):
        assert not find_robots(plan(name), OVERLAY).lack_world
    written = replace(plan(tmp_path / "made.sdf"), written={str(tmp_path / "made.sdf"): "<sdf/>"})
    assert not find_robots(written, OVERLAY).lack_world


def test_models_of_gazebo_are_no_robots(tmp_path: Path) -> None:
    environment = {"HOME": str(tmp_path)}
    folder = tmp_path / ".gazebo" / "models" / "crane"
    folder.mkdir(parents=True)
    (folder / "model.sdf").write_text(f"<sdf version='1.8'>{model('crane')}</sdf>")
    (tmp_path / "my").mkdir()
    file = world(tmp_path / "my", "<include><uri>model://crane</uri></include>")
    found = read(file, environment)
    assert [one.name for one in found.models] == ["crane"]
    assert robots_of_world(found, environment) == set()


def test_a_robot_with_an_error_is_there_and_not_simulated(tmp_path: Path) -> None:
    bad = model("bad").replace("<mass>1<", "<mass>-1<")
    found = read(world(tmp_path, bad, model("good"), model("box", joint="")), {})
    models, _ = prepare_models(found, context(tmp_path), is_static_model=True)
    robots = {one.entity: one for one in as_robots(models, robots_of_world(found, {}))}
    assert [name for name, one in robots.items() if not one.is_static_model] == ["bad", "good"]
    assert robots["good"].can_run
    assert not robots["bad"].can_run


def test_plans_with_a_spawner(tmp_path: Path) -> None:
    file = world(tmp_path)
    assert not find_robots(plan(file), OVERLAY).are_meant
    assert not find_robots(plan("no.sdf"), OVERLAY).are_meant
    create = Process(package="ros_gz_sim", executable="create", arguments=("-string", "<robot/>"))
    assert find_robots(plan(file, create), OVERLAY).are_meant
    wrong = replace(create, arguments=("-file", "/no/r.urdf"))
    assert find_robots(plan(file, wrong), OVERLAY).are_meant
    publisher = Process(
        package="robot_state_publisher",
        executable="robot_state_publisher",
        parameters={"robot_description": "<robot name='r'/>"},
    )
    assert not find_robots(plan(file, publisher), OVERLAY).are_meant
    own = Process(package="my_robot", executable="spawn")
    assert find_robots(plan(file, publisher, own), OVERLAY).are_meant
    assert find_simulator(plan(file))[0] is not None


def test_model_that_is_spawned_by_its_name(tmp_path: Path) -> None:
    folder = tmp_path / "models" / "cup"
    folder.mkdir(parents=True)
    (folder / "model.sdf").write_text("<sdf version='1.8'/>")
    spawn = Spawn(entity="c", description="", model_uri="model://cup")
    environment = {"GAZEBO_MODEL_PATH": str(tmp_path / "models")}
    process = Process(package="gazebo_ros", executable="spawn_entity.py", file=tmp_path / "l.py")
    found = look_up_model(replace(spawn, process=process), context(tmp_path), environment)
    assert isinstance(found, Spawn)
    assert (found.description, found.description_file) == (
        "<sdf version='1.8'/>",
        folder / "model.sdf",
    )
    for uri in ("model://no", "https://fuel.gazebosim.org/1.0/a/models/b"):
        missing = look_up_model(replace(spawn, model_uri=uri), context(tmp_path), {})
        assert not isinstance(missing, Spawn)
        assert (missing.code, missing.element) == ("SPN006", uri)


@pytest.mark.parametrize("place", ["cup", "models/cup"])
def test_models_of_other_packages(tmp_path: Path, place: str) -> None:
    folder = tmp_path / "prefix" / "share" / "my_models" / place
    folder.mkdir(parents=True)
    (folder / "model.sdf").write_text("<sdf version='1.8'/>")
    (tmp_path / "cup").mkdir()  # no model, but of that name
    process = Process(package="ros_gz_sim", executable="create", file=tmp_path / "l.py")
    spawn = Spawn(entity="c", description="", model_uri="model://cup", process=process)
    environment = {"AMENT_PREFIX_PATH": str(tmp_path / "prefix")}
    for uri in ("model://cup", str(folder)):
        found = look_up_model(replace(spawn, model_uri=uri), context(tmp_path), environment)
        assert isinstance(found, Spawn)
        assert found.description_file == folder / "model.sdf"
