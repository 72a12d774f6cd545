"""What `--until-exit` may name."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from wsgen.errors import RequestError
from wsgen.live.plan_checks import check_awaited
from wsgen.model.plan import Include, LaunchPlan, Process

PLAN = LaunchPlan(
    package="rover",
    launch_file=Path("rover.launch.py"),
    processes=(
        Process(package="rover", executable="drive.py", name="pilot", namespace="left"),
        Process(package=None, executable="/opt/tool", command=("/opt/tool", "x"), name="helper"),
        Process(package="rover", executable="goal", starts="exit of pilot"),
    ),
)


@pytest.mark.parametrize(
    "name", ["pilot", "/left/pilot", "drive.py", "drive.py-1", "helper", "tool", "tool-2", "goal"]
)
def test_names_of_nodes_and_programs_are_taken(name: str) -> None:
    check_awaited(name, PLAN)


def test_another_name_is_refused_with_the_nearest() -> None:
    with pytest.raises(RequestError) as caught:
        check_awaited("pilto", PLAN)
    assert "`pilto`" in str(caught.value)
    assert (caught.value.hint or "").startswith("Did you mean `pilot`?")


def test_what_gazebo_starts_and_names_of_processes_are_taken(tmp_path: Path) -> None:
    include = Include(package="ros_gz_sim", file=Path("gz_sim.launch.py"), evaluated=False)
    check_awaited("gazebo", replace(PLAN, includes=(include,)))
    file = tmp_path / "rover.launch.py"
    file.write_text("Node(package='rover', executable='goal', exec_name='third')")
    check_awaited("third", replace(PLAN, launch_file=file))
    with pytest.raises(RequestError):
        check_awaited("thrid", replace(PLAN, launch_file=file))


def test_a_launch_in_the_launch_has_no_end_to_wait_for() -> None:
    nested = Process(package=None, executable="ros2", command=("ros2", "launch", "rover", "arm.py"))
    plan = replace(PLAN, processes=(*PLAN.processes, nested))
    with pytest.raises(RequestError, match="starts another launch file"):
        check_awaited("ros2", plan)
    run = Process(package=None, executable="ros2", command=("ros2", "bag", "record"))
    check_awaited("ros2", replace(plan, processes=(*plan.processes, run)))
