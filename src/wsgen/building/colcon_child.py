"""The process that colcon runs in: a script with the module search path and colcon's arguments.

Standard input is the parent-death pipe. Standard output carries the events to wsgen; the output of
colcon itself goes to standard error.
"""

import gc
import json
import os
import signal
import sys

from colcon_core.command import main
from colcon_core.executor import Job

from wsgen.building.colcon_events import write_events_to
from wsgen.building.package_environment import set_package_environments
from wsgen.building.python_environments import ignore_python_environments
from wsgen.isolation.system import end_with_parent, take_parent_death_pipe

sys.path[:] = json.loads(sys.argv[1])
events = os.fdopen(os.dup(1), "w", encoding="utf-8")
os.dup2(2, 1)


# Not SIGKILL: make and compilers remove unfinished files.
end_with_parent(take_parent_death_pipe(), signal.SIGTERM)

# The process is short, and importing colcon creates enough objects to keep the collector busy.
gc.disable()

set_package_environments(os.environ)
ignore_python_environments()
run_job = Job.__call__


async def run_to_its_end(job: Job) -> int:
    """Let a package fail whose task raises: colcon would give up all others, too."""
    try:
        await run_job(job)
    except Exception:  # noqa: BLE001  the job has reported it
        return 1
    return int(job.returncode)


Job.__call__ = run_to_its_end
write_events_to(events)
sys.argv[:2] = ["colcon"]  # the name in its messages
sys.exit(main(argv=sys.argv[1:]))
