"""The JSON contract of `wsgen validate --format json`."""

import json
import math
from dataclasses import replace
from pathlib import Path

from wsgen.building.colcon import PackageResult
from wsgen.building.run import BuildResult
from wsgen.checks.fixes.plan import FileFix
from wsgen.checks.rules.catalogue import UNKNOWN_RULE_ALLOWED
from wsgen.diagnostics import Diagnostic, Measured, Severity
from wsgen.model.behavior import BehaviorOutcome, Drive, Reach
from wsgen.model.outcome import (
    EngineOutcome,
    NotValidated,
    Outcome,
    PackageOutcome,
    Rest,
    RobotOutcome,
    Simulated,
)
from wsgen.model.transform import Pose
from wsgen.model.world import PlacedModel, World
from wsgen.porting.plan import PortPlan
from wsgen.porting.ported import Unported
from wsgen.porting.proof import Compared, Proof
from wsgen.reporting.json_report import (
    render_build,
    render_outcome,
    render_port,
    render_proof,
    render_rules,
)

BEHAVIORS = (
    BehaviorOutcome(
        name="drives", task=Drive(x=1.0, yaw=0.0), passed=True, moved=(0.98, 0.0, math.inf)
    ),
    BehaviorOutcome(
        name="reaches",
        task=Reach(positions={"elbow": 0.5}),
        passed=False,
        positions={"elbow": 0.3},
    ),
    BehaviorOutcome(name="untried", task=Drive(y=0.5), passed=False),
)
ROBOT = RobotOutcome(
    entity="r",
    spawn_pose=Pose((0.0, 0.0, 1.0)),
    links=2,
    joints=1,
    movable_joints=0,
    mass=1.0,
    engines=(
        EngineOutcome(
            engine="bullet",
            simulated=Simulated(engine="bullet", links=1, movable_joints=0, mass=1.0),
            rest=Rest(
                pose_in_world=Pose((0.0, 0.0, 0.25)),
                settled_after=0.5,
                speed=0.0,
                tilt=0.01,
                joint_positions={"elbow": 0.5},
            ),
            behaviors=BEHAVIORS[:1],
            passed=True,
        ),
        EngineOutcome(engine="dart", behaviors=BEHAVIORS[2:]),
    ),
    behaviors=BEHAVIORS,
)
DIAGNOSTIC = Diagnostic(
    name="some-rule", code="SPN053", severity=Severity.WARNING, message="m", file=Path("f"), line=3
)


def outcome(**changes: object) -> Outcome:
    values = {
        "package": "p",
        "share": Path("/s"),
        "launch_file": Path("/s/l.launch.py"),
        "world": World(name="w", models=(PlacedModel(name="ground_plane"),)),
        "robots": (ROBOT,),
        "diagnostics": (DIAGNOSTIC,),
        "seconds": {"total": 1.23456},
        **changes,
    }
    left = NotValidated(package="q", reason="spawns no robot", robot_files=(Path("/q/q.urdf"),))
    return Outcome(packages=(PackageOutcome(**values),), not_validated=(left,))  # type: ignore[arg-type]


def test_every_key_of_the_contract() -> None:
    document = json.loads(render_outcome(outcome()))
    assert document == {
        "version": 1,
        "complete": True,
        "passed": True,
        "packages": [
            {
                "package": "p",
                "file": None,
                "share": "/s",
                "launch_file": "/s/l.launch.py",
                "passed": True,
                "world": {
                    "name": "w",
                    "file": None,
                    "models": ["ground_plane"],
                    "gravity": [0.0, 0.0, -9.8],
                },
                "robots": [
                    {
                        "entity": "r",
                        "spawn_pose": {"xyz": [0.0, 0.0, 1.0], "rpy": [0.0, 0.0, 0.0]},
                        "links": 2,
                        "joints": 1,
                        "movable_joints": 0,
                        "mass": 1.0,
                        "simulated": {
                            "engine": "bullet",
                            "links": 1,
                            "movable_joints": 0,
                            "mass": 1.0,
                        },
                        "rest": {
                            "xyz": [0.0, 0.0, 0.25],
                            "rpy": [0.0, 0.0, 0.0],
                            "settled_after": 0.5,
                            "speed": 0.0,
                            "tilt": 0.01,
                            "joint_positions": {"elbow": 0.5},
                        },
                        "behaviors": [
                            {
                                "name": "drives",
                                "passed": True,
                                "moved": {"x": 0.98, "y": 0.0, "yaw": None},
                                "joints": None,
                                "traveled": None,
                                "seconds": None,
                                "printed": [],
                                "expected": {"x": 1.0, "y": None, "yaw": 0.0},
                            },
                            {
                                "name": "reaches",
                                "passed": False,
                                "moved": None,
                                "joints": {"elbow": 0.3},
                                "traveled": None,
                                "seconds": None,
                                "printed": [],
                                "expected": {"elbow": 0.5},
                            },
                            {
                                "name": "untried",
                                "passed": False,
                                "moved": None,
                                "joints": None,
                                "traveled": None,
                                "seconds": None,
                                "printed": [],
                                "expected": {"x": None, "y": 0.5, "yaw": None},
                            },
                        ],
                        "engines": [
                            {
                                "engine": "bullet",
                                "version": None,
                                "passed": True,
                                "rest": {
                                    "xyz": [0.0, 0.0, 0.25],
                                    "rpy": [0.0, 0.0, 0.0],
                                    "settled_after": 0.5,
                                    "speed": 0.0,
                                    "tilt": 0.01,
                                    "joint_positions": {"elbow": 0.5},
                                },
                                "behaviors": [
                                    {
                                        "name": "drives",
                                        "passed": True,
                                        "moved": {"x": 0.98, "y": 0.0, "yaw": None},
                                        "joints": None,
                                        "traveled": None,
                                        "seconds": None,
                                        "printed": [],
                                    }
                                ],
                            },
                            {
                                "engine": "dart",
                                "version": None,
                                "passed": False,
                                "rest": None,
                                "behaviors": [
                                    {
                                        "name": "untried",
                                        "passed": False,
                                        "moved": None,
                                        "joints": None,
                                        "traveled": None,
                                        "seconds": None,
                                        "printed": [],
                                    }
                                ],
                            },
                        ],
                    }
                ],
                "diagnostics": [
                    {
                        "code": "SPN053",
                        "name": "some-rule",
                        "severity": "warning",
                        "message": "m",
                        "file": "f",
                        "line": 3,
                        "element": None,
                        "hint": None,
                    }
                ],
                "picture": None,
                "world_picture": None,
                "video": None,
                "seconds": {"total": 1.2346},
            }
        ],
        "not_validated": [
            {
                "package": "q",
                "launch_file": None,
                "reason": "spawns no robot",
                "robot_files": ["/q/q.urdf"],
            }
        ],
    }


def keys(value: object, path: str = "") -> set[str]:
    """The paths of all keys, lists as in the documentation."""
    if isinstance(value, list):
        return {name for item in value[:1] for name in keys(item, f"{path}[]")}
    if not isinstance(value, dict):
        return set()
    found = set()
    for key, below in value.items():
        name = f"{path}.{key}" if path else key
        is_list_of_objects = isinstance(below, list) and bool(below) and isinstance(below[0], dict)
        found |= {f"{name}[]" if is_list_of_objects else name} | keys(below, name)
    return found


def documented_keys(command: str) -> set[str]:
    """The keys that docs/json.md lists for a command."""
    text = (Path(__file__).parents[2] / "docs" / "json.md").read_text(encoding="utf-8")
    (section,) = (
        part for part in text.split("# The JSON of ") if part.startswith(f"`{command}`\n")
    )
    return {line.split("`")[1] for line in section.splitlines() if line.startswith("| `")}


def test_the_documentation_lists_every_key() -> None:
    stages = dict.fromkeys(("launch", "expand", "run", "load", "simulate", "total"), 1.0)
    document = json.loads(render_outcome(outcome(seconds=stages)))
    (robot,) = document["packages"][0]["robots"]
    robot["rest"]["joint_positions"] = None  # its keys are names
    robot["behaviors"][0]["expected"] = None  # so may be its
    robot["engines"][0]["rest"] = None  # as `rest`
    robot["engines"][0]["behaviors"][0]["moved"] = None  # as in `behaviors`
    assert documented_keys("wsgen validate") == keys(document)


BUILD = BuildResult(
    succeeded=True,
    packages=(
        PackageResult(
            name="p", outcome="built", seconds=1.23456, left_out=("driver",), needs=("rclcpp",)
        ),
    ),
    seconds=2.0,
    diagnostics=(DIAGNOSTIC,),
    log_folder=Path("/ws/log"),
)


def test_every_key_of_a_build() -> None:
    document = json.loads(render_build(BUILD))
    assert document == {
        "version": 1,
        "passed": True,
        "packages": [
            {
                "package": "p",
                "state": "built",
                "seconds": 1.2346,
                "left_out": ["driver"],
                "needs": ["rclcpp"],
            }
        ],
        "diagnostics": [
            {
                "code": "SPN053",
                "name": "some-rule",
                "severity": "warning",
                "message": "m",
                "file": "f",
                "line": 3,
                "element": None,
                "hint": None,
            }
        ],
        "log": "/ws/log",
        "seconds": 2.0,
    }
    assert documented_keys("wsgen build") == keys(document)


def test_every_key_of_a_port() -> None:
    fix = FileFix(file=Path("/p/b.xml"), before="", after="", data=b"", fixed=())
    plan = PortPlan(
        files=(fix,),
        created=((Path("/p/w.sdf"), ""),),
        unported=(Unported(Path("/p/a.py"), 3, "It was.", "Write it."),),
        packages=("p",),
    )
    document = json.loads(render_port(plan, is_written=True))
    assert document == {
        "version": 1,
        "written": True,
        "packages": ["p"],
        "files": [{"path": "/p/w.sdf", "new": True}, {"path": "/p/b.xml", "new": False}],
        "left": [
            {"file": "/p/a.py", "line": 3, "what": "It was.", "advice": "Write it.", "note": False}
        ],
    }
    assert documented_keys("wsgen port") == keys(document)


def test_every_key_of_a_proof() -> None:
    rows = (
        Compared("a", "topics", "1", "1", is_same=False),
        Compared("a", "/scan", "frame x", "frame y", is_same=False, is_detail=True),
        Compared("a", "turn", "1 rad", "1.1 rad", is_same=False, difference=0.1),
        Compared("b", "rest pose", "0 m", "not simulated", is_same=None),
    )
    document = json.loads(render_proof(Proof(before="as it is", rows=rows)))
    one = {"aspect": "topics", "before": "1", "after": "1", "same": False, "difference": None}
    detail = {"aspect": "/scan", "before": "frame x", "after": "frame y", "same": False}
    assert document["robots"][0]["aspects"][0] == {**one, "details": [detail]}
    assert document["robots"][0]["aspects"][1]["difference"] == 0.1
    assert [one["robot"] for one in document["robots"]] == ["a", "b"]
    assert (document["passed"], document["before"]) == (False, "as it is")
    assert documented_keys("wsgen port --check") == keys(document)


def test_no_robot_is_no_pass() -> None:
    document = json.loads(render_outcome(outcome(robots=())))
    assert document["passed"] is False


def test_an_error_is_no_pass() -> None:
    error = Diagnostic(name="some-rule", code="SPN052", severity=Severity.ERROR, message="m")
    document = json.loads(render_outcome(outcome(diagnostics=(error,))))
    assert document["packages"][0]["passed"] is False


def test_numbers_that_json_does_not_know_are_null() -> None:
    rest = Rest(pose_in_world=Pose((math.nan, 0.0, math.inf)), settled_after=None, speed=math.nan)
    robot = RobotOutcome(
        entity="r",
        spawn_pose=Pose(),
        links=1,
        joints=0,
        movable_joints=0,
        mass=1.0,
        engines=(EngineOutcome(engine="bullet", rest=rest),),
    )
    written = json.loads(render_outcome(outcome(robots=(robot,))))["packages"][0]["robots"][0]
    assert written["rest"]["xyz"] == [None, 0.0, None]
    assert written["rest"]["speed"] is None
    assert written["simulated"] is None


def test_every_key_of_a_rule() -> None:
    rule = replace(UNKNOWN_RULE_ALLOWED, measured=Measured("takes it", "refuses it"))
    document = json.loads(render_rules([rule]))
    assert document["version"] == 1
    assert document["rules"][0]["measured"] == {"classic": "takes it", "sim": "refuses it"}
    assert document["rules"][0]["severity"] == "warning"
    assert documented_keys("wsgen rule") == keys(document)


def test_the_code_of_a_rule_has_no_empty_lines_around_it() -> None:
    rule = replace(UNKNOWN_RULE_ALLOWED, example="\n  a\n\nb\n", instead="\nc\n")
    (written,) = json.loads(render_rules([rule]))["rules"]
    assert (written["example"], written["instead"]) == ("  a\n\nb", "c")


def test_a_file_name_that_is_no_text_can_be_written_and_read() -> None:
    text = render_outcome(outcome(launch_file=Path("/s/caf\udce9 ü.launch.py")))
    document = json.loads(text.encode())
    assert document["packages"][0]["launch_file"] == "/s/caf\udce9 ü.launch.py"
    assert "ü" in text
