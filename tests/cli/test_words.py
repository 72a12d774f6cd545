"""Words that several commands read."""

from pathlib import Path

import pytest

from building.building import write_package
from wsgen.cli.words import launch_file_of
from wsgen.errors import NotFoundError, RequestError
from wsgen.packages.workspace.layout import Workspace


@pytest.mark.parametrize("inside", [".", "src/demo/launch"])
def test_a_launch_file_stands_for_its_package(
    inside: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = write_package(tmp_path / "ws") / "launch" / "demo.launch.py"
    monkeypatch.chdir(tmp_path / "ws" / inside)
    place = Workspace(root=tmp_path / "ws")
    for given in (str(file), str(file.relative_to(Path.cwd()))):
        assert launch_file_of([given], None) == ("demo", "demo.launch.py", place)
    other = file.parent / "sim" / "demo.launch.py"
    other.parent.mkdir()
    other.touch()  # its name alone would be that of two
    assert launch_file_of([str(other)], None) == ("demo", "launch/sim/demo.launch.py", place)
    simulation = file.with_name("simulation.py")
    simulation.write_text("def generate_launch_description():\n    pass\n")
    assert launch_file_of([str(simulation)], None) == ("demo", "simulation.py", place)
    for names in (["demo"], ["robot.urdf"], ["robot.py"], [], [str(tmp_path)]):
        assert launch_file_of(names, "other.launch.py") is None


@pytest.mark.parametrize(
    ("names", "launch_file", "message"),
    [
        (["demo.launch.py", "demo"], None, "cannot be combined with 'demo'"),
        (["demo.launch.py"], "x.launch.py", "cannot be combined with '--launch x.launch.py'"),
        (["demo.launch.py"], None, "is not in a package: no package.xml is above it"),
    ],
)
def test_a_launch_file_that_stands_for_nothing(
    names: list[str],
    launch_file: str | None,
    message: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    write_package(tmp_path / "ws")
    for name, package in (("missing", "PACKAGE"), ("demo", "demo")):
        with pytest.raises(NotFoundError, match="does not exist") as raised:
            launch_file_of([f"{name}.launch.py"], None)
        assert raised.value.hint.endswith(f": {package} --launch {name}.launch.py")
    (tmp_path / "demo.launch.py").touch()
    with pytest.raises(RequestError, match=message):
        launch_file_of(names, launch_file)
