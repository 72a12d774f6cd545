"""Publish, subscribe and call services by a process that has rclpy."""

from __future__ import annotations

import json
import select
import socket
import subprocess
import time
from typing import TYPE_CHECKING, Any

from wsgen.errors import RequestError, SessionDiedError
from wsgen.isolation.parent import not_started
from wsgen.isolation.result import read_tail
from wsgen.ros.environment.processes import module_command

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

MODULE = "wsgen.live.nodes.messenger"  # says what is asked for, and how
SECONDS_TO_END = 2.0  # of the clock
SECONDS_TO_START = 60.0  # of the clock, on a busy machine


class Messenger:
    """The process, from its start to its end.

    Raises:
        NotReadableError: It cannot be started.
    """

    def __init__(self, python: Path, environment: Mapping[str, str], errors: Path) -> None:
        """Start it; what it prints is added to the file `errors`."""
        self._errors = errors
        ours, theirs = socket.socketpair()
        # Killed, it would leave queues of Fast DDS in shared memory; with LOCALHOST it may do so
        # still, since rmw_fastrtps then adds them to all profiles.
        variables = {"FASTDDS_BUILTIN_TRANSPORTS": "UDPv4", **environment}
        try:
            with errors.open("ab") as output:
                self._process = subprocess.Popen(
                    module_command(python, MODULE, str(theirs.fileno())),
                    stdin=subprocess.DEVNULL,
                    stdout=output,
                    stderr=output,
                    pass_fds=(theirs.fileno(),),
                    env=variables,
                    start_new_session=True,  # Ctrl-C is for the process that has started it
                )
        except OSError as error:
            ours.close()
            raise not_started(error) from error
        finally:
            theirs.close()
        self._socket = ours
        self._rest = b""
        self._answers: dict[int, dict[str, Any]] = {}
        self._count = 0

    def send(self, do: str, **values: object) -> int:
        """Ask for something; gives the number of the answer.

        Raises:
            RequestError: A value is none that a message has.
            SessionDiedError: The process has ended.
        """
        self._count += 1
        try:
            text = json.dumps({"id": self._count, "do": do, **values}, default=_plain)
        except (TypeError, ValueError) as error:
            raise RequestError(
                f"No message has such a value: {error}.",
                hint="Give numbers, texts, lists, and dictionaries by the names of fields.",
            ) from error
        try:
            self._socket.sendall(text.encode() + b"\n")
        except OSError as error:
            raise self._ended() from error
        return self._count

    def answer(self, number: int, seconds: float = 0.0) -> dict[str, Any] | None:
        """The answer of that number, which is waited for so long at most.

        Raises:
            RequestError: What was asked for is not possible.
            SessionDiedError: The process has ended.
        """
        end = time.monotonic() + seconds
        while number not in self._answers:
            left = max(0.0, end - time.monotonic())
            if not select.select([self._socket], [], [], left)[0]:
                return None
            try:
                data = self._socket.recv(1 << 20)
            except OSError:
                data = b""
            if not data:
                raise self._ended()
            *lines, self._rest = (self._rest + data).split(b"\n")
            for line in lines:
                found = json.loads(line)
                self._answers[found.pop("id")] = found
        answer = self._answers.pop(number)
        if "error" in answer:
            raise RequestError(answer["error"], hint=answer.get("hint") or "Check what is given.")
        return answer

    def ask(self, do: str, **values: object) -> dict[str, Any]:
        """Ask for what is answered at once.

        Raises:
            RequestError: What was asked for is not possible.
            SessionDiedError: The process has ended, or hangs.
        """
        answer = self.answer(self.send(do, **values), SECONDS_TO_START)
        if answer is None:
            raise SessionDiedError(
                f"The process that speaks ROS for wsgen has not answered for {SECONDS_TO_START:g} "
                "s.",
                hint="Check the load and the memory of the machine.",
            )
        return answer

    def close(self) -> None:
        """End the process."""
        self._socket.close()
        try:
            self._process.wait(SECONDS_TO_END)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _ended(self) -> SessionDiedError:
        return SessionDiedError(
            "The process that speaks ROS for wsgen has ended.",
            hint=read_tail(self._errors) or "Check the memory of the machine.",
        )


def _plain(value: Any) -> Any:
    """What JSON has of a value that it does not know: of arrays and numbers of numpy."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{value!r} is a {type(value).__name__}")
