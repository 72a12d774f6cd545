"""Models of SDF and MuJoCo become packages in one command."""

from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from mesh_samples import binary_stl
from wsgen.cli import run

pytestmark = pytest.mark.slow

MODEL = """<sdf version="1.9"><model name="cart">
<link name="base"><inertial><mass>2</mass></inertial>
<visual name="v"><geometry><mesh><uri>{mesh}</uri></mesh></geometry></visual></link>
</model></sdf>
"""
MJCF = """<mujoco model="arm">
<asset><mesh file="part.stl"/></asset>
<worldbody><body name="base"><geom type="mesh" mesh="part"/>
<body name="tip"><joint name="turn" type="ball"/><geom type="ellipsoid" size="0.1 0.2 0.3"/></body>
</body></worldbody></mujoco>
"""


@pytest.fixture(autouse=True)
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the package is to be, from an empty current folder."""
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder / "ws_gazebo" / "src" / "my_robot"


def new(source: Path, *options: str) -> int:
    return run(["new", "my_robot", "--from", str(source), "--distro", "jazzy", *options])


def write_cart(folder: Path, mesh: str = "meshes/part.stl") -> Path:
    """The folder of a model with files for two versions of SDF."""
    model = folder / "cart"
    (model / "meshes").mkdir(parents=True)
    (model / "meshes" / "part.stl").write_bytes(binary_stl())
    (model / "model.config").write_text(
        "<model><sdf version='1.4'>old.sdf</sdf><sdf version='1.9'>model.sdf</sdf></model>"
    )
    (model / "old.sdf").write_text(MODEL.format(mesh="old.stl"))
    (model / "model.sdf").write_text(MODEL.format(mesh=mesh))
    return model


def test_the_folder_of_a_model(
    package: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new(write_cart(tmp_path)) == 0
    assert "up to 0 m or rad apart" in capsys.readouterr().out
    robot = ET.parse(package / "urdf" / "model.urdf").getroot()
    assert robot.get("name") == "cart"
    (mesh,) = robot.iter("mesh")
    assert mesh.get("filename") == "package://my_robot/meshes/part.stl"
    assert (package / "meshes" / "part.stl").read_bytes() == binary_stl()


def test_a_mesh_that_is_missing_or_elsewhere(
    package: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new(write_cart(tmp_path / "a", "nowhere.stl")) == 4
    assert "the mesh `nowhere.stl`" in capsys.readouterr().err
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "outside.stl").write_bytes(binary_stl())
    model = write_cart(tmp_path / "b", "../outside.stl")
    assert new(model) == 2
    assert "--copy-outside" in capsys.readouterr().err
    assert not package.exists()
    assert new(model, "--copy-outside") == 0
    assert (package / "meshes" / "outside.stl").is_file()


def test_an_mjcf(package: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mujoco")
    file = tmp_path / "arm.xml"
    file.write_text(MJCF)
    (tmp_path / "part.stl").write_bytes(binary_stl())
    assert new(file) == 0
    output = capsys.readouterr().err
    assert "arm.xml:4: The ball joint `turn` became three revolute joints" in output
    assert {one.name for one in (package / "meshes").iterdir()} == {"part.stl", "ellipsoid.stl"}
    assert (package / "urdf" / "arm.urdf").is_file()
