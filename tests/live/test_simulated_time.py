"""The time of a simulator, asked by its socket."""

from __future__ import annotations

import json
import socket
import threading
from typing import TYPE_CHECKING

from wsgen.live import termination
from wsgen.live.termination import SimulatedTime
from wsgen.simulation.live_runs import short_name, socket_path

if TYPE_CHECKING:
    from pathlib import Path

    import pytest


def test_one_connection_asks_a_socket_with_a_long_path(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(termination, "SECONDS", 60.0)  # on a busy machine
    folder = tmp_path / ("long" * 25) / ("path" * 25)
    folder.mkdir(parents=True)
    time = SimulatedTime(folder)
    assert time.now() is None  # it is not there yet
    server = socket.socket(socket.AF_UNIX)
    with short_name(socket_path(folder)) as name:
        server.bind(name)
    server.listen()
    taken = []

    def serve() -> None:
        for answers in ([1.5, 2.5], [3.5]):  # then the simulator is another one
            client, _ = server.accept()
            taken.append(client)
            with client, client.makefile("rwb") as stream:
                for seconds in answers:
                    assert json.loads(stream.readline()) == {"do": "state"}
                    stream.write(json.dumps({"ok": True, "seconds": seconds}).encode() + b"\n")
                    stream.flush()

    thread = threading.Thread(target=serve)
    thread.start()
    assert [time.now(), time.now()] == [1.5, 2.5]
    while time.now() != 3.5:
        pass
    assert len(taken) == 2
    time.close()
    thread.join()
    server.close()
