"""All rules, collected from the modules that define them, and those that a package allows."""

from __future__ import annotations

import functools
import importlib
import sys
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.text.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator
    from pathlib import Path


# In the order of the documentation.
FAMILIES = {
    "PKG": "The package",
    "BLD": "The build",
    "ROB": "Robots",
    "WLD": "SDF: worlds, models and meshes",
    "LCH": "Launch files",
    "SPN": "Spawning and simulation",
    "TPL": "Templates",
}

# The modules that define rules; some of them are above this one in the diagram.
MODULES = (
    "wsgen.building.causes",
    "wsgen.building.explain",
    "wsgen.building.installed",
    "wsgen.building.last_build",
    "wsgen.building.run",
    "wsgen.building.left_out",
    "wsgen.packages.build_files.cmake_checks",
    "wsgen.packages.build_files.install_checks",
    "wsgen.packages.build_files.python_checks",
    "wsgen.packages.build_files.python_sources",
    "wsgen.descriptions.rules",
    "wsgen.launching.alternatives",
    "wsgen.launching.commands",
    "wsgen.launching.descriptions",
    "wsgen.launching.evaluate",
    "wsgen.launching.explain",
    "wsgen.launching.explain_missing",
    "wsgen.launching.explain_names",
    "wsgen.launching.launch_warnings",
    "wsgen.launching.package_lookup",
    "wsgen.launching.simulators",
    "wsgen.launching.spawner_options",
    "wsgen.launching.spawning",
    "wsgen.launching.undeclared",
    "wsgen.launching.vain_handlers",
    "wsgen.descriptions.meshes.inspection",
    "wsgen.descriptions.meshes.requests",
    "wsgen.descriptions.meshes.shape_meshes",
    "wsgen.live.plan_checks",
    "wsgen.pipeline.changed_since_build",
    "wsgen.pipeline.file_validation",
    "wsgen.pipeline.gazebo_models",
    "wsgen.pipeline.prepare",
    "wsgen.pipeline.engines",
    "wsgen.pipeline.run_robots",
    "wsgen.pipeline.selection",
    "wsgen.pipeline.started",
    "wsgen.pipeline.template_check",
    "wsgen.checks.rules.behaviors",
    "wsgen.checks.rules.bodies",
    "wsgen.checks.rules.bridges",
    "wsgen.checks.rules.catalogue",
    "wsgen.checks.rules.controller_joints",
    "wsgen.checks.rules.controllers",
    "wsgen.checks.rules.dependencies",
    "wsgen.checks.rules.entities",
    "wsgen.checks.rules.frames",
    "wsgen.checks.rules.friction",
    "wsgen.checks.rules.drives",
    "wsgen.checks.rules.joint_limits",
    "wsgen.checks.rules.joint_states",
    "wsgen.checks.rules.launch_files",
    "wsgen.checks.rules.lumped",
    "wsgen.checks.rules.manifests",
    "wsgen.checks.rules.materials",
    "wsgen.checks.rules.mesh_addresses",
    "wsgen.checks.rules.named_worlds",
    "wsgen.checks.rules.package_uses",
    "wsgen.checks.rules.parameter_files",
    "wsgen.checks.rules.node_topics",
    "wsgen.checks.rules.python_nodes",
    "wsgen.checks.rules.controller_parameters",
    "wsgen.checks.rules.plugins",
    "wsgen.checks.rules.robot_files",
    "wsgen.checks.rules.resource_paths",
    "wsgen.checks.rules.robots",
    "wsgen.checks.rules.ros2_control",
    "wsgen.checks.rules.runs",
    "wsgen.checks.rules.settings",
    "wsgen.checks.rules.simulators",
    "wsgen.checks.rules.systems",
    "wsgen.checks.rules.worlds",
    "wsgen.checks.rules.damping",
    "wsgen.checks.rules.suppressions",
    "wsgen.descriptions.sdf.assembly",
    "wsgen.descriptions.sdf.bodies",
    "wsgen.descriptions.sdf.frames",
    "wsgen.descriptions.sdf.includes",
    "wsgen.descriptions.sdf.joints",
    "wsgen.descriptions.sdf.models",
    "wsgen.descriptions.sdf.worlds",
    "wsgen.descriptions.sdf.shapes",
    "wsgen.descriptions.sdf.source",
    "wsgen.simulation.run",
    "wsgen.templating.render",
    "wsgen.templating.template",
    "wsgen.descriptions.urdf.gazebo",
    "wsgen.descriptions.urdf.joints",
    "wsgen.descriptions.urdf.links",
    "wsgen.descriptions.urdf.lumping",
    "wsgen.descriptions.urdf.reader",
    "wsgen.descriptions.urdf.sensors",
    "wsgen.descriptions.urdf.structure",
    "wsgen.packages.workspace.package_xml",
    "wsgen.packages.workspace.manifest",
    "wsgen.packages.workspace.overlay",
    "wsgen.packages.workspace.settings",
    "wsgen.descriptions.xacro.reader",
)


@functools.cache
def all_rules() -> tuple[Rule, ...]:
    """Every rule, by family and code."""
    return collect(rule for module in MODULES for rule in _rules_in(module))


@functools.cache
def _rules_in(module: str) -> tuple[Rule, ...]:
    names = vars(importlib.import_module(module)).values()
    return tuple(value for value in names if isinstance(value, Rule))


def collect(found: Iterable[Rule]) -> tuple[Rule, ...]:
    """Each rule once, in order.

    Raises:
        ValueError: Two rules have one code or one name, or a code is of no family.
    """
    by_code: dict[str, Rule] = {}
    names: dict[str, Rule] = {}
    for rule in found:
        if rule.code[:3] not in FAMILIES:
            raise ValueError(f"{rule.code} does not belong to a family of rules.")
        if by_code.setdefault(rule.code, rule) is not rule:
            raise ValueError(f"{rule.code} is the code of two rules.")
        if names.setdefault(rule.name, rule) is not rule:
            raise ValueError(f"{rule.name} is the name of two rules.")
    families = list(FAMILIES)
    return tuple(
        sorted(by_code.values(), key=lambda rule: (families.index(rule.code[:3]), rule.code))
    )


def find_rule(name: str) -> Rule | None:
    """The rule with that code or name, capitals or not.

    Modules that are loaded already are searched first: importing all takes longer than to validate
    a small package.
    """
    wanted = name.strip()
    loaded = [rule for module in MODULES if module in sys.modules for rule in _rules_in(module)]
    return _select(wanted, loaded) or _select(wanted, all_rules())


def _select(wanted: str, rules: Iterable[Rule]) -> Rule | None:
    for rule in rules:
        if wanted.upper() == rule.code or wanted.lower() == rule.name:
            return rule
    return None


def to_markdown(rule: Rule, *, has_fix: bool = False) -> str:
    """The documentation of a rule: a section for docs/rules.md, and what `wsgen rule` shows."""
    severity = rule.severity.value
    if rule.severity_varies:
        severity = f"{severity}; {rule.severity_varies}"
    fix = (
        " `wsgen check --fix` fixes it where the text makes the intention clear." if has_fix else ""
    )
    parts = [f"## {rule.name} ({rule.code})", rule.summary, f"Severity: {severity}.{fix}"]
    if rule.what:
        parts += ["**What it checks.** " + rule.what]
    parts += ["**Why is this bad?** " + rule.why]
    if rule.measured:
        classic, sim = rule.measured
        parts += [
            f"**Measured.** Gazebo Classic 11 {classic}; sdformat 12, Gazebo Sim's parser, {sim}."
        ]
    parts += ["**Example**", _code(rule.example), "**Use instead**", _code(rule.instead)]
    return "\n\n".join(parts) + "\n"


def _code(text: str) -> str:
    """A block of code; a text that is a sentence stays one."""
    text = text.strip("\n")
    if text.endswith(".") and "\n" not in text:
        return text
    language = "xml" if text.lstrip().startswith("<") else ""
    return f"```{language}\n{text}\n```"


UNKNOWN_RULE_ALLOWED = Rule(
    code="PKG061",
    name="unknown-rule-allowed",
    severity=Severity.WARNING,
    summary="`wsgen.toml` allows a rule that does not exist.",
    what="Compares the names in `allow` of `wsgen.toml` with all rules.",
    why="A misspelled name has no effect.",
    example='[validate]\nallow = ["masless-root"]',
    instead='[validate]\nallow = ["massless-root"]',
)


def without_allowed(
    diagnostics: Iterable[Diagnostic], allow: Collection[str]
) -> tuple[Diagnostic, ...]:
    """The diagnostics without those whose rule is allowed by name or code; errors always stay."""
    return tuple(
        found
        for found in diagnostics
        if found.severity is Severity.ERROR or not (found.name in allow or found.code in allow)
    )


def unknown_rule_allowed(
    allow: Iterable[str], file: Path, line: int | None = None
) -> Iterator[Diagnostic]:
    """Report the names in `allow` that no rule has."""
    for name in allow:
        rule = find_rule(name)
        if rule is None or name not in {rule.name, rule.code}:
            near = nearest(name, [rule.name for rule in all_rules()])
            yield UNKNOWN_RULE_ALLOWED.at(
                file,
                line,
                "validate.allow",
                message=f"The allowed rule {name!r} does not exist.",
                hint=did_you_mean(near) if near else "Run `wsgen rule` to list the names.",
            )
