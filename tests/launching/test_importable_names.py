"""Every module that launch files import from is found, however few files there are here."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from wsgen.launching import worker

if TYPE_CHECKING:
    from pathlib import Path


# Imports each module as the first of all, then asks for its names as a launch file does.
SCRIPT = """
import importlib, json, sys
sys.path.insert(0, sys.argv[1])
sys.path.append(sys.argv[2])
own, finders = {*sys.modules}, [*sys.meta_path]

def failures(module, names):
    for other in {*sys.modules} - own:
        if other.startswith(("launch", "ament", "lifecycle", "ros_gz")):
            del sys.modules[other]
    sys.meta_path[:] = finders
    try:
        importlib.import_module(module)
    except Exception as error:
        yield f"import {module}: {error!r}"
        return
    for name in names:
        scope = {}
        try:
            exec(f"from {module} import {name}", scope)
            assert {*scope} > {"__builtins__"}, "nothing is imported"
        except Exception as error:
            yield f"from {module} import {name}: {error!r}"

if sys.argv[3] == "all":
    from launch._finder import HOMES, NAMES
    asked = {module: ["*"] for module in HOMES}
    for package, names in NAMES.items():
        asked[package] = ["*", *names]
        for name, home in names.items():
            if home and not home.startswith("."):
                asked.setdefault(f"{package}.{home}", ["*"]).append(name)
else:
    asked = {}
    for module, name in json.loads(sys.argv[3]):
        asked.setdefault(module, []).append(name)
found = [text for module, names in asked.items() for text in failures(module, names)]
print(json.dumps([sum(map(len, asked.values())), found]))
"""

# Modules that the tables of the finder need not know, each with a name of it.
OTHERS = [
    ("ament_index_python", "get_package_prefix"),
    ("ament_index_python.packages", "get_package_share_directory"),
    ("ament_index_python.resources", "get_resource"),
    ("ament_index_python.search_paths", "get_search_paths"),
    ("launch", "LaunchDescriptionSource"),
    ("launch.action", "Action"),
    ("launch.frontend", "Entity"),
    ("launch.frontend.entity", "Entity"),
    ("launch.frontend.parser", "InvalidFrontendLaunchFileError"),
    ("launch.launch_context", "LaunchContext"),
    ("launch.launch_description", "LaunchDescription"),
    ("launch.launch_description_source", "LaunchDescriptionSource"),
    ("launch.launch_service", "LaunchService"),
    ("launch.logging", "get_logger"),
    ("launch.utilities.type_utils", "normalize_typed_substitution"),
    ("launch_ros", "actions"),
    ("launch_ros.parameter_descriptions", "ParameterValue"),
    ("launch_ros.parameters_type", "SomeParameters"),
    ("launch_ros.remap_rule_type", "SomeRemapRules"),
    ("launch_ros.utilities", "evaluate_parameters"),
    ("launch_xml", "launch_description_sources"),
    ("launch_yaml", "launch_description_sources"),
    ("lifecycle_msgs", "msg"),
    ("lifecycle_msgs.msg", "Transition"),
    ("ros_gz_bridge", "actions"),
    ("ros_gz_bridge.actions", "RosGzBridge"),
    ("ros_gz_sim", "actions"),
    ("ros_gz_sim.actions", "GzServer"),
]

# What the original does not have there either, though the module here needs it for itself.
HIDDEN = [
    ("launch.actions", "ProcessExited"),
    ("launch.events", "ProcessExited"),
    ("launch.launch_description_sources", "LaunchDescriptionSource"),
    ("launch.utilities", "is_substitution"),
    ("launch_ros.actions", "ComposableNode"),
    ("launch_ros.descriptions", "normalize_parameters"),
    ("launch_ros.event_handlers", "StateTransition"),
    ("launch_ros.events", "ChangeState"),
    ("launch_xml", "XMLLaunchDescriptionSource"),
    ("launch_yaml", "YAMLLaunchDescriptionSource"),
]


def ask(what: str) -> tuple[int, list[str]]:
    """How many names were asked for, and what was said of those that are not there."""
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT, worker._SHIM, worker._ROS_PACKAGES, what],
        capture_output=True,
        text=True,
        check=True,
    )
    asked, failures = json.loads(run.stdout)
    return asked, failures


@pytest.mark.slow
def test_every_public_name_is_found_in_its_package_and_in_its_module() -> None:
    asked, failures = ask("all")
    assert not failures
    assert asked > 300


@pytest.mark.slow
def test_every_other_module_is_found() -> None:
    assert not ask(json.dumps(OTHERS))[1]


@pytest.mark.slow
def test_what_a_module_needs_for_itself_is_not_shown() -> None:
    asked, failures = ask(json.dumps(HIDDEN))
    assert len(failures) == asked
    assert all("ImportError" in text for text in failures)


def test_the_index_needs_nothing_of_wsgen(tmp_path: Path) -> None:
    code = (
        "import sys; sys.path.insert(0, sys.argv[1]); "
        "import ament_index_python.packages, ament_index_python.resources; "
        "import ament_index_python.search_paths; "
        "print(*(name for name in sys.modules if name.startswith(('wsgen', 'launch'))))"
    )
    run = subprocess.run(
        [sys.executable, "-c", code, worker._SHIM],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    )
    assert not run.stdout.strip()
