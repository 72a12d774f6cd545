"""Programs of a live run end at the first signal, wherever it comes."""

from __future__ import annotations

import subprocess
import sys

import pytest

PROGRAM = """
import os, signal, time
from wsgen.live.nodes.signals import ignore_ends, raise_when_ended

class Dropping:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0.01)

raise_when_ended()
try:
    dropping = Dropping()
    del dropping
    print("dropped", flush=True)
    time.sleep(60)
except KeyboardInterrupt:
    ignore_ends()
    time.sleep(1.5)
    print("ended")
"""


@pytest.mark.slow
def test_a_signal_that_a_finalizer_drops_comes_again_once() -> None:
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM], capture_output=True, text=True, timeout=300, check=False
    )
    assert done.stdout == "dropped\nended\n", done.stderr


BOTH = """
import signal
from wsgen.live.nodes.signals import ENDING, ignore_ends, raise_when_ended

raise_when_ended()
try:
    signal.pthread_sigmask(signal.SIG_BLOCK, ENDING)
    for number in ENDING:
        signal.raise_signal(number)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, ENDING)
except KeyboardInterrupt:
    ignore_ends()  # else it is raised again after a second
    print("ended")
"""


def test_signals_that_come_together_end_it_without_a_word() -> None:
    done = subprocess.run(
        [sys.executable, "-c", BOTH], capture_output=True, text=True, timeout=300, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "ended\n", "")
