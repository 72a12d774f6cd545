"""Launch files that are played for real, with plain processes."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import textwrap
import time
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

SERVE = Path(__file__).with_name("live") / "serve.py"
HEAD = """
import os, signal, sys
import textwrap
from launch import LaunchDescription
from launch.events import *
from launch.events.process import *
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.substitutions import *
from launch_ros.actions import *

def python(code, *words, **keywords):
    keywords = {'name': 'node', 'output': 'screen', **keywords}
    return ExecuteProcess(cmd=['python3', '-c', textwrap.dedent(code), *words], **keywords)

def generate_launch_description():
"""
SECONDS = 300.0  # wall-clock, on a busy machine


class Launch:
    """A launch that runs."""

    def __init__(self, text: str, folder: Path, **options: Any) -> None:
        file = folder / "test.launch.py"
        file.write_text(HEAD + textwrap.indent(textwrap.dedent(text), "    "), encoding="utf-8")
        self.live = folder / "live"
        self.live.mkdir()
        self.logs = folder / "logs"
        self.screen = folder / "screen"
        environment = {**os.environ, "ROS_LOG_DIR": str(self.logs)}
        with self.screen.open("wb") as stream:
            self.process = subprocess.Popen(
                [sys.executable, str(SERVE), str(file), str(self.live), json.dumps(options)],
                stdin=subprocess.DEVNULL,
                stdout=stream,
                stderr=subprocess.STDOUT,
                env=environment,
                start_new_session=True,
            )

    @property
    def output(self) -> str:
        """What it has printed."""
        return self.screen.read_text(encoding="utf-8", errors="replace")

    @property
    def lines(self) -> list[str]:
        """Its lines, without those about where logs are."""
        return [line for line in self.output.splitlines() if not line.startswith("[INFO] [launch]")]

    @property
    def log(self) -> str:
        """What is in launch.log."""
        return self.read_log("launch.log")

    def read_log(self, name: str) -> str:
        """What is in a log."""
        (folder,) = {found.resolve() for found in self.logs.iterdir()}
        return (folder / name).read_text(encoding="utf-8")

    def wait(self) -> int:
        """Wait for its end; gives the exit code."""
        return self.process.wait(SECONDS)

    def wait_for(self, text: str) -> None:
        """Wait until it has printed a text."""
        wait_until(lambda: text in self.output, lambda: f"{text!r} is not in:\n{self.output}")

    def pids(self) -> list[int]:
        """The processes that it has told of, and those whose numbers they print as `pid N`."""
        words = self.output.replace("[", " ").replace("]", " ").split()
        return [
            int(word) for before, word in pairwise(words) if before == "pid" and word.isdecimal()
        ]

    def interrupt(self) -> None:
        """Press Ctrl-C."""
        self.process.send_signal(signal.SIGINT)


def wait_until(holds: Callable[[], bool], why: Callable[[], str], seconds: float = SECONDS) -> None:
    """Wait until something holds."""
    end = time.monotonic() + seconds
    while not holds():
        assert time.monotonic() < end, why()
        time.sleep(0.01)


def is_alive(pid: int) -> bool:
    """Whether a process runs."""
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(") ")[2][0]
    except OSError:
        return False
    return state != "Z"
