"""A child that was forked, as `subprocess.Popen` has it."""

from __future__ import annotations

import os
import sys

import pytest

if sys.platform != "linux":
    pytest.skip("nothing is forked elsewhere", allow_module_level=True)

from wsgen.isolation.forked import ForkedProcess


def forked(code: int) -> int:
    pid = os.fork()
    if pid == 0:
        os._exit(code)
    return pid


def test_its_exit_code() -> None:
    process = ForkedProcess(forked(3))
    assert process.wait(60) == process.poll() == 3


def test_another_one_has_asked_for_its_exit_code() -> None:
    process = ForkedProcess(forked(3))
    os.waitpid(process.pid, 0)
    assert process.wait(60) == 0
    process.kill()
