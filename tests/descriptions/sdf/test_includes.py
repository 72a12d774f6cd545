"""Models that are included from other files."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from wsgen.descriptions.sdf.lookup import model_finder
from wsgen.descriptions.sdf.models import read_sdf
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.robot import Link, Robot
from wsgen.pipeline.prepare import share_on_model_path

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.descriptions.sdf.models import SdfFile

    Read = Callable[..., SdfFile]

MASS = "<inertial><mass>2</mass></inertial>"
LINK = f'<link name="l">{MASS}<pose>0 0 1 0 0 0</pose></link>'
GROUND = "<include><uri>model://ground_plane</uri></include>"


def write_model(folder: Path, content: str, version: str = "1.9", name: str = "model.sdf") -> None:
    folder.mkdir(exist_ok=True, parents=True)
    (folder / name).write_text(f'<sdf version="{version}">\n{content}</sdf>', encoding="utf-8")


def world(content: str) -> str:
    return f'<world name="w">{GROUND}\n{content}</world>'


def test_name_pose_and_static_of_the_include(read: Read, models: Path) -> None:
    write_model(models / "crate", f'<model name="crate"><pose>9 9 9 0 0 0</pose>{LINK}</model>')
    file = read(
        world(
            "<include><uri>model://crate</uri></include>"
            "<include><uri>model://crate</uri><name>other</name><pose>1 0 0 0 0 0</pose>"
            "<static>true</static></include>"
        )
    )
    assert file.diagnostics == ()
    assert [(one.name, one.pose_in_world.xyz, one.is_static) for one in file.models] == [
        ("crate", (9, 9, 10), False),
        ("other", (1, 0, 1), True),
    ]
    assert {(one.file, one.line) for one in file.models} == {(models / "crate" / "model.sdf", 2)}
    assert file.world is not None
    assert [(one.name, one.uri) for one in file.world.models] == [
        ("ground_plane", "model://ground_plane"),
        ("crate", "model://crate"),
        ("other", "model://crate"),
    ]


def test_an_include_may_make_a_static_model_movable(read: Read, models: Path) -> None:
    write_model(models / "m", f'<model name="m"><static>1</static>{LINK}</model>')
    uri = "<uri>model://m</uri>"
    file = read(world(f"<include>{uri}<static>0</static></include>"))
    assert [one.is_static for one in file.models] == [False]


def test_placement_frame_of_the_include(read: Read, models: Path) -> None:
    write_model(models / "m", f'<model name="m">{LINK}</model>')
    uri = "<uri>model://m</uri><pose>0 0 5 0 0 0</pose><placement_frame>l</placement_frame>"
    file = read(world(f"<include>{uri}</include>"))
    assert file.models[0].pose_in_world.xyz == (0, 0, 5)


def test_model_config_names_the_file(read: Read, models: Path) -> None:
    folder = models / "m"
    write_model(folder, f'<model name="old">{LINK}</model>', "1.4", "old.sdf")
    write_model(folder, f'<model name="new">{LINK}</model>', "1.10", "new.sdf")
    (folder / "model.config").write_text(
        '<model><sdf version="1.4">old.sdf</sdf><sdf version="1.10">new.sdf</sdf></model>'
    )
    file = read(world("<include><uri>model://m</uri></include>"))
    assert [one.name for one in file.models] == ["new"]


@pytest.mark.parametrize("uri", ["parts/m", "parts/m/model.sdf", "file://{models}/m"])
def test_paths(read: Read, models: Path, uri: str) -> None:
    for folder in (models, models.parent / "parts"):
        folder.mkdir(exist_ok=True, parents=True)
        write_model(folder / "m", f'<model name="m">{LINK}</model>')
    file = read(world(f"<include><uri>{uri.format(models=models)}</uri></include>"))
    assert file.diagnostics == ()
    assert [one.name for one in file.models] == ["m"]


def test_meshes_are_seen_from_the_file_that_names_them(read: Read, models: Path) -> None:
    mesh = "<geometry><mesh><uri>m.stl</uri></mesh></geometry>"
    link = f'<link name="l">{MASS}<visual name="v">{mesh}</visual></link>'
    write_model(models / "m", f'<model name="m">{link}</model>')
    (models / "m" / "m.stl").touch()
    file = read(world("<include><uri>model://m</uri></include>"))
    assert file.diagnostics == ()


def test_include_in_a_model(read: Read, models: Path) -> None:
    write_model(models / "hand", f'<model name="hand">{LINK}</model>', "1.6")
    file = read(
        f'<model name="m"><link name="base">{MASS}</link><include><uri>model://hand</uri>'
        '<name>left</name><pose relative_to="base">0 1 0 0 0 0</pose></include>'
        '<joint name="j" type="fixed"><parent>base</parent><child>left::l</child></joint></model>'
    )
    assert file.diagnostics == ()
    robot = file.models[0].robot
    assert robot is not None
    assert [(one.child, one.pose_in_parent.xyz) for one in robot.joints] == [("left::l", (0, 1, 1))]


def test_merged_include(read: Read, models: Path) -> None:
    hand = f'{LINK}<frame name="tip" attached_to="l"/>'
    write_model(models / "hand", f'<model name="hand">{hand}</model>')
    file = read(
        f'<model name="m"><link name="base">{MASS}</link><include merge="true">'
        "<uri>model://hand</uri><pose>0 1 0 0 0 0</pose></include>"
        '<joint name="j" type="fixed"><parent>base</parent><child>tip</child></joint></model>'
    )
    assert file.diagnostics == ()
    robot = file.models[0].robot
    assert robot is not None
    assert [(one.child, one.pose_in_parent.xyz) for one in robot.joints] == [("l", (0, 1, 1))]


@pytest.mark.parametrize(
    ("include", "link", "codes"),
    [
        ('<include merge="true"><uri>model://lost</uri></include>', "base", ["WLD004"]),
        ("<include><uri>model://lost</uri></include>", "lost::base", ["WLD004"]),
        ("<include><uri>lost</uri><name>n</name></include>", "n::base", ["WLD004"]),
        # Its own file may call it so.
        ("<include><uri>model://lost</uri></include>", "lost_base::base", ["WLD004"]),
        (
            "<include><uri>lost</uri><name>n</name></include>",
            "lost::base",
            ["ROB013", "WLD004", "WLD016"],
        ),
        ("<include><uri>model://lost</uri></include>", "base", ["ROB013", "WLD004", "WLD016"]),
        ("", "base", ["ROB013", "WLD016"]),
    ],
)
def test_what_a_model_that_is_not_found_may_have(
    read: Read, models: Path, include: str, link: str, codes: list[str]
) -> None:
    models.mkdir(exist_ok=True)
    file = read(
        f'<model name="m"><link name="l"><pose relative_to="{link}">0 0 1 0 0 0</pose>{MASS}</link>'
        f'<joint name="j" type="fixed"><parent>{link}</parent><child>l</child></joint>'
        f"{include}</model>"
    )
    assert sorted({found.code for found in file.diagnostics}) == codes


def test_a_merged_link_needs_its_own_name(read: Read, models: Path) -> None:
    hand = (
        f'{LINK}<link name="k">{MASS}</link>'
        '<joint name="j" type="fixed"><parent>l</parent><child>k</child></joint>'
    )
    write_model(models / "hand", f'<model name="hand">{hand}</model>')
    file = read(
        f'<model name="m">{LINK}<include merge="true"><uri>model://hand</uri></include></model>'
    )
    assert [found.code for found in file.diagnostics] == ["WLD015"]
    robot = file.models[0].robot
    assert robot is not None
    assert ([link.name for link in robot.links], robot.joints) == (["l", "k"], ())


@pytest.mark.parametrize(
    ("include", "severity"),
    [
        ("<uri>model://nowhere</uri>", Severity.WARNING),
        ("<uri>model://empty</uri>", Severity.WARNING),
        ("<uri>model://../models</uri>", Severity.WARNING),
        ("<uri>model://urdf</uri>", Severity.WARNING),
        ("<uri>https://fuel.gazebosim.org/1.0/someone/models/Tree</uri>", Severity.WARNING),
        ("<uri>no/such/file.sdf</uri>", Severity.WARNING),
        (f"<uri>{'x' * 5000}</uri>", Severity.WARNING),
        ("", Severity.ERROR),
    ],
)
def test_what_cannot_be_had(read: Read, models: Path, include: str, severity: Severity) -> None:
    (models / "empty").mkdir()
    (models / "urdf").mkdir()
    (models / "urdf" / "r.urdf").write_text('<robot name="r"/>')
    (models / "urdf" / "model.config").write_text("<model><sdf>r.urdf</sdf></model>")
    file = read(world(f"<include>{include}</include>"))
    (found,) = file.diagnostics
    assert (found.code, found.severity, found.line) == ("WLD004", severity, 3)
    assert file.models == ()
    inside = read(f'<model name="m">{LINK}\n<include>{include}</include></model>')
    (found,) = inside.diagnostics
    assert (found.code, found.severity, found.line) == ("WLD004", Severity.ERROR, 3)
    assert inside.models[0].robot is not None
    # What is static stands without it: the scenery of TurtleBot3 is such a model.
    scenery = f'<model name="m"><static>1</static>\n<include>{include}</include></model>'
    (found, *_) = read(world(scenery)).diagnostics
    assert (found.code, found.severity) == ("WLD004", severity)


@pytest.mark.parametrize("uri", ["/home/ada/ws/models/box", "file:///home/ada/ws/models/box"])
def test_a_path_of_another_machine(read: Read, uri: str) -> None:
    mesh = f"<mesh><uri>{uri}/box.stl</uri></mesh>"
    collision = f"<collision name='c'><geometry>{mesh}</geometry></collision>"
    file = read(
        world(
            f"<include><uri>{uri}</uri></include>"
            f"<model name='m'><link name='l'>{collision}</link></model>"
        )
    )
    hints = {found.code: found.hint or "" for found in file.diagnostics}
    assert "Other machines do not have this path." in hints["WLD004"]
    assert "Other machines do not have this path." in hints["ROB060"]


def test_a_special_file_is_not_read(read: Read, models: Path) -> None:
    (models / "m").mkdir()
    os.mkfifo(models / "m" / "model.sdf")
    file = read(world("<include><uri>model://m/model.sdf</uri></include>"))
    assert [found.code for found in file.diagnostics] == ["WLD004"]
    assert "model.sdf is a named pipe" in file.diagnostics[0].message
    (models / "n").mkdir()
    os.mkfifo(models / "n" / "model.config")
    file = read(world("<include><uri>model://n</uri></include>"))
    assert "model.config is a named pipe" in file.diagnostics[0].message


def test_lights_and_actors_are_nothing_to_touch(read: Read, models: Path) -> None:
    write_model(models / "lamp", '<light name="lamp" type="point"/>')
    assert read(world("<include><uri>model://lamp</uri></include>")).diagnostics == ()


def test_a_broken_model_is_reported_with_its_own_file(read: Read, models: Path) -> None:
    (models / "m").mkdir()
    (models / "m" / "model.sdf").write_text("<sdf>\n<model>\n</sdf>")
    file = read(world("<include><uri>model://m</uri></include>"))
    assert [(found.code, found.file, found.line) for found in file.diagnostics] == [
        ("ROB001", models / "m" / "model.sdf", 2),
        ("WLD004", models.parent / "scene.sdf", 3),
    ]


def test_what_is_wrong_in_a_model_is_said_once(read: Read, models: Path) -> None:
    write_model(models / "m", '<model name="m"><link name="l"/></model>')
    include = "<include><uri>model://m</uri><name>{}</name></include>"
    file = read(world("".join(map(include.format, "abc"))))
    assert len(file.models) == 3
    assert [(found.code, found.file) for found in file.diagnostics] == [
        ("WLD035", models / "m" / "model.sdf")
    ]


def test_a_circle_of_includes(read: Read, models: Path) -> None:
    for name, other in ("ab", "ba"):
        content = f"{LINK}<include><uri>model://{other}</uri></include>"
        write_model(models / name, f'<model name="{name}">{content}</model>')
    file = read(world("<include><uri>model://a</uri></include>"))
    (found,) = file.diagnostics
    assert (found.code, found.severity) == ("WLD019", Severity.ERROR)
    assert "a/model.sdf → b/model.sdf → a/model.sdf" in found.message
    robot = file.models[0].robot
    assert robot is not None
    assert [link.name for link in robot.links] == ["l", "b::l"]


@pytest.mark.slow
def test_a_ladder_of_includes(read: Read, models: Path) -> None:
    for i in range(300):
        content = f"{LINK}<include><uri>model://m{i + 1}</uri></include>"
        write_model(models / f"m{i}", f'<model name="m">{content}</model>')
    file = read(world("<include><uri>model://m0</uri></include>"))
    (found,) = file.diagnostics
    assert found.code == "WLD014"
    assert found.file is not None
    assert found.file.parent.name == "m50"


def test_the_folders_around_the_file_are_searched(tmp_path: Path) -> None:
    package = tmp_path / "package"
    (package / "worlds").mkdir(parents=True)
    (package / "models").mkdir()
    write_model(package / "models" / "m", f'<model name="m">{LINK}</model>')
    file = package / "worlds" / "w.world"
    file.write_text(f'<sdf version="1.6">{world("<include><uri>model://m</uri></include>")}</sdf>')
    found = read_sdf(file, find_model=model_finder(file, {}))
    assert found.diagnostics == ()
    assert [one.name for one in found.models] == ["m"]


def test_a_robot_of_urdf(tmp_path: Path, models: Path) -> None:
    folder = models / "arm"
    folder.mkdir()
    (folder / "arm.urdf").write_text('<robot name="arm"><link name="l"/></robot>')
    (folder / "model.config").write_text("<model><sdf>arm.urdf</sdf></model>")
    uri = "<uri>model://arm</uri>"
    file = tmp_path / "w.sdf"
    file.write_text(
        '<sdf version="1.9">'
        + world(
            f"<include>{uri}<pose>1 0 0 0 0 0</pose></include>"
            f"<include>{uri}<name>b</name><static>1</static></include>"
            f'<frame name="f" attached_to="arm"/>'
        )
        + "</sdf>"
    )
    asked = []
    finding = Diagnostic(name="some-rule", code="ROB016", severity=Severity.WARNING, message="?")

    def read_robot(urdf: Path) -> tuple[Robot, tuple[Diagnostic, ...]]:
        asked.append(urdf)
        return Robot(name="arm", root="l", links=(Link(name="l"),)), (finding,)

    find = model_finder(file, {"GAZEBO_MODEL_PATH": str(models)})
    found = read_sdf(file, find_model=find, read_robot=read_robot)
    assert found.diagnostics == (finding,)
    assert asked == [folder / "arm.urdf"]
    assert [
        (one.name, one.robot and one.robot.name, one.pose_in_world.xyz, one.is_static)
        for one in found.models
    ] == [("arm", "arm", (1, 0, 0), False), ("b", "b", (0, 0, 0), True)]
    assert [one.robot and one.robot.is_static for one in found.models] == [False, True]
    (left_out,) = read_sdf(file, find_model=find).diagnostics  # nothing about the frame on it
    assert left_out.code == "WLD004"
    assert "arm.urdf is a URDF" in left_out.message


def test_a_robot_of_urdf_that_cannot_be_read(read: Read, models: Path) -> None:
    (models / "arm").mkdir()
    (models / "arm" / "arm.urdf").write_text('<robot name="arm"/>')
    content = world("<include><uri>model://arm/arm.urdf</uri></include>")
    file = models.parent / "scene.sdf"
    read(content)
    found = read_sdf(
        file,
        find_model=model_finder(file, {"GAZEBO_MODEL_PATH": str(models)}),
        read_robot=lambda _: (None, ()),
    )
    assert [(one.name, one.robot) for one in found.models] == [("arm", None)]


def test_a_name_that_no_folder_can_have(tmp_path: Path) -> None:
    file = tmp_path / "w.sdf"
    content = world(f"<include><uri>model://{'x' * 9999}</uri></include>")
    file.write_text(f'<sdf version="1.9">{content}</sdf>')

    def find_model(uri: str) -> Path | None:
        os.stat(uri.partition("://")[2])  # noqa: PTH116  raises, as pathlib does before Python 3.14
        return None

    found = read_sdf(file, find_model=find_model)
    assert [one.code for one in found.diagnostics] == ["WLD004"]


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("groundplane", "ground_plane"),
        ("sn", "sun"),
        ("caffe_table", "cafe_table"),
        ("crat", "crate"),
    ],
)
def test_a_misspelled_model(read: Read, models: Path, name: str, meant: str) -> None:
    write_model(models / "crate", f'<model name="crate">{LINK}</model>')
    (models / "crate" / "model.config").write_text("<model><sdf>model.sdf</sdf></model>")
    (found,) = read(world(f"<include><uri>model://{name}</uri></include>")).diagnostics
    assert (found.code, found.severity, found.line) == ("WLD004", Severity.WARNING, 3)
    assert found.hint == f"Did you mean `model://{meant}`?"


def test_a_misspelled_ground_is_the_one_error_of_a_world_without_ground(read: Read) -> None:
    file = read('<world name="w">\n<include><uri>model://groundplane</uri></include></world>')
    (found,) = file.diagnostics
    assert (found.code, found.severity, found.line) == ("WLD004", Severity.ERROR, 3)
    assert found.hint == "Did you mean `model://ground_plane`?"
    assert "no ground; the simulation uses `model://ground_plane`" in found.message
    assert file.world is not None
    assert file.world.has_ground_plane  # so that what is spawned is not said to fall as well


BOWL = """<model name="bowl"><link name="l"><inertial><mass>0.1</mass></inertial>
<collision name="c"><geometry><mesh><uri>model://bowl/meshes/bowl.dae</uri></mesh></geometry></collision>
</link></model>"""


def test_models_of_gazebos_database_are_one_line(read: Read) -> None:
    include = "<include><uri>model://{}</uri></include>"
    part = f'<model name="m">{include.format("table")}</model>'
    content = include.format("cafe_table") + include.format("coke_can") + part + BOWL
    file = read(f'<world name="w">{content}</world>')
    (found,) = file.diagnostics
    assert (found.code, found.severity) == ("WLD062", Severity.INFO)
    assert "cafe_table, coke_can, table, bowl." in found.message
    # Nothing falls, and what only Gazebo has may be the ground.
    assert [model.name for model in file.models if model.robot is not None] == []
    assert file.world is not None
    assert file.world.has_ground_plane


def test_a_model_that_is_found_is_not_left_to_gazebo(read: Read, models: Path) -> None:
    (models / "bowl").mkdir()
    file = read(f'<world name="w">{BOWL}</world>')
    assert "ROB060" in {found.code for found in file.diagnostics}


def test_a_model_whose_include_is_left_out_has_no_missing_link(read: Read) -> None:
    include = "<include><uri>model://nosuch</uri></include>"
    file = read(f'<world name="w"><model name="m">{include}</model></world>')
    assert [found.code for found in file.diagnostics] == ["WLD004"]
    assert file.world is not None
    assert file.world.has_ground_plane  # what is not found may be the ground


def test_a_model_that_only_wraps_what_is_static_is_static(read: Read, models: Path) -> None:
    write_model(models / "wall", f'<model name="wall"><static>true</static>{LINK}</model>')
    wrapped = '<model name="m"><include><uri>model://wall</uri></include>{}</model>'
    (model,) = read(f'<world name="w">{GROUND}{wrapped.format("")}</world>').models
    assert model.is_static
    assert model.robot is not None
    assert model.robot.is_static
    with_own = read(f'<world name="w">{GROUND}{wrapped.format(LINK)}</world>')
    assert [found.code for found in with_own.diagnostics] == ["WLD048"]


def test_a_relative_address_in_the_folders_of_models(read: Read, models: Path) -> None:
    write_model(models / "wall", f'<model name="wall">{LINK}</model>')
    (models.parent / "worlds").mkdir()
    file = read(f'<world name="w">{GROUND}<include><uri>models/wall</uri></include></world>')
    assert file.diagnostics == ()
    world = models.parent / "worlds" / "w.sdf"
    include = f'<world name="w">{GROUND}<include><uri>wall</uri></include></world>'
    world.write_text(f'<sdf version="1.9">{include}</sdf>')
    found = read_sdf(world, find_model=model_finder(world, {"GZ_SIM_RESOURCE_PATH": str(models)}))
    assert found.diagnostics == ()
    assert [model.name for model in found.models] == ["wall"]


@pytest.mark.parametrize("is_exported", [True, False])
def test_a_file_in_a_folder_for_resources(tmp_path: Path, is_exported: bool) -> None:
    share = tmp_path / "install" / "share" / "hull"
    write_model(share / "models" / "wall", f'<model name="wall">{LINK}</model>')
    share.joinpath("package.xml").write_text(
        '<package><export><gazebo_ros gazebo_media_path="/none:${prefix}"/></export></package>'
    )
    world = tmp_path / "w.sdf"
    include = "<include><uri>file://models/wall/model.sdf</uri></include>"
    world.write_text(f'<sdf version="1.9"><world name="w">{GROUND}{include}</world></sdf>')
    environment = {"AMENT_PREFIX_PATH": str(tmp_path / "install")}
    if not is_exported:
        share.joinpath("package.xml").unlink()
        environment["GAZEBO_RESOURCE_PATH"] = f"/none:{share}"
    found = read_sdf(world, find_model=model_finder(world, environment))
    assert found.diagnostics == ()
    assert [model.name for model in found.models] == ["wall"]
    assert share_on_model_path(environment)("models") == share / "models"
