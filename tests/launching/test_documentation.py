"""The lists in docs/launch.md are those of the code; docs/launch-fidelity.md is measured."""

from __future__ import annotations

import ast
import json
import re
import runpy
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from conformance import (
    CASES,
    CONFORMANCE,
    NOT_YET,
    REFUSALS,
    answers,
    evaluate_case,
    lines,
    packages_of_cases,
)
from wsgen.checks.rules.catalogue import all_rules
from wsgen.diagnostics import Severity
from wsgen.launching import known_packages

if TYPE_CHECKING:
    from collections.abc import Callable

    from install_space import InstallSpace


ROOT = Path(__file__).parents[2]
SHIM = ROOT / "src" / "wsgen" / "launching" / "shim"

# What differs from the original; everything else does not.
PARTLY = {
    "AnonName": "the name is the same in every evaluation, so that plans can be compared",
    "Command": "executes xacro, `cat` and `echo` only",
    "ComposableNodeContainer": "records the nodes as loaded, without a service call",
    "FindExecutable": "also finds programs of ROS and Gazebo that are not installed",
    "LaunchLogDir": "the folder above that of the launch, whose name has the time in it",
    "LaunchService": "plays what it is given at once, when it is run",
    "LoadComposableNodes": "see `ComposableNodeContainer`",
    "OnProcessIO": "handles no event, because no process writes; listed as unresolved",
    "OpaqueCoroutine": "sleeps in no time; unresolved if it waits for anything else for 1 s",
    "Parameter": "without descriptor",
    "ProcessIO": "never happens",
    "ProcessStderr": "never happens",
    "ProcessStdin": "never happens",
    "ProcessStdout": "never happens",
    "RosTimer": "virtual time is the time of ROS",
    "ShutdownProcess": "can be emitted, and ends nothing",
    "SignalProcess": "can be emitted, and ends nothing",
    "matches_pid": "matches nothing, because there are no processes",
}


def names() -> dict[str, list[str]]:
    """Package -> the names that can be imported from it."""
    found = {}
    for file in sorted(SHIM.rglob("__init__.py")):
        package = ".".join(file.parent.relative_to(SHIM).parts)
        tree = ast.parse(file.read_text(encoding="utf-8"))
        for node in tree.body:
            if not isinstance(node, ast.Assign) or not isinstance(node.value, ast.List):
                continue
            if ast.unparse(node.targets[0]) == "__all__":
                found[package] = ast.literal_eval(node.value)
    finder = runpy.run_path(str(SHIM / "launch" / "_finder.py"))
    shown: dict[str, dict[str, str]] = {**finder["ON_DEMAND"], **finder["NAMES"]}
    for package, homes in shown.items():
        found[package] = [name for name, home in homes.items() if home and home[0] != "."]
    module = "launch_ros.parameter_descriptions"
    tree = ast.parse((SHIM / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8"))
    found[module] = [node.name for node in tree.body if isinstance(node, ast.ClassDef)]
    return {package: found[package] for package in sorted(found) if found[package]}


def api() -> str:
    own = "\n".join(
        file.read_text(encoding="utf-8") for file in Path(__file__).parent.glob("test_*.py")
    )
    cases = {file.name.partition("_")[0]: body(file) for file in sorted(CASES.glob("t*.py"))}
    rows = []
    for package, listed in names().items():
        for name in sorted(listed):
            found = [case for case, text in cases.items() if re.search(rf"\b{name}\b", text)]
            found += ["own tests"] if re.search(rf"\b{name}\b", own) else []
            rows.append(
                f"| `{package}` | `{name}` | {PARTLY.get(name, '')} | {', '.join(found) or '-'} |"
            )
    head = "| from | name | what differs | tried in |\n|---|---|---|---|\n"
    return head + "\n".join(rows)


def tags() -> str:
    code = (
        "import json, sys; sys.path[:0] = sys.argv[1:]; "
        "from launch.frontend.actions import known_tags; "
        "from launch.frontend.template import FORMS; "
        "print(json.dumps([known_tags(), sorted(FORMS)]))"
    )
    folders = (str(SHIM), str(ROOT / "src" / "wsgen" / "launching" / "ros_packages"))
    found = subprocess.check_output([sys.executable, "-c", code, *folders], text=True)
    actions, substitutions = json.loads(found)
    return (
        f"Tags: {words(actions)}; `if` and `unless` on each.\n\n"
        f"Substitutions: {words(f'$({name})' for name in substitutions)}."
    )


def words(items: object) -> str:
    return ", ".join(f"`{item}`" for item in items)  # type: ignore[attr-defined]  # any iterable


def packages() -> str:
    files = known_packages._LAUNCH_FILES
    rows = [
        f"| `{package}` | {words(launch_files)} |"
        for package, launch_files in sorted(files.items())
    ]
    others = words(sorted(known_packages._OTHERS))
    table = "| package | launch files with their arguments |\n|---|---|\n" + "\n".join(rows)
    return f"{table}\n\nAlso {others}, and all that begin with `nav2_`."


SECTIONS: dict[str, Callable[[], str]] = {
    "api": api,
    "tags": tags,
    "packages": packages,
    "modules": lambda: words(sorted(known_packages.KNOWN_MODULES)) + ".",
    "programs": lambda: words(sorted(known_packages._RUN_FOR_EVER)) + ".",
}


@pytest.mark.slow
@pytest.mark.skipif(not CONFORMANCE.is_dir(), reason="the cases are not here")
@pytest.mark.parametrize("section", SECTIONS)
def test_the_lists_are_those_of_the_code(section: str, *, regenerate: bool) -> None:
    file = ROOT / "docs" / "launch.md"
    text = file.read_text(encoding="utf-8")
    pattern = re.compile(rf"(<!-- {section} -->\n).*?(<!-- end -->)", re.DOTALL)
    wanted = pattern.sub(lambda match: f"{match[1]}{SECTIONS[section]()}\n{match[2]}", text)
    if regenerate:
        file.write_text(wanted, encoding="utf-8")
    assert file.read_text(encoding="utf-8") == wanted


@pytest.mark.slow
@pytest.mark.skipif(not CONFORMANCE.is_dir(), reason="the cases are not here")
def test_every_name_is_tried_somewhere() -> None:
    assert not re.findall(r".*\| - \|", api())


def test_every_difference_is_of_a_name_there_is() -> None:
    known = {name for listed in names().values() for name in listed}
    assert set(PARTLY) <= known


HEAD = """# The evaluation of launch files, compared with the original

Each case is a small launch file. Its expected result was recorded with the real `launch` and
`launch_ros` of humble, jazzy and rolling, which all agree. The recorder visits the launch
description with a real `LaunchContext`, and replaces the execution of processes, so that every
process ends at once. In 2025 launch changed: `PathJoinSubstitution` takes lists (t18), and from
jazzy on a timer keeps the configurations of its group (t21). wsgen does as `ROS_DISTRO` says, which
for `wsgen check` is the target, and takes lists where it is not set; these two are of the launch
before.

A line is `@T NODE package/executable namespace/name [arguments] P:{parameters}` or
`@T PROC [command]`, where T is the simulated time in seconds, in the order in which things start.
`<cases>` is the folder of the cases. In the cases, `LC` is `LaunchConfiguration`,
`P('a', ...)` is `ExecuteProcess(cmd=['echo', 'a', ...])`, and `D` is the folder.

A test writes this page from the recorded results and from the results of wsgen:
`pytest tests/launching/test_documentation.py --regenerate`.

"""


@pytest.mark.slow
@pytest.mark.skipif(not CONFORMANCE.is_dir(), reason="the cases are not here")
def test_the_fidelity_page_is_what_is_measured(space: InstallSpace, *, regenerate: bool) -> None:
    packages_of_cases(space)
    sections = []
    same = refused = 0
    for name, answer in answers().items():
        plan = evaluate_case(space, name)
        found = lines(plan)
        errors = [one for one in plan.diagnostics if one.severity is Severity.ERROR]
        if name in NOT_YET:
            verdict = f"**not the same**: {NOT_YET[name]}.\n\n```\n{chr(10).join(found)}\n```"
        elif errors:
            (error,) = errors
            rule = next(rule.name for rule in all_rules() if rule.code == error.code)
            verdict = f"also refuses it, with {error.code} ({rule}): “{REFUSALS[name]}”."
            refused += 1
        else:
            verdict = "the same."
            same += 1
        sections.append(
            f"## {name}\n\n```python\n{body(CASES / f'{name}.launch.py')}\n```\n\nlaunch:\n\n```\n"
            f"{chr(10).join(answer) or '(nothing starts)'}\n```\n\nwsgen: {verdict}\n"
        )
    summary = (
        f"Of {len(sections)} cases, {same} give the same processes, arguments, parameters, names "
        f"and order;\nboth refuse {refused} for the same reason; {len(NOT_YET)} differ.\n\n"
    )
    page = HEAD + summary + "\n".join(sections)
    file = ROOT / "docs" / "launch-fidelity.md"
    if regenerate:
        file.write_text(page, encoding="utf-8")
    assert file.read_text(encoding="utf-8") == page


def body(case: Path) -> str:
    """What a case is about: the launch file without the lines that all cases begin with."""
    text = case.read_text(encoding="utf-8")
    head, found, rest = text.partition("LC=LaunchConfiguration\n")
    return (rest if found else head).strip()
