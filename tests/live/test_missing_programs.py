from __future__ import annotations

from pathlib import Path

from wsgen.live.plan_checks import CANNOT_RUN, cannot_run
from wsgen.model.plan import LaunchPlan, Process

FILE = Path("robot.launch.py")


def _plan(*processes: Process) -> LaunchPlan:
    return LaunchPlan(package="robot", launch_file=FILE, processes=processes)


def test_programs_that_cannot_run_are_reported_where_they_are_written() -> None:
    rviz = Process(package="rviz2", executable="rviz2", file=FILE, line=7)
    (found,) = cannot_run(_plan(rviz), is_sourced=False)
    assert (found.code, found.file, found.line) == (CANNOT_RUN.code, FILE, 7)
    assert found.message.startswith("rviz2 of rviz2 cannot run here: ")
    assert not list(cannot_run(_plan(rviz), is_sourced=True))


def test_what_wsgen_does_itself_is_not_missing() -> None:
    window = Process(package=None, executable=None, command=("gzclient",))
    server = Process(package=None, executable=None, command=("gz", "sim", "-r", "a.sdf"))
    own = Process(package="robot", executable="drive.py")
    assert not list(cannot_run(_plan(window, server, own), is_sourced=False))


def test_nodes_for_containers_cannot_run_but_for_those_that_wsgen_has() -> None:
    own, bridge, other = (
        Process(package=package, executable=plugin, container="/box", file=FILE, line=3)
        for package, plugin in (
            ("camera", "camera::Proc"),
            ("ros_gz_bridge", "ros_gz_bridge::RosGzBridge"),
            ("camera", "camera::Other"),
        )
    )
    found = list(cannot_run(_plan(own, bridge, other), is_sourced=False))
    assert [one.message.partition(":")[0] for one in found] == ["camera", "camera"]
    assert found[0].message.startswith("camera::Proc of camera cannot run here: it is a C++ node")
    assert not list(cannot_run(_plan(own, bridge, other), is_sourced=True))
