"""Start programs of wsgen that speak ROS, in the folder of a user."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

# `python -m` finds modules in the working folder first: the yaml.py of a user would be executed.
# Python 3.10 has no option against that which keeps PYTHONPATH. `-P` and PYTHONSAFEPATH of later
# versions leave the first entry out themselves.
WITHOUT_WORKING_FOLDER = "import sys\nif not sys.path[0]: del sys.path[0]\n"  # for `python -c`
SHIM = Path(__file__).parents[1] / "shim"  # Python packages of ROS that PyPI lacks
START = Path(__file__).parents[1] / "start"  # what the Python of a node executes at its start
_RUN_MODULE = (
    f"{WITHOUT_WORKING_FOLDER}import runpy\n"
    f"sys.path.append({str(SHIM)!r})\n"  # a sourced ROS may lack them, too
    "sys.argv[0] = '-m'\n"  # as `python -m` has it while packages of the module are imported
    "runpy.run_module(sys.argv.pop(1), run_name='__main__', alter_sys=True)"
)


def module_command(python: Path | str, module: str, *words: str) -> tuple[str, ...]:
    """Return the command line of `python -m MODULE WORDS`, deaf to files in the working folder."""
    return (str(python), "-c", _RUN_MODULE, module, *words)


def hand_over(text: str) -> str:
    """Return the number of a descriptor with a text, for the program that this process becomes.

    One argument of a command line has at most 128 kB on Linux.

    Raises:
        OSError: the text cannot be written.
    """
    with tempfile.TemporaryFile() as file:
        file.write(text.encode())
        file.flush()
        descriptor = os.dup(file.fileno())
    os.set_inheritable(descriptor, True)
    return str(descriptor)


def handed_over(number: str) -> str:
    """Return the text of `hand_over`, and close its descriptor."""
    with os.fdopen(int(number), "rb") as file:
        file.seek(0)
        return file.read().decode()
