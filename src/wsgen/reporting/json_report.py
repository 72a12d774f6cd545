"""Results -> the JSON that `--format json` prints: one function for each command.

All are contracts, see `VERSION`. Every key is always present, and every text ends with a newline.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import has_errors
from wsgen.text.printable import escape_json

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.building.machine import DoctorReport, Requirement
    from wsgen.building.run import BuildResult
    from wsgen.diagnostics import Diagnostic, Rule
    from wsgen.model.behavior import BehaviorOutcome
    from wsgen.model.outcome import Outcome, PackageOutcome, Rest, RobotOutcome
    from wsgen.model.plan import LaunchArgument, LaunchPlan, Origin, Process
    from wsgen.model.transform import Pose
    from wsgen.pipeline.create import CreatedPackage
    from wsgen.porting.existing.package import ExistingRobot
    from wsgen.porting.plan import PortPlan
    from wsgen.porting.proof import Proof
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


def fields(value: object, names: str) -> dict[str, Any]:
    """Attributes of a value by their names, which have blanks between them, as JSON has them."""
    return {name: _plain(getattr(value, name)) for name in names.split()}


def _plain(value: Any) -> Any:
    """What JSON has of a value: infinity and not-a-number are null, paths are texts."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, (list, tuple)):
        return [_plain(one) for one in value]
    if isinstance(value, Mapping):
        return {name: _plain(one) for name, one in value.items()}
    if isinstance(value, Enum):
        return value.value
    return str(value) if isinstance(value, Path) else value


def _document(**values: Any) -> str:
    return dump_json({"version": VERSION, **values})


def _seconds(value: float) -> float:
    return round(value, 4)


def render_outcome(outcome: Outcome) -> str:
    """An outcome, for `wsgen validate`; docs/json.md lists the keys."""
    return _document(
        complete=outcome.is_complete,
        passed=outcome.passed,
        packages=[_package(package) for package in outcome.packages],
        not_validated=[
            fields(one, "package launch_file reason robot_files") for one in outcome.not_validated
        ],
    )


def render_created(created: CreatedPackage, existing: ExistingRobot | None = None) -> str:
    """A package that was written, for `wsgen new`; docs/json.md lists the keys."""
    robot = {} if existing is None else {"robot": _existing(existing)}
    return _document(
        package=created.folder.name,
        path=_plain(created.folder),
        workspace=_plain(created.workspace.root),
        **fields(created, "files workspace_files"),
        written=created.is_written,
        **robot,
    )


def _existing(robot: ExistingRobot) -> dict[str, Any]:
    rows = [
        {
            "same": row.is_same,
            "fixed": row.is_fixed,
            **fields(row, "aspect source package differing"),
        }
        for row in robot.rows
    ]
    return {
        **fields(robot, "source kind notes fixes fixable"),
        "same": robot.is_same,
        "comparison": rows,
        "not_in_package": [fields(one, "file line what advice") for one in robot.unported],
        "diagnostics": _diagnostics(robot.diagnostics),
    }


def render_build(result: BuildResult) -> str:
    """A build, for `wsgen build`; docs/json.md lists the keys."""
    return _document(
        passed=result.succeeded,
        packages=[
            {
                "package": package.name,
                "state": package.outcome,
                "seconds": _seconds(package.seconds),
                **fields(package, "left_out needs"),
            }
            for package in result.packages
        ],
        diagnostics=_diagnostics(result.diagnostics),
        log=_plain(result.log_folder),
        seconds=_seconds(result.seconds),
    )


def diagnostic_to_json(diagnostic: Diagnostic) -> dict[str, Any]:
    """One diagnostic."""
    return fields(diagnostic, "code name severity message file line element hint")


def _diagnostics(found: Iterable[Diagnostic]) -> list[dict[str, Any]]:
    return [diagnostic_to_json(one) for one in found]


def _package(package: PackageOutcome) -> dict[str, Any]:
    world = package.world
    return {
        **fields(package, "package file share launch_file passed"),
        "world": world
        and {
            **fields(world, "name file"),
            "models": [model.name for model in world.models],
            **fields(world, "gravity"),
        },
        "robots": [_robot(robot) for robot in package.robots],
        "diagnostics": _diagnostics(package.diagnostics),
        **fields(package, "picture world_picture video"),
        "seconds": {stage: _seconds(value) for stage, value in package.seconds.items()},
    }


def _robot(robot: RobotOutcome) -> dict[str, Any]:
    return {
        "entity": robot.entity,
        "spawn_pose": _pose(robot.spawn_pose),
        **fields(robot, "links joints movable_joints mass"),
        "simulated": robot.simulated
        and fields(robot.simulated, "engine links movable_joints mass"),
        "rest": _rest(robot.rest),
        "behaviors": [
            {**_behaved(one), "expected": _plain(one.task.expected)} for one in robot.behaviors
        ],
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
    of_rest = fields(rest, "settled_after speed tilt joint_positions")
    return {**_pose(rest.pose_in_world), **of_rest}


def _behaved(behavior: BehaviorOutcome) -> dict[str, Any]:
    moved = behavior.moved
    return {
        "name": behavior.name,
        "passed": None if behavior.is_left_out else behavior.passed,
        "moved": moved and _plain(dict(zip(("x", "y", "yaw"), moved, strict=True))),
        "joints": _plain(behavior.positions),
        **fields(behavior, "traveled seconds printed"),
    }


def _pose(pose: Pose) -> dict[str, Any]:
    return fields(pose, "xyz rpy")


def render_plan(plan: LaunchPlan) -> str:
    """A launch plan, for `wsgen launch`; docs/json.md lists the keys."""
    return _document(
        **fields(plan, "package launch_file"),
        arguments=[_argument(argument) for argument in plan.arguments],
        processes=[_process(process) for process in plan.processes],
        includes=[fields(one, "package file arguments evaluated") for one in plan.includes],
        **fields(plan, "environment"),
        unresolved=[fields(one, "what file line why") for one in plan.unresolved],
        files=[fields(file, "path use sha256") for file in plan.files],
        diagnostics=_diagnostics(plan.diagnostics),
    )


def _argument(argument: LaunchArgument) -> dict[str, Any]:
    return {
        **fields(argument, "name default value description"),
        **(_origin(argument.origin) or {"file": None, "line": None}),
        "set_by": argument.set_by,
        "set_at": _origin(argument.set_at),
    }


def _process(process: Process) -> dict[str, Any]:
    origins = process.parameter_origins
    return {
        **fields(process, "package executable name namespace"),
        "parameters": {name: _value(value) for name, value in process.parameters.items()},
        **fields(process, "arguments remappings"),
        "parameter_origins": {name: _origin(origins.get(name)) for name in process.parameters},
        "argument_origins": [_origin(one) for one in process.argument_origins],
        "remapping_origins": [_origin(one) for one in process.remapping_origins],
        **fields(process, "command environment container starts start_time file line"),
    }


def _origin(origin: Origin | None) -> dict[str, Any] | None:
    return None if origin is None else fields(origin, "file line")


def _value(value: Any) -> Any:
    """A parameter; JSON has no infinity and no not-a-number, so these are text, as in YAML."""
    if isinstance(value, list):
        return [_value(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else ("-.inf" if value < 0.0 else ".inf")
    return value


def render_templates(templates: Iterable[Template]) -> str:
    """Templates and their variables, for `wsgen templates`; docs/templates.md lists the keys."""
    return _document(
        templates=[
            {
                **fields(template, "name description"),
                "targets": [fields(target, "distro simulator") for target in template.targets],
                "variables": [_variable(variable) for variable in template.variables.values()],
            }
            for template in templates
        ]
    )


def render_template_check(diagnostics: Sequence[Diagnostic]) -> str:
    """The diagnostics of a template, for `wsgen templates --check`."""
    return _document(passed=not has_errors(diagnostics), diagnostics=_diagnostics(diagnostics))


def _variable(variable: Variable) -> dict[str, Any]:
    """A variable; what its type does not have is null."""
    is_number = variable.type in {"number", "integer"}
    return {
        **fields(variable, "name help type"),
        "unit": variable.unit or None,
        "default": variable.default,
        **(
            fields(variable, "minimum maximum") if is_number else {"minimum": None, "maximum": None}
        ),
        "choices": list(variable.choices) or None,
    }


def render_doctor_report(report: DoctorReport) -> str:
    """The requirements of wsgen and of ROS, for `wsgen doctor`; docs/doctor.md lists the keys."""
    return _document(
        passed=report.passed,
        target=fields(report.target, "distro simulator ubuntu end_of_life"),
        **fields(report, "notes"),
        wsgen=[_requirement(one) for one in report.wsgen],
        ros=[_requirement(one) for one in report.ros],
        apt=report.apt,
    )


def _requirement(one: Requirement) -> dict[str, object]:
    return {
        "name": one.name,
        "met": one.is_met,
        "required": one.is_required,
        "text": one.text,
        "fix": one.fix or None,
    }


def render_port(plan: PortPlan, *, is_written: bool) -> str:
    """What a port changes and leaves, for `wsgen port`; docs/json.md lists the keys."""
    return _document(
        written=is_written,
        packages=list(plan.packages),
        files=[
            *({"path": _plain(file), "new": True} for file, _ in plan.created),
            *({"path": _plain(fix.file), "new": False} for fix in plan.files),
        ],
        left=[
            {**fields(one, "file line what advice"), "note": one.is_note} for one in plan.unported
        ],
    )


def render_proof(proof: Proof) -> str:
    """Robots before and after a port, for `wsgen port --check`; docs/json.md lists the keys."""
    robots: dict[str, list[dict[str, Any]]] = {}
    for row in proof.rows:
        aspects = robots.setdefault(row.robot, [])
        found = {**fields(row, "aspect before after"), "same": row.is_same}
        if row.is_detail:
            aspects[-1]["details"].append(found)
        else:
            aspects.append({**found, **fields(row, "difference"), "details": []})
    return _document(
        **fields(proof, "passed before"),
        robots=[{"robot": robot, "aspects": aspects} for robot, aspects in robots.items()],
    )


def render_rules(rules: Iterable[Rule]) -> str:
    """Rules with their documentation, for `wsgen rule`; docs/json.md lists the keys."""
    return _document(
        rules=[
            {
                **dataclasses.asdict(rule),
                "severity": rule.severity.value,
                "measured": rule.measured and rule.measured._asdict(),
                "example": rule.example.strip("\n"),
                "instead": rule.instead.strip("\n"),
            }
            for rule in rules
        ]
    )
