"""LaunchPlan -> the JSON that `wsgen launch --format json` prints; a contract, see `VERSION`."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from wsgen.report.json_report import diagnostic_to_json

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.plan import Include, LaunchArgument, LaunchPlan, Process, Unresolved

VERSION = 1  # changes only when a key is taken away or changes its meaning


def render_plan(plan: LaunchPlan) -> str:
    """The JSON text, with a newline at its end; all keys are always there."""
    document = {
        "version": VERSION,
        "package": plan.package,
        "launch_file": str(plan.launch_file),
        "arguments": [_argument(argument) for argument in plan.arguments],
        "processes": [_process(process) for process in plan.processes],
        "includes": [_include(include) for include in plan.includes],
        "environment": dict(plan.environment),
        "unresolved": [_unresolved(entry) for entry in plan.unresolved],
        "diagnostics": [diagnostic_to_json(found) for found in plan.diagnostics],
    }
    return json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _argument(argument: LaunchArgument) -> dict[str, Any]:
    return {
        "name": argument.name,
        "default": argument.default,
        "value": argument.value,
        "description": argument.description,
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
        "command": None if process.command is None else list(process.command),
        "environment": dict(process.environment),
        "container": process.container,
        "starts": process.starts,
        "start_time": process.start_time,
        "file": _path(process.file),
        "line": process.line,
    }


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
    """A parameter; JSON has no infinity and no not-a-number, so these are words, as in YAML."""
    if isinstance(value, list):
        return [_value(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return ".nan" if math.isnan(value) else ("-.inf" if value < 0.0 else ".inf")
    return value


def _path(path: Path | None) -> str | None:
    return None if path is None else str(path)
