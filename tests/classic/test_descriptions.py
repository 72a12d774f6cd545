"""What Gazebo Classic makes of small URDFs with one mistake each, and what wsgen says of them.

`descriptions.json` was recorded with Debian 11's Gazebo 11.1 (sdformat 9): each robot was spawned
1 m above the ground, and simulated for 1 s. `--regenerate` records it anew where that is unpacked.
"""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from classic.gazebo_classic import HOST, NEEDS_CLASSIC, EndedError, GazeboClassic, recorded_in
from classic.test_rest_poses import WORLD, engine_of
from gazebo_oracle import IGN, run_ign
from mesh_samples import binary_stl
from urdf_texts import robot
from wsgen.checks.rules.catalogue import all_rules, find_rule
from wsgen.diagnostics import has_errors
from wsgen.isolation import parent
from wsgen.model.transform import Pose
from wsgen.pipeline.prepare import PrepareContext, prepare_robot
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Mapping

RECORDED = Path(__file__).with_name("descriptions.json")
# Asked live in each run of the tests.
LIVE = ("sound", "no limit", "two sensors", "a word for a friction")
INERTIA = "<inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/>"
LIMIT = "<limit lower='-1' upper='1' effort='1' velocity='1'/>"
AXIS = "<axis xyz='0 0 1'/>"
SENSOR = (
    "<gazebo reference='{}'><sensor name='s' type='imu'><update_rate>10</update_rate></sensor>"
    "</gazebo>"
)


def link(name: str, shape: str = "<box size='0.1 0.1 0.1'/>", mass: str | None = "1") -> str:
    inertial = f"<inertial><mass value='{mass}'/>{INERTIA}</inertial>" if mass else ""
    collision = f"<collision><geometry>{shape}</geometry></collision>" if shape else ""
    return f"<link name='{name}'>{inertial}{collision}</link>"


def joint(name: str, parent_link: str, child: str, kind: str = "revolute") -> str:
    return (
        f"<joint name='{name}' type='{kind}'><parent link='{parent_link}'/><child link='{child}'/>"
        f"{AXIS}{LIMIT}</joint>"
    )


TWO = link("a") + link("b") + joint("j", "a", "b")
CASES: Mapping[str, str] = {
    "sound": TWO,
    # Shapes.
    "flat box": link("a", "<box size='0 0.1 0.1'/>"),
    "negative box": link("a", "<box size='-0.1 0.1 -0.1'/>"),
    "sphere of size 0": link("a", "<sphere radius='0'/>"),
    "negative cylinder": link("a", "<cylinder radius='-0.1' length='0.1'/>"),
    "negative length": link("a", "<cylinder radius='0.1' length='-0.1'/>"),
    "mirrored mesh": link("a", "<mesh filename='MESH' scale='0.1 -0.1 0.1'/>"),
    "absent mesh": link("a", "<mesh filename='file:///absent.stl'/>"),
    "unnamed mesh": link("a", "<mesh/>"),
    "four scales": link("a", "<mesh filename='MESH' scale='1 1 1 1'/>"),
    "capsule": link("a", "<capsule radius='0.1' length='0.2'/>"),
    "capsule before a box": link("a").replace(
        "<collision>", "<collision><geometry><capsule/></geometry></collision><collision>"
    ),
    "no shape to see": link("a").replace("</link>", "<visual/></link>"),
    "origin of two numbers": link("a").replace("<collision>", "<collision><origin xyz='0 0'/>"),
    # Masses and inertias.
    "negative mass": link("a", mass="-1"),
    "a word for a mass": link("a", mass="one"),
    "inertia of 0": link("a").replace("0.01", "0"),
    "negative inertia": link("a").replace("0.01", "-0.01", 1),
    "impossible inertia": link("a").replace("ixx='0.01'", "ixx='1'"),
    "no moments": TWO.replace(INERTIA, "", 1),
    "a word for a moment": TWO.replace("ixx='0.01'", "ixx='one'", 1),
    "massless child": link("a") + link("b", "", None) + joint("j", "a", "b"),
    "half a milligram": link("a") + link("b", "", "5e-7") + joint("j", "a", "b"),
    "two milligrams": link("a") + link("b", "", "2e-6") + joint("j", "a", "b"),
    "massless frame that is kept": link("a")
    + link("b", "", None)
    + joint("j", "a", "b", "fixed")
    + "<gazebo reference='j'><preserveFixedJoint>true</preserveFixedJoint></gazebo>",
    "on a lumped massless link": link("a")
    + link("b", "", None)
    + link("c")
    + joint("j", "a", "b", "fixed")
    + joint("k", "b", "c"),
    "massless root": link("a", "", None) + link("b") + joint("j", "a", "b"),
    "massless root, fixed": link("a", "", None) + link("b") + joint("j", "a", "b", "fixed"),
    "masses of 0, fixed": link("a")
    + link("b", "", "0")
    + link("c", "", "0")
    + joint("j", "a", "b", "fixed")
    + joint("k", "b", "c", "fixed"),
    # Names and joints.
    "two links of a name": link("a") + link("a"),
    "two joints of a name": TWO + link("c") + joint("j", "a", "c"),
    "a joint named as a link": TWO.replace("name='j'", "name='b'"),
    "two roots": link("a") + link("b"),
    "no limit": TWO.replace(LIMIT, ""),
    "swapped limits": TWO.replace("lower='-1' upper='1'", "lower='1' upper='-1'"),
    "unknown type": TWO.replace("revolute", "hinge"),
    "planar": TWO.replace("revolute", "planar"),
    "mimics nothing": TWO.replace("</joint>", "<mimic joint='x'/></joint>"),
    # Extensions.
    "two sensors": link("a") + 2 * SENSOR.format("a"),
    "two sensors that are lumped": TWO.replace("revolute", "fixed")
    + SENSOR.format("a")
    + SENSOR.format("b"),
    "a word for a friction": link("a") + "<gazebo reference='a'><mu1>high</mu1></gazebo>",
    "unknown reference": link("a") + "<gazebo reference='z'><mu1>1</mu1></gazebo>",
    "absent plugin": link("a") + "<gazebo><plugin name='p' filename='libabsent.so'/></gazebo>",
    "no link": "",
}
# The rules that say what simulators do, by the case of which it was measured.
OF_RULES = {
    "a word for a mass": "ROB016",
    "negative mass": "ROB022",
    "impossible inertia": "ROB037",
    "capsule": "ROB024",
    "massless child": "ROB040",
    "massless root, fixed": "ROB051",
    "masses of 0, fixed": "ROB041",
    "two links of a name": "ROB007",
    "two joints of a name": "ROB008",
    "a joint named as a link": "ROB034",
    "two roots": "ROB009",
    "no limit": "ROB020",
    "swapped limits": "ROB023",
    "unknown type": "ROB015",
    "planar": "ROB055",
    "mimics nothing": "ROB035",
    "two sensors": "ROB108",
    "a word for a friction": "ROB031",
    "unknown reference": "ROB030",
    "mirrored mesh": "ROB151",
    "no link": "ROB005",
}
# What is left of the robot rests there, and here; the other links are reported.
CUT = {
    "massless child": "ROB040",
    "half a milligram": "ROB040",
    "massless frame that is kept": "ROB040",
    "on a lumped massless link": "ROB080",
}
# Gazebo Classic has the robot, without contacts or with links that come apart; wsgen has none.
REFUSED = {
    "negative mass": "ROB022: the link floats",
    "masses of 0, fixed": "ROB041: the pose of the link is no number, and the origin is shown",
}
CUBES = ({0.05}, {0.15})  # m; the cube of 0.1 m, and that of the mesh


def write(case: str, folder: Path, host: str = "") -> Path:
    (folder / "m.stl").write_bytes(binary_stl())
    file = folder / "r.urdf"
    file.write_text(robot(CASES[case]).replace("MESH", f"file://{host}{folder}/m.stl"))
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
        with GazeboClassic(world) as gazebo:
            gazebo.spawn(file, "r", z=1.0)
            gazebo.run(1.0)
            links = gazebo.state()["r"]["links"]
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


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_wsgen_simulates_what_gazebo_classic_simulates(
    case: str, recorded: Any, tmp_path: Path
) -> None:
    context = PrepareContext(share_of=lambda _: None, folder=tmp_path, run=parent.run)
    file = write(case, tmp_path)
    prepared, found = prepare_robot(
        file.read_text(), file=file, context=context, simulator="classic"
    )
    heights = recorded[case]
    is_simulated = bool(heights) and not {"refused", "crashed"} & heights.keys()
    if not is_simulated or case in REFUSED:
        assert prepared is None or not prepared.can_run
        assert has_errors(found)
        return
    assert prepared is not None
    assert prepared.can_run
    assert case not in CUT or CUT[case] in {one.code for one in found}
    pose = Pose((0.0, 0.0, 1.0))
    spawned = SpawnedRobot(entity="r", robot=prepared.lumped, pose_in_world=pose)
    with closing(engine_of("bullet")(WORLD)) as engine:
        engine.spawn(spawned)
        engine.advance(round(1.0 / engine.step_seconds))
        poses = engine.link_poses("r")
    assert {name: pose.xyz[2] for name, pose in poses.items()} == {
        name: pytest.approx(height, abs=0.02) for name, height in heights.items()
    }


def verdict(case: str, recorded: Mapping[str, Any]) -> str:
    """What Gazebo Classic does with a case, as rules say it."""
    if {"refused", "crashed"} & recorded.keys():
        return "refuses it" if "refused" in recorded else "crashes"
    if not recorded:
        return "loads nothing of it"
    if set(recorded.values()) not in CUBES:
        return "simulates another robot"
    return "simulates what is left" if case in CUT else "simulates it"


def test_rules_say_what_gazebo_classic_does(recorded: Any) -> None:
    said = {one.code: one.measured.classic for one in all_rules() if one.measured}
    assert said == {code: verdict(case, recorded[case]) for case, code in OF_RULES.items()}


@pytest.mark.parametrize("case", OF_RULES)
def test_a_rule_with_a_measurement_reports_the_case(case: str, tmp_path: Path) -> None:
    context = PrepareContext(share_of=lambda _: None, folder=tmp_path, run=parent.run)
    file = write(case, tmp_path)
    _, found = prepare_robot(file.read_text(), file=file, context=context)
    assert OF_RULES[case] in {one.code for one in found}


@pytest.mark.oracle
@pytest.mark.skipif(IGN is None, reason="`ign sdf` is not installed")
@pytest.mark.parametrize("case", OF_RULES)
def test_rules_say_what_the_parser_of_gazebo_sim_does(case: str, tmp_path: Path) -> None:
    rule = find_rule(OF_RULES[case])
    assert rule is not None
    assert rule.measured is not None
    code, _ = run_ign("-k", write(case, tmp_path), tmp_path)
    does = "crashes" if code < 0 else "refuses it" if code else "accepts it"
    assert does == rule.measured.sim
