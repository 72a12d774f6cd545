"""The first lines of a child process: set the module search path, then perform the task.

Run as a script in an isolated interpreter (`python -I bootstrap.py REQUEST`), with the file of the
request, and the parent-death pipe as standard input. Before the search path is set it imports only
what performs the task.
"""

import pickle
import sys
from pathlib import Path

from wsgen.isolation import child
from wsgen.isolation.system import take_parent_death_pipe

request = pickle.loads(Path(sys.argv[1]).read_bytes())  # noqa: S301  the parent wrote it
request["parent_death_pipe"] = take_parent_death_pipe()
child.set_search_path(request["path"])


if "control" in request:
    from wsgen.isolation.fork_server_process import serve

    request = serve(request)  # returns in each child that the server forks
    child.set_search_path(request["path"])

child.perform(request)
