"""The first lines of a child process: set the module search path, then perform the task.

Run as a script in an isolated interpreter (`python -I bootstrap.py`), with the request on
standard input. Before the search path is set it imports only what performs the task.
"""

import os
import pickle
import sys

from wsgen.isolation import child


def set_search_path(own: list[str]) -> None:
    """Search modules where wsgen does, then in PYTHONPATH."""
    overlay = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    sys.path[:] = own + [entry for entry in overlay if entry and entry not in own]


request = pickle.load(sys.stdin.buffer)  # noqa: S301  the parent wrote it
set_search_path(request["path"])


if "control" in request:
    from wsgen.isolation.fork_server_process import serve

    request = serve(request)  # returns in each child that the server forks
    set_search_path(request["path"])

child.perform(request)
