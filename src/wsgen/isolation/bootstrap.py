"""The first lines of a child process: find wsgen again, then do the task.

Run as a script in an isolated interpreter (`python -I bootstrap.py`), with the request on
standard input. It imports nothing but the standard library until the search path is set.
"""

import os
import pickle
import sys

request = pickle.load(sys.stdin.buffer)  # noqa: S301  the parent wrote it
overlay = os.environ.get("PYTHONPATH", "").split(os.pathsep)
sys.path[:] = request["path"] + [
    entry for entry in overlay if entry and entry not in request["path"]
]

from wsgen.isolation import child  # noqa: E402  the search path had to be set first

child.perform(request)
