"""Values of launch arguments for a launch file that fails without them.

They are what the launch file itself says that an argument may have: its choices and the values in
quotes in its description, what conditions compare it with, and truth values for what a condition
reads. A default of `true` that an expression of Python reads should have been `True`.
"""

from __future__ import annotations

import ast
import itertools
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Rule, Severity
from wsgen.launching.explain import ARGUMENT_WITHOUT_VALUE
from wsgen.launching.explain_missing import FILE_NOT_INSTALLED, nodes_of
from wsgen.launching.explain_names import RAISES, REFUSED_BY_LAUNCH, UNDEFINED_NAME
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchArgument, LaunchPlan


ASSUMED_ARGUMENT = Rule(
    code="LCH092",
    name="assumed-argument",
    severity=Severity.INFO,
    summary="The launch file is evaluated with a launch argument whose value wsgen has chosen.",
    what="Tries, where the launch file fails without it, the values that the launch file names: "
    "choices, values in quotes in the description, and those that conditions compare with.",
    why="`ros2 launch` needs the value on its command line. Another value may start something "
    "else, which is not checked.",
    example="DeclareLaunchArgument('robot', choices=['wheeled', 'tracked'])",
    instead="DeclareLaunchArgument('robot', choices=['wheeled', 'tracked'],\n"
    "                      default_value='wheeled')",
)
MOST_TRIED = 6  # evaluations
_TRUTHS = {"true": "True", "false": "False"}  # of launch -> of Python
_QUOTED = lazy_pattern(r"'([\w.-]+)'|\"([\w.-]+)\"|`([\w.-]+)`")
_COMPARED = lazy_pattern(r"==\s*['\"]+\s*([\w.-]+)|\b([\w.-]+)\s*['\"]+\s*==")
_CONDITIONS = frozenset(("IfCondition", "UnlessCondition"))
_COMPARISONS = frozenset(("LaunchConfigurationEquals", "LaunchConfigurationNotEquals"))


def alternatives(
    plan: LaunchPlan,
    given: Mapping[str, str],
    ask_for_arguments: Callable[[], Sequence[LaunchArgument]],
) -> Iterator[dict[str, str]]:
    """The values to try, by argument, for the plan of a launch file that fails for want of them.

    Nothing that is `given` is changed.
    """
    failed = {
        found.code: found.element for found in plan.diagnostics if found.severity is Severity.ERROR
    }
    wanted: dict[str, Sequence[str]] = {}
    if ARGUMENT_WITHOUT_VALUE.code in failed:
        read = _values_in_conditions(plan.launch_file)
        lacking = [one for one in ask_for_arguments() if one.default is None]
        wanted = {one.name: _values(one, read) for one in lacking if one.name not in given}
        if not all(wanted.values()):
            return
    elif failed.get(UNDEFINED_NAME.code) in _TRUTHS:
        wanted = {
            one.name: [_TRUTHS[one.value]]
            for one in plan.arguments
            if one.value in _TRUTHS and one.name not in given
        }
        if wanted:
            yield {name: values[0] for name, values in wanted.items()}
        return
    elif {REFUSED_BY_LAUNCH.code, RAISES.code, FILE_NOT_INSTALLED.code} & failed.keys():
        read = _values_in_conditions(plan.launch_file)
        empty = [one for one in plan.arguments if one.value == "" and one.name not in given]
        wanted = {one.name: values for one in empty if (values := _values(one, read))}
    if wanted:
        rows = itertools.zip_longest(*wanted.values())
        first = [values[0] for values in wanted.values()]
        for row in itertools.islice(rows, MOST_TRIED):
            tried = (value or other for value, other in zip(row, first, strict=True))
            yield dict(zip(wanted, tried, strict=True))


def with_assumed(plan: LaunchPlan, failed: LaunchPlan, values: Mapping[str, str]) -> LaunchPlan:
    """The plan of a launch file with these values, with what is said of them and of the failure."""
    kept = (found for found in failed.diagnostics if found.code != ARGUMENT_WITHOUT_VALUE.code)
    diagnostics = (*kept, _assumed(plan, values), *plan.diagnostics)
    return replace(plan, diagnostics=tuple(dict.fromkeys(diagnostics)))


def _assumed(plan: LaunchPlan, values: Mapping[str, str]) -> Diagnostic:
    words = " ".join(f"{name}:={value}" for name, value in values.items())
    name = next(iter(values))
    return ASSUMED_ARGUMENT.at(
        plan.launch_file,
        None,
        name,
        message=f"The launch file fails without a value for {', '.join(values)}: it is evaluated "
        f"with {words}.",
        hint=f"Declare '{name}' with the default_value that it works with. For wsgen validate, "
        f"--arg {name}:=VALUE gives another one.",
    )


def _values(argument: LaunchArgument, read: Mapping[str, Sequence[str]]) -> list[str]:
    documented = ["".join(groups) for groups in _QUOTED.findall(argument.description)]
    return list(dict.fromkeys((*documented, *read.get(argument.name, ()))))


def _values_in_conditions(file: Path) -> dict[str, list[str]]:
    """The values that the conditions of a launch file have for arguments."""
    nodes: list[Any] = list(nodes_of(file))
    variables = {
        node.targets[0].id: _names_in(node.value, {})
        for node in nodes
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
        if _called(node.value) == "LaunchConfiguration"
    }
    found: dict[str, list[str]] = {}
    for node in nodes:
        kind = _called(node)
        inside: list[Any] = list(ast.walk(node))
        texts = [one.value for one in inside if _is_text(one)]
        if kind in _COMPARISONS:
            names, values = texts[:1], texts[1:2]
        elif kind == "PythonExpression":
            names = _names_in(node, variables)
            compared = _COMPARED.findall("".join(texts))
            values = ["".join(groups) for groups in compared] or [*_TRUTHS.values()]
        elif kind in _CONDITIONS and not any(_called(one) == "PythonExpression" for one in inside):
            names, values = _names_in(node, variables), [*_TRUTHS]
        else:
            continue
        for name in names:
            found.setdefault(name, []).extend(values)
    return found


def _called(node: Any) -> str | None:
    """The name of the function or class that a node calls."""
    return ast.unparse(node.func).rpartition(".")[2] if isinstance(node, ast.Call) else None


def _is_text(node: Any) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


def _names_in(node: Any, variables: Mapping[str, Sequence[str]]) -> list[str]:
    """The launch arguments that an expression reads."""
    found: list[str] = []
    inside: list[Any] = list(ast.walk(node))
    for one in inside:
        if _called(one) == "LaunchConfiguration":
            found += [text.value for text in one.args[:1] if _is_text(text)]
        elif isinstance(one, ast.Name):
            found += variables.get(one.id, ())
    return found
