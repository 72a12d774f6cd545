"""`python -m wsgen.live.nodes.create`: spawns a robot, in the place of two programs.

`--as spawn_entity.py` takes the arguments of gazebo_ros's spawner, `--as create` those of
ros_gz_sim's. What they print, how long they wait and how they end is theirs: sources are
ros-simulation/gazebo_ros_pkgs, gazebo_ros/scripts/spawn_entity.py (branch ros2) and
gazebosim/ros_gz, ros_gz_sim/src/create.cpp. A robot that wsgen has read in the launch file is
prepared already, with its pose; another one is prepared from the description that is given here.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import rclpy
import rclpy.utilities
from rclpy.exceptions import NameValidationException
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.signals import SignalHandlerOptions
from std_msgs.msg import String

from wsgen.isolation.codec import encode
from wsgen.launching.spawner_options import CREATE, NUMBERS, SPAWN_ENTITY, read_flags
from wsgen.live.nodes.signals import ignore_ends, raise_when_ended
from wsgen.model.transform import Pose
from wsgen.simulation.live_runs import NewEntity, SimulatorClient, SimulatorError

if TYPE_CHECKING:
    from collections.abc import Mapping

CLASSIC, SIM = "spawn_entity.py", "create"
GZ_FAILED = 255  # -1
WAIT = 5.0  # s, for Gazebo Sim, between two messages
LOOK_EVERY = 0.2  # s, for entities that others spawn, and for signals
NAME = re.compile(r"<(?:robot|model)\b[^>]*\bname\s*=\s*[\"']([^\"']*)[\"']")


def main() -> int:
    """Spawn a robot; gives the exit code."""
    arguments = sys.argv[1:]
    program = SIM
    if arguments[:1] == ["--as"]:
        program, arguments = arguments[1], arguments[2:]
    raise_when_ended()
    client = None
    try:
        client = SimulatorClient()
        rclpy.init(args=[program, *arguments], signal_handler_options=SignalHandlerOptions.NO)
        words = rclpy.utilities.remove_ros_args([program, *arguments])[1:]
        return (_spawn_entity if program == CLASSIC else _create)(words, client)
    except SimulatorError as error:
        sys.stderr.write(f"{error.message}\n{error.hint}\n")
        return 1
    except NameValidationException as error:
        sys.stderr.write(f"{error}\nCorrect the name in the launch file.\n")
        return 1
    except KeyboardInterrupt:
        return 130
    finally:
        ignore_ends()
        if client is not None:
            client.close()
        rclpy.try_shutdown()


def _spawn_entity(words: list[str], client: SimulatorClient) -> int:
    """As gazebo_ros does."""
    options = _classic_options().parse_args(words)
    node = rclpy.create_node("spawn_entity")
    log = node.get_logger()
    log.info("Spawn Entity started")
    if options.wait:
        log.info(f"Waiting for entity {options.wait} before proceeding.")
        client.connect(math.inf)
        while options.wait not in client.ask("state")["entities"]:
            time.sleep(LOOK_EVERY)
    new = _classic_source(options, node)
    if isinstance(new, str):
        log.error(new)
        return 1
    timeout = options.timeout
    if options.spawn_service_timeout is not None:
        log.warning("'-spawn_service_timeout' is deprecated, use '-timeout' instead")
        timeout = options.spawn_service_timeout
    service = f"{options.gazebo_namespace}/spawn_entity"
    if timeout < 0:
        log.error("spawn_entity timeout must be greater than zero")
        log.error("Spawn service failed. Exiting.")
        return 1
    log.info(f"Waiting for service {service}, timeout = {timeout:.0f}")
    log.info(f"Waiting for service {service}")
    if not client.connect(timeout):
        log.error(f"Service {service} unavailable. Was Gazebo started with GazeboRosFactory?")
        log.error("Spawn service failed. Exiting.")
        return 1
    log.info(f"Calling service {service}")
    try:
        client.ask(
            "spawn",
            entity=options.entity,
            namespace=options.robot_namespace,
            new=json.loads(encode(new)),
        )
    except SimulatorError as error:
        log.info(f"Spawn status: {error.message} {error.hint}")
        log.error("Spawn service failed. Exiting.")
        return 1
    log.info(f"Spawn status: SpawnEntity: Successfully spawned entity [{options.entity}]")
    if options.unpause:
        log.info(f"Calling service {options.gazebo_namespace}/unpause_physics")
        client.ask("unpause")
    if options.b:
        _stay(options, client, log)
    return 0


def _stay(options: argparse.Namespace, client: SimulatorClient, log: Any) -> None:
    """Delete the robot when this program is interrupted."""
    log.info(f"Waiting for shutdown to delete entity [{options.entity}]")
    try:
        client.wait_until_it_ends()
    except KeyboardInterrupt:
        ignore_ends()
        log.info("Ctrl-C detected")
    log.info(f"Deleting entity [{options.entity}]")
    log.info(f"Calling service {options.gazebo_namespace}/delete_entity")
    try:
        client.ask("delete", entity=options.entity)
    except SimulatorError as error:
        log.info(f"Deleting status: {error.message}")
    else:
        log.info(f"Deleting status: Successfully deleted entity [{options.entity}]")


def _classic_options() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog=CLASSIC,
        description="Spawn an entity in Gazebo. wsgen simulates in the place of Gazebo.",
    )
    source = parser.add_mutually_exclusive_group(required=True)
    for name, default in SPAWN_ENTITY.with_value.items():
        numeric: dict[str, Any] = {"type": float} if name in NUMBERS else {}
        group = source if name in SPAWN_ENTITY.sources else parser
        is_required = name == SPAWN_ENTITY.entity
        group.add_argument(f"-{name}", default=default, required=is_required, **numeric)
    for name in sorted(SPAWN_ENTITY.flags):
        group = source if name in SPAWN_ENTITY.sources else parser
        group.add_argument(f"-{name}", action="store_true")
    return parser


def _classic_source(options: argparse.Namespace, node: Any) -> NewEntity | str:
    """The description, which is waited for; or what is wrong with where it is."""
    log = node.get_logger()
    new = NewEntity(
        entity=options.entity,
        pose_in_world=Pose(
            xyz=(options.x, options.y, options.z), rpy=(options.R, options.P, options.Y)
        ),
    )
    if options.file:
        log.info(f"Loading entity XML from file {options.file}")
        return _in_file(new, Path(options.file))
    if options.topic:
        log.info(f"Loading entity published on topic {options.topic}")
        waiting = f"Waiting for entity xml on {options.topic}"
        return replace(new, text=_description_on(node, options.topic, waiting))
    if options.database:
        log.info("Loading entity XML from Gazebo Model Database")
        return replace(new, model_uri=f"model://{options.database}")
    text = sys.stdin.read()
    return replace(new, text=text) if text else "Error: stdin buffer was empty"


def _in_file(new: NewEntity, file: Path) -> NewEntity | str:
    """The description of a file, or what is wrong with that."""
    if not file.exists():
        return f"Error: specified file {file} does not exist"
    if not file.is_file():
        return f"Error: specified file {file} is not a file"
    text = file.read_text(errors="replace")
    return replace(new, text=text, file=file.absolute()) if text else f"Error: file {file} is empty"


def _description_on(node: Any, topic: str, waiting: str, every: float | None = None) -> str:
    """What is published on a topic, as robot_state_publisher does; says that it waits."""
    found: list[str] = []
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    node.create_subscription(String, topic, lambda message: found.append(message.data), qos)
    while not any(found):
        node.get_logger().info(waiting)
        heard = len(found)
        end = math.inf if every is None else time.monotonic() + every
        while len(found) == heard and time.monotonic() < end:
            rclpy.spin_once(node, timeout_sec=LOOK_EVERY)  # signals wait until it returns
    return next(text for text in found if text)


def _create(words: list[str], client: SimulatorClient) -> int:
    """As ros_gz_sim does."""
    node = rclpy.create_node("ros_gz_sim", automatically_declare_parameters_from_overrides=True)
    log = node.get_logger()
    flags = read_flags(words, CREATE)
    for word in flags.without_value:
        log.error(f"flag '{word.lstrip('-')}' is missing its argument")
        return 1
    given = _Given(node, flags.values)
    world = given.value("world")
    while not client.connect(WAIT):
        if world:
            log.warning(_waiting(world))
        else:
            log.info("Requesting list of world names.")
    actual = client.ask("state")["world"]
    description = _gz_description(given)
    if description is None:
        return GZ_FAILED
    while world not in {"", actual}:
        time.sleep(WAIT)
        log.warning(_waiting(world))
    new = replace(description, pose_in_world=given.pose())
    found = NAME.search(new.text)
    entity = given.value("name") or (found[1] if found else "")
    renames = given.value("allow_renaming").lower() == "true"
    try:
        client.ask(
            "spawn",
            entity=entity,
            renames=renames,
            new=json.loads(encode(replace(new, entity=entity))),
        )
    except SimulatorError as error:
        log.error(f"Entity creation failed.\n {error.message} {error.hint}")
        return 1
    log.info("Entity creation successful.")
    return 0


class _Given(NamedTuple):
    """What the launch file gives to ros_gz_sim's program."""

    node: Any
    flags: Mapping[str, str]

    def value(self, name: str) -> str:
        """A parameter of ROS, or else a flag; empty without them."""
        is_there = self.node.has_parameter(name)
        parameter = self.node.get_parameter(name).value if is_there else ""
        return str(parameter) or self.flags.get(name, "")

    def pose(self) -> Pose:
        """Where it is spawned; 0 for what is no number."""
        x, y, z, roll, pitch, yaw = (self._number(name) for name in ("x", "y", "z", "R", "P", "Y"))
        return Pose(xyz=(x, y, z), rpy=(roll, pitch, yaw))

    def _number(self, name: str) -> float:
        try:
            number = float(self.value(name))
        except ValueError:
            return 0.0
        return number if math.isfinite(number) else 0.0


def _gz_description(given: _Given) -> NewEntity | None:
    """The robot, waited for if it must be; None where nothing says where its description is."""
    log = given.node.get_logger()
    if given.value("file"):
        file = Path(given.value("file"))
        if not file.is_file():  # the address of a model
            return NewEntity(model_uri=given.value("file"))
        return NewEntity(text=file.read_text(errors="replace"), file=file.absolute())
    if given.value("string"):
        return NewEntity(text=given.value("string"))
    parameter = given.flags.get("param", "")
    if parameter:
        text = given.value(parameter)
        if not text:
            log.error(f"Failed to get XML from param [{parameter}].")
        return NewEntity(text=text) if text else None
    topic = given.value("topic")
    if topic:
        waiting = f"Waiting messages on topic [{topic}]."
        return NewEntity(text=_description_on(given.node, topic, waiting, 1.0))
    kinds = "file, string or topic as ROS 2 parameters"
    if given.flags:
        kinds = "either -file, -param, -string or -topic"
    log.error(f"Must specify {kinds}")
    return None


def _waiting(world: str) -> str:
    return f"Waiting for service [/world/{world}/create] to become available ..."


if __name__ == "__main__":
    sys.exit(main())
