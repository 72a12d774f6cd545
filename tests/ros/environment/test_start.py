"""What the Python of a node executes at its start: exceptions of lifecycle nodes are shown."""

from __future__ import annotations

import shutil
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from ros_for_tests import plain_environment, ros_with, variables_for
from wsgen.ros.environment import RosEnvironment, variables_of_nodes
from wsgen.ros.environment.processes import START

if TYPE_CHECKING:
    from pathlib import Path

# As rclpy has it: exceptions of callbacks are results.
RCLPY = """
class LifecycleNodeMixin:
    def __init__(self):
        self._callbacks = {}
        self.__register_callback(10, self.on_configure)

    def __register_callback(self, state, callback):
        self._callbacks[state] = callback
        return True

    def trigger_configure(self):
        try:
            return self._callbacks[10]('unconfigured')
        except Exception:
            return 'error'
"""
NODE = """
import importlib.util
assert importlib.util.find_spec('rclpy.lifecycle.node')  # who only asks is not who imports it
import rclpy.lifecycle.node

class Logger:
    def error(self, text):
        print(text, end='')

class Talker(rclpy.lifecycle.node.LifecycleNodeMixin):
    get_logger = Logger
    def on_configure(self, state):
        return 'success' if state else None

class Raises(Talker):
    def on_configure(self, state):
        raise ValueError('no map')

class Wrong(Talker):
    def on_configure(self):
        pass

for node in (Talker(), Raises(), Wrong()):
    print(node.trigger_configure())
"""
REAL_NODE = """
import sys
import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn

class Talker(LifecycleNode):
    def on_configure(self, state):
        raise ValueError('no map')

    def on_error(self, state):
        return TransitionCallbackReturn.SUCCESS

rclpy.init()
node = Talker('talker')
print(node.trigger_configure().name, node._state_machine.current_state)
"""


def start(script: Path, *places: Path) -> str:
    path = ":".join(map(str, [*places, START]))
    done = subprocess.run(
        [sys.executable, str(script)],
        env={**plain_environment(), "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""
    return done.stdout


def test_exceptions_of_lifecycle_nodes_are_logged(tmp_path: Path) -> None:
    folder = tmp_path / "rclpy" / "lifecycle"
    folder.mkdir(parents=True)
    (folder / "node.py").write_text(RCLPY, encoding="utf-8")
    script = tmp_path / "node.py"
    script.write_text(NODE, encoding="utf-8")
    lines = start(script, tmp_path).splitlines()
    assert lines[:2] == [
        "success",
        "on_configure() raised an exception, so the transition fails:",
    ]
    assert lines[3] == f'  File "{script}", line 17, in on_configure'
    assert lines[4:6] == ["    raise ValueError('no map')", "ValueError: no map"]
    assert lines[6] == "error"
    assert lines[8].startswith("TypeError: ")  # it takes no state
    assert lines[9:] == ["error"]


def test_a_sitecustomize_of_the_user_is_executed_too(tmp_path: Path) -> None:
    """One that comes after the folder, as that of a Linux distribution; and no rclpy at all."""
    script = tmp_path / "script.py"
    script.write_text(
        "import sys, sitecustomize\nprint(sys.hidden, sitecustomize.__file__)", encoding="utf-8"
    )
    later = tmp_path / "later"
    later.mkdir()
    (later / "sitecustomize.py").write_text("import sys; sys.hidden = 1", encoding="utf-8")
    done = subprocess.run(
        [sys.executable, str(script)],
        env={**plain_environment(), "PYTHONPATH": f"{START}:{later}"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""
    assert done.stdout == f"1 {later / 'sitecustomize.py'}\n"


def test_that_of_another_wsgen_is_executed_once(tmp_path: Path) -> None:
    """As where a node starts the wsgen of another environment."""
    folder = tmp_path / "rclpy" / "lifecycle"
    folder.mkdir(parents=True)
    (folder / "node.py").write_text(RCLPY, encoding="utf-8")
    script = tmp_path / "node.py"
    script.write_text(NODE, encoding="utf-8")
    other, later = tmp_path / "other", tmp_path / "later"
    shutil.copytree(START, other)
    later.mkdir()
    (later / "sitecustomize.py").write_text("print('later')", encoding="utf-8")
    lines = start(script, tmp_path, other, START, later).splitlines()
    assert lines[0] == "later"
    assert sum("on_configure() raised an exception" in line for line in lines) == 2  # two nodes


def test_nodes_of_any_ros_have_it_last(tmp_path: Path) -> None:
    for is_sourced, after in ((True, ""), (False, f":{START.with_name('shim')}")):
        found = variables_of_nodes(
            RosEnvironment(
                distro="jazzy", is_sourced=is_sourced, python=tmp_path / "python", variables={}
            ),
            {"PYTHONPATH": "/mine"},
        )
        assert found["PYTHONPATH"] == f"/mine:{START}{after}"


@pytest.mark.slow
def test_the_real_rclpy_logs_them(tmp_path: Path) -> None:
    ros = ros_with()
    script = tmp_path / "talker.py"
    script.write_text(REAL_NODE, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, str(script)],
        env={**variables_for(ros, variables_of_nodes(ros, plain_environment()))},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout == "ERROR (1, 'unconfigured')\n"
    lines = done.stderr.splitlines()
    assert lines[0].endswith(
        "[talker]: on_configure() raised an exception, so the transition fails:"
    )
    assert lines[1:] == [
        "Traceback (most recent call last):",
        f'  File "{script}", line 8, in on_configure',
        "    raise ValueError('no map')",
        "ValueError: no map",
        "",
    ]
