"""The process that colcon runs in: run as a script, with the request on standard input.

It imports nothing but the standard library until the search path is set. Standard output carries
the events to wsgen; what colcon itself prints goes to standard error.
"""

import gc
import json
import os
import signal
import sys

request = json.load(sys.stdin)
sys.path[:] = request["path"]
events = os.fdopen(os.dup(1), "w", encoding="utf-8")
os.dup2(2, 1)

from wsgen.isolation.lifeline import hold  # noqa: E402  the search path had to be set first

# Not SIGKILL: make and compilers remove the files that they have half written.
hold(request["lifeline"], signal.SIGTERM)

# The process is short, and importing colcon makes objects enough to keep the collector busy.
gc.disable()

from colcon_core.command import main  # noqa: E402  same

from wsgen.workspace.colcon_events import write_events_to  # noqa: E402  same

write_events_to(events)
sys.argv[0] = "colcon"  # the name in its messages
sys.exit(main(argv=request["arguments"]))
