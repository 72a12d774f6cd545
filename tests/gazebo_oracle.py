"""What Gazebo's own parser (`ign sdf`) makes of a URDF, and where ours differs from it."""

from __future__ import annotations

import atexit
import functools
import json
import math
import re
import shutil
import signal
import subprocess
import sys
from typing import TYPE_CHECKING, TypeVar
from xml.etree import ElementTree as ET

from wsgen.model.inertia import about_link_axes
from wsgen.model.robot import Inertial, JointType
from wsgen.model.transform import Pose, rotation_of_rpy

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from wsgen.model.robot import Collision, Joint, Link, Robot


Default = TypeVar("Default", float, None)

IGN = shutil.which("ign")
SECONDS = 600.0
OUTPUT_SIZE = 2**25  # bytes; on a circle of links it prints without end
# Where pitch is 90 degrees, sdformat cannot tell roll from yaw; it takes pitches nearby for 90.
NEAR_GIMBAL_LOCK = 1.5e-3  # rad; the sine differs from 1 by a millionth
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
NO_LIMIT = 1e16  # what sdformat writes for an angle without bounds


# What `ign sdf` calls once it has started Ruby and read its settings, which takes most of its time.
LIBRARY = f"""
import ctypes, json, os, resource, signal, sys
library = ctypes.CDLL("libsdformat12.so.12")

def call(option, file):
    resource.setrlimit(resource.RLIMIT_FSIZE, ({OUTPUT_SIZE}, {OUTPUT_SIZE}))
    function = {{"-k": library.cmdCheck, "-p": library.cmdPrint}}[option]
    return function(file.encode()) & 255
"""
CALL = LIBRARY + "sys.exit(call(*sys.argv[1:]))"
# Loading the library takes half of the time of a call: one process does it for many calls, each in
# a child of it. The end of the C library writes what is left to write.
CALLS = f"""{LIBRARY}
for line in sys.stdin:
    option, file, answer, home, seconds = json.loads(line)
    pid = os.fork()
    if pid == 0:
        signal.alarm(seconds)
        os.environ["HOME"] = home
        os.dup2(os.open(answer, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), 1)
        ctypes.CDLL(None).exit(call(option, file))
    print(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]), flush=True)
"""


def ign_sdf(option: str, file: Path) -> list[str]:
    """A command that does what `ign sdf` does with an option and a file."""
    return [sys.executable, "-I", "-S", "-c", CALL, option, str(file.absolute())]


def run_ign(option: str, file: Path, folder: Path) -> tuple[int, str]:
    """Exit code and standard output of `ign sdf`; `folder` is for its log.

    Raises:
        ChildProcessError: it did not end by itself, which says nothing about the file. A number
            that sdformat cannot read is an exception that it does not catch: SIGABRT is an answer.
    """
    answer = folder / f"answer{option}"
    request = *map(str, (file.absolute(), answer, folder)), int(SECONDS)
    calls = _calls()
    assert calls.stdin is not None
    assert calls.stdout is not None
    try:
        calls.stdin.write(json.dumps((option, *request)) + "\n")
        calls.stdin.flush()
        line = calls.stdout.readline()
    except BrokenPipeError:
        line = ""
    if not line:
        _calls.cache_clear()  # the next call has a new one
        raise ChildProcessError(f"the process that calls sdformat ended before {file}")
    if (code := int(line)) < 0 and code != -signal.SIGABRT:
        raise ChildProcessError(f"sdformat was ended by {signal.Signals(-code).name}: {file}")
    return code, answer.read_text(encoding="utf-8", errors="replace")


@functools.cache
def _calls() -> subprocess.Popen[str]:
    """The process that has loaded the library; it ends with this one, which closes its input."""
    calls = subprocess.Popen(
        [sys.executable, "-I", "-S", "-c", CALLS],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    atexit.register(_end, calls)
    return calls


def _end(calls: subprocess.Popen[str]) -> None:
    calls.communicate()


def is_taken(file: Path, folder: Path) -> bool:
    """Whether Gazebo's parser finds nothing wrong in it."""
    return run_ign("-k", file, folder)[0] == 0


def model_of(file: Path, folder: Path) -> ET.Element | None:
    """The SDF model that Gazebo makes of it; None where there is none."""
    _, text = run_ign("-p", file, folder)
    start = text.find("<sdf")
    # It writes names such as <sensor:contact> and <ignition::corrected_offsets>, which are no XML.
    plain = re.sub(r"(</?\w+):+", r"\1-", text[max(start, 0) :])
    return None if start < 0 else ET.fromstring(plain).find("model")


def differences(robot: Robot, model: ET.Element) -> Iterator[str]:
    """In what the lumped robot differs from the model, as "what: where"."""
    links = {
        link.name: link
        for link in robot.links
        if not (robot.fixed_to_world and link.name == "world")
    }
    theirs = {link.get("name") or "": link for link in model.findall("link")}
    yield from (f"link: {name}" for name in links.keys() ^ theirs.keys())
    for name in links.keys() & theirs.keys():
        yield from (f"{what}: {name}" for what in _of_link(links[name], theirs[name], model))
    joints = {joint.name: joint for joint in robot.joints}
    others = {joint.get("name") or "": joint for joint in model.findall("joint")}
    yield from (f"joint: {name}" for name in joints.keys() ^ others.keys())
    ours = [joint.name for joint in robot.joints_in_gazebo if joint.name in others]
    if ours != [name for name in others if name in joints]:
        yield "order of joints: the robot"
    for name in joints.keys() & others.keys():
        yield from (f"{what}: {name}" for what in _of_joint(joints[name], others[name]))
    if robot.is_static != _is_true(model, "static"):
        yield "static: the robot"
    mass = sum(_number(link, "inertial/mass", 0.0) for link in theirs.values())
    if not math.isclose(robot.mass, mass, rel_tol=1e-6):
        yield "mass: the robot"


def _of_link(link: Link, theirs: ET.Element, model: ET.Element) -> Iterator[str]:
    inertial = theirs.find("inertial")
    if inertial is None or link.inertial is None:
        yield "inertial"
    else:
        yield from _of_inertial(link.inertial, inertial)
    shapes = theirs.findall("collision")
    if len(shapes) != len(link.collisions):
        yield "number of collisions"
    elif not all(map(_same_collision, link.collisions, shapes)):
        yield "collision"
    visuals = theirs.findall("visual")
    if len(visuals) != len(link.visuals):
        yield "number of visuals"
    elif not all(
        _same_pose(one.pose_in_link, _pose(other))
        for one, other in zip(link.visuals, visuals, strict=True)
    ):
        yield "visual"
    collides = _is_true(model, "self_collide")
    if link.self_collide != _is_true(theirs, "self_collide", default=collides):
        yield "self_collide"
    if link.gravity != _is_true(theirs, "gravity", default=True):
        yield "gravity"
    first = "velocity_decay[1]"  # of several, the first counts
    decay = tuple(_number(theirs, f"{first}/{one}", 0.0) for one in ("linear", "angular"))
    if link.velocity_decay != decay:
        yield "velocity_decay"


def _of_inertial(ours: Inertial, theirs: ET.Element) -> Iterator[str]:
    pose = _pose(theirs)
    moments = [_number(theirs, f"inertia/{moment}", math.nan) for moment in MOMENTS]
    turned = about_link_axes(
        Inertial(mass=1.0, pose_in_link=Pose(rpy=pose.rpy), inertia=(*moments,))  # type: ignore[arg-type]  # six of them
    )
    if not math.isclose(ours.mass, _number(theirs, "mass", math.nan), rel_tol=1e-6):
        yield "mass"
    if not _close(ours.pose_in_link.xyz, pose.xyz):
        yield "center of mass"
    slack = max(1e-6 * max(map(abs, turned)), 1e-18)  # kg m²; below it there is nothing but noise
    if not all(
        math.isclose(one, other, rel_tol=1e-6, abs_tol=slack)
        for one, other in zip(about_link_axes(ours), turned, strict=True)
    ):
        yield "inertia"


def _same_collision(ours: Collision, theirs: ET.Element) -> bool:
    geometry = theirs.find("geometry")
    kind = "" if geometry is None else next(iter(geometry)).tag
    surface = ours.surface
    return (
        kind == type(ours.geometry).__name__.lower()
        and _same_pose(ours.pose_in_link, _pose(theirs))
        and surface.mu1 == _number(theirs, "surface/friction/ode/mu", 1.0)
        and surface.mu2 == _number(theirs, "surface/friction/ode/mu2", 1.0)
        and surface.kp == _number(theirs, "surface/contact/ode/kp", None)
        and surface.kd == _number(theirs, "surface/contact/ode/kd", None)
        and surface.min_depth == _number(theirs, "surface/contact/ode/min_depth", None)
        and surface.max_contacts == _number(theirs, "max_contacts", None)
    )


def _of_joint(ours: Joint, theirs: ET.Element) -> Iterator[str]:
    kind = {JointType.CONTINUOUS: "revolute"}.get(ours.type, ours.type.value)
    if kind != theirs.get("type"):
        yield "type"
    if (ours.parent, ours.child) != (theirs.findtext("parent"), theirs.findtext("child")):
        yield "ends"
    if not _same_pose(ours.pose_in_parent, _pose(theirs)):
        yield "pose"
    if ours.type is JointType.FIXED:
        return
    axis = [float(word) for word in (theirs.findtext("axis/xyz") or "").split()]
    if not _close(ours.axis_in_joint, [number / math.hypot(*axis) for number in axis]):
        yield "axis"
    limit = ours.limit
    is_bound = limit is not None and ours.type is not JointType.CONTINUOUS
    bounds = (limit.lower, limit.upper) if limit and is_bound else (-NO_LIMIT, NO_LIMIT)
    drive = (limit.effort, limit.velocity) if limit else (-1.0, -1.0)
    if not _close(
        bounds, [_number(theirs, f"axis/limit/{key}", math.nan) for key in ("lower", "upper")]
    ):
        yield "limits"
    if not _close(
        drive, [_number(theirs, f"axis/limit/{key}", -1.0) for key in ("effort", "velocity")]
    ):
        yield "effort or velocity"
    if not _close(
        (ours.damping, ours.friction, ours.spring_stiffness, ours.spring_reference),
        [
            _number(theirs, f"axis/dynamics/{key}", 0.0)
            for key in ("damping", "friction", "spring_stiffness", "spring_reference")
        ],
    ):
        yield "dynamics"


def _number(element: ET.Element, path: str, default: Default) -> float | Default:
    """The first of that path, as sdformat takes it."""
    text = element.findtext(path)
    return default if text is None else float(text)


def _is_true(element: ET.Element, path: str, *, default: bool = False) -> bool:
    text = element.findtext(path)
    return default if text is None else text.strip().lower() in {"1", "true"}


def _pose(element: ET.Element) -> Pose:
    x, y, z, *rpy = (float(word) for word in (element.findtext("pose") or "0 0 0 0 0 0").split())
    return Pose(xyz=(x, y, z), rpy=(rpy[0], rpy[1], rpy[2]))


def _same_pose(one: Pose, other: Pose) -> bool:
    is_locked = abs(abs(other.rpy[1]) - math.pi / 2) < NEAR_GIMBAL_LOCK
    slack = NEAR_GIMBAL_LOCK if is_locked else 1e-6
    return _close(one.xyz, other.xyz) and all(
        _close(row, other_row, slack)
        for row, other_row in zip(rotation_of_rpy(one.rpy), rotation_of_rpy(other.rpy), strict=True)
    )


def _close(one: Sequence[float], other: Sequence[float], slack: float = 1e-7) -> bool:
    return all(
        math.isclose(a, b, rel_tol=1e-6, abs_tol=slack) for a, b in zip(one, other, strict=True)
    )
