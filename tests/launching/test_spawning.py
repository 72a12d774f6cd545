"""Simulators and robots are read from plans; mistakes of spawners are diagnostics."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from install_space import HEAD, InstallSpace
from wsgen.diagnostics import Severity
from wsgen.launching.spawning import assume_spawn, find_spawns
from wsgen.model.plan import STARTS_UNKNOWN, Include, LaunchPlan, Process, Unresolved
from wsgen.model.world import Spawn, SpawnHeight

URDF = "<robot name='r'/>"


def plan(*processes: Process, includes: tuple[Include, ...] = ()) -> LaunchPlan:
    return LaunchPlan(
        package="p", launch_file=Path("p.launch.py"), processes=processes, includes=includes
    )


def publisher(description: Any = URDF, **keywords: Any) -> Process:
    return Process(
        package="robot_state_publisher",
        executable="robot_state_publisher",
        parameters={"robot_description": description},
        **keywords,
    )


def spawner(*arguments: str, **keywords: Any) -> Process:
    return Process(
        package="gazebo_ros",
        executable="spawn_entity.py",
        arguments=arguments,
        file=Path("p.launch.py"),
        line=7,
        **keywords,
    )


def create(*arguments: str, **keywords: Any) -> Process:
    return Process(package="ros_gz_sim", executable="create", arguments=arguments, **keywords)


def only_spawn(*processes: Process) -> Spawn:
    (spawn,), diagnostics = find_spawns(plan(*processes))
    assert not diagnostics
    return spawn


def only_error(*processes: Process) -> tuple[str, str]:
    spawns, (diagnostic,) = find_spawns(plan(*processes))
    assert not spawns
    assert diagnostic.hint
    return diagnostic.code, diagnostic.message


def test_topic_and_pose() -> None:
    spawn = only_spawn(
        spawner(
            *[
                "-topic",
                "robot_description",
                "-entity",
                "e",
                "-x",
                "1",
                "-y",
                "-2",
                "-z=.5",
                "-R",
                "0.1",
                "-P",
                "0.2",
                "-Y=-3",
            ]
        ),
        publisher(),
    )
    assert (spawn.entity, spawn.description, spawn.description_file) == ("e", URDF, None)
    assert spawn.pose_in_world.xyz == (1.0, -2.0, 0.5)
    assert spawn.pose_in_world.rpy == (0.1, 0.2, -3.0)
    assert spawn.process is not None
    assert spawn.process.line == 7


def test_a_model_keeps_its_own_name() -> None:
    words = ("-topic", "robot_description", "-entity", "")
    assert only_spawn(spawner(*words), publisher()).entity == "r"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("node", "is_given", "launch_argument"),
    [
        ("arguments=['-topic', 'd', '-entity', 'e']", False, None),
        ("arguments=['-topic', 'd', '-entity', 'e', '-z', '0.0']", True, None),
        (
            "arguments=['-topic', 'd', '-entity', 'e', '-z', LaunchConfiguration('up')]",
            True,
            "up",
        ),
    ],
)
def test_where_the_height_is_given(
    space: InstallSpace, node: str, *, is_given: bool, launch_argument: str | None
) -> None:
    text = f"""{HEAD}
def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('x', default_value='0.0'),
        DeclareLaunchArgument('up', default_value='0.0'),
        Node(package='robot_state_publisher', executable='robot_state_publisher',
             parameters=[{{'robot_description': '<robot/>'}}],
             remappings=[('robot_description', 'd')]),
        Node(package='gazebo_ros', executable='spawn_entity.py', {node}),
    ])
"""
    file = space.add("my_robot", {"launch/r.launch.py": text}) / "launch/r.launch.py"
    evaluated = space.evaluate(file)
    assert evaluated.diagnostics == ()
    (spawn,), diagnostics = find_spawns(evaluated)
    assert not diagnostics
    assert spawn.height == SpawnHeight(
        file=file,
        line=text[: text.index("spawn_entity")].count("\n") + 1,
        option="-z",
        holder="the arguments of spawn_entity.py",
        is_given=is_given,
        launch_argument=launch_argument,
    )


def test_where_the_height_is_given_that_is_a_parameter() -> None:
    source = {"topic": "robot_description"}
    spawn = only_spawn(create(parameters=source, line=3), publisher())
    assert spawn.height is not None
    assert (spawn.height.option, spawn.height.is_given) == ("z", False)
    assert spawn.height.holder == "the parameters of create"


def test_namespaces() -> None:
    plans = plan(
        publisher("<robot name='a'/>", namespace="/a"),
        publisher("<robot name='b'/>", namespace="/b"),
        spawner("-topic", "/b/robot_description", "-entity", "b"),
        spawner("-topic", "robot_description", "-entity", "a", namespace="/a"),
    )
    spawns, diagnostics = find_spawns(plans)
    assert not diagnostics
    assert [(spawn.entity, spawn.description) for spawn in spawns] == [
        ("b", "<robot name='b'/>"),
        ("a", "<robot name='a'/>"),
    ]


def test_remapped_topic() -> None:
    only_spawn(
        publisher(remappings=(("robot_description", "/r1/urdf"),)),
        spawner("-topic", "r1/urdf", "-entity", "e"),
    )


def test_file(tmp_path: Path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(URDF)
    spawn = only_spawn(spawner("-file", str(file), "-entity", "e"))
    assert (spawn.description, spawn.description_file) == (URDF, file)


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        ("-topic robot_description", "SPN004", "-entity, the name of the model"),
        ("-topic robot_description -entity", "SPN004", "-entity"),
        ("-topic robot_description -entity e -q 1", "SPN004", "does not know '-q'"),
        ("-topic robot_description -entity e -x one", "SPN005", "-x of the spawner is 'one'"),
        ("-topic robot_description -entity e -x nan", "SPN005", "not a finite number"),
        ("-topic robot_description -entity e -x=inf", "SPN005", "not a finite number"),
        ("-stdin -entity e", "SPN007", "standard input"),
        ("-entity e", "SPN004", "exactly one of -file, -topic"),
        ("-topic robot -entity e", "SPN008", "/robot, and no robot_state_publisher"),
        ("-file /no/r.urdf -entity e", "SPN012", "'/no/r.urdf'"),
        # As every device, it is not opened: of some there is no end.
        ("-file /dev/null -entity e", "SPN012", "'/dev/null': it is a device"),
    ],
)
def test_wrong_arguments(arguments: str, code: str, words: str) -> None:
    spawns, diagnostics = find_spawns(plan(spawner(*arguments.split()), publisher()))
    assert not spawns
    assert {diagnostic.code for diagnostic in diagnostics} == {code}
    assert any(words in diagnostic.message for diagnostic in diagnostics)


def test_two_sources() -> None:
    code, message = only_error(
        spawner("-topic", "robot_description", "-file", "x", "-entity", "e"), publisher()
    )
    assert code == "SPN004"
    assert "is given -file and -topic" in message


def test_options_glued_into_one_argument() -> None:
    _, diagnostics = find_spawns(
        plan(spawner("-topic robot_description", "-entity", "e"), publisher())
    )
    assert "a single argument" in diagnostics[0].message


@pytest.mark.parametrize(
    ("words", "z"),
    [
        (("-z 0.5",), 0.5),
        (("-z0.5", "-x -1.8"), 0.5),
        (("-z=0.5",), 0.5),
        (("-z", "-.5"), -0.5),
        (("-z", " 0.5 "), 0.5),
        (("-z=-5e-1",), -0.5),
    ],
)
def test_values_that_argparse_accepts(words: tuple[str, ...], z: float) -> None:
    spawn = only_spawn(publisher(), spawner("-topic", "robot_description", "-ent", "e", *words))
    assert spawn.entity == "e"
    assert spawn.pose_in_world.xyz[2] == z


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (("-x 1 -y 2",), "SPN005", "' 1 -y 2', which is not a finite number"),
        (("-z", "-5e-1"), "SPN004", "takes -5e-1 for an option"),
        (("-t", "3"), "SPN004", "ambiguous option"),
        (("-b 1",), "SPN004", "ignored explicit argument"),
        (("-timeout 60",), "SPN004", "'-timeout 60' is a single argument"),
        (("-timeout", "long"), "SPN004", "invalid float value"),
        (("--z", "1"), "SPN004", "does not know '--z'"),
    ],
)
def test_values_that_argparse_refuses(words: tuple[str, ...], code: str, said: str) -> None:
    program = spawner("-topic", "robot_description", "-entity", "e", *words)
    found, message = only_error(program, publisher())
    assert found == code
    assert said in message


@pytest.mark.parametrize(
    ("words", "hint"),
    [
        (("-topicrobot_description", "-entity", "e"), "'-topic', 'robot_description'"),
        (("-topics", "robot_description", "-entity", "e"), "Did you mean `-topic`?"),
        (("-topic", "robot_description", "-entity", "e", "-z", "0,3"), "with a point: 0.3"),
        (("-topic", "robot_description", "-entity", "e", "-z", "high"), "Give meters"),
    ],
)
def test_what_to_write_for_a_missing_comma_and_a_decimal_one(
    words: tuple[str, ...], hint: str
) -> None:
    _, found = find_spawns(plan(spawner(*words), publisher()))
    assert hint in (found[0].hint or "")


def test_create_takes_no_value_in_the_word_of_its_option() -> None:
    (spawn,), (found,) = find_spawns(
        plan(publisher(), create("-topic", "robot_description", "-z 0.5", "-x", "-1e-3"))
    )
    assert spawn.pose_in_world.xyz == (-1e-3, 0, 0)
    assert "'-z 0.5' is a single argument of create" in found.message
    assert found.severity is Severity.WARNING


def test_nobody_publishes() -> None:
    code, message = only_error(spawner("-topic", "robot_description", "-entity", "e"))
    assert code == "SPN008"
    assert "it does not start robot_state_publisher" in message


@pytest.mark.parametrize("description", ["", " \n", "/path/r.urdf", 3, ["<robot/>"]])
def test_description_that_is_none(description: Any) -> None:
    code, _ = only_error(
        spawner("-topic", "robot_description", "-entity", "e"), publisher(description)
    )
    assert code == "SPN011"


def test_publisher_without_description() -> None:
    bare = Process(package="robot_state_publisher", executable="robot_state_publisher")
    code, _ = only_error(spawner("-topic", "robot_description", "-entity", "e"), bare)
    assert code == "SPN009"


def test_publisher_with_a_file_as_argument(tmp_path: Path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(URDF)
    old = Process(
        package="robot_state_publisher",
        executable="robot_state_publisher",
        arguments=(str(file),),
    )
    assert only_spawn(spawner("-topic", "robot_description", "-entity", "e"), old)


def test_spawner_of_ros_1() -> None:
    code, _ = only_error(
        Process(package="gazebo_ros", executable="spawn_model", arguments=("-urdf",)), publisher()
    )
    assert code == "SPN002"


def test_no_spawner() -> None:
    assert assume_spawn(plan(publisher()))[1].code == "SPN003"


def test_create() -> None:
    spawn = only_spawn(
        create("-string", URDF, "--name", "e", "-x=1", "-allow-renaming", "true", "-z", "2")
    )
    assert (spawn.entity, spawn.description) == ("e", URDF)
    assert spawn.pose_in_world.xyz == (1.0, 0.0, 2.0)


def test_create_with_parameters() -> None:
    spawn = only_spawn(
        publisher(),
        create("-z", "1", parameters={"topic": "robot_description", "name": "e", "z": 0.5}),
    )
    assert spawn.entity == "e"
    assert spawn.pose_in_world.xyz == (0.0, 0.0, 0.5)


def test_create_from_a_parameter() -> None:
    assert only_spawn(create("-param", "d", parameters={"d": URDF})).description == URDF
    assert only_error(create("-param", "d"))[0] == "SPN010"


@pytest.mark.parametrize("option", ["-enity", "-name", "-model"])
def test_misspelled_option_is_one_error(option: str) -> None:
    process = spawner("-topic", "robot_description", option, "r")
    _, (found,) = find_spawns(plan(publisher(), process))
    assert f"'{option}'" in found.message
    assert "Did you mean `-entity`?" in (found.hint or "")


def test_option_without_value_is_one_error() -> None:
    assert (
        "-entity" in only_error(publisher(), spawner("-topic", "robot_description", "-entity"))[1]
    )


def test_misspelled_topic() -> None:
    process = spawner("-topic", "robot_descripton", "-entity", "r")
    _, (found,) = find_spawns(plan(publisher(), process))
    assert found.code == "SPN008"
    assert "Did you mean `/robot_description`?" in (found.hint or "")


def test_misspelled_parameter() -> None:
    wrong = Process(
        package="robot_state_publisher",
        executable="robot_state_publisher",
        parameters={"robot_descripton": URDF},
    )
    _, (found,) = find_spawns(plan(wrong, spawner("-topic", "robot_description", "-entity", "r")))
    assert found.code == "SPN009"
    assert found.hint == "Rename `robot_descripton` to `robot_description`."


GZ_SIM = "IncludeLaunchDescription([FindPackageShare('ros_gz_sim'), '/launch/gz_sim.launch.py'])"
CLASSIC = GZ_SIM.replace("ros_gz_sim", "gazebo_ros").replace("gz_sim.launch", "gazebo.launch")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("actions", "hint"),
    [
        (GZ_SIM, "Add a Node with package='ros_gz_sim', executable='create'"),
        (CLASSIC, "Add a Node with package='gazebo_ros', executable='spawn_entity.py'"),
        ("LogInfo(msg='')", "Give a launch file that starts a simulator and a spawner."),
    ],
)
def test_the_spawner_to_add_is_that_of_the_simulator(
    space: InstallSpace, actions: str, hint: str
) -> None:
    found = assume_spawn(space.play(actions))[1]
    assert found.code == "SPN003"
    assert (found.hint or "").startswith(hint)


@pytest.mark.slow
def test_a_robot_that_is_only_shown_can_be_tried_by_itself(
    space: InstallSpace, tmp_path: Path
) -> None:
    file = tmp_path / "r.urdf"
    file.write_text("<robot name='r'><link name='a'/></robot>")
    publisher = "Node(package='robot_state_publisher', executable='robot_state_publisher', "
    publisher += f"parameters=[{{'robot_description': open({str(file)!r}).read()}}])"
    found = assume_spawn(space.play(publisher))[1]
    assert (found.hint or "").endswith(f" wsgen validate {file}")


def run(*words: str, is_shell: bool = False) -> Process:
    return Process(package=None, executable=None, command=words, is_shell=is_shell, line=4)


FACTORY = "/w/create --reqtype gz.msgs.EntityFactory --reptype gz.msgs.Boolean"


@pytest.mark.parametrize(
    "process",
    [
        run(
            "ros2", "run", "gazebo_ros", "spawn_entity.py", "-topic", "d", "-entity", "e", "-z", "2"
        ),
        run("ros2 run ros_gz_sim create -topic d -name e -z 2", is_shell=True),
        run("bash", "-c", "sleep 1; ros2 run ros_gz_sim create -string '<robot/>' -name e -z 2"),
        run(
            "ros2",
            "run",
            "ros_gz_sim",
            "create",
            *["--ros-args", "-p", "topic:=d", "-p", "z:=2", "-p", "name:=e"],
        ),
        Process(
            package="ros_ign_gazebo",
            executable="create",
            arguments=("-topic", "d", "-name", "e", "-z", "2"),
        ),
        run(
            *("ros2", "service", "call", "/spawn_entity", "gazebo_msgs/srv/SpawnEntity"),
            '{name: "e", xml: "<robot/>", initial_pose: {position: {z: 2.0}}}',
        ),
        run(
            "ros2 service call /spawn_entity gazebo_msgs/SpawnEntity",
            "'{name: e, xml: \"<robot/>\", initial_pose: {position: {z: 2}}}'",
            is_shell=True,
        ),
        run(
            *("gz", "service", "-s", *FACTORY.split(), "--req"),
            'sdf: "<robot/>" name: "e" pose: {position: {z: 2}}',
        ),
        run(
            f"ign service -s {FACTORY.replace('gz.', 'ignition.')} --req",
            '\'sdf: "<robot/>", name: "e", pose: {position: {z: 2}}\'',
            is_shell=True,
        ),
    ],
)
def test_commands_that_spawn(process: Process) -> None:
    spawn = only_spawn(process, publisher("<robot/>", remappings=(("robot_description", "d"),)))
    assert (spawn.entity, spawn.description) == ("e", "<robot/>")
    assert spawn.pose_in_world.xyz == (0, 0, 2)
    assert spawn.height is not None
    assert spawn.height.is_given


def test_file_in_a_request(tmp_path: Path) -> None:
    file = tmp_path / "r.sdf"
    file.write_text("<sdf/>")
    words = ("gz", "service", *FACTORY.split(), "--req", f'sdf_filename: "{file}"')
    spawn = only_spawn(run(*words))
    assert (spawn.entity, spawn.description, spawn.description_file) == ("robot", "<sdf/>", file)


def test_orientation_in_a_request() -> None:
    words = ("ros2", "service", "call", "/spawn_entity", "gazebo_msgs/srv/SpawnEntity")
    request = "{xml: '<robot/>', initial_pose: {orientation: {z: 1.0, w: 1.0}}}"
    assert only_spawn(run(*words, request)).pose_in_world.rpy == pytest.approx((0, 0, 1.5707963))


@pytest.mark.parametrize(
    ("request_", "code"),
    [
        ("{name: e}", "SPN004"),
        ('{xml: "<robot name="r"/>"}', "SPN004"),
        ("{xml: '<robot/>', initial_pose: {position: {x: far}}}", "SPN005"),
    ],
)
def test_requests_that_fail(request_: str, code: str) -> None:
    words = ("ros2", "service", "call", "/spawn_entity", "gazebo_msgs/srv/SpawnEntity")
    assert only_error(run(*words, request_))[0] == code


def test_publisher_that_is_a_command() -> None:
    words = "ros2 run robot_state_publisher robot_state_publisher --ros-args -r __ns:=/a -p"
    process = run(*words.split(), "robot_description:=<robot/>")
    assert only_spawn(process, spawner("-topic", "/a/robot_description", "-entity", "e"))


@pytest.mark.parametrize(
    ("arguments", "uri"),
    [("-database cup -entity e", "model://cup"), ("-file model://cup -entity e", "model://cup")],
)
def test_models_that_gazebo_looks_up(arguments: str, uri: str) -> None:
    assert only_spawn(spawner(*arguments.split())).model_uri == uri


def test_a_file_of_a_package_of_ros_that_is_not_here() -> None:
    share = "/opt/ros/iron/share/crane_gazebo"
    code, message = only_error(spawner("-file", f"{share}/models/model.sdf", "-entity", "e"))
    assert code == "LCH007"
    assert "is in the package 'crane_gazebo', which was not found" in message
    code, _ = only_error(spawner("-file", "/ws/share/crane_gazebo/model.sdf", "-entity", "e"))
    assert code == "SPN012"


def test_what_is_not_known_may_publish() -> None:
    gazebo = Process(package=None, executable=None, command=("gzserver",))
    started = plan(gazebo, spawner("-topic", "robot_description", "-entity", "e"))
    unknown = Unresolved(what="moveit.demo()", why=STARTS_UNKNOWN)
    for unresolved, severity in (((), Severity.ERROR), ((unknown,), Severity.WARNING)):
        _, (found,) = find_spawns(replace(started, unresolved=unresolved))
        assert (found.code, found.severity) == ("SPN008", severity)


def test_models_that_create_looks_up_by_their_name(tmp_path: Path) -> None:
    assert only_spawn(create("-file", "my_cup")).model_uri == "model://my_cup"
    assert only_spawn(create("-file", str(tmp_path))).model_uri == str(tmp_path)
    assert only_error(create("-file", "my_cup.sdf"))[0] == "SPN012"
    assert only_error(spawner("-file", "my_cup", "-entity", "e"))[0] == "SPN012"


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("<robot name='crane'/>", "crane"),
        ("<sdf version='1.9'><model name='crane'/></sdf>", "crane"),
        ("<robot/>", "robot"),
        ("<robot name='crane'>", "robot"),
    ],
)
def test_model_that_is_given_no_name_has_its_own(text: str, name: str) -> None:
    assert only_spawn(create("-string", text)).entity == name
    request = ("gz", "service", *FACTORY.split(), "--req", f'sdf: "{text}"')
    assert only_spawn(run(*request)).entity == name


def test_create_ignores_what_it_does_not_know() -> None:
    (spawn,), (found,) = find_spawns(
        plan(publisher(), create("-topic", "robot_description", "-entity", "e"))
    )
    assert spawn.entity == "r"
    assert (found.code, found.severity) == ("SPN004", Severity.WARNING)
    assert "ignores '-entity'" in found.message


def test_create_is_not_told_what_to_spawn() -> None:
    _, (found,) = find_spawns(plan(publisher(), create("-topc", "robot_description")))
    assert (found.code, found.severity) == ("SPN004", Severity.ERROR)
    assert "'-topc'" in found.message


def test_create_takes_the_first_of_its_sources(tmp_path: Path) -> None:
    file = tmp_path / "r.urdf"
    file.write_text(URDF)
    spawn = only_spawn(
        publisher("<robot/>"), create("-topic", "robot_description", "-file", str(file))
    )
    assert spawn.description == URDF
    given = {"topic": "robot_description"}
    assert only_spawn(publisher(), create("-file", "no", parameters=given)).description == URDF


def unknown(*processes: Process) -> LaunchPlan:
    unresolved = (Unresolved(what="m.x()", why="it is not installed"),)
    return replace(plan(*processes), unresolved=unresolved)


@pytest.mark.parametrize(
    "processes",
    [
        (publisher("$(m.x())"), spawner("-topic", "robot_description", "-entity", "e")),
        (spawner("-file", "$(m.x())/r.urdf", "-entity", "e"),),
        (publisher(), spawner("-topic", "$(m.x())", "-entity", "e")),
    ],
)
def test_description_that_is_not_known_is_no_mistake(processes: tuple[Process, ...]) -> None:
    spawns, (found,) = find_spawns(unknown(*processes))
    assert not spawns
    assert (found.code, found.severity) == ("SPN091", Severity.WARNING)


def test_unknown_pose_and_name_have_their_defaults() -> None:
    words = ("-topic", "robot_description", "-name", "$(m.x())", "-x", "$(m.x())", "-y", "1")
    (spawn,), diagnostics = find_spawns(unknown(publisher(), create(*words)))
    assert not diagnostics
    assert (spawn.entity, spawn.pose_in_world.xyz) == ("r", (0, 1, 0))


GAZEBO = Process(package=None, executable=None, command=("gazebo", "w.world"))
GAZEBO_ROS = Include(
    package="gazebo_ros",
    file=Path("/opt/share/gazebo_ros/launch/gazebo.launch.py"),
    evaluated=False,
)


def test_topic_that_nobody_publishes_beside_a_simulator_is_an_error() -> None:
    reads = spawner("-topic", "robot_description", "-entity", "e")
    _, (found,) = find_spawns(plan(GAZEBO, reads))
    assert found.severity is Severity.ERROR
    _, (found,) = find_spawns(plan(reads, includes=(GAZEBO_ROS,)))
    assert found.severity is Severity.ERROR
    other = replace(GAZEBO_ROS, package="my_description")
    _, (found,) = find_spawns(plan(GAZEBO, reads, includes=(other,)))
    assert found.severity is Severity.WARNING


def own(executable: str = "spawn_me", *arguments: str) -> Process:
    return Process(package="my_robot", executable=executable, arguments=arguments)


@pytest.mark.parametrize(
    "processes",
    [
        (GAZEBO, publisher(), own()),
        (publisher(), own()),
        (GAZEBO, publisher(), own("put_it_there")),
        (GAZEBO, publisher(), run("python3", "/my/put.py")),
        (GAZEBO, publisher(), run("ros2", "run", "my_robot", "put_it_there")),
    ],
)
def test_spawner_of_somebodys_own(processes: tuple[Process, ...]) -> None:
    assert find_spawns(plan(*processes)) == ((), ())
    spawn, found = assume_spawn(plan(*processes))
    assert spawn is not None
    assert (spawn.entity, spawn.description, spawn.is_assumed) == ("r", URDF, True)
    assert (found.code, found.severity) == ("SPN092", Severity.INFO)


def test_spawner_of_somebodys_own_that_calls_the_service() -> None:
    found = plan(publisher(), own("put_it_there"))
    spawn, _ = assume_spawn(found, lambda program: program.executable == "put_it_there")
    assert spawn is not None
    assert spawn.entity == "r"
    assert assume_spawn(found, lambda _: False)[0] is None


def test_spawner_of_somebodys_own_that_is_given_a_file(tmp_path: Path) -> None:
    file = tmp_path / "r.sdf"
    file.write_text("<sdf version='1.6'><model name='m'/></sdf>")
    spawn, _ = assume_spawn(plan(GAZEBO, own("spawn", str(file), "r", "0.0")))
    assert spawn is not None
    assert (spawn.entity, spawn.description_file) == ("m", file)


@pytest.mark.parametrize(
    "processes",
    [
        (GAZEBO, publisher()),
        (GAZEBO, own()),
        (publisher(), own("put_it_there")),
        (GAZEBO, publisher(), Process(package="rviz2", executable="rviz2")),
        (GAZEBO, publisher(), Process(package="controller_manager", executable="spawner")),
        (GAZEBO, publisher(), run("ros2", "control", "list_controllers")),
    ],
)
def test_nothing_that_could_be_a_spawner(processes: tuple[Process, ...]) -> None:
    spawn, found = assume_spawn(plan(*processes))
    assert spawn is None
    assert found.code == "SPN003"


@pytest.mark.slow
def test_file_that_the_text_of_a_request_was_read_from(space: InstallSpace) -> None:
    share = space.add("my_robot", {"r.urdf": '<robot name="r">\n  <link name="a"/>\n</robot>\n'})
    xml = "open(get_package_share_directory('my_robot') + '/r.urdf').read().replace('\"', '\\\\\"')"
    words = "'ros2', 'service', 'call', '/spawn_entity', 'gazebo_msgs/srv/SpawnEntity'"
    for quote, is_shell in (("", False), ("'", True)):
        request = f'"{quote}{{name: r, xml: \\"" + {xml} + "\\"}}{quote}"'
        started = space.play(f"ExecuteProcess(cmd=[{words}, {request}], shell={is_shell})")
        (spawn,), diagnostics = find_spawns(started)
        assert not diagnostics
        assert spawn.description_file == share / "r.urdf"
