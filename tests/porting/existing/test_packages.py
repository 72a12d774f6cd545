"""A robot that exists becomes a package in one command: its files, its names, what is reported."""

# ruff: noqa: E501  elements as people write them

import json
import re
import shutil
import zipfile
from pathlib import Path
from typing import Any

import pytest

from existing_robots import ARM, cube_stl, write_arm
from wsgen.cli import run
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.text import tomlfile

pytestmark = pytest.mark.slow


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty current folder."""
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    folder = tmp_path / "here"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def new(source: Path | str, *options: str, name: str = "my_arm") -> int:
    maintainer = ("--maintainer-name", "Ada", "--maintainer-email", "ada@example.com")
    return run(["new", name, "--from", str(source), "--distro", "jazzy", *maintainer, *options])


def made(here: Path, name: str = "my_arm") -> Path:
    return here / "ws_gazebo" / "src" / name


def files(folder: Path) -> set[str]:
    return {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}


def test_a_package_of_ros_1(here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    write_arm(tmp_path)
    assert new(tmp_path / "arm_description") == 0
    package = made(here)
    assert files(package) >= {
        "CMakeLists.txt",
        "LICENSE",
        "README.md",
        "config/bridge.yaml",
        "config/robot.rviz",
        "launch/display.launch.py",
        "launch/gazebo_model.launch.py",
        "meshes/base_part.stl",
        "meshes/cube.mtl",
        "meshes/cube.obj",
        "meshes/textures/red.png",
        "model/empty_world.world",
        "model/robot.xacro",
        "package.xml",
        "test/test_robot.py",
        "urdf/arm.urdf",
        "wsgen.toml",
    }
    assert "model/inertia.xacro" not in files(package)
    text = (package / "urdf" / "arm.urdf").read_text()
    # Nothing but the names of the files is different.
    renamed = ARM.replace("base part.stl", "base_part.stl").replace("arm_description", "my_arm")
    assert text == renamed
    assert (package / "meshes" / "base_part.stl").read_bytes() == cube_stl()
    assert '<license file="LICENSE">MIT<' in (package / "package.xml").read_text()
    assert re.search(r"DIRECTORY .*meshes.* urdf", (package / "CMakeLists.txt").read_text())
    output = capsys.readouterr()
    assert re.search(
        r"poses of links in 10 random configurations +up to 0 m or rad apart +same", output.out
    )
    assert "different" not in output.out
    assert "Renamed the file `base part.stl` to meshes/base_part.stl." in output.err


LAUNCH = """\
<launch>
  <arg name="model" default="$(find arm_description)/urdf/arm.urdf"/>
  <param name="robot_description" textfile="$(find arm_description)/urdf/arm.urdf"/>
  <include file="$(find gazebo_ros)/launch/empty_world.launch"/>
  <node pkg="robot_state_publisher" type="robot_state_publisher" name="rsp"/>
  <node pkg="rviz" type="rviz" name="rviz" args="-d $(find arm_description)/gone.rviz"/>
  <node pkg="gazebo_ros" type="spawn_model" name="s" args="-urdf -param robot_description -model a"/>
  <node pkg="arm_description" type="driver" name="driver"/>
</launch>
"""


def test_the_launch_files_of_ros_1(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """They start the same in ROS 2; the package has what they name, and passes."""
    source = write_arm(tmp_path).parents[1]
    for name, text in {
        "launch/display.launch": LAUNCH,
        "launch/more.launch": "<launch/>",
        "config/a.yaml": "file: package://arm_description/x\n",
        "CMakeLists.txt": "find_package(catkin REQUIRED)\nadd_executable(driver src/driver.cpp)\n",
        "scripts/help": "#!/bin/sh\n",
    }.items():
        (source / name).parent.mkdir(exist_ok=True)
        (source / name).write_text(text)
    assert new(source) == 0
    package = made(here)
    assert {"launch/display.launch.py", "launch/more.launch.py", "scripts/help"} <= files(package)
    assert not [one for one in files(package) if one.endswith(".launch")]
    assert (package / "config" / "a.yaml").read_text() == "file: package://my_arm/x\n"
    assert "PROGRAMS scripts/help" in (package / "CMakeLists.txt").read_text()
    output = capsys.readouterr()
    assert "display.launch:8: The program `driver` of arm_description is compiled" in output.err
    assert "CMakeLists.txt:2: `add_executable` compiles the program `driver`" in output.err
    assert "Ported the launch files of ROS 1: launch/display.launch.py" in output.err
    assert "The program `driver`" in (package / "README.md").read_text().replace("\\", "")
    assert run(["check", str(package), "--distro", "jazzy"]) == 0
    assert "warning[LCH" not in capsys.readouterr().out
    assert run(["launch", str(package / "launch" / "display.launch.py"), "--format", "json"]) == 0
    plan = json.loads(capsys.readouterr().out)
    started = {one["executable"]: one for one in plan["processes"]}
    assert set(started) == {"parameter_bridge", "robot_state_publisher", "rviz2", "create"}
    assert started["create"]["arguments"] == ["-topic", "robot_description", "-name", "my_arm"]
    assert started["rviz2"]["arguments"][1].endswith("my_arm/config/robot.rviz")
    again = new(package, name="again")
    assert again == 0
    assert (made(here, "again") / "launch" / "display.launch.py").is_file()


@pytest.mark.parametrize("is_packed", [False, True])
def test_the_same_from_a_file_and_from_a_zip(here: Path, tmp_path: Path, is_packed: bool) -> None:
    urdf = write_arm(tmp_path)
    source = urdf
    if is_packed:
        source = tmp_path / "arm.zip"
        with zipfile.ZipFile(source, "w") as archive:
            for file in urdf.parents[1].rglob("*"):
                archive.write(file, file.relative_to(tmp_path))
    assert new(source) == 0
    assert "meshes/textures/red.png" in files(made(here))


def test_builds_and_is_checked_and_stands(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_arm(tmp_path)
    assert new(tmp_path / "arm_description", "--validate", "-q") == 0
    shutil.rmtree(tmp_path / "arm_description")  # the package needs nothing of it
    assert run(["check", str(made(here))]) == 0
    report = capsys.readouterr().out
    assert "error[" not in report


XACRO = """<?xml version="1.0"?>
<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="rover">
  <xacro:arg name="wheels" default="2"/>
  <xacro:include filename="$(find rover_description)/urdf/parts/wheel.xacro"/>
  <link name="body">
    <visual><geometry><mesh filename="file://$(find rover_description)/meshes/body.stl"/></geometry></visual>
    <xacro:mass m="3"/>
  </link>
  <xacro:wheel number="1"/>
  <xacro:if value="${int('$(arg wheels)') > 1}"><xacro:wheel number="2"/></xacro:if>
</robot>
"""
WHEEL = """<robot xmlns:xacro="http://www.ros.org/wiki/xacro">
  <!-- what weighs m -->
  <xacro:macro name="mass" params="m"><inertial><mass value="${m}"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></xacro:macro>
  <xacro:macro name="wheel" params="number">
    <link name="wheel_${number}">
      <visual><geometry><mesh filename="package://rover_description/meshes/${'wheel'}.stl"/></geometry></visual>
      <xacro:mass m="1"/>
    </link>
    <joint name="axle_${number}" type="continuous"><parent link="body"/><child link="wheel_${number}"/>
      <origin xyz="${number} 0 0"/><axis xyz="0 1 0"/></joint>
  </xacro:macro>
</robot>
"""


def write_rover(folder: Path) -> Path:
    package = folder / "rover_description"
    (package / "urdf" / "parts").mkdir(parents=True)
    (package / "meshes").mkdir()
    (package / "package.xml").write_text(
        "<package><name>rover_description</name><license>Custom</license></package>"
    )
    (package / "urdf" / "rover.urdf.xacro").write_text(XACRO)
    (package / "urdf" / "parts" / "wheel.xacro").write_text(WHEEL)
    for name in ("body", "wheel"):
        (package / "meshes" / f"{name}.stl").write_bytes(cube_stl())
    return package


def robot_in(capsys: pytest.CaptureFixture[str]) -> dict[str, Any]:
    robot: dict[str, Any] = json.loads(capsys.readouterr().out)["robot"]
    return robot


def test_macros_are_kept(here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new(write_rover(tmp_path), "--format", "json") == 0
    robot = robot_in(capsys)
    assert robot["same"] is True
    assert robot["notes"][0] == "Kept the xacro files (2) with the macros."
    package = made(here)
    text = (package / "urdf" / "rover.urdf.xacro").read_text()
    mesh = XACRO.replace("file://$(find rover_description)/meshes", "package://my_arm/meshes")
    assert text == mesh.replace("find rover_description", "find my_arm")
    wheel = (package / "urdf" / "parts" / "wheel.xacro").read_text()
    assert wheel == WHEEL.replace("rover_description", "my_arm")
    # The license is that of the source, which wsgen does not have.
    assert 'LICENSE">Custom<' in (package / "package.xml").read_text()
    assert "`Custom`" in (package / "LICENSE").read_text()


def test_warnings_of_xacro_stop_no_launch(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    package = write_rover(tmp_path)
    main = package / "urdf" / "rover.urdf.xacro"
    pi = '<xacro:property name="pi" value="3.14"/></robot>'
    main.write_text(main.read_text().replace("</robot>", pi))
    assert new(package) == 0
    assert "Kept the xacro files" in capsys.readouterr().err
    assert run(["check", "ws_gazebo"]) == 0
    assert "refused-by-launch" not in capsys.readouterr().out


def test_arguments_are_kept(here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert new(write_rover(tmp_path), "--arg", "wheels:=1", "--format", "json") == 0
    rows = {row["aspect"]: row for row in robot_in(capsys)["comparison"]}
    assert (rows["links"]["source"], rows["links"]["package"]) == ("2", "2")
    assert (
        '<xacro:arg name="wheels" default="1"/>'
        in (made(here) / "model" / "robot.xacro").read_text()
    )


def test_packages_beside_the_given_one_are_found(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By xacro, too: many arms include the materials of a package of all arms."""
    package = write_rover(tmp_path)
    include = '<robot xmlns:xacro="x"><xacro:include filename="$(find {0})/{0}.xacro"/></robot>'
    (package / "urdf" / "parts" / "wheel.xacro").write_text(include.format("wheels"))
    for name, text in (("wheels", include.format("masses")), ("masses", WHEEL)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "package.xml").write_text(f"<package><name>{name}</name></package>")
        (tmp_path / name / f"{name}.xacro").write_text(text)
    assert new(package, "--format", "json") == 0
    robot = robot_in(capsys)
    assert robot["same"] is True
    assert "without its macros" in robot["notes"][0]
    assert [file.name for file in (made(here) / "urdf").iterdir()] == ["rover.urdf"]


def test_what_includes_others_is_expanded(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    package = write_rover(tmp_path)
    outside = tmp_path / "wheel.xacro"
    (package / "urdf" / "parts" / "wheel.xacro").rename(outside)
    main = package / "urdf" / "rover.urdf.xacro"
    main.write_text(XACRO.replace("$(find rover_description)/urdf/parts/wheel.xacro", str(outside)))
    assert new(package, "--format", "json") == 0
    robot = robot_in(capsys)
    assert robot["same"] is True
    assert "without its macros: wheel.xacro is not of the source" in robot["notes"][0]
    read, _ = read_urdf((made(here) / "urdf" / "rover.urdf").read_text(), file=None)
    assert read is not None
    assert [one.name for one in read.links] == ["body", "wheel_1", "wheel_2"]


def test_files_outside_are_copied_if_asked(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "robot"
    folder.mkdir()
    (tmp_path / "elsewhere.stl").write_bytes(cube_stl())
    text = ARM.replace(
        "package://arm_description/meshes/base part.stl", str(tmp_path / "elsewhere.stl")
    )
    (folder / "arm.urdf").write_text(
        re.sub(
            r"<(visual|collision)>\s*(<origin[^>]*>)?\s*<geometry>\s*<mesh filename=.package.*?</\1>",
            "",
            text,
            flags=re.DOTALL,
        )
    )
    assert new(folder / "arm.urdf") == 2
    error = capsys.readouterr().err
    assert "elsewhere.stl" in error
    assert "--copy-outside" in error
    assert not [*here.iterdir()]
    assert new(folder / "arm.urdf", "--copy-outside") == 0
    assert "meshes/elsewhere.stl" in files(made(here))
    assert "look at their license" in capsys.readouterr().err


def test_a_mesh_that_is_missing(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    urdf = write_arm(tmp_path)
    (urdf.parents[1] / "meshes" / "cube.obj").unlink()
    assert new(urdf) == 4
    assert (
        "the mesh `package://arm_description/meshes/cube.obj` does not exist"
        in capsys.readouterr().err
    )
    assert not [*here.iterdir()]


def test_names_that_exclude_each_other(here: Path, tmp_path: Path) -> None:
    """Two packages with a mesh of the same name, and one that differs in case."""
    urdf = write_arm(tmp_path)
    other = tmp_path / "arm_description" / "more"
    (other / "meshes").mkdir(parents=True)
    (other / "package.xml").write_text("<package><name>more</name></package>")
    (other / "meshes" / "CUBE.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    urdf.write_text(ARM.replace("arm_description/meshes/base part.stl", "more/meshes/CUBE.obj"))
    assert new(tmp_path / "arm_description" / "urdf" / "arm.urdf") == 0
    meshes = [name for name in files(made(here)) if name.endswith(".obj")]
    assert len({name.casefold() for name in meshes}) == len(meshes) == 2


BROKEN = (
    ("", 4),
    ("<robot", 4),
    ("<robot name='r'/>", 4),
    ("<robot name='r'><link name='a'/><link name='a'/></robot>", 4),
    ("<robot name='r'><link name='a'/><link name='b'/></robot>", 4),
    ("<robot name='r' xmlns:xacro='x'><xacro:nothing/></robot>", 4),
)


@pytest.mark.parametrize(("text", "code"), BROKEN)
def test_what_is_no_robot(
    text: str, code: int, here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "r.urdf").write_text(text)
    assert new(tmp_path / "r.urdf") == code
    error = capsys.readouterr().err
    assert "Traceback" not in error
    assert "try: " in error
    assert not [*here.iterdir()]


def test_options_without_a_source(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["new", "a_robot", "--copy-outside"]) == 2
    assert "Add --from PATH" in capsys.readouterr().err
    assert run(["new", "a_robot", "--from", "x", "-t", "arm"]) == 2
    assert "--template cannot be combined with --from" in capsys.readouterr().err
    assert not [*here.iterdir()]


def test_a_dry_run_writes_nothing(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert new(write_arm(tmp_path), "--dry-run") == 0
    assert "my_arm/meshes/cube.mtl" in capsys.readouterr().out
    assert not [*here.iterdir()]


def test_expressions_of_a_urdf_are_texts(here: Path, tmp_path: Path) -> None:
    """In a URDF they are none, but xacro includes it."""
    urdf = write_arm(tmp_path)
    urdf.write_text(
        ARM.replace("</robot>", "<gazebo><note>${x} and $(find y)</note></gazebo></robot>")
    )
    assert new(urdf) == 1  # Gazebo reads the note, which the source has, too
    assert "$${x} and $$(find y)" in (made(here) / "urdf" / "arm.urdf").read_text()


@pytest.mark.parametrize("start", ["\n\n<?xml version='1.0'?>", "<?xml version='0.0' ?>", "\ufeff"])
def test_declarations_that_only_gazebo_reads(start: str, here: Path, tmp_path: Path) -> None:
    urdf = write_arm(tmp_path)
    urdf.write_text(ARM.replace('<?xml version="1.0"?>', start))
    assert new(urdf) == 0


def test_other_encodings_become_utf_8(here: Path, tmp_path: Path) -> None:
    urdf = write_arm(tmp_path)
    text = ARM.replace('version="1.0"', 'version="1.0" encoding="ISO-8859-1"').replace(
        'name="two', 'name="für zwei'
    )
    urdf.write_bytes(text.encode("latin-1"))
    assert new(urdf) == 0
    assert "für zwei" in (made(here) / "urdf" / "arm.urdf").read_text(encoding="utf-8")


def test_limits_that_the_port_of_a_drive_changes(
    here: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its plugin for Gazebo Classic turned the wheels without them."""
    urdf = write_arm(tmp_path)
    wheel = re.search(r'<link name="upper">.*?</link>', ARM, re.DOTALL)
    assert wheel is not None
    parts = "".join(
        f"""<joint name="{side}" type="continuous"><origin xyz="0 {y} 0"/><parent link="base"/>
        <child link="{side}_wheel"/><axis xyz="0 1 0"/><limit effort="1" velocity="2"/></joint>"""
        + wheel[0].replace('"upper"', f'"{side}_wheel"')
        for side, y in (("left", 0.2), ("right", -0.2))
    )
    plugin = """<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <leftJoint>left</leftJoint><rightJoint>right</rightJoint><wheelTorque>5</wheelTorque>
      <wheelSeparation>0.4</wheelSeparation><wheelDiameter>0.1</wheelDiameter>
      <robotBaseFrame>base</robotBaseFrame></plugin></gazebo></robot>"""
    urdf.write_text(ARM.replace("</robot>", parts + plugin))
    assert new(urdf, "--format", "json") == 0
    robot = robot_in(capsys)
    row = next(one for one in robot["comparison"] if one["aspect"].startswith("limits"))
    assert not row["same"]
    assert any("Set <limit> of left, right to what the drive" in one for one in robot["notes"])


def test_what_was_asked_for_is_recorded(here: Path, tmp_path: Path) -> None:
    source = write_arm(tmp_path).parents[1]
    options = ("--sensor", "imu:upper", "--control", "position", "--bolted")
    assert new(source, *options) == 0
    recorded = tomlfile.load(made(here) / "wsgen.toml")["answers"]
    assert recorded == {
        "control": "position",
        "from": str(source),
        "sensors": ["imu:upper"],
        "bolted": True,
    }


def test_addresses_with_a_slash_too_many(here: Path, tmp_path: Path) -> None:
    """xacro makes them of `file://$(find …)/…`."""
    file = write_arm(tmp_path)
    folder = file.parents[1]
    text = file.read_text().replace("package://arm_description", f"file:///{folder}")
    file.write_text(text)
    assert new(folder) == 0
    assert {"meshes/base_part.stl", "meshes/cube.obj"} <= files(made(here))
