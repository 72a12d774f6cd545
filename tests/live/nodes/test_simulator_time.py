"""The time of a simulator without a /clock in ROS."""

from __future__ import annotations

import json
import socket
import threading
from typing import TYPE_CHECKING

import pytest

from wsgen.live.nodes import simulator_client
from wsgen.simulation.live_runs import short_name, socket_path

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.slow
def test_it_is_asked_as_soon_as_the_simulator_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(simulator_client, "ASK_SECONDS", 0.0)
    time = simulator_client.SimulatorTime(tmp_path)
    assert time.nanoseconds() == 0  # it is not there yet
    server = socket.socket(socket.AF_UNIX)
    with short_name(socket_path(tmp_path)) as name:
        server.bind(name)
    server.listen()

    def serve() -> None:
        client, _ = server.accept()
        with client, client.makefile("rwb") as stream:
            for seconds in (1.5, 2.25):
                assert json.loads(stream.readline()) == {"do": "state"}
                stream.write(json.dumps({"ok": True, "seconds": seconds}).encode() + b"\n")
                stream.flush()

    thread = threading.Thread(target=serve)
    thread.start()
    assert [time.nanoseconds(), time.nanoseconds()] == [1_500_000_000, 2_250_000_000]
    thread.join()
    assert time.nanoseconds() == 2_250_000_000  # it has ended
    monkeypatch.setattr(simulator_client, "ASK_SECONDS", 60.0)
    time.nanoseconds()
    assert time.nanoseconds() == 2_250_000_000  # it is not asked for each message
    time.close()
    server.close()


def test_a_simulator_that_hangs_holds_nobody(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(simulator_client, "ASK_SECONDS", 0.0)
    monkeypatch.setattr(simulator_client, "PATIENCE_SECONDS", 0.01)
    time = simulator_client.SimulatorTime(tmp_path)
    with socket.socket(socket.AF_UNIX) as server:
        with short_name(socket_path(tmp_path)) as name:
            server.bind(name)
        server.listen()
        assert time.nanoseconds() == 0
        server.accept()[0].close()
        answers = [b'{"ok": true}\n', b'{"seco', b'{"seconds": 2}\n']

        def serve() -> None:
            for answer in answers:
                client, _ = server.accept()
                with client:
                    client.recv(100)
                    client.sendall(answer)

        thread = threading.Thread(target=serve)
        thread.start()
        monkeypatch.setattr(simulator_client, "PATIENCE_SECONDS", 60.0)
        time = simulator_client.SimulatorTime(tmp_path)
        assert [time.nanoseconds() for _ in answers] == [0, 0, 2_000_000_000]
        thread.join()
        time.close()


def test_what_the_time_was_when_a_message_was_sent() -> None:
    times = simulator_client.SimulatedTimes()
    assert times.at(5) == 0
    times.note(100, 7)  # the simulator was asked
    times.note(900, 8)
    for sent in (200, 300):  # messages of /clock that have waited since
        times.note(sent, 10 * sent)
    assert [times.at(sent) for sent in (50, 150, 200, 299, 300, 5000)] == [
        *(7, 7, 2000, 2000, 3000, 3000)
    ]
    assert times.reach(300)
    assert not times.reach(301)


def test_old_times_are_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(simulator_client, "MOST_TIMES", 4)
    times = simulator_client.SimulatedTimes()
    for sent in range(1, 8):
        times.note(sent, sent)
    assert (times.at(1), times.at(7)) == (5, 7)
