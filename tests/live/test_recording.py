"""The process that records topics: its start, its end, and what keeps it from its file."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from ros_for_tests import ros_with, variables_for
from wsgen.errors import SessionDiedError
from wsgen.live.recording import recording_topics
from wsgen.ros_environment import RosEnvironment, variables_of_nodes

if TYPE_CHECKING:
    from collections.abc import Mapping

if sys.platform != "linux":
    pytest.skip("live runs need Linux", allow_module_level=True)

PYTHON = Path(sys.executable)
SAY = """
import sys
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("one_who_says")
publisher = node.create_publisher(String, "said", 10)
while publisher.get_subscription_count() == 0:
    rclpy.spin_once(node, timeout_sec=0.02)
for word in ("one", "two"):
    publisher.publish(String(data=word))
publisher.wait_for_all_acked(rclpy.duration.Duration(seconds=60))
"""


@pytest.fixture(scope="module")
def variables() -> Mapping[str, str]:
    ros: RosEnvironment = ros_with()
    environment = variables_for(ros)
    return {**environment, **variables_of_nodes(ros, environment)}


@pytest.mark.slow
def test_messages_have_the_time_of_the_machine(
    tmp_path: Path, variables: Mapping[str, str], monkeypatch: pytest.MonkeyPatch
) -> None:
    reader = pytest.importorskip("mcap.reader")
    for name in ("argparse", "yaml", "numpy"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('executed')")
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "said.mcap"
    began = time.time_ns()
    with recording_topics(file, PYTHON, variables, use_sim_time=False):
        subprocess.run([PYTHON, "-c", SAY], cwd="/", env=dict(variables), check=True, timeout=120)
    with file.open("rb") as stream:
        found = [
            (channel.topic, message.log_time)
            for _, channel, message in reader.make_reader(stream).iter_messages()
        ]
    assert [topic for topic, _ in found] == ["/said", "/said"]
    assert all(began < stamp < time.time_ns() for _, stamp in found)


@pytest.mark.slow
def test_a_short_run_has_a_file(
    tmp_path: Path, variables: Mapping[str, str], capfd: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "short.mcap"
    with recording_topics(file, PYTHON, variables, use_sim_time=True):
        pass
    assert file.read_bytes()[:5] == b"\x89MCAP"
    assert capfd.readouterr().err == ""


@pytest.mark.slow
def test_a_full_disk(tmp_path: Path, variables: Mapping[str, str]) -> None:
    (tmp_path / "x.mcap.part").symlink_to("/dev/full")
    with (
        pytest.raises(SessionDiedError, match=r"x\.mcap\.part cannot be written: No space left"),
        recording_topics(tmp_path / "x.mcap", PYTHON, variables, use_sim_time=True),
    ):
        pass
    assert not (tmp_path / "x.mcap").exists()


def test_a_file_that_cannot_be_written(tmp_path: Path) -> None:
    file = tmp_path / "x.mcap"
    (tmp_path / "x.mcap.part").mkdir()
    with (
        pytest.raises(SessionDiedError, match=r"x\.mcap\.part cannot be written: Is a dir"),
        recording_topics(file, PYTHON, os.environ, use_sim_time=True),
    ):
        pytest.fail("nothing is recorded")


def test_a_recorder_that_does_not_start(tmp_path: Path) -> None:
    (tmp_path / "rclpy.py").write_text("raise ImportError('no ROS')")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path)}
    with (
        pytest.raises(SessionDiedError, match="a Python module cannot be imported: no ROS") as one,
        recording_topics(tmp_path / "x.mcap", PYTHON, environment, use_sim_time=True),
    ):
        pytest.fail("nothing is recorded")
    assert one.value.exit_code == 1
    assert [path.name for path in tmp_path.iterdir() if "mcap" in path.name] == []
