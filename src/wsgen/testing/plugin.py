"""The pytest plugin: fixtures with the robots of a package, in a simulation without ROS.

pytest loads this module in every run, so it imports pytest and what pytest has loaded; everything
else is imported when a test asks for a fixture. See docs/testing.md.
"""

from __future__ import annotations

import hashlib
import os
import sys
from collections.abc import Mapping
from contextlib import ExitStack
from importlib.machinery import PathFinder
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator, Sequence
    from contextlib import AbstractContextManager
    from importlib.machinery import ModuleSpec
    from pathlib import Path

    from wsgen.live.session import LiveSession
    from wsgen.model.plan import LaunchPlan
    from wsgen.model.world import World
    from wsgen.testing.live import Live
    from wsgen.testing.robot import Robot
    from wsgen.testing.simulation import SharedScene, Simulation

ENGINES = ("bullet", "dart", "mujoco")
KEYS = ("package", "launch_file", "arguments", "engine", "robot")  # of the marker
MARKER = (
    "wsgen(package=NAME, launch_file=NAME, arguments={NAME: VALUE}, engine=NAME, robot=NAME): "
    "what the fixtures of wsgen simulate; by default the package that the test lies in."
)
LONGEST_NAME = 200  # bytes, of a file; systems take 255
SIMULATION = pytest.StashKey[Any]()  # of a test that has one
SHARED_SCENES = pytest.StashKey[Any]()  # of a run
LIVE_REPORTS = pytest.StashKey[Any]()  # of a test: what is known of its live runs at their ends


class PlainImports:
    """Finds the modules of wsgen before pytest does.

    pytest rewrites the assertions in all modules of a package that has a plugin. `colcon test` lets
    it keep nothing of what it compiles: each run would take a second of CPU time more.
    """

    @staticmethod
    def find_spec(
        name: str, path: Sequence[str] | None, _target: object = None
    ) -> ModuleSpec | None:
        """Find a module of wsgen as Python does by itself."""
        return PathFinder.find_spec(name, path) if name.startswith("wsgen.") else None


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options and settings."""
    group = parser.getgroup("wsgen", "robots simulated by wsgen")
    for name, what, metavar in (
        ("package", "Package whose robots are simulated (default: that of the test).", "NAME"),
        ("launch-file", "Launch file that spawns the robots (default: the only one).", "NAME"),
        ("engine", f"Physics engine: {', '.join(ENGINES)} (default: the first installed).", "NAME"),
        ("output", "Folder for a picture and a GIF of each failed test.", "DIR"),
    ):
        destination = f"wsgen_{name.replace('-', '_')}"
        group.addoption(f"--wsgen-{name}", dest=destination, metavar=metavar, help=what)
        parser.addini(destination, what)
    group.addoption(
        "--wsgen-argument",
        dest="wsgen_arguments",
        action="append",
        metavar="NAME:=VALUE",
        help="Argument of the launch file; may be given several times.",
    )
    parser.addini("wsgen_arguments", "Arguments of the launch file, NAME:=VALUE.", type="linelist")


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker; refuse settings that no test could use."""
    config.addinivalue_line("markers", MARKER)
    sys.meta_path.insert(0, PlainImports)
    config.add_cleanup(lambda: sys.meta_path.remove(PlainImports))
    engine = _setting(config, "engine")
    if engine is not None:
        _check_engine(engine)
    _arguments(config)


def pytest_unconfigure(config: pytest.Config) -> None:
    """End the engines."""
    for shared_scene in config.stash.get(SHARED_SCENES, {}).values():
        if not isinstance(shared_scene, str):
            shared_scene.close()


def _setting(config: pytest.Config, name: str) -> str | None:
    """An option, or else the setting of that name."""
    value = config.getoption(f"wsgen_{name}") or config.getini(f"wsgen_{name}")
    return str(value) if value else None


def _arguments(config: pytest.Config) -> dict[str, str]:
    words = [*config.getini("wsgen_arguments"), *(config.getoption("wsgen_arguments") or ())]
    pairs = [word.partition(":=") for word in words]
    for name, sign, _ in pairs:
        if not (name and sign):
            raise pytest.UsageError(f"wsgen: {name!r} is not a launch argument; write NAME:=VALUE.")
    return {name: value for name, _, value in pairs}


def _check_engine(engine: str) -> None:
    if engine not in ENGINES:
        raise pytest.UsageError(
            f"wsgen: {engine!r} is not a physics engine; choose one of {', '.join(ENGINES)}."
        )


def _wanted(item: pytest.Item) -> dict[str, Any]:
    """What the test wants to have simulated: its markers, then options, then settings."""
    wanted: dict[str, Any] = {
        name: _setting(item.config, name) for name in ("package", "launch_file", "engine")
    }
    wanted |= {"arguments": _arguments(item.config), "robot": None}
    for marker in reversed(list(item.iter_markers("wsgen"))):  # the closest one last
        unknown = [name for name in marker.kwargs if name not in KEYS]
        if marker.args or unknown:
            what = f"`{unknown[0]}`" if unknown else f"{marker.args[0]!r} without a name"
            _fail(f"The marker wsgen takes no {what}.", f"It takes {', '.join(KEYS)}.")
        _check_values(marker.kwargs)
        wanted |= {name: value for name, value in marker.kwargs.items() if name != "arguments"}
        wanted["arguments"] |= {
            name: _text(value) for name, value in (marker.kwargs.get("arguments") or {}).items()
        }
    _check_name_of_engine(wanted["engine"])
    return wanted


def _check_name_of_engine(engine: str | None) -> None:
    if engine not in {None, *ENGINES}:
        _fail(f"{engine!r} is not a physics engine.", f"Use {', '.join(ENGINES)}.")


def _check_values(given: Mapping[str, object], of: str = "The marker wsgen") -> None:
    """Refuse what a marker or a call cannot mean."""
    for name, value in given.items():
        if name != "arguments" and value is not None and not isinstance(value, str):
            _fail(f"{of} has {name}={value!r}.", f'Give a name: {name}="NAME".')
    arguments = given.get("arguments")
    if arguments is not None and not isinstance(arguments, Mapping):
        what = f"{of} has arguments={arguments!r}."
        _fail(what, 'Give names and values: arguments={"z": 0.5}.')


def _check_run(rate: object, may_fail: object) -> None:
    """Refuse a way to run that is none."""
    if rate is not None and (
        isinstance(rate, bool) or not isinstance(rate, (int, float)) or not 0 < rate < float("inf")
    ):
        _fail(
            f"live() has rate={rate!r}.",
            "Give simulated seconds a second, above 0; without it, time passes as fast as it can.",
        )
    names = may_fail if isinstance(may_fail, (list, tuple, set, frozenset)) else [None]
    if not all(isinstance(one, str) for one in names):
        _fail(f"live() has may_fail={may_fail!r}.", 'Give a list of names: may_fail=["mapper"].')


def _text(value: object) -> str:
    """A value of a launch argument as `ros2 launch` takes it."""
    return str(value).lower() if isinstance(value, bool) else str(value)


def _fail(message: str, hint: str) -> None:
    pytest.fail(f"wsgen: {message}\n{hint}".rstrip(), pytrace=False)


def _shared_scene(item: pytest.Item) -> SharedScene:
    """What the test has simulated, loaded once for all that want the same."""
    wanted = _wanted(item)
    wanted.pop("robot")
    near = item.path
    shared_scenes: dict[Any, SharedScene | str] = item.config.stash.setdefault(SHARED_SCENES, {})
    key = (
        wanted["package"] or near.parent,
        wanted["launch_file"],
        wanted["engine"],
        *sorted(wanted["arguments"].items()),
    )
    if key not in shared_scenes:
        shared_scenes[key] = _open(near, wanted)
    for other in shared_scenes.values():
        if not isinstance(other, str) and other is not shared_scenes[key]:
            other.end_session()  # an engine takes as much memory as pytest
    shared_scene = shared_scenes[key]
    if isinstance(shared_scene, str):
        pytest.fail(shared_scene, pytrace=False)
    for unused in shared_scene.unused_arguments:  # the test does not test what it says
        item.warn(pytest.PytestWarning(unused))
    return shared_scene


def _open(near: Path, wanted: dict[str, Any]) -> SharedScene | str:
    """The scene, or why it cannot be loaded."""
    from wsgen.errors import WsgenError  # noqa: PLC0415  see the top
    from wsgen.pipeline.load_scene import BrokenSceneError  # noqa: PLC0415
    from wsgen.reporting.words import render_text  # noqa: PLC0415
    from wsgen.testing.simulation import SharedScene  # noqa: PLC0415

    try:
        shared_scene = SharedScene(near=near, **wanted)
    except WsgenError as error:
        return f"wsgen: {error}"
    except BrokenSceneError as broken:
        return f"wsgen: {broken}\n{render_text(broken.diagnostics)}"
    if shared_scene.loaded.errors:
        shared_scene.close()
        what = f"wsgen: {shared_scene.loaded.package} has errors; nothing is simulated."
        return f"{what}\n{render_text(shared_scene.loaded.errors)}"
    return shared_scene


@pytest.fixture
def simulation(request: pytest.FixtureRequest) -> Iterator[Simulation]:
    """The robots that a launch file of the package spawns, in a physics engine.

    Every test begins with them as they are spawned; the same steps give the same states.
    """
    from wsgen.testing.simulation import Simulation  # noqa: PLC0415  see the top

    shared_scene = _shared_scene(request.node)
    made = Simulation(shared_scene)
    request.node.stash[SIMULATION] = made
    yield made
    del request.node.stash[SIMULATION]


@pytest.fixture
def robot(simulation: Simulation, request: pytest.FixtureRequest) -> Robot:
    """The robot that the launch file spawns; of several, the one that the marker names."""
    from wsgen.errors import WsgenError  # noqa: PLC0415  see the top

    try:
        return simulation.robot(_wanted(request.node)["robot"])
    except WsgenError as error:
        problem = f"wsgen: {error}"
    pytest.fail(problem, pytrace=False)


@pytest.fixture
def launch_plan(request: pytest.FixtureRequest) -> LaunchPlan:
    """What the launch file would start: processes, parameters, included launch files."""
    return _shared_scene(request.node).loaded.plan


@pytest.fixture
def world(request: pytest.FixtureRequest) -> World:
    """The world that the launch file starts: its models, gravity, step and light."""
    return _shared_scene(request.node).loaded.world


@pytest.fixture
def live(request: pytest.FixtureRequest) -> Iterator[Callable[..., AbstractContextManager[Live]]]:
    """What starts a launch file with its nodes, in simulated time.

    Use it as `with live("my_package", "bringup.launch.py") as ros: ...`
    It has a ROS domain of its own; all that it starts ends with the context, or with the test.
    """
    stack = ExitStack()

    def start(  # noqa: PLR0913  what is run, and how
        package: str | None = None,
        launch_file: str | None = None,
        *,
        arguments: Mapping[str, object] | None = None,
        engine: str | None = None,
        rate: float | None = None,
        may_fail: Sequence[str] = (),
    ) -> AbstractContextManager[Live]:
        wanted = _wanted(request.node)
        names = {"package": package, "launch_file": launch_file, "engine": engine}
        _check_values({**names, "arguments": arguments}, "live()")
        _check_name_of_engine(engine)
        _check_run(rate, may_fail)
        given = {name: _text(value) for name, value in (arguments or {}).items()}
        return _RunningLive(
            request.node,
            stack,
            package=package or wanted["package"],
            launch_file=launch_file or wanted["launch_file"],
            arguments={**wanted["arguments"], **given},
            engine=engine or wanted["engine"],
            rate=rate,
            may_fail=may_fail,
        )

    with stack:
        yield start


class _RunningLive:
    """A live run, which ends with the context, or with the test."""

    def __init__(self, item: pytest.Item, of_test: ExitStack, **wanted: Any) -> None:
        self._item = item
        self._of_test = of_test
        self._stack = ExitStack()
        self._wanted = wanted

    def __enter__(self) -> Live:
        from wsgen.errors import NotFoundError, WsgenError  # noqa: PLC0415  see the top
        from wsgen.isolation.system import require_linux  # noqa: PLC0415

        __tracebackhide__ = True
        try:
            require_linux("The fixture `live`", "The fixture `simulation` needs no nodes.")
        except NotFoundError as error:
            pytest.fail(f"wsgen: {error}", pytrace=False)
        from wsgen.live.session import BrokenLaunchError  # noqa: PLC0415
        from wsgen.reporting.words import render_text  # noqa: PLC0415
        from wsgen.testing.live import run_live  # noqa: PLC0415

        self._of_test.push(self._stack)
        reports = self._item.stash.setdefault(LIVE_REPORTS, [])

        def opened(session: LiveSession) -> None:
            self._stack.callback(lambda: reports.append(session.report()))
            for unused in session.unused_arguments:  # the test does not test what it says
                self._item.warn(pytest.PytestWarning(unused))

        try:
            run = run_live(near=self._item.path, opened=opened, **self._wanted)
            ros: Live = self._stack.enter_context(run)
        except WsgenError as error:
            problem = f"wsgen: {error}"
        except BrokenLaunchError as broken:
            problem = f"wsgen: {broken}\n{render_text(broken.diagnostics)}"
        else:
            return ros
        self._stack.close()
        pytest.fail(problem, pytrace=False)

    def __exit__(self, *error: object) -> None:
        self._stack.close()


# The form that old versions know, too: a plugin that is not loaded breaks all tests.
@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, Any, None]:
    """Add a picture and the last second to the report of a test that failed."""
    outcome = yield
    report: pytest.TestReport = outcome.get_result()
    simulation = item.stash.get(SIMULATION, None)
    if report.when == "call" and report.failed and simulation is not None:
        shown = _draw(item, simulation)
        if shown:
            _add(report, shown)
    if report.when == "call" and report.failed and item.stash.get(LIVE_REPORTS, None):
        _add(report, "\n".join(item.stash[LIVE_REPORTS]))
    if report.when == "call" and report.passed and simulation is not None:
        for file in _files(item, simulation):  # that an earlier run may have left
            file.unlink(missing_ok=True)


def _files(item: pytest.Item, simulation: Simulation) -> tuple[Path, Path]:
    """The picture and the GIF of a test that fails."""
    folder, name = _output_folder(item.config, simulation.loaded.package), _file_name(item)
    return folder / f"{name}.png", folder / f"{name}.gif"


def _draw(item: pytest.Item, simulation: Simulation) -> str:
    """What was drawn of the end of a test, one file a line; empty where nothing happened."""
    if not simulation.has_begun:
        return ""
    from wsgen.errors import WsgenError  # noqa: PLC0415  see the top

    lines = [f"after {simulation.seconds:g} simulated seconds in {simulation.engine}"]
    try:
        picture, video = _files(item, simulation)
        picture.parent.mkdir(parents=True, exist_ok=True)
        simulation.picture(picture)
        lines.append(f"picture: {picture}")
        simulation.record(video)
        lines.append(f"last second: {video}")
    except (WsgenError, OSError) as error:
        lines.append(f"no picture: {error}")
    return "\n".join(lines)


def _output_folder(config: pytest.Config, package: str) -> Path:
    """The folder for pictures: in the one that is asked for, or beside the results of the tests."""
    given = _setting(config, "output")
    if given is not None:  # `colcon test` gives the same one to the tests of all packages
        folder: Path = config.invocation_params.dir / given / package
        return folder
    results: str | None = getattr(config.option, "xmlpath", None)  # of --junit-xml
    if results:
        file: Path = config.invocation_params.dir / results
        return file.parent / file.name.removesuffix(".xml").removesuffix(".xunit")
    factory: pytest.TempPathFactory = config._tmp_path_factory  # type: ignore[attr-defined]  # noqa: SLF001  fixtures alone get it otherwise
    base: Path = factory.getbasetemp()
    return base / "wsgen"


def _file_name(item: pytest.Item) -> str:
    """The name of a test as that of a file, which no other test of the run has.

    It begins with the name of the file with the test, or its path where others have that name.
    """
    others = {other.path for other in item.session.items if other.path.stem == item.path.stem}
    file = item.path.stem
    if len(others) > 1:
        file = os.path.relpath(item.path.with_suffix(""), item.config.rootpath)
    name = "-".join((file, *item.nodeid.split("::")[1:]))
    plain = "".join(sign if sign.isalnum() or sign in "-_." else "_" for sign in name)
    if plain == name and len(os.fsencode(plain)) <= LONGEST_NAME:
        return plain
    # Values of parameters may be long, and differ in what no file's name has.
    begin = os.fsencode(plain)[:LONGEST_NAME].decode(errors="ignore")
    return f"{begin}-{hashlib.sha256(name.encode(errors='replace')).hexdigest()[:8]}"


def _add(report: pytest.TestReport, shown: str) -> None:
    """Add it to what is printed of the failure, which is also what JUnit files have."""
    add: Callable[..., None] | None = getattr(report.longrepr, "addsection", None)
    if add is not None:
        add("wsgen", shown, sep="-")
        crash = getattr(report.longrepr, "reprcrash", None)
        if crash is not None:  # all that `colcon test-result` shows of a JUnit file
            crash.message += f"\n{shown}"
    elif isinstance(report.longrepr, str):
        report.longrepr = f"{report.longrepr}\n{shown}"
    else:
        report.sections.append(("wsgen", shown))
