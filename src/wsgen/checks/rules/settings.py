"""Settings of Gazebo Classic that not every engine follows: which ones, and where they matter.

docs/fidelity.md, the rule's documentation and the tests against Gazebo Classic take them from here.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.urdf.lumping import that_stay
from wsgen.diagnostics import Rule, Severity
from wsgen.model.engines import name_engines
from wsgen.model.world import World
from wsgen.text.suggestions import some_named

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import DiffDrive
    from wsgen.model.robot import Robot

DEPTH = 1e-3  # m; nobody sees less
CORNERS = 4  # that carry a robot
WEIGHT = math.hypot(*World(name="").gravity)  # N/kg
SOLVED = 1000  # iterations, with which a robot skids as in the engines
SKIDS = 2  # pairs of wheels
FAST = 10.0  # rad/s, that a drive seldom turns wheels by


class Setting(NamedTuple):
    """One that a description or a world may have; texts are Markdown."""

    elements: str
    followed_by: tuple[str, ...]  # engines
    in_gazebo: str  # what Gazebo Classic does, after "there"
    matters: str  # where it does
    keys: tuple[str, ...] = ()  # that a `<gazebo>` element may have for it
    # The links or joints of a robot, as Gazebo has it, where it matters; None: not of a robot.
    find: Callable[[Robot], Iterator[str]] | None = None


def _soft(robot: Robot) -> Iterator[str]:
    for link in robot.links:
        stiffnesses = [one.surface.kp for one in link.collisions if one.surface.kp]
        if stiffnesses and robot.mass * WEIGHT / (CORNERS * min(stiffnesses)) > DEPTH:
            yield link.name


def _deep(robot: Robot) -> Iterator[str]:
    for link in robot.links:
        if any((one.surface.min_depth or 0.0) > DEPTH for one in link.collisions):
            yield link.name


def _stopped(robot: Robot) -> Iterator[str]:
    return (joint.name for joint in robot.movable_joints if joint.stop and joint.limit is not None)


def _kinematic(robot: Robot) -> Iterator[str]:
    stay = that_stay(robot)
    return (link.name for link in robot.links if link.is_kinematic and link.name not in stay)


SOFT = Setting(
    "`<kp>` and `<kd>`",
    (),
    "a robot sinks into the ground on soft contacts",
    "by more than 1 mm",
    ("kp", "collision/surface/contact/ode/kp"),
    _soft,
)
MIN_DEPTH = Setting(
    "`<min_depth>`",
    ("mujoco",),
    "what is in the ground is not pushed out further than to this depth",
    "more than 1 mm",
    ("minDepth", "collision/surface/contact/ode/min_depth"),
    _deep,
)
STOPS = Setting(
    "`<stopErp>` and `<stopCfm>`",
    ("mujoco",),
    "a joint gives way at its limits",
    "other than 0.2 and 0",
    ("stopErp", "stopCfm"),
    _stopped,
)
KINEMATIC = Setting(
    "`<kinematic>`",
    (),
    "the link stays where it is",
    "on what hangs on a link that moves",
    ("kinematic",),
    _kinematic,
)
ITERATIONS = Setting(
    "`<iters>`",
    (),
    "wheels that skid turn a robot less far, for its solver does not finish",
    "less than 1000, with four driven wheels",
)
CORRECTING = Setting(
    "`<contact_max_correcting_vel>`",
    (),
    "motors turn wheels by no more rad/s than this",
    "less than 10, with driven wheels",
)
FRICTION_DIRECTION = Setting(
    "`<fdir1>`",
    ("mujoco",),
    "friction has other directions than those of the world",
    "on wheels, as `friction-direction-not-simulated`",
)
SETTINGS = (SOFT, MIN_DEPTH, STOPS, KINEMATIC, ITERATIONS, CORRECTING, FRICTION_DIRECTION)


def without(setting: Setting, engines: Iterable[str]) -> tuple[str, ...]:
    """Those of the engines that do not follow it."""
    return tuple(engine for engine in engines if engine not in setting.followed_by)


def _listed() -> str:
    return "; ".join(
        one.elements
        + (f" ({one.matters})" if one.matters else "")
        + (f", which {name_engines(one.followed_by)} follows" if one.followed_by else "")
        for one in SETTINGS
        if one is not FRICTION_DIRECTION
    )


SETTING_NOT_SIMULATED = Rule(
    code="SPN111",
    name="setting-not-simulated",
    severity=Severity.INFO,
    summary="The physics engine does not follow a setting that Gazebo Classic follows.",
    what=f"In runs for Gazebo Classic, looks for these, where they matter: {_listed()}.",
    why="The robot moves in another way than in Gazebo Classic. docs/fidelity.md says what each "
    "setting does there.",
    example='<gazebo reference="base_link"><kp>1000</kp><kd>10</kd></gazebo>',
    instead='<gazebo reference="base_link"><kp>1000000</kp><kd>10</kd></gazebo>',
)


def settings_not_simulated(
    written: Robot, lumped: Robot, file: Path | None, engines: Sequence[str]
) -> Iterator[Diagnostic]:
    """Report, once each, what engines do not follow of a robot for Gazebo Classic."""
    for setting in () if lumped.is_static else SETTINGS:
        lacking = without(setting, engines)
        names = list(setting.find(lumped)) if setting.find and lacking else []
        if not names:
            continue
        tags = [tag for tag in written.gazebo if any(key in tag.values for key in setting.keys)]
        # That of the first one; one of a link that is lumped into it has another reference.
        tag = next((tag for tag in tags if tag.reference == names[0]), next(iter(tags), None))
        lines = {link.name: link.line for link in lumped.links}
        lines |= {joint.name: joint.line for joint in lumped.joints}
        yield SETTING_NOT_SIMULATED.at(
            file,
            lines[names[0]] if tag is None else tag.line,
            names[0] if tag is None else f"gazebo[@reference='{tag.reference}']",
            message=_message(setting, lacking, f"{some_named(names, 1)} of `{written.name}`"),
            hint=_hint(setting),
        )


def solver_not_simulated(
    world: World, drives: Iterable[DiffDrive | None], engines: Sequence[str]
) -> Iterator[Diagnostic]:
    """Report what a world for Gazebo Classic says of ODE's solver, where wheels turn otherwise."""
    pairs = [len(drive.pairs) for drive in drives if drive is not None]
    for setting, (value, line), enough, matters, path in (
        (ITERATIONS, world.iterations, SOLVED, any(one >= SKIDS for one in pairs), "solver/iters"),
        (
            CORRECTING,
            world.correcting_speed,
            FAST,
            bool(pairs),
            "constraints/contact_max_correcting_vel",
        ),
    ):
        lacking = without(setting, engines)
        if value is not None and value < enough and matters and lacking:
            yield SETTING_NOT_SIMULATED.at(
                world.file,
                line,
                f"physics/ode/{path}",
                message=_message(setting, lacking, f"the world `{world.name}` ({value:g})"),
                hint=_hint(setting),
            )


def _message(setting: Setting, lacking: Sequence[str], where: str) -> str:
    does = "does" if len(lacking) == 1 else "do"
    elements = setting.elements.replace("`", "")
    return (
        f"{name_engines(lacking)} {does} not follow {elements} of {where}: in Gazebo Classic, "
        f"{setting.in_gazebo}."
    )


def _hint(setting: Setting) -> str:
    if setting.followed_by:
        return "Simulate it with --engine mujoco (pip install 'wsgen[mujoco]')."
    return "Run wsgen validate --engine gazebo to compare with the Gazebo that is installed."
