"""`python -m wsgen` and the script `wsgen`: ready for signals before the rest is imported."""

import _signal  # type: ignore[import-not-found]
import os

from wsgen.errors import EXIT_SIGNALLED, SIGNAL_MESSAGES

# What `signal` wraps, which loads `enum`: somebody may press Ctrl-C meanwhile. It has no stubs.


STANDARD_ERROR = 2


def main() -> None:
    """Run the command line and exit."""
    for name in SIGNAL_MESSAGES:
        number = getattr(_signal, name, None)  # Windows has no SIGHUP
        if number is not None and _signal.getsignal(number) != _signal.SIG_IGN:
            _signal.signal(number, _leave_at_once)
    from wsgen.cli import main as run_command_line  # noqa: PLC0415  most of the start-up

    run_command_line()


def _leave_at_once(number: int, _frame: object) -> None:
    """End while modules are imported: nothing has begun that would have to be undone."""
    try:
        names = {getattr(_signal, name, None): name for name in SIGNAL_MESSAGES}
        message = SIGNAL_MESSAGES[names[number]]
        os.write(STANDARD_ERROR, f"\n{message}\n".encode())
    finally:  # standard error may be closed
        os._exit(EXIT_SIGNALLED + number)


if __name__ == "__main__":
    main()
