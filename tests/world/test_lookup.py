"""The file that a world's name stands for."""

from pathlib import Path

import pytest

from wsgen.world.lookup import find_world


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
