"""What all tests share."""

import signal
import sys

import hypothesis
import pytest

from ros_for_tests import ros

if sys.platform == "linux":
    import resource

__all__ = ["ros"]  # a fixture

# What `nohup` and a shell's `&` let be ignored, the processes that tests start would ignore, too.
for _name, _handler in (("SIGINT", signal.default_int_handler), ("SIGHUP", signal.SIG_DFL)):
    _signal = getattr(signal, _name, None)  # Windows has no SIGHUP
    if _signal is not None and signal.getsignal(_signal) is signal.SIG_IGN:
        signal.signal(_signal, _handler)

# A busy machine takes its time.
hypothesis.settings.register_profile("wsgen", deadline=None)
hypothesis.settings.load_profile("wsgen")

# Bytes that a process of the tests, or one that it has started, may grow to. What needs more than
# a few hundred MB does it in a process of its own.
MOST_MEMORY = 2**30
LONGEST_NAME = 100  # characters of a parameter in the name of a test
_reported = 0  # bytes, of the process that was larger than that


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--regenerate",
        action="store_true",
        help="write the goldens and examples anew instead of comparing with them",
    )
    parser.addoption(
        "--thorough",
        action="store_true",
        help="compare all public meshes with trimesh, not a sample of each folder",
    )


def pytest_make_parametrize_id(val: object, argname: str) -> str | None:
    """Name a long text by what it is, else a test's name holds all of it."""
    if isinstance(val, (str, bytes)) and len(val) > LONGEST_NAME:
        return f"{argname} of {len(val)}"
    return None


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
