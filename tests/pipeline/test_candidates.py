"""Which launch files are simulated, from plans alone."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.launching.explain import ARGUMENT_WITHOUT_VALUE, SYNTAX_ERROR, UNDEFINED_CONFIGURATION
from wsgen.launching.explain_missing import PACKAGE_NOT_FOUND, XACRO_FAILS
from wsgen.model.plan import Include, LaunchPlan, Process
from wsgen.model.transform import Pose
from wsgen.model.world import Simulator, Spawn
from wsgen.pipeline.candidates import Candidate, LaunchFile, choose, with_commands
from wsgen.pipeline.started import Started

GAZEBO = Simulator(kind="classic", world=None)


def robot(name: str, *, x: float = 0.0) -> Spawn:
    return Spawn(entity=name, description=f"<robot name='{name}'/>", pose_in_world=Pose((x, 0, 0)))


def candidate(
    name: str,
    *spawns: Spawn,
    simulator: Simulator | None = GAZEBO,
    includes: tuple[str, ...] = (),
    error: Diagnostic | None = None,
    package: str = "p",
) -> Candidate:
    plan = LaunchPlan(
        package=package,
        launch_file=Path(name),
        includes=tuple(Include(package=None, file=Path(one)) for one in includes),
        diagnostics=(error,) if error else (),
    )
    started = Started(
        plan, simulator, spawns, plan.diagnostics, bool(spawns), 0.1, is_evaluated=error is None
    )
    return Candidate(LaunchFile(package, Path(name)), started)


def chosen(*found: Candidate, kept: tuple[str, ...] = ()) -> list[str]:
    return [one.file.name for one in choose(found, kept=kept).chosen]


def reasons(*found: Candidate) -> list[str]:
    return [reason for _, reason in choose(found).others]


def error(rule: str, message: str = "m", file: str = "f", line: int | None = None) -> Diagnostic:
    return Diagnostic(
        name="n", code=rule, severity=Severity.ERROR, message=message, file=Path(file), line=line
    )


def test_what_spawns_into_a_simulator() -> None:
    found = (
        candidate("rviz", simulator=None),
        candidate("sim", robot("r")),
        candidate("world"),
    )
    assert chosen(*found) == ["sim"]
    assert reasons(*found) == []


def test_a_world_that_is_missing_is_shown() -> None:
    world = candidate("world")
    lacking = world._replace(started=world.started._replace(lacks_world=True))
    assert chosen(lacking) == ["world"]
    outer = candidate("sim", robot("r"), includes=("world",))
    assert chosen(lacking, outer) == ["sim"]
    incomplete = world._replace(started=world.started._replace(lacks_model="w.sdf: no model."))
    assert chosen(incomplete) == []
    assert reasons(incomplete) == ["w.sdf: no model"]


def test_what_a_command_gives() -> None:
    failing = candidate("inner", error=error(UNDEFINED_CONFIGURATION.code))
    words = ("ros2", "launch", "p", "inner", "x:=1")
    process = Process(package=None, executable=None, command=words)
    plan = replace(candidate("outer").started.plan, processes=(process,))
    outer = candidate("outer")._replace(started=candidate("outer").started._replace(plan=plan))

    def evaluate(file: LaunchFile, arguments: Mapping[str, str]) -> Started:
        assert (file.file.name, arguments) == ("inner", {"x": "1"})
        return candidate("inner", robot("r")).started

    assert chosen(failing, outer) == ["inner"]
    _, inner = with_commands([outer, failing], evaluate)
    assert not inner.errors
    assert inner.started.spawns
    assert with_commands([failing], evaluate) == [failing]


def test_the_outer_one_of_any_package() -> None:
    inner = candidate("sim", robot("r"), package="sim")
    outer = candidate("robot", robot("r", x=1), includes=("sim",), package="bringup")
    assert chosen(inner, outer) == ["robot"]
    assert reasons(inner, outer) == ["included by bringup robot"]
    assert reasons(inner, outer._replace(launch_file=LaunchFile("sim", Path("robot")))) == []
    assert chosen(inner, outer, kept=("sim",)) == ["sim", "robot"]
    outermost = candidate("all", robot("r", x=2), includes=("robot", "sim"), package="all")
    assert reasons(inner, outer, outermost)[0] == "included by all all"


def test_an_outer_one_that_fails_hides_nothing() -> None:
    failing = candidate("robot", includes=("sim",), error=error(SYNTAX_ERROR.code), simulator=None)
    assert chosen(candidate("sim", robot("r")), failing) == ["sim", "robot"]


def test_a_spawner_alone() -> None:
    spawner = candidate("spawn", robot("r", x=3), simulator=None)
    assert chosen(spawner) == ["spawn"]
    assert chosen(spawner, candidate("sim", robot("r"))) == ["sim"]
    assert chosen(spawner, candidate("sim", robot("other"))) == ["spawn", "sim"]


def test_the_same_simulation_of_a_package() -> None:
    first, second = candidate("a", robot("r")), candidate("b", robot("r"))
    assert chosen(first, second, candidate("c", robot("r", x=1))) == ["a", "c"]
    assert reasons(first, second) == ["the same simulation as a"]
    world = candidate("b", robot("r"), simulator=replace(GAZEBO, world="office.world"))
    assert chosen(first, world) == ["a", "b"]
    assert chosen(first, candidate("b", robot("r"), package="q")) == ["a", "b"]


def test_a_mistake_in_what_spawns_nothing() -> None:
    found = candidate("teleop", simulator=None, error=error(SYNTAX_ERROR.code, line=3))
    simulation = candidate("sim", robot("r"))
    assert chosen(simulation, found) == ["sim"]
    assert reasons(simulation, found) == [f"m ({SYNTAX_ERROR.code}, f:3)"]


def test_a_mistake_in_what_may_spawn(tmp_path: Path) -> None:
    mistake = error(SYNTAX_ERROR.code)
    assert chosen(candidate("sim", error=mistake)) == ["sim"]
    inner = candidate("spawn", robot("r"), simulator=None)
    outer = candidate("all", simulator=None, error=mistake, includes=("spawn",))
    assert chosen(inner, outer) == ["spawn", "all"]
    for text in (
        "'spawn.launch.py'",
        "find('gazebo_ros')",
        "<a b='$(find-pkg-share ros_gz_sim)/c'",
        "cr(",
    ):
        file = tmp_path / "a.launch.py"
        file.write_text(text)
        failing = candidate(str(file), simulator=None, error=mistake)
        spawner = candidate("spawn.launch.py", robot("r"), simulator=None, package="q")
        assert ("a.launch.py" in chosen(failing, spawner)) == (text != "cr(")


def test_a_mistake_in_the_description_of_a_robot() -> None:
    mistake = error(XACRO_FAILS.code, file="robot.xacro")
    display = candidate("display", simulator=None, error=mistake)
    assert chosen(display) == ["display"]
    simulation = candidate("sim", error=mistake, package="q")
    assert chosen(display, simulation) == ["sim"]
    assert reasons(display, simulation) == ["the same mistake as q sim"]


def test_what_an_included_one_lacks_is_said_of_the_outer_one() -> None:
    lacks = error(PACKAGE_NOT_FOUND.code)
    inner = candidate("drivers", simulator=None, error=lacks)
    outer = candidate("sim", error=lacks, includes=("drivers",))
    assert chosen(inner, outer) == ["sim"]
    assert reasons(inner, outer) == []


def test_mistakes_of_packages_that_are_named() -> None:
    mistake = error(SYNTAX_ERROR.code)
    failing = candidate("teleop", simulator=None, error=mistake)
    named = choose([failing], named=("p",))
    assert [one.file.name for one in named.chosen] == ["teleop"]
    assert not choose([failing], named=("q",)).chosen
    both = choose([failing, candidate("sim", robot("r"))], named=("p",))
    assert [one.file.name for one in both.chosen] == ["sim"]


def test_one_mistake_in_several_launch_files_is_reported_once() -> None:
    mistake = error(SYNTAX_ERROR.code, file="robot.xacro")
    found = [candidate(name, error=mistake) for name in ("a", "b")]
    assert chosen(*found) == ["a"]
    assert reasons(*found) == ["the same mistake as a"]
    outer = candidate("c", error=mistake, includes=("a",), package="q")
    assert chosen(found[0], outer) == ["c"]


def test_what_only_its_machine_has(tmp_path: Path) -> None:
    lacks = error(PACKAGE_NOT_FOUND.code, "The package 'lidar' is not found.")
    driver = candidate("driver", simulator=None, error=lacks)
    assert chosen(driver) == []
    assert reasons(driver) == ["The package 'lidar' is not found."]
    for name, text in (
        ("spawns.launch.py", "Node(executable='spawn_entity.py')"),
        ("spawns.launch.xml", '<launch><node pkg="ros_gz_sim" exec="create"/></launch>'),
    ):
        file = tmp_path / name
        file.write_text(text)
        assert chosen(candidate(str(file), simulator=None, error=lacks)) == [name]
    (tmp_path / "create.launch.py").write_text("description = 'Whether to create a map'")
    assert chosen(candidate(str(tmp_path / "create.launch.py"), simulator=None, error=lacks)) == []
    assert chosen(candidate("started", error=lacks)) == ["started"]


def test_a_required_argument() -> None:
    lacks = error(ARGUMENT_WITHOUT_VALUE.code, "The argument `x` has no default.")
    needs = candidate("sim", error=lacks)
    assert chosen(needs) == ["sim"]
    other = candidate("a", robot("r"))
    assert chosen(needs, other) == ["a"]
    assert reasons(needs, other) == ["The argument `x` has no default."]
    outer = candidate("robot", robot("r"), includes=("sim",), package="q")
    assert reasons(needs, outer) == ["included by q robot"]
