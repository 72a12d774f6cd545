"""Small URDFs and worlds with one mistake each: what simulators make of them says what rules say.

What is no <robot> nor <sdf> is the inside of one <robot>. MESH and BROKEN are files of meshes; a
world has the ground plane and the model `r`, 1 m above it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

INERTIA = "<inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/>"
LIMIT = "<limit lower='-1' upper='1' effort='1' velocity='1'/>"
AXIS = "<axis xyz='0 0 1'/>"
SENSOR = (
    "<gazebo reference='{}'><sensor name='s' type='imu'><update_rate>10</update_rate></sensor>"
    "</gazebo>"
)


def link(name: str, shape: str = "<box size='0.1 0.1 0.1'/>", mass: str | None = "1") -> str:
    inertial = f"<inertial><mass value='{mass}'/>{INERTIA}</inertial>" if mass else ""
    collision = f"<collision><geometry>{shape}</geometry></collision>" if shape else ""
    return f"<link name='{name}'>{inertial}{collision}</link>"


def joint(name: str, parent_link: str, child: str, kind: str = "revolute") -> str:
    return (
        f"<joint name='{name}' type='{kind}'><parent link='{parent_link}'/><child link='{child}'/>"
        f"{AXIS}{LIMIT}</joint>"
    )


def sdf(*inside: str, version: str = "1.7", before: str = "") -> str:
    """A world with the ground plane, `before` it, and the model `r` with what is inside."""
    ground = (
        "<model name='ground'><static>true</static><link name='g'><collision name='c'><geometry>"
        "<plane><normal>0 0 1</normal><size>9 9</size></plane></geometry></collision></link>"
        "</model>"
    )
    model = f"<model name='r'><pose>0 0 1 0 0 0</pose>{''.join(inside)}</model>"
    return f"<sdf version='{version}'><world name='w'>{before}{ground}{model}</world></sdf>"


def part(name: str, shape: str = "<box><size>0.1 0.1 0.1</size></box>", mass: str = "1") -> str:
    """A link of SDF."""
    return (
        f"<link name='{name}'><inertial><mass>{mass}</mass><inertia><ixx>0.01</ixx><iyy>0.01</iyy>"
        "<izz>0.01</izz></inertia></inertial><collision name='c'><geometry>"
        f"{shape}</geometry></collision></link>"
    )


def turns(name: str, child: str, kind: str = "revolute") -> str:
    """A joint of SDF from the link `a`."""
    return (
        f"<joint name='{name}' type='{kind}'><parent>a</parent><child>{child}</child>"
        "<axis><xyz>0 0 1</xyz></axis></joint>"
    )


PARTS = part("a") + part("b")
FRAMES = "<frame name='{}'><pose relative_to='{}'/></frame>"
SCREW = (
    "<gazebo><joint name='s' type='revolute'><parent>a</parent><child>{}</child>"
    "<axis><xyz>0 0 1</xyz></axis></joint></gazebo>"
)
TWO = link("a") + link("b") + joint("j", "a", "b")
CASES: Mapping[str, str] = {
    "sound": TWO,
    # Shapes.
    "flat box": link("a", "<box size='0 0.1 0.1'/>"),
    "negative box": link("a", "<box size='-0.1 0.1 -0.1'/>"),
    "sphere of size 0": link("a", "<sphere radius='0'/>"),
    "negative cylinder": link("a", "<cylinder radius='-0.1' length='0.1'/>"),
    "negative length": link("a", "<cylinder radius='0.1' length='-0.1'/>"),
    "mirrored mesh": link("a", "<mesh filename='MESH' scale='0.1 -0.1 0.1'/>"),
    "absent mesh": link("a", "<mesh filename='file:///absent.stl'/>"),
    "unnamed mesh": link("a", "<mesh/>"),
    "four scales": link("a", "<mesh filename='MESH' scale='1 1 1 1'/>"),
    "capsule": link("a", "<capsule radius='0.1' length='0.2'/>"),
    "capsule before a box": link("a").replace(
        "<collision>", "<collision><geometry><capsule/></geometry></collision><collision>"
    ),
    "no shape to see": link("a").replace("</link>", "<visual/></link>"),
    "origin of two numbers": link("a").replace("<collision>", "<collision><origin xyz='0 0'/>"),
    # Masses and inertias.
    "negative mass": link("a", mass="-1"),
    "a word for a mass": link("a", mass="one"),
    "inertia of 0": link("a").replace("0.01", "0"),
    "negative inertia": link("a").replace("0.01", "-0.01", 1),
    "impossible inertia": link("a").replace("ixx='0.01'", "ixx='1'"),
    "no moments": TWO.replace(INERTIA, "", 1),
    "a word for a moment": TWO.replace("ixx='0.01'", "ixx='one'", 1),
    "massless child": link("a") + link("b", "", None) + joint("j", "a", "b"),
    "half a milligram": link("a") + link("b", "", "5e-7") + joint("j", "a", "b"),
    "two milligrams": link("a") + link("b", "", "2e-6") + joint("j", "a", "b"),
    "massless frame that is kept": link("a")
    + link("b", "", None)
    + joint("j", "a", "b", "fixed")
    + "<gazebo reference='j'><preserveFixedJoint>true</preserveFixedJoint></gazebo>",
    "on a lumped massless link": link("a")
    + link("b", "", None)
    + link("c")
    + joint("j", "a", "b", "fixed")
    + joint("k", "b", "c"),
    "massless root": link("a", "", None) + link("b") + joint("j", "a", "b"),
    "massless root, fixed": link("a", "", None) + link("b") + joint("j", "a", "b", "fixed"),
    "masses of 0, fixed": link("a")
    + link("b", "", "0")
    + link("c", "", "0")
    + joint("j", "a", "b", "fixed")
    + joint("k", "b", "c", "fixed"),
    # Names and joints.
    "two links of a name": link("a") + link("a"),
    "two joints of a name": TWO + link("c") + joint("j", "a", "c"),
    "a joint named as a link": TWO.replace("name='j'", "name='b'"),
    "two roots": link("a") + link("b"),
    "no limit": TWO.replace(LIMIT, ""),
    "swapped limits": TWO.replace("lower='-1' upper='1'", "lower='1' upper='-1'"),
    "unknown type": TWO.replace("revolute", "hinge"),
    "planar": TWO.replace("revolute", "planar"),
    "mimics nothing": TWO.replace("</joint>", "<mimic joint='x'/></joint>"),
    # Extensions.
    "two sensors": link("a") + 2 * SENSOR.format("a"),
    "two sensors that are lumped": TWO.replace("revolute", "fixed")
    + SENSOR.format("a")
    + SENSOR.format("b"),
    "a word for a friction": link("a") + "<gazebo reference='a'><mu1>high</mu1></gazebo>",
    "unknown reference": link("a") + "<gazebo reference='z'><mu1>1</mu1></gazebo>",
    "absent plugin": link("a") + "<gazebo><plugin name='p' filename='libabsent.so'/></gazebo>",
    "no link": "",
    # What is in no URDF that is read.
    "a tag that is not closed": link("a").replace("</collision>", ""),
    "entities": "<!DOCTYPE robot [<!ENTITY m '1'>]>"
    f"<robot name='r'>{link('a', mass='&m;')}</robot>",
    "not a robot": f"<robots name='r'>{link('a')}</robots>",
    "a robot without a name": f"<robot>{link('a')}</robot>",
    "another version": f"<robot name='r' version='2.0'>{link('a')}</robot>",
    "a link without a name": link("a") + link("").replace("name=''", ""),
    "two materials of a name": 2 * "<material name='m'><color rgba='1 0 0 1'/></material>"
    + link("a"),
    "left over": TWO.replace(AXIS, "<origin xyz='${x} 0 0'/>" + AXIS),
    "a macro that is not expanded": link("a")
    + "<xacro:wheel xmlns:xacro='http://www.ros.org/wiki/xacro'/>",
    "a number beyond engines": link("a", mass="1e300"),
    "a broken mesh": link("a", "<mesh filename='BROKEN'/>"),
    "a misspelled collision": link("a").replace("collision>", "colision>"),
    "a misspelled value": link("a").replace("value", "vlaue"),
    "a color in words": link("a").replace(
        "</link>",
        "<visual><geometry><sphere radius='0.1'/></geometry><material name='m'>"
        "<color rgba='255 0 0 1'/></material></visual></link>",
    ),
    "an unknown material": link("a").replace(
        "</link>",
        "<visual><geometry><sphere radius='0.1'/></geometry><material name='m'/></visual></link>",
    ),
    "an absent mesh to see": link("a").replace(
        "</link>",
        "<visual><geometry><mesh filename='file:///absent.stl'/></geometry></visual></link>",
    ),
    # The tree, and its joints.
    "two parents": TWO + link("c") + joint("k", "a", "c") + joint("l", "b", "c"),
    "a joint to itself": TWO + joint("k", "b", "b"),
    "an unknown child": link("a") + joint("j", "a", "b"),
    "a joint without a child": TWO.replace("<child link='b'/>", ""),
    "an axis of 0": TWO.replace("0 0 1", "0 0 0"),
    "a long axis": TWO.replace("0 0 1", "0 0 2"),
    "mimics itself": TWO.replace("</joint>", "<mimic joint='j'/></joint>"),
    "mimics a fixed joint": TWO.replace("</joint>", "<mimic joint='k'/></joint>")
    + link("c")
    + joint("k", "a", "c", "fixed"),
    "a negative effort": TWO.replace("effort='1'", "effort='-1'"),
    "an impossible sum": link("a")
    + link("b", "", "0").replace("izz='0.01'", "izz='9'")
    + joint("j", "a", "b", "fixed"),
    "a reserved name": link("__a__"),
    "a link called world": link("a") + link("world") + joint("j", "a", "world"),
    "a joint called world": TWO.replace("name='j'", "name='world'"),
    # Extensions.
    "a word for a flag": link("a")
    + "<gazebo reference='a'><self_collide>yes</self_collide></gazebo>",
    "a setting of a joint on a link": link("a")
    + "<gazebo reference='a'><preserveFixedJoint>true</preserveFixedJoint></gazebo>",
    "a collision that is not found": link("a").replace("<collision>", "<collision name='tire'>")
    + "<gazebo reference='a'><mu1>0.2</mu1></gazebo>",
    "an unknown end of a joint of SDF": TWO + SCREW.format("z"),
    "a lumped end of a joint of SDF": TWO
    + link("c")
    + joint("k", "b", "c", "fixed")
    + SCREW.format("c"),
    "a sensor without a type": link("a")
    + "<gazebo reference='a'><sensor name='s'><update_rate>10</update_rate></sensor></gazebo>",
    "a word for a rate": link("a") + SENSOR.format("a").replace("10", "fast"),
    "a sensor without a link": link("a") + SENSOR.format("").replace(" reference=''", ""),
    "a plugin without a file": link("a") + "<gazebo><plugin name='p'/></gazebo>",
    # Worlds.
    "a sound world": sdf(PARTS, turns("j", "b")),
    "kinematic": sdf(
        part("a").replace("<inertial>", "<kinematic>true</kinematic><inertial>"),
        part("b"),
        turns("j", "b"),
    ),
    "neither world nor model": "<sdf version='1.7'/>",
    "no version": sdf(part("a")).replace(" version='1.7'", ""),
    "a later version": sdf(part("a"), version="1.99"),
    "entities in a world": f"<!DOCTYPE sdf [<!ENTITY m '1'>]>{sdf(part('a', mass='&m;'))}",
    "a step of 0": sdf(
        part("a"),
        before="<physics name='p' type='ode'><max_step_size>0</max_step_size></physics>",
    ),
    "two links of a name in SDF": sdf(part("a"), part("a")),
    "an unknown frame": sdf(part("a").replace("<inertial>", "<pose relative_to='x'/><inertial>")),
    "a cycle of frames": sdf(part("a"), FRAMES.format("x", "y"), FRAMES.format("y", "x")),
    "a collision seen from a frame": sdf(
        part("a").replace("<geometry>", "<pose relative_to='x'/><geometry>"),
        "<frame name='x' attached_to='a'/>",
    ),
    "a joint without a child in SDF": sdf(PARTS, turns("j", "b").replace("<child>b</child>", "")),
    "a screw": sdf(PARTS, turns("j", "b", "screw")),
    "a closed chain": sdf(
        PARTS,
        part("c"),
        turns("j", "b"),
        turns("k", "c"),
        turns("l", "c").replace("<parent>a", "<parent>b"),
    ),
    "no normal": sdf(part("a"), before="").replace("0 0 1</normal>", "0 0 0</normal>"),
    "negative box of SDF": sdf(part("a", "<box><size>-0.1 0.1 -0.1</size></box>")),
    "no inertial": sdf(part("a").replace("inertial>", "ignored>")),
    "a mass of 0": sdf(part("a", mass="0")),
    "a static model in another": sdf(
        part("a"), f"<model name='m'><static>true</static>{part('b')}</model>"
    ),
    "no area": sdf(
        part("a", f"<polyline><height>0.1</height>{4 * '<point>0 0</point>'}</polyline>")
    ),
}
# The rules that say what simulators do, by the case of which it was measured.
OF_RULES = {
    "a word for a mass": "ROB016",
    "negative mass": "ROB022",
    "impossible inertia": "ROB037",
    "capsule": "ROB024",
    "massless child": "ROB040",
    "massless root, fixed": "ROB051",
    "masses of 0, fixed": "ROB041",
    "two links of a name": "ROB007",
    "two joints of a name": "ROB008",
    "a joint named as a link": "ROB034",
    "two roots": "ROB009",
    "no limit": "ROB020",
    "swapped limits": "ROB023",
    "unknown type": "ROB015",
    "planar": "ROB055",
    "mimics nothing": "ROB035",
    "two sensors": "ROB108",
    "a word for a friction": "ROB031",
    "unknown reference": "ROB030",
    "mirrored mesh": "ROB151",
    "no link": "ROB005",
    "a tag that is not closed": "ROB001",
    "entities": "ROB002",
    "not a robot": "ROB003",
    "a robot without a name": "ROB004",
    "another version": "ROB047",
    "a link without a name": "ROB006",
    "two materials of a name": "ROB059",
    "left over": "ROB017",
    "a macro that is not expanded": "ROB143",
    "a number beyond engines": "ROB056",
    "a broken mesh": "ROB062",
    "absent mesh": "ROB060",
    "unnamed mesh": "ROB029",
    "no moments": "ROB021",
    "sphere of size 0": "ROB028",
    "a misspelled collision": "ROB038",
    "a misspelled value": "ROB077",
    "a color in words": "ROB027",
    "an unknown material": "ROB025",
    "an absent mesh to see": "ROB061",
    "two parents": "ROB011",
    "a joint to itself": "ROB012",
    "an unknown child": "ROB013",
    "a joint without a child": "ROB014",
    "an axis of 0": "ROB018",
    "a long axis": "ROB019",
    "mimics itself": "ROB036",
    "mimics a fixed joint": "ROB085",
    "a negative effort": "ROB131",
    "an impossible sum": "ROB042",
    "a reserved name": "ROB043",
    "a word for a flag": "ROB045",
    "a setting of a joint on a link": "ROB033",
    "a collision that is not found": "ROB046",
    "an unknown end of a joint of SDF": "ROB078",
    "a lumped end of a joint of SDF": "ROB079",
    "on a lumped massless link": "ROB080",
    "a sensor without a type": "ROB097",
    "a word for a rate": "ROB099",
    "a sensor without a link": "ROB104",
    "a plugin without a file": "ROB098",
    "neither world nor model": "WLD003",
    "no version": "WLD011",
    "a later version": "WLD012",
    "entities in a world": "WLD046",
    "a step of 0": "WLD007",
    "two links of a name in SDF": "WLD015",
    "an unknown frame": "WLD016",
    "a cycle of frames": "WLD017",
    "a collision seen from a frame": "WLD020",
    "a joint without a child in SDF": "WLD021",
    "a screw": "WLD024",
    "a closed chain": "WLD025",
    "no normal": "WLD034",
    "no inertial": "WLD035",
    "a mass of 0": "WLD041",
    "a static model in another": "WLD048",
    "no area": "WLD057",
}
