"""The manifest of a template: what can be asked of it, which files it makes, for which simulators.

A template is a folder with a `template.toml`; `templates/simple` is the example to read.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsgen import tomlfile
from wsgen.errors import RequestError
from wsgen.templating.location import templates_folder

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from typing import Any

    from wsgen.model.target import Target

MANIFEST = "template.toml"


@dataclass(frozen=True, kw_only=True)
class Variable:
    """A number that a user may set with `--set NAME=NUMBER`."""

    name: str
    help: str
    unit: str  # SI
    default: float
    minimum: float  # included
    maximum: float  # included


@dataclass(frozen=True, kw_only=True)
class Template:
    """A template, as it is for one target."""

    name: str
    description: str
    variables: tuple[Variable, ...]
    files: Mapping[str, str]  # path in the package -> source below the templates' folder
    dependencies: Mapping[str, tuple[str, ...]]  # as in PackageSpec


def template_names() -> list[str]:
    """The templates that come with wsgen."""
    return sorted(path.parent.name for path in templates_folder().glob(f"*/{MANIFEST}"))


def load_template(name: str, target: Target) -> Template:
    """Read the manifest of a template.

    Raises:
        RequestError: there is no such template, or it is not made for the simulator of the target.
    """
    known = template_names()
    if name not in known:
        raise RequestError(
            f"There is no template {name!r}.", hint=f"Templates: {', '.join(known)}."
        )
    manifest = tomlfile.load(templates_folder() / name / MANIFEST)
    simulators = manifest["simulators"]
    if target.simulator not in simulators:
        raise RequestError(
            f"Template {name!r} is not made for the simulator {target.simulator!r}.",
            hint=f"Take --sim {' or '.join(simulators)}.",
        )
    parts = (manifest, simulators[target.simulator])
    return Template(
        name=name,
        description=manifest["description"],
        variables=tuple(
            _read_variable(variable, table) for variable, table in manifest["variables"].items()
        ),
        files={path: source for part in parts for path, source in part["files"].items()},
        dependencies=_merge_dependencies(part["dependencies"] for part in parts),
    )


def resolve_answers(template: Template, settings: Iterable[str]) -> dict[str, float]:
    """The value of every variable: its default, or what a `NAME=NUMBER` of `settings` says.

    Raises:
        RequestError: no such variable, no number, or a number out of the variable's bounds.
    """
    variables = {variable.name: variable for variable in template.variables}
    answers = {name: variable.default for name, variable in variables.items()}
    for setting in settings:
        name, separator, text = setting.partition("=")
        if not separator or name not in variables:
            known = ", ".join(variables)
            raise RequestError(
                f"--set {setting}: "
                + (
                    f"template {template.name!r} has no variable {name!r}."
                    if separator
                    else "no '='."
                ),
                hint=f"Write --set NAME=NUMBER; the names are {known}.",
            )
        answers[name] = _read_number(variables[name], text, setting)
    return answers


def _read_variable(name: str, table: Mapping[str, Any]) -> Variable:
    return Variable(
        name=name,
        help=table["help"],
        unit=table["unit"],
        default=table["default"],
        minimum=table["minimum"],
        maximum=table["maximum"],
    )


def _merge_dependencies(
    parts: Iterable[Mapping[str, list[str]]],
) -> dict[str, tuple[str, ...]]:
    merged: dict[str, set[str]] = {}
    for part in parts:
        for kind, packages in part.items():
            merged.setdefault(kind, set()).update(packages)
    return {kind: tuple(sorted(packages)) for kind, packages in sorted(merged.items())}


def _read_number(variable: Variable, text: str, setting: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not variable.minimum <= value <= variable.maximum:  # also not-a-number
        raise RequestError(
            f"--set {setting}: {text!r} is no number from {variable.minimum:g} to"
            f" {variable.maximum:g} {variable.unit}.",
            hint=f"For example --set {variable.name}={variable.default:g}.",
        )
    return value
