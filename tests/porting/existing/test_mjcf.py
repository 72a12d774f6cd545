"""MJCF as URDF: compared with MuJoCo's own masses, inertias, kinematics and shapes."""

from __future__ import annotations

import re
import struct
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

pytest.importorskip("mujoco")

from porting.existing.mjcf_oracle import compare
from wsgen.descriptions.meshes.worker import measure
from wsgen.errors import NotFoundError, NotReadableError, RequestError, WsgenError
from wsgen.isolation import parent
from wsgen.isolation.result import Limits
from wsgen.porting.existing import mjcf
from wsgen.porting.existing.mjcf import read_mjcf

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.porting.existing.description import Description

NEAR = 1e-6  # m, or a share


@pytest.fixture(autouse=True)
def _here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Read in this process, which takes a tenth of the time of a child."""
    monkeypatch.setattr(parent, "run", parent.run_here)


def write(folder: Path, body: str, before: str = "", behind: str = "") -> Path:
    file = folder / "robot.xml"
    file.write_text(
        f"""<mujoco model="robot">
{before}
<worldbody>
{body}
</worldbody>
{behind}
</mujoco>
""",
        encoding="utf-8",
    )
    return file


def same(file: Path) -> Description:
    """The description of an MJCF, which is what MuJoCo has."""
    description = read_mjcf(file)
    found = compare(description)
    assert not found.wrong
    assert found.mass <= NEAR
    assert found.position <= NEAR
    assert found.turn <= NEAR
    assert found.shape <= 10 * NEAR  # MuJoCo's meshes are of single precision
    return description


def said(description: Description, words: str) -> int:
    """The line of the one note with these words."""
    (note,) = [one for one in description.notes if words in one.what]
    assert note.advice.endswith(".")
    return note.line


WEDGE = "v 0 0 0\nv 1 0 0\nv 0 2 0\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"


def wedge(at: float = 0.0) -> bytes:
    """The same as a binary STL, moved along x."""
    points = [(at, 0, 0), (1 + at, 0, 0), (at, 2, 0), (at, 0, 3)]
    data = b"".join(
        struct.pack("<12fH", 0, 0, 0, *points[a], *points[b], *points[c], 0)
        for a, b, c in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
    )
    return bytes(80) + struct.pack("<I", 4) + data


def test_a_body_is_a_link_and_what_is_fixed_hangs_on_the_world(tmp_path: Path) -> None:
    file = write(
        tmp_path,
        """<geom name="floor" type="plane" size="1 1 1"/>
<body name="base" pos="1 2 3" euler="10 20 30">
  <geom type="box" size="0.1 0.2 0.3" mass="2"/>
  <body name="arm" pos="0 0 0.5">
    <joint name="lift" axis="0 1 1" range="-30 40" damping="0.5" frictionloss="0.1"/>
    <geom type="cylinder" fromto="0 0 0 0.1 0.2 0.4" size="0.05"/>
  </body>
</body>""",
    )
    description = same(file)
    assert description.name == "robot"
    robot = ET.fromstring(description.text)
    assert [link.get("name") for link in robot.findall("link")] == ["world", "base", "arm"]
    joint = robot.find("joint[@name='lift']")
    assert joint is not None
    assert [dict(one.attrib) for one in joint.findall("dynamics")] == [
        {"damping": "0.5", "friction": "0.1"}
    ]
    assert said(description, "geoms of the world") == 4


def test_a_free_body_is_the_root(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            """<body name="ball" pos="1 0 0"><freejoint/><geom size="0.1"/></body>
<body name="robot" pos="0 0 1">
  <freejoint name="root"/>
  <geom type="capsule" size="0.1 0.3" euler="0 90 0"/>
  <body name="leg" pos="0 0 -0.1"><joint name="hip"/><geom type="box" size=".1 .1 .1"/></body>
</body>""",
        )
    )
    assert 'link name="world"' not in description.text
    assert '"ball"' not in description.text
    assert said(description, "moves freely beside the robot") == 4


def test_several_joints_of_a_body_are_one_after_the_other(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            """<body name="trunk" pos="0 0 1">
  <joint name="x" type="slide" axis="1 0 0" ref="0.3"/>
  <joint name="z" type="slide" axis="0 0 1" ref="1.25" range="0 2"/>
  <joint name="turn" axis="0 1 0" pos="0.1 0.2 0.3" ref="20" range="-90 90"/>
  <geom type="box" size="0.1 0.2 0.3" mass="3"/>
  <body name="head" pos="0 0 0.4" quat="1 1 0 0">
    <joint name="yaw" axis="0 0 1" pos="0 0 -0.1"/>
    <joint name="pitch" axis="1 1 0" pos="0.05 0 0"/>
    <geom size="0.1"/>
  </body>
</body>""",
        )
    )
    assert said(description, "start") == 5  # `x`, `z` and `turn`
    assert said(description, "several joints") == 4
    links = re.findall(r'<link name="(\w+)"', description.text)
    assert links == ["world", "x_link", "z_link", "trunk", "yaw_link", "head"]


@pytest.mark.parametrize("pitch", ["90", "-90", "89.99999", "89.9999"])
def test_turns_of_ninety_degrees_are_exact(tmp_path: Path, pitch: str) -> None:
    same(
        write(
            tmp_path,
            f"""<body name="a"><geom size="0.1"/>
<body name="b" pos="1 2 3" euler="37 {pitch} 53"><joint/><geom pos="10 10 10" size="0.1"/></body>
</body>""",
            '<compiler eulerseq="XYZ"/>',
        )
    )


def test_a_ball_joint_becomes_three(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            """<body name="a"><freejoint/><geom size="0.1"/>
  <body name="b" pos="0 0 1">
    <joint name="shoulder" type="ball" pos="0.1 0 0" damping="2" range="0 60"/>
    <geom pos="0.2 0 0" type="ellipsoid" size="0.1 0.2 0.3"/>
  </body></body>""",
        )
    )
    assert said(description, "ball joint `shoulder`") == 6
    limits = re.findall(r'lower="(\S+)" upper="(\S+)"', description.text)
    assert limits == [("-1.0471975511965976", "1.0471975511965976")] * 3
    assert list(description.meshes) == ["ellipsoid.stl"]


MESHES = {
    "plain": 'file="wedge.obj"',
    "scaled": 'file="wedge.obj" scale="0.1 0.2 0.3"',
    "mirrored": 'file="wedge.obj" scale="0.1 -0.1 0.1"',
    "moved": 'file="wedge.stl" scale="0.1 0.1 0.1" refpos="0.1 0.2 0.3" refquat="1 0.2 0.3 0.4"',
    "moved and scaled": 'file="wedge.stl" scale="0.1 0.2 0.1" refquat="1 0.2 0.3 0.4"',
    "written": 'name="wedge" vertex="0 0 0 1 0 0 0 2 0 0 0 3"',
}


@pytest.mark.parametrize("mesh", MESHES)
def test_a_mesh_is_where_it_was(tmp_path: Path, mesh: str) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "wedge.obj").write_text(WEDGE)
    (tmp_path / "meshes" / "wedge.stl").write_bytes(wedge())
    description = same(
        write(
            tmp_path,
            """<body name="a"><joint pos="1 1 1"/>
<geom type="mesh" mesh="wedge" pos="0.1 0.2 0.3" euler="10 20 30"/>
<geom type="box" mesh="wedge"/>
</body>""",
            f'<compiler meshdir="meshes"/><asset><mesh {MESHES[mesh]}/></asset>',
        )
    )
    (found,) = description.meshes.values()
    assert isinstance(found, bytes) == (mesh in {"written", "moved and scaled"})


def test_collisions_are_the_hulls_of_meshes(tmp_path: Path) -> None:
    """As in MuJoCo; what is seen has the dent, and what is convex has its file."""
    dented = WEDGE.replace("f 2 3 4", "v 0.2 0.4 0.6\nf 2 3 5\nf 3 4 5\nf 4 2 5")
    (tmp_path / "dented.obj").write_text(dented)
    (tmp_path / "wedge.obj").write_text(WEDGE)
    description = same(
        write(
            tmp_path,
            """<body name="a"><freejoint/>
<geom type="mesh" mesh="dented" pos="1 2 3" euler="10 20 30"/>
<geom type="mesh" mesh="wedge"/></body>""",
            '<asset><mesh file="dented.obj" scale="1 2 1"/><mesh file="wedge.obj"/></asset>',
        )
    )
    link = ET.fromstring(description.text).find("link")
    assert link is not None
    names = {
        tag: [mesh.get("filename") for mesh in link.iterfind(f"{tag}/geometry/mesh")]
        for tag in ("visual", "collision")
    }
    assert names == {
        "visual": ["dented.obj", "wedge.obj"],
        "collision": ["dented_hull.stl", "wedge.obj"],
    }
    hull = description.meshes["dented_hull.stl"]
    assert isinstance(hull, bytes)
    (tmp_path / "hull.stl").write_bytes(hull)
    (solid,) = measure([(str(tmp_path / "hull.stl"), (1.0, 1.0, 1.0))])
    assert solid is not None
    assert solid.is_closed
    assert solid.volume == pytest.approx(2.0, rel=1e-6)
    assert said(description, "collides with the convex hulls of meshes") > 0


def test_two_meshes_of_one_name_stay_two(tmp_path: Path) -> None:
    for number, folder in enumerate(("left", "right")):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "hand.STL").write_bytes(wedge(number))
    description = same(
        write(
            tmp_path,
            """<body name="a"><freejoint/><geom type="mesh" mesh="l"/></body>
<body name="b"><joint/><geom type="mesh" mesh="l"/><geom type="mesh" mesh="r"/>
<body name="c"><joint/><geom type="mesh" mesh="r"/></body></body>""",
            '<asset><mesh name="l" file="left/hand.STL"/>'
            '<mesh name="r" file="right/hand.STL"/></asset>',
        )
    )
    assert list(description.meshes) == ["hand.STL", "hand_2.STL"]


def test_what_is_seen_and_what_is_touched(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            """<body name="a"><joint/>
  <geom size="0.1" class="visual" rgba="1 0 0 1"/>
  <geom size="0.2" class="collision" friction="0.6"/>
  <geom size="0.3" rgba="1 1 1 0"/>
  <geom size="0.4" material="blue"/>
</body>""",
            """<compiler discardvisual="true"/>
<default>
  <default class="visual"><geom contype="0" conaffinity="0" group="2"/></default>
  <default class="collision"><geom group="3"/></default>
</default>
<asset><material name="blue" rgba="0 0 1 0.5"/></asset>""",
        )
    )
    robot = ET.fromstring(description.text)
    for tag, sizes in (("visual", ["0.1", "0.4"]), ("collision", ["0.2", "0.3", "0.4"])):
        spheres = robot.findall(f"link/{tag}/geometry/sphere")
        assert [one.get("radius") for one in spheres] == sizes
    colors = [one.get("rgba") for one in robot.iter("color")]
    assert colors == ["1 0 0 1", "0 0 1 0.5"]
    assert robot.findtext("gazebo[@reference='a']/mu1") == "0.6"


COMPILERS = {
    "radians": '<compiler angle="radian" eulerseq="zyx"/>',
    "total mass": '<compiler settotalmass="7"/>',
    "balanced": '<compiler balanceinertia="true" boundmass="0.5" boundinertia="0.01"/>',
    "of geoms": '<compiler inertiafromgeom="true" inertiagrouprange="0 1"/>',
    "no limits": '<compiler autolimits="false"/>',
    "fused": '<compiler fusestatic="true"/>',
    "classes": '<default><joint damping="3" range="-10 20"/><geom density="500"/></default>',
}


@pytest.mark.filterwarnings("ignore:compiler attribute")
@pytest.mark.parametrize("compiler", COMPILERS)
def test_settings_of_the_compiler(tmp_path: Path, compiler: str) -> None:
    limited = 'limited="true"' if compiler == "no limits" else ""
    same(
        write(
            tmp_path,
            f"""<body name="a" euler="0.1 0.2 0.3">
  <inertial pos="0.1 0 0" mass="1.5" fullinertia="0.03 0.025 0.02 0.001 0.002 0.003"/>
  <geom size="0.2"/>
  <body name="b" pos="0 0 1" axisangle="1 1 0 0.7">
    <joint name="j" axis="0 1 1" range="-1 0.5" {limited}/>
    <geom type="box" size="0.1 0.2 0.3" group="1"/>
    <body name="c" xyaxes="0 1 0 -1 0 0"><geom type="capsule" size="0.1 0.2" group="2"/></body>
  </body>
</body>""",
            COMPILERS[compiler],
        )
    )


def test_included_files_and_their_lines(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "arm.xml").write_text(
        """<mujoco>
  <!-- -- -->
  <body name="arm" pos="0 0 1">
    <joint name="elbow"
           ref="10"/>
    <geom size="0.1"/>
  </body>
</mujoco>
"""
    )
    description = same(
        write(tmp_path, '<body name="base"><geom size="1"/><include file="parts/arm.xml"/></body>')
    )
    (note,) = [one for one in description.notes if "`elbow`" in one.what]
    assert (note.file.name, note.line) == ("arm.xml", 5)  # where its tag ends


def test_actuators_and_their_limits(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            """<body name="a">
  <joint name="one"/><geom size="1"/>
  <body name="b"><joint name="two" range="0 90"/><geom size="1"/>
    <body name="c"><joint name="three" range="0 90" actuatorfrcrange="-7 7"/><geom size="1"/>
      <body name="d"><joint name="four" range="0 90"/><geom size="1"/></body>
    </body>
  </body>
</body>""",
            behind="""<actuator>
  <motor name="m" joint="one" gear="50" ctrlrange="-2 1"/>
  <position name="p" joint="two" kp="100" kv="5" forcerange="-30 40"/>
  <velocity joint="three" kv="3"/>
  <general name="g" joint="four" biastype="affine" gainprm="1" biasprm="0 1 1"/>
</actuator>""",
        )
    )
    efforts = re.findall(r'<limit .*?effort="(\S+)"', description.text)
    assert efforts == ["100", "40", "7", "1000000"]
    for words, line in (
        ("motors (effort): `m`", 14),
        ("position servos: `p` (kp 100 kv 5)", 15),
        ("velocity servos: some (1 without a name) (kv 3)", 16),
        ("of another kind: `g`", 17),
        ("effort limit of 1,000,000 was written for `four`", 8),
    ):
        assert said(description, words) == line


def test_couplings_become_mimics_and_loops_are_said(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            """<body name="a"><joint name="one" ref="10"/><geom size="1"/>
<body name="b"><joint name="two"/><geom size="1"/></body>
<body name="c"><joint name="three"/><geom size="1"/></body>
<body name="d"><joint name="four"/><geom size="1"/></body></body>""",
            behind="""<equality>
  <joint joint1="two" joint2="one" polycoef="0.5 -2 0 0 0"/>
  <joint joint1="three" joint2="four" polycoef="0.5 -2 0 0 0"/>
  <joint joint1="four" joint2="one" polycoef="0 1 3 0 0"/>
  <joint joint1="four" joint2="one" active="false"/>
  <connect name="loop" body1="b" body2="c" anchor="0 0 0"/>
  <weld body1="c" body2="d"/>
</equality>
<actuator><motor joint="three"/></actuator>
<tendon><fixed name="cord"><joint joint="two" coef="1"/></fixed></tendon>""",
        )
    )
    found = re.findall(r'<mimic joint="(\w+)" multiplier="(\S+)" offset="(\S+)"', description.text)
    # two = 0.5 - 2 (one - 10°); three is driven: four = (three - 0.5) / -2
    assert [
        (leader, float(factor), round(float(offset), 9)) for leader, factor, offset in found
    ] == [
        ("one", -2, 0.84906585),
        ("three", -0.5, 0.25),
    ]
    assert said(description, "by more than a factor") == 12
    assert said(description, "`loop` (connect) closes a loop between `b` and `c`") == 14
    assert said(description, "(weld) closes a loop between `c` and `d`") == 15
    assert said(description, "no tendons: `cord`") == 18


def test_a_spring_is_for_gazebo(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            '<body name="a" gravcomp="1"><joint name="j" stiffness="4" springref="90"/>'
            '<geom size="1"/></body>',
        )
    )
    robot = ET.fromstring(description.text)
    assert robot.findtext("gazebo[@reference='j']/springStiffness") == "4"
    assert robot.findtext("gazebo[@reference='j']/springReference") == "1.5707963267948966"
    assert robot.findtext("gazebo[@reference='a']/turnGravityOff") == "true"


def test_names_are_unique(tmp_path: Path) -> None:
    description = read_mjcf(
        write(
            tmp_path,
            """<body name="a"><joint name="a"/><geom size="1"/>
<body name="b&amp;c"><joint/><geom size="1"/><body><geom size="1"/></body>
<body><geom size="1"/></body></body></body>""",
        )
    )
    robot = ET.fromstring(description.text)
    names = [one.get("name") for one in (*robot.findall("link"), *robot.findall("joint"))]
    assert len(names) == len(set(names)) == 9
    assert {"a", "a_joint", "b&c", "b&c_joint"} <= set(names)


def test_what_is_fixed_to_a_body_gives_a_share_of_its_mass(tmp_path: Path) -> None:
    description = read_mjcf(
        write(
            tmp_path,
            """<body name="a"><freejoint/><geom size="1"/><body name="b" pos="0 0 1">
<joint name="x" axis="1 0 0"/><joint name="y" axis="0 1 0"/>
<body name="c" pos="0 1 0" euler="0 0 90"><geom size="1" pos="0.5 0 0" mass="3"/></body>
</body></body>""",
        )
    )
    robot = ET.fromstring(description.text)
    inertial = robot.find("link[@name='x_link']/inertial")
    assert inertial is not None
    assert [dict(one.attrib) for one in inertial][:2] == [
        {"xyz": "0 1.5 0", "rpy": "0 0 1.570796326795"},
        {"value": "0.03"},
    ]
    masses = [float(one.get("value") or 0) for one in robot.iterfind("link/inertial/mass")]
    assert sum(masses[1:]) == pytest.approx(3)


def test_sites_are_frames(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            """<body name="a"><joint pos="0 0 1"/><geom size="1"/>
<site name="tool" pos="0 0 2" euler="0 0 90"/><site name="a"/><site/>
<site name="skin"/><site name="cord"/><site name="end"/></body>""",
            behind="""<sensor><touch site="skin"/></sensor>
<tendon><spatial><site site="cord"/><site site="end"/></spatial></tendon>""",
        )
    )
    robot = ET.fromstring(description.text)
    names = [str(one.get("name")) for one in robot.findall("link")]
    assert names == ["world", "a", "tool", "a_site"]
    origin = robot.find("joint[@name='tool_fixed']/origin")
    assert origin is not None
    assert origin.attrib == {"xyz": "0 0 1", "rpy": "0 0 1.570796326795"}


NUMBER = st.floats(-2, 2).map(lambda one: round(one, 4))
VECTOR = st.tuples(NUMBER, NUMBER, NUMBER).map(lambda three: " ".join(map(str, three)))
AXIS = VECTOR.filter(lambda text: sum(float(one) ** 2 for one in text.split()) > 0.1)
JOINT = st.builds(
    lambda kind, axis, at, ref: (
        f'<joint type="{kind}" axis="{axis}" pos="{at}" '
        + (f'ref="{ref}"/>' if kind != "ball" else "/>")
    ),
    st.sampled_from(["hinge", "slide"]),
    AXIS,
    VECTOR,
    NUMBER,
)
BALL = st.builds(lambda at: f'<joint type="ball" pos="{at}"/>', VECTOR)
JOINTS = st.one_of(st.lists(JOINT, max_size=3).map("\n".join), BALL)
GEOM = st.builds(
    lambda kind, at, turn: f'<geom type="{kind}" size="0.1 0.2 0.3" pos="{at}" euler="{turn}"/>',
    st.sampled_from(["sphere", "box", "cylinder", "capsule"]),
    VECTOR,
    VECTOR,
)
BODY = st.recursive(
    st.builds(lambda geom: f"<body>{geom}</body>", GEOM),
    lambda inner: st.builds(
        lambda at, turn, joints, geom, bodies: (
            f'<body pos="{at}" euler="{turn}">{joints}{geom}{"".join(bodies)}</body>'
        ),
        VECTOR,
        VECTOR,
        JOINTS,
        GEOM,
        st.lists(inner, max_size=2),
    ),
    max_leaves=4,
)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning")  # of slides along one axis
@settings(max_examples=40, phases=[Phase.generate])
@given(body=BODY)
def test_random_trees(body: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(parent, "run", parent.run_here)
        first, *others = body.split("<joint ")
        named = first + "".join(f'<joint name="j{n}" {rest}' for n, rest in enumerate(others))
        same(write(tmp_path_factory.mktemp("tree"), named, '<compiler angle="radian"/>'))


def includes(file: str) -> str:
    return f'<mujoco><worldbody><body name="a"/></worldbody><include file="{file}"/></mujoco>'


BAD: dict[str, tuple[str, type[WsgenError], str]] = {
    "not XML": ("<mujoco><body></mujoco>", NotReadableError, "robot.xml:1: not well-formed"),
    "a URDF": ('<robot name="a"/>', RequestError, "its root element is <robot>"),
    "an empty file": ("", NotReadableError, "not well-formed"),
    "nothing": ("<mujoco/>", NotReadableError, "no <body>"),
    "an unknown element": (
        "<mujoco><worldbody><bode/></worldbody></mujoco>",
        NotReadableError,
        "bode",
    ),
    "a missing mesh": (
        (
            '<mujoco><asset><mesh file="a.stl"/></asset><worldbody><body>'
            '<geom type="mesh" mesh="a"/>'
            "</body></worldbody></mujoco>"
        ),
        NotReadableError,
        "a.stl",
    ),
    "a broken mesh": (
        (
            '<mujoco><asset><mesh file="broken.stl"/></asset><worldbody><body>'
            '<geom type="mesh" mesh="broken"/></body></worldbody></mujoco>'
        ),
        NotReadableError,
        "broken.stl",
    ),
    "itself": (includes("robot.xml"), RequestError, "robot.xml:1: `robot.xml` includes itself"),
    "a circle": (includes("circle.xml"), RequestError, "circle.xml:1: `robot.xml` includes itself"),
    "a model of itself": (
        '<mujoco><asset><model file="robot.xml"/></asset></mujoco>',
        RequestError,
        "includes itself",
    ),
    "one that is missing": (includes("nowhere.xml"), NotFoundError, "robot.xml:1: `nowhere.xml`"),
    "one outside": (includes("../../../outside.xml"), RequestError, "is outside of"),
    "one of the system": (includes("/etc/hostname"), RequestError, "`/etc/hostname` is outside"),
    "a folder": (includes("folder"), NotReadableError, "it is a folder"),
    "entities": (
        '<!DOCTYPE a [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><mujoco model="&b;"/>',
        NotReadableError,
        "",
    ),
    "commas": (
        (
            '<mujoco>\n<worldbody><body><geom size="0.1"/>\n<site size="1, 1, 1"/></body>'
            "</worldbody></mujoco>"
        ),
        NotReadableError,
        "robot.xml:3: `1, 1, 1`",
    ),
    "numbers": (
        '<mujoco><worldbody><body pos="nan 0 0"><geom size="1"/></body></worldbody></mujoco>',
        NotReadableError,
        "",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files_have_a_message(tmp_path: Path, case: str) -> None:
    text, kind, words = BAD[case]
    folder = tmp_path / "a" / "b"
    (folder / "folder").mkdir(parents=True)
    (tmp_path.parent / "outside.xml").write_text("<mujoco/>")
    (folder / "circle.xml").write_text(includes("robot.xml"))
    (folder / "broken.stl").write_bytes(b"solid nothing")
    file = folder / "robot.xml"
    file.write_text(text)
    with pytest.raises(kind) as raised:
        read_mjcf(file)
    assert words in raised.value.message
    assert raised.value.hint.endswith((".", "FILE"))


def test_without_mujoco_it_says_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(mjcf, "find_spec", lambda _: None)
    with pytest.raises(NotFoundError, match=re.escape("pip install 'wsgen[mujoco]'")):
        read_mjcf(write(tmp_path, '<body name="a"><geom size="1"/></body>'))


@pytest.mark.slow
def test_it_is_read_in_a_child(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    file = write(tmp_path, '<body name="a"><joint type="ball"/><geom size="1"/></body>')
    description = same(file)
    assert isinstance(description.notes, tuple)
    monkeypatch.setattr(mjcf, "LIMITS", Limits(seconds=0.01))
    with pytest.raises(NotReadableError, match="CPU time"):
        read_mjcf(file)
