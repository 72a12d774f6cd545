"""What becomes of launch files in XML and YAML, to the letter."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.fixes.source import SourceText, apply
from wsgen.porting.launch_files import Context
from wsgen.porting.launch_markup import port_markup
from wsgen.porting.ported import BridgeRow

SCAN = BridgeRow("/scan", "LaserScan", "sensor_msgs/msg/LaserScan", "[", "/scan")
ODOM = BridgeRow("/model/r/odometry", "Odometry", "nav_msgs/msg/Odometry", "[", "/odom")
CLOCK = "/clock@rosgraph_msgs/msg/Clock[gz.msgs.Clock"
SCANS = "/scan@sensor_msgs/msg/LaserScan[gz.msgs.LaserScan"
ODOMS = "/model/r/odometry@nav_msgs/msg/Odometry[gz.msgs.Odometry"
INCLUDE = '  <include file="$(find-pkg-share {})/launch/{}.launch.py">\n{}  </include>\n'
CLASSIC, SIM = ("gazebo_ros", "gazebo"), ("ros_gz_sim", "gz_sim")
BRIDGE = '  <node pkg="ros_gz_bridge" exec="parameter_bridge" args="{}" output="screen"/>\n'


def ported(
    text: str,
    rows: dict[int, list[BridgeRow]] | None = None,
    *,
    file: str = "a.launch.xml",
    default_world: str | None = None,
) -> tuple[str, list[str]]:
    """The text afterwards, which a second port leaves as it is, and what is listed."""
    context = Context(rows=rows or {}, package="p", distro="jazzy", default_world=default_world)

    def port(before: str) -> tuple[str, list[str]]:
        found = port_markup(SourceText(Path("/nowhere") / file, before), context)
        return apply(before, found.edits), [f"{one.line}: {one.what}" for one in found.unported]

    after, listed = port(text)
    assert port(after)[0] == after
    return after, listed


def xml(*parts: str) -> str:
    return f"<launch>\n{''.join(parts)}</launch>\n"


@pytest.mark.parametrize(
    ("given", "gz_args"),
    [
        ({}, "-r empty.sdf"),
        ({"world": "$(find-pkg-share p)/a.world"}, "-r $(find-pkg-share p)/a.world"),
        ({"pause": "True"}, "empty.sdf"),
        ({"gui": "false"}, "-r -s empty.sdf"),
        ({"verbose": "$(var loud)"}, "-r $(if $(var loud) '-v 4 ' '')empty.sdf"),
        ({"pause": "true", "world": "w.sdf", "init": "true"}, "w.sdf"),
    ],
)
def test_arguments_of_the_simulator(given: dict[str, str], gz_args: str) -> None:
    arguments = "".join(
        f'    <arg name="{name}" value="{value}"/>\n' for name, value in given.items()
    )
    new = f'    <arg name="gz_args" value="{gz_args}"/>\n'
    assert ported(xml(INCLUDE.format(*CLASSIC, arguments))) == (
        xml(INCLUDE.format(*SIM, new), BRIDGE.format(CLOCK)),
        [],
    )


def test_declared_arguments_reach_the_simulator() -> None:
    """The included launch file sees them, whether they are given or not."""
    declared = '  <arg name="world" default="{}"/>\n  <arg name="gui" default="true"/>\n'
    new = "-r $(if $(var gui) '' '-s ')$(var world)"
    after, _ = ported(
        xml(declared.format(""), INCLUDE.format(*CLASSIC, "")), default_world="worlds/empty.sdf"
    )
    assert after == xml(
        declared.format("$(find-pkg-share p)/worlds/empty.sdf"),
        INCLUDE.format(*SIM, f'    <arg name="gz_args" value="{new}"/>\n'),
        BRIDGE.format(CLOCK),
    )


def test_the_two_halves_of_the_simulator() -> None:
    server, client = ("gazebo_ros", "gzserver"), ("gazebo_ros", "gzclient")
    world = '    <arg name="world" value="a.sdf"/>\n    <!-- fast -->\n'
    after, _ = ported(
        xml(
            INCLUDE.format(*server, world),
            '  <group if="$(var gui)">\n',
            INCLUDE.format(*client, ""),
            "  </group>\n",
        )
    )
    assert after == xml(
        INCLUDE.format(*SIM, '    <arg name="gz_args" value="-s -r a.sdf"/>\n    <!-- fast -->\n'),
        BRIDGE.format(CLOCK),
        '  <group if="$(var gui)">\n',
        INCLUDE.format(*SIM, '    <arg name="gz_args" value="-g"/>\n'),
        "  </group>\n",
    )


def test_the_spawner_and_its_bridge() -> None:
    before = (
        '  <!-- the robot -->\n  <node pkg="gazebo_ros" exec="spawn_entity.py" if="$(var sim)"\n'
        "        args=\"-topic robot_description -ent $(eval ' a + b ') -timeout 60\n"
        '              -x $(var x) -robot_namespace ns -unpause"/>\n'
    )
    after = (
        '  <!-- the robot -->\n  <node pkg="ros_gz_sim" exec="create" if="$(var sim)"\n'
        "        args=\"-topic robot_description -name $(eval ' a + b ')\n"
        '              -x $(var x)"/>\n'
        f'  <node pkg="ros_gz_bridge" exec="parameter_bridge" args="{SCANS} {ODOMS}" '
        'output="screen">\n    <remap from="/model/r/odometry" to="/odom"/>\n  </node>\n'
    )
    assert ported(xml(before), {3: [SCAN, ODOM, SCAN]}) == (
        xml(after),
        [],
    )
    robot_of_no_file = ["3: `-robot_namespace` of spawn_entity.py is gone, and which robot it was"]
    assert [one.partition(" for ")[0] for one in ported(xml(before))[1]] == robot_of_no_file
    dos, _ = ported(xml(before).replace("\n", "\r\n"), {3: [SCAN, ODOM]})
    assert dos == xml(after).replace("\n", "\r\n")


OWN = (
    BridgeRow("/model/{model}/scan", "LaserScan", SCAN.ros_type, "[", "/{namespace}/scan"),
    BridgeRow("/model/{model}/tf", "Pose_V", "tf2_msgs/msg/TFMessage", "[", "/tf"),
)


@pytest.mark.parametrize(
    ("model", "space", "topic", "attribute"),
    [
        ("rover", "/a", "/a/scan", ""),
        ("$(var name)", "$(var space)", "$(var space)/scan", ' namespace="/"'),
    ],
)
def test_the_bridge_of_a_robot_in_a_namespace(
    model: str, space: str, topic: str, attribute: str
) -> None:
    before = (
        '  <node pkg="gazebo_ros" exec="spawn_entity.py"\n'
        f'        args="-file a.sdf -entity {model} -robot_namespace {space}"/>\n'
    )
    after, listed = ported(xml(before), {2: [*OWN]})
    assert f"/model/{model}/scan@{SCAN.ros_type}[gz.msgs.LaserScan" in after
    assert f'output="screen"{attribute}>' in after
    assert f'<remap from="/model/{model}/scan" to="{topic}"/>' in after
    assert f'<remap from="/model/{model}/tf" to="/tf"/>' in after
    assert listed == []
    written = (
        "launch:\n- node:\n    pkg: gazebo_ros\n    exec: spawn_entity.py\n"
        f'    args: "-file a.sdf -entity {model} -robot_namespace {space}"\n'
    )
    after, listed = ported(written, {2: [*OWN]}, file="a.launch.yaml")
    assert f'- from: "/model/{model}/scan"\n        to: "{topic}"' in after
    assert ('    namespace: "/"\n' in after) == bool(attribute)
    assert listed == []


def test_commands() -> None:
    before = (
        '  <executable cmd="gzserver --verbose -s libgazebo_ros_init.so $(var w)"/>\n'
        '  <executable cmd="gzclient"/>\n  <executable cmd="gazebo -s libown.so"/>\n'
        '  <executable cmd="ls gazebo"/>\n'
    )
    after = (
        f'  <executable cmd="gz sim -s -r -v 4 $(var w)"/>\n{BRIDGE.format(CLOCK)}'
        '  <executable cmd="gz sim -g"/>\n  <executable cmd="gz sim -r empty.sdf"/>\n'
        '  <executable cmd="ls gazebo"/>\n'
    )
    assert ported(xml(before)) == (
        xml(after),
        ["4: `-s libown.so` of Gazebo Classic is gone."],
    )


def test_variables() -> None:
    """Where two become one, the second adds to it, if it does not do so already."""
    before = (
        '  <set_env name="GAZEBO_MODEL_PATH" value="$(find-pkg-share p)/models"/>\n'
        "  <!-- GAZEBO_RESOURCE_PATH too -->\n"
        '  <set_env name="GAZEBO_RESOURCE_PATH" value="/usr"/>\n'
        '  <set_env name="GAZEBO_MODEL_PATH" value="$(env GAZEBO_MODEL_PATH \'\'):/opt"/>\n'
    )
    after = (
        '  <set_env name="GZ_SIM_RESOURCE_PATH" value="$(find-pkg-share p)/models"/>\n'
        "  <!-- GAZEBO_RESOURCE_PATH too -->\n"
        '  <append_env name="GZ_SIM_RESOURCE_PATH" value="/usr"/>\n'
        '  <set_env name="GZ_SIM_RESOURCE_PATH" '
        "value=\"$(env GZ_SIM_RESOURCE_PATH ''):/opt\"/>\n"
    )
    assert ported(xml(before)) == (xml(after), [])


def test_what_has_no_counterpart_is_listed() -> None:
    text = xml(
        '  <node pkg="gazebo_ros" exec="gzserver"/>\n',
        INCLUDE.format(*CLASSIC, '    <arg name="physics" value="p.yaml"/>\n'),
    )
    assert [line.partition(" of ")[0] for line in ported(text)[1]] == [
        "2: `gzserver`",
        "3: The launch argument `physics`",
    ]


YAML = """launch:
  - arg: {name: gui, default: "true"}
  - set_env:
      name: GAZEBO_MODEL_PATH
      value: "$(find-pkg-share p)/models"
  # the simulator: GAZEBO_MODEL_PATH
  - include:
      file: "$(find-pkg-share gazebo_ros)/launch/gazebo.launch.py"
      arg:
        - name: "verbose"
          value: "true"
        - name: world
          value: $(var world)  # of ours

  - node:
      pkg: gazebo_ros
      exec: "spawn_entity.py"
      args: "-topic robot_description -entity r"
"""
PORTED_YAML = f"""launch:
  - arg: {{name: gui, default: "true"}}
  - set_env:
      name: GZ_SIM_RESOURCE_PATH
      value: "$(find-pkg-share p)/models"
  # the simulator: GAZEBO_MODEL_PATH
  - include:
      file: "$(find-pkg-share ros_gz_sim)/launch/gz_sim.launch.py"
      arg:
        - name: gz_args
          value: "-r -v 4 $(var world)"

  - node:
      pkg: ros_gz_sim
      exec: "create"
      args: "-topic robot_description -name r"
  - node:
      pkg: ros_gz_bridge
      exec: parameter_bridge
      args: "{CLOCK} {SCANS} {ODOMS}"
      remap:
        - from: "/model/r/odometry"
          to: "/odom"
      output: screen
"""


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_yaml(newline: str) -> None:
    rows = {15: [SCAN, ODOM]}
    after, listed = ported(YAML.replace("\n", newline), rows, file="a.launch.yaml")
    assert (after, listed) == (PORTED_YAML.replace("\n", newline), [])


def test_yaml_without_arguments() -> None:
    include = "launch:\n- include:\n    file: $(find-pkg-share {})/launch/{}.launch.py\n"
    after, _ = ported(include.format(*CLASSIC), file="a.launch.yaml")
    assert after == (
        include.format(*SIM)
        + '    arg:\n      - name: gz_args\n        value: "-r empty.sdf"\n'
        + "- node:\n    pkg: ros_gz_bridge\n    exec: parameter_bridge\n"
        + f'    args: "{CLOCK}"\n    output: screen\n'
    )


def test_quotes_in_values() -> None:
    world = "$(eval \"'a' + '.sdf'\")"
    xml_world = "value='$(eval &quot;a&quot;)'"
    after, _ = ported(xml(INCLUDE.format(*CLASSIC, f'    <arg name="world" {xml_world}/>\n')))
    assert '    <arg name="gz_args" value="-r $(eval &quot;a&quot;)"/>\n' in after
    text = (
        "launch:\n- include:\n    file: $(find-pkg-share gazebo_ros)/launch/gazebo.launch.py\n"
        f"    arg:\n    - name: world\n      value: {world}\n"
    )
    after, _ = ported(text, file="a.launch.yaml")
    assert "      value: '-r $(eval \"''a'' + ''.sdf''\")'\n" in after


def test_a_spawner_of_any_robot_has_the_topics_of_all() -> None:
    node = '  <node pkg="gazebo_ros" exec="spawn_entity.py" args="-entity $(var r)"/>\n'
    context = Context(rows={}, package="p", distro="jazzy", any_rows=[SCAN])
    source = SourceText(Path("/nowhere/a.launch.xml"), xml(node))
    port = port_markup(source, context)
    assert BRIDGE.format(SCANS) in apply(source.text, port.edits)
    assert [one.line for one in port.unported] == [2]
    assert port_markup(source, context._replace(are_all=True)).unported == ()
    known = context._replace(rows={2: []})
    assert port_markup(source, known).unported == ()
    assert "bridge" not in apply(source.text, port_markup(source, known).edits)
