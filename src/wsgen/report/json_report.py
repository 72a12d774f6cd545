"""Outcome -> the JSON that `--format json` prints: of `wsgen validate`, and of `wsgen build`.

Both are contracts, see `VERSION`.
"""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behaviour import BehaviourOutcome
    from wsgen.model.outcome import Outcome, PackageOutcome, RobotOutcome
    from wsgen.model.pose import Pose
    from wsgen.workspace.build import BuildResult

VERSION = 1  # changes only when a key is taken away or changes its meaning


def render_outcome(outcome: Outcome) -> str:
    """The JSON text, with a newline at its end."""
    document = {
        "version": VERSION,
        "complete": outcome.is_complete,
        "passed": outcome.passed,
        "packages": [_package(package) for package in outcome.packages],
    }
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def render_build(result: BuildResult) -> str:
    """The JSON text of a build, with a newline at its end."""
    document = {
        "version": VERSION,
        "passed": result.succeeded,
        "packages": [
            {
                "package": package.name,
                "state": package.outcome,
                "seconds": round(package.seconds, 4),
            }
            for package in result.packages
        ],
        "diagnostics": [diagnostic_to_json(found) for found in result.diagnostics],
        "log": _path(result.log_folder),
        "seconds": round(result.seconds, 4),
    }
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def diagnostic_to_json(diagnostic: Diagnostic) -> dict[str, Any]:
    """One diagnostic, all keys always there."""
    return {
        "code": diagnostic.code,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "file": _path(diagnostic.file),
        "line": diagnostic.line,
        "element": diagnostic.element,
        "hint": diagnostic.hint,
    }


def _package(package: PackageOutcome) -> dict[str, Any]:
    world = package.world
    return {
        "package": package.package,
        "file": _path(package.file),
        "share": _path(package.share),
        "launch_file": _path(package.launch_file),
        "passed": package.passed,
        "world": None
        if world is None
        else {
            "name": world.name,
            "file": _path(world.file),
            "models": [model.name for model in world.models],
            "gravity": list(world.gravity),
        },
        "robots": [_robot(robot) for robot in package.robots],
        "diagnostics": [diagnostic_to_json(found) for found in package.diagnostics],
        "picture": _path(package.picture),
        "world_picture": _path(package.world_picture),
        "film": _path(package.film),
        "seconds": {stage: round(value, 4) for stage, value in package.seconds.items()},
    }


def _robot(robot: RobotOutcome) -> dict[str, Any]:
    simulated, rest = robot.simulated, robot.rest
    return {
        "entity": robot.entity,
        "spawn_pose": _pose(robot.spawn_pose),
        "links": robot.links,
        "joints": robot.joints,
        "movable_joints": robot.movable_joints,
        "mass": _number(robot.mass),
        "simulated": None
        if simulated is None
        else {
            "engine": simulated.engine,
            "links": simulated.links,
            "movable_joints": simulated.movable_joints,
            "mass": _number(simulated.mass),
        },
        "rest": None
        if rest is None
        else {
            **_pose(rest.pose_in_world),
            "settled_after": rest.settled_after,
            "speed": _number(rest.speed),
            "joint_positions": _numbers(dict(rest.joint_positions)),
        },
        "behaviours": [_behaviour(behaviour) for behaviour in robot.behaviours],
    }


def _behaviour(behaviour: BehaviourOutcome) -> dict[str, Any]:
    moved, positions = behaviour.moved, behaviour.positions
    return {
        "name": behaviour.name,
        "passed": behaviour.passed,
        "moved": None
        if moved is None
        else _numbers(dict(zip(("x", "y", "yaw"), moved, strict=True))),
        "joints": None if positions is None else _numbers(dict(positions)),
        "expected": _numbers(behaviour.task.expected),
    }


def _numbers(values: Mapping[str, float | None]) -> dict[str, float | None]:
    return {name: None if value is None else _number(value) for name, value in values.items()}


def _pose(pose: Pose) -> dict[str, Any]:
    return {
        "xyz": [_number(value) for value in pose.xyz],
        "rpy": [_number(value) for value in pose.rpy],
    }


def _number(value: float) -> float | None:
    """JSON has no infinity and no not-a-number: null says that there is no usable value."""
    return value if math.isfinite(value) else None


def _path(path: Path | None) -> str | None:
    return None if path is None else str(path)
