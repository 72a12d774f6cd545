"""What becomes of package.xml, to the letter."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.fixes.source import SourceText, apply
from wsgen.model.target import Target
from wsgen.porting.manifests import port_manifest

JAZZY = Target(distro="jazzy", simulator="gz")
HEAD = """<?xml version="1.0"?>
<package format="3">
  <name>r</name>
  <buildtool_depend>ament_cmake</buildtool_depend>
"""
TAIL = """  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""


def ported(
    text: str,
    needs: tuple[str, ...] = (),
    *,
    file: Path = Path("/nowhere/package.xml"),
    has_models: bool = False,
    workspace: tuple[str, ...] = (),
    target: Target = JAZZY,
) -> tuple[str, list[str]]:
    """The text afterwards, which a second port leaves as it is, and what is listed."""

    def port(before: str) -> tuple[str, list[str]]:
        found = port_manifest(
            SourceText(file, before),
            target,
            frozenset(needs),
            workspace=workspace,
            has_models=has_models,
        )
        return apply(before, found.edits), [f"{one.line}: {one.what}" for one in found.unported]

    after, listed = port(text)
    again = port(after)
    assert again[0] == after
    assert len(again[1]) == len(listed)
    return after, listed


@pytest.mark.parametrize(
    ("before", "needs", "after"),
    [
        pytest.param(
            "  <exec_depend>gazebo_ros</exec_depend>  <!-- the simulator -->\n",
            (),
            "  <exec_depend>ros_gz_sim</exec_depend>  <!-- the simulator -->\n",
            id="the tag and the comment stay",
        ),
        pytest.param(
            "  <exec_depend>gazebo_ros</exec_depend>\n"
            "  <exec_depend>gazebo_plugins</exec_depend>\n"
            "  <exec_depend>xacro</exec_depend>\n",
            (),
            "  <exec_depend>ros_gz_sim</exec_depend>\n  <exec_depend>xacro</exec_depend>\n",
            id="no duplicates",
        ),
        pytest.param(
            "  <exec_depend>gazebo_plugins</exec_depend>\n  <depend>gazebo_ros</depend>\n",
            ("ros_gz_sim",),
            "  <depend>ros_gz_sim</depend>\n",
            id="catkin_pkg refuses a depend beside an exec_depend",
        ),
        pytest.param(
            "  <exec_depend>gazebo_ros</exec_depend>\n  <exec_depend>ros_gz_sim</exec_depend>\n",
            (),
            "  <exec_depend>ros_gz_sim</exec_depend>\n",
            id="a package for both simulators",
        ),
        pytest.param(
            "  <build_depend>gazebo_ros</build_depend>\n  <exec_depend>gazebo_ros</exec_depend>\n",
            ("ros_gz_sim", "ros_gz_bridge"),
            "  <build_depend>ros_gz_sim</build_depend>\n"
            "  <exec_depend>ros_gz_sim</exec_depend>\n"
            "  <exec_depend>ros_gz_bridge</exec_depend>\n",
            id="what is needed is added",
        ),
        pytest.param(
            "  <depend>gazebo_ros</depend>\n"
            "  <exec_depend>xacro</exec_depend>\n"
            "  <exec_depend>gazebo</exec_depend>\n"
            "  <exec_depend>gazebo_plugins</exec_depend>\n",
            ("ros_gz_sim", "ros_gz_bridge"),
            "  <depend>ros_gz_sim</depend>\n"
            "  <exec_depend>xacro</exec_depend>\n"
            "  <exec_depend>ros_gz_bridge</exec_depend>\n",
            id="what is added comes behind what stays",
        ),
        pytest.param(
            "  <exec_depend>gazebo_ros_pkgs</exec_depend>\n"
            "  <exec_depend>gazebo_ros2_control</exec_depend>\n",
            ("ros_gz_sim", "ros_gz_bridge", "r"),
            "  <exec_depend>ros_gz</exec_depend>\n  <exec_depend>gz_ros2_control</exec_depend>\n",
            id="ros_gz brings them, and the package itself is there",
        ),
        pytest.param(
            '  <exec_depend condition="$ROS_DISTRO == humble">gazebo_ros</exec_depend>\n'
            '  <exec_depend condition="$ROS_DISTRO != humble">ros_gz_sim</exec_depend>\n',
            ("ros_gz_sim",),
            '  <exec_depend condition="$ROS_DISTRO == humble">gazebo_ros</exec_depend>\n'
            '  <exec_depend condition="$ROS_DISTRO != humble">ros_gz_sim</exec_depend>\n',
            id="what is for another distribution stays",
        ),
        pytest.param(
            "  <exec_depend>gazebo_msgs</exec_depend>\n"
            "  <exec_depend>velodyne_gazebo_plugins</exec_depend>\n"
            "  <!-- <exec_depend>gazebo_ros</exec_depend> -->\n",
            (),
            "  <!-- <exec_depend>gazebo_ros</exec_depend> -->\n",
            id="what nothing uses goes, and comments stay",
        ),
        pytest.param(
            "  <exec_depend>joint_state_controller</exec_depend>\n"
            "  <test_depend>gazebo_ros</test_depend>\n",
            (),
            "  <exec_depend>joint_state_broadcaster</exec_depend>\n"
            "  <test_depend>ros_gz_sim</test_depend>\n",
            id="renamed packages of ROS",
        ),
    ],
)
def test_dependencies(before: str, needs: tuple[str, ...], after: str) -> None:
    assert ported(HEAD + before + TAIL, needs) == (HEAD + after + TAIL, [])
    dos = (HEAD + before + TAIL).replace("\n", "\r\n")
    assert ported(dos, needs)[0] == (HEAD + after + TAIL).replace("\n", "\r\n")


def test_what_the_target_lacks_is_listed() -> None:
    """The rest is as before, also what only the workspace has."""
    text = f"{HEAD}  <exec_depend>ros1_bridge</exec_depend>\n  <depend>gazebo_ros</depend>\n{TAIL}"
    assert ported(text, workspace=("gazebo_ros",)) == (
        text,
        ["5: The dependency `ros1_bridge` is not released for ROS 2 jazzy."],
    )


LISTED = (
    "5: The messages of `gazebo_msgs` are for services of Gazebo Classic, which spawn.py calls."
)


def test_messages_that_code_uses(tmp_path: Path) -> None:
    (tmp_path / "spawn.py").write_text("from gazebo_msgs.srv import SpawnEntity\n")
    text = f"{HEAD}  <exec_depend>gazebo_msgs</exec_depend>\n{TAIL}"
    assert ported(text, file=tmp_path / "package.xml") == (
        text,
        [LISTED],
    )


@pytest.mark.parametrize(
    ("exported", "after"),
    [
        pytest.param(
            "",
            '    <gazebo_ros gazebo_model_path="${prefix}/.."/>\n',
        ),
        (
            '    <gazebo_ros plugin_path="${prefix}/lib" gazebo_model_path="${prefix}/../"/>\n',
            '    <gazebo_ros plugin_path="${prefix}/lib" gazebo_model_path="${prefix}/../"/>\n',
        ),
        pytest.param(
            '    <gazebo_ros gazebo_model_path="${prefix}/models"/>\n',
            '    <gazebo_ros gazebo_model_path="${prefix}/.."/>\n'
            '    <gazebo_ros gazebo_model_path="${prefix}/models"/>\n',
            id="another folder",
        ),
    ],
)
def test_the_folder_of_meshes(exported: str, after: str) -> None:
    """gz_sim.launch.py reads this export of all packages, as gazebo.launch.py does."""
    text = HEAD + TAIL
    place = "  <export>\n"
    assert ported(text.replace(place, place + exported), has_models=True) == (
        text.replace(place, place + after),
        [],
    )
