"""What Gazebo Classic makes of small URDFs with one mistake each, and what wsgen says of them.

`descriptions.json` was recorded with Debian 11's Gazebo 11.1 (sdformat 9): each robot was spawned
1 m above the ground, and simulated for 1 s. `--regenerate` records it anew where that is unpacked.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from classic.gazebo_classic import HOST, EndedError, GazeboClassic, recorded_in, why_missing
from mesh_samples import binary_stl
from urdf_texts import robot
from wsgen.isolation import parent
from wsgen.pipeline.prepare import PrepareContext, prepare_robot

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
    "negative box": link("a", "<box size='-0.1 0.1 0.1'/>"),
    "sphere of size 0": link("a", "<sphere radius='0'/>"),
    "negative cylinder": link("a", "<cylinder radius='-0.1' length='0.1'/>"),
    "mirrored mesh": link("a", "<mesh filename='MESH' scale='1 -1 1'/>"),
    "capsule": link("a", "<capsule radius='0.1' length='0.2'/>"),
    # Masses and inertias.
    "negative mass": link("a", mass="-1"),
    "a word for a mass": link("a", mass="one"),
    "inertia of 0": link("a").replace("0.01", "0"),
    "negative inertia": link("a").replace("0.01", "-0.01", 1),
    "impossible inertia": link("a").replace("ixx='0.01'", "ixx='1'"),
    "massless child": link("a") + link("b", "", None) + joint("j", "a", "b"),
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
# Why wsgen refuses what Gazebo Classic simulates as it is meant.
STRICTER = {
    "negative box": "ROB028: no engine of wsgen has such shapes; Gazebo Sim ends on them",
    "negative cylinder": "ROB028, as above",
}
# What is left of the robot rests there, too; wsgen refuses it for what is dropped.
CUT = ("massless child",)
# wsgen leaves out the shape with a warning, and the robot falls as it does there.
FALLS = ("flat box",)
RESTING = ({0.05}, {1.5})  # m; the cube of 0.1 m, and that of 3 m of the mesh


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
@pytest.mark.skipif(why_missing() != "", reason=why_missing())
@pytest.mark.parametrize("case", LIVE)
def test_the_record_is_what_gazebo_classic_does(case: str, recorded: Any, tmp_path: Path) -> None:
    assert ask(case, tmp_path) == recorded[case]


@pytest.mark.parametrize("case", CASES)
def test_wsgen_refuses_what_gazebo_classic_does_not_simulate(
    case: str, recorded: Any, tmp_path: Path
) -> None:
    context = PrepareContext(share_of=lambda _: None, folder=tmp_path, run=parent.run)
    file = write(case, tmp_path)
    prepared, found = prepare_robot(
        file.read_text(), file=file, context=context, simulator="classic"
    )
    can_run = prepared is not None and prepared.can_run
    rests = set(recorded[case].values()) in RESTING
    if case in (*STRICTER, *CUT):
        assert (rests, can_run) == (True, False)
    elif case in FALLS:
        assert (rests, can_run, [one.code for one in found]) == (False, True, ["ROB028"])
    else:
        assert can_run == rests
    if can_run and prepared is not None:
        assert {one.name for one in prepared.lumped.links} == recorded[case].keys()
