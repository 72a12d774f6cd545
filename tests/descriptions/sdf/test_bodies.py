"""Links of SDF: masses, shapes, surfaces and colors."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from wsgen.diagnostics import Severity
from wsgen.model.robot import Box, Capsule, Cylinder, Inertial, Link, Mesh, Sphere, Surface
from wsgen.model.transform import Pose

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.descriptions.sdf.models import SdfFile
    from wsgen.model.robot import Geometry

    Read = Callable[..., SdfFile]

MASS = "<inertial><mass>2</mass></inertial>"
BOX = "<geometry><box><size>1 1 1</size></box></geometry>"


def link_of(file: SdfFile) -> Link:
    assert file.diagnostics == ()
    robot = file.models[0].robot
    assert robot is not None
    return robot.links[0]


def model(content: str) -> str:
    return f'<model name="m"><link name="l">\n{content}</link></model>'


def test_inertial(read: Read) -> None:
    link = link_of(
        read(
            model(
                "<inertial><pose>1 2 3 0.1 0 0</pose><mass>4</mass><inertia><ixx>2</ixx>"
                "<ixy>0.1</ixy><iyy>3</iyy><izz>4</izz></inertia></inertial>"
            )
        )
    )
    assert link.inertial == Inertial(
        mass=4, pose_in_link=Pose((1, 2, 3), (0.1, 0, 0)), inertia=(2, 0.1, 0, 3, 0, 4)
    )


def test_what_is_not_said_about_the_mass_is_1(read: Read) -> None:
    expected = Inertial(mass=1, inertia=(1, 0, 0, 1, 0, 1))
    assert link_of(read(model("<inertial><mass/></inertial>"))).inertial == expected
    file = read(model(""))
    # It is a warning in a robot alone.
    assert [(found.code, found.severity) for found in file.diagnostics] == [
        ("WLD035", Severity.INFO)
    ]
    joint = '<joint name="j" type="fixed"><parent>l</parent><child>arm</child></joint>'
    whole = read(f'<model name="m"><link name="l"/><link name="arm"/>{joint}</model>')
    assert {found.severity for found in whole.diagnostics} == {Severity.WARNING}
    robot = file.models[0].robot
    assert robot is not None
    assert robot.links[0].inertial == expected


def test_inertia_from_the_collisions(read: Read) -> None:
    box = (
        '<collision name="{}"><pose>{}</pose><geometry><box><size>1 1 2</size></box></geometry>'
        "<density>{}</density></collision>"
    )
    content = '<inertial auto="true"><density>{}</density>{}</inertial>' + box.format(
        "a", "0 0 1 0 0 0", 100
    )
    whole = link_of(read(model(content.format(5, "")), "1.11")).inertial
    assert whole is not None
    assert (whole.mass, whole.pose_in_link) == (200, Pose((0, 0, 1)))
    assert whole.inertia == pytest.approx((250 / 3, 0, 0, 250 / 3, 0, 100 / 3))
    content += box.format("b", "0 0 -1 0 0 0", 100)
    halves = link_of(read(model(content.format(5, "<mass>4</mass>")), "1.12")).inertial
    assert halves is not None
    assert halves.mass == pytest.approx(4)
    assert halves.pose_in_link == Pose()
    # One body of 1 × 1 × 4 m.
    assert halves.inertia == pytest.approx((17 / 3, 0, 0, 17 / 3, 0, 2 / 3))
    early = read(model(content.format(5, "<mass>4</mass>")), "1.9").models[0].robot
    assert early is not None
    assert early.links[0].inertial == Inertial(mass=4, inertia=(1, 0, 0, 1, 0, 1))


@pytest.mark.parametrize(
    ("shape", "volume"),
    [
        ("<sphere><radius>2</radius></sphere>", 32 / 3 * math.pi),
        ("<cylinder><radius>2</radius><length>3</length></cylinder>", 12 * math.pi),
        ("<capsule><radius>3</radius><length>1</length></capsule>", 45 * math.pi),
    ],
)
def test_mass_from_the_collisions(read: Read, shape: str, volume: float) -> None:
    content = f'<collision name="a"><geometry>{shape}</geometry></collision>'
    link = link_of(read(model(f'<inertial auto="true"/>{content}'), "1.11"))
    assert link.inertial is not None
    assert link.inertial.mass == pytest.approx(1000 * volume)


def test_no_inertia_comes_from_a_mesh(read: Read, models: Path) -> None:
    (models.parent / "x.stl").touch()
    mesh = '<collision name="a"><geometry><mesh><uri>x.stl</uri></mesh></geometry></collision>'
    file = read(model(f'<inertial auto="true"/>{mesh}'), "1.11")
    assert [found.code for found in file.diagnostics] == ["WLD040"]


def test_nobody_weighs_what_is_static(read: Read) -> None:
    assert read('<model name="m"><static>1</static><link name="l"/></model>').diagnostics == ()


@pytest.mark.parametrize(
    ("shape", "expected"),
    [
        ("<box><size>1 2 3</size></box>", Box(size=(1, 2, 3))),
        ("<box/>", Box(size=(1, 1, 1))),
        ("<sphere><radius>2</radius></sphere>", Sphere(radius=2)),
        (
            "<cylinder><radius>2</radius><length>3</length></cylinder>",
            Cylinder(radius=2, length=3),
        ),
        ("<capsule/>", Capsule(radius=0.5, length=1)),
    ],
)
def test_shapes(read: Read, shape: str, expected: Geometry) -> None:
    geometry = f"<geometry>{shape}</geometry>"
    link = link_of(
        read(
            model(
                f'{MASS}<collision name="c">{geometry}</collision>'
                f'<visual name="v">{geometry}</visual>'
            )
        )
    )
    assert link.collisions[0].geometry == expected
    assert link.visuals[0].geometry == expected
    assert (link.collisions[0].name, link.visuals[0].name) == ("c", "v")


@pytest.mark.parametrize(
    "uri",
    ["meshes/hull.stl", "model://boat/hull.stl", "package://boat/hull.stl", "file://{file}"],
)
def test_meshes(read: Read, models: Path, uri: str) -> None:
    for file in (models / "boat" / "hull.stl", models.parent / "meshes" / "hull.stl"):
        file.parent.mkdir()
        file.touch()
    uri = uri.format(file=models / "boat" / "hull.stl")
    mesh = f"<geometry><mesh><uri>{uri}</uri><scale>1 2 3</scale></mesh></geometry>"
    link = link_of(read(model(f'{MASS}<collision name="c">{mesh}</collision>')))
    place = models.parent / "meshes" if uri.startswith("meshes") else models / "boat"
    assert link.collisions[0].geometry == Mesh(
        uri=uri, scale=(1, 2, 3), path=str(place / "hull.stl")
    )


def test_a_part_of_a_mesh(read: Read, models: Path) -> None:
    (models.parent / "car.obj").touch()
    part = "<submesh><name>door</name><center>true</center></submesh>"
    mesh = f"<geometry><mesh><uri>car.obj</uri>{part}</mesh></geometry>"
    link = link_of(read(model(f'{MASS}<visual name="v">{mesh}</visual>')))
    assert isinstance(link.visuals[0].geometry, Mesh)
    assert link.visuals[0].geometry.part == ("door", True)


@pytest.mark.parametrize("uri", ["no.stl", "model://no/x.stl", "https://x/y.stl", "", "a" * 500])
@pytest.mark.parametrize(
    ("tag", "code", "severity"),
    [("collision", "ROB060", Severity.ERROR), ("visual", "ROB061", Severity.WARNING)],
)
def test_meshes_that_are_not_there(
    read: Read, tag: str, uri: str, code: str, severity: Severity
) -> None:
    mesh = f"<geometry><mesh><uri>{uri}</uri></mesh></geometry>"
    file = read(model(f'{MASS}<{tag} name="c">{mesh}</{tag}><{tag} name="d">{mesh}</{tag}>'))
    (found,) = file.diagnostics  # one for both
    assert (found.code, found.severity, found.line) == (code, severity, 3)
    assert f"`{uri}`" in found.message
    assert "link `l`" in found.message


def test_a_mirrored_mesh_can_be_seen_but_not_touched(read: Read, models: Path) -> None:
    (models.parent / "x.stl").touch()
    mesh = "<geometry><mesh><uri>x.stl</uri><scale>1 -1 1</scale></mesh></geometry>"
    assert link_of(read(model(f'{MASS}<visual name="v">{mesh}</visual>'))).visuals
    file = read(model(f'{MASS}<collision name="c">{mesh}</collision>'))
    assert [found.code for found in file.diagnostics] == ["ROB151"]


def test_surface(read: Read) -> None:
    link = link_of(
        read(
            model(
                f'{MASS}<collision name="c">{BOX}<max_contacts>4</max_contacts><surface><friction>'
                "<ode><mu>0.5</mu><mu2>0.4</mu2></ode></friction><contact><ode><kp>1e6</kp>"
                "<kd>2</kd><min_depth>0.001</min_depth></ode></contact></surface></collision>"
                f'<collision name="d">{BOX}</collision>'
            )
        )
    )
    assert link.collisions[0].surface == Surface(
        mu1=0.5, mu2=0.4, kp=1e6, kd=2, min_depth=0.001, max_contacts=4
    )
    assert link.collisions[1].surface == Surface()


def test_laser_retro(read: Read) -> None:
    retro = "<laser_retro>{}</laser_retro>"
    file = read(
        model(
            f'{MASS}<collision name="c">{BOX}{retro.format(200)}</collision>'
            f'<visual name="v">{BOX}{retro.format(30)}</visual>'
            f'<visual name="w">{BOX}{retro.format("much")}</visual>'
        )
    )
    made = file.models[0].robot
    assert made is not None
    (link,) = made.links
    assert link.collisions[0].laser_retro == 200.0
    assert [visual.laser_retro for visual in link.visuals] == [30.0, 0.0]
    assert "<laser_retro> needs 1 finite number" in file.diagnostics[0].message


@pytest.mark.parametrize(
    ("material", "rgba"),
    [
        ("", None),
        (
            "<material><diffuse>1 0.5 0 1</diffuse><ambient>0 0 0 1</ambient></material>",
            (1, 0.5, 0, 1),
        ),
        ("<material><ambient>0 1 0</ambient></material>", (0, 1, 0, 1)),
        ("<material><script><name>Gazebo/Green</name></script></material>", (0, 1, 0, 1)),
        ("<material><script><name>Mine/Own</name></script></material>", None),
        ("<material><diffuse>2 -1 0 1</diffuse></material>", (1, 0, 0, 1)),
        (
            "<material><diffuse>1 1 1 1</diffuse></material><transparency>0.25</transparency>",
            (1, 1, 1, 0.75),
        ),
    ],
)
def test_colors(read: Read, material: str, rgba: tuple[float, ...] | None) -> None:
    link = link_of(read(model(f'{MASS}<visual name="v">{BOX}{material}</visual>')))
    assert link.visuals[0].rgba == rgba


SIZED = (
    f'{MASS}<visual name="c"><geometry><{{0}}><radius>{{1}}</radius></{{0}}></geometry></visual>'
)
ERROR, WARNING = Severity.ERROR, Severity.WARNING


@pytest.mark.parametrize(
    ("content", "code", "severity"),
    [
        ("<inertial><mass>-1</mass></inertial>", "ROB022", ERROR),
        ("<inertial><mass>0</mass></inertial>", "WLD041", WARNING),
        ("<inertial><mass>nan</mass></inertial>", "ROB016", ERROR),
        ("<inertial><mass>1,5</mass></inertial>", "ROB016", ERROR),
        ("<inertial><mass>1_5</mass></inertial>", "ROB016", ERROR),
        ("<inertial><inertia><izz>3</izz></inertia></inertial>", "ROB037", ERROR),
        ("<inertial><inertia><izz>-1</izz></inertia></inertial>", "ROB037", ERROR),
        ("<inertial><pose>0 0 0</pose></inertial>", "ROB016", ERROR),
        ('<inertial><pose relative_to="l">0 0 0 0 0 0</pose></inertial>', "WLD020", WARNING),
        (f"{MASS}<pose>1e300 0 0 0 0 0</pose>", "ROB016", ERROR),
        (f'{MASS}<pose rotation_format="quat_xyzw">0 0 0 0 0 0 0</pose>', "ROB016", ERROR),
        (f'{MASS}<pose rotation_format="matrix">0 0 0 0 0 0</pose>', "ROB016", ERROR),
        (f"{MASS}<gravity>perhaps</gravity>", "ROB016", ERROR),
        (f"{MASS}<collision>{BOX}</collision>", "ROB006", ERROR),
        (f'{MASS}<collision name="c"/>', "ROB024", WARNING),
        (f'{MASS}<collision name="c"><geometry/></collision>', "ROB024", WARNING),
        (
            f'{MASS}<collision name="c">{BOX}</collision><collision name="c">{BOX}</collision>',
            "WLD015",
            ERROR,
        ),
        (f'{MASS}<visual name="c">{BOX.replace("1 1 1", "0 1 1")}</visual>', "ROB028", WARNING),
        (SIZED.format("sphere", -1), "ROB028", ERROR),
        (SIZED.format("cylinder", "1e300"), "WLD034", ERROR),
        (
            f'{MASS}<collision name="c"><geometry><image/></geometry></collision>',
            "WLD031",
            WARNING,
        ),
        (
            f'{MASS}<collision name="c">{BOX}<pose relative_to="k">0 0 0 0 0 0</pose></collision>',
            "WLD020",
            WARNING,
        ),
    ],
)
def test_what_is_wrong_with_a_link(read: Read, content: str, code: str, severity: Severity) -> None:
    file = read(model(content))
    (found,) = file.diagnostics
    assert (found.code, found.severity, found.line) == (code, severity, 3)
    assert found.hint
    assert found.element is not None
    assert found.element.startswith("/sdf/model[@name='m']/link[@name='l']")
    assert file.models[0].robot is not None
