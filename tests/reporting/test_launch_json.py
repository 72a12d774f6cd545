"""The JSON of `wsgen launch`: every key of the contract, always."""

import json
import math
from pathlib import Path

from reporting.test_json_report import documented_keys, keys
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.plan import (
    FileRead,
    Include,
    LaunchArgument,
    LaunchPlan,
    Origin,
    Process,
    Unresolved,
)
from wsgen.reporting.json_report import render_plan

FULL = LaunchPlan(
    package="my_robot",
    launch_file=Path("/w/r.launch.py"),
    arguments=(
        LaunchArgument(
            name="z",
            default=None,
            value="1",
            description="height",
            origin=Origin(file=Path("/w/r.launch.py"), line=2),
            set_by="include",
            set_at=Origin(file=Path("/w/p.launch.py"), line=7),
        ),
    ),
    processes=(
        Process(
            package="p",
            executable="e",
            name="n",
            namespace="/a",
            parameters={"x": math.inf, "y": [1.0, math.nan], "z": -math.inf, "é": True},
            arguments=("-d",),
            parameter_origins={"x": Origin(file=Path("/w/p.yaml"), line=3)},
            argument_origins=(Origin(file=Path("/w/r.launch.py"), line=5),),
            remappings=(("a", "b"),),
            remapping_origins=(Origin(file=Path("/w/r.launch.xml")),),
            starts="timer 3.0",
            start_time=3.0,
            file=Path("/w/r.launch.py"),
            line=4,
        ),
        Process(package=None, executable=None, command=("gz", "sim")),
    ),
    includes=(Include(package="q", file=Path("/q.launch.py"), arguments={"a": "b"}),),
    environment={"A": "1"},
    unresolved=(Unresolved(what="date", why="not executed", file=Path("/w/r.launch.py"), line=9),),
    files=(FileRead(path=Path("/w/p.yaml"), use="parameters", sha256="5c"),),
    diagnostics=(
        Diagnostic(name="some-rule", code="LCH019", severity=Severity.WARNING, message="m"),
    ),
)


def test_every_key_of_the_contract() -> None:
    text = render_plan(FULL)
    assert text.endswith("}\n")
    document = json.loads(text)
    assert {name: document[name] for name in ("version", "package", "launch_file")} == {
        "version": 1,
        "package": "my_robot",
        "launch_file": "/w/r.launch.py",
    }
    assert document["arguments"] == [
        {
            "name": "z",
            "default": None,
            "value": "1",
            "description": "height",
            "file": "/w/r.launch.py",
            "line": 2,
            "set_by": "include",
            "set_at": {"file": "/w/p.launch.py", "line": 7},
        }
    ]
    node, command = document["processes"]
    assert node["remappings"] == [["a", "b"]]
    assert node["remapping_origins"] == [{"file": "/w/r.launch.xml", "line": None}]
    assert node["argument_origins"] == [{"file": "/w/r.launch.py", "line": 5}]
    assert node["parameter_origins"] == {
        "x": {"file": "/w/p.yaml", "line": 3},
        **dict.fromkeys("yzé"),
    }
    assert document["files"] == [{"path": "/w/p.yaml", "use": "parameters", "sha256": "5c"}]
    assert (node["starts"], node["start_time"], node["command"]) == ("timer 3.0", 3.0, None)
    assert (command["package"], command["command"]) == (None, ["gz", "sim"])
    assert document["includes"] == [
        {"package": "q", "file": "/q.launch.py", "arguments": {"a": "b"}, "evaluated": True}
    ]
    assert document["environment"] == {"A": "1"}
    assert document["unresolved"] == [
        {"what": "date", "file": "/w/r.launch.py", "line": 9, "why": "not executed"}
    ]
    assert document["diagnostics"][0]["code"] == "LCH019"


def test_numbers_that_json_does_not_have() -> None:
    (node, _) = json.loads(render_plan(FULL))["processes"]
    assert node["parameters"] == {"x": ".inf", "y": [1.0, ".nan"], "z": "-.inf", "é": True}


def test_an_empty_plan_has_every_key_too() -> None:
    document = json.loads(render_plan(LaunchPlan(package=None, launch_file=Path("x"))))
    assert set(document) == set(json.loads(render_plan(FULL)))
    assert document["package"] is None
    assert document["processes"] == []


def test_the_documentation_lists_every_key() -> None:
    document = json.loads(render_plan(FULL))
    document["environment"] = None  # its keys are names
    for process in document["processes"]:
        process["parameters"] = process["environment"] = process["parameter_origins"] = None
    for include in document["includes"]:
        include["arguments"] = None
    assert documented_keys("wsgen launch") == keys(document)
