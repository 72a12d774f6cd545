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
    said = capsys.readouterr()
    output = said.err
    row = next(line for line in said.out.splitlines() if "(MuJoCo" in line)
    assert row.strip().startswith("masses and inertias in 10 random configurations")
    assert row.endswith("same")
    assert "arm.xml:4: The ball joint `turn` became three revolute joints" in output
    assert {one.name for one in (package / "meshes").iterdir()} == {"part.stl", "ellipsoid.stl"}
    assert (package / "urdf" / "arm.urdf").is_file()


def test_a_model_that_is_included_from_elsewhere(
    package: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    base, cart = tmp_path / "models" / "base", tmp_path / "models" / "cart"
    base.mkdir(parents=True)
    cart.mkdir()
    (base / "model.config").write_text("<model><sdf version='1.9'>model.sdf</sdf></model>")
    link = '<link name="base"><inertial><mass>2</mass></inertial></link>'
    (base / "model.sdf").write_text(f'<sdf version="1.9"><model name="base">{link}</model></sdf>')
    (cart / "model.config").write_text("<model><sdf version='1.9'>model.sdf</sdf></model>")
    (cart / "model.sdf").write_text(
        '<sdf version="1.9"><model name="cart"><include merge="true"><uri>model://base</uri>'
        "</include></model></sdf>"
    )
    assert new(cart) == 2
    said = capsys.readouterr().err
    assert f"which is {base / 'model.sdf'}" in said
    assert "--copy-outside" in said
    assert not package.exists()
    assert new(cart, "--copy-outside") == 0
    robot = ET.parse(package / "urdf" / "model.urdf").getroot()
    assert [link.get("name") for link in robot.iter("link")] == ["base"]


def test_the_strength_of_a_wheel(package: Path, tmp_path: Path) -> None:
    """A joint that turns endlessly has an effort and a velocity, in models within others, too."""
    file = tmp_path / "cart.sdf"
    inertial = "<inertial><mass>2</mass></inertial>"
    file.write_text(
        f'<sdf version="1.9"><model name="cart"><model name="inner"><link name="base">{inertial}'
        f'</link><link name="wheel">{inertial}</link><joint name="turn" type="revolute">'
        "<parent>base</parent><child>wheel</child><axis><xyz>0 1 0</xyz><limit>"
        "<lower>-inf</lower><upper>inf</upper><effort>7</effort><velocity>3</velocity></limit>"
        "</axis></joint></model></model></sdf>"
    )
    assert new(file) == 0
    (joint,) = ET.parse(package / "urdf" / "cart.urdf").getroot().iter("joint")
    assert joint.get("type") == "continuous"
    limit = joint.find("limit")
    assert limit is not None
    assert limit.attrib == {"effort": "7", "velocity": "3"}


def test_a_joint_that_its_limits_hold(package: Path, tmp_path: Path) -> None:
    """Models of drones have the link of an IMU on a joint that cannot move: no fix sets it free."""
    file = tmp_path / "drone.sdf"
    inertial = "<inertial><mass>0.1</mass></inertial>"
    file.write_text(
        f'<sdf version="1.9"><model name="drone"><link name="base">{inertial}</link>'
        f'<link name="imu">{inertial}</link><joint name="hold" type="revolute">'
        "<parent>base</parent><child>imu</child><axis><xyz>1 0 0</xyz><limit><lower>0</lower>"
        "<upper>0</upper><effort>0</effort><velocity>0</velocity></limit></axis></joint>"
        "</model></sdf>"
    )
    assert new(file, "--fix") == 0
    (joint,) = ET.parse(package / "urdf" / "drone.urdf").getroot().iter("joint")
    limit = joint.find("limit")
    assert limit is not None
    assert (limit.get("lower"), limit.get("upper")) == ("0", "0")


def test_a_template_of_a_model(
    package: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = tmp_path / "boat"
    model.mkdir()
    (model / "model.config").write_text("<model><sdf version='1.5'>boat.sdf</sdf></model>")
    (model / "boat.sdf.jinja").write_text("<sdf><model>{{ body }}</model></sdf>")
    assert new(model) == 4
    assert "boat.sdf.jinja is a template: give the file that its" in capsys.readouterr().err
    assert not package.exists()


def test_a_body_without_mass(
    package: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A fix gives it one; that the rest is what MuJoCo has is still shown."""
    pytest.importorskip("mujoco")
    file = tmp_path / "arm.xml"
    file.write_text(
        '<mujoco><worldbody><body name="frame"><site name="goal"/></body><body name="base">'
        '<geom size="0.1"/><body name="tip"><joint range="0 1" limited="true"/>'
        '<geom size="0.1" pos="0 0 1"/></body></body></worldbody></mujoco>'
    )
    assert new(file, "--fix") == 0
    rows = [line.strip() for line in capsys.readouterr().out.splitlines()]
    (row,) = [line for line in rows if line.startswith("masses and inertias")]
    assert row.endswith("same")
