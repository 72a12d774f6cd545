"""The engines of a request: all that can be compared, those that are missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.errors import NotFoundError
from wsgen.model.engines import ENGINES, name_engines
from wsgen.simulation.run import default_engine, installed_engines, missing_engines

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from wsgen.diagnostics import Diagnostic


def all_engines() -> tuple[str, ...]:
    """Those that `--engine all` compares: what is installed; all, if there is nothing to compare.

    `check_engines` then says which are missing.
    """
    installed = installed_engines()
    return tuple(installed if len(installed) > 1 else ENGINES)


def check_engines(engines: Sequence[str]) -> None:
    """Check that engines are installed.

    Raises:
        NotFoundError: one is not.
    """
    missing = missing_engines(engines)
    if missing:
        raise NotFoundError(
            f"{name_engines(missing)} {'is' if len(missing) == 1 else 'are'} not installed."
            if installed_engines()
            else "No physics engine is installed.",
            hint=_how_to_install(missing),
        )


def _how_to_install(engines: Sequence[str]) -> str:
    """The hint for engines that are missing; PyBullet's wheels have two names, where it has any."""
    extras = [ENGINES[name].extra for name in engines if ENGINES[name].extra]
    if not extras and not installed_engines():
        extras = ["mujoco"]
    if extras:
        what = "it" if len(engines) == 1 else "them"
        if len(extras) < len(engines):
            what = name_engines(name for name in engines if ENGINES[name].extra)
        return f"Install {what}: pip install 'wsgen[{','.join(extras)}]'"
    return (
        "PyBullet is installed with wsgen if it has a wheel for this machine and Python version; "
        f"otherwise use --engine {default_engine()}."
    )


ENGINE_LEFT_OUT = Rule(
    code="SPN098",
    name="engine-left-out",
    severity=Severity.INFO,
    severity_varies="an error with `--engine gazebo`",
    summary="An engine is not installed; `--engine all` compares the others.",
    what="Also looks for the Gazebo that the launch file starts: with `--engine gazebo`, and with "
    "`--engine all` where the other Gazebo is installed.",
    why="If two engines disagree, it is not known which one is right.",
    example="wsgen validate my_robot --engine all",
    instead="pip install 'wsgen[mujoco,dart]'\nwsgen validate my_robot --engine all",
)


def engine_left_out(engines: Sequence[str]) -> Iterator[Diagnostic]:
    """Report which engine a comparison is without; `engines` are those that are compared."""
    left_out = [name for name in ENGINES if name not in engines]
    if len(engines) > 1 and left_out:
        yield ENGINE_LEFT_OUT.at(
            None,
            message=f"{name_engines(left_out)} is not installed: only {name_engines(engines)} are "
            "compared.",
            hint=_how_to_install(left_out),
        )
