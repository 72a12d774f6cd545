"""Programs in Python that call services of Gazebo Classic."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.fixes.source import SourceText, apply
from wsgen.porting.programs import port_program

FILE = Path("/p/spawn.py")
HEAD = """from gazebo_msgs.srv import DeleteEntity, SpawnEntity

"""
SPAWNS = (
    HEAD
    + '''
def make(name: str) -> SpawnEntity.Request:
    """Make a request."""
    req = SpawnEntity.Request()
    req.name = name
    req.robot_namespace = ""
    req.reference_frame = "world"  # of Gazebo
    req.initial_pose.position.x = 1.0
    return req


class Spawner:
    def __init__(self, node):
        self.client = node.create_client(SpawnEntity, "spawn_entity")
        self.gone = node.create_client(DeleteEntity, '/sim/delete_entity')
        self.template = SpawnEntity.Request()
        self.other.name = "mine"

    def spawn(self, request: SpawnEntity.Request, text):
        request = copy.deepcopy(self.template)
        request.xml = text
        made = make("a")
        made.xml = text
        print(f"{made.name} at {made.initial_pose.position.x:.2f}")
        answer = self.client.call(made)
        print(answer.success, answer.status_message, f"{answer.status_message}")

    def delete(self):
        req = DeleteEntity.Request()
        req.name = "a"
        self.gone.call_async(req)
'''
)
SPAWNS_AFTER = '''from ros_gz_interfaces.srv import DeleteEntity, SpawnEntity
from ros_gz_interfaces.msg import Entity


def make(name: str) -> SpawnEntity.Request:
    """Make a request."""
    req = SpawnEntity.Request()
    req.entity_factory.name = name
    # of Gazebo
    req.entity_factory.pose.position.x = 1.0
    return req


class Spawner:
    def __init__(self, node):
        self.client = node.create_client(SpawnEntity, "spawn_entity")
        self.gone = node.create_client(DeleteEntity, '/sim/delete_entity')
        self.template = SpawnEntity.Request()
        self.other.name = "mine"

    def spawn(self, request: SpawnEntity.Request, text):
        request = copy.deepcopy(self.template)
        request.entity_factory.sdf = text
        made = make("a")
        made.entity_factory.sdf = text
        print(f"{made.entity_factory.name} at {made.entity_factory.pose.position.x:.2f}")
        answer = self.client.call(made)
        print(answer.success, str(answer), f"{str(answer)}")

    def delete(self):
        req = DeleteEntity.Request()
        req.entity.name = "a"
        req.entity.type = Entity.MODEL
        self.gone.call_async(req)
'''


def test_requests_get_the_fields_of_gazebo_sim() -> None:
    made = port_program(SourceText(FILE, SPAWNS))
    assert made is not None
    assert apply(SPAWNS, made.edits) == SPAWNS_AFTER
    assert made.unported == ()
    assert made.packages == {"ros_gz_interfaces"}
    assert {(row.gz_topic, row.ros_type, row.ros_topic) for row in made.services} == {
        ("/world/{world}/create", "ros_gz_interfaces/srv/SpawnEntity", "/spawn_entity"),
        ("/world/{world}/remove", "ros_gz_interfaces/srv/DeleteEntity", "/sim/delete_entity"),
    }
    assert port_program(SourceText(FILE, SPAWNS_AFTER)) is None


MOVES = """from gazebo_msgs.msg import EntityState
from gazebo_msgs.srv import SetEntityState


class Mover:
    def __init__(self):
        self.client = self.create_client(SetEntityState, "/gazebo/set_entity_state")

    def move(self, name: str) -> None:
        request = SetEntityState.Request()
        request.state = EntityState()
        request.state.name = name
        request.state.pose.position.x = 1.0
        request.state.twist.linear.x = 0.0
        request.state.reference_frame = "world"
        self.log(f"{request.state.name} to {request.state.pose.position.x}")
        self.client.call_async(request)

    def move_too(self, pose: Pose) -> None:
        state = EntityState()
        state.name = "a"  # of the world
        state.pose = pose
        req = SetEntityState.Request()
        req.state = state
        self.client.call_async(req)

    def move_again(self, pose: Pose) -> None:
        req = SetEntityState.Request()
        s = req.state
        s.pose = pose
"""
MOVES_AFTER = """from ros_gz_interfaces.msg import Entity
from ros_gz_interfaces.srv import SetEntityPose


class Mover:
    def __init__(self):
        self.client = self.create_client(SetEntityPose, "/gazebo/set_entity_state")

    def move(self, name: str) -> None:
        request = SetEntityPose.Request()
        request.entity.name = name
        request.entity.type = Entity.MODEL
        request.pose.position.x = 1.0
        self.log(f"{request.entity.name} to {request.pose.position.x}")
        self.client.call_async(request)

    def move_too(self, pose: Pose) -> None:
        state = SetEntityPose.Request()
        state.entity.name = "a"  # of the world
        state.entity.type = Entity.MODEL
        state.pose = pose
        req = SetEntityPose.Request()
        req = state
        self.client.call_async(req)

    def move_again(self, pose: Pose) -> None:
        req = SetEntityPose.Request()
        s = req
        s.pose = pose
"""


def test_a_state_becomes_the_request_of_a_pose() -> None:
    made = port_program(SourceText(FILE, MOVES))
    assert made is not None
    assert apply(MOVES, made.edits) == MOVES_AFTER
    assert made.unported == ()
    (row,) = made.services
    assert row.gz_topic == "/world/{world}/set_pose"
    assert row.ros_type == "ros_gz_interfaces/srv/SetEntityPose"
    assert row.ros_topic == "/gazebo/set_entity_state"


def test_the_velocity_of_a_state_is_left_to_the_author() -> None:
    made = port_program(SourceText(FILE, MOVES.replace("linear.x = 0.0", "linear.x = speed")))
    assert made is not None
    assert [one.what for one in made.unported] == ["The service of Gazebo Sim has no `twist`."]


def test_what_a_request_can_no_longer_say_is_left_to_the_author() -> None:
    text = SPAWNS.replace('"world"', '"table"').replace(
        'robot_namespace = ""', "robot_namespace = n"
    )
    made = port_program(SourceText(FILE, text))
    assert made is not None
    assert [one.what for one in made.unported] == [
        "The service of Gazebo Sim has no `robot_namespace`.",
        "The service of Gazebo Sim has no `reference_frame`.",
    ]


@pytest.mark.parametrize(
    "text",
    [
        SPAWNS.replace("import DeleteEntity", "import GetEntityState, DeleteEntity"),
        SPAWNS.replace("DeleteEntity, SpawnEntity", "DeleteEntity, SpawnEntity as S"),
        f"import gazebo_msgs.msg\n{SPAWNS}",
        SPAWNS.replace('"spawn_entity"', "name"),
        SPAWNS.replace(
            "    req = SpawnEntity.Request()", "    req = SpawnEntity.Request(name='a')"
        ),
        SPAWNS.replace("req.robot_namespace =", "n = req.robot_namespace ="),
        f"{HEAD}call = helper(SpawnEntity)\n",
        "def broken(:\n    from gazebo_msgs.srv import SpawnEntity\n",
    ],
    ids=["other", "renamed", "module", "computed", "filled", "used", "no client", "syntax"],
)
def test_a_program_that_does_more_is_not_touched(text: str) -> None:
    assert port_program(SourceText(FILE, text)) is None
