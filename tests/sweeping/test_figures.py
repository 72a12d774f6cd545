"""The columns of what was measured."""

from dataclasses import replace
from pathlib import Path

from sweeping.blueprints import blueprint
from wsgen.model.behavior import Behavior, BehaviorOutcome, Reach
from wsgen.model.outcome import RobotOutcome
from wsgen.model.transform import Pose
from wsgen.pipeline.behavior_plan import BehaviorPlan
from wsgen.sweeping.run_variant import columns, figures_of


def test_joints_with_the_name_of_a_column() -> None:
    joints = {"passed": 1.0, "joint.passed": 2.0, "arm": 3.0}
    task = Reach(positions=joints)
    plan = BehaviorPlan(
        file=Path("wsgen.toml"),
        entities={"wave": "plate"},
        behaviors=(Behavior(name="wave", task=task, seconds=1.0),),
        behavior_runs=(),
        diagnostics=(),
    )
    made = replace(blueprint(), behavior_plan=plan)
    outcome = RobotOutcome(
        entity="plate",
        spawn_pose=Pose(),
        links=1,
        joints=3,
        movable_joints=3,
        mass=1.0,
        behaviors=(BehaviorOutcome(name="wave", task=task, passed=False, positions=joints),),
    )
    names = [one.name for one in columns(made)]
    assert len(set(names)) == len(names)
    figures = figures_of(made, [outcome], ())
    assert figures == {
        "behavior.wave.passed": False,
        "behavior.wave.joint.joint.passed": 1.0,
        "behavior.wave.joint.passed": 2.0,
        "behavior.wave.arm": 3.0,
    }
    assert set(figures) <= set(names)
