"""What sensors of Gazebo Classic measure, and what wsgen's measure in live runs in their place.

`recorded/sensors.json` was recorded with Debian 11's Gazebo 11.1: the world of `world()` is
simulated for 2 s, then each sensor measures. `--regenerate` records it anew where that is
unpacked.
"""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from classic.gazebo_classic import NEEDS_CLASSIC, GazeboClassic, why_missing
from live.nodes.sensor_messages import install_sensor_messages
from live.nodes.test_sensors import mounted, run
from wsgen.live.nodes.simulator.sensors.motion import InertialUnit
from wsgen.model.robot import (
    Box,
    Collision,
    Cylinder,
    Inertial,
    Joint,
    JointType,
    Link,
    Robot,
    Sphere,
)
from wsgen.model.transform import IDENTITY, Pose, rotation_of_rpy, rpy_of_rotation
from wsgen.simulation.scene import SpawnedRobot

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.robot import Primitive

RECORDED = Path(__file__).parent / "recorded" / "sensors.json"
GRAVITY = 9.8
FIELD = (1e-5, 2e-5, -4e-5)  # T
SHAPES: Mapping[str, tuple[Primitive, Pose]] = {
    "box": (Box(size=(1.0, 1.0, 2.0)), Pose((3.0, 0.0, 1.0), (0.0, 0.0, 0.3))),
    "cylinder": (Cylinder(radius=0.5, length=2.0), Pose((3.0, 10.0, 1.0), (0.2, 0.0, 0.0))),
    "sphere": (Sphere(radius=0.5), Pose((3.0, 20.0, 1.0))),
}
TO_BOX, TO_CYLINDER, TO_SPHERE = (Pose((0.0, y, 1.0)) for y in (0.0, 10.0, 20.0))


def ray(
    samples: int = 1,
    least: float = 0.0,
    most: float = 0.0,
    *,
    near: float = 0.1,
    far: float = 10.0,
    resolution: float = 1.0,
    up: tuple[int, float, float, float] = (1, 1.0, 0.0, 0.0),
) -> str:
    """A <ray>; `up` has samples, resolution and angles of its rows."""

    def scan(samples: int, resolution: float, least: float, most: float) -> str:
        return (
            f"<samples>{samples}</samples><resolution>{resolution}</resolution>"
            f"<min_angle>{least}</min_angle><max_angle>{most}</max_angle>"
        )

    return (
        f"<ray><scan><horizontal>{scan(samples, resolution, least, most)}</horizontal>"
        f"<vertical>{scan(*up)}</vertical></scan>"
        f"<range><min>{near}</min><max>{far}</max></range></ray>"
    )


FIVE = ray(5, -0.1, 0.1)
RAYS: Mapping[str, tuple[Pose, str]] = {
    "box": (TO_BOX, FIVE),
    "cylinder": (TO_CYLINDER, FIVE),
    "sphere": (TO_SPHERE, FIVE),
    "ground": (Pose((0.0, 40.0, 1.0), (0.0, 0.5, 0.0)), ray()),
    "ground_from_below": (Pose((0.0, 50.0, -1.0), (0.0, -0.5, 0.0)), ray()),
    "nothing": (Pose((0.0, 50.0, 1.0)), ray()),
    # Begin in a shape.
    "in_box": (Pose((3.0, 0.0, 1.0), (0.0, 0.0, 0.3)), FIVE),
    "in_cylinder": (Pose((3.0, 10.0, 1.0), (0.2, 0.0, 0.0)), FIVE),
    "in_cylinder_up": (Pose((3.0, 10.0, 1.0), (0.2, -1.4, 0.0)), FIVE),
    "in_sphere": (Pose((3.0, 20.0, 1.0)), FIVE),
    "before_sphere": (Pose((2.45, 20.0, 1.0)), ray()),
    "through_sphere": (Pose((2.45, 20.0, 1.0)), ray(near=1.1)),
    # One ray looks straight ahead.
    "single": (TO_BOX, ray(1, -0.5, 0.5)),
    "single_row": (TO_SPHERE, ray(3, -0.1, 0.1, up=(1, 1.0, 0.1, 0.2))),
    # The borders of what is measured.
    "at_most": (TO_SPHERE, ray(far=2.5)),
    "above_most": (TO_SPHERE, ray(far=2.499)),
    "below_most": (TO_SPHERE, ray(far=2.501)),
    "at_least": (TO_SPHERE, ray(near=2.5)),
    "above_least": (TO_SPHERE, ray(near=2.495)),
    "below_least": (TO_SPHERE, ray(near=2.501)),
    "from_0": (TO_SPHERE, ray(near=0.0)),
    # Ranges between rays.
    "twice": (TO_BOX, ray(3, -0.1, 0.1, resolution=2.0)),
    "twice_beside": (TO_BOX, ray(5, -0.4, 0.4, resolution=2.0)),
    "half": (TO_BOX, ray(5, -0.1, 0.1, resolution=0.5)),
    "third": (TO_BOX, ray(4, -0.1, 0.1, resolution=0.3)),
    "rows": (TO_SPHERE, ray(3, -0.1, 0.1, up=(2, 2.0, -0.15, 0.1))),
}
BODY = Box(size=(0.4, 0.4, 0.2))
MASS = 2.0  # kg
CENTER = (0.2, -0.05, 0.0)  # m, of what hangs, in its link
ROLLED = Pose((0.0, 0.0, 0.0), (math.pi / 2, 0.0, 0.0))
MOUNT = Pose((0.1, 0.0, 0.0), (0.0, 0.0, 0.5))  # of the force-torque sensor in its joint
HANGING = {"parent": 0.3, "child": 0.4}  # rad: pitch of the parent, roll of the child
SIDES = ("child_to_parent", "parent_to_child")
WRENCHES = [(frame, side) for frame in ("child", "parent", "sensor") for side in SIDES]


SLOPE = Box(size=(4.0, 4.0, 0.2))
TILTED = Pose((-10.0, 0.0, 2.0), (0.0, 0.3, 0.0))
LEANING = Pose((-10.0 + 0.2 * math.sin(0.3), 0.0, 2.0 + 0.2 * math.cos(0.3)), TILTED.rpy)
RESTING = Pose((-5.0, 0.0, 0.1), (0.0, 0.0, 0.7))


def force_torque(frame: str, side: str) -> str:
    return (
        f'<sensor name="{frame}_{side}" type="force_torque"><pose>{numbers(MOUNT)}</pose>'
        f"<force_torque><frame>{frame}</frame><measure_direction>{side}</measure_direction>"
        "</force_torque></sensor>"
    )


def numbers(pose: Pose) -> str:
    return " ".join(map(str, (*pose.xyz, *pose.rpy)))


def geometry(shape: Primitive) -> str:
    if isinstance(shape, Box):
        return f"<box><size>{' '.join(map(str, shape.size))}</size></box>"
    if isinstance(shape, Sphere):
        return f"<sphere><radius>{shape.radius}</radius></sphere>"
    assert isinstance(shape, Cylinder)
    return f"<cylinder><radius>{shape.radius}</radius><length>{shape.length}</length></cylinder>"


def link(content: str, pose: Pose = IDENTITY, *, name: str = "l", center: str = "0 0 0") -> str:
    return (
        f"<link name='{name}'><pose>{numbers(pose)}</pose><inertial><pose>{center} 0 0 0</pose>"
        f"<mass>{MASS}</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia>"
        f"</inertial>{content}</link>"
    )


def solid(shape: Primitive) -> str:
    return f"<collision name='c'><geometry>{geometry(shape)}</geometry></collision>"


def model(name: str, pose: Pose, content: str, *, is_static: bool = False) -> str:
    static = "<static>true</static>" if is_static else ""
    return f"<model name='{name}'>{static}<pose>{numbers(pose)}</pose>{content}</model>"


def sensor(name: str, kind: str, content: str = "", pose: Pose = IDENTITY) -> str:
    return (
        f"<sensor name='{name}' type='{kind}'><pose>{numbers(pose)}</pose>"
        f"<update_rate>0</update_rate>{content}</sensor>"
    )


def world() -> str:
    parts = [
        model(name, pose, f"<link name='l'>{solid(shape)}</link>", is_static=True)
        for name, (shape, pose) in SHAPES.items()
    ]
    parts += [
        model(
            f"ray_{name}",
            pose,
            f"<link name='l'>{sensor('s', 'ray', text)}</link>",
            is_static=True,
        )
        for name, (pose, text) in RAYS.items()
    ]
    bumper = sensor("b", "contact", "<contact><collision>c</collision></contact>")
    imus = sensor("i", "imu") + sensor("r", "imu", pose=ROLLED)
    magnet = sensor("m", "magnetometer", "<magnetometer/>", ROLLED)
    housed = sensor("s", "ray", ray())
    resting = link(solid(BODY) + bumper + imus + magnet + housed)
    parts.append(model("resting", RESTING, resting))
    parts.append(model("slope", TILTED, f"<link name='l'>{solid(SLOPE)}</link>", is_static=True))
    parts.append(model("leaning", LEANING, link(solid(BODY) + bumper)))
    parts.append(model("falling", Pose((-15.0, 0.0, 50.0), (0.5, 0.0, 0.0)), link(imus)))
    fixed = "<joint name='f' type='fixed'><parent>world</parent><child>base</child></joint>"
    swing = (
        "<joint name='j' type='revolute'><parent>base</parent><child>l</child>"
        "<axis><xyz>0 1 0</xyz></axis></joint>"
    )
    base = link("", name="base")
    swinging = link(imus, Pose(rpy=(0.3, 0.2, 0.1)), center="0.5 0 0")
    parts.append(model("swinging", Pose((-20.0, 0.0, 5.0)), base + swinging + fixed + swing))
    stiff = (
        "<joint name='j' type='revolute'><parent>base</parent><child>l</child><axis><xyz>0 0 1"
        "</xyz><limit><lower>0</lower><upper>0</upper></limit></axis>"
        + "".join(force_torque(*one) for one in WRENCHES)
        + "</joint>"
    )
    base = link("", Pose(rpy=(0.0, HANGING["parent"], 0.0)), name="base")
    hanging = link("", Pose(rpy=(HANGING["child"], 0.0, 0.0)), center=" ".join(map(str, CENTER)))
    parts.append(model("hanging", Pose((-25.0, 0.0, 5.0)), base + hanging + fixed + stiff))
    return (
        f"<sdf version='1.6'><world name='w'><gravity>0 0 -{GRAVITY}</gravity><magnetic_field>"
        f"{' '.join(map(str, FIELD))}</magnetic_field><include><uri>model://ground_plane</uri>"
        f"</include>{''.join(parts)}</world></sdf>"
    )


def values(text: str, name: str) -> list[float | str]:
    """Those of a field of a message; JSON has no infinity."""
    found = re.findall(rf"\b{name}: (\S+)", text)
    return [one if one in ("inf", "-inf", "nan") else rounded(float(one)) for one in found]


def vectors(text: str, *names: str) -> list[list[float]]:
    """The x, y, z (and w) of all fields of a name, in each field of the names before it."""
    for name in names:
        text = "\n".join(re.findall(rf"\b{name} {{([^{{}}]*(?:{{[^{{}}]*}}[^{{}}]*)*)}}", text))
        text = text.replace("\n\n", "\n")
    found = [[float(one) for one in re.findall(rf"\b{axis}: (\S+)", text)] for axis in "xyzw"]
    return [[rounded(one) for one in each] for each in zip(*filter(None, found), strict=True)]


def total(step: str) -> Any:
    """The force of all points of a contact."""
    return np.sum(vectors(step, "body_1_wrench", "force"), axis=0)


def rounded(number: float) -> float:
    return round(number, 5) + 0.0


def ask(folder: Path) -> dict[str, Any]:
    """What the real sensors measure."""
    file = folder / "sensors.world"
    file.write_text(world())
    topics = {f"ray_{name}/l/s/scan": "LaserScanStamped" for name in RAYS}
    topics["resting/l/s/scan"] = "LaserScanStamped"
    imus = [f"{name}/l/{one}/imu" for name in ("resting", "falling", "swinging") for one in "ir"]
    topics.update(dict.fromkeys(imus, "IMU"))
    topics.update(dict.fromkeys(("resting/l/b", "leaning/l/b"), "Contacts"))
    topics["resting/l/m"] = "Magnetometer"
    topics.update({f"hanging/j/{'_'.join(one)}/wrench": "WrenchStamped" for one in WRENCHES})
    with GazeboClassic(file) as gazebo:
        for topic, kind in topics.items():
            gazebo.ask("listen", f"~/{topic}", f"gazebo.msgs.{kind}")
        gazebo.run(1.9)
        gazebo.ask("sensors")
        before = gazebo.state()
        gazebo.run(0.1)
        gazebo.ask("sensors")
        state = gazebo.state()
        heard = {topic: gazebo.ask("heard", f"~/{topic}")["text"] for topic in topics}
    found: dict[str, Any] = {
        f"ray {name}": {
            "ranges": values(heard[f"ray_{name}/l/s/scan"], "ranges"),
            "angle_step": values(heard[f"ray_{name}/l/s/scan"], "angle_step")[:1],
        }
        for name in RAYS
    }
    found["ray of a box in itself"] = {"ranges": values(heard["resting/l/s/scan"], "ranges")}
    for name in ("resting", "falling", "swinging"):
        one = f"{name}::l"
        found[f"state {name}"] = [
            {
                key: [round(number, 8) + 0.0 for number in each[name]["links"][one][key]]
                for key in ("pose", "linear", "angular")
            }
            for each in (before, state)
        ]
    for topic in imus:
        found[f"imu {topic[:-4].replace('/l/', ' ')}"] = {
            key: vectors(heard[topic], key)[0]
            for key in ("orientation", "angular_velocity", "linear_acceleration")
        }
    for name in ("resting", "leaning"):
        steps = re.findall(r"(?ms)^contact {$.*?^}$", heard[f"{name}/l/b"])
        last = steps[-1]
        found[f"contact {name}"] = {
            "names": re.findall(r'collision\d: "(.*)"', last),
            "states": len(steps),
            "normal": vectors(last, "normal")[0],
            # What slides jumps from one corner to another.
            "mean_force": np.mean([total(one) for one in steps], axis=0).round(1).tolist(),
        }
        if name == "resting":
            found[f"contact {name}"]["positions"] = sorted(vectors(last, "position"))
    tesla = [float(one) for one in re.findall(r"\b[xyz]: (\S+)", heard["resting/l/m"])]
    found["magnetometer"] = [round(1e6 * one, 3) for one in tesla]  # uT
    for frame, side in WRENCHES:
        text = heard[f"hanging/j/{frame}_{side}/wrench"]
        found[f"wrench {frame} {side}"] = [
            vectors(text, "force")[0],
            vectors(text, "torque")[0],
        ]
    return found


def record(folder: Path) -> str:
    lines = (f"{json.dumps(name)}: {json.dumps(one)}" for name, one in ask(folder).items())
    return "{\n" + ",\n".join(lines) + "\n}\n"


@pytest.fixture(scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    if request.config.getoption("--regenerate") and not why_missing():
        RECORDED.parent.mkdir(exist_ok=True)
        RECORDED.write_text(record(tmp_path_factory.mktemp("sensors")))
    return json.loads(RECORDED.read_text())


@pytest.fixture(autouse=True)
def _messages(monkeypatch: pytest.MonkeyPatch) -> None:
    install_sensor_messages(monkeypatch)


@pytest.mark.oracle
@pytest.mark.slow
@NEEDS_CLASSIC
def test_the_record_is_what_gazebo_classic_measures(recorded: Any, tmp_path: Path) -> None:
    found = json.loads(record(tmp_path))
    expected = dict(recorded)
    sliding = [one.pop("contact leaning") for one in (found, expected)]
    assert found == expected
    assert sliding[0].pop("mean_force") == pytest.approx(sliding[1]["mean_force"], abs=0.5)
    assert sliding[0].items() <= sliding[1].items()


INERTIAL = Inertial(mass=MASS, inertia=(0.1, 0.0, 0.0, 0.1, 0.0, 0.1))
PLUGIN = (
    '<plugin name="p" filename="libgazebo_ros_{}.so">{}<ros><remapping>{}:=/{}</remapping></ros>'
    "</plugin>"
)
SCAN = "<output_type>sensor_msgs/LaserScan</output_type>"


def static(name: str, shape: Primitive, pose: Pose) -> SpawnedRobot:
    one = Link(name="l", collisions=(Collision(name="c", geometry=shape),))
    robot = replace(Robot(name=name, root="l", links=(one,)), is_static=True)
    return SpawnedRobot(entity=name, robot=robot, pose_in_world=pose, is_static_model=True)


def body(shape: Primitive | None = BODY) -> Robot:
    collisions = (Collision(geometry=shape),) if shape is not None else ()
    base = Link(name="base", inertial=INERTIAL, collisions=collisions)
    return Robot(name="rover", root="base", links=(base,))


AROUND = tuple(static(name, shape, pose) for name, (shape, pose) in SHAPES.items())


@pytest.mark.slow
def test_rays(recorded: Any) -> None:
    """Where rays begin and end, which of them there are, and what is between them."""
    sensors = [
        mounted(sensor(name, "ray", text + PLUGIN.format("ray_sensor", SCAN, "~/out", name)), pose)
        for name, (pose, text) in RAYS.items()
    ]
    robot = replace(body(None), is_static=True)
    ros = run(*sensors, robot=robot, pose=IDENTITY, others=AROUND, seconds=0.01)
    differing = {}
    for name in RAYS:
        scan, expected = ros.published(f"/{name}")[-1], recorded[f"ray {name}"]
        ranges, step = map(floats, (expected["ranges"], expected["angle_step"]))
        rows = len(ranges) // len(scan.ranges)
        ranges = ranges[rows // 2 * len(scan.ranges) :][: len(scan.ranges)]
        is_equal = list(scan.ranges) == pytest.approx(ranges, abs=1e-3, nan_ok=True)
        if not is_equal or [scan.angle_increment] != pytest.approx(step, abs=1e-5, nan_ok=True):
            differing[name] = list(scan.ranges), scan.angle_increment
    assert differing == {}


def floats(values: list[Any]) -> list[float]:
    return [float(one) for one in values]


@pytest.mark.slow
def test_a_ray_that_begins_in_its_own_link(recorded: Any) -> None:
    text = sensor("s", "ray", ray() + PLUGIN.format("ray_sensor", SCAN, "~/out", "s"))
    ros = run(mounted(text, IDENTITY), robot=body(), seconds=0.01)
    assert list(ros.published("/s")[-1].ranges) == pytest.approx(
        recorded["ray of a box in itself"]["ranges"], abs=1e-3
    )


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["gpu_ray", "ray"])
def test_rays_of_others_do_not_see_what_they_begin_in(kind: str) -> None:
    """They see visuals from outside: those of GPUs, and those of Gazebo Sim."""
    on_gpu = kind == "gpu_ray"
    plugin = PLUGIN.format("ray_sensor", SCAN, "~/out", "s") if on_gpu else "<topic>s</topic>"
    text = sensor("s", kind, ray() + plugin)
    simulator = "classic" if on_gpu else "gz"
    ros = run(mounted(text, IDENTITY), robot=body(), seconds=0.01, simulator=simulator)
    assert list(ros.published("/s")[-1].ranges) == pytest.approx([2.0], abs=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "pose", "others"),
    [("resting", RESTING, AROUND), ("leaning", LEANING, (static("slope", SLOPE, TILTED),))],
)
def test_contacts(name: str, pose: Pose, others: tuple[SpawnedRobot, ...], recorded: Any) -> None:
    """They are seen from the world, forces from the link; only friction is not in them."""
    content = "<contact><collision>base_collision</collision></contact>"
    plugin = PLUGIN.format("bumper", "", "bumper_states", "b")
    bumper = mounted(sensor("b", "contact", content + plugin), IDENTITY)
    ros = run(bumper, robot=body(), pose=pose, others=others, seconds=2.0)
    (state,) = ros.published("/b")[-1].states
    expected = recorded[f"contact {name}"]
    assert state.collision2_name == expected["names"][1]
    assert triple(state.total_wrench.force)[2] == pytest.approx(expected["mean_force"][2], rel=0.02)
    assert triple(state.contact_normals[0]) == pytest.approx(expected["normal"], abs=1e-3)
    corners = [triple(point) for point in state.contact_positions]
    for point in expected.get("positions", ()):
        assert min(math.dist(point, corner) for corner in corners) < 2e-3
    for wrench, corner in zip(state.wrenches, corners, strict=True):
        lever = np.array(corner) - pose.xyz @ np.eye(3)
        force = rotation_of_rpy(pose.rpy) @ np.array(triple(wrench.force))
        torque = rotation_of_rpy(pose.rpy) @ np.array(triple(wrench.torque))
        assert torque == pytest.approx(np.cross(lever, force), abs=0.02)


def triple(vector: Any) -> tuple[float, float, float]:
    return vector.x, vector.y, vector.z


@pytest.mark.parametrize("name", ["resting", "falling", "swinging"])
@pytest.mark.parametrize("mount", ["i", "r"])
def test_an_imu(name: str, mount: str, recorded: Any) -> None:
    """What it makes of how it moves, since it measured before."""
    first = {"resting": RESTING.rpy, "falling": (0.5, 0.0, 0.0), "swinging": (0.3, 0.2, 0.1)}
    turn = np.array(rotation_of_rpy((ROLLED if mount == "r" else IDENTITY).rpy))
    unit = InertialUnit(
        None,
        np.random.default_rng(0),
        gravity=(0.0, 0.0, -GRAVITY),
        reference=np.array(rotation_of_rpy(first[name])) @ turn,
    )
    for now, state in zip((1.9, 2.0), recorded[f"state {name}"], strict=True):
        *xyz, w, x, y, z = state["pose"]
        turned = np.array(rotation_of_quaternion(x, y, z, w)) @ turn
        pose = Pose((xyz[0], xyz[1], xyz[2]), rpy_of_rotation(turned))
        velocities = np.array(state["linear"]), np.array(state["angular"])
        measured = unit.measure(pose, *velocities, now)
    expected = recorded[f"imu {name} {mount}"]
    x, y, z, w = expected["orientation"]
    assert measured.orientation == pytest.approx(rotation_of_quaternion(x, y, z, w), abs=1e-4)
    assert measured.turning == pytest.approx(expected["angular_velocity"], abs=1e-4)
    assert measured.acceleration == pytest.approx(expected["linear_acceleration"], abs=1e-3)


def rotation_of_quaternion(x: float, y: float, z: float, w: float) -> Any:
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def test_a_magnetometer(recorded: Any) -> None:
    """That of Gazebo Sim; ROS 2 has no plugin for the one of Gazebo Classic."""
    text = sensor("m", "magnetometer", "<topic>m</topic>")
    field = f"<world><magnetic_field>{' '.join(map(str, FIELD))}</magnetic_field></world>"
    ros = run(
        mounted(text, ROLLED),
        robot=replace(body(), is_static=True),
        pose=RESTING,
        simulator="gz",
        surroundings=field,
        seconds=0.01,
    )
    measured = np.array(triple(ros.published("/m")[-1].magnetic_field))
    assert 1e6 * measured == pytest.approx(recorded["magnetometer"], abs=1e-2)


@pytest.mark.parametrize(("frame", "side"), WRENCHES)
def test_a_force_torque_sensor(frame: str, side: str, recorded: Any) -> None:
    """A weight that hangs beside its joint, at rest: about the joint, whatever the <pose>."""
    from wsgen.live.nodes.simulator.sensors.forces import (  # noqa: PLC0415  with fakes
        JointLoad,
    )

    child = Pose(rpy=(HANGING["child"], 0.0, 0.0))
    weight = np.array([0.0, 0.0, MASS * GRAVITY])
    lever = np.array(rotation_of_rpy(child.rpy)) @ CENTER
    joint = Joint(name="j", type=JointType.REVOLUTE, parent="base", child="l")
    one = mounted(force_torque(frame, side), MOUNT, "j")
    handle = SimpleNamespace(
        entity="hanging",
        robot=SimpleNamespace(joints=(joint,)),
        joint_wrench=lambda _: (weight, np.cross(lever, weight)),
        link_poses=lambda: {"l": child, "base": Pose(rpy=(0.0, HANGING["parent"], 0.0))},
    )
    host = SimpleNamespace(simulator="classic", step_seconds=0.001)
    load = JointLoad(host, handle, replace(one, link="l"))  # type: ignore[arg-type]
    for measured, expected in zip(load.measure(), recorded[f"wrench {frame} {side}"], strict=True):
        assert measured == pytest.approx(expected, abs=2e-3)
