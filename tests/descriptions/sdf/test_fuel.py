"""Models of Fuel: only what Gazebo has loaded on this machine before."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.sdf.lookup import Address, address_of, find_in_cache, model_finder
from wsgen.descriptions.sdf.models import read_model, read_sdf
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from pathlib import Path


SERVER = "https://fuel.gazebosim.org"
TREE = f"{SERVER}/1.0/OpenRobotics/models/Pine Tree"
LINK = '<link name="l"><inertial><mass>2</mass></inertial>{}</link>'


@pytest.mark.parametrize(
    ("uri", "expected"),
    [
        (TREE, ("OpenRobotics", "Pine Tree", "tip", "")),
        (TREE.replace(" ", "%20") + "/", ("OpenRobotics", "Pine Tree", "tip", "")),
        (f"{SERVER}/OpenRobotics/models/Pine Tree", ("OpenRobotics", "Pine Tree", "tip", "")),
        (f"{TREE}/3", ("OpenRobotics", "Pine Tree", "3", "")),
        (f"{TREE}/tip/files/meshes/a.dae", ("OpenRobotics", "Pine Tree", "tip", "meshes/a.dae")),
        (f"{TREE}/3/files/a.dae", ("OpenRobotics", "Pine Tree", "3", "a.dae")),
        (f"{SERVER}/1.0/OpenRobotics/worlds/Empty", None),
        (f"{SERVER}/1.0/OpenRobotics/models", None),
        (f"{SERVER}/1.0/OpenRobotics/models/..", None),
        (f"{SERVER}/1.0/OpenRobotics/models/a%2Fb", None),
        (f"{TREE}/3/files/../../../secret", None),
        (f"{TREE}/3/meshes/a.dae", None),
        ("https://[fuel/1.0/a/models/b", None),
        ("model://Pine Tree", None),
    ],
)
def test_addresses(uri: str, expected: tuple[str, ...] | None) -> None:
    found = address_of(uri)
    assert found == (None if expected is None else Address("fuel.gazebosim.org", *expected))


@pytest.mark.parametrize("cache", [".gz/fuel", ".ignition/fuel"])
@pytest.mark.parametrize("server", ["fuel.gazebosim.org", "fuel.ignitionrobotics.org"])
def test_the_newest_version_in_the_cache(tmp_path: Path, cache: str, server: str) -> None:
    folder = tmp_path / cache / server / "openrobotics" / "models" / "pine tree"
    for version in ("2", "10", "9", "10.zip"):
        (folder / version).mkdir(parents=True)
    environment = {"HOME": str(tmp_path)}
    assert find_in_cache(TREE, environment) == folder / "10"
    assert find_in_cache(f"{TREE}/tip", environment) == folder / "10"
    assert find_in_cache(f"{TREE}/2", environment) == folder / "2"
    assert find_in_cache(f"{TREE}/4", environment) is None
    assert find_in_cache(f"{SERVER}/1.0/OpenRobotics/models/Oak", environment) is None


@pytest.mark.parametrize("variable", ["GZ_FUEL_CACHE_PATH", "IGN_FUEL_CACHE_PATH"])
def test_a_cache_elsewhere(tmp_path: Path, variable: str) -> None:
    folder = tmp_path / "fuel.gazebosim.org" / "OpenRobotics" / "models" / "Pine Tree" / "1"
    folder.mkdir(parents=True)  # in capitals, as the first releases had it
    assert find_in_cache(TREE, {variable: str(tmp_path)}) == folder
    assert find_in_cache(TREE, {}) is None


def test_another_server_has_its_own_folder(tmp_path: Path) -> None:
    folder = tmp_path / "models.example.org" / "us" / "models" / "cart" / "1"
    folder.mkdir(parents=True)
    environment = {"GZ_FUEL_CACHE_PATH": str(tmp_path)}
    assert find_in_cache("https://models.example.org/1.0/us/models/cart", environment) == folder
    assert find_in_cache(f"{SERVER}/1.0/us/models/cart", environment) is None


def test_models_and_meshes_from_the_cache(tmp_path: Path) -> None:
    folder = tmp_path / ".gz/fuel/fuel.gazebosim.org/openrobotics/models/pine tree/2"
    (folder / "meshes").mkdir(parents=True)
    (folder / "meshes" / "a.dae").touch()
    mesh = f"<geometry><mesh><uri>{TREE}/tip/files/meshes/a.dae</uri></mesh></geometry>"
    visual = f'<visual name="v">{mesh}</visual>'
    (folder / "model.sdf").write_text(
        f'<sdf version="1.9"><model name="tree">{LINK.format(visual)}</model></sdf>'
    )
    file = tmp_path / "w.sdf"
    file.write_text(
        '<sdf version="1.9"><world name="w"><include><uri>model://ground_plane</uri></include>'
        f"<include><uri>{TREE}</uri><pose>1 0 0 0 0 0</pose></include></world></sdf>"
    )
    found = read_sdf(file, find_model=model_finder(file, {"HOME": str(tmp_path)}))
    assert found.diagnostics == ()
    (tree,) = found.models
    assert (tree.name, tree.pose_in_world.xyz) == ("tree", (1, 0, 0))
    assert tree.robot is not None
    assert repr(str(folder / "meshes" / "a.dae")) in repr(tree.robot.links[0].visuals)


def test_what_was_not_loaded_yet(tmp_path: Path) -> None:
    file = tmp_path / "w.sdf"
    file.write_text(
        '<sdf version="1.9"><world name="w"><include><uri>model://ground_plane</uri></include>\n'
        f"<include><uri>{TREE}</uri></include></world></sdf>"
    )
    (found,) = read_sdf(file, find_model=model_finder(file, {"HOME": str(tmp_path)})).diagnostics
    assert (found.code, found.severity, found.line) == ("WLD004", Severity.WARNING, 2)
    assert f"gz fuel download -u '{TREE}'" in (found.hint or "")
    assert "GZ_SIM_RESOURCE_PATH" in (found.hint or "")


def test_meshes_that_gazebo_downloads(tmp_path: Path) -> None:
    mesh = f"<geometry><mesh><uri>{TREE}/1/files/tree.obj</uri></mesh></geometry>"
    link = LINK.format(f'<collision name="c">{mesh}</collision><visual name="v">{mesh}</visual>')
    model = f'<model name="tree">\n{link}</model>'
    find_model = model_finder(tmp_path / "w.sdf", {"HOME": str(tmp_path)})
    world = read_sdf(
        tmp_path / "w.sdf",
        find_model=find_model,
        content=f'<sdf version="1.9"><world name="w">{model}</world></sdf>',
    )
    (found,) = world.diagnostics
    assert (found.code, found.severity) == ("WLD066", Severity.INFO)
    assert "Pine Tree" in found.message
    assert world.models == ()  # it would fall through the ground
    spawned = read_model(
        f'<sdf version="1.9">{model}</sdf>', file=None, find_model=find_model
    ).diagnostics
    assert [(one.code, one.severity) for one in spawned] == [("WLD066", Severity.WARNING)]
