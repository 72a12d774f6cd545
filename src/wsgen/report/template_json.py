"""Templates -> the JSON that `wsgen templates --format json` prints; a contract, see `VERSION`."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import has_errors
from wsgen.report.json_report import diagnostic_to_json

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.templating.manifest import Template
    from wsgen.templating.variables import Variable

VERSION = 1  # changes only when a key is taken away or changes its meaning


def render_templates(templates: Iterable[Template]) -> str:
    """The JSON text, with a newline at its end."""
    return _text({"templates": [_template(template) for template in templates]})


def render_template_check(diagnostics: Sequence[Diagnostic]) -> str:
    """The JSON text of what was found in a template, with a newline at its end."""
    return _text(
        {
            "passed": not has_errors(diagnostics),
            "diagnostics": [diagnostic_to_json(found) for found in diagnostics],
        }
    )


def _text(document: dict[str, Any]) -> str:
    return json.dumps({"version": VERSION, **document}, indent=2, ensure_ascii=False) + "\n"


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
    """All keys always there; what a type does not have is null."""
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
