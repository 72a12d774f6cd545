"""Results -> the JSON that `--format json` prints: one function for each command.

All are contracts, see `VERSION`. Every key is always present, and every text ends with a newline.
"""

from __future__ import annotations

import dataclasses
import json
import math
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import has_errors
from wsgen.text.printable import escape_json

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from pathlib import Path

    from wsgen.building.machine import DoctorReport, Requirement
    from wsgen.building.run import BuildResult
    from wsgen.diagnostics import Diagnostic, Rule
    from wsgen.model.behavior import BehaviorOutcome
    from wsgen.model.outcome import NotValidated, Outcome, PackageOutcome, Rest, RobotOutcome
    from wsgen.model.plan import (
        Include,
        LaunchArgument,
        LaunchPlan,
        Origin,
        Process,
        Unresolved,
    )
    from wsgen.model.transform import Pose
    from wsgen.pipeline.create import CreatedPackage
    from wsgen.templating.spec import Variable
    from wsgen.templating.template import Template


VERSION = 1  # changes only when a key is removed or changes its meaning


def dump_json(document: object) -> str:
    """A document as it is printed and written: two blanks a level, no NaN.

    A file's name may have bytes that are no characters; Python's `os.fsencode` takes the escapes
    back.
    """
    text = json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False)
    return f"{escape_json(text)}\n"


def render_outcome(outcome: Outcome) -> str:
    """An outcome, for `wsgen validate`; docs/json.md lists the keys."""
    document = {
        "version": VERSION,
        "complete": outcome.is_complete,
        "passed": outcome.passed,
        "packages": [_package(package) for package in outcome.packages],
        "not_validated": [_not_validated(one) for one in outcome.not_validated],
    }
    return dump_json(document)


def render_created(created: CreatedPackage) -> str:
    """A package that was written, for `wsgen new`; docs/json.md lists the keys."""
    document = {
        "version": VERSION,
        "package": created.folder.name,
        "path": _path(created.folder),
        "workspace": _path(created.workspace.root),
        "files": list(created.files),
        "workspace_files": list(created.workspace_files),
        "written": created.is_written,
    }
    return dump_json(document)


def render_build(result: BuildResult) -> str:
    """A build, for `wsgen build`; docs/json.md lists the keys."""
    document = {
        "version": VERSION,
        "passed": result.succeeded,
        "packages": [
            {
                "package": package.name,
                "state": package.outcome,
                "seconds": round(package.seconds, 4),
                "left_out": [*package.left_out],
                "needs": [*package.needs],
            }
            for package in result.packages
        ],
        "diagnostics": [diagnostic_to_json(found) for found in result.diagnostics],
        "log": _path(result.log_folder),
        "seconds": round(result.seconds, 4),
    }
    return dump_json(document)


def diagnostic_to_json(diagnostic: Diagnostic) -> dict[str, Any]:
    """One diagnostic."""
    return {
        "code": diagnostic.code,
        "name": diagnostic.name,
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
        "video": _path(package.video),
        "seconds": {stage: round(value, 4) for stage, value in package.seconds.items()},
    }


def _not_validated(one: NotValidated) -> dict[str, Any]:
    return {
        "package": one.package,
        "launch_file": _path(one.launch_file),
        "reason": one.reason,
        "robot_files": [_path(file) for file in one.robot_files],
    }


def _robot(robot: RobotOutcome) -> dict[str, Any]:
    simulated = robot.simulated
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
        "rest": _rest(robot.rest),
        "behaviors": [_behavior(behavior) for behavior in robot.behaviors],
        "engines": [
            {
                "engine": one.engine,
                "version": one.version or None,
                "passed": one.passed,
                "rest": _rest(one.rest),
                "behaviors": [_behaved(behavior) for behavior in one.behaviors],
            }
            for one in robot.engines
        ],
    }


def _rest(rest: Rest | None) -> dict[str, Any] | None:
    if rest is None:
        return None
    return {
        **_pose(rest.pose_in_world),
        "settled_after": rest.settled_after,
        "speed": _number(rest.speed),
        "tilt": _number(rest.tilt),
        "joint_positions": _numbers(dict(rest.joint_positions)),
    }


def _behavior(behavior: BehaviorOutcome) -> dict[str, Any]:
    return {**_behaved(behavior), "expected": _numbers(behavior.task.expected)}


def _behaved(behavior: BehaviorOutcome) -> dict[str, Any]:
    moved, positions = behavior.moved, behavior.positions
    return {
        "name": behavior.name,
        "passed": None if behavior.is_left_out else behavior.passed,
        "moved": None
        if moved is None
        else _numbers(dict(zip(("x", "y", "yaw"), moved, strict=True))),
        "joints": None if positions is None else _numbers(dict(positions)),
        "traveled": None if behavior.traveled is None else _number(behavior.traveled),
        "seconds": behavior.seconds,
        "printed": list(behavior.printed),
    }


def _numbers(values: Mapping[str, float | None]) -> dict[str, float | None]:
    return {name: None if value is None else _number(value) for name, value in values.items()}


def _pose(pose: Pose) -> dict[str, Any]:
    return {
        "xyz": [_number(value) for value in pose.xyz],
        "rpy": [_number(value) for value in pose.rpy],
    }


def _number(value: float) -> float | None:
    """JSON has no infinity and no not-a-number: both are null."""
    return value if math.isfinite(value) else None


def _path(path: Path | None) -> str | None:
    return None if path is None else str(path)


def render_plan(plan: LaunchPlan) -> str:
    """A launch plan, for `wsgen launch`; docs/json.md lists the keys."""
    document = {
        "version": VERSION,
        "package": plan.package,
        "launch_file": str(plan.launch_file),
        "arguments": [_argument(argument) for argument in plan.arguments],
        "processes": [_process(process) for process in plan.processes],
        "includes": [_include(include) for include in plan.includes],
        "environment": dict(plan.environment),
        "unresolved": [_unresolved(entry) for entry in plan.unresolved],
        "files": [
            {"path": str(file.path), "use": file.use, "sha256": file.sha256} for file in plan.files
        ],
        "diagnostics": [diagnostic_to_json(found) for found in plan.diagnostics],
    }
    return dump_json(document)


def _argument(argument: LaunchArgument) -> dict[str, Any]:
    return {
        "name": argument.name,
        "default": argument.default,
        "value": argument.value,
        "description": argument.description,
        "file": _path(argument.origin.file) if argument.origin else None,
        "line": argument.origin.line if argument.origin else None,
        "set_by": argument.set_by,
        "set_at": _origin(argument.set_at),
    }


def _process(process: Process) -> dict[str, Any]:
    return {
        "package": process.package,
        "executable": process.executable,
        "name": process.name,
        "namespace": process.namespace,
        "parameters": {name: _value(value) for name, value in process.parameters.items()},
        "arguments": list(process.arguments),
        "remappings": [list(pair) for pair in process.remappings],
        "parameter_origins": {
            name: _origin(process.parameter_origins.get(name)) for name in process.parameters
        },
        "argument_origins": [_origin(one) for one in process.argument_origins],
        "remapping_origins": [_origin(one) for one in process.remapping_origins],
        "command": None if process.command is None else list(process.command),
        "environment": dict(process.environment),
        "container": process.container,
        "starts": process.starts,
        "start_time": process.start_time,
        "file": _path(process.file),
        "line": process.line,
    }


def _origin(origin: Origin | None) -> dict[str, Any] | None:
    return None if origin is None else {"file": str(origin.file), "line": origin.line}


def _include(include: Include) -> dict[str, Any]:
    return {
        "package": include.package,
        "file": str(include.file),
        "arguments": dict(include.arguments),
        "evaluated": include.evaluated,
    }


def _unresolved(entry: Unresolved) -> dict[str, Any]:
    return {
        "what": entry.what,
        "file": _path(entry.file),
        "line": entry.line,
        "why": entry.why,
    }


def _value(value: Any) -> Any:
    """A parameter; JSON has no infinity and no not-a-number, so these are text, as in YAML."""
    if isinstance(value, list):
        return [_value(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else ("-.inf" if value < 0.0 else ".inf")
    return value


def render_templates(templates: Iterable[Template]) -> str:
    """Templates and their variables, for `wsgen templates`; docs/templates.md lists the keys."""
    return _text({"templates": [_template(template) for template in templates]})


def render_template_check(diagnostics: Sequence[Diagnostic]) -> str:
    """The diagnostics of a template, for `wsgen templates --check`."""
    return _text(
        {
            "passed": not has_errors(diagnostics),
            "diagnostics": [diagnostic_to_json(found) for found in diagnostics],
        }
    )


def _text(document: dict[str, Any]) -> str:
    return dump_json({"version": VERSION, **document})


def _template(template: Template) -> dict[str, Any]:
    return {
        "name": template.name,
        "description": template.description,
        "targets": [
            {"distro": target.distro, "simulator": target.simulator} for target in template.targets
        ],
        "variables": [_variable(variable) for variable in template.variables.values()],
    }


def _variable(variable: Variable) -> dict[str, Any]:
    """A variable; what its type does not have is null."""
    is_number = variable.type in {"number", "integer"}
    return {
        "name": variable.name,
        "help": variable.help,
        "type": variable.type,
        "unit": variable.unit or None,
        "default": variable.default,
        "minimum": _bound(variable.minimum) if is_number else None,
        "maximum": _bound(variable.maximum) if is_number else None,
        "choices": list(variable.choices) or None,
    }


def _bound(value: float) -> float | None:
    return value if math.isfinite(value) else None


def render_doctor_report(report: DoctorReport) -> str:
    """The requirements of wsgen and of ROS, for `wsgen doctor`; docs/doctor.md lists the keys."""
    target = report.target
    document = {
        "version": VERSION,
        "passed": report.passed,
        "target": {
            "distro": target.distro,
            "simulator": target.simulator,
            "ubuntu": target.ubuntu,
            "end_of_life": target.end_of_life,
        },
        "notes": list(report.notes),
        "wsgen": [_requirement(one) for one in report.wsgen],
        "ros": [_requirement(one) for one in report.ros],
        "apt": report.apt,
    }
    return dump_json(document)


def _requirement(one: Requirement) -> dict[str, object]:
    return {
        "name": one.name,
        "met": one.is_met,
        "required": one.is_required,
        "text": one.text,
        "fix": one.fix or None,
    }


def render_rules(rules: Iterable[Rule]) -> str:
    """Rules with their documentation, for `wsgen rule`; docs/json.md lists the keys."""
    document = {
        "version": VERSION,
        "rules": [
            {
                **dataclasses.asdict(rule),
                "severity": rule.severity.value,
                "measured": rule.measured and rule.measured._asdict(),
                "example": rule.example.strip("\n"),
                "instead": rule.instead.strip("\n"),
            }
            for rule in rules
        ],
    }
    return dump_json(document)
