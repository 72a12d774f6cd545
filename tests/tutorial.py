"""The tutorial's package as somebody leaves it who types every file as printed.

The four files are cut out of the tutorial's text, which lies beside the checkout where the project
is developed; `package.xml` and `CMakeLists.txt` are what `ros2 pkg create` (Iron) writes, with the
lines that the tutorial's step 6 adds.
"""

from pathlib import Path

TEXT = Path(__file__).parents[2] / "shared" / "tutorial.txt"

PACKAGE_XML = """\
<?xml version="1.0"?>
<?xml-model href="http://download.ros.org/schema/package_format3.xsd" \
schematypens="http://www.w3.org/2001/XMLSchema"?>
<package format="3">
  <name>gazebo_test</name>
  <version>0.0.0</version>
  <description>TODO: Package description</description>
  <maintainer email="follower@todo.todo">follower</maintainer>
  <license>TODO: License declaration</license>

  <buildtool_depend>ament_cmake</buildtool_depend>

  <exec_depend>joint_state_publisher</exec_depend>
  <exec_depend>robot_state_publisher</exec_depend>
  <exec_depend>gazebo_ros</exec_depend>
  <exec_depend>xacro</exec_depend>

  <test_depend>ament_lint_auto</test_depend>
  <test_depend>ament_lint_common</test_depend>

  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""

CMAKE = """\
cmake_minimum_required(VERSION 3.8)
project(gazebo_test)

if(CMAKE_COMPILER_IS_GNUCXX OR CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  add_compile_options(-Wall -Wextra -Wpedantic)
endif()

# find dependencies
find_package(ament_cmake REQUIRED)

install(
  DIRECTORY launch model
  DESTINATION share/${PROJECT_NAME}
)

if(BUILD_TESTING)
  find_package(ament_lint_auto REQUIRED)
  set(ament_cmake_copyright_FOUND TRUE)
  set(ament_cmake_cpplint_FOUND TRUE)
  ament_lint_auto_find_test_dependencies()
endif()

ament_package()
"""


def write_tutorial(root: Path) -> Path:
    """Type the tutorial's workspace below `root`; returns the workspace."""
    text = TEXT.read_text(encoding="utf-8")
    workspace = root / "ws_gazebo"
    package = workspace / "src" / "gazebo_test"
    for folder in ("launch", "model", "src", "include/gazebo_test"):
        (package / folder).mkdir(parents=True)
    (package / "package.xml").write_text(PACKAGE_XML)
    (package / "CMakeLists.txt").write_text(CMAKE)
    files = {
        "model/robot.xacro": _cut(text, '<?xml version="1.0"?>\n<robot xmlns', "</robot>"),
        "model/robot.gazebo": _cut(text, '<?xml version="1.0"?>\n<robot>', "</robot>"),
        "model/empty_world.world": _cut(text, '<?xml version="1.0" ?>', "</sdf>"),
        "launch/gazebo_model.launch.py": _cut(
            text, "import os\nfrom ament", "return launchDescriptionObject\n"
        ),
    }
    for name, content in files.items():
        (package / name).write_text(content)
    return workspace


def _cut(text: str, start: str, end: str) -> str:
    """The text from `start` to the next `end`, both included."""
    begin = text.index(start)
    return text[begin : text.index(end, begin) + len(end)].rstrip("\n") + "\n"
