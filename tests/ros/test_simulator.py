"""The simulator of live runs, its spawner and its bridge, as real nodes see them."""

from __future__ import annotations

import json
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from live.nodes.fake_ros import live_scene, plugin
from ros_for_tests import variables_for
from wsgen.isolation.codec import encode
from wsgen.simulation.live_runs import FOLDER_VARIABLE, SCENE_FILE, LiveScene

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from wsgen.ros.environment import RosEnvironment

pytestmark = pytest.mark.slow
USER = Path(__file__).with_name("simulator_user.py")
WAIT = 300.0  # s, on a busy machine
DRIVE = (
    "<left_joint>left</left_joint><right_joint>right</right_joint>"
    "<wheel_separation>0.4</wheel_separation>"
)
CLASSIC = (
    plugin(
        "libgazebo_ros_diff_drive.so",
        f"{DRIVE}<wheel_diameter>0.2</wheel_diameter><odometry_source>0</odometry_source>"
        "<publish_odom>true</publish_odom><publish_odom_tf>true</publish_odom_tf>",
        name="drive",
    ),
    plugin(
        "libgazebo_ros_joint_state_publisher.so",
        "<joint_name>left</joint_name><joint_name>right</joint_name>",
        name="states",
    ),
    plugin(
        "libgazebo_ros_p3d.so",
        "<ros><remapping>odom:=truth</remapping></ros><body_name>base</body_name>"
        "<update_rate>50</update_rate>",
        name="truth",
    ),
)


@contextmanager
def simulator(
    scene: LiveScene, folder: Path, variables: Mapping[str, str]
) -> Iterator[tuple[subprocess.Popen[str], dict[str, str]]]:
    """The simulator of a scene, and the variables of processes of the same live run."""
    (folder / SCENE_FILE).write_text(encode(scene))
    environment = {**variables, FOLDER_VARIABLE: str(folder)}
    command = [sys.executable, "-m", "wsgen.live.nodes.simulator"]
    with subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True) as process:
        try:
            yield process, environment
        finally:
            process.kill()


def run(module: str, *arguments: str, environment: Mapping[str, str]) -> tuple[int, str]:
    """A program that belongs to the live run: its exit code and what it printed."""
    done = subprocess.run(
        [sys.executable, "-m", f"wsgen.live.nodes.{module}", *arguments],
        env=environment,
        capture_output=True,
        text=True,
        timeout=WAIT,
        check=False,
    )
    return done.returncode, done.stderr


def test_a_node_drives_a_robot_in_the_place_of_classic(ros: RosEnvironment, tmp_path: Path) -> None:
    scene = live_scene(*CLASSIC, rate=2.0)
    with simulator(scene, tmp_path, variables_for(ros)) as (process, environment):
        urdf = tmp_path / "rover.urdf"
        urdf.write_text("<robot name='rover'/>")
        arguments = ("--as", "spawn_entity.py", "-entity", "rover", "-file", str(urdf))
        code, printed = run("create", *arguments, environment=environment)
        assert code == 0, printed
        assert "Successfully spawned entity [rover]" in printed
        again, printed = run("create", *arguments, environment=environment)
        assert again == 1
        assert "exists already" in printed
        user = subprocess.run(
            [sys.executable, str(USER)],
            env=environment,
            capture_output=True,
            text=True,
            timeout=WAIT,
            check=False,
        )
        process.terminate()
        _, warnings = process.communicate(timeout=WAIT)
    assert user.returncode == 0, user.stderr
    seen = json.loads(user.stdout)
    assert seen["frames"] == seen["tf"] == ["odom", "base_footprint"]
    assert seen["joints"] == ["left", "right"]
    assert seen["speed"] == pytest.approx(0.5, rel=0.05)
    assert seen["moved"]["/odom"] == pytest.approx(seen["moved"]["/truth"], rel=0.05)
    assert seen["is_paused"]
    assert seen["reset"]
    assert process.returncode == 0
    assert warnings.count("NaN") == 1
    assert "Traceback" not in warnings
