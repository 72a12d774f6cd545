"""The process that colcon runs in, a script with the request on standard input.

Standard output carries the events to wsgen; the output of colcon itself goes to standard error.
"""

import gc
import json
import os
import signal
import sys

from colcon_core.command import main

from wsgen.build.colcon_events import write_events_to
from wsgen.isolation.parent_death import end_with_parent

request = json.load(sys.stdin)
sys.path[:] = request["path"]
events = os.fdopen(os.dup(1), "w", encoding="utf-8")
os.dup2(2, 1)


# Not SIGKILL: make and compilers remove unfinished files.
end_with_parent(request["parent_death_pipe"], signal.SIGTERM)

# The process is short, and importing colcon creates enough objects to keep the collector busy.
gc.disable()


write_events_to(events)
sys.argv[0] = "colcon"  # the name in its messages
sys.exit(main(argv=request["arguments"]))
