"""All rules, collected from the modules that define them, and what a package allows of them.

What is allowed on purpose is not reported; what allows nothing is.
"""

from __future__ import annotations

import functools
import importlib
import sys
from pathlib import PurePath
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.text.files import real_path
from wsgen.text.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.packages.workspace.settings import Allowance


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
    "wsgen.launching.evaluate",
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
    "wsgen.launching.launch_warnings",
    "wsgen.descriptions.meshes.inspection",
    "wsgen.descriptions.meshes.requests",
    "wsgen.descriptions.meshes.shape_meshes",
    "wsgen.live.plan_checks",
    "wsgen.pipeline.changed_since_build",
    "wsgen.pipeline.file_validation",
    "wsgen.pipeline.gazebo_models",
    "wsgen.pipeline.prepare",
    "wsgen.simulation.run",
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
    "wsgen.checks.rules.drives",
    "wsgen.checks.rules.joint_limits",
    "wsgen.checks.rules.launch_files",
    "wsgen.checks.rules.lumped",
    "wsgen.checks.rules.manifests",
    "wsgen.checks.rules.robot_files",
    "wsgen.checks.rules.worlds",
    "wsgen.checks.rules.package_uses",
    "wsgen.checks.rules.node_topics",
    "wsgen.checks.rules.python_nodes",
    "wsgen.checks.rules.plugins",
    "wsgen.checks.rules.robots",
    "wsgen.checks.rules.ros2_control",
    "wsgen.checks.rules.runs",
    "wsgen.checks.rules.settings",
    "wsgen.checks.rules.simulators",
    "wsgen.checks.rules.systems",
    "wsgen.descriptions.sdf.assembly",
    "wsgen.descriptions.sdf.bodies",
    "wsgen.descriptions.sdf.frames",
    "wsgen.descriptions.sdf.includes",
    "wsgen.descriptions.sdf.joints",
    "wsgen.descriptions.sdf.models",
    "wsgen.descriptions.sdf.worlds",
    "wsgen.descriptions.sdf.shapes",
    "wsgen.descriptions.sdf.source",
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


ALLOWED_WITHOUT_REASON = Rule(
    code="PKG100",
    name="allowed-without-reason",
    severity=Severity.WARNING,
    summary="A rule is allowed without a reason.",
    what="Looks at `[check.allow]` of `wsgen.toml` and at comments `wsgen: allow RULE: REASON`. "
    "Without a reason the diagnostic is still reported.",
    why="Readers of the file cannot distinguish intended exceptions from silenced errors.",
    example="<!-- wsgen: allow no-visual -->",
    instead="<!-- wsgen: allow no-visual: the gripper is drawn by its driver -->",
)
UNUSED_ALLOWANCE = Rule(
    code="PKG101",
    name="unused-allowance",
    severity=Severity.WARNING,
    summary="A rule is allowed where it reports nothing.",
    what="Looks at `[check.allow]` of `wsgen.toml` and at comments `wsgen: allow RULE: REASON`. "
    "Rules about simulations and builds are left out: `wsgen check` does neither.",
    why="It would hide the next error of this kind, and its reason is out of date.",
    example='[check.allow]\nno-visual = "the base is drawn by its driver"  # it has a <visual>',
    instead="[check.allow]",
)

# What `wsgen check` does not look for: simulations, and the run of a build.
ELSEWHERE = ("SPN", "TPL", "RUN")
# What depends on the machine: elsewhere the allowance may be needed.
OF_MACHINE = frozenset(
    (
        *("launch-import", "not-installed-here", "package-not-found", "source-used"),
        *("variable-not-set", "world-not-here", "models-of-gazebo"),
    )
)


class Suppressed(NamedTuple):
    """What is left of diagnostics, and what is wrong with what allows the others."""

    reported: tuple[Diagnostic, ...]
    allowed: tuple[Diagnostic, ...]


def suppress(
    diagnostics: Iterable[Diagnostic],
    allowances: Sequence[Allowance],
    *,
    read: Collection[Path] | None = None,
) -> Suppressed:
    """Leave out what is allowed, and report what is wrong with the allowances.

    Args:
        diagnostics: what is reported, with the places in the sources
        allowances: of `wsgen.toml` and of comments
        read: the files and folders that were checked; None: all of them, so that each allowance
            must have been used
    """
    used: set[Allowance] = set()
    reported, allowed = [], []
    by_rule = _by_rule(allowances)
    for found in diagnostics:
        those = [
            one
            for one in (*by_rule.get(found.name, ()), *by_rule.get(found.code, ()))
            if _covers(one, found)
        ]
        used.update(those)
        if any(one.reason for one in those):
            allowed.append(found)
        else:
            reported.append(found)
    places = None if read is None else [real_path(place) for place in read]
    for one in allowances:
        file = PurePath(real_path(one.file))
        is_read = places is None or any(file.is_relative_to(place) for place in places)
        reported += _check(one, is_used=one in used or not is_read)
    return Suppressed(tuple(reported), tuple(allowed))


def _by_rule(allowances: Iterable[Allowance]) -> dict[str, list[Allowance]]:
    found: dict[str, list[Allowance]] = {}
    for one in allowances:
        found.setdefault(one.rule, []).append(one)
    return found


def _covers(one: Allowance, found: Diagnostic) -> bool:
    """Whether an allowance is about the place of a diagnostic of its rule."""
    if found.file is None:
        return False
    # A package may be given by a link, and what includes a file says where it really is.
    file, place = PurePath(real_path(found.file)), PurePath(real_path(one.file))
    if one.lines is not None:
        first, last = one.lines
        return file == place and first <= (found.line or 0) <= last
    if not file.is_relative_to(place.parent):
        return False
    inside = file.relative_to(place.parent)
    return not one.patterns or any(inside.match(pattern) for pattern in one.patterns)


def _check(one: Allowance, *, is_used: bool) -> Iterator[Diagnostic]:
    """What is wrong with an allowance."""
    rule = find_rule(one.rule)
    if rule is None or one.rule not in {rule.name, rule.code}:
        near = nearest(one.rule, [rule.name for rule in all_rules()])
        yield UNKNOWN_RULE_ALLOWED.at(
            one.file,
            one.line,
            None if one.lines else "check.allow",
            message=f"The allowed rule {one.rule!r} does not exist.",
            hint=did_you_mean(near) if near else "Run `wsgen rule` to list the names.",
        )
    elif not one.reason:
        yield ALLOWED_WITHOUT_REASON.at(
            one.file,
            one.line,
            None if one.lines else "check.allow",
            message=f"`{one.rule}` is allowed without a reason, and is still reported.",
            hint=f"Write why: `wsgen: allow {one.rule}: REASON`."
            if one.lines
            else f'Write why: {one.rule} = "REASON".',
        )
    elif not is_used and not rule.code.startswith(ELSEWHERE) and rule.name not in OF_MACHINE:
        yield UNUSED_ALLOWANCE.at(
            one.file,
            one.line,
            None if one.lines else "check.allow",
            message=f"`{one.rule}` is allowed, but the rule reports nothing here.",
            hint="Remove the comment." if one.lines else "Remove the line.",
        )
