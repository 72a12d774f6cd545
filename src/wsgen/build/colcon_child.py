"""The process that colcon runs in: run as a script, with the request on standard input.

It imports nothing but the standard library until the search path is set. Standard output carries
the events to wsgen; what colcon itself prints goes to standard error.
"""

import gc
import json
import os
import signal
import sys

from colcon_core.command import main

from wsgen.build.colcon_events import write_events_to
from wsgen.isolation.parent_death import hold

request = json.load(sys.stdin)
sys.path[:] = request["path"]
events = os.fdopen(os.dup(1), "w", encoding="utf-8")
os.dup2(2, 1)


# Not SIGKILL: make and compilers remove the files that they have half written.
hold(request["parent_death_pipe"], signal.SIGTERM)

# The process is short, and importing colcon makes objects enough to keep the collector busy.
gc.disable()


write_events_to(events)
sys.argv[0] = "colcon"  # the name in its messages
sys.exit(main(argv=request["arguments"]))
