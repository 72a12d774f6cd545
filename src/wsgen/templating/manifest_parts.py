"""What a `template.toml` says of variables, targets, and files that exist under a condition."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.model.names import PYTHON_KEYWORDS, check_package_name
from wsgen.model.target import SIMULATORS, TARGETS
from wsgen.templating.sources import SHIPPED
from wsgen.templating.variables import TYPES, Variable

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.package import Answer
    from wsgen.model.target import Target
    from wsgen.templating.manifest_file import ManifestFile

DEPENDENCIES = (
    "build_depend",
    "build_export_depend",
    "buildtool_depend",
    "buildtool_export_depend",
    "depend",
    "doc_depend",
    "exec_depend",
    "test_depend",
)
VARIABLE_KEYS = ("help", "type", "unit", "default", "minimum", "maximum", "choices")
PART_KEYS = ("when", "files", "dependencies")
# What a condition may name besides variables.
TARGET_WORDS = ("distro", "simulator")


class Part(NamedTuple):
    """Files and dependencies that belong to a package under one condition."""

    when: Mapping[str, tuple[Answer, ...]]  # variable, distro or simulator -> values that will do
    files: Mapping[str, str]  # pattern of the path in the package -> name of the source
    dependencies: Mapping[str, tuple[str, ...]]  # as in PackageSpec

    def holds(self, target: Target, answers: Mapping[str, Answer]) -> bool:
        """Whether the condition is met."""
        values = {"distro": target.distro, "simulator": target.simulator, **answers}
        return all(values[name] in wanted for name, wanted in self.when.items())


def read_variables(
    manifest: ManifestFile, tables: Mapping[str, Mapping[str, Any]]
) -> dict[str, Variable]:
    """The variables of a template from their tables, those that it takes over included."""
    variables = {}
    for name, table in tables.items():
        # `package.answers.NAME` must mean the answer, and xacro must take NAME for a property.
        if (
            not re.fullmatch(r"[a-z][a-z0-9_]*", name)
            or name in PYTHON_KEYWORDS
            or name in TARGET_WORDS
            or hasattr(dict, name)
        ):
            manifest.wrong(
                f"A variable cannot be called `{name}`.",
                "Take lower-case letters a to z, digits and underscores, and no keyword of Python.",
                *("variables", name),
            )
        else:
            variable = _read_variable(manifest, name, table)
            if variable is not None:
                variables[name] = variable
    return variables


def _read_variable(manifest: ManifestFile, name: str, table: Mapping[str, Any]) -> Variable | None:
    where = ("variables", name)
    before = len(manifest.faults)
    manifest.check_keys(table, VARIABLE_KEYS, *where)
    kind = table.get("type")
    needed = {"help", "type", "default"}
    if kind not in TYPES:
        manifest.wrong(f"There is no type {kind!r}.", f"Types: {', '.join(TYPES)}.", *where, "type")
    elif kind in {"number", "integer"}:
        needed |= {"minimum", "maximum"} | ({"unit"} if kind == "number" else set())
    elif kind == "choice":
        needed |= {"choices"}
    for key in sorted(needed - set(table)):
        manifest.wrong(f"The variable `{name}` has no `{key}`.", f"Add a line: {key} = ...", *where)
    variable = Variable(
        name=name,
        help=manifest.take(table, str, *where, "help", default=""),
        type=str(kind),
        default=_number(table.get("default"), str(kind)),
        unit=manifest.take(table, str, *where, "unit", default=""),
        minimum=_bound(manifest, table, *where, "minimum"),
        maximum=_bound(manifest, table, *where, "maximum"),
        choices=manifest.take_texts(table, *where, "choices"),
    )
    if len(manifest.faults) == before and not variable.accepts(variable.default):
        manifest.wrong(
            f"The default {variable.default!r} of `{name}` is no {variable.wanted}.",
            "Change the default, or what is wanted.",
            *where,
            "default",
        )
    return variable if len(manifest.faults) == before else None


def _number(value: Any, kind: str) -> Any:
    """A number of TOML may be written without a point."""
    return float(value) if kind == "number" and type(value) is int else value


def _bound(manifest: ManifestFile, table: Mapping[str, Any], *where: str) -> float:
    bound = table.get(where[-1], 0.0)
    if isinstance(bound, bool) or not isinstance(bound, (int, float)):
        manifest.wrong(f"`{where[-1]}` is no number.", "Write a number.", *where)
        return 0.0
    return bound


def read_targets(manifest: ManifestFile) -> tuple[Target, ...]:
    """The targets that a template is made for; all, where it does not say."""
    words = manifest.take_texts(manifest.document, "targets")
    known = {word for target in TARGETS for word in (target.name, target.distro, target.simulator)}
    for word in words:
        if word not in known:
            manifest.wrong(
                f"There is no target {word!r}.",
                f"Write a simulator ({', '.join(SIMULATORS)}), a distribution (jazzy), or both"
                " (jazzy-gz).",
                "targets",
            )
    if "targets" not in manifest.document:
        return TARGETS
    if manifest.document["targets"] == []:
        manifest.wrong("`targets` names none.", "Leave it out for all of them.", "targets")
    return tuple(
        target for target in TARGETS if {target.name, target.distro, target.simulator} & set(words)
    )


def read_parts(manifest: ManifestFile, variables: Mapping[str, Variable], own: str) -> list[Part]:
    """The unconditional part of a template, then the others; `own` qualifies its sources."""
    document = manifest.document
    parts = [_read_part(manifest, document, {}, own)]
    for index, table in enumerate(manifest.take(document, list, "parts", default=[])):
        where = ("parts", str(index))
        if not isinstance(table, dict):
            manifest.wrong("A part is no table.", "Write it below [[parts]].", "parts")
            continue
        manifest.check_keys(table, PART_KEYS, *where)
        when = _read_condition(manifest, table, variables, *where, "when")
        parts.append(_read_part(manifest, table, when, own, *where))
    return parts


def _read_part(
    manifest: ManifestFile,
    table: Mapping[str, Any],
    when: Mapping[str, tuple[Answer, ...]],
    own: str,
    *where: str,
) -> Part:
    files = {}
    for path, source in manifest.take(table, dict, *where, "files", default={}).items():
        if not isinstance(source, str):
            manifest.wrong(
                f"The source of {path!r} is no text.",
                'Write: "path/in/the/package" = "source.j2"',
                *(*where, "files", path),
            )
        else:
            files[path] = source if source.startswith(SHIPPED) else own + source
    dependencies = {}
    needed = manifest.take(table, dict, *where, "dependencies", default={})
    manifest.check_keys(needed, DEPENDENCIES, *where, "dependencies")
    for kind in needed:
        if kind in DEPENDENCIES:
            names = manifest.take_texts(needed, *where, "dependencies", kind)
            dependencies[kind] = names
            for name in names:
                _check_dependency(manifest, name, *where, "dependencies", kind)
    return Part(when, files, dependencies)


def _check_dependency(manifest: ManifestFile, name: str, *where: str) -> None:
    # A rosdep key of the system, python3-numpy, has dashes.
    problem = check_package_name(re.sub(r"[-.]", "_", name))
    if problem is not None:
        manifest.wrong(f"The dependency {name!r} {problem}.", "Name a ROS package.", *where)


def _read_condition(
    manifest: ManifestFile,
    table: Mapping[str, Any],
    variables: Mapping[str, Variable],
    *where: str,
) -> dict[str, tuple[Answer, ...]]:
    condition: dict[str, tuple[Answer, ...]] = {}
    for name, value in manifest.take(table, dict, *where, default={}).items():
        values = tuple(value) if isinstance(value, list) else (value,)
        if name in variables:
            usable = all(variables[name].accepts(one) for one in values)
            wanted = variables[name].wanted
        elif name in TARGET_WORDS:
            known = {getattr(target, name) for target in TARGETS}
            usable = all(isinstance(one, str) and one in known for one in values)
            wanted = f"{name}: {', '.join(sorted(known))}"
        else:
            manifest.wrong(
                f"A condition cannot ask for `{name}`: there is no such variable.",
                f"It asks for {', '.join((*TARGET_WORDS, *variables))}.",
                *where,
                name,
            )
            continue
        if usable:
            condition[name] = values
        else:
            manifest.wrong(f"{value!r} is no {wanted}.", "Write one, or a list.", *where, name)
    return condition
