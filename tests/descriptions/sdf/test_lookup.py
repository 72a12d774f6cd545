"""The file that a world's name stands for."""

from pathlib import Path

import pytest

from wsgen.descriptions.sdf.lookup import find_world, is_brought_along, model_finder


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_an_absolute_path_is_taken_as_it_is() -> None:
    assert find_world("/nowhere/some.world", {}) == Path("/nowhere/some.world")


def test_a_path_is_seen_from_the_current_folder(here: Path) -> None:
    (here / "some.world").touch()
    assert find_world("some.world", {}) == here / "some.world"


@pytest.mark.parametrize("variable", ["GAZEBO_RESOURCE_PATH", "GZ_SIM_RESOURCE_PATH"])
@pytest.mark.parametrize("place", ["some.world", "worlds/some.world"])
def test_a_name_is_looked_up_where_gazebo_does(here: Path, variable: str, place: str) -> None:
    file = here / "resources" / place
    file.parent.mkdir(parents=True)
    file.touch()
    environment = {variable: f"/nowhere:{here / 'resources'}"}
    assert find_world("some.world", environment) == file


def test_a_name_that_is_found_nowhere() -> None:
    assert find_world("empty.world", {"GAZEBO_RESOURCE_PATH": ""}) is None


def make_model(folder: Path, marker: str = "model.sdf") -> Path:
    folder.mkdir(parents=True)
    (folder / marker).touch()
    return folder


@pytest.mark.parametrize(
    "variable", ["GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH"]
)
def test_a_model_is_looked_up_where_gazebo_does(here: Path, variable: str) -> None:
    model = make_model(here / "resources" / "crate")
    find = model_finder(Path("/nowhere/w.world"), {variable: f"/gone:{here / 'resources'}"})
    assert find("model://crate") == model
    assert find("package://crate/") == model
    assert find("model://other") is None


@pytest.mark.parametrize("place", ["crate", "models/crate", "../crate", "../models/crate"])
def test_a_model_is_looked_up_around_the_file(here: Path, place: str) -> None:
    file = here / "package" / "worlds" / "w.world"
    model = make_model(file.parent / place)
    found = model_finder(file, {})("model://crate")
    assert found is not None
    assert found.samefile(model)


def test_the_models_of_gazebo_classic(here: Path) -> None:
    model = make_model(here / ".gazebo" / "models" / "crate")
    assert model_finder(Path("/nowhere/w"), {"HOME": str(here)})("model://crate") == model


def test_a_folder_with_a_model_goes_before_one_without(here: Path) -> None:
    (here / "first" / "crate").mkdir(parents=True)
    model = make_model(here / "second" / "crate", "model.config")
    find = model_finder(
        Path("/nowhere/w"), {"GAZEBO_MODEL_PATH": f"{here / 'first'}:{here / 'second'}"}
    )
    assert find("model://crate") == model
    (model / "model.config").unlink()
    assert find("model://crate") == here / "first" / "crate"


@pytest.mark.parametrize(
    "uri", ["crate", "model://", "model:///", "model://../crate", "https://x/crate", "model://a\0"]
)
def test_addresses_of_no_model(here: Path, uri: str) -> None:
    make_model(here / "crate")
    assert model_finder(here / "w.world", {"GAZEBO_MODEL_PATH": str(here)})(uri) is None


def test_a_name_that_no_folder_can_have(here: Path) -> None:
    assert model_finder(here / "w.world", {})("model://" + "x" * 5000) is None


@pytest.mark.parametrize(
    ("world", "expected"),
    [
        ("empty.sdf", True),
        ("worlds/empty.world", True),
        ("shapes.sdf", True),
        ("emtpy.sdf", False),
        ("mine/empty.sdf", False),
        ("/home/ada/worlds/empty.world", False),
        ("/usr/share/gazebo-11/worlds/cafe.world", True),
        ("/usr/share/ignition/ignition-gazebo6/worlds/shapes.sdf", True),
        ("/usr/share/gazebo-11/worlds/caffe.world", False),
        ("/opt/ros/nosuch/share/gazebo_ros/worlds/empty.world", True),
        ("/opt/ros/nosuch/share/gazebo_ros/worlds/emtpy.world", False),
        ("/opt/ros/nosuch/share/turtlebot3_gazebo/worlds/house.world", True),
    ],
)
def test_worlds_that_are_brought_along(world: str, expected: bool) -> None:
    assert is_brought_along(world) is expected
