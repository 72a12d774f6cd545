"""The systems of Gazebo Sim: plugin libraries, and the classes in them.

Source: gazebosim/gz-sim, src/systems, of all releases from Fortress to Jetty.
"""

from __future__ import annotations

import re
from functools import cache
from typing import NamedTuple

from wsgen.text.suggestions import nearest
from wsgen.text.values import lazy_pattern

# Library, without its prefix and suffix -> its class; where that is not the name in CamelCase, it
# follows the name after a colon.
_SYSTEMS = """
ackermann-steering acoustic-comms advanced-lift-drag air-pressure air-speed altimeter
apply-joint-force apply-link-wrench breadcrumbs buoyancy buoyancy-engine
buoyancy-engine:BuoyancyEnginePlugin camera-video-recorder
collada-world-exporter comms-endpoint contact cpu-lidar detachable-joint diff-drive
drive-to-pose-controller dvl:DopplerVelocityLogSystem elevator entity-semantics environment-preload
environmental-sensor:EnvironmentalSystem environmental-sensor:EnvironmentalSensorSystem
follow-actor forcetorque:ForceTorque free-space-explorer
hydrodynamics imu joint-controller joint-position-controller joint-state-publisher
joint-trajectory-controller kinetic-energy-monitor label led-plugin lens-flare lift-drag
lighter_than_air_dynamics:LighterThanAirDynamics linearbatteryplugin:LinearBatteryPlugin
log:LogPlayback log:LogRecord log-video-recorder
logicalaudiosensorplugin:LogicalAudioSensorPlugin logical-camera lookup-wheel-slip magnetometer
mecanum-drive model-photo-shoot multicopter-control:MulticopterVelocityControl
multicopter-motor-model navsat:NavSat odometry-publisher opticaltactileplugin:OpticalTactilePlugin
particle-emitter perfect-comms performer-detector physics pose-publisher python-system-loader
rf-comms:RFComms scene-broadcaster sensors shader-param spacecraft-thruster-model thermal
thermal-sensor thruster touchplugin:TouchPlugin track-controller tracked-vehicle
trajectory-follower triggered-publisher user-commands velocity-control websocket-server wheel-slip
wind-effects
"""
_LIBRARY = lazy_pattern(r"(?:lib)?(gz-sim|ignition-gazebo)(\d*)-(.+?)-system(?:\.so)?")
_CLASS = lazy_pattern(r"(?:gz::sim|ignition::gazebo)(?:::v\d+)?::systems::(\w+)")
# A name with another prefix or without `-system` is still meant to be a system of Gazebo.
_NEARLY = lazy_pattern(r"(?:lib)?((?:gz-sim|ignition-gazebo)\d*-[\w-]+)(?:\.so)?")
_MARKERS = (
    *("gz-sim", "gz::sim", "ignition-gazebo", "ignition::gazebo"),
    *("gz_ros2_control", "ign_ros2_control"),
)
# What Gazebo loads for a world without systems, and from Ionic on for any world, unless a
# server.config says another thing (include/gz/sim/server.config of all releases).
SPAWNING = "UserCommands"  # the one without which nothing can be spawned
DEFAULT_SYSTEMS = ("Physics", SPAWNING, "SceneBroadcaster")
# The distributions whose Gazebo adds them to those of a world (SimulationRunner.cc of gz-sim9).
WITH_MERGED_DEFAULTS = ("kilted", "lyrical", "rolling")
# Those of the worlds that Gazebo ships and people start robots in.
EMPTY_WORLD = "empty.sdf"
OF_SHIPPED_WORLDS = {EMPTY_WORLD: (*DEFAULT_SYSTEMS, "Contact")}
MOST_LETTERS = 2  # more or fewer of a misspelled name
SURELY = 0.8  # so alike two names are, as difflib counts, that one is the other misspelled


class Remark(NamedTuple):
    """What is wrong with the names of a plugin."""

    message: str
    meant: str  # the name to write instead
    is_filename: bool  # it stands in `filename`; else in `name`


@cache
def systems() -> dict[str, tuple[str, ...]]:
    """The classes of each system, by its name between `gz-sim-` and `-system`."""
    found: dict[str, tuple[str, ...]] = {}
    for word in _SYSTEMS.split():
        name, _, written = word.partition(":")
        in_camel_case = "".join(part.capitalize() for part in name.split("-"))
        found[name] = (*found.get(name, ()), written or in_camel_case)
    return found


def loaded_class(filename: str, name: str) -> str | None:
    """The class of the system that a plugin loads; None where it is another one, or fails."""
    found = _LIBRARY.fullmatch(filename.rpartition("/")[2])
    classes = systems().get(found[3], ()) if found else ()
    if not name:
        return classes[0] if classes else None
    written = _CLASS.fullmatch(name)
    return written[1] if written is not None and written[1] in classes else None


def library_of(system: str) -> str:
    """The library that holds a system, by its class."""
    return f"gz-sim-{next(name for name, classes in systems().items() if system in classes)}-system"


def plugin_of(system: str) -> str:
    """The element that loads a system, by its class."""
    return f'<plugin filename="{library_of(system)}" name="gz::sim::systems::{system}"/>'


def is_of_gz(filename: str, name: str = "") -> bool:
    """Whether a plugin is a system of Gazebo Sim, or what connects it to ros2_control."""
    return any(marker in word for word in (filename, name) for marker in _MARKERS)


def is_of_classic(filename: str) -> bool:
    """Whether a plugin is one of Gazebo Classic for ROS."""
    return filename.startswith(("libgazebo_ros_", "libgazebo_ros2_control"))


# Libraries of ros2_control for Gazebo Sim, and their classes; each has that of the other, too.
CONTROL = {
    "gz_ros2_control-system": "gz_ros2_control::GazeboSimROS2ControlPlugin",
    "ign_ros2_control-system": "ign_ros2_control::IgnitionROS2ControlPlugin",
}


def control_library(filename: str) -> str | None:
    """The library of ros2_control for Gazebo Sim that a file name means, also a misspelled one."""
    name = filename.removeprefix("lib").removesuffix(".so")
    return name if name in CONTROL else nearest(name, CONTROL, cutoff=SURELY)


def _remark_on_control(filename: str, name: str, library: str) -> Remark | None:
    if filename.removeprefix("lib").removesuffix(".so") != library:
        return Remark(f"Gazebo has no system `{filename}`.", library, is_filename=True)
    if not name or name in CONTROL.values():
        return None
    message = f"The library `{filename}` has no class `{name}`."
    return Remark(message, CONTROL[library], is_filename=False)


def remark_on(filename: str, name: str) -> Remark | None:
    """What is wrong with the names of a plugin that is meant to be a system of Gazebo Sim.

    None where nothing is, or where it may be a library of somebody's own.
    """
    control = control_library(filename)
    if control is not None:
        return _remark_on_control(filename, name, control)
    known = systems()
    found = _LIBRARY.fullmatch(filename)
    if found is None:
        nearly = _NEARLY.fullmatch(filename)
        stem = re.sub(r"^(?:gz-sim|ignition-gazebo)\d*-", "", nearly[1]) if nearly else ""
        meant = f"{nearly[1]}-system" if nearly and stem in known else None
        name_of, _, ending = stem.rpartition("-")
        if nearly and name_of in known and nearest(ending, ["system"], cutoff=SURELY):
            meant = f"{nearly[1].removesuffix(ending)}system"
    else:
        # Libraries of others have a word more: `gz-sim-yarp-forcetorque-system`.
        alike = [one for one in known if abs(len(one) - len(found[3])) <= MOST_LETTERS]
        near = None if found[3] in known else nearest(found[3], alike, cutoff=SURELY)
        meant = f"{found[1]}-{near}-system" if near else None
    if meant is not None:
        return Remark(f"Gazebo has no system `{filename}`.", meant, is_filename=True)
    classes = known.get(found[3], ()) if found else ()
    if not classes or not name:
        return None
    written = _CLASS.fullmatch(name)
    if written is not None and written[1] in classes:
        return None
    namespace = "ignition::gazebo" if name.startswith("ignition::") else "gz::sim"
    return Remark(
        f"The library `{filename}` has no class `{name}`.",
        f"{namespace}::systems::{classes[0]}",
        is_filename=False,
    )
