"""The cases of launch conformance, their answers, and plans in the words of these.

The cases and their answers lie beside the checkout where the project is developed.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from install_space import InstallSpace
    from wsgen.model.plan import LaunchPlan, Process


CONFORMANCE = Path(__file__).parents[2] / "shared" / "launch-conformance"
CASES = CONFORMANCE / "cases"

NOT_YET = {
    "t15_command_stderr": "sh is not executed",
    "t16_command_shlex": "printf is not executed",
}

# Where launch was changed after the answers had been recorded: a distribution that it was not for.
RECORDED_FOR = {"t18_pathjoin_nested_list": "galactic"}

# What the diagnostic says in each case that the real launch refuses.
REFUSALS = {
    "t07_condition_bad": "expected one of [true, 1, false, 0] but got 'yes'",
    "t09_pyexpr_lower_true": "name 'true' is not defined",
    "t11_robot_description_yaml_fold": "Unable to parse the value of parameter robot_description",
    "t12_robot_description_colon": "Unable to parse the value of parameter robot_description",
    "t18_pathjoin_nested_list": "Failed to normalize given item of type '<class 'list'>'",
    "t24_declare_missing": "'req' has no default",
    "t26_use_before_declare": "'late' does not exist",
    "t29_node_executed_twice": "executed more than once",
    "t30_nonentity": "'NoneType' object has no attribute 'describe_sub_entities'",
    "t31_launch_args_dict_value_types": "'bool' object is not iterable",
    "t35_node_args_types": "'float' object is not iterable",
    "t39_onexit_empty_list": "AttributeError: 'OnProcessExit'",
    "t43_short_package_name": "'p' is not a valid package name",
    "t45_launch_args_plain_dict": "not enough values to unpack (expected 2, got 1)",
    "t47_opaque_returns_single": "'ExecuteProcess' object is not iterable",
    "t48_nested_list": "'list' object has no attribute 'describe_sub_entities'",
    "t51_missing_launch_function": "generate_launch_description",
    "t52_wrong_kwarg": "missing 1 required keyword-only argument: 'executable'",
    "t53_param_not_list": "expected 'parameters' to be one of [<class 'list'>]",
}


def answers() -> dict[str, list[str]]:
    if not CONFORMANCE.is_dir():
        return {}
    found: dict[str, list[str]] = json.loads((CONFORMANCE / "answers.json").read_text())
    return found


def evaluate_case(space: InstallSpace, name: str) -> LaunchPlan:
    """The plan of a case, for the distribution that its answer holds for."""
    distro = RECORDED_FOR.get(name)
    environment = {"ROS_DISTRO": distro} if distro else None
    return space.evaluate(CASES / f"{name}.launch.py", package=None, environment=environment)


def packages_of_cases(space: InstallSpace) -> InstallSpace:
    """The packages that the recorder of the answers took for installed."""
    space.add("pkg_a")
    for program in ("e", "e2"):
        space.add_program("pkg_a", program)
    return space


def merged(line: str) -> str:
    """An answer whose parameters are one mapping; the original gives a node several files."""
    head, *parameters = re.split(r" P:(?=\{)", line)
    if len(parameters) < 2:
        return line
    found = {name: value for text in parameters for name, value in json.loads(text).items()}
    return f"{head} P:{json.dumps(found, sort_keys=True)}"


def lines(plan: LaunchPlan) -> list[str]:
    """The processes as the answers write them; none of these shuts down."""
    return [line(process) for process in plan.processes if process.starts != "shutdown"]


def line(process: Process) -> str:
    if process.container is not None:
        return composable(process)
    start = f"@{process.start_time:g}"
    if process.command is not None:
        words = [word.replace(str(CASES), "<cases>") for word in process.command]
        return f"{start} PROC {json.dumps(words)}"
    text = (
        f"{start} NODE {process.package}/{process.executable} "
        f"{process.namespace or '<node_namespace_unspecified>'}"
        f"/{process.name or '<node_name_unspecified>'}"
    )
    if process.arguments:
        text += f" {json.dumps(process.arguments)}"
    if process.parameters:
        text += f" P:{json.dumps(process.parameters, sort_keys=True)}"
    if process.remappings:
        text += f" R:{json.dumps(process.remappings)}"
    return text


def composable(node: Process) -> str:
    """A node of a container; only the names and integers of its parameters are compared."""
    parameters = [
        f"rcl_interfaces.msg.Parameter(name='{name}', value=rcl_interfaces.msg.ParameterValue("
        f"type=2, bool_value=False, integer_value={value}, double_value=0.0, string_value='', "
        "byte_array_value=[], bool_array_value=[], integer_array_value=[], "
        "double_array_value=[], string_array_value=[]))"
        for name, value in node.parameters.items()
    ]
    answer = {
        "package_name": node.package,
        "plugin_name": node.executable,
        "node_name": node.name,
        "node_namespace": node.namespace,
        "remap_rules": [f"{source}:={target}" for source, target in node.remappings],
        "parameters": parameters,
    }
    return f"COMPOSABLE {json.dumps(answer)}"
