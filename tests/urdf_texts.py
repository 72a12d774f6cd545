"""Small robots: one for every error and every warning of the reader."""

from __future__ import annotations

MASS = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>'
)


def robot(body: str, name: str = "r") -> str:
    return f'<robot name="{name}">\n{body}\n</robot>'


def link(name: str, body: str = MASS) -> str:
    return f'<link name="{name}">{body}</link>\n'


def joint(name: str, parent: str, child: str, body: str = "", kind: str = "fixed") -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{body}</joint>\n"
    )


def shape(tag: str, geometry: str) -> str:
    return f"<{tag}><geometry>{geometry}</geometry></{tag}>"


def sensor(body: str) -> str:
    return f'<gazebo reference="a"><sensor name="s" type="camera">{body}</sensor></gazebo>'


TWO = link("a") + link("b")
SPHERE = '<sphere radius="1"/>'
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'

ERRORS = {
    "not xml": ("ROB001", "<robot name='r'><link name='a'></robot>"),
    "empty": ("ROB001", ""),
    "entities": ("ROB002", '<!DOCTYPE r [<!ENTITY a "b">]>' + robot(link("a"))),
    "sdf": ("ROB003", "<sdf version='1.9'/>"),
    "no name": ("ROB004", robot(link("a"), name="")),
    "no links": ("ROB005", robot("")),
    "link without name": ("ROB006", robot(link("a") + "<link/>")),
    "joint without name": ("ROB006", robot(TWO + joint("", "a", "b", kind="continuous"))),
    "material without name": (
        "ROB006",
        robot(link("a", MASS + shape("visual", SPHERE).replace("</v", "<material/></v"))),
    ),
    "two links of one name": ("ROB007", robot(link("a") + link("a"))),
    "two joints of one name": (
        "ROB008",
        robot(TWO + link("c") + joint("j", "a", "b") + joint("j", "b", "c")),
    ),
    "two roots": ("ROB009", robot(TWO)),
    "world not joined": ("ROB009", robot('<link name="world"/>' + link("a"))),
    "cycle": ("ROB010", robot(TWO + joint("j", "a", "b") + joint("k", "b", "a"))),
    "cycle below a root": (
        "ROB010",
        robot(link("r") + TWO + joint("j", "a", "b") + joint("k", "b", "a")),
    ),
    "two parents": (
        "ROB011",
        robot(TWO + link("c") + joint("j", "a", "c") + joint("k", "b", "c")),
    ),
    "self joint": ("ROB012", robot(link("a") + joint("j", "a", "a"))),
    "unknown link": ("ROB013", robot(TWO + joint("j", "a", "B"))),
    "joint without child": (
        "ROB014",
        robot(TWO + '<joint name="j" type="fixed"><parent link="a"/></joint>'),
    ),
    "mimic without joint": ("ROB014", robot(TWO + joint("j", "a", "b", "<mimic/>"))),
    "joint type": ("ROB015", robot(TWO + joint("j", "a", "b", kind="hinge"))),
    "comma": ("ROB016", robot(TWO + joint("j", "a", "b", '<origin xyz="0,1 0 0"/>'))),
    "two numbers": ("ROB016", robot(TWO + joint("j", "a", "b", '<origin xyz="0 0"/>'))),
    "nan": ("ROB016", robot(TWO + joint("j", "a", "b", '<origin rpy="nan 0 0"/>'))),
    "huge": ("ROB016", robot(link("a", MASS.replace('"1"', '"1e999"')))),
    "underscore": ("ROB016", robot(link("a", MASS.replace('value="1"', 'value="1_0"')))),
    "other digits": ("ROB016", robot(link("a", MASS.replace('value="1"', 'value="٣"')))),
    "missing moment": ("ROB016", robot(link("a", MASS.replace('iyz="0"', "")))),
    "limit without effort on a continuous joint": (
        "ROB016",
        robot(TWO + joint("j", "a", "b", '<limit velocity="1"/>', "continuous")),
    ),
    "wrong limit on a fixed joint": (
        "ROB016",
        robot(TWO + joint("j", "a", "b", LIMIT.replace("-1", "x"))),
    ),
    "empty dynamics": ("ROB016", robot(TWO + joint("j", "a", "b", "<dynamics/>"))),
    "safety without velocity": (
        "ROB016",
        robot(TWO + joint("j", "a", "b", "<safety_controller/>")),
    ),
    "wrong calibration": (
        "ROB016",
        robot(TWO + joint("j", "a", "b", '<calibration rising="x"/>')),
    ),
    "blank behind a number": ("ROB016", robot(link("a", MASS.replace('value="1"', 'value="1 "')))),
    "line break in numbers": (
        "ROB016",
        robot(TWO + joint("j", "a", "b", '<origin xyz="1\n0 0"/>')),
    ),
    "tab in numbers": ("ROB016", robot(TWO + joint("j", "a", "b", "<origin rpy='1 0\t0'/>"))),
    "four scales": (
        "ROB016",
        robot(link("a", MASS + shape("visual", '<mesh filename="a.stl" scale="1 1 1 1"/>'))),
    ),
    "left over": ("ROB017", robot(TWO + joint("j", "a", "b", '<origin xyz="${x} 0 0"/>'))),
    "left over in text": ("ROB017", robot(link("a") + "<gazebo><p>$(find x)</p></gazebo>")),
    "left over macro": (
        "ROB143",
        robot(link("a") + '<xacro:wheel xmlns:xacro="http://www.ros.org/wiki/xacro"/>'),
    ),
    "zero axis": (
        "ROB018",
        robot(TWO + joint("j", "a", "b", '<axis xyz="0 0 0"/>', "continuous")),
    ),
    "axis without xyz": ("ROB018", robot(TWO + joint("j", "a", "b", "<axis/>", "continuous"))),
    "no limit": ("ROB020", robot(TWO + joint("j", "a", "b", kind="revolute"))),
    "no effort": (
        "ROB016",
        robot(TWO + joint("j", "a", "b", '<limit velocity="1"/>', "prismatic")),
    ),
    "inertial without mass": ("ROB021", robot(link("a", "<inertial/>"))),
    "negative mass": ("ROB022", robot(link("a", MASS.replace('value="1"', 'value="-1"')))),
    "no geometry": ("ROB024", robot(link("a", MASS + "<collision/>"))),
    "unknown geometry": ("ROB024", robot(link("a", MASS + shape("visual", "<cone/>")))),
    "capsule": (
        "ROB024",
        robot(link("a", MASS + shape("collision", '<capsule radius="1" length="1"/>'))),
    ),
    "first element is no shape": (
        "ROB024",
        robot(link("a", MASS + shape("visual", "<x/>" + SPHERE))),
    ),
    "zero radius": ("ROB028", robot(link("a", MASS + shape("collision", '<sphere radius="0"/>')))),
    "negative box": ("ROB028", robot(link("a", MASS + shape("collision", '<box size="1 -1 1"/>')))),
    "zero scale": (
        "ROB028",
        robot(link("a", MASS + shape("collision", '<mesh filename="a.stl" scale="0 1 1"/>'))),
    ),
    "mirrored mesh": (
        "ROB151",
        robot(link("a", MASS + shape("collision", '<mesh filename="a.stl" scale="1 -1 1"/>'))),
    ),
    "mesh without name": ("ROB029", robot(link("a", MASS + shape("visual", "<mesh/>")))),
    "friction in words": (
        "ROB031",
        robot(link("a") + '<gazebo reference="a"><mu1>low</mu1></gazebo>'),
    ),
    "negative friction": (
        "ROB031",
        robot(
            link("a", MASS + shape("collision", SPHERE))
            + '<gazebo reference="a"><mu1>-1</mu1></gazebo>'
        ),
    ),
    "friction out of range": (
        "ROB031",
        robot(link("a") + '<gazebo reference="x"><mu1>1e400</mu1></gazebo>'),
    ),
    "contacts in words": (
        "ROB031",
        robot(link("a") + '<gazebo reference="a"><maxContacts>inf</maxContacts></gazebo>'),
    ),
    "copied friction in words": (
        "ROB031",
        robot(
            link("a", MASS + shape("collision", SPHERE))
            + '<gazebo reference="a"><collision><surface><friction><ode><mu>low</mu></ode>'
            "</friction></surface></collision></gazebo>"
        ),
    ),
    "no truth": (
        "ROB045",
        robot(link("a") + '<gazebo reference="a"><self_collide>yes</self_collide></gazebo>'),
    ),
    "mimics itself": ("ROB036", robot(TWO + joint("j", "a", "b", '<mimic joint="j"/>'))),
    "impossible part of a sum that is impossible": (
        "ROB037",
        robot(link("a") + link("b", MASS.replace('izz="1"', 'izz="9"')) + joint("j", "a", "b")),
    ),
    "link called world in the middle": (
        "ROB043",
        robot(link("a") + link("world") + joint("j", "a", "world", kind="continuous")),
    ),
    "joint called world": ("ROB043", robot(TWO + joint("world", "a", "b", kind="continuous"))),
    "link of SDF": ("ROB043", robot(link("__model__"))),
    "robot called world": ("ROB043", robot(link("a"), name="world")),
    "version": ("ROB047", robot(link("a")).replace("<robot", "<robot version='2.0'")),
    "material defined twice": (
        "ROB059",
        robot('<material name="m"><color rgba="1 0 0 1"/></material>' * 2 + link("a")),
    ),
    "processing instruction": ("ROB001", robot("<?php echo ?>" + link("a"))),
    "impossible inertia": ("ROB037", robot(link("a", MASS.replace('izz="1"', 'izz="9"')))),
    "sensor without type": (
        "ROB097",
        robot(link("a") + '<gazebo reference="a"><sensor name="s"/></gazebo>'),
    ),
    "sensor without name": (
        "ROB097",
        robot(link("a") + '<gazebo reference="a"><sensor type="imu"/></gazebo>'),
    ),
    "unknown sensor": (
        "ROB097",
        robot(link("a") + '<gazebo reference="a"><sensor name="s" type="camra"/></gazebo>'),
    ),
    "plugin without name": (
        "ROB098",
        robot(link("a") + '<gazebo><plugin filename="f"/></gazebo>'),
    ),
    "plugin of a sensor without file": (
        "ROB098",
        robot(link("a") + sensor('<plugin name="p"/>')),
    ),
    "rate in words": ("ROB099", robot(link("a") + sensor("<update_rate>fast</update_rate>"))),
    "flag of a sensor": ("ROB099", robot(link("a") + sensor("<always_on>yes</always_on>"))),
    "pose of three numbers": ("ROB099", robot(link("a") + sensor("<pose>0 0 1</pose>"))),
    "quaternion of six numbers": (
        "ROB099",
        robot(link("a") + sensor('<pose rotation_format="quat_xyzw">0 0 1 0 0 0</pose>')),
    ),
    "view in degrees": (
        "ROB099",
        robot(link("a") + sensor("<camera><horizontal_fov>90</horizontal_fov></camera>")),
    ),
    "noise in words": (
        "ROB099",
        robot(link("a") + sensor("<camera><noise><mean>low</mean></noise></camera>")),
    ),
}

WARNINGS = {
    "rate with its unit": (
        "ROB099",
        robot(link("a") + sensor("<update_rate>30 Hz</update_rate>")),
    ),
    "long axis": (
        "ROB019",
        robot(TWO + joint("j", "a", "b", '<axis xyz="0 0 2"/>', "continuous")),
    ),
    "limits exchanged": (
        "ROB023",
        robot(TWO + joint("j", "a", "b", LIMIT.replace("-1", "2"), "revolute")),
    ),
    "undefined material": (
        "ROB025",
        robot(
            link(
                "a",
                MASS
                + '<visual><geometry><sphere radius="1"/></geometry><material name="m"/></visual>',
            )
        ),
    ),
    "two colors": (
        "ROB026",
        robot(
            '<material name="m"><color rgba="1 0 0 1"/></material>\n'
            + link(
                "a",
                MASS
                + shape("visual", SPHERE).replace(
                    "</v", '<material name="m"><color rgba="0 0 1 1"/></material></v'
                ),
            )
        ),
    ),
    "color in words": (
        "ROB016",
        robot('<material name="m"><color rgba="red"/></material>' + link("a")),
    ),
    "nothing to see": ("ROB028", robot(link("a", MASS + shape("visual", '<sphere radius="0"/>')))),
    "not finite": (
        "ROB031",
        robot(link("a") + '<gazebo reference="a"><mu1>inf</mu1></gazebo>'),
    ),
    "number with an end": (
        "ROB031",
        robot(link("a") + '<gazebo reference="a"><mu1>0.2f</mu1></gazebo>'),
    ),
    "contacts with a point": (
        "ROB031",
        robot(link("a") + '<gazebo reference="a"><maxContacts>3.7</maxContacts></gazebo>'),
    ),
    "self-collision of the whole robot": (
        "ROB033",
        robot(link("a") + "<gazebo><selfCollide>1</selfCollide></gazebo>"),
    ),
    "friction of a joint": (
        "ROB033",
        robot(TWO + joint("j", "a", "b") + '<gazebo reference="j"><mu1>1</mu1></gazebo>'),
    ),
    "spring of a link": (
        "ROB033",
        robot(link("a") + '<gazebo reference="a"><springStiffness>1</springStiffness></gazebo>'),
    ),
    "static link": (
        "ROB033",
        robot(link("a") + '<gazebo reference="a"><static>1</static></gazebo>'),
    ),
    "unknown leader": ("ROB035", robot(TWO + joint("j", "a", "b", '<mimic joint="x"/>'))),
    "closed chain": (
        "ROB058",
        robot(
            TWO
            + joint("j", "a", "b", kind="continuous")
            + '<gazebo><joint name="k" type="revolute"><parent>a</parent><child>b</child></joint>'
            "</gazebo>"
        ),
    ),
    "two hyphens in a comment": ("ROB001", robot("<!-- a -- b -->" + link("a"))),
    "prefix not declared": ("ROB001", robot("<sensor:camera/>" + link("a"))),
    "bare ampersand": ("ROB001", robot("<author>You & I</author>" + link("a"))),
    "bytes as color": (
        "ROB027",
        robot('<material name="m"><color rgba="255 0 0 1"/></material>' + link("a")),
    ),
    "unknown reference": ("ROB030", robot(link("wheel") + '<gazebo reference="whel"/>')),
    "unknown color": (
        "ROB032",
        robot(link("a") + '<gazebo reference="a"><material>Gazebo/Gren</material></gazebo>'),
    ),
    "preserve on a link": (
        "ROB033",
        robot(
            link("a") + '<gazebo reference="a"><preserveFixedJoint>1</preserveFixedJoint></gazebo>'
        ),
    ),
    "joint named like a link": ("ROB034", robot(TWO + joint("b", "a", "b", kind="continuous"))),
    "preserved joint named like a link": (
        "ROB034",
        robot(
            TWO
            + joint("b", "a", "b")
            + '<gazebo reference="b"><preserveFixedJoint>true</preserveFixedJoint></gazebo>'
        ),
    ),
    "impossible part of a sum that is possible": (
        "ROB037",
        robot(
            link("a", MASS.replace('"1"', '"20"'))
            + link("b", MASS.replace('izz="1"', 'izz="9"'))
            + joint("j", "a", "b")
        ),
    ),
}
