"""`wsgen validate FILE`: robots and worlds that belong to no package."""

import importlib.util
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

pytestmark = pytest.mark.slow

needs_dart = pytest.mark.skipif(
    importlib.util.find_spec("dartpy") is None, reason="DART (dartpy) is missing"
)

LINK = """
  <link name="{name}">
    <inertial><mass value="{mass}"/>
      <inertia ixx="{inertia}" ixy="0" ixz="0" iyy="{inertia}" iyz="0" izz="{inertia}"/></inertial>
    <visual><geometry>{shape}</geometry></visual>
    <collision><geometry>{shape}</geometry></collision>
  </link>"""
XACRO = "http://www.ros.org/wiki/xacro"
BOX = '<box size="0.4 0.4 0.2"/>'


def link(name: str = "base", *, mass: str = "2", inertia: str = "0.1", shape: str = BOX) -> str:
    return LINK.format(name=name, mass=mass, inertia=inertia, shape=shape)


def urdf(*parts: str, name: str = "crate") -> str:
    return f'<?xml version="1.0"?>\n<robot name="{name}">{"".join(parts)}\n</robot>\n'


def run(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    done = subprocess.run(
        [sys.executable, "-m", "wsgen", "validate", *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "Traceback" not in done.stderr, done.stderr
    return done


def checked(folder: Path, *arguments: str) -> tuple[int, list[dict[str, Any]]]:
    done = run(folder, "--format", "json", *arguments)
    assert done.stdout, done.stderr
    return done.returncode, json.loads(done.stdout)["packages"]


def codes(package: dict[str, Any], severity: str = "error") -> list[str]:
    return [found["code"] for found in package["diagnostics"] if found["severity"] == severity]


def wheeled(caster_height: float) -> str:
    """A robot on two wheels with a radius of 0.1 m and a ball, which ends so high above them."""
    wheel = '<origin rpy="1.5708 0 0"/><geometry><cylinder radius="0.1" length="0.04"/></geometry>'
    ball = '<geometry><sphere radius="0.03"/></geometry>'
    inertia = (
        '<inertial><mass value="0.5"/><inertia ixx="0.002" ixy="0" ixz="0" iyy="0.002" '
        'iyz="0" izz="0.002"/></inertial>'
    )
    parts = [link("base", shape='<box size="0.5 0.3 0.05"/>', mass="5", inertia="0.1")]
    for name, place, shape, kind in (
        ("left", "0.15 0.2 0", wheel, "continuous"),
        ("right", "0.15 -0.2 0", wheel, "continuous"),
        ("caster", f"-0.2 0 {caster_height - 0.07}", ball, "fixed"),
    ):
        shapes = f"<visual>{shape}</visual><collision>{shape}</collision>"
        parts.append(
            f'<link name="{name}">{inertia}{shapes}</link>'
            f'<joint name="{name}_joint" type="{kind}"><parent link="base"/>'
            f'<child link="{name}"/><origin xyz="{place}"/><axis xyz="0 1 0"/></joint>'
        )
    caster = '<gazebo reference="caster_joint"><preserveFixedJoint>true</preserveFixedJoint>'
    return urdf(*parts, f"{caster}</gazebo>", name="cart")


def test_a_caster_that_hangs_too_high(tmp_path: Path) -> None:
    """The robot stands on it, and leans backward."""
    (tmp_path / "right.urdf").write_text(wheeled(0.001))
    (tmp_path / "wrong.urdf").write_text(wheeled(0.03))
    code, packages = checked(tmp_path, "right.urdf", "wrong.urdf")
    right, wrong = ([one for one in p["diagnostics"] if one["code"] == "SPN067"] for p in packages)
    assert (code, right) == (0, [])
    (found,) = wrong
    assert "leans by 4.9 degrees. It rests on `caster`, `left`, `right`." in found["message"]
    assert found["hint"].startswith(
        "If the robot is upright, `caster` is 30 mm above the lowest part"
    )


def test_a_robot_is_put_just_above_the_ground(tmp_path: Path) -> None:
    (tmp_path / "crate.urdf").write_text(urdf(link()))
    code, (package,) = checked(tmp_path, "crate.urdf")
    (robot,) = package["robots"]
    assert code == 0
    assert (package["package"], package["launch_file"], package["share"]) == (None, None, None)
    assert package["file"] == "crate.urdf"
    assert robot["entity"] == "crate"
    assert robot["spawn_pose"]["xyz"] == pytest.approx([0, 0, 0.105], abs=1e-6)
    assert robot["rest"]["xyz"] == pytest.approx([0, 0, 0.1], abs=0.001)
    assert robot["simulated"] == {
        "engine": "bullet",
        "links": 1,
        "movable_joints": 0,
        "mass": 2.0,
    }


def test_an_arm_on_the_world_swings_and_passes(tmp_path: Path) -> None:
    joint = """
  <joint name="swing" type="continuous"><parent link="world"/><child link="base"/>
    <origin xyz="0 0 2"/><axis xyz="0 1 0"/></joint>"""
    arm = link().replace('<mass value="2"/>', '<origin xyz="0.5 0 0"/><mass value="2"/>')
    (tmp_path / "arm.urdf").write_text(urdf('<link name="world"/>', arm, joint))
    code, (package,) = checked(tmp_path, "arm.urdf")
    assert code == 0
    assert codes(package, "info") == ["SPN060"]
    (robot,) = package["robots"]
    assert robot["spawn_pose"]["xyz"] == [0, 0, 0]
    assert abs(robot["rest"]["joint_positions"]["swing"]) > 0.1


def test_xacro_with_an_argument(tmp_path: Path) -> None:
    text = urdf('<xacro:arg name="kg" default="1"/>', link(mass="$(arg kg)"))
    text = text.replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"')
    (tmp_path / "crate.urdf.xacro").write_text(text)
    code, (package,) = checked(tmp_path, "crate.urdf.xacro", "--arg", "kg:=7")
    assert (code, package["robots"][0]["mass"]) == (0, 7.0)


def test_xacro_that_fails_names_file_and_line(tmp_path: Path) -> None:
    text = urdf("\n", link(mass="${unknown}"))
    text = text.replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"')
    (tmp_path / "crate.xacro").write_text(text)
    code, (package,) = checked(tmp_path, "crate.xacro")
    (found,) = package["diagnostics"]
    assert (code, found["code"], found["line"]) == (1, "ROB071", 5)
    assert Path(found["file"]).name == "crate.xacro"
    assert "unknown" in found["message"]


MODEL = """<?xml version="1.0"?>
<sdf version="1.7">{before}
  <model name="crate">{pose}<link name="base">
    <inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
    <collision name="c"><geometry><box><size>0.4 0.4 0.2</size></box></geometry></collision>
  </link></model>{after}
</sdf>
"""


def test_an_sdf_model_is_put_on_the_ground(tmp_path: Path) -> None:
    (tmp_path / "crate.sdf").write_text(MODEL.format(before="", pose="", after=""))
    code, (package,) = checked(tmp_path, "crate.sdf")
    assert code == 0
    assert package["robots"][0]["rest"]["xyz"] == pytest.approx([0, 0, 0.1], abs=0.001)


def test_the_models_of_a_world_stand_where_it_puts_them(tmp_path: Path) -> None:
    ground = "<include><uri>model://ground_plane</uri></include>"
    (tmp_path / "room.world").write_text(
        MODEL.format(
            before=f'<world name="room">{ground}',
            pose="<pose>1 2 0.1 0 0 0</pose>",
            after="</world>",
        )
    )
    code, (package,) = checked(tmp_path, "room.world")
    assert code == 0
    assert package["world"]["name"] == "room"
    assert package["robots"][0]["rest"]["xyz"] == pytest.approx([1, 2, 0.1], abs=0.001)


def test_packages_are_found_in_the_folders_around(tmp_path: Path) -> None:
    meshes = tmp_path / "somewhere" / "meshes"
    meshes.mkdir(parents=True)
    (tmp_path / "somewhere" / "package.xml").write_text("<package><name>crates</name></package>")
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = ("1 2 4 3", "5 7 8 6", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
    (meshes / "crate.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
        + "".join(f"f {face}\n" for face in faces)
    )
    shape = '<mesh filename="package://crates/meshes/crate.obj" scale="0.1 0.1 0.1"/>'
    (tmp_path / "somewhere" / "crate.urdf").write_text(urdf(link(shape=shape)))
    code, (package,) = checked(tmp_path, "somewhere/crate.urdf")
    assert code == 0, package["diagnostics"]
    assert package["robots"][0]["rest"]["xyz"][2] == pytest.approx(0.1, abs=0.002)


@pytest.mark.parametrize(
    ("name", "content", "code"),
    [
        ("bytes.urdf", b"abc\xff", "ROB001"),
        ("empty.urdf", b"", "ROB001"),
        ("cut.urdf", b"<robot name='r'><link name='a'>", "ROB001"),
        ("nothing.sdf", b"<sdf version='1.6'/>", "WLD003"),
        ("cut.world", b"<sdf version='1.6'><world", "ROB001"),
    ],
)
def test_files_that_are_none(tmp_path: Path, name: str, content: bytes, code: str) -> None:
    (tmp_path / name).write_bytes(content)
    exit_code, (package,) = checked(tmp_path, name)
    assert exit_code == 1
    assert code in codes(package)
    assert package["diagnostics"][0]["file"] == name
    assert package["robots"] == []


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    done = run(tmp_path, "nothing.urdf")
    assert (done.returncode, done.stdout) == (4, "")
    assert "nothing.urdf" in done.stderr


def test_a_refused_file_does_not_take_the_others(tmp_path: Path) -> None:
    (tmp_path / "crate.urdf").write_text(urdf(link()))
    (tmp_path / "notes.txt").write_text("Not a robot.")
    (tmp_path / "folder.urdf").mkdir()
    names = ["nothing.urdf", "folder.urdf", "notes.txt", "crate.urdf"]
    code, packages = checked(tmp_path, *names)
    assert (code, [package["file"] for package in packages]) == (1, names)
    assert [package["passed"] for package in packages] == [False, False, False, True]
    assert [codes(package) for package in packages[:3]] == [["PKG066"]] * 3
    words = [package["diagnostics"][0]["message"] for package in packages[:3]]
    assert words == [
        "nothing.urdf does not exist.",
        "folder.urdf is a folder.",
        "notes.txt is neither a URDF nor xacro nor SDF.",
    ]


@pytest.mark.parametrize("name", ["crate", "crate.xml"])
@pytest.mark.parametrize("kind", ["urdf", "xacro", "sdf"])
def test_the_root_element_says_what_a_file_is(tmp_path: Path, name: str, kind: str) -> None:
    text = f"<!-- a crate -->\n{urdf(link())}".replace('<?xml version="1.0"?>\n', "")
    if kind == "xacro":
        text = urdf('<xacro:property name="kg" value="2"/>', link(mass="${kg}"))
        text = text.replace("<robot", f'<robot xmlns:xacro="{XACRO}"')
    elif kind == "sdf":
        text = MODEL.format(before="", pose="", after="")
    (tmp_path / name).write_text(text)
    code, (package,) = checked(tmp_path, name)
    assert (code, package["robots"][0]["mass"]) == (0, 2.0), package["diagnostics"]


def test_a_world_that_xacro_writes(tmp_path: Path) -> None:
    world = f'<world name="room" xmlns:xacro="{XACRO}"><include><uri>model://ground_plane</uri>'
    world += "</include>"
    text = MODEL.format(before=world, pose="<pose>0 0 ${1 / 10} 0 0 0</pose>", after="</world>")
    (tmp_path / "room.world.xacro").write_text(text)
    code, (package,) = checked(tmp_path, "room.world.xacro")
    assert (code, package["world"]["name"]) == (0, "room"), package["diagnostics"]
    assert package["robots"][0]["spawn_pose"]["xyz"] == pytest.approx([0, 0, 0.1])


def test_many_files_at_once_are_reported_in_their_order(tmp_path: Path) -> None:
    names = []
    for number in range(6):
        (tmp_path / str(number)).mkdir()
        mass = "0" if number == 3 else str(number + 1)  # Gazebo refuses what has no mass
        (tmp_path / str(number) / "model.urdf").write_text(urdf(link(mass=mass)))
        names.append(f"{number}/model.urdf")
    code, packages = checked(tmp_path, "-j", "3", "--picture", "pictures", *names)
    assert code == 1
    assert [package["file"] for package in packages] == names
    assert [package["passed"] for package in packages] == [True, True, True, False, True, True]
    assert [package["robots"][0]["mass"] for package in packages if package["passed"]] == [
        1.0,
        2.0,
        3.0,
        5.0,
        6.0,
    ]
    assert sorted(file.name for file in (tmp_path / "pictures").iterdir()) == [
        f"{number}-model.png" for number in (0, 1, 2, 4, 5)
    ]


def test_a_mesh_that_would_kill_the_engine_is_refused_before(tmp_path: Path) -> None:
    """An OBJ whose faces name points that it does not have ends PyBullet with SIGSEGV."""
    (tmp_path / "bad.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 999999999\n")
    (tmp_path / "bad.urdf").write_text(urdf(link(shape='<mesh filename="bad.obj"/>')))
    (tmp_path / "good.urdf").write_text(urdf(link()))
    code, (bad, good) = checked(tmp_path, "-j", "2", "bad.urdf", "good.urdf")
    assert code == 1
    assert codes(bad) == ["ROB062"]
    assert good["passed"]


@pytest.mark.parametrize("kind", ["text", "ply"])
def test_meshes_that_pybullet_does_not_read_are_stood_on(tmp_path: Path, kind: str) -> None:
    """A tetrahedron on its side of 1 m, with the origin 0.2 m above, at half its size."""
    points = [(-0.3, -0.3, -0.2), (0.7, -0.3, -0.2), (-0.3, 0.7, -0.2), (0.0, 0.0, 0.8)]
    faces = [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)]
    if kind == "text":
        lines = ["solid s"]
        for face in faces:
            corners = [f"vertex {x} {y} {z}" for x, y, z in (points[i] for i in face)]
            lines += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
        name, text = "mesh.stl", "\n".join([*lines, "endsolid s", ""])
    else:
        head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        head += "property float z\nelement face 4\nproperty list uchar int vertex_indices\n"
        rows = [f"{x} {y} {z}" for x, y, z in points] + [f"3 {a} {b} {c}" for a, b, c in faces]
        name, text = "mesh.ply", head + "end_header\n" + "\n".join(rows) + "\n"
    (tmp_path / name).write_text(text)
    shape = f'<mesh filename="{name}" scale="0.5 0.5 0.5"/>'
    (tmp_path / "crate.urdf").write_text(urdf(link(shape=shape)))
    code, (package,) = checked(tmp_path, "crate.urdf", "--picture", "pictures")
    assert code == 0, package["diagnostics"]
    assert package["robots"][0]["rest"]["xyz"][2] == pytest.approx(0.1, abs=0.002)
    assert codes(package, "warning") == (["ROB068", "ROB068"] if kind == "ply" else [])


@needs_dart
@pytest.mark.parametrize("engine", ["dart", "all"])
def test_the_other_engines(tmp_path: Path, engine: str) -> None:
    (tmp_path / "crate.urdf").write_text(urdf(link()))
    code, (package,) = checked(
        tmp_path, "crate.urdf", "--engine", engine, "--picture", str(tmp_path)
    )
    (robot,) = package["robots"]
    assert code == 0
    assert robot["simulated"]["engine"] == ("dart" if engine == "dart" else "bullet")
    assert robot["rest"]["xyz"] == pytest.approx([0, 0, 0.1], abs=0.001)
    assert [one["passed"] for one in robot["engines"]] == [True] * len(robot["engines"])
    assert [one["rest"]["xyz"][2] for one in robot["engines"]] == pytest.approx(
        [0.1] * len(robot["engines"]), abs=0.001
    )
    names = [one["engine"] for one in robot["engines"]]
    if engine == "all":
        assert codes(package, "info") == (["SPN098"] if "mujoco" not in names else [])
        assert {"bullet", "dart"} <= set(names)
    with Image.open(tmp_path / "crate.png") as picture:
        assert picture.width > 0


@needs_dart
def test_engines_that_disagree_are_reported(tmp_path: Path) -> None:
    """A bowl that can move is filled up for PyBullet, which takes the convex hull of its mesh."""
    points = [(x, y, z) for z in (0.0, 0.2) for x in (-0.2, 0.2) for y in (-0.2, 0.2)]
    # An open box, and a ball in it: on its floor in DART, on its rim in PyBullet.
    faces = ("1 2 4 3", "1 5 6 2", "3 4 8 7", "1 3 7 5", "2 6 8 4")
    (tmp_path / "bowl.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in points) + "".join(f"f {f}\n" for f in faces)
    )
    world = f"""<sdf version="1.7"><world name="w">
      <include><uri>model://ground_plane</uri></include>
      <model name="bowl"><link name="l">
        <inertial><mass>50</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>
        <collision name="c"><geometry><mesh><uri>{tmp_path}/bowl.obj</uri></mesh></geometry>
        </collision></link></model>
      <model name="ball"><pose>0 0 0.3 0 0 0</pose><link name="l">
        <inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>
        </inertial><collision name="c"><geometry><sphere><radius>0.05</radius></sphere></geometry>
        </collision></link></model></world></sdf>"""
    (tmp_path / "bowl.sdf").write_text(world)
    _, (package,) = checked(tmp_path, "bowl.sdf", "--engine", "all", "-j", "3")
    found = [item for item in package["diagnostics"] if item["code"] == "SPN065"]
    assert [item["element"] for item in found] == ["ball"]
    assert "mm" in found[0]["message"]
    (gap,) = [item for item in package["diagnostics"] if item["code"] == "SPN066"]
    assert gap["element"] == "bowl"
    assert "touches `ball`" in gap["message"]


def test_many_warnings_of_one_kind_are_counted(tmp_path: Path) -> None:
    joints = [
        f'<joint name="j{n}" type="continuous"><parent link="l0"/><child link="l{n}"/>'
        f'<origin xyz="0 0 {n}"/></joint>'
        for n in range(1, 6)
    ]
    links = [link(f"l{n}", mass=f"{n + 1}", inertia="500") for n in range(6)]
    (tmp_path / "odd.urdf").write_text(urdf(*links, *joints))
    brief, full = run(tmp_path, "odd.urdf").stdout, run(tmp_path, "-v", "odd.urdf").stdout
    assert brief.count("] implausible-inertia:") == 3
    assert "and 3 more of implausible-inertia: -v shows all" in brief
    assert full.count("] implausible-inertia:") == 6
    assert "-v shows all" not in full


def test_a_xacro_file_in_another_folder(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    text = urdf(link()).replace("<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"')
    (tmp_path / "sub" / "crate.xacro").write_text(text)
    code, _ = checked(tmp_path, "sub/crate.xacro")
    assert code == 0


def test_a_world_without_models_passes_and_says_so(tmp_path: Path) -> None:
    ground = "<include><uri>model://ground_plane</uri></include>"
    (tmp_path / "empty.world").write_text(
        f'<sdf version="1.7"><world name="w">{ground}</world></sdf>'
    )
    code, (package,) = checked(tmp_path, "empty.world")
    assert (code, codes(package, "info")) == (0, ["WLD042"])


BODY = """<link name="l"><collision name="c"><geometry><box><size>{size}</size></box></geometry>
  </collision>{inertial}</link>"""
INERTIAL = """<inertial><mass>2</mass>
  <inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>"""


def test_walls_may_stand_in_a_floor_below_zero(tmp_path: Path) -> None:
    floor = BODY.format(size="4 4 0.2", inertial="")
    wall = BODY.format(size="0.1 4 1", inertial="")
    crate = BODY.format(size="0.4 0.4 0.2", inertial=INERTIAL)
    (tmp_path / "room.sdf").write_text(
        '<sdf version="1.7"><world name="w">'
        f'<model name="floor"><static>1</static><pose>0 0 -0.3 0 0 0</pose>{floor}</model>'
        f'<model name="wall"><static>1</static><pose>1 0 0.25 0 0 0</pose>{wall}</model>'
        f'<model name="crate"><pose>0 0 -0.05 0 0 0</pose>{crate}</model>'
        "</world></sdf>"
    )
    code, (package,) = checked(tmp_path, "room.sdf")
    assert (code, codes(package)) == (0, [])
    crates = [robot for robot in package["robots"] if robot["entity"] == "crate"]
    assert crates[0]["rest"]["xyz"][2] == pytest.approx(-0.1, abs=0.002)


def test_loose_parts_that_fall_for_ever_keep_it_from_rest(tmp_path: Path) -> None:
    floating = """<joint name="j" type="floating"><parent link="base"/><child link="ball"/>
      <origin xyz="1 0 1"/></joint>"""
    ball = link("ball").replace("<collision>", "<!--").replace("</collision>", "-->")
    (tmp_path / "loose.urdf").write_text(urdf(link(), ball, floating))
    code, (package,) = checked(tmp_path, "loose.urdf")
    assert (code, codes(package)) == (1, ["ROB055"])
    (loose,) = package["diagnostics"]
    assert "does not come to rest" in loose["message"]


def test_a_broken_visual_is_left_out_of_the_picture(tmp_path: Path) -> None:
    (tmp_path / "bad.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 999999999\n")
    shown = '<visual><geometry><mesh filename="bad.obj"/></geometry></visual>'
    text = urdf(link().replace("<collision>", f"{shown}<collision>"))
    (tmp_path / "crate.urdf").write_text(text)
    code, (package,) = checked(tmp_path, "crate.urdf", "--picture", "pictures")
    assert (code, codes(package, "warning")) == (0, ["ROB063"])
    assert Path(package["picture"]).is_file()


def test_options_that_would_do_nothing(tmp_path: Path) -> None:
    (tmp_path / "crate.urdf").write_text(urdf(link()))
    (tmp_path / "crate.stl").write_text("solid")
    for words in (("--launch", "l.py", "crate.urdf"), ("--arg", "a:=1", "crate.urdf")):
        assert run(tmp_path, *words).returncode == 2
    done = run(tmp_path, "crate.stl")
    assert (done.returncode, ".urdf" in done.stderr) == (2, True)


def test_a_summary_of_many(tmp_path: Path) -> None:
    (tmp_path / "good.urdf").write_text(urdf(link()))
    (tmp_path / "bad.urdf").write_text(urdf(link(mass="0")))
    lines = run(tmp_path, "-q", "good.urdf", "bad.urdf").stdout.splitlines()
    assert lines[-2] == "1 passed, 1 failed:"
    assert lines[-1].startswith("  bad.urdf: ")


def test_a_thing_of_a_world_may_roll(tmp_path: Path) -> None:
    ball = """<model name="ball"><pose>0 0 1 0 0 0</pose><link name="l">
      <inertial><mass>1</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>
      </inertial><collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry>
      </collision></link></model>"""
    slope = """<model name="slope"><static>true</static><link name="l"><collision name="c">
      <geometry><plane><normal>0.5 0 1</normal></plane></geometry></collision></link></model>"""
    world = f'<sdf version="1.7"><world name="w">{slope}{ball}</world></sdf>'
    (tmp_path / "slope.world").write_text(world)
    code, (package,) = checked(tmp_path, "slope.world")
    moves = [item for item in package["diagnostics"] if item["element"] == "ball"]
    assert code == 0
    assert ("SPN058", "warning") in [(item["code"], item["severity"]) for item in moves]
    (tmp_path / "ball.sdf").write_text(f'<sdf version="1.7">{ball}</sdf>')
    assert checked(tmp_path, "ball.sdf")[0] == 0  # on level ground it lies still


@pytest.mark.parametrize(
    ("name", "content", "named"),
    [
        ("44dir.urdf", "44dir.urdf/robot.xacro", "wsgen validate 44dir.urdf/robot.xacro"),
        ("44dir.urdf", "44dir.urdf/notes.txt", "Give a file in it"),
        ("src/rover/", "src/rover/package.xml", "wsgen validate rover"),
        ("./src", "src/rover/package.xml", "wsgen validate rover"),
    ],
)
def test_a_folder_is_no_file(tmp_path: Path, name: str, content: str, named: str) -> None:
    (tmp_path / content).parent.mkdir(parents=True)
    (tmp_path / content).write_text("<package><name>rover</name></package>")
    done = run(tmp_path, name)
    assert (done.returncode, done.stdout) == (2, "")
    assert "is a folder" in done.stderr
    assert named in done.stderr


def test_an_argument_that_no_xacro_file_has(tmp_path: Path) -> None:
    has_size = '<xacro:arg name="size" default="1"/>'
    for name, part in (("one", has_size), ("two", "")):
        text = urdf(part, link()).replace("<robot ", f'<robot xmlns:xacro="{XACRO}" ')
        (tmp_path / f"{name}.urdf.xacro").write_text(text)
    code, (package,) = checked(tmp_path, "one.urdf.xacro", "--arg", "sise:=1")
    assert (code, codes(package, "warning")) == (0, ["LCH035"])
    assert "`size`" in package["diagnostics"][0]["hint"]
    # Of several files one may be meant.
    _, packages = checked(tmp_path, "one.urdf.xacro", "two.urdf.xacro", "--arg", "size:=1")
    assert [codes(package, "warning") for package in packages] == [[], []]
    _, packages = checked(tmp_path, "one.urdf.xacro", "two.urdf.xacro", "--arg", "nope:=1")
    assert [codes(package, "warning") for package in packages] == [["LCH035"], ["LCH035"]]


def test_no_mass_is_printed_of_a_robot_that_is_not_simulated(tmp_path: Path) -> None:
    """What Gazebo refuses is left out of the sum."""
    (tmp_path / "r.urdf").write_text(urdf(link(mass="2 kg")))
    (row,) = [line for line in run(tmp_path, "r.urdf").stdout.splitlines() if "crate" in line]
    assert row.split()[:2] == ["crate", "-"]
