"""A node that lacks a Python module: wsgen says what to install, and into which interpreter."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from wsgen.live.python_failures import (
    explain_module,
    explain_numpy,
    missing_module,
    missing_name,
    newer_numpy,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from live_launch import Launch


@pytest.mark.parametrize(
    ("module", "words"),
    [
        ("cv2", "/py -m pip install 'opencv-python-headless<5'"),
        ("yaml", "/py -m pip install PyYAML"),
        ("PIL.Image", "/py -m pip install pillow"),
        ("pinocchio", "/py -m pip install pin"),  # a package of ROS, too
        ("sklearn.cluster", "/py -m pip install scikit-learn"),
        ("serial", "/py -m pip install pyserial"),
        ("scipy.spatial", "/py -m pip install scipy"),
        ("transforms3d", "/py -m pip install transforms3d"),
        ("tkinter", "sudo apt install python3-tk"),
        ("rospy", "ROS 1"),
        ("geometry_msg.msg", "Did you mean `geometry_msgs`?"),
        ("sensor_mesgs.msg", "Did you mean `sensor_msgs`?"),
        ("rclpyy", "Did you mean `rclpy`?"),
        ("rover_mgss", "Did you mean `rover_msgs`?"),
        ("example_interface.srv", "Did you mean `example_interfaces`?"),
        ("scipyy", "/py -m pip install scipyy"),
        ("nav2_simple_commander.robot_navigator", "a package of ROS that PyPI does not have"),
        ("gazebo_msgs.srv", "add <exec_depend>gazebo_msgs</exec_depend> to the package.xml"),
        ("rover_msgs.msg", "rover_msgs is a package of this workspace"),
    ],
)
def test_each_module_has_its_way(module: str, words: str) -> None:
    said = explain_module(module, Path("/py"), ("rover_msgs",))
    assert words in said
    assert f"the Python module {module} is missing" in said


def test_a_message_that_a_package_does_not_have(tmp_path: Path) -> None:
    file = tmp_path / "__init__.py"
    file.write_text("from geometry_msgs.msg._twist import Twist  # noqa: F401\n")
    line = f"ImportError: cannot import name 'Twst' from 'geometry_msgs.msg' ({file})"
    hint = "geometry_msgs has no msg/Twst. Did you mean `geometry_msgs.msg.Twist`?"
    assert missing_name(f"  x\n{line}\n".encode()) == hint
    assert (
        missing_name(line.replace("Twst", "Wombat").encode()) == "geometry_msgs has no msg/Wombat."
    )
    assert missing_name(f"[INFO] {line}".encode()) is None
    file.write_bytes(b"\xff\xfe\xff")
    assert missing_name(line.encode()) is None
    file.unlink()
    assert missing_name(line.encode()) is None
    os.mkfifo(file)  # nobody writes into it
    assert missing_name(line.encode()) is None
    assert missing_name(line.replace(str(file), "\0").encode()) is None


@pytest.mark.slow
def test_a_message_that_no_package_has_is_named_once(
    launch: Callable[..., Launch], tmp_path: Path
) -> None:
    file = tmp_path / "__init__.py"
    file.write_text("from rover_msgs.msg._speed import Speed\n")
    run = launch(
        f"""
        words = "cannot import name 'Sped' from 'rover_msgs.msg' ({file})"
        return LaunchDescription([
            python(f'raise ImportError({{words!r}})', name='one', respawn=True,
                   respawn_max_retries=1),
        ])
        """
    )
    run.wait()
    assert run.output.count("process has died") == 2
    (hint,) = [line for line in run.lines if "Did you mean" in line]
    assert hint.startswith("[ERROR] [one-1]: rover_msgs has no msg/Sped.")


def test_a_sourced_ros_has_packages_for_its_modules() -> None:
    said = explain_module("tf_transformations", None, (), "jazzy")
    assert "sudo apt install ros-jazzy-tf-transformations" in said
    assert "python3 -m pip install pyserial" in explain_module("serial", None, (), "jazzy")


def test_only_the_end_of_a_traceback_counts() -> None:
    text = b"Traceback:\n  x\nModuleNotFoundError: No module named 'a.b'"
    assert missing_module(text) == "a.b"
    assert missing_module(b"[WARN] ModuleNotFoundError: No module named 'a'") is None


@pytest.mark.slow
def test_a_node_that_is_older_than_numpy(launch: Callable[..., Launch]) -> None:
    said = explain_numpy("2.4", Path("/py"))
    assert "/py -m pip install 'numpy<2.4'" in said
    assert (
        newer_numpy(b"AttributeError: `np.float_` was removed in the NumPy 2.0 release. U") == "2"
    )
    assert newer_numpy(b"[INFO] all is well") is None
    run = launch(
        """
        words = 'only 0-dimensional arrays can be converted to Python scalars'
        return LaunchDescription([
            python(f'raise TypeError("{words}")', name='old', respawn=True, respawn_max_retries=1),
        ])
        """
    )
    run.wait()
    assert "[ERROR] [old-1]: process has died" in run.output
    assert run.output.count("process has died") == 2  # and the hint comes once
    (hint,) = [line for line in run.lines if "correct the line, or " in line]
    assert hint.startswith("[ERROR] [old-1]: NumPy 2.4 and later refuse")


@pytest.mark.slow
def test_a_node_that_dies_for_a_module_gets_one_hint(launch: Callable[..., Launch]) -> None:
    run = launch(
        """
        return LaunchDescription([
            python("import serial_not_there.tools", name='one'),
            python('''
                try:
                    import optional_not_there
                except ImportError:
                    import traceback
                    traceback.print_exc()
            ''', name='lives'),
            python('''
                import sys, traceback
                try:
                    import optional_not_there
                except ImportError:
                    traceback.print_exc()
                try:
                    raise TypeError(
                        'only 0-dimensional arrays can be converted to Python scalars'
                    )
                except TypeError:
                    traceback.print_exc()
                for _ in range(20):
                    print('it goes on', file=sys.stderr)
                sys.exit(3)
            ''', name='dies_later'),
            python('''
                try:
                    import serial_not_here
                except ImportError as error:
                    raise RuntimeError('no driver') from error
            ''', name='says_more'),
        ])
        """
    )
    run.wait()
    hints = [line for line in run.lines if "pip install" in line]
    assert sorted(hints) == [
        f"[ERROR] [{name}]: the Python module {module} is missing: "
        f"{sys.executable} -m pip install {module}"
        for name, module in (("one-1", "serial_not_there"), ("says_more-4", "serial_not_here"))
    ]
    assert "correct the line, or " not in run.output  # that error was handled, too
