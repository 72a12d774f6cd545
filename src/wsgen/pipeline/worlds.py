"""World files that a launch file names and that are not there."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.launch.explain_missing import first_missing
from wsgen.launch.syntax import where_written
from wsgen.suggestions import advice
from wsgen.world.lookup import gazebo_worlds, world_names

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.plan import LaunchPlan


def missing_world(plan: LaunchPlan, file: Path) -> Diagnostic:
    """Report the path of a world that leads to nothing, at the line that writes it."""
    missing, beside = first_missing(str(file))
    written, line = where_written(missing, plan.evaluated_files) or (plan.launch_file, None)
    return Diagnostic(
        code="WLD001",
        severity=Severity.ERROR,
        message=f"The world file '{file}' is not there.",
        file=Path(written),
        line=line,
        element=missing,
        hint=advice(
            missing,
            beside,
            "Put its folder into an install(DIRECTORY ...) rule of CMakeLists.txt, then build "
            "again with `wsgen build`.",
        ),
    )


def unknown_world(plan: LaunchPlan, name: str, environment: Mapping[str, str]) -> Diagnostic:
    """Report the name of a world that is not found here; Gazebo may have it."""
    written, line = where_written(name, plan.evaluated_files) or (plan.launch_file, None)
    gazebos = gazebo_worlds()
    use_path = "Give the path of a world file that the package installs."
    return Diagnostic(
        code="WLD008",
        severity=Severity.WARNING,
        message=f"No file is called {name}. If it is one of Gazebo's own worlds, Gazebo finds it; "
        "the trial takes a ground plane instead.",
        file=Path(written),
        line=line,
        element=name,
        hint=use_path
        if name in gazebos
        else advice(name, [*gazebos, *world_names(environment)], use_path),
    )
