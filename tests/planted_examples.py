"""How the examples of the rules' documentation are planted into sound packages.

An example shows only what its rule is about. Here is what stands around it: `@` is the place of the
example, an ellipsis in it stands for what `dots` gives, and `<link name="arm"/>` for a link with a
body.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

Files = dict[str, "str | None"]  # path in the package -> text; None: the file is not there

# Of a package for Gazebo Sim on Jazzy, and for Gazebo Classic on Humble.
DEPENDENCIES = {
    "jazzy": (
        "controller_manager",
        "diff_drive_controller",
        "gz_ros2_control",
        "joint_state_broadcaster",
        "joint_state_publisher",
        "joint_trajectory_controller",
        "robot_state_publisher",
        "ros_gz_bridge",
        "ros_gz_sim",
        "rviz2",
        "xacro",
    ),
    "fortress": (
        "robot_state_publisher",
        "ros_gz_bridge",
        "ros_gz_sim",
        "rviz2",
        "xacro",
    ),
    "humble": (
        "controller_manager",
        "gazebo_ros",
        "gazebo_ros2_control",
        "robot_state_publisher",
        "rviz2",
        "xacro",
    ),
}
CONTROL_PLUGIN = (
    '<gazebo><plugin filename="gz_ros2_control-system" '
    'name="gz_ros2_control::GazeboSimROS2ControlPlugin">'
    "<parameters>$(find my_robot)/config/controllers.yaml</parameters></plugin></gazebo>"
)
CONTROLLERS = """\
controller_manager:
  ros__parameters:
    update_rate: 100
    joint_state_broadcaster:
      type: joint_state_broadcaster/JointStateBroadcaster
"""


def manifest(distro: str, *, name: str = "my_robot", kind: str = "ament_cmake") -> str:
    """package.xml."""
    declared = "".join(
        f"  <exec_depend>{one}</exec_depend>\n" for one in DEPENDENCIES.get(distro, ())
    )
    tool = f"  <buildtool_depend>{kind}</buildtool_depend>\n" if kind == "ament_cmake" else ""
    return (
        '<?xml version="1.0"?>\n<package format="3">\n'
        f"  <name>{name}</name>\n  <version>0.1.0</version>\n"
        "  <description>A robot.</description>\n"
        '  <maintainer email="ada@example.org">Ada</maintainer>\n  <license>MIT</license>\n'
        f"{tool}{declared}"
        f"  <export>\n    <build_type>{kind}</build_type>\n  </export>\n</package>\n"
    )


def cmake(folders: str, more: str = "") -> str:
    """CMakeLists.txt that installs some folders."""
    install = f"install(DIRECTORY {folders} DESTINATION share/${{PROJECT_NAME}})\n"
    return (
        "cmake_minimum_required(VERSION 3.8...3.31)\nproject(my_robot LANGUAGES NONE)\n"
        f"find_package(ament_cmake REQUIRED)\n{install if folders else ''}{more}ament_package()\n"
    )


# ---- robots --------------------------------------------------------------------------------------

LIMIT = '<limit lower="-1.5" upper="1.5" effort="10" velocity="1"/>'
CYLINDER = '<geometry><cylinder radius="0.1" length="0.04"/></geometry>'
BOX = '<geometry><box size="0.1 0.1 0.1"/></geometry>'
INERTIAL = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="0.0017" ixy="0" ixz="0" iyy="0.0017" iyz="0" izz="0.0017"/></inertial>'
)
SHAPES = f"<visual>{BOX}</visual><collision>{BOX}</collision>"


def link(name: str, inner: str = INERTIAL + SHAPES) -> str:
    """A cube of 0.1 m and 1 kg."""
    return f'<link name="{name}">{inner}</link>'


def joint(
    child: str,
    *inner: str,
    kind: str = "revolute",
    parent: str = "base_link",
    name: str = "",
    origin: str = "0 0 0.2",
) -> str:
    """A joint to a link; without `inner`, with an axis and a limit as its type needs them."""
    needed = {"fixed": "", "continuous": '<axis xyz="0 1 0"/>'}.get(
        kind, f'<axis xyz="0 1 0"/>{LIMIT}'
    )
    return (
        f'<joint name="{name or child + "_joint"}" type="{kind}"><origin xyz="{origin}"/>'
        f'<parent link="{parent}"/><child link="{child}"/>{"".join(inner) or needed}</joint>'
    )


def ends(child: str, parent: str = "base_link", more: str = '<axis xyz="0 1 0"/>') -> str:
    """What a joint holds that an example leaves out."""
    return f'<parent link="{parent}"/><child link="{child}"/>{more}'


BODY = link("base_link")
ARM = BODY + link("arm")
PLACE = re.compile(r"(?<!\w)@|@(?!\w)")


def put(around: str, text: str) -> str:
    """The text at its place in another one."""
    return PLACE.sub(lambda _: text, around)


SHORT = re.compile(r'<link name="(\w+)"/>')
DOTS = re.compile(r"…|\.\.\.")


@dataclass(frozen=True)
class Plant:
    """Where the examples of a rule are written."""

    file: str
    around: str = "@"  # of the bad example
    good: str | None = None  # the same of the good one; None: as of the bad one
    dots: tuple[str, ...] = ()  # what the ellipses stand for, in turn; the last for all others
    distro: str = "jazzy"
    files: Mapping[str, str | None] = field(default_factory=dict)  # what is beside it
    is_good_code: bool = True  # whether the good example can be planted, too
    swaps: tuple[tuple[str, str], ...] = ()  # what of the example is replaced, once each
    good_dots: tuple[str, ...] | None = None  # None: as of the bad one

    def plant(self, example: str, *, is_good: bool = False) -> Files:
        """The files of a package with the example."""
        around = self.good if is_good and self.good is not None else self.around
        dots = self.good_dots if is_good and self.good_dots is not None else self.dots
        text = example.strip("\n")
        for old, new in self.swaps:
            text = text.replace(old, new, 1)
        rest = [*dots]
        if rest:
            text = DOTS.sub(lambda _: rest.pop(0) if len(rest) > 1 else rest[0], text)
        return {**self.files, self.file: put(around, text)}


def robot(around: str = "@", **options: Any) -> Plant:
    """Plant into a URDF."""
    return Plant(file="urdf/my_robot.urdf", around=around, **options)


def finish_robot(text: str) -> str:
    """The file of a robot, its short links with bodies."""
    text = SHORT.sub(lambda found: link(found[1]), text).replace("><", ">\n<")
    return text if "<robot" in text else f'<robot name="my_robot">\n{text}\n</robot>\n'


INERTIA_OF = f'<link name="base_link"><inertial><mass value="1"/>@</inertial>{SHAPES}</link>'
MASS_OF = INERTIAL.replace('<mass value="1"/>', "@")
MASS_OF = f'<link name="base_link">{MASS_OF}{SHAPES}</link>'
IN_JOINT = ARM + joint("arm", "@", kind="fixed").replace('<origin xyz="0 0 0.2"/>', "")
IN_REVOLUTE = ARM + joint("arm", '<axis xyz="0 1 0"/>', "@")
WHEEL = BODY + "@" + joint("wheel", kind="continuous")
CONTROLLED = ARM + joint("arm") + CONTROL_PLUGIN
HARDWARE = "<hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>"
COMMANDS = '<command_interface name="position"/><state_interface name="position"/>'
STATES = '<state_interface name="position"/>'
TIRE = f'<visual><origin rpy="1.5708 0 0"/>{CYLINDER}</visual>'
TIRE += TIRE.replace("visual>", "collision>")
WHEELS = BODY + "".join(link(f"{side}_wheel", INERTIAL + TIRE) for side in ("left", "right"))
WHEEL_JOINTS = joint("left_wheel", kind="continuous") + joint("right_wheel", kind="continuous")
SENSOR = "<update_rate>10</update_rate>"
IN_CONTROL = f'<ros2_control name="arm" type="system">{HARDWARE}@</ros2_control>'
YAML = {"config/controllers.yaml": CONTROLLERS}

ROBOTS: dict[str, Plant] = {
    "ROB001": robot(),
    "ROB002": robot(f'@\n<robot name="r">{BODY}</robot>', is_good_code=False),
    "ROB003": robot(),
    "ROB004": robot(f"@{BODY}</robot>"),
    "ROB005": robot(),
    "ROB006": robot(),
    "ROB007": robot(
        BODY + "@" + "".join(joint(one, kind="continuous") for one in ("left_wheel", "right_wheel"))
    ),
    "ROB008": robot(WHEELS + "@", dots=(ends("left_wheel"), ends("right_wheel"))),
    "ROB009": robot(),
    "ROB010": robot(ARM + link("hand") + "@"),
    "ROB011": robot(
        BODY
        + "".join(link(one) for one in ("left_arm", "right_arm", "hand"))
        + joint("left_arm")
        + joint("right_arm")
        + "@"
    ),
    "ROB012": robot(ARM + "@"),
    "ROB013": robot(),
    "ROB014": robot(ARM + "@"),
    "ROB015": robot(ARM + "@" + ends("arm", more=LIMIT) + "</joint>"),
    "ROB016": robot(IN_JOINT),
    "ROB018": robot(ARM + joint("arm", "@", LIMIT)),
    "ROB019": robot(ARM + joint("arm", "@", LIMIT)),
    "ROB020": robot(ARM + "@"),
    "ROB021": robot(
        '<link name="base_link">@<visual><geometry><sphere radius="0.5"/></geometry></visual>'
        '<collision><geometry><sphere radius="0.5"/></geometry></collision></link>'
    ),
    "ROB022": robot(MASS_OF),
    "ROB023": robot(IN_REVOLUTE),
    "ROB024": robot(
        '<link name="base_link"><inertial><mass value="100"/>'
        '<inertia ixx="16" iyy="16" izz="16" ixy="0" ixz="0" iyz="0"/></inertial>'
        "<visual>@</visual><collision>@</collision></link>"
    ),
    "ROB025": robot(
        f'<link name="base_link">{INERTIAL}<collision>{BOX}</collision>@</link>',
        good=f'@<link name="base_link">{INERTIAL}<collision>{BOX}</collision>'
        f'<visual>{BOX}<material name="blue"/></visual></link>',
    ),
    "ROB026": robot("@" + BODY, dots=("",)),
    "ROB027": robot(f'<material name="m">@</material>{BODY}'),
    "ROB028": robot(
        f'<link name="base_link">{INERTIAL}'
        "<visual><geometry>@</geometry></visual><collision><geometry>@</geometry></collision></link>"
    ),
    "ROB151": robot(
        f'<link name="base_link">{INERTIAL}@</link>',
        files={"meshes/hand.stl": "STL", "meshes/hand_mirrored.stl": "STL"},
    ),
    "ROB029": robot(
        f'<link name="base_link">{INERTIAL}'
        "<visual><geometry>@</geometry></visual><collision><geometry>@</geometry></collision></link>",
        files={"meshes/arm.stl": "STL"},
    ),
    "ROB030": robot(),
    "ROB031": robot(put(WHEEL, link("wheel") + "@")),
    "ROB032": robot(BODY + "@", distro="humble"),
    "ROB033": robot(BODY + "@"),
    "ROB034": robot(BODY + "@" + ends("arm", more=LIMIT) + "</joint>"),
    "ROB036": robot(
        BODY + link("left") + link("right") + "@",
        dots=(ends("left", more=LIMIT), ends("right", more=LIMIT)),
    ),
    "ROB037": robot(INERTIA_OF.replace("0.1 0.1 0.1", "0.7 0.7 0.7")),
    "ROB040": robot(WHEEL, dots=('<geometry><box size="0.4 0.4 0.4"/></geometry>',)),
}

MESH = {"meshes/arm.stl": "STL", "meshes/base.stl": "STL", "meshes/arm.dae": "DAE"}
SENSED = BODY + link("camera_link") + joint("camera_link", kind="fixed")
FINGERS = BODY + link("left_finger") + link("right_finger")
PRISMATIC_LEFT = ends("left_finger", more=f'<axis xyz="0 1 0"/>{LIMIT}')
PRISMATIC_RIGHT = ends("right_finger", more=f'<axis xyz="0 1 0"/>{LIMIT}')
SYSTEM = "<gazebo>@</gazebo>"

ROBOTS |= {
    "ROB042": robot(
        BODY + "<link name='a'>@</link>" + joint("a", kind="fixed"), is_good_code=False
    ),
    "ROB043": robot(),
    "ROB045": robot(ARM + joint("arm") + "@"),
    "ROB047": robot(f"@{BODY}</robot>"),
    "ROB048": robot(
        '<link name="base_link"><inertial><mass value="5"/>'
        '<inertia ixx="0.054" iyy="0.083" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
        "<visual><geometry>@</geometry></visual><collision><geometry>@</geometry></collision></link>"
    ),
    "ROB049": robot(MASS_OF),
    "ROB050": robot("@"),
    "ROB055": robot(ARM + "@"),
    "ROB056": robot(MASS_OF),
    "ROB058": robot(ARM + link("hand") + joint("arm") + joint("hand") + "@", is_good_code=False),
    "ROB059": robot("@" + BODY),
    "ROB060": robot(f'<link name="base_link">{INERTIAL}<visual>{BOX}</visual>@</link>', files=MESH),
    "ROB061": robot(
        f'<link name="base_link">{INERTIAL}<collision>{BOX}</collision>@</link>', files=MESH
    ),
    "ROB068": robot(
        f'<link name="base_link">{INERTIAL}<collision>{BOX}</collision>'
        "<visual><geometry>@</geometry></visual></link>",
        files={"meshes/arm.glb": "GLB", "meshes/arm.dae": "DAE"},
    ),
    "ROB070": robot(IN_REVOLUTE),
    "ROB152": robot(
        ARM + joint("arm", '<axis xyz="0 1 0"/>', "@", kind="continuous"),
    ),
    "ROB077": robot(IN_JOINT),
    "ROB078": robot(ARM + link("hand") + joint("arm") + joint("hand") + "@"),
    "ROB079": robot(
        ARM + link("flange") + joint("arm") + joint("flange", kind="fixed") + "@",
        good=ARM + link("flange") + joint("arm") + joint("flange", kind="fixed") + "@"
        '<gazebo><joint name="closing_joint" type="revolute"><parent>arm</parent>'
        "<child>flange</child></joint></gazebo>",
    ),
    "ROB081": robot(
        link("base_link")
        + joint("upper_arm", kind="fixed")
        + link("upper_arm")
        + link("forearm")
        + "@"
    ),
    "ROB082": robot(IN_REVOLUTE),
    "ROB083": robot(IN_REVOLUTE),
    "ROB084": robot(IN_REVOLUTE),
    "ROB095": robot(ARM + joint("arm") + "@"),
    "ROB097": robot(SENSED + "@"),
    "ROB099": robot(
        SENSED + '<gazebo reference="camera_link"><sensor name="c" type="camera">'
        "<camera>@<image><width>64</width><height>64</height></image></camera></sensor></gazebo>"
    ),
    "ROB104": robot(BODY + link("imu_link") + joint("imu_link", kind="continuous") + "@"),
    "ROB122": robot(WHEELS + WHEEL_JOINTS + "@"),
    "ROB141": robot(
        '<robot name="my_robot" xmlns:gz="http://gazebosim.org/schema">'
        '<link name="base_footprint"/>'
        + BODY
        + joint("base_link", kind="fixed", parent="base_footprint")
        + link("front_left_wheel")
        + joint("front_left_wheel", kind="continuous")
        + "@</robot>"
    ),
}
XACRO = '<robot name="my_robot" xmlns:xacro="http://www.ros.org/wiki/xacro">\n@\n</robot>\n'


def xacro(around: str, **options: Any) -> Plant:
    """Plant into a xacro file."""
    return Plant(file="urdf/my_robot.urdf.xacro", around=put(XACRO, around), **options)


ROBOTS |= {
    "ROB071": xacro(
        f'@\n<link name="base_link">{INERTIAL}<visual>{BOX}</visual><collision>{BOX}</collision>'
        "</link>"
    ),
    "ROB115": xacro("@\n" + BODY),
    "ROB116": xacro(BODY + "\n@\n"),
}

# ---- worlds and models ---------------------------------------------------------------------------

DEFAULT_SYSTEMS = (
    '<plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>'
    '<plugin filename="gz-sim-user-commands-system" name="gz::sim::systems::UserCommands"/>'
    '<plugin filename="gz-sim-scene-broadcaster-system" '
    'name="gz::sim::systems::SceneBroadcaster"/>'
)
SYSTEMS = (
    DEFAULT_SYSTEMS
    + '<plugin filename="gz-sim-sensors-system" name="gz::sim::systems::Sensors"/>'
    + '<plugin filename="gz-sim-imu-system" name="gz::sim::systems::Imu"/>'
)
GROUND = (
    '<model name="ground"><static>true</static><link name="link"><collision name="c"><geometry>'
    "<plane><normal>0 0 1</normal><size>9 9</size></plane></geometry></collision></link></model>"
)
LIGHT = '<light name="sun" type="directional"/>'
SURROUNDINGS = SYSTEMS + GROUND + LIGHT
SDF = '<sdf version="1.9">@</sdf>'
IN_WORLD = put(SDF, f'<world name="w">{SURROUNDINGS}@</world>')
SDF_INERTIAL = (
    "<inertial><mass>1</mass><inertia><ixx>0.0017</ixx><iyy>0.0017</iyy><izz>0.0017</izz>"
    "</inertia></inertial>"
)
SDF_BOX = "<geometry><box><size>0.1 0.1 0.1</size></box></geometry>"
SDF_SHAPE = f'<collision name="c">{SDF_BOX}</collision>'
SDF_INNER = SDF_INERTIAL + SDF_SHAPE
SDF_LINK = f'<link name="{{}}"><pose>{{}} 0 1 0 0 0</pose>{SDF_INNER}</link>'
IN_MODEL = put(IN_WORLD, '<model name="m">@</model>')
IN_LINK = put(IN_MODEL, f'<link name="link"><pose>0 0 1 0 0 0</pose>{SDF_INERTIAL}@</link>')


def sdf_link(name: str, x: int = 0) -> str:
    """A cube of 0.1 m and 1 kg."""
    return SDF_LINK.format(name, x)


def world(around: str = "@", file: str = "worlds/office.sdf", **options: Any) -> Plant:
    """Plant into an SDF file."""
    return Plant(file=file, around=around, **options)


def model_file(name: str, text: str | None = None) -> dict[str, str | None]:
    """The folder of a model."""
    config = (
        f"<model><name>{name}</name><version>1.0</version>"
        '<sdf version="1.9">model.sdf</sdf></model>'
    )
    model = text or put(SDF, f'<model name="{name}">{sdf_link("link")}</model>')
    return {f"models/{name}/model.config": config, f"models/{name}/model.sdf": model}


TWO_JOINTED = sdf_link("base_link") + sdf_link("lever", 1) + sdf_link("bar", 2)
AXIS = "<axis><xyz>0 0 1</xyz></axis>"
IN_GEOMETRY = put(IN_LINK, '<collision name="collision"><geometry>@</geometry></collision>')
STATIC_GEOMETRY = IN_GEOMETRY.replace('<model name="m">', '<model name="m"><static>true</static>')
HILL = {"models/hill/hill.png": "PNG"} | model_file("hill")

WORLDS: dict[str, Plant] = {
    "WLD007": world(IN_WORLD),
    "WLD011": world(f'@<model name="m">{sdf_link("link")}</model></sdf>'),
    "WLD012": world(f'@<world name="w">{SURROUNDINGS}</world></sdf>'),
    "WLD015": world(IN_MODEL),
    "WLD016": world(put(IN_MODEL, f"{sdf_link('shoulder')}@{SDF_INNER}</link>")),
    "WLD017": world(put(IN_MODEL, f"{sdf_link('link')}@")),
    "WLD019": world(
        put(SDF, "@"),
        file="models/arm/model.sdf",
        files={"models/arm/model.config": model_file("arm")["models/arm/model.config"]}
        | model_file("hand"),
    ),
    "WLD020": world(
        put(
            IN_MODEL,
            f"{sdf_link('base')}<link name='arm'>{SDF_INNER}@{SDF_BOX}</visual></link>"
            '<joint name="arm_joint" type="revolute"><parent>base</parent><child>arm</child>'
            f"{AXIS}</joint>",
        )
    ),
    "WLD021": world(put(IN_MODEL, f"{sdf_link('base_link')}{sdf_link('arm', 1)}@")),
    "WLD034": world(STATIC_GEOMETRY),
    "WLD035": world(
        put(
            IN_MODEL,
            f"{sdf_link('base')}@<joint name='j' type='revolute'><parent>base</parent>"
            f"<child>arm</child>{AXIS}</joint>",
        ),
        dots=(SDF_BOX,),
    ),
    "WLD038": world("@", dots=(sdf_link("link"),), good="@"),
    "WLD041": world(IN_LINK.replace(SDF_INERTIAL, "<inertial>@</inertial>" + SDF_SHAPE)),
    "WLD044": world(IN_LINK, dots=(SDF_BOX,)),
    "WLD045": world(IN_WORLD),
    "WLD046": world("@", is_good_code=False),
    "WLD050": world(STATIC_GEOMETRY, files=HILL),
    "WLD057": world(STATIC_GEOMETRY),
    "WLD062": world(IN_WORLD, is_good_code=False),
    "WLD065": world(IN_WORLD),
    "WLD066": world(IN_WORLD, files=model_file("table")),
}

# ---- the package and its build -------------------------------------------------------------------

LAUNCH_DESCRIPTION = """\
from launch import LaunchDescription


def generate_launch_description():
    return LaunchDescription([])
"""
NODE = "import rclpy  # noqa: F401\n\n\ndef main():\n    pass\n"


def package(around: str = "@", **options: Any) -> Plant:
    """Plant into package.xml."""
    return Plant(file="package.xml", around=around, **options)


def in_manifest(where: str = "declared", distro: str = "jazzy") -> str:
    """package.xml with a place: for dependencies, or instead of the build type."""
    text = manifest(distro)
    if where == "declared":
        return text.replace("  <export>", "  @\n  <export>")
    if where == "export":
        return text.replace("<export>\n    <build_type>ament_cmake</build_type>\n  </export>", "@")
    return text.replace(where, "@")


CMAKE_LAUNCH = {"launch/robot.launch.py": LAUNCH_DESCRIPTION}
TOP = "cmake_minimum_required(VERSION 3.8...3.31)\nproject(my_robot LANGUAGES NONE)\n"
FIND = "find_package(ament_cmake REQUIRED)\n"
COMPILED = TOP.replace("NONE", "CXX") + FIND


def build(around: str = TOP + FIND + "@\nament_package()\n", **options: Any) -> Plant:
    """Plant into CMakeLists.txt."""
    return Plant(file="CMakeLists.txt", around=around, **options)


SETUP = """\
from glob import glob

from setuptools import setup

package_name = 'my_robot'

setup(
    name=package_name,
    version='0.1.0',
    packages=['my_robot'],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='Ada',
    maintainer_email='ada@example.org',
    description='A robot.',
    license='MIT',
)
"""
SETUP_CFG = """\
[develop]
script_dir=$base/lib/my_robot
[install]
install_scripts=$base/lib/my_robot
"""
PYTHON: dict[str, str | None] = {
    "package.xml": manifest("", kind="ament_python"),
    "CMakeLists.txt": None,
    "setup.py": SETUP,
    "setup.cfg": SETUP_CFG,
    "resource/my_robot": "",
    "my_robot/__init__.py": "",
}
DATA = "        ('share/' + package_name, ['package.xml']),\n"
SCRIPTS = (
    "    license='MIT',\n    entry_points={'console_scripts': ['talk = my_robot.talk:main']},\n"
)


def setup(around: str = SETUP, file: str = "setup.py", **options: Any) -> Plant:
    """Plant into setup.py."""
    files = PYTHON | dict(options.pop("files", {}))
    return Plant(file=file, around=around, files=files, **options)


MESHES: dict[str, str | None] = {"meshes/arm.stl": "STL"}
TESTED = manifest("jazzy").replace(
    "  <export>", "  <test_depend>ament_lint_auto</test_depend>\n  <export>"
)
CPP: dict[str, str | None] = {"src/my_node.cpp": "int main() { return 0; }\n"}
SCRIPT = "#!/usr/bin/env python3\nprint()\n"

PACKAGES: dict[str, Plant] = {
    "PKG001": package(is_good_code=False),
    "PKG004": package(
        in_manifest("  <name>my_robot</name>\n  <version>0.1.0</version>\n"),
        swaps=(('<package format="3">\n', ""), ("</package>", "")),
        is_good_code=False,
    ),
    "PKG005": package(
        "@<description>A robot.</description>"
        '<maintainer email="ada@example.org">Ada</maintainer><license>MIT</license>'
        "<buildtool_depend>ament_cmake</buildtool_depend>"
        "<export><build_type>ament_cmake</build_type></export></package>"
    ),
    "PKG006": package(in_manifest("<name>my_robot</name>")),
    "PKG008": package(in_manifest("<build_type>ament_cmake</build_type>")),
    "PKG009": package(in_manifest("export")),
    "PKG060": Plant(file="wsgen.toml"),
    "PKG061": Plant(file="wsgen.toml"),
    "PKG068": package(in_manifest("<exec_depend>robot_state_publisher</exec_depend>")),
    "PKG069": package(in_manifest()),
    "PKG070": package(in_manifest(), good=in_manifest("<exec_depend>ros_gz_sim</exec_depend>")),
    "PKG071": package(in_manifest()),
    "PKG072": package(in_manifest()),
    "PKG073": package(
        manifest("", kind="ament_python").replace("  <export>", "  @\n  <export>"),
        good=manifest("", kind="ament_python").replace(
            "<export>\n    <build_type>ament_python</build_type>\n  </export>", "@"
        ),
        files=PYTHON,
    ),
    "PKG075": package(manifest("").replace("  <export>", "  @\n  <export>")),
    "PKG076": package(in_manifest("<license>MIT</license>")),
    "PKG078": package(
        in_manifest("export").replace("  <buildtool_depend>ament_cmake</buildtool_depend>\n", "")
    ),
    "PKG081": package(
        in_manifest("export").replace("<buildtool_depend>ament_cmake</buildtool_depend>", "")
    ),
    "PKG085": Plant(
        file="my_robot/talk.py", files=PYTHON | {"setup.py": SETUP}, is_good_code=False
    ),
    "PKG087": build(is_good_code=False),
    "PKG089": build(is_good_code=False),
    "PKG100": robot("@" + BODY.replace(f"<visual>{BOX}</visual>", "")),
    "PKG101": Plant(file="wsgen.toml", files={"urdf/my_robot.urdf": BODY}),
}
BUILDS: dict[str, Plant] = {
    "BLD003": build(files=CMAKE_LAUNCH),
    "BLD009": build(TOP + FIND + "@\n"),
    "BLD010": build(TOP + "@\n", files=CMAKE_LAUNCH),
    "BLD011": build(TOP + FIND + "@\n", files={"package.xml": TESTED}),
    "BLD012": build("@\nproject(my_robot LANGUAGES NONE)\n" + FIND + "ament_package()\n"),
    "BLD027": build(TOP + "@\n"),
    "BLD028": build(files=CMAKE_LAUNCH),
    "BLD029": build(
        TOP.replace("project(my_robot LANGUAGES NONE)", "@") + FIND + "ament_package()\n"
    ),
    "BLD031": build("@\n"),
    "BLD041": setup(
        SETUP.replace(DATA, DATA + "        @\n"),
        files={"urdf/my_robot.urdf": BODY, "urdf/parts/arm.xacro": put(XACRO, "")},
    ),
    "BLD042": setup(
        SETUP.replace("packages=['my_robot'],", "@"),
        files={"my_robot/__init__.py": None},
        is_good_code=False,
    ),
    "BLD043": setup(
        "@\n",
        file="setup.cfg",
        files={
            "setup.py": SETUP.replace("    license='MIT',\n", SCRIPTS),
            "my_robot/talk.py": "def main():\n    pass\n",
        },
    ),
    "BLD045": build("@\n"),
    "BLD046": build(
        COMPILED + "@\ninstall(TARGETS my_node DESTINATION lib/${PROJECT_NAME})\nament_package()\n",
        files=CPP,
    ),
    "BLD047": build(
        TOP.replace("project(my_robot LANGUAGES NONE)", "@") + FIND + "ament_package()\n"
    ),
    "BLD049": build(
        TOP + FIND + "find_package(rclcpp REQUIRED)\n@\n",
        files={
            "package.xml": manifest("jazzy").replace(
                "  <export>", "  <depend>rclcpp</depend>\n  <export>"
            )
        },
    ),
    "BLD050": build(is_good_code=False),
    "BLD051": build(files={"package.xml": TESTED}),
    "BLD052": build(
        COMPILED + "find_package(rclcpp REQUIRED)\nfind_package(std_msgs REQUIRED)\n"
        "add_executable(my_node src/my_node.cpp)\n@\n"
        "install(TARGETS my_node DESTINATION lib/${PROJECT_NAME})\nament_package()\n",
        files=CPP
        | {
            "package.xml": manifest("").replace(
                "  <export>", "  <depend>rclcpp</depend>\n  <depend>std_msgs</depend>\n  <export>"
            )
        },
        distro="lyrical",
    ),
    "BLD053": build(files=CMAKE_LAUNCH | {"meshes/": ""}),
    "BLD054": build(
        files=CMAKE_LAUNCH
        | MESHES
        | {
            "urdf/my_robot.urdf": BODY.replace(
                BOX, '<geometry><mesh filename="package://my_robot/meshes/arm.stl"/></geometry>'
            )
        }
    ),
    "BLD055": build(files=CMAKE_LAUNCH),
    "BLD056": build(files=CMAKE_LAUNCH | {"urdf/my_robot.urdf": BODY}),
    "BLD057": build(files=MESHES | {"urdf/my_robot.urdf": None}),
    "BLD058": build(COMPILED + "@\n", files=CPP),
    "BLD059": build(files={"scripts/my_node.py": SCRIPT}),
    "BLD061": build(files={"scripts/my_node.py": SCRIPT}, is_good_code=False),
    "BLD062": build(files=CMAKE_LAUNCH),
    "BLD071": build(files=CMAKE_LAUNCH),
    "BLD068": build(
        TOP + FIND + "find_package(pluginlib REQUIRED)\n@\n",
        files={
            "package.xml": manifest("jazzy").replace(
                "  <export>", "  <depend>pluginlib</depend>\n  <export>"
            ),
            "plugins.xml": '<library path="my_library"></library>\n',
        },
    ),
    "BLD063": setup(
        "from setuptools import setup\npackage_name = 'my_robot'\n"
        "setup(name=package_name, version='0.1.0', packages=['my_robot'], @)\n"
    ),
    "BLD066": Plant(
        file="my_robot/talk.py",
        around="class Talker:\n    publisher = None\n\n@\n\n\ndef main():\n    pass\n",
        files=PYTHON | {"setup.py": SETUP},
        swaps=(("def talk", "    def talk"), ("    self.pub", "        self.pub")),
    ),
    "BLD064": setup(SETUP.replace("package_name = 'my_robot'", "@")),
}

IN_NODE = """\
#!/usr/bin/env python3
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node


class Talker(Node):

    def __init__(self):
        super().__init__('talker')
        @

    def tick(self):
        self.get_logger().info(str(Twist()))

    def on_scan(self, scan):
        pass


def main():
    rclpy.init()
    rclpy.spin(Talker())


if __name__ == '__main__':
    main()
"""


def node(around: str, **options: Any) -> Plant:
    """Plant into a Python program that is installed."""
    declared = "".join(
        f"<exec_depend>{one}</exec_depend>"
        for one in ("geometry_msgs", "nav_msgs", "rclpy", "sensor_msgs")
    )
    return Plant(
        file="scripts/talk.py",
        around=around,
        files={
            "CMakeLists.txt": cmake(
                "", "install(PROGRAMS scripts/talk.py DESTINATION lib/${PROJECT_NAME})\n"
            ),
            "package.xml": put(in_manifest(), declared),
        },
        **options,
    )


BUILDS |= {
    "PKG109": package(
        in_manifest("export").replace("<exec_depend>xacro</exec_depend>\n", ""),
        good=in_manifest("export").replace("<exec_depend>xacro</exec_depend>\n", ""),
    ),
    "PKG105": node(put(IN_NODE, "pass").replace("import rclpy\n", "@\nimport rclpy\n")),
    "PKG106": node(put(IN_NODE, "pass").replace("import rclpy\n", "@\nimport rclpy\n")),
    "PKG107": node(
        IN_NODE.replace("def tick", "def tik"), good=IN_NODE, swaps=(("# def tik(self)", ""),)
    ),
    "PKG108": node(IN_NODE, swaps=(("\n", "\n        "),)),
    "PKG110": node(IN_NODE, swaps=(("\n", "\n        "),)),
    "BLD073": node(
        IN_NODE,
        good=put(IN_NODE, "self.create_subscription(LaserScan, 'scan', self.on_scan, 10)").replace(
            "import rclpy\n", "import rclpy\n@\n"
        ),
    ),
    "BLD074": node("@\n", swaps=(("\ndef main", "\nimport rclpy\n\n\ndef main"),)),
    "BLD075": node(IN_NODE),
}

# ---- launch files --------------------------------------------------------------------------------

IMPORTS = """\
import os
import sys

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch.actions import (
    DeclareLaunchArgument,
    ExecuteProcess,
    IncludeLaunchDescription,
    LogInfo,
    OpaqueFunction,
    RegisterEventHandler,
)
from launch.conditions import IfCondition
from launch.event_handlers import OnProcessExit, OnProcessStart
from launch.launch_description_sources import PythonLaunchDescriptionSource
from launch.substitutions import Command, LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue

share = get_package_share_directory('my_robot')
path = os.path.join(share, 'urdf', 'my_robot.urdf.xacro')
world = os.path.join(share, 'worlds', 'office.sdf')
text = ParameterValue(Command(['xacro ', path]), value_type=str)
"""
START = """\
gazebo = os.path.join(get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py')
source = PythonLaunchDescriptionSource(gazebo)
simulator = IncludeLaunchDescription(source, launch_arguments={'gz_args': ['-r ', world]}.items())
"""
START_CLASSIC = """\
gazebo = os.path.join(get_package_share_directory('gazebo_ros'), 'launch', 'gazebo.launch.py')
source = PythonLaunchDescriptionSource(gazebo)
simulator = IncludeLaunchDescription(source)
"""
PUBLISH = (
    "Node(package='robot_state_publisher', executable='robot_state_publisher',\n"
    "     parameters=[{'robot_description': text, 'use_sim_time': True}]),\n"
)
STATED = (
    "Node(package='joint_state_publisher', executable='joint_state_publisher',\n"
    "     parameters=[{'use_sim_time': True}]),\n"
)
CLOCK = (
    "Node(package='ros_gz_bridge', executable='parameter_bridge',\n"
    "     arguments=['/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock']),\n"
)
CREATE = (
    "Node(package='ros_gz_sim', executable='create', arguments=['-topic', 'robot_description',\n"
    "     '-z', '0.06']),\n"
)
SPAWN = (
    "Node(package='gazebo_ros', executable='spawn_entity.py', arguments=['-topic',\n"
    "     'robot_description', '-entity', 'my_robot', '-z', '0.06']),\n"
)
RETURN = "\n\ndef generate_launch_description():\n    return LaunchDescription([\n"
GZ = IMPORTS + START + RETURN + "simulator,\n" + PUBLISH + CLOCK
ALL_OF_IT = GZ + CREATE + "])\n"
LAUNCH_FILE = "launch/robot.launch.py"
LASER = (
    '<sensor name="lidar" type="gpu_lidar"><topic>scan</topic>'
    "<gz_frame_id>base_link</gz_frame_id></sensor>"
)
UP = '<origin xyz="0 0 0.05"/>'
STANDING = f"""<link name="base_link">{INERTIAL.replace("<mass", f"{UP}<mass")}
  <visual>{UP}{BOX}</visual><collision>{UP}{BOX}</collision></link>"""
SIMULATED: dict[str, str | None] = {
    "urdf/my_robot.urdf.xacro": put(XACRO, STANDING),
    "worlds/office.sdf": put(SDF, f'<world name="office">{SURROUNDINGS}</world>'),
}
CLASSIC_WORLD = put(
    SDF.replace("1.9", "1.6"),
    f'<world name="office">{GROUND}<light name="sun" type="directional"><cast_shadows>true'
    "</cast_shadows></light></world>",
)
FOR_CLASSIC: dict[str, str | None] = {
    "urdf/my_robot.urdf.xacro": put(XACRO, STANDING),
    "worlds/office.sdf": CLASSIC_WORLD,
}


def launch(
    around: str = GZ + CREATE + "@])\n",
    *,
    file: str = LAUNCH_FILE,
    files: Mapping[str, str | None] | None = None,
    **options: Any,
) -> Plant:
    """Plant into a launch file."""
    beside = FOR_CLASSIC if options.get("distro") == "humble" else SIMULATED
    return Plant(file=file, around=around, files=beside | dict(files or {}), **options)


BEFORE = IMPORTS + "@\n" + START + RETURN + "simulator,\n" + PUBLISH + CLOCK + CREATE + "])\n"
WITH_WORLD = "(source, launch_arguments={'world': world}.items())"
CLASSIC = IMPORTS + START_CLASSIC.replace("(source)", WITH_WORLD) + RETURN + "simulator,\n"
CREATED = "Node(package='ros_gz_sim', executable='create', @),\n"
SPAWNED = "Node(package='gazebo_ros', executable='spawn_entity.py', @),\n"
BRIDGED = "Node(package='ros_gz_bridge', executable='parameter_bridge', @),\n"
BY_HAND = GZ + CREATE + "@\n])\n"
DIFF_DRIVE = {
    "urdf/my_robot.urdf.xacro": put(
        XACRO,
        WHEELS + WHEEL_JOINTS + '<gazebo><plugin filename="gz-sim-diff-drive-system" '
        'name="gz::sim::systems::DiffDrive"><left_joint>left_wheel_joint</left_joint>'
        "<right_joint>right_wheel_joint</right_joint><odom_topic>odom</odom_topic>"
        "<topic>cmd_vel</topic></plugin></gazebo>",
    )
}
EXAMPLE_MAIN = "\n\ndef generate_launch_description():\n    return LaunchDescription([])\n"

LAUNCHES: dict[str, Plant] = {
    "LCH001": launch(
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n"
        "def generate_launch_description():\n"
        "    spawner = Node(package='rviz2', executable='rviz2')\n"
        "    publisher = Node(package='rviz2', executable='rviz2')\n    @\n"
    ),
    "LCH002": launch("@\n" + EXAMPLE_MAIN),
    "LCH003": launch("from launch import LaunchDescription\n\n\n@\n"),
    "LCH004": launch("share = '/tmp'\n@\nfrom launch import LaunchDescription\n" + EXAMPLE_MAIN),
    "LCH005": build(
        files=SIMULATED
        | {
            LAUNCH_FILE: ALL_OF_IT.replace("'urdf', ", "'model', ").replace(
                "world = ", "world = 'empty.sdf'  #"
            ),
            "worlds/office.sdf": None,
            "urdf/my_robot.urdf.xacro": None,
            "model/my_robot.urdf.xacro": SIMULATED["urdf/my_robot.urdf.xacro"],
        }
    ),
    "LCH006": launch(GZ + CREATE + "@, LogInfo(msg=LaunchConfiguration('world'))])\n"),
    "LCH092": launch(GZ + CREATE + "@, LogInfo(msg=LaunchConfiguration('robot'))])\n"),
    "LCH008": Plant(
        file="urdf/my_robot.urdf.xacro",
        around=put(
            XACRO,
            BODY.replace(
                SHAPES, f"<visual>{CYLINDER}</visual><collision>{CYLINDER}</collision>"
            ).replace(CYLINDER, "<geometry>@</geometry>"),
        ),
        good=put(XACRO, "@" + BODY),
        files={LAUNCH_FILE: ALL_OF_IT, "worlds/office.sdf": SIMULATED["worlds/office.sdf"]},
    ),
    "LCH009": launch(IMPORTS + "\n\ndef generate_launch_description():\n    return @\n"),
    "LCH010": launch(BY_HAND),
    "LCH011": launch(BEFORE, good=put(BEFORE, "argument = @")),
    "LCH013": launch(BEFORE, is_good_code=False),
    "LCH015": launch(
        GZ.replace(PUBLISH, "@,\n") + CREATE + "])\n",
        dots=("package='robot_state_publisher', executable='robot_state_publisher'",),
        files={"urdf/my_robot.urdf.xacro": put(XACRO, "<!-- a robot: of one box -->\n" + BODY)},
    ),
    "LCH016": launch(
        GZ.replace(PUBLISH, "@,\n") + CREATE + "])\n",
        dots=("package='robot_state_publisher', executable='robot_state_publisher'",),
    ),
    "LCH017": launch("from launch import LaunchDescription\n@\n" + EXAMPLE_MAIN),
    "LCH019": launch(
        GZ + CREATE + "@])\n", dots=("package='rviz2', executable='rviz2'",), is_good_code=False
    ),
    "LCH020": launch(BEFORE),
    "LCH021": launch(
        GZ.replace(PUBLISH, "@,\n") + CREATE + "])\n",
        swaps=(
            ("publiser')", "publiser', parameters=[{'robot_description': text}])"),
            ("publisher')", "publisher', parameters=[{'robot_description': text}])"),
        ),
    ),
    "LCH022": launch(BY_HAND),
    "LCH023": launch("@\n", file="launch/view.launch.xml"),
    "LCH030": launch("@\n", file="launch/view.launch.py"),
    "LCH031": launch(BY_HAND),
    "LCH040": launch(IMPORTS + RETURN + "@,\n" + PUBLISH + CLOCK + CREATE + "])\n"),
    "LCH068": launch(
        IMPORTS.replace(", 'worlds', 'office.sdf'", ", 'worlds', 'office.world'")
        + RETURN
        + "@,\n"
        + PUBLISH
        + SPAWN
        + "])\n",
        distro="humble",
        files={
            "worlds/office.sdf": None,
            "worlds/office.world": CLASSIC_WORLD,
        },
    ),
    "LCH069": launch(
        GZ.replace(PUBLISH, "@,\n").replace("text = ", "description = ") + CREATE + "])\n"
    ),
    "LCH102": launch(
        IMPORTS
        + START
        + "robot_state_publisher = "
        + PUBLISH.rstrip(",\n")
        + "\nspawn_robot = "
        + CREATE.rstrip(",\n")
        + RETURN
        + "simulator,\nrobot_state_publisher,\n"
        + CLOCK
        + "@,\n])\n",
    ),
    "LCH070": launch(
        GZ.replace(CLOCK, "@,\n") + CREATE + "])\n",
        files={
            "urdf/my_robot.urdf.xacro": put(
                XACRO,
                BODY + '<gazebo reference="base_link">'
                '<sensor name="lidar" type="gpu_lidar"><topic>scan</topic>'
                "<gz_frame_id>base_link</gz_frame_id></sensor></gazebo>",
            )
        },
    ),
    "LCH071": launch(
        GZ + "Node(package='ros_gz_sim', executable='create',\n@),\n])\n",
        good=GZ + "Node(package='ros_gz_sim', executable='create',\n@ + ['-z', '0.06']),\n])\n",
        files={"worlds/office.sdf": put(SDF, f'<world name="default">{SURROUNDINGS}</world>')},
    ),
    "LCH072": launch(
        GZ + CREATE + BRIDGED + "])\n",
        files={
            "urdf/my_robot.urdf.xacro": put(
                XACRO,
                BODY + '<gazebo reference="base_link">'
                '<sensor name="lidar" type="gpu_lidar"><topic>scan</topic>'
                "<gz_frame_id>base_link</gz_frame_id></sensor></gazebo>",
            )
        },
    ),
    "LCH073": launch(
        GZ + CREATE + BRIDGED + "])\n",
        files={
            "urdf/my_robot.urdf.xacro": put(
                XACRO,
                BODY + '<gazebo reference="base_link">'
                '<sensor name="imu" type="imu"><topic>imu</topic>'
                "<gz_frame_id>base_link</gz_frame_id></sensor></gazebo>",
            )
        },
    ),
    "LCH074": launch(
        is_good_code=True,
        file="config/bridge.yaml",
        around="@\n",
        files={
            LAUNCH_FILE: GZ
            + CREATE
            + put(
                BRIDGED,
                "parameters=[{'config_file': os.path.join(share, 'config', 'bridge.yaml')}]",
            )
            + "])\n",
            "urdf/my_robot.urdf.xacro": put(
                XACRO,
                BODY + '<gazebo reference="base_link">'
                '<sensor name="lidar" type="gpu_lidar"><topic>scan</topic>'
                "<gz_frame_id>base_link</gz_frame_id></sensor></gazebo>",
            ),
        },
    ),
    "LCH075": launch(GZ.replace(CLOCK, BRIDGED) + CREATE + "])\n"),
    "LCH077": launch(
        GZ + STATED + CREATE.replace("0.06", "0.11") + "Node(package='ros_gz_bridge',"
        " executable='parameter_bridge',\n@),\n])\n",
        files=DIFF_DRIVE,
    ),
    "LCH081": launch(BEFORE),
    "LCH082": launch(
        "<launch>\n@\n</launch>\n",
        file="launch/view.launch.xml",
        files={"rviz/robot.rviz": "Panels: []\n"},
    ),
    "LCH083": launch(
        IMPORTS.replace("Command(['xacro ', path])", "@")
        + GZ.removeprefix(IMPORTS)
        + CREATE
        + "])\n"
    ),
    "LCH085": Plant(
        file="config/nav.yaml",
        around="@\n",
        files=SIMULATED
        | {
            LAUNCH_FILE: GZ + CREATE + "Node(package='rviz2', executable='rviz2', parameters=["
            "os.path.join(share, 'config', 'nav.yaml')]),\n])\n"
        },
    ),
    "LCH087": launch(
        IMPORTS
        + START.replace("launch_arguments={'gz_args': ['-r ', world]}.items()", "@")
        + GZ.removeprefix(IMPORTS + START)
        + CREATE
        + "])\n"
    ),
    "LCH088": launch(
        IMPORTS
        + START.replace("launch_arguments={'gz_args': ['-r ', world]}.items()", "@")
        + GZ.removeprefix(IMPORTS + START)
        + CREATE
        + "])\n"
    ),
    "LCH089": launch(BY_HAND),
    "SPN002": launch(CLASSIC + PUBLISH + "@,\n])\n", distro="humble"),
    "SPN005": launch(CLASSIC + PUBLISH + SPAWNED + "])\n", distro="humble"),
    "SPN006": launch(CLASSIC + SPAWNED + "])\n", distro="humble", files=model_file("can")),
    "SPN007": launch(CLASSIC + PUBLISH + SPAWNED + "])\n", distro="humble"),
    "SPN008": launch(CLASSIC + PUBLISH + SPAWNED + "])\n", distro="humble"),
    "SPN009": launch(GZ.replace(PUBLISH, "@,\n") + CREATE + "])\n"),
    "SPN010": launch(GZ.replace(PUBLISH, "@,\n") + "])\n"),
    "SPN106": launch(
        IMPORTS + "description = text\n" + RETURN + "@,\n])\n",
        files={"urdf/my_robot.urdf.xacro": put(XACRO, WHEELS + WHEEL_JOINTS)},
    ),
    "SPN105": launch(
        IMPORTS
        + "@\nsimulator = IncludeLaunchDescription(source)\n"
        + RETURN
        + "simulator,\n"
        + PUBLISH
        + CLOCK
        + CREATE
        + "])\n"
    ),
    "SPN011": launch(
        GZ.replace(
            PUBLISH,
            "Node(package='robot_state_publisher', executable='robot_state_publisher',\n@),\n",
        )
        + CREATE
        + "])\n"
    ),
    "SPN049": launch(GZ + "@])\n"),
}


def simulated(around: str, distro: str = "jazzy", **options: Any) -> Plant:
    """Plant into the robot that a launch file spawns."""
    files = SIMULATED | {LAUNCH_FILE: ALL_OF_IT}
    return Plant(
        file="urdf/my_robot.urdf.xacro",
        around=put(XACRO, around),
        good=put(XACRO, options.pop("good", around)),
        files=files,
        distro=distro,
        **options,
    )


def simulated_world(
    around: str, *, distro: str = "jazzy", whole: bool = False, **options: Any
) -> Plant:
    """Plant into the world that a launch file starts."""
    return Plant(
        file="worlds/office.sdf",
        around=around if whole else put(SDF, around),
        files=SIMULATED | {LAUNCH_FILE: ALL_OF_IT},
        distro=distro,
        **options,
    )


BODY_OF_5_KG = (
    (
        '<link name="base_link">',
        (
            '<link name="base_link"><inertial><mass value="5"/>'
            '<inertia ixx="0.054" iyy="0.083" izz="0.104" ixy="0" ixz="0" iyz="0"/></inertial>'
        ),
    ),
)
DRIVEN = "<left_joint>left_wheel_joint</left_joint><right_joint>right_wheel_joint</right_joint>"
DRIVES = (
    WHEELS
    + WHEEL_JOINTS
    + '<gazebo><plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive">'
    + f"{DRIVEN}</plugin></gazebo>"
)
MESHED = STANDING.replace(
    f"<visual>{UP}{BOX}</visual>", f"<visual>{UP}<geometry>@</geometry></visual>"
)
MESHED_FILES = SIMULATED | {
    LAUNCH_FILE: ALL_OF_IT,
    "meshes/base.stl": "STL",
    "package.xml": manifest("jazzy").replace(
        "<export>", '<export><gazebo_ros gazebo_model_path="${prefix}/.."/>'
    ),
}
SDF_JOINT = '<joint name="{}" type="revolute"><parent>base</parent><child>{}</child>'
MULTIPLIED = "<multiplier>1</multiplier><offset>0</offset><reference>0</reference>"
CLASSIC_LAUNCH = (
    IMPORTS
    + START_CLASSIC.replace("(source)", WITH_WORLD)
    + RETURN
    + "simulator,\n"
    + PUBLISH
    + SPAWN
    + "])\n"
)
GZ_ARGS = "launch_arguments={'gz_args': ['-r ', world]}.items()"
PHYSICS = '<plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>'
LEVER = (
    '<joint name="pivot" type="revolute"><parent>base_link</parent><child>lever</child>'
    f"{AXIS}</joint>"
)
STATIC_COLLISION = put(
    IN_WORLD, '<model name="m"><static>true</static><link name="link">@</link></model>'
)
DIFF_CONTROLLER = """\
controller_manager:
  ros__parameters:
    diff_drive_controller:
      type: diff_drive_controller/DiffDriveController
"""
COMMANDED_ROBOT = put(
    XACRO,
    WHEELS
    + WHEEL_JOINTS
    + CONTROL_PLUGIN
    + put(
        IN_CONTROL,
        '@<joint name="right_wheel_joint"><command_interface name="velocity"/>'
        f'{STATES}<state_interface name="velocity"/></joint>',
    ),
)
COMMANDED: dict[str, str | None] = {
    "urdf/my_robot.urdf.xacro": put(
        COMMANDED_ROBOT,
        '<joint name="left_wheel_joint"><command_interface name="velocity"/>'
        f'{STATES}<state_interface name="velocity"/></joint>',
    ),
    "worlds/office.sdf": SIMULATED["worlds/office.sdf"],
}
WITH_SPAWNER = (
    GZ + CREATE.replace("0.06", "0.11") + "Node(package='controller_manager', executable='spawner',"
    " arguments=['diff_drive_controller']),\n])\n"
)
LYING: dict[str, str | None] = {"urdf/my_robot.urdf.xacro": put(XACRO, BODY)}
MESSAGES: dict[str, str | None] = {
    "msg/Speed.msg": "float32 speed\n",
    "CMakeLists.txt": TOP.replace("NONE", "CXX")
    + FIND
    + "find_package(rosidl_default_generators REQUIRED)\n"
    "rosidl_generate_interfaces(${PROJECT_NAME} msg/Speed.msg)\nament_package()\n",
}
MARKED = (
    "data_files=[('share/ament_index/resource_index/packages', ['resource/' + package_name]),"
    " ('share/' + package_name, ['package.xml'])],"
)


def in_classic(around: str) -> Plant:
    """Plant into the world that a launch file starts in Gazebo Classic."""
    return Plant(
        file="worlds/office.sdf",
        around=CLASSIC_WORLD.replace("<model", f"{around}<model"),
        files=FOR_CLASSIC | {LAUNCH_FILE: CLASSIC_LAUNCH},
        distro="humble",
    )


OTHERS: dict[str, Plant] = {
    "ROB046": robot(
        BODY + "@" + joint("wheel", kind="continuous"),
        dots=(BOX,),
        swaps=(('<link name="wheel">', f'<link name="wheel">{INERTIAL}<visual>{BOX}</visual>'),),
    ),
    "ROB053": robot("@", swaps=BODY_OF_5_KG),
    "ROB054": robot("@", swaps=BODY_OF_5_KG),
    "ROB085": robot(FINGERS + "@", dots=(PRISMATIC_LEFT, PRISMATIC_RIGHT)),
    "ROB086": robot(
        BODY + link("left_pad") + link("right_pad") + "@",
        dots=('effort="1" velocity="1"',),
        swaps=(
            ('type="prismatic"><', f'type="prismatic">{ends("left_pad")}<'),
            ('type="prismatic">\n', f'type="prismatic">{ends("right_pad")}'),
        ),
    ),
    "ROB087": xacro(ARM + CONTROL_PLUGIN + "@", dots=(ends("arm", more=LIMIT),), files=YAML),
    "ROB088": xacro(
        BODY + link("tool") + CONTROL_PLUGIN + "@",
        dots=(ends("tool", more=LIMIT), 'name="arm" type="system"'),
        swaps=(('  <joint name="tool_joint"><comm', f'{HARDWARE}<joint name="tool_joint"><comm'),),
        files=YAML,
    ),
    "ROB089": xacro(
        BODY
        + link("left_pad")
        + link("right_pad")
        + CONTROL_PLUGIN
        + joint("left_pad", kind="prismatic", name="left_finger")
        + "@",
        dots=(ends("right_pad", more=LIMIT), 'name="arm" type="system"'),
        swaps=(('  <joint name="left_finger">', f'{HARDWARE}<joint name="left_finger">'),),
        files=YAML,
    ),
    "ROB090": xacro(CONTROLLED + "@", files=YAML),
    "ROB091": xacro(CONTROLLED + IN_CONTROL, files=YAML),
    "ROB093": xacro(CONTROLLED.replace(CONTROL_PLUGIN, "") + "@", files=YAML),
    "ROB094": xacro(ARM + joint("arm") + "@", files=YAML),
    "ROB096": xacro(ARM + joint("arm") + "@", good=CONTROLLED + "@", files=YAML),
    "ROB098": robot(
        WHEELS + WHEEL_JOINTS + f"<gazebo>@{DRIVEN}</plugin></gazebo>", distro="humble"
    ),
    "ROB100": robot(WHEELS + WHEEL_JOINTS + f"<gazebo>@{DRIVEN}</plugin></gazebo>"),
    "ROB101": replace(
        simulated(WHEELS + WHEEL_JOINTS + f"<gazebo>@{DRIVEN}</plugin></gazebo>"),
        files=SIMULATED | {LAUNCH_FILE: GZ + STATED + CREATE + "])\n"},
    ),
    "ROB103": robot(
        WHEELS + WHEEL_JOINTS + "<gazebo>@</gazebo>",
        swaps=(('DiffDrive">', f'DiffDrive">{DRIVEN}'),),
    ),
    "ROB105": simulated(SENSED + f'<gazebo reference="camera_link">@{SENSOR}</sensor></gazebo>'),
    "ROB106": robot(BODY + "@" + joint("laser_link", kind="continuous"), dots=(INERTIAL + SHAPES,)),
    "ROB108": robot(
        BODY
        + "".join(link(f"{one}_camera_link") for one in ("left", "right"))
        + "".join(joint(f"{one}_camera_link", kind="fixed") for one in ("left", "right"))
        + "@"
    ),
    "ROB117": robot(
        f'<link name="base_link">@{SHAPES}</link>',
        dots=(
            '<inertia ixx="0.0007" ixy="0" ixz="0" iyy="0.0007" iyz="0" izz="0.0007"/></inertial>',
        ),
    ),
    "ROB118": robot(
        '<link name="base_link">@</link>',
        dots=('<inertia ixx="0.0005" ixy="0" ixz="0" iyy="0.0005" iyz="0" izz="0.0005"/>',),
    ),
    "ROB119": robot(
        f'<link name="base_link">{INERTIAL}@</link>',
        dots=("package://my_robot/meshes",),
        files={"meshes/base.stl": "STL_OF_50"},
    ),
    "ROB120": robot(
        BODY + "@" + joint("left_wheel", kind="continuous"),
        swaps=(('<link name="left_wheel">', f'<link name="left_wheel">{INERTIAL}'),),
    ),
    "ROB124": robot(
        BODY + joint("gimbal", kind="continuous") + "@" + link("telescope"),
        dots=(
            '<inertia ixx="1e-6" ixy="0" ixz="0" iyy="1e-6" iyz="0" izz="1e-6"/>',
            f'<axis xyz="0 1 0"/>{LIMIT}',
        ),
        good_dots=(
            '<inertia ixx="1e-3" ixy="0" ixz="0" iyy="1e-3" iyz="0" izz="1e-3"/>',
            f'<axis xyz="0 1 0"/>{LIMIT}',
        ),
    ),
    "ROB125": simulated(
        BODY + "@",
        good="@",
        dots=("<box size='0.1 0.1 0.1'/>",),
        swaps=(("<visual>", f"{INERTIAL}<collision>{BOX}</collision><visual>"),),
        distro="fortress",
    ),
    "ROB035": robot(
        BODY
        + link("left_finger")
        + link("right_finger")
        + joint("left_finger", kind="prismatic")
        + "@",
        dots=(PRISMATIC_RIGHT,),
    ),
    "ROB080": robot(
        BODY + "@" + link("wheel"),
        dots=('<parent link="base_link"/><child link="wheel_mount"/>',),
        swaps=(('<link name="wheel_mount"/>', '<link name="wheel_mount"></link>'),),
    ),
    "ROB041": robot(
        BODY
        + "<link name='a'>@</link><link name='b'>@</link>"
        + joint("a", kind="fixed")
        + joint("b", kind="fixed", parent="a"),
        is_good_code=False,
    ),
    "WLD003": world(swaps=(('<world name="w">', f'<world name="w">{SURROUNDINGS}'),)),
    "WLD028": world(
        IN_MODEL.replace("1.9", "1.11").replace(
            "@", f"{sdf_link('base')}{sdf_link('a', 1)}{sdf_link('b', 2)}@"
        ),
        swaps=(
            ('<joint name="left" type="revolute">', SDF_JOINT.format("left", "a")),
            ('<joint name="right" type="revolute">', SDF_JOINT.format("right", "b")),
        ),
        dots=(MULTIPLIED,),
        good_dots=("<xyz>0 0 1</xyz>", MULTIPLIED),
    ),
    "WLD063": simulated_world("@", swaps=(("</world>", f"{GROUND}{LIGHT}</world>"),)),
    "WLD072": Plant(
        file="worlds/office.sdf",
        around=SDF,
        files={
            LAUNCH_FILE: ALL_OF_IT,
            "urdf/my_robot.urdf.xacro": put(
                XACRO, f'{STANDING}<gazebo reference="base_link">{LASER}</gazebo>'
            ),
        },
        swaps=(
            (PHYSICS, DEFAULT_SYSTEMS),
            ("</world>", f"{GROUND}{LIGHT}</world>"),
        ),
    ),
    "WLD067": simulated_world(f'<world name="w">{SYSTEMS}{LIGHT}@</world>'),
    "WLD068": world(SDF, swaps=(("</world>", f"{SYSTEMS}{GROUND}</world>"),)),
    "WLD069": simulated_world(
        f'<world name="w">{SURROUNDINGS}<model name="m"><link name="link">{SDF_INERTIAL}'
        f'<visual name="v">{SDF_BOX}@</visual></link></model></world>',
        distro="fortress",
    ),
    "WLD070": Plant(
        file="worlds/office.sdf",
        around=CLASSIC_WORLD.replace("<light", '<physics name="p" type="ode">@</physics><light'),
        files=FOR_CLASSIC | {LAUNCH_FILE: CLASSIC_LAUNCH},
        distro="humble",
    ),
    "WLD071": simulated_world(
        f'@<world name="w">{SURROUNDINGS}</world></sdf>', whole=True, distro="fortress"
    ),
    "ROB038": robot(
        f'<link name="base_link">@{SHAPES}</link>'.replace("0.1 0.1 0.1", "0.7 0.7 0.7")
    ),
    "ROB051": robot(
        BODY + "@",
        dots=(
            'filename="gz-sim-velocity-control-system" name="gz::sim::systems::VelocityControl"',
        ),
        swaps=(('<link name="base_footprint"/>', '<link name="base_footprint"></link>'),),
    ),
    "ROB052": xacro(
        ARM + joint("arm") + "<gazebo>@</gazebo>",
        good=ARM
        + joint("arm")
        + "<gazebo>@</gazebo>"
        + put(
            IN_CONTROL, '<joint name="arm_joint"><command_interface name="position"/></joint>'
        ).replace("gz_ros2_control/GazeboSimSystem", "gazebo_ros2_control/GazeboSystem"),
        swaps=(
            (
                '.so"/>',
                '.so"><parameters>$(find my_robot)/config/controllers.yaml</parameters></plugin>',
            ),
        ),
        files=YAML,
        distro="humble",
    ),
    "ROB102": robot(WHEELS + "@", dots=(ends("left_wheel"), ends("right_wheel"))),
    "ROB107": simulated(
        SENSED + '<gazebo reference="camera_link">@</gazebo>',
        good=BODY
        + link("laser_link")
        + joint("laser_link", kind="fixed")
        + '<gazebo reference="laser_link">@</gazebo>',
        dots=(SENSOR,),
    ),
    "ROB126": replace(simulated(MESHED), files=MESHED_FILES),
    "ROB127": replace(
        simulated(MESHED),
        files=MESHED_FILES
        | {LAUNCH_FILE: GZ + CREATE + "Node(package='rviz2', executable='rviz2')])\n"},
    ),
    "ROB128": robot(
        BODY + link("lidar_link") + "@",
        good=BODY + link("lidar_link") + joint("lidar_link", kind="fixed") + "@",
        dots=(SENSOR,),
    ),
    "ROB129": robot(DRIVES + "@"),
    "ROB131": robot(IN_REVOLUTE),
    "ROB132": robot(BODY + link("carriage") + "@"),
    "ROB133": xacro(
        ARM
        + joint("arm")
        + link("gripper")
        + joint("gripper", parent="arm")
        + CONTROL_PLUGIN
        + "@",
        dots=(HARDWARE, COMMANDS, HARDWARE, COMMANDS),
        files=YAML,
    ),
    "ROB144": robot(
        WHEELS
        + joint(
            "right_wheel",
            '<parent link="base_link"/><child link="right_wheel"/><origin xyz="0 -0.2 0"/>'
            '<axis xyz="0 1 0"/>',
            kind="continuous",
        )
        + "@"
        + DRIVES.removeprefix(WHEELS + WHEEL_JOINTS)
    ),
    "ROB145": robot(BODY + "@" + joint("wheel", kind="continuous"), is_good_code=False),
    "ROB134": robot(DRIVES.replace("</plugin>", "@</plugin>")),
    "ROB130": robot(
        DRIVES + "@",
        good=DRIVES + link("caster") + joint("caster", kind="fixed") + "@",
        dots=(ends("caster", more='<origin xyz="-0.2 0 -0.05"/>'), BOX),
    ),
    "ROB121": robot(
        BODY + link("wheel") + "@",
        good=BODY + link("camera") + "@",
        dots=(ends("wheel"),),
        good_dots=(ends("camera"),),
    ),
    "WLD048": world(put(IN_WORLD, f"@{sdf_link('link')}</model>{sdf_link('other', 1)}</model>")),
    "ROB092": xacro(
        CONTROLLED + '<ros2_control name="arm" type="system"><hardware>@</hardware>'
        '<joint name="arm_joint"><command_interface name="position"/></joint></ros2_control>',
        files=YAML,
    ),
    "WLD004": in_classic("@"),
    "WLD006": Plant(
        file="worlds/office.sdf",
        around=put(SDF.replace("1.9", "1.6"), "@"),
        files=FOR_CLASSIC | {LAUNCH_FILE: CLASSIC_LAUNCH},
        distro="humble",
    ),
    "PKG074": package(manifest("").replace("  <export>", "  @\n  <export>"), distro="unknown"),
    "PKG079": package(
        in_manifest().replace(
            "  <export>", "  <exec_depend>rosidl_default_runtime</exec_depend>\n  <export>"
        ),
        files=MESSAGES,
    ),
    "PKG080": package(in_manifest(), files=MESSAGES),
    "PKG082": package(
        swaps=(
            (
                ">",
                (
                    "><name>my_robot</name><version>0.1.0</version><description>A</description>"
                    '<maintainer email="a@b.cd">A</maintainer><license>MIT</license>'
                    "<buildtool_depend>ament_cmake</buildtool_depend>"
                ),
            ),
            ("</package>", "<export><build_type>ament_cmake</build_type></export></package>"),
        ),
    ),
    "PKG084": package(
        in_manifest("<exec_depend>xacro</exec_depend>"),
        files=SIMULATED | {LAUNCH_FILE: ALL_OF_IT},
    ),
    "PKG086": package(
        in_manifest(),
        files={
            "CMakeLists.txt": COMPILED + "add_executable(my_node src/my_node.cpp)\n"
            "install(TARGETS my_node DESTINATION lib/${PROJECT_NAME})\nament_package()\n"
        }
        | CPP,
        is_good_code=False,
    ),
    "PKG088": build(
        files={"package.xml": put(in_manifest(), "<depend>rclcpp</depend>")},
    ),
    "BLD040": setup(
        "from setuptools import setup\npackage_name = 'my_robot'\n@\n",
        swaps=(("version='0.1.0',", f"version='0.1.0', packages=['my_robot'], {MARKED}"),),
    ),
    "BLD044": setup(
        "from setuptools import setup\npackage_name = 'my_robot'\n@\n",
        swaps=(
            (
                "[(",
                "[('share/ament_index/resource_index/packages', ['resource/' + package_name]), (",
            ),
            ("setup(", "setup(name=package_name, packages=['my_robot'], "),
        ),
    ),
    "BLD060": Plant(
        file="scripts/my_node.py",
        around="@\nimport rclpy\n\nif __name__ == '__main__':\n    rclpy.init()\n",
        files={
            "CMakeLists.txt": cmake(
                "", "install(PROGRAMS scripts/my_node.py DESTINATION lib/${PROJECT_NAME})\n"
            ),
            "package.xml": put(in_manifest(), "<exec_depend>rclpy</exec_depend>"),
        },
    ),
    "BLD065": setup(
        SETUP.replace(DATA, DATA + "        ('share/' + package_name + '/launch', @\n        ),\n"),
        files={"launch/robot_launch.py": LAUNCH_DESCRIPTION},
    ),
    "LCH007": launch(
        put(BEFORE, "description = @"),
        swaps=(("my_robot_desription", "rviz3"), ("my_robot_description", "rviz2")),
    ),
    "LCH014": launch(put(BEFORE, "path = '/no/file'\n@"), good=put(BEFORE, "@")),
    "LCH034": launch(
        IMPORTS + "source = PythonLaunchDescriptionSource(os.path.join(share, 'launch',"
        " 'world.launch.py'))\n" + RETURN + "@,\n" + PUBLISH + CLOCK + CREATE + "])\n",
        files={
            "launch/world.launch.py": IMPORTS
            + START.replace("-r ', world", "-r ', LaunchConfiguration('world')")
            + RETURN
            + "DeclareLaunchArgument('world', default_value=world),\nsimulator])\n"
        },
        swaps=((": path}", ": world}"),),
    ),
    "LCH035": launch(
        IMPORTS.replace("Command(['xacro ', path])", "@")
        + GZ.removeprefix(IMPORTS)
        + CREATE
        + "])\n",
        files={
            "urdf/my_robot.urdf.xacro": put(
                XACRO,
                '<xacro:arg name="length" default="0.5"/><!-- m -->'
                + STANDING.replace('size="0.1 0.1 0.1"', 'size="0.1 0.1 ${$(arg length) / 5}"'),
            )
        },
    ),
    "LCH065": launch(
        put(BEFORE, "@").replace("return LaunchDescription([", "return LaunchDescription([view,"),
        dots=("package='rviz2', executable='rviz2'",),
        swaps=(("Node(", "view = Node("),),
    ),
    "LCH076": launch(
        GZ
        + CREATE.replace("'-z'", "'-name', 'r', '-z'")
        + "Node(package='ros_gz_bridge', executable='parameter_bridge',\n@\n),\n])\n",
    ),
    "LCH078": launch(
        BY_HAND,
        swaps=(
            ("# controllers.yaml: controller_manager: ros__parameters: diff_cont: type: ...\n", ""),
        ),
        files={
            "urdf/my_robot.urdf.xacro": put(
                XACRO,
                ARM
                + joint("arm")
                + CONTROL_PLUGIN
                + put(
                    IN_CONTROL,
                    '<joint name="arm_joint"><command_interface name="position"/></joint>',
                ),
            ),
            "config/controllers.yaml": CONTROLLERS.replace(
                "joint_state_broadcaster:", "diff_cont:"
            ),
        },
    ),
    "LCH079": Plant(
        file="config/controllers.yaml",
        around="controller_manager:\n  ros__parameters:\n    update_rate: 100\n    @\n",
        swaps=(("\n  ", "\n      "),),
        files={
            "urdf/my_robot.urdf.xacro": put(
                XACRO,
                ARM
                + joint("arm")
                + CONTROL_PLUGIN
                + put(
                    IN_CONTROL,
                    '<joint name="arm_joint"><command_interface name="position"/></joint>',
                ),
            )
        },
    ),
    "LCH080": launch(
        BY_HAND,
        swaps=(
            (
                "\n\n# CMakeLists.txt\ninstall(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
                "",
            ),
        ),
        files={
            "rviz/other.rviz": "Panels: []\n",
            "CMakeLists.txt": cmake("launch urdf worlds rviz"),
        },
        is_good_code=False,
    ),
    "SPN004": launch(CLASSIC + PUBLISH + put(SPAWNED, "@\n") + "])\n", distro="humble"),
    "ROB066": robot(
        '<link name="base_link"><inertial><mass value="1000"/><inertia ixx="0.0017" ixy="0" ixz="0"'
        ' iyy="0.0017" iyz="0" izz="0.0017"/></inertial><visual><geometry>@</geometry></visual>'
        "<collision><geometry>@</geometry></collision></link>".replace("1000", "1"),
        files={"meshes/arm_in_mm.stl": "STL_MM"},
    ),
    "LCH067": launch(
        GZ + "@\n])\n",
        swaps=(
            ("gz_sim.launch.py of ros_gz_sim, and\n", ""),
            ("...", "arguments=['-topic', 'robot_description', '-entity', 'my_robot']"),
        ),
    ),
    "LCH084": launch(
        IMPORTS + "source = PythonLaunchDescriptionSource(os.path.join(share, 'launch',"
        " 'view.launch.py'))\n" + RETURN + "@])\n",
        files={"launch/view.launch.py": IMPORTS + RETURN + "LogInfo(msg='view')])\n"},
    ),
    "SPN053": launch(CLASSIC + PUBLISH + SPAWNED + "])\n", files=LYING, distro="humble"),
    "SPN054": launch(CLASSIC + PUBLISH + SPAWNED + "])\n", files=LYING, distro="humble"),
    "ROB017": launch(
        BEFORE.replace("text,", "robot_description,"),
        is_good_code=False,
        swaps=(("'robot.urdf.xacro'", "path"),),
        files={
            "urdf/my_robot.urdf.xacro": put(
                XACRO, '<xacro:property name="size" value="0.1"/>' + STANDING
            ).replace("0.1 0.1 0.1", "${size} 0.1 0.1")
        },
    ),
    "ROB143": launch(
        BEFORE.replace("text,", "robot_description,"),
        is_good_code=False,
        swaps=(("'robot.urdf.xacro'", "path"),),
        files={
            "urdf/my_robot.urdf.xacro": put(
                XACRO, STANDING + '<xacro:if value="true"><gazebo/></xacro:if>'
            )
        },
    ),
    "ROB110": xacro(
        ARM
        + joint("arm")
        + put(IN_CONTROL, '<joint name="arm_joint"><command_interface name="position"/></joint>')
        + '<gazebo><plugin filename="gz_ros2_control-system" '
        'name="gz_ros2_control::GazeboSimROS2ControlPlugin">@</plugin></gazebo>',
        files=YAML,
    ),
    "ROB111": Plant(
        file="config/controllers.yaml",
        around=DIFF_CONTROLLER + "@\n    right_wheel_names: [right_wheel_joint]\n",
        files=COMMANDED | {LAUNCH_FILE: WITH_SPAWNER},
    ),
    "ROB112": Plant(
        file="urdf/my_robot.urdf.xacro",
        around=put(COMMANDED_ROBOT, "@"),
        swaps=(("# and a diff_drive_controller, which commands velocities", ""),),
        files={
            "config/controllers.yaml": DIFF_CONTROLLER + "diff_drive_controller:\n"
            "  ros__parameters:\n    left_wheel_names: [left_wheel_joint]\n"
            "    right_wheel_names: [right_wheel_joint]\n",
            LAUNCH_FILE: WITH_SPAWNER,
            "worlds/office.sdf": SIMULATED["worlds/office.sdf"],
        },
    ),
    "LCH097": Plant(
        file="scripts/talk.py",
        around=IN_NODE.replace("import Twist", "import Twist, TwistStamped"),
        files={
            **COMMANDED,
            **node("").files,
            LAUNCH_FILE: WITH_SPAWNER,
            "config/controllers.yaml": DIFF_CONTROLLER + "diff_drive_controller:\n"
            "  ros__parameters:\n    left_wheel_names: [left_wheel_joint]\n"
            "    right_wheel_names: [right_wheel_joint]\n",
            "CMakeLists.txt": cmake(
                "config launch urdf worlds",
                "install(PROGRAMS scripts/talk.py DESTINATION lib/${PROJECT_NAME})\n",
            ),
        },
    ),
    "LCH098": Plant(
        file="scripts/talk.py",
        around=IN_NODE.replace(
            "import rclpy\n", "import rclpy\nfrom sensor_msgs.msg import LaserScan\n"
        ),
        files={
            **SIMULATED,
            **node("").files,
            LAUNCH_FILE: GZ
            + CREATE
            + "Node(package='ros_gz_bridge', executable='parameter_bridge', arguments=["
            "'/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan']),\n])\n",
            "CMakeLists.txt": cmake(
                "launch urdf worlds",
                "install(PROGRAMS scripts/talk.py DESTINATION lib/${PROJECT_NAME})\n",
            ),
        },
        is_good_code=False,
    ),
    "ROB150": Plant(
        file="config/controllers.yaml",
        around=DIFF_CONTROLLER + "@\n    right_wheel_names: [right_wheel_joint]\n"
        "    wheel_radius: 0.1\n",
        files=COMMANDED | {LAUNCH_FILE: WITH_SPAWNER},
        is_good_code=False,
    ),
    "LCH099": Plant(
        file="config/controllers.yaml",
        around=DIFF_CONTROLLER
        + "@\n    wheel_separation: 0.5\n    left_wheel_names: [left_wheel_joint]\n"
        "    right_wheel_names: [right_wheel_joint]\n",
        files=COMMANDED | {LAUNCH_FILE: WITH_SPAWNER},
        is_good_code=False,
    ),
    "ROB113": Plant(
        file="config/controllers.yaml",
        swaps=(("[shoulder, elbow]", "[left_wheel_joint]"), ("[position]", "[velocity]")),
        files=COMMANDED
        | {LAUNCH_FILE: WITH_SPAWNER.replace("diff_drive_controller", "arm_controller")},
    ),
    "WLD001": build(
        files=SIMULATED
        | {
            LAUNCH_FILE: ALL_OF_IT.replace("'office.sdf'", "'office.world'"),
            "worlds/office.sdf": None,
            "worlds/office.world": SIMULATED["worlds/office.sdf"],
            "CMakeLists.txt": "",
        },
        swaps=(
            ("# launch file\nworld = os.path.join(share, 'worlds', 'office.world')\n\n", ""),
            ("DIRECTORY launch", "DIRECTORY launch urdf"),
        ),
    ),
    "WLD008": launch(
        IMPORTS + START.replace(GZ_ARGS, "@") + GZ.removeprefix(IMPORTS + START) + CREATE + "])\n",
        files={
            "worlds/office.sdf": None,
            "worlds/my_world.sdf": SIMULATED["worlds/office.sdf"],
        },
    ),
    "WLD024": world(
        put(
            IN_MODEL,
            TWO_JOINTED + "@<parent>base_link</parent><child>bar</child>" + AXIS + "</joint>",
        ),
        is_good_code=False,
    ),
    "WLD025": world(put(IN_MODEL, f"{TWO_JOINTED}@{LEVER}")),
    "WLD040": world(
        put(IN_WORLD, '<model name="m"><link name="link">@</link></model>').replace("1.9", "1.11"),
        dots=("<uri>model://my_robot/meshes/arm.stl</uri>",),
        good_dots=("<ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz>",),
        swaps=(("</mesh>", "</mesh></geometry></collision>"),),
        files={"meshes/arm.stl": "STL"},
    ),
    "WLD043": launch(
        GZ + put(CREATED, "@") + "])\n",
        swaps=(("'worlds/field.sdf'", "world"),),
        is_good_code=False,
    ),
    "WLD054": world(STATIC_GEOMETRY, good=STATIC_COLLISION, files=HILL),
    "WLD056": world(
        put(IN_WORLD, "@</link></model>"),
        swaps=(
            (
                "…<heightmap>…",
                (
                    f"{SDF_INERTIAL}<collision name='c'><geometry><heightmap>"
                    "<uri>model://hill/hill.png</uri></heightmap></geometry></collision>"
                ),
            ),
        ),
        files=HILL,
    ),
    "WLD061": launch(
        IMPORTS + START.replace(GZ_ARGS, "@") + GZ.removeprefix(IMPORTS + START) + CREATE + "])\n",
        files={
            "worlds/office.sdf": None,
            "worlds/shapes.sdf": SIMULATED["worlds/office.sdf"],
        },
    ),
    "WLD064": simulated_world(
        f'<world name="w">{SYSTEMS.removeprefix(PHYSICS)}{GROUND}{LIGHT}@</world>',
        good=put(SDF, f'<world name="w">{SYSTEMS.removeprefix(PHYSICS)}{GROUND}{LIGHT}@</world>'),
    ),
    "LCH045": launch(BY_HAND, is_good_code=False),
    "LCH046": launch(
        "from launch_ros.substitutions import FindPackageShare\n" + GZ + CREATE + "@])\n",
        is_good_code=False,
        files={
            "package.xml": put(in_manifest(), "<exec_depend>nav2_bringup</exec_depend>"),
        },
    ),
    "SPN012": build(
        files=FOR_CLASSIC
        | {
            LAUNCH_FILE: CLASSIC
            + "Node(package='gazebo_ros', executable='spawn_entity.py', arguments=['-file',"
            " os.path.join(share, 'model', 'my_robot.urdf'), '-entity', 'r']),\n])\n",
            "model/my_robot.urdf": STANDING,
            "urdf/my_robot.urdf.xacro": None,
        },
        swaps=(("DIRECTORY launch", "DIRECTORY worlds launch"),),
        distro="humble",
    ),
    "ROB140": robot(ARM + joint("arm").replace('<origin xyz="0 0 0.2"/>', "@")),
}

TABLES = (OTHERS, ROBOTS, WORLDS, PACKAGES, BUILDS, LAUNCHES)
PLANTS: dict[str, Plant] = {code: plant for table in TABLES for code, plant in table.items()}

# ---- what cannot be planted ----------------------------------------------------------------------

NOT_PLANTED: dict[str, tuple[str, ...]] = {
    "a run of wsgen build": (
        *("PKG052", "BLD001", "BLD002", "BLD004", "BLD005", "BLD006", "BLD007", "BLD008", "BLD013"),
        *("BLD014", "BLD015", "BLD016", "BLD017", "BLD018", "BLD019", "BLD020", "BLD023", "BLD024"),
        *("BLD025", "BLD026", "BLD030", "BLD032", "BLD048", "BLD067", "BLD070"),
    ),
    "a run of wsgen validate": (
        *("BLD069", "PKG050", "PKG051", "PKG065", "PKG066", "PKG067", "ROB142", "WLD042", "LCH033"),
        *("SPN003", "SPN089", "SPN097", "SPN098", "SPN099", "SPN100", "SPN101", "SPN102"),
        *("SPN108", "SPN109", "SPN110", "SPN111"),
    ),
    "a simulation": (
        *("SPN031", "SPN032", "SPN033", "SPN034", "SPN035", "SPN050", "SPN051", "SPN052", "SPN055"),
        *("SPN056", "SPN057", "SPN058", "SPN059", "SPN060", "SPN061", "SPN062", "SPN063", "SPN064"),
        *(
            "SPN065",
            "SPN066",
            "SPN067",
            "SPN070",
            "SPN071",
            "SPN080",
            "SPN081",
            "SPN082",
            "SPN083",
            "SPN084",
        ),
        *("SPN085", "SPN086", "SPN087", "SPN088", "SPN090"),
    ),
    "a template": ("TPL001", "TPL002", "TPL003", "TPL004", "TPL005", "TPL006"),
    "an example that is a path, a command or a sentence": (
        *("PKG002", "PKG003", "PKG007", "PKG010", "PKG077", "BLD021", "ROB057", "ROB062", "ROB063"),
        *("ROB064", "ROB065", "ROB072", "ROB074", "ROB123", "WLD053", "WLD055", "LCH018", "LCH032"),
        *("LCH066", "SPN092"),
    ),
    "a mesh, an image or a file with what the example shows": (
        *("ROB067", "ROB073", "ROB075", "ROB076", "ROB114", "WLD031", "WLD051"),
    ),
    "an example that shows a part of what is wrong": (
        *("WLD014", "WLD060", "LCH024", "LCH090", "SPN001", "SPN091"),
    ),
    "a launch that is started": ("LCH091", "LCH100", "LCH101"),
    "several packages": ("PKG090",),
    "a launch file that runs for long, or in two processes": ("LCH012", "LCH025"),
}
