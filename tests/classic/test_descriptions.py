"""What Gazebo Classic makes of the cases of `description_cases.py`, and what wsgen says of them.

`descriptions.json` was recorded with Debian 11's Gazebo 11.1 (sdformat 9): each robot was spawned
1 m above the ground, and simulated for 1 s. `--regenerate` records it anew where that is unpacked.
"""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from classic.description_cases import CASES, OF_RULES
from classic.gazebo_classic import HOST, NEEDS_CLASSIC, EndedError, GazeboClassic, recorded_in
from classic.test_rest_poses import WORLD, engine_of
from gazebo_oracle import IGN, run_ign
from mesh_samples import binary_stl
from urdf_texts import robot
from wsgen.checks.rules.catalogue import all_rules, find_rule
from wsgen.diagnostics import has_errors
from wsgen.isolation import parent
from wsgen.model.transform import Pose
from wsgen.pipeline.prepare import (
    PrepareContext,
    for_simulator,
    prepare_models,
    prepare_robot,
    read_file,
)
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.prepare import PreparedRobot

RECORDED = Path(__file__).with_name("descriptions.json")
# Asked live in each run of the tests.
LIVE = ("sound", "no limit", "two sensors", "a word for a friction")
# What is left of the robot rests there, and here; the other links are reported.
CUT = {
    "no moments": "ROB021",
    "massless child": "ROB040",
    "half a milligram": "ROB040",
    "massless frame that is kept": "ROB040",
    "on a lumped massless link": "ROB080",
    "a macro that is not expanded": "ROB143",
    "an unknown end of a joint of SDF": "ROB078",
}
# Gazebo Classic loads it, but not as it is meant or as wsgen could simulate it: wsgen has none.
REFUSED = {
    "negative mass": "ROB022: the link floats",
    "masses of 0, fixed": "ROB041: the pose of the link is no number, and the origin is shown",
    "a number beyond engines": "ROB056: it falls through the ground",
    "a broken mesh": "ROB062: it falls through the ground; Gazebo ends with other broken meshes",
    "two parents": "ROB011: one of the joints is left out",
    "an axis of 0": "ROB018: the joint has no direction",
    "a step of 0": "WLD007: time does not pass",
    "two links of a name in SDF": "WLD015: one of them is left out",
    "an unknown frame": "WLD016: the pose is one in the model",
    "a cycle of frames": "WLD017: the poses are some in the model",
    "no normal": "WLD034: it falls through the ground",
    "no area": "WLD057: it falls through the ground",
}
# wsgen simulates it in another way, and says so.
OTHERWISE = {"a static model in another": "WLD048: the inner model does not move there"}
CUBES = ({0.05}, {0.15})  # m; the cube of 0.1 m, and that of the mesh


def is_world(case: str) -> bool:
    return "<sdf" in CASES[case]


def write(case: str, folder: Path, host: str = "") -> Path:
    (folder / "m.stl").write_bytes(binary_stl())
    (folder / "broken.stl").write_bytes(binary_stl()[:100])
    text = CASES[case] if "<robot" in CASES[case] or is_world(case) else robot(CASES[case])
    text = text.replace("MESH", f"file://{host}{folder}/m.stl")
    file = folder / ("r.world" if is_world(case) else "r.urdf")
    file.write_text(text.replace("BROKEN", f"file://{host}{folder}/broken.stl"))
    return file


def ask(case: str, folder: Path) -> dict[str, Any]:
    """What the real one does: why it has no robot, or the heights of its links after 1 s, in m."""
    world = folder / "w.world"
    world.write_text(
        "<sdf version='1.6'><world name='w'><include><uri>model://ground_plane</uri></include>"
        "</world></sdf>"
    )
    file = write(case, folder, HOST)
    try:
        with GazeboClassic(file if is_world(case) else world) as gazebo:
            if not is_world(case):
                gazebo.spawn(file, "r", z=1.0)
            gazebo.run(1.0)
            links = gazebo.state().get("r", {"links": {}})["links"]
    except ValueError:
        return {"refused": True}
    except EndedError:
        return {"crashed": True}
    return {name.removeprefix("r::"): round(one["pose"][2], 2) + 0.0 for name, one in links.items()}


@pytest.fixture(scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("descriptions")
    return recorded_in(RECORDED, request, CASES, lambda name: ask(name, folder))


@pytest.mark.oracle
@pytest.mark.slow
@NEEDS_CLASSIC
@pytest.mark.parametrize("case", LIVE)
def test_the_record_is_what_gazebo_classic_does(case: str, recorded: Any, tmp_path: Path) -> None:
    assert ask(case, tmp_path) == recorded[case]


def prepared(
    case: str, folder: Path, simulator: str | None
) -> tuple[PreparedRobot | None, Sequence[Diagnostic]]:
    """What wsgen has of it."""
    context = PrepareContext(
        share_of=lambda _: None,
        folder=folder,
        run=parent.run,
        engines=("bullet",) if simulator == "classic" else (),
    )
    file = write(case, folder)
    if not is_world(case):
        spawned = Pose((0.0, 0.0, 1.0))
        return prepare_robot(
            file.read_text(), file=file, context=context, spawn_pose=spawned, simulator=simulator
        )
    found = read_file(file, context, {})
    found = found._replace(diagnostics=tuple(for_simulator(found.diagnostics, simulator)))
    models, more = prepare_models(found, context)
    model = next((one for one in models if one.entity == "r"), None)
    return model, (*found.diagnostics, *more)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_wsgen_simulates_what_gazebo_classic_simulates(
    case: str, recorded: Any, tmp_path: Path
) -> None:
    robot, found = prepared(case, tmp_path, "classic")
    heights = recorded[case]
    is_simulated = bool(heights) and not {"refused", "crashed"} & heights.keys()
    if not is_simulated or case in REFUSED:
        assert robot is None or not robot.can_run
        assert has_errors(found)
        return
    assert robot is not None
    assert robot.can_run
    assert case not in CUT or CUT[case] in {one.code for one in found}
    with closing(engine_of("bullet")(WORLD)) as engine:
        engine.spawn(SpawnedRobot(entity="r", robot=robot.lumped, pose_in_world=robot.spawn_pose))
        engine.advance(round(1.0 / engine.step_seconds))
        poses = engine.link_poses("r")
    if robot.lumped.fixed_to_world:
        del poses[robot.lumped.root]
    is_same = {name: pose.xyz[2] for name, pose in poses.items()} == {
        name: pytest.approx(height, abs=0.02) for name, height in heights.items()
    }
    assert is_same == (case not in OTHERWISE)


def verdict(case: str, recorded: Mapping[str, Any]) -> str:
    """What Gazebo Classic does with a case, as rules say it."""
    if {"refused", "crashed"} & recorded.keys():
        return "refuses it" if "refused" in recorded else "crashes"
    if not recorded:
        return "loads nothing of it"
    if case in REFUSED:
        return f"simulates another {'model' if is_world(case) else 'robot'}"
    is_whole = case not in CUT and set(recorded.values()) in CUBES
    return "simulates it" if is_whole or case in OTHERWISE else "simulates what is left"


def test_rules_say_what_gazebo_classic_does(recorded: Any) -> None:
    said = {one.code: one.measured.classic for one in all_rules() if one.measured}
    assert said == {code: verdict(case, recorded[case]) for case, code in OF_RULES.items()}


@pytest.mark.parametrize("case", OF_RULES)
def test_a_rule_with_a_measurement_reports_the_case(case: str, tmp_path: Path) -> None:
    _, found = prepared(case, tmp_path, None)
    assert OF_RULES[case] in {one.code for one in found}


@pytest.mark.oracle
@pytest.mark.skipif(IGN is None, reason="`ign sdf` is not installed")
@pytest.mark.parametrize("case", OF_RULES)
def test_rules_say_what_the_parser_of_gazebo_sim_does(case: str, tmp_path: Path) -> None:
    rule = find_rule(OF_RULES[case])
    assert rule is not None
    assert rule.measured is not None
    try:
        code, _ = run_ign("-k", write(case, tmp_path), tmp_path)
    except ChildProcessError:  # by a signal
        code = -1
    does = "crashes" if code < 0 else "refuses it" if code else "accepts it"
    assert does == rule.measured.sim
