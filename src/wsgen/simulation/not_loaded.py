"""Explain why an engine is not loaded: nothing of the robot is to blame."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.isolation.missing_library import find_missing_library

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.result import Died


ENGINE_NOT_LOADED = Rule(
    code="SPN097",
    name="engine-not-loaded",
    severity=Severity.ERROR,
    summary="The library of the physics engine is installed but cannot be loaded.",
    what="Imports the engine in the simulation process, as `wsgen doctor` does.",
    why="An engine may need a system library that is missing on a machine without a desktop. The "
    "robot is not the cause.",
    example="wsgen validate robot.urdf --engine dart  # in a container without libGL.so.1",
    instead="sudo apt install libgl1",
)


def explain_not_loaded(engine: str, death: Died, others: Iterable[str]) -> Diagnostic | None:
    """Explain a death while the engine was imported; None if it died of something else.

    Args:
        engine: its name on the command line.
        death: of the child.
        others: names of the other engines that are installed.
    """
    missing = find_missing_library(death.reason)  # MuJoCo's module has Python load one by ctypes
    is_import = any(name in death.reason for name in ("(ImportError", "(ModuleNotFoundError"))
    if death.step or (missing is None and not is_import):
        return None
    why = death.reason if missing is None else f"needs {missing.name}, which the system lacks"
    fix = "Install it again with pip" if missing is None else missing.advice
    other = next(iter(others), None)
    instead = "" if other is None else f"--engine {other}, which works without it"
    return ENGINE_NOT_LOADED.at(
        None,
        message=f"The physics engine ({engine}) {why}.",
        hint=f"{'; or '.join(filter(None, (fix, instead)))}.",
    )
