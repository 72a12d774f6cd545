"""Which files of a package describe a robot."""

from pathlib import Path

from wsgen.workspace.robot_files import find_robot_files

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
