"""What simulators refuse of a robot is fixed by --fix, listed, and nothing else changes."""

# ruff: noqa: E501  elements as people write them

import json
import math
import re
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from existing_robots import cube_stl
from wsgen.cli import run
from wsgen.descriptions.meshes.stl import write_stl
from wsgen.descriptions.meshes.worker import measure, read_mesh, write_hull, write_mirrored
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.isolation import parent
from wsgen.model.inertia import about_link_axes, is_possible
from wsgen.model.robot import Collision, Mesh, Robot, Visual
from wsgen.porting.existing import made_meshes

pytestmark = pytest.mark.slow

INERTIAL = '<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
BOX = '<collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>'
LIMIT = '<limit lower="-1" upper="1" effort="5" velocity="3"/>'


def joint(
    child: str, *, limit: str = LIMIT, kind: str = "revolute", name: str = "turn", more: str = ""
) -> str:
    return f'<joint name="{name}" type="{kind}"><parent link="base"/><child link="{child}"/><axis xyz="0 0 1"/>{limit}{more}</joint>'


def robot_of(*parts: str, base: str = INERTIAL + BOX) -> str:
    return (
        f'<?xml version="1.0"?>\n<robot name="r">\n  <link name="base">{base}</link>\n  '
        + "\n  ".join(parts)
        + "\n</robot>\n"
    )


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def new(text: str, folder: Path, *options: str) -> int:
    (folder / "r.urdf").write_text(text)
    maintainer = ("--maintainer-name", "Ada", "--maintainer-email", "ada@example.com")
    return run(
        [
            "new",
            "my_robot",
            "--from",
            str(folder / "r.urdf"),
            "--distro",
            "jazzy",
            "--format",
            "json",
            *maintainer,
            *options,
        ]
    )


def fixed(
    text: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> tuple[Robot, dict[str, Any]]:
    """The robot after its fixes, and what is said of it."""
    assert new(text, folder, "--fix") == 0
    said: dict[str, Any] = json.loads(capsys.readouterr().out)["robot"]
    assert said["same"] is True
    assert [one["name"] for one in said["diagnostics"] if one["severity"] == "error"] == []
    written = folder / "here" / "ws_gazebo" / "src" / "my_robot" / "urdf" / "r.urdf"
    robot, _ = read_urdf(written.read_text(), file=None)
    assert robot is not None
    return robot, said


def differing(said: dict[str, Any]) -> dict[str, list[str]]:
    assert all(row["fixed"] for row in said["comparison"] if not row["same"])
    return {row["aspect"]: row["differing"] for row in said["comparison"] if not row["same"]}


def test_what_can_be_fixed_is_offered(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = robot_of(f'<link name="arm">{BOX}</link>', joint("arm"))
    assert new(text, tmp_path) == 1
    said = json.loads(capsys.readouterr().out)["robot"]
    assert said["fixable"] == ["dropped-link"]
    assert (said["fixes"], said["same"]) == ([], True)


def test_a_missing_inertia_of_a_box(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot, said = fixed(robot_of(f'<link name="arm">{BOX}</link>', joint("arm")), tmp_path, capsys)
    inertial = robot.link("arm").inertial
    assert inertial is not None
    assert inertial.mass == pytest.approx(6.0)
    assert inertial.inertia == pytest.approx((6 * 0.13 / 12, 0, 0, 6 * 0.10 / 12, 0, 6 * 0.05 / 12))
    assert said["fixes"] == [
        "Gave the link `arm` a mass of 6 kg and an inertia from its shapes and a density of 1000 kg/m³."
    ]
    assert differing(said) == {"masses": ["arm"], "centers of mass": ["arm"], "inertias": ["arm"]}


def test_a_missing_inertia_of_a_mesh_that_is_turned(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "cube.stl").write_bytes(cube_stl())
    shape = '<collision><origin xyz="1 0 0" rpy="0 0 1.5707963267948966"/><geometry><mesh filename="cube.stl" scale="1 2 3"/></geometry></collision>'
    robot, _ = fixed(robot_of(f'<link name="arm">{shape}</link>', joint("arm")), tmp_path, capsys)
    inertial = robot.link("arm").inertial
    assert inertial is not None
    assert inertial.mass == pytest.approx(6.0, rel=1e-5)
    assert inertial.pose_in_link.xyz == pytest.approx((1 - 0.1, 0.05, 0.15), rel=1e-5)
    # 0.1 along x of the mesh, which is y of the link.
    wanted = (6 * (0.01 + 0.09) / 12, 0, 0, 6 * (0.04 + 0.09) / 12, 0, 6 * 0.05 / 12)
    assert inertial.inertia == pytest.approx(wanted, rel=1e-4, abs=1e-9)


def test_a_link_without_anything(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    robot, said = fixed(robot_of('<link name="hub"/>', joint("hub")), tmp_path, capsys)
    inertial = robot.link("hub").inertial
    assert inertial is not None
    assert inertial.mass == 0.01
    assert "as it has no shape" in said["fixes"][0]


def test_an_impossible_inertia(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = robot_of().replace('izz="0.01"', 'izz="0.05"')
    robot, said = fixed(text, tmp_path, capsys)
    assert differing(said) == {"inertias": ["base"]}
    inertial = robot.link("base").inertial
    assert inertial is not None
    assert inertial.inertia[0] + inertial.inertia[3] >= inertial.inertia[5]
    assert inertial.mass == 1.0


def test_two_roots(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = robot_of(
        f'<link name="arm">{INERTIAL}</link>', joint("arm"), f'<link name="lost">{INERTIAL}</link>'
    )
    assert new(text, tmp_path) == 4
    assert "Or add --fix." in capsys.readouterr().err
    robot, said = fixed(text, tmp_path, capsys)
    assert robot.root == "base"
    assert [one.name for one in robot.joints] == ["turn", "base_to_lost"]
    assert "Attached the second root `lost`" in said["fixes"][0]
    assert "cannot be read without its fixes" in " ".join(said["notes"])


def test_names(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = robot_of(
        f'<link name="arm: upper">{INERTIAL}</link>',
        joint("arm: upper", name="arm: upper"),
        f'<link name="arm__upper">{INERTIAL}</link>',
        joint("arm__upper", name="follow", more='<mimic joint="arm: upper"/>'),
        '<gazebo reference="arm: upper"><mu1>0.5</mu1></gazebo>',
        '<gazebo><plugin filename="libx.so" name="x"><body>arm: upper</body></plugin></gazebo>',
    )
    robot, said = fixed(text, tmp_path, capsys)
    assert [one.name for one in robot.links] == ["base", "arm_upper", "arm__upper"]
    assert [one.name for one in robot.joints] == ["arm_upper_joint", "follow"]
    assert robot.joints[1].mimic is not None
    assert robot.joints[1].mimic.joint == "arm_upper_joint"
    assert robot.gazebo[0].reference == "arm_upper"
    assert differing(said) == {}  # it is the same robot with other names
    assert len(said["fixes"]) == 2


def test_meshes_in_millimeters(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "cube.stl").write_bytes(cube_stl(150.0))
    shape = '<visual><geometry><mesh filename="cube.stl"/></geometry></visual>'
    robot, said = fixed(robot_of(base=INERTIAL + BOX + shape), tmp_path, capsys)
    geometry = robot.link("base").visuals[0].geometry
    assert isinstance(geometry, Mesh)
    assert geometry.scale == (0.001, 0.001, 0.001)
    assert differing(said) == {"visuals": ["base"]}


def test_mirrored_meshes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "cube.stl").write_bytes(cube_stl())
    shape = '<collision><geometry><mesh filename="cube.stl" scale="1 -2 1"/></geometry></collision>'
    robot, said = fixed(robot_of(base=INERTIAL + shape), tmp_path, capsys)
    geometry = robot.link("base").collisions[0].geometry
    assert isinstance(geometry, Mesh)
    assert (geometry.uri, geometry.scale) == (
        "package://my_robot/meshes/cube_mirrored_y.stl",
        (1, 2, 1),
    )
    file = tmp_path / "here" / "ws_gazebo" / "src" / "my_robot" / "meshes" / "cube_mirrored_y.stl"
    corners = read_mesh(file).corners
    assert (corners.min(axis=(0, 1)), corners.max(axis=(0, 1))) == (
        pytest.approx((0, -0.1, 0)),
        pytest.approx((0.1, 0, 0.1)),
    )
    (solid,) = measure([(str(file), (1.0, 2.0, 1.0))])
    assert solid is not None
    assert solid.volume == pytest.approx(0.002, rel=1e-5)
    assert differing(said) == {"collisions": ["base"]}


def heavy(folder: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    monkeypatch.setattr("wsgen.porting.existing.fixes.HEAVY", 10)
    (folder / "cube.stl").write_bytes(cube_stl())
    shape = '<{0} name="c"><geometry><mesh filename="cube.stl" scale="2 2 2"/></geometry></{0}>'
    return robot_of(base=INERTIAL + shape.format("visual") + shape.format("collision"))


def names_of(shapes: Iterable[Visual | Collision]) -> list[str]:
    meshes = [one.geometry for one in shapes]
    return [one.uri.rpartition("/")[2] for one in meshes if isinstance(one, Mesh)]


def test_heavy_collision_meshes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("scipy")
    monkeypatch.setitem(sys.modules, "coacd", None)
    monkeypatch.setattr(made_meshes, "run", parent.run_here)
    robot, said = fixed(heavy(tmp_path, monkeypatch), tmp_path, capsys)
    base = robot.link("base")
    assert names_of(base.visuals) == ["cube.stl"]
    assert names_of(base.collisions) == ["cube_hull.stl"]
    assert differing(said) == {"collisions": ["base"]}
    assert said["fixes"] == [
        "Took the convex hull of `cube.stl` (12 triangles) for the collision of `base` (pip install 'wsgen[decompose]' finds its parts)."
    ]


def test_the_convex_parts_of_a_collision_mesh(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A corner of three bars: its hull is several times as large, its parts are not."""
    pytest.importorskip("coacd")
    text = heavy(tmp_path, monkeypatch)
    assert new(text, tmp_path, "--dry-run") == 0
    notes = json.loads(capsys.readouterr().out)["robot"]["notes"]
    assert (
        "The collision mesh `cube.stl` has 12 triangles: --fix takes convex parts of it." in notes
    )
    bars = [
        np.frombuffer(
            cube_stl(0.1)[84:], np.dtype([("n", "<f4", 3), ("c", "<f4", (3, 3)), ("a", "<u2")])
        )["c"]
        * scale
        for scale in ((10, 1, 1), (1, 10, 1), (1, 1, 10))
    ]
    write_stl(np.concatenate(bars).astype(float), tmp_path / "cube.stl")
    robot, said = fixed(text, tmp_path, capsys)
    shapes = robot.link("base").collisions
    assert 2 <= len(shapes) <= 16
    assert names_of(shapes) == [f"cube_part_{at}.stl" for at, _ in enumerate(shapes, 1)]
    assert {one.geometry.scale for one in shapes if isinstance(one.geometry, Mesh)} == {(2, 2, 2)}
    written = (tmp_path / "here" / "ws_gazebo" / "src" / "my_robot" / "urdf" / "r.urdf").read_text()
    assert re.findall('<collision name="([^"]*)"', written)[:2] == ["c", "c_2"]
    meshes = tmp_path / "here" / "ws_gazebo" / "src" / "my_robot" / "meshes"
    solids = measure([(str(meshes / name), (1.0, 1.0, 1.0)) for name in names_of(shapes)])
    volumes = [one.volume for one in solids if one is not None and one.is_closed]
    assert len(volumes) == len(shapes)
    assert sum(volumes) < 0.06  # 0.028 m³ and what the approximation adds; the hull has 0.19
    assert f"Took {len(shapes)} convex parts of" in said["fixes"][0]


def test_a_heavy_mesh_without_what_would_change_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(made_meshes.MadeMeshes, "parts", lambda *_: ())
    _, said = fixed(heavy(tmp_path, monkeypatch), tmp_path, capsys)
    assert said["fixes"] == []
    assert "pip install 'wsgen[decompose]' makes convex bodies of it" in " ".join(said["notes"])


def about(where: str) -> str:
    """A bar of 2 kg, whose inertia is about another point."""
    m, center = 2.0, np.array([0.5, 0.1, 0.05])
    own = np.diag(m / 12 * np.array([0.2**2 + 0.1**2, 1 + 0.1**2, 1 + 0.2**2]))
    root = np.array([0.0, 0.0, -0.7]) if where == "root" else np.zeros(3)
    d = center - root
    if where != "center":
        own = own + m * (d @ d * np.eye(3) - np.outer(d, d))
    six = (
        f'{n}="{own[i][j]:.12g}"'
        for n, i, j in (
            ("ixx", 0, 0),
            ("ixy", 0, 1),
            ("ixz", 0, 2),
            ("iyy", 1, 1),
            ("iyz", 1, 2),
            ("izz", 2, 2),
        )
    )
    inertial = f'<inertial><origin xyz="0.5 0.1 0.05"/><mass value="2"/><inertia {" ".join(six)}/></inertial>'
    shape = '<visual><geometry><mesh filename="cube.stl" scale="10 2 1"/></geometry></visual>'
    place = '<origin xyz="0 0 0.7"/>'
    return robot_of(f'<link name="arm">{inertial}{shape}{BOX}</link>', joint("arm", more=place))


@pytest.mark.parametrize(
    ("where", "words"),
    [
        ("center", None),
        ("link", "about the origin of the link"),
        ("root", "about the origin of the root link"),
    ],
)
def test_an_inertia_about_another_point(
    where: str, words: str | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "cube.stl").write_bytes(cube_stl())
    text = about(where)
    assert new(text, tmp_path, "--dry-run") == 0
    notes = " ".join(json.loads(capsys.readouterr().out)["robot"]["notes"])
    offer = f"By its meshes, the inertia of `arm` is that {words}: --fix moves it"
    assert (offer in notes) == (words is not None)
    robot, said = fixed(text, tmp_path, capsys)
    inertial = robot.link("arm").inertial
    assert inertial is not None
    wanted = (2 / 12 * 0.05, 0, 0, 2 / 12 * 1.01, 0, 2 / 12 * 1.04)
    assert about_link_axes(inertial) == pytest.approx(wanted, abs=1e-6)
    assert inertial.pose_in_link.xyz == (0.5, 0.1, 0.05)
    if words is None:
        assert said["fixes"] == []
    else:
        assert said["fixes"] == [
            f"Moved the inertia of `arm` to its center of mass: by its meshes, it was that {words}."
        ]
        assert differing(said) == {"inertias": ["arm"]}


@pytest.mark.parametrize("change", ["no mesh", "open", "another center"])
def test_an_inertia_of_which_meshes_tell_nothing(
    change: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, mesh = about("link"), cube_stl()
    if change == "no mesh":
        text = re.sub("<visual>.*</visual>", "", text)
    elif change == "open":
        mesh = mesh[:80] + (11).to_bytes(4, "little") + mesh[84:-50]
    else:
        text = text.replace('scale="10 2 1"', 'scale="8 2 1"')
    (tmp_path / "cube.stl").write_bytes(mesh)
    _, said = fixed(text, tmp_path, capsys)
    assert said["fixes"] == []


def test_a_mass_that_gazebo_drops(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """As the links of sensors in models of drones."""
    light = '<inertial><mass value="1e-8"/><inertia ixx="1e-11" iyy="1e-11" izz="1e-11" ixy="0" ixz="0" iyz="0"/></inertial>'
    robot, said = fixed(
        robot_of(f'<link name="imu">{light}</link>', joint("imu")), tmp_path, capsys
    )
    inertial = robot.link("imu").inertial
    assert inertial is not None
    assert inertial.mass == 1e-5
    assert is_possible(inertial.inertia)
    assert said["fixes"] == [
        "Raised the mass of `imu` from 1e-08 to 1e-05 kg, as Gazebo drops what is lighter than a milligram."
    ]


def test_too_many_numbers(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "cube.stl").write_bytes(cube_stl())
    shape = (
        '<collision><geometry><mesh filename="cube.stl" scale="2 2 2 1"/></geometry></collision>'
    )
    robot, said = fixed(robot_of(base=INERTIAL + shape), tmp_path, capsys)
    (collision,) = robot.link("base").collisions
    assert isinstance(collision.geometry, Mesh)
    assert collision.geometry.scale == (2, 2, 2)
    assert said["fixes"] == ['Took scale="2 2 2" for scale="2 2 2 1" in `base`.']


def test_a_mesh_is_found_from_folders_above(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As PyBullet finds it, from the folder that has several robots."""
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "cube.stl").write_bytes(cube_stl())
    (tmp_path / "car").mkdir()
    shape = '<visual><geometry><mesh filename="parts/cube.stl"/></geometry></visual>'
    text = robot_of(base=INERTIAL + BOX + shape)
    assert new(text, tmp_path / "car") == 2
    assert "--copy-outside" in capsys.readouterr().err
    assert new(text, tmp_path / "car", "--copy-outside") == 0
    package = tmp_path / "here" / "ws_gazebo" / "src" / "my_robot"
    assert (package / "meshes" / "cube.stl").is_file()


def test_a_mass_in_grams(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    inertial = '<inertial><mass value="60"/><inertia ixx="0.00065" iyy="0.0005" izz="0.00025" ixy="0" ixz="0" iyz="0"/></inertial>'
    robot, said = fixed(robot_of(base=inertial + BOX), tmp_path, capsys)
    assert robot.mass == 0.06
    assert "in grams" in said["fixes"][0]


def test_the_rounds_have_an_end(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Behind each link that is dropped may be another one; what is left then is still reported."""
    chain = [
        f'<link name="l{at}"/><joint name="j{at}" type="revolute"><parent link="{f"l{at - 1}" if at else "base"}"/><child link="l{at}"/><axis xyz="0 0 1"/>{LIMIT}</joint>'
        for at in range(5)
    ]
    monkeypatch.setattr("wsgen.porting.existing.fixes.MOST_ROUNDS", 2)
    assert new(robot_of(*chain), tmp_path, "--fix", "--dry-run") == 1
    said = json.loads(capsys.readouterr().out)["robot"]
    assert [one["name"] for one in said["diagnostics"] if one["severity"] == "error"] == [
        "dropped-link"
    ]
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path / "here")
    robot, said = fixed(robot_of(*chain), tmp_path, capsys)
    assert sum(one.inertial is not None for one in robot.links) == 6
    assert len(said["fixes"]) == 5


@pytest.mark.parametrize(
    ("limit", "wanted"),
    [
        ('<limit lower="0" upper="0" effort="5" velocity="3"/>', (-3.14159, 3.14159, 5, 3)),
        ('<limit lower="-1" upper="1" effort="0" velocity="0"/>', (-1, 1, 1000, 100)),
        ("", (-3.14159, 3.14159, 1000, 100)),
    ],
)
def test_limits_of_zero(
    limit: str, wanted: tuple[float, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    robot, said = fixed(
        robot_of(f'<link name="arm">{INERTIAL}</link>', joint("arm", limit=limit)), tmp_path, capsys
    )
    found = robot.joints[0].limit
    assert found is not None
    assert (found.lower, found.upper, found.effort, found.velocity) == pytest.approx(wanted)
    assert "Gave the joint `turn` a limit" in said["fixes"][0]


def test_a_mesh_that_is_missing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    shape = '<visual><geometry><mesh filename="lost.stl"/></geometry></visual>'
    robot, said = fixed(robot_of(base=INERTIAL + BOX + shape), tmp_path, capsys)
    assert robot.link("base").visuals == ()
    assert "its mesh `lost.stl` is missing" in said["fixes"][0]
    assert differing(said) == {"visuals": ["base"]}


@pytest.mark.parametrize(
    ("uri", "place"),
    [
        ("package://renamed/urdf/PART.stl", "meshes/part.STL"),
        ("/home/ada/ws/src/r/visual/wheel.stl", "visual/wheel.stl"),
        ("package:///wheel.stl", None),  # two that differ
    ],
)
def test_a_mesh_that_is_elsewhere(
    uri: str, place: str | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A file of the source that is called as the mesh takes its place; with equal folders first."""
    for number, name in enumerate(("meshes/part.STL", "visual/wheel.stl", "meshes/wheel.stl")):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_bytes(cube_stl(0.1 + 0.1 * number))
    mesh = f'<visual><geometry><mesh filename="{uri}"/></geometry></visual>'
    text = robot_of(base=INERTIAL + BOX + mesh)
    if place is None:
        assert new(text, tmp_path, "--fix") == 0
        said = json.loads(capsys.readouterr().out)["robot"]
        assert said["fixes"] == [f"Left out the visual of `base`: its mesh `{uri}` is missing."]
        return
    assert new(text, tmp_path) != 0
    assert f"Or add --fix, which takes {tmp_path / place}." in capsys.readouterr().err
    robot, said = fixed(text, tmp_path, capsys)
    (fix,) = said["fixes"]
    assert fix.endswith(f"for `{uri}`, which does not exist.")
    assert differing(said) == {}
    geometry = robot.link("base").visuals[0].geometry
    assert isinstance(geometry, Mesh)
    copy = tmp_path / "here" / "ws_gazebo" / "src" / geometry.uri.removeprefix("package://")
    assert copy.read_bytes() == (tmp_path / place).read_bytes()


def test_names_that_end_with_blanks(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = robot_of(f'<link name="arm ">{INERTIAL}{BOX}</link>', joint("arm "))
    _, said = fixed(text, tmp_path, capsys)
    assert said["fixes"] == ["Renamed the link `arm ` to `arm`."]


def test_limits_are_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What a check fixes says of which joint it is."""
    swapped = '<limit lower="2" upper="1" effort="5" velocity="3"/>'
    text = robot_of(f'<link name="arm">{INERTIAL}{BOX}</link>', joint("arm", limit=swapped))
    _, said = fixed(text, tmp_path, capsys)
    assert said["fixes"][0].startswith("`turn`: The lower limit 2 is above the upper limit 1.")


def test_fixes_of_checks_are_made(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    more = '<origin xyz="0.1, 0, 0"/>'
    robot, said = fixed(
        robot_of(f'<link name="arm">{INERTIAL}</link>', joint("arm", more=more)), tmp_path, capsys
    )
    assert robot.joints[0].pose_in_parent.xyz == (0.1, 0, 0)
    assert differing(said)["origins of joints"] == ["turn"]


def test_a_robot_that_needs_none_stays(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = robot_of(f'<link name="arm">{INERTIAL}{BOX}</link>', joint("arm"))
    _, said = fixed(text, tmp_path, capsys)
    assert said["fixes"] == []
    written = tmp_path / "here" / "ws_gazebo" / "src" / "my_robot" / "urdf" / "r.urdf"
    assert written.read_text() == text


def test_solids(tmp_path: Path) -> None:
    """A cube, one whose faces look inwards, and one with a hole."""
    file = tmp_path / "cube.stl"
    file.write_bytes(cube_stl(0.2))
    (solid,) = measure([(str(file), (1.0, 1.0, 1.0))])
    assert solid is not None
    assert solid.volume == pytest.approx(0.008, rel=1e-5)
    assert solid.center == pytest.approx((0.1, 0.1, 0.1), rel=1e-5)
    assert solid.inertia == pytest.approx(
        (0.008 * 0.08 / 12, 0, 0, 0.008 * 0.08 / 12, 0, 0.008 * 0.08 / 12), rel=1e-4, abs=1e-9
    )
    write_mirrored([(str(file), (-1.0, 1.0, 1.0), str(tmp_path / "mirrored.stl"))])
    (turned,) = measure([(str(tmp_path / "mirrored.stl"), (-1.0, 1.0, 1.0))])
    assert turned is not None
    assert turned.volume == pytest.approx(0.008, rel=1e-5)
    data = bytearray(cube_stl(0.2)[:-50])
    data[80:84] = (11).to_bytes(4, "little")
    (tmp_path / "open.stl").write_bytes(data)
    (hull,) = measure([(str(tmp_path / "open.stl"), (1.0, 1.0, 1.0))])
    assert hull is not None
    assert math.isclose(hull.volume, 0.008, rel_tol=1e-5)
    pytest.importorskip("scipy")
    assert write_hull(str(tmp_path / "open.stl"), str(tmp_path / "hull.stl"))
    assert np.ptp(read_mesh(tmp_path / "hull.stl").corners) == pytest.approx(0.2)


def test_the_readme_lists_the_fixes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    fixed(robot_of(f'<link name="arm">{BOX}</link>', joint("arm")), tmp_path, capsys)
    text = (tmp_path / "here" / "ws_gazebo" / "src" / "my_robot" / "README.md").read_text()
    assert "a mass of 6 kg and an inertia from its shapes" in text
    assert re.search(r"\| masses \| 1 kg \| 7 kg \| fixed \|", text)
