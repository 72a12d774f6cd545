"""Which files of a package describe a robot."""

from pathlib import Path

from wsgen.packages.workspace.robot_files import find_descriptions, find_robot_files

XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def test_robots_that_no_file_includes(tmp_path: Path) -> None:
    files = {
        "a/robot.urdf": '<robot name="r"><link name="l"/></robot>',
        "top.urdf.xacro": f'<robot {XACRO} name="t"><xacro:include filename="core.xacro"/></robot>',
        "core.xacro": '<robot name="core"><link name="l"/></robot>',
        "macros.xacro": f'<robot {XACRO} name="m"><xacro:arg name="a" default="1"/>'
        '<xacro:macro name="leg"><link name="l"/></xacro:macro></robot>',
        "nameless.xacro": f'<robot {XACRO}><link name="l"/></robot>',
        "calls.xacro": f'<robot\n  {XACRO}\n  name="c"><xacro:leg/></robot>',
        "comment.xacro": '<!-- <robot name="x"><link name="l"/> --><robot/>',
        "notes.txt": '<robot name="r"><link name="l"/></robot>',
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(text)
    (tmp_path / "folder.urdf").mkdir()
    found = [file.relative_to(tmp_path).as_posix() for file in find_robot_files(tmp_path)]
    assert found == ["a/robot.urdf", "calls.xacro", "top.urdf.xacro"]


def test_build_in_the_package_itself(tmp_path: Path) -> None:
    for name in ("robot.urdf", "install/p/share/p/robot.urdf", "old/install/p/robot.urdf"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text('<robot name="r"><link name="l"/></robot>')
    (tmp_path / "install/p/share/p/room.world").write_text("<sdf/>")
    (tmp_path / "install/COLCON_IGNORE").touch()
    (tmp_path / "old/install/.colcon_install_layout").touch()
    assert [file.name for file in find_descriptions(tmp_path)] == ["robot.urdf"]
    assert find_robot_files(tmp_path) == (tmp_path / "robot.urdf",)
    assert len(find_robot_files(tmp_path / "install")) == 1  # it is asked for
