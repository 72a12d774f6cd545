"""The process of the launch service.

    python -I service_process.py FOLDER DESCRIPTOR SEARCH_PATH

Its standard input is the parent-death pipe; the descriptor is a socket, by which its parent says
it what to do. It imports what it needs, and then waits for the request in the folder. Before it
does anything, a guard stands between it and its parent, which ends all that the launch has started
when this process or the parent ends, however they end.
"""

from __future__ import annotations

import json
import math
import os
import socket
import sys
import time
from pathlib import Path
from typing import TypeVar

from wsgen.errors import EXIT_FAILED
from wsgen.isolation.child import set_search_path
from wsgen.isolation.codec import decode
from wsgen.isolation.guard import stand_guard
from wsgen.isolation.system import take_parent_death_pipe
from wsgen.live.request import GO, NODES, NODES_FILE, NodeServerRequest, ServiceRequest
from wsgen.live.resources import remove_left_behind
from wsgen.simulation.live_runs import REQUEST_FILE

Kind = TypeVar("Kind")
CLOCK_TICK = 0.05  # s; the times of files are older than the clock by a tick of the kernel


def main() -> int:
    """Play the launch of the request in the folder; gives the exit code."""
    folder, descriptor = Path(sys.argv[1]), int(sys.argv[2])
    begun = time.time() - CLOCK_TICK
    stand_guard(take_parent_death_pipe(), math.inf, lambda: remove_left_behind(begun))
    control = socket.socket(fileno=descriptor)
    set_search_path(sys.argv[3].split(os.pathsep))
    for stream in (sys.stdout, sys.stderr):  # what the launch file prints
        stream.reconfigure(line_buffering=True, errors="replace")  # type: ignore[union-attr]  # files

    from wsgen.descriptions.xacro import expansion  # noqa: PLC0415  same
    from wsgen.launching import worker  # noqa: PLC0415  the guard need not have it
    from wsgen.live.forked_nodes import NodeServer  # noqa: PLC0415  same
    from wsgen.live.service import Service  # noqa: PLC0415  same
    from wsgen.pipeline.tasks.launch import run_xacro  # noqa: PLC0415  same

    worker.load_shim()
    nodes = None
    while (word := control.recv(1)) == NODES:
        nodes = NodeServer(_read(folder / NODES_FILE, NodeServerRequest))
    if word != GO:
        return EXIT_FAILED
    request = _read(folder / REQUEST_FILE, ServiceRequest)
    service = Service(request, control, nodes)
    service.prepare()
    went_well = worker.play_live(
        request.launch, service, run_xacro=run_xacro, explain_xacro=expansion.explain_error
    )
    service.close()
    return service.shutdown.exit_code(went_well=went_well)


def _read(file: Path, kind: type[Kind]) -> Kind:
    return decode(json.loads(file.read_text(encoding="utf-8")), kind)


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    # Threads of the launch file may still run.
    os._exit(code)
