"""The node of the launch service, in a process that has rclpy: started when it is needed."""

from __future__ import annotations

import json
import os
from contextlib import suppress
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import subprocess
    from collections.abc import Callable, Sequence

    from wsgen.live.forked_nodes import ForkedNode

MODULE = "wsgen.live.nodes.launch_node"  # says what is asked for, and how
STDERR = 2
LARGEST = 1 << 16  # bytes that are read at once


class LaunchNode:
    """The process.

    Args:
        begin: Starts it; is given descriptors for its output and its errors.

    Raises:
        OSError: It cannot be started.
    """

    def __init__(
        self, begin: Callable[[Sequence[int]], subprocess.Popen[bytes] | ForkedNode]
    ) -> None:
        self.descriptor, theirs = os.pipe()
        try:
            self._process = begin((theirs, STDERR))
        except OSError:
            os.close(self.descriptor)
            raise
        finally:
            os.close(theirs)
        self._rest = b""

    def send(self, do: str, **values: object) -> None:
        """Ask for something."""
        line = json.dumps({"do": do, **values}).encode() + b"\n"
        assert self._process.stdin is not None  # noqa: S101  it is started with one
        with suppress(OSError):  # it has ended, which `take` says
            self._process.stdin.write(line)
            self._process.stdin.flush()

    def take(self) -> list[dict[str, Any]] | None:
        """What has happened; None when the process has ended."""
        data = os.read(self.descriptor, LARGEST)
        if not data:
            return None
        *lines, self._rest = (self._rest + data).split(b"\n")
        return [json.loads(line) for line in lines]

    def close(self) -> None:
        """Have it end."""
        with suppress(OSError):
            if self._process.stdin is not None:
                self._process.stdin.close()
        os.close(self.descriptor)
        self._process.poll()
