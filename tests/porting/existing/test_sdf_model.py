"""Models of SDF as URDF: compared with the reader's poses and with Gazebo's own parser."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

import pytest

from gazebo_oracle import IGN, model_of
from mesh_samples import binary_stl
from porting.existing.sdf_oracle import compare
from wsgen.errors import NotFoundError, NotReadableError, RequestError, WsgenError
from wsgen.porting.existing.sdf_model import read_sdf_model

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.porting.existing.description import Description

NEAR = 1e-9  # m, or a share


def write(folder: Path, inside: str, version: str = "1.9", name: str = "cart") -> Path:
    file = folder / "model.sdf"
    file.write_text(
        f'<sdf version="{version}">\n<model name="{name}">\n{inside}\n</model>\n</sdf>\n',
        encoding="utf-8",
    )
    return file


def same(file: Path) -> Description:
    """The description of a model, which is what its reader has."""
    description = read_sdf_model(file)
    assert all(difference <= NEAR for difference in compare(description).values())
    return description


def said(description: Description, words: str) -> int:
    """The line of the one note with these words."""
    (note,) = [one for one in description.notes if words in one.what]
    assert note.advice.endswith(".")
    return note.line


def link(name: str, pose: str = "0 0 0 0 0 0", more: str = "") -> str:
    return f"""<link name="{name}"><pose>{pose}</pose><inertial>
<pose>0.1 0.2 0.3 0.1 0.2 0.3</pose><mass>2</mass>
<inertia><ixx>0.02</ixx><ixy>0.001</ixy><iyy>0.03</iyy><izz>0.04</izz></inertia>
</inertial>{more}</link>"""


def joint(kind: str, parent: str, child: str, more: str = "", pose: str = "") -> str:
    placed = f"<pose>{pose}</pose>" if pose else ""
    return (
        f'<joint name="{child}_joint" type="{kind}">{placed}<parent>{parent}</parent>'
        f"<child>{child}</child>{more}</joint>"
    )


AXIS = '<axis><xyz expressed_in="__model__">0 1 0.5</xyz>{}</axis>'
LIMIT = "<limit><lower>-1</lower><upper>0.5</upper><effort>5</effort><velocity>3</velocity></limit>"


def test_frames_of_links_and_joints_are_anywhere(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            "\n".join(
                (
                    link("base", "0 0 0.1 0.1 0 0.3"),
                    link("arm", "0 1 0 0.3 0.2 0.1"),
                    link("slide", "1 1 0 0 0 1"),
                    link("wheel", "0 0 0 1.5 0 0"),
                    joint("revolute", "base", "arm", AXIS.format(LIMIT), "0.1 0.2 0.3 0.4 0.5 0.6"),
                    joint("prismatic", "arm", "slide", AXIS.format(LIMIT)),
                    joint(
                        "revolute",
                        "base",
                        "wheel",
                        AXIS.format("<limit><effort>7</effort></limit>"),
                    ),
                )
            ),
        )
    )
    limits = re.findall(r"<limit (.*)/>", description.text)
    assert limits == [
        'lower="-1" upper="0.5" effort="5" velocity="3"',
        'lower="-1" upper="0.5" effort="5" velocity="3"',
        'effort="7" velocity="1000000"',
    ]
    assert said(description, "origin of the robot") == 2


@pytest.mark.parametrize("version", ["1.4", "1.6"])
def test_axes_of_old_versions(tmp_path: Path, version: str) -> None:
    axis = "<axis><xyz>0 1 0</xyz><use_parent_model_frame>1</use_parent_model_frame></axis>"
    parts = (link("base"), link("arm", "0 0 1 0.3 0.2 0.1"), joint("revolute", "base", "arm", axis))
    same(write(tmp_path, "\n".join(parts), version))


def test_what_a_urdf_cannot_say_has_its_line(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            "\n".join(
                (
                    *map(link, ("base",)),
                    '<link name="ball"><light name="lamp" type="point"/></link>',
                    '<link name="cross"/>',
                    '<link name="bolt"/>',
                    joint("ball", "base", "ball"),
                    joint("universal", "ball", "cross", "<axis/><axis2><xyz>0 1 0</xyz></axis2>"),
                    (
                        '<joint name="loop" type="fixed"><parent>base</parent>'
                        "<child>cross</child></joint>"
                    ),
                    joint("screw", "base", "bolt", AXIS.format("")),
                )
            ),
        )
    )
    assert said(description, "URDF has no lights: `lamp`") == 7
    assert said(description, "`ball_joint` became three revolute joints") == 10
    assert said(description, "universal joint `cross_joint` became two") == 11
    assert said(description, "`loop` is not in the URDF: it closes a kinematic chain") == 12
    assert said(description, "URDF does not have screw joints") == 13
    robot = ET.fromstring(description.text)
    masses = {
        str(one.get("name")): float(one.find("inertial/mass").get("value") or 0)  # type: ignore[union-attr]
        for one in robot.findall("link")
    }
    assert masses["ball_joint_x_link"] == masses["cross_joint_cross"] == 0.01  # of 1 kg
    (loose,) = [one for one in robot.findall("joint") if one.get("type") == "fixed"]
    assert loose.find("child").get("link") == "bolt"  # type: ignore[union-attr]


def test_sensors_and_plugins_are_kept(tmp_path: Path) -> None:
    description = same(
        write(
            tmp_path,
            "\n".join(
                (
                    '<frame name="mount" attached_to="arm"><pose>0 0 0.5 0 0 0</pose></frame>',
                    link("base"),
                    link(
                        "arm",
                        "0 0 1 0 0 0",
                        '<sensor name="eye" type="camera">'
                        '<pose relative_to="mount">1 0 0 0 0 0</pose><camera name="a">'
                        "<image><width>640</width></image></camera></sensor>"
                        "<kinematic>true</kinematic><self_collide>true</self_collide>",
                    ),
                    joint(
                        "revolute",
                        "base",
                        "arm",
                        f"{AXIS.format('')}<sensor name='force' type='force_torque'/>",
                        "0 0 -0.2 0 0 0",
                    ),
                    (
                        '<plugin name="drive" filename="libdrive.so"><joint>arm_joint</joint>'
                        "<a b='&lt;'>1 &lt; 2<!-- not this --></a><gz:b>3</gz:b>"
                        "<i:c xmlns:i='http://ignitionrobotics.org/schema'/></plugin>"
                    ),
                )
            ),
        )
    )
    robot = ET.fromstring(description.text)
    eye = robot.find("gazebo[@reference='arm']/sensor")
    assert eye is not None
    # The frame of the link is at the joint, 0.2 m below its own.
    assert eye.findtext("pose") == "1 0 0.7 0 0 0"
    assert eye.findtext("camera/image/width") == "640"
    force = robot.find("gazebo[@reference='arm_joint']/sensor")
    assert force is not None
    plugin = robot.find("gazebo/plugin")
    assert plugin is not None
    assert plugin.attrib == {"name": "drive", "filename": "libdrive.so"}
    a = plugin.find("a")
    assert a is not None
    assert (a.text, a.get("b")) == ("1 < 2", "<")
    assert "<gz:b xmlns:gz=" in description.text
    assert "<ignition:c xmlns:ignition=" in description.text
    assert robot.findtext("gazebo[@reference='arm']/selfCollide") == "true"
    assert robot.findtext("gazebo[@reference='arm']/kinematic") == "true"
    mount = robot.find("joint[@name='mount_fixed']/origin")
    assert mount is not None
    assert mount.get("xyz") == "0 0 0.7"


def test_models_in_models_have_names_of_urdf(tmp_path: Path) -> None:
    hand = tmp_path / "models" / "hand"
    hand.mkdir(parents=True)
    (hand / "model.config").write_text("<model><sdf version='1.9'>hand.sdf</sdf></model>")
    (hand / "hand.sdf").write_text(
        f"""<sdf version="1.9"><model name="hand" placement_frame="finger">{link("palm")}
{link("finger", "0 0.1 0 0 0 0.5")}{joint("revolute", "palm", "finger", AXIS.format(LIMIT))}
<plugin name="p" filename="p"><joint_name>finger_joint</joint_name></plugin></model></sdf>"""
    )
    description = same(
        write(
            tmp_path,
            f"""{link("palm_1")}{link("base", "0 0 0.5 0 0 0")}
<include><uri>model://hand</uri><name>left</name>
<pose relative_to="base">0 1 0 0 0 1</pose></include>
<model name="right"><pose>0 -1 0 0 0 0</pose>{link("palm")}</model>
<joint name="a" type="fixed"><parent>base</parent><child>left::palm</child></joint>
<joint name="b" type="fixed"><parent>base</parent><child>right::palm</child></joint>
<joint name="c" type="fixed"><parent>palm_1</parent><child>base</child></joint>
<plugin name="p" filename="p"><joint>left::finger_joint</joint></plugin>""",
        )
    )
    robot = ET.fromstring(description.text)
    assert [one.get("name") for one in robot.findall("link")] == [
        *("palm_1", "base", "left_palm", "left_finger", "right_palm"),
    ]
    assert "left_finger_joint" in [one.text for one in robot.iter("joint")]


def test_shapes_colors_and_surfaces(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "part.stl").write_bytes(binary_stl())
    (tmp_path / "two.obj").write_text(
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no left\nf 1 2 3\no right\nf 1 2 4\n"
    )
    shapes = {
        "box": "<box><size>1 2 3</size></box>",
        "capsule": "<capsule><radius>0.1</radius><length>0.5</length></capsule>",
        "ellipsoid": "<ellipsoid><radii>0.1 0.2 0.3</radii></ellipsoid>",
        "mesh": "<mesh><uri>meshes/part.stl</uri><scale>0.1 0.1 0.1</scale></mesh>",
        "part": "<mesh><uri>two.obj</uri><submesh><name>right</name></submesh></mesh>",
        "lost": "<mesh><uri>nowhere.stl</uri></mesh>",
    }
    parts = [
        f'<visual name="{name}"><geometry>{shape}</geometry>'
        "<material><diffuse>1 0 0 1</diffuse></material></visual>"
        for name, shape in shapes.items()
    ]
    surface = "<surface><friction><ode><mu>0.4</mu><mu2>0.3</mu2></ode></friction></surface>"
    collision = f'<collision name="c"><geometry>{shapes["box"]}</geometry>{surface}</collision>'
    description = same(
        write(tmp_path, f"<static>true</static>\n{link('a', more=''.join(parts) + collision)}")
    )
    robot = ET.fromstring(description.text)
    found = [one[0].tag for one in robot.iterfind("link/visual/geometry")]
    assert found == ["box", "cylinder", "sphere", "sphere", *["mesh"] * 4]
    names = [one.get("filename") for one in robot.iterfind("link/visual/geometry/mesh")]
    assert names == ["ellipsoid.stl", "part.stl", "two_right.stl", "nowhere.stl"]
    assert set(description.meshes) == set(names[:3])
    assert isinstance(description.meshes["part.stl"], type(tmp_path))
    right = description.meshes["two_right.stl"]
    assert isinstance(right, bytes)
    assert int.from_bytes(right[80:84], "little") == 1
    assert said(description, "`nowhere.stl`") == 7
    assert robot.findtext("gazebo[@reference='a']/mu2") == "0.3"
    assert robot.findtext("gazebo/static") == "true"


@pytest.mark.slow
@pytest.mark.skipif(IGN is None, reason="needs Gazebo's parser")
def test_the_parser_of_gazebo_makes_the_same_of_it(tmp_path: Path) -> None:
    parts = (
        '<link name="base"/>',
        *(link(name) for name in ("a", "b", "c")),
        joint("ball", "base", "a"),
        joint("universal", "a", "b", "<axis/><axis2><xyz>0 1 0</xyz></axis2>"),
        joint("fixed", "b", "c"),
    )
    description = same(write(tmp_path, "\n".join(parts)))
    file = tmp_path / "cart.urdf"
    file.write_text(description.text)
    model = model_of(file, tmp_path)
    assert model is not None
    masses = [float(one.text or 0) for one in model.iter("mass")]
    assert sum(masses) == pytest.approx(7)
    names = [one.get("name") for one in model.findall("link")]
    assert names == ["base", "a_joint_x_link", "a_joint_y_link", "a", "b_joint_cross", "b"]


def test_the_folder_of_a_model(tmp_path: Path) -> None:
    (tmp_path / "model.config").write_text(
        "<model><sdf version='1.5'>old.sdf</sdf><sdf version='1.9'>model.sdf</sdf></model>"
    )
    write(tmp_path, link("a"))
    description = read_sdf_model(tmp_path)
    assert description.name == "cart"
    assert description.file == tmp_path / "model.sdf"


BAD: dict[str, tuple[str, type[WsgenError], str]] = {
    "not XML": ('<sdf version="1.9"><model></sdf>', NotReadableError, "model.sdf:1: "),
    "empty": ("", NotReadableError, "model.sdf"),
    "a world": (
        f'<sdf version="1.9"><world name="w"><model name="a">{link("a")}</model></world></sdf>',
        RequestError,
        "is a world",
    ),
    "without links": ('<sdf version="1.9"><model name="a"/></sdf>', NotReadableError, "a link"),
    "itself": (
        '<sdf version="1.9"><model name="a"><include><uri>model.sdf</uri></include></model></sdf>',
        NotReadableError,
        "includes itself",
    ),
    "entities": (
        '<!DOCTYPE a [<!ENTITY a "aaa">]><sdf version="1.9"><model name="&a;"/></sdf>',
        NotReadableError,
        "entities",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_files_have_a_message(tmp_path: Path, case: str) -> None:
    text, kind, words = BAD[case]
    file = tmp_path / "model.sdf"
    file.write_text(text)
    with pytest.raises(kind) as raised:
        read_sdf_model(file)
    assert words in raised.value.message
    assert raised.value.hint


def test_files_that_are_not_there(tmp_path: Path) -> None:
    with pytest.raises(NotFoundError, match=re.escape("no model.config")):
        read_sdf_model(tmp_path)
    with pytest.raises(NotReadableError, match="No such file"):
        read_sdf_model(tmp_path / "model.sdf")
    include = "<include><uri>model://nowhere</uri></include>"
    with pytest.raises(NotFoundError, match=re.escape("model.sdf:3: The model `model://nowhere`")):
        read_sdf_model(write(tmp_path, include))
