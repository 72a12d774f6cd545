"""What all tests share."""

import gc
import os
import signal
import sys
from collections.abc import Callable, Generator
from pathlib import Path

import hypothesis
import pytest

from forks import fork_child
from own_network import why_refused
from ros_for_tests import network_of_ros, ros
from wsgen.isolation import channel, result, system
from wsgen.isolation.parent import Process
from wsgen.launching import evaluate

if sys.platform == "linux":
    import resource

__all__ = ["network_of_ros", "ros"]  # fixtures

# What `nohup` and a shell's `&` let be ignored, the processes that tests start would ignore, too.
for _name, _handler in (("SIGINT", signal.default_int_handler), ("SIGHUP", signal.SIG_DFL)):
    _signal = getattr(signal, _name, None)  # Windows has no SIGHUP
    if _signal is not None and signal.getsignal(_signal) is signal.SIG_IGN:
        signal.signal(_signal, _handler)

# A busy machine takes its time: limits are those of CPU time. Examples of properties are the same
# in each run, so that what fails was changed; with --thorough they are others each time.
hypothesis.settings.register_profile(
    "thorough", deadline=None, suppress_health_check=[hypothesis.HealthCheck.too_slow]
)
hypothesis.settings.register_profile(
    "wsgen", hypothesis.settings.get_profile("thorough"), derandomize=True
)
hypothesis.settings.load_profile("wsgen")
result.WALL_CLOCK_FACTOR = 200.0

# Bytes that a process of the tests, or one that it has started, may grow to. What needs more than
# a few hundred MB does it in a process of its own.
MOST_MEMORY = 2**30
# Files that take twenty seconds and more. `make test` has each file run by one process, which makes
# its fixtures once: what takes long comes first, or it would run alone at the end.
LONGEST = (
    "test_packaging.py",
    "testing/test_live.py",
    "test_public_robots_simulated.py",
    "test_matrix.py",
    "isolation/test_run.py",
    "ros/test_nodes.py",
    "porting/test_proof.py",
    "building/test_failures.py",
    "simulation/test_rest_poses.py",
    "test_interpreters.py",  # installs what the first one resolves
    "cli/test_validate.py",
    "testing/test_plugin.py",
    "descriptions/urdf/test_public_robots.py",
    "pipeline/test_validate_with_gazebo.py",
    "cli/test_validate_files.py",
    "live/test_with_ros.py",
    "building/test_another_machine.py",
    "reporting/test_page_in_chromium.py",
    "descriptions/urdf/test_broken_models.py",
    "classic/test_validate_in_classic.py",  # waits while `.ci/run` unpacks
    "reporting/viewing/test_browser.py",
    "ros/test_ros2_control.py",
    "kinds/test_line_follower.py",
    "kinds/test_messages_and_nodes.py",
    "building/test_without_ros.py",
    "checks/rules/test_examples.py",
    "sweeping/test_plots.py",
    "launching/test_properties.py",
    "building/test_build.py",
    "descriptions/meshes/test_mesh_files.py",
    "checks/fixes/test_examples_fixed.py",
    "rendering/test_picture.py",
    "ros/environment/test_with_ros.py",
    "live/test_recording.py",
    "templating/test_oracles.py",
    "building/test_plain_colcon.py",
    "test_cmake_versions.py",
    "rendering/test_pictures.py",
    "cli/test_signals.py",
    "cli/test_build.py",
    "sweeping/test_subjects.py",
    "testing/test_colcon.py",
    "simulation/test_engines_triangles.py",
    "descriptions/urdf/test_gazebo_texts.py",
    "test_bounds.py",
    "pipeline/test_single_mistakes.py",
    "simulation/test_session.py",
    "launching/test_bad_input.py",
)
LONGEST_NAME = 100  # characters of a parameter in the name of a test
_reported = 0  # bytes, of the process that was larger than that


def starter(*, is_forked: bool) -> Callable[..., Process]:
    """What starts a child that `wsgen.isolation.channel` asks."""
    is_alike = system.can_fork() and FOREIGN.isdisjoint(sys.modules)
    if is_forked and system.has_guards() and not is_alike:
        return fork_child
    return own_starter(is_forked=is_forked)


if "PYTEST_XDIST_WORKER" in os.environ:
    # wsgen, which has one thread and imports nothing foreign, forks such children from itself. A
    # process of pytest-xdist has more, and would start an interpreter for each check.
    own_starter = channel._starter
    channel._starter = starter
    FOREIGN = evaluate.FOREIGN
    evaluate.FOREIGN = frozenset()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--regenerate",
        action="store_true",
        help="write the goldens and examples anew instead of comparing with them",
    )
    parser.addoption(
        "--thorough",
        action="store_true",
        help="compare all public meshes and simulate all public robots, not a sample of them; "
        "test properties with other examples each time",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Choose the examples of properties, before the files that have some are imported."""
    if config.getoption("--thorough"):
        hypothesis.settings.load_profile("thorough")
    if config.getoption("--regenerate") and "PYTEST_XDIST_WORKER" not in os.environ:
        from template_history import keep_states  # noqa: PLC0415  before a golden has a state

        keep_states()


def pytest_report_header() -> str:
    refused = why_refused()
    return f"network of tests with ROS: {f'that of the machine: {refused}' if refused else 'own'}"


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect tests without the collector of garbage, and keep it from looking at them later.

    They are kept until the end: a quarter of the time would go into looking at them again.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Put the files that take long to the front, and leave out what is for --thorough."""
    if not config.getoption("--thorough"):
        left_out = pytest.mark.skip(reason="with --thorough alone")
        for item in items:
            if item.get_closest_marker("thorough") is not None:
                item.add_marker(left_out)
    places = {Path(__file__).parent / name: place for place, name in enumerate(LONGEST)}
    items.sort(key=lambda item: places.get(item.path, len(places)))


def pytest_make_parametrize_id(val: object, argname: str) -> str | None:
    """Name a long text by what it is, else a test's name holds all of it."""
    if isinstance(val, (str, bytes)) and len(val) > LONGEST_NAME:
        return f"{argname} of {len(val)}"
    return None


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Show why tests failed that passed when they ran again, which the summary leaves out."""
    failed = {report.nodeid for report in terminalreporter.getreports("failed")}
    for report in terminalreporter.getreports("rerun"):
        if report.nodeid not in failed:
            terminalreporter.section(f"failed, then passed: {report.nodeid}", yellow=True)
            terminalreporter.line(report.longreprtext)


@pytest.fixture
def regenerate(request: pytest.FixtureRequest) -> bool:
    """Whether goldens are written instead of compared."""
    return bool(request.config.getoption("--regenerate"))


@pytest.fixture
def thorough(request: pytest.FixtureRequest) -> bool:
    """Whether all there is to compare is compared, not a sample."""
    return bool(request.config.getoption("--thorough"))


if sys.platform == "linux":  # elsewhere it is counted in other units

    @pytest.hookimpl(trylast=True)  # behind the tearing down itself, which a failure would stop
    def pytest_runtest_teardown() -> None:
        """Fail with the test during which this process or a child of it has grown too large."""
        global _reported  # noqa: PLW0603  the system tells the largest size so far
        kinds = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        largest = max(resource.getrusage(kind).ru_maxrss for kind in kinds) * 1024
        if largest > max(MOST_MEMORY, _reported):
            _reported = largest
            pytest.fail(f"a process has grown to {largest / 2**20:.0f} MiB", pytrace=False)
