from pathlib import Path

import pytest

from wsgen.live.messages import messages_of, messages_of_plugins
from wsgen.pipeline.plan_launch import select_launch_file
from wsgen.simulation.live_scene import SCENE_FILE

MANIFEST = """\
<package format="3"><name>demo</name><version>0.0.0</version><description>D</description>
<maintainer email="a@example.com">A</maintainer><license>MIT</license>
<exec_depend>sensor_msgs</exec_depend></package>
"""


def test_messages_that_nobody_declares_are_found(tmp_path: Path) -> None:
    files = {
        "package.xml": MANIFEST,
        "CMakeLists.txt": "project(demo)\nfind_package(moveit_msgs REQUIRED)\n",
        "scripts/drive": "from ackermann_msgs.msg import AckermannDrive\n",
        "config/bridge.yaml": "- ros_type_name: ros_gz_interfaces/msg/Contacts\n",
        "launch/a.launch.py": "def generate_launch_description(): pass\n",
        "src/node.cpp": "#include <control_msgs/msg/pid_state.hpp>\n",
    }
    for name, text in files.items():
        file = tmp_path / "src" / "demo" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    path = str(tmp_path / "src" / "demo" / "launch" / "a.launch.py")
    with select_launch_file((path,), str(tmp_path)) as selected:
        assert messages_of(selected) == {"sensor_msgs", "ackermann_msgs", "ros_gz_interfaces"}


@pytest.mark.parametrize(
    ("plugin", "messages"),
    [
        ("libgazebo_ros2_control.so", {"control_msgs", "controller_manager_msgs"}),
        ("gz_ros2_control-system", {"control_msgs", "controller_manager_msgs"}),
        ("libgazebo_ros_bumper.so", {"gazebo_msgs"}),
        ("libgazebo_ros_diff_drive.so", set()),
    ],
)
def test_plugins(plugin: str, messages: set[str], tmp_path: Path) -> None:
    assert messages_of_plugins(tmp_path) == frozenset()
    (tmp_path / SCENE_FILE).write_text(f'{{"filename": "{plugin}"}}')
    assert messages_of_plugins(tmp_path) == messages
