"""Install spaces of a few files, and what evaluating their launch files gives."""

from __future__ import annotations

import os
from textwrap import dedent
from typing import TYPE_CHECKING, Any

from wsgen.isolation.parent import Limits
from wsgen.launching.evaluate import evaluate

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.model.plan import LaunchPlan


HEAD = """\
import os
from ament_index_python.packages import *
from launch import LaunchDescription
from launch.actions import *
from launch.conditions import *
from launch.event_handlers import *
from launch.launch_description_sources import *
from launch.substitutions import *
from launch_ros.actions import *
from launch_ros.parameter_descriptions import ParameterFile, ParameterValue
from launch_ros.substitutions import *
"""


class InstallSpace:
    """A prefix with packages in it."""

    def __init__(self, prefix: Path) -> None:
        self.prefix = prefix

    def add(self, package: str, files: Mapping[str, str] | None = None) -> Path:
        """Install a package with these files in its share folder; gives that folder."""
        index = self.prefix / "share" / "ament_index" / "resource_index" / "packages"
        index.mkdir(parents=True, exist_ok=True)
        index.joinpath(package).touch()
        share = self.prefix / "share" / package
        share.mkdir(parents=True, exist_ok=True)
        for name, text in (files or {}).items():
            share.joinpath(name).parent.mkdir(parents=True, exist_ok=True)
            share.joinpath(name).write_text(text, encoding="utf-8")
        return share

    def add_program(self, package: str, name: str) -> None:
        """Install a program of a package."""
        program = self.prefix / "lib" / package / name
        program.parent.mkdir(parents=True, exist_ok=True)
        program.touch()
        program.chmod(0o755)

    def evaluate(
        self,
        launch_file: Path,
        *,
        package: str | None = "my_robot",
        arguments: Mapping[str, str] | None = None,
        environment: Mapping[str, str] | None = None,
        seconds: float = 20.0,
        wall_clock: float | None = None,
        with_origins: bool = False,
    ) -> LaunchPlan:
        """The plan of a launch file, with this prefix sourced."""
        variables = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("ROS_", "AMENT_", "GAZEBO_", "GZ_"))
        }
        return evaluate(
            launch_file,
            package=package,
            arguments=arguments or {},
            environment=variables
            | {"AMENT_PREFIX_PATH": str(self.prefix)}
            | dict(environment or {}),
            with_origins=with_origins,
            limits=Limits(seconds=seconds, wall_clock=wall_clock, memory=2**30),
        )

    def play(
        self,
        entities: str,
        *,
        before: str = "",
        arguments: Mapping[str, str] | None = None,
        environment: Mapping[str, str] | None = None,
    ) -> LaunchPlan:
        """The plan of a launch file whose description holds these entities."""
        text = (
            HEAD
            + dedent(before)
            + "\n\ndef generate_launch_description():\n"
            + f"    return LaunchDescription([{entities}])\n"
        )
        share = self.add("my_robot", {"launch/test.launch.py": text})
        return self.evaluate(
            share / "launch" / "test.launch.py", arguments=arguments, environment=environment
        )


def only_message(plan: LaunchPlan, code: str) -> str:
    """Message and hint of the plan's only diagnostic, which has this code."""
    assert [diagnostic.code for diagnostic in plan.diagnostics] == [code], plan.diagnostics
    (diagnostic,) = plan.diagnostics
    assert "Traceback" not in diagnostic.message
    assert diagnostic.hint
    return f"{diagnostic.message}\n{diagnostic.hint}"


def essence(plan: LaunchPlan) -> list[Any]:
    """What two files that say the same have in common: all but where they say it."""
    assert not plan.diagnostics, plan.diagnostics
    return [
        [(one.name, one.default, one.value, one.description) for one in plan.arguments],
        [
            (
                one.package,
                one.executable,
                one.name,
                one.namespace,
                one.parameters,
                one.arguments,
                one.remappings,
                one.command,
                one.environment,
                one.container,
                one.starts,
            )
            for one in plan.processes
        ],
        [(one.package, one.file, one.arguments, one.evaluated) for one in plan.includes],
        plan.environment,
        [(one.what, one.why) for one in plan.unresolved],
    ]
