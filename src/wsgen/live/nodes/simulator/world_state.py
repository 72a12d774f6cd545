"""What gazebo_msgs says of Gazebo Classic's world: which robots are in it, and how they move.

Sources: ros-simulation/gazebo_ros_pkgs, gazebo_ros/src/gazebo_ros_factory.cpp and
gazebo_ros_state.cpp (branch ros2).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from gazebo_msgs.msg import LinkStates, ModelStates
from gazebo_msgs.srv import DeleteEntity, GetEntityState, GetModelList, SetEntityState, SpawnEntity
from geometry_msgs.msg import Pose as PoseMessage
from geometry_msgs.msg import Twist

from wsgen.live.nodes.simulator.elements import number, topics_of
from wsgen.live.nodes.simulator.host import Plugin
from wsgen.live.nodes.simulator.messages import (
    NOT_FINITE,
    TOO_FAST,
    can_follow,
    move,
    pose_of,
    set_pose,
    set_twist,
)
from wsgen.live.nodes.simulator.simulation import RefusedError
from wsgen.model.transform import (
    Pose,
    compose,
    invert,
    quaternion_of_rpy,
    rotate,
    rotation_of_rpy,
    transpose,
)
from wsgen.simulation.live_runs import NewEntity

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.live.nodes.simulator.simulation import LiveSimulation
    from wsgen.model.devices import Element
    from wsgen.model.transform import Vector

    Moving = tuple[Pose, tuple[Vector, Vector]]  # in the world, with m/s and rad/s

WORLD = ("", "world")  # the frame of reference that is none
MAP = (*WORLD, "map", "/map")  # that of what is spawned


def offer_factory(simulation: LiveSimulation) -> None:
    """Offer the services that spawn, delete and list robots."""
    host = simulation.host

    def do(function: Callable[[], object], response: Any, done: str) -> Any:
        try:
            function()
        except RefusedError as error:
            response.success, response.status_message = False, f"{error.message} {error.hint}"
        else:
            response.success, response.status_message = True, done
        return response

    def spawn(request: Any, response: Any) -> Any:
        new = _asked_for(host, request)
        if isinstance(new, str):
            response.success, response.status_message = False, new
            return response
        done = "Successfully sent factory message to Gazebo."
        if new.entity:
            done = f"SpawnEntity: Successfully spawned entity [{new.entity}]"
        namespace = request.robot_namespace
        return do(
            lambda: simulation.spawn_new(new, namespace, renames=not new.entity), response, done
        )

    def delete(request: Any, response: Any) -> Any:
        name = request.name
        if name not in host.robots:
            response.success = False
            response.status_message = f"Entity [{name}] does not exist"
            return response
        done = f"Successfully deleted entity [{name}]"
        return do(lambda: simulation.delete(name), response, done)

    def names(_: Any, response: Any) -> Any:
        response.header.stamp, response.success = host.stamp(), True
        response.model_names = list(host.robots)
        return response

    host.service(None, SpawnEntity, "spawn_entity", spawn)
    host.service(None, DeleteEntity, "delete_entity", delete)
    host.service(None, GetModelList, "get_model_list", names)


def _asked_for(host: Host, request: Any) -> NewEntity | str:
    """What a request for an entity describes, or what is wrong with it, as Gazebo says it."""
    pose, frame = pose_of(request.initial_pose), _find(host, request.reference_frame)
    if pose is None:
        return f"SpawnEntity: {NOT_FINITE}"
    if frame is None and request.reference_frame not in MAP:
        return (
            f"Reference frame [{request.reference_frame}] not found, did you forget to scope the "
            "link by model name?"
        )
    if request.name in host.robots:
        return f"Entity [{request.name}] already exists."
    return NewEntity(
        entity=request.name,
        text=request.xml,
        pose_in_world=pose if frame is None else compose(frame[0], pose),
    )


class WorldState(Plugin):
    """`libgazebo_ros_state.so`, a plugin of the world."""

    def __init__(self, host: Host, _: None, element: Element) -> None:
        self._host = host
        rate = number(element, "update_rate")
        self.period = 1 / rate if rate > 0 else host.step_seconds
        self._node = host.node(None, element)
        host.service(None, GetEntityState, "get_entity_state", self._get, node=self._node)
        host.service(None, SetEntityState, "set_entity_state", self._set, node=self._node)
        topics, node = topics_of(host, None, element), self._node
        self._models = host.publisher(None, ModelStates, topics["models"], node=node, depth=1)
        self._links = host.publisher(None, LinkStates, topics["links"], node=node, depth=1)

    def update(self) -> None:
        """Publish where everything is."""
        robots = self._host.robots.values()
        if self._models.is_wanted:
            self._publish(
                self._models,
                ModelStates(),
                ((robot.entity, _root_of(robot)) for robot in robots),
            )
        if self._links.is_wanted:
            self._publish(
                self._links,
                LinkStates(),
                (
                    (f"{robot.entity}::{link}", (pose, robot.link_velocities()[link]))
                    for robot in robots
                    for link, pose in robot.link_poses().items()
                ),
            )

    @staticmethod
    def _publish(publisher: Any, message: Any, entities: Iterator[tuple[str, Moving]]) -> None:
        for name, (pose, (linear, angular)) in entities:
            made, twist = PoseMessage(), Twist()
            set_pose(made, pose.xyz, quaternion_of_rpy(pose.rpy))
            set_twist(twist, linear, angular)
            message.name.append(name)
            message.pose.append(made)
            message.twist.append(twist)
        publisher.publish(message)

    def _get(self, request: Any, response: Any) -> Any:
        found = _find(self._host, request.name)
        frame = _find(self._host, request.reference_frame)
        response.success = found is not None and (
            frame is not None or request.reference_frame in WORLD
        )
        if found is None or not response.success:
            self._host.warn(
                f"GetEntityState: no entity `{request.name}` in the frame "
                f"`{request.reference_frame}`."
            )
            return response
        pose, (linear, angular) = found
        if frame is not None:
            its_pose, (its_linear, its_angular) = frame
            to_frame = transpose(rotation_of_rpy(its_pose.rpy))
            pose = compose(invert(its_pose), pose)
            linear, angular = (
                rotate(to_frame, (a[0] - b[0], a[1] - b[1], a[2] - b[2]))
                for a, b in ((linear, its_linear), (angular, its_angular))
            )
        response.header.stamp = self._host.stamp()
        response.header.frame_id = request.reference_frame
        set_pose(response.state.pose, pose.xyz, quaternion_of_rpy(pose.rpy))
        set_twist(response.state.twist, linear, angular)
        return response

    def _set(self, request: Any, response: Any) -> Any:
        state = request.state
        robot = self._host.robots.get(state.name)
        frame = _find(self._host, state.reference_frame)
        response.success = robot is not None and (
            frame is not None or state.reference_frame in WORLD
        )
        if robot is None or not response.success:
            self._host.warn(
                f"SetEntityState: no entity `{state.name}` in the frame `{state.reference_frame}`."
            )
            return response
        pose = pose_of(state.pose)
        linear = (state.twist.linear.x, state.twist.linear.y, state.twist.linear.z)
        angular = (state.twist.angular.x, state.twist.angular.y, state.twist.angular.z)
        if pose is None or not all(map(math.isfinite, (*linear, *angular))):
            self._host.warn(f"SetEntityState: {NOT_FINITE}")
            response.success = False
            return response
        if not can_follow(linear, angular):
            self._host.warn(f"SetEntityState: {TOO_FAST}")
            response.success = False
            return response
        if frame is not None:
            rotation = rotation_of_rpy(frame[0].rpy)
            pose = compose(frame[0], pose)
            linear, angular = rotate(rotation, linear), rotate(rotation, angular)
        move(robot, pose)
        robot.set_velocity(linear, angular)
        return response


def _find(host: Host, name: str) -> Moving | None:
    """Where a robot or a link of one (`robot::link`) is."""
    entity, _, link = name.partition("::")
    robot = host.robots.get(entity)
    if robot is None or (link and link not in robot.link_poses()):
        return None
    if not link:
        return _root_of(robot)
    return robot.link_poses()[link], robot.link_velocities()[link]


def _root_of(robot: RobotHandle) -> Moving:
    return robot.link_poses()[robot.robot.root], robot.root_velocity()
