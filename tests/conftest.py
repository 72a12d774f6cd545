"""What all tests share."""

import signal
import sys

import pytest

if sys.platform == "linux":
    import resource

# What `nohup` and a shell's `&` let be ignored, the processes that tests start would ignore, too.
for _name, _handler in (("SIGINT", signal.default_int_handler), ("SIGHUP", signal.SIG_DFL)):
    _signal = getattr(signal, _name, None)  # Windows has no SIGHUP
    if _signal is not None and signal.getsignal(_signal) is signal.SIG_IGN:
        signal.signal(_signal, _handler)

# Bytes that a process of the tests, or one that it has started, may grow to. A worker has 1 GiB
# near the end of the suite: all engines and thousands of tests; a world that nobody frees is 90 MB.
MOST_MEMORY = 3 * 2**29
_reported = 0  # bytes, of the process that was larger than that


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--regenerate",
        action="store_true",
        help="write the goldens and examples anew instead of comparing with them",
    )


@pytest.fixture
def regenerate(request: pytest.FixtureRequest) -> bool:
    """Whether goldens are written instead of compared."""
    return bool(request.config.getoption("--regenerate"))


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
