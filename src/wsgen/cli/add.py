"""`wsgen add`."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, TypeVar

import click

from wsgen.cli.options import Choice, workspace_option
from wsgen.cli.ros_tool import ExampleGroup
from wsgen.cli.terminal import echo, echo_next
from wsgen.errors import EXIT_FAILED, EXIT_PASSED
from wsgen.model.target import SIMULATORS

if TYPE_CHECKING:
    from wsgen.porting.adding.addition import Addition, AddPlan

Function = TypeVar("Function", bound=Callable[..., Any])

_SHARED: tuple[Callable[[Any], Any], ...] = (
    click.option(
        "--to",
        metavar="PACKAGE",
        help="Name or folder of the package.  [default: the one around the current folder]",
    ),
    workspace_option,
    click.option(
        "--distro",
        metavar="NAME",
        help="ROS 2 distribution.  [default: that of wsgen.toml, else $ROS_DISTRO]",
    ),
    click.option(
        "--sim",
        type=Choice(tuple(SIMULATORS), meant={"ign": "gz", "ignition": "gz"}),
        help="Simulator.  [default: the one that the package depends on]",
    ),
    click.option("--diff", is_flag=True, help="Show what would be added; write nothing."),
    click.option("--force", is_flag=True, help="Write also over what git cannot take back."),
    click.option(
        "--check", is_flag=True, help="Take it back if `wsgen check` then reports more than before."
    ),
    click.option("-q", "--quiet", is_flag=True, help="Print only what is left to you."),
)


def _shared(function: Function) -> Function:
    for option in reversed(_SHARED):
        function = option(function)
    return function


def _repeated(name: str, metavar: str, explained: str) -> Callable[[Function], Function]:
    """An option that can be given several times."""
    return click.option(name, multiple=True, metavar=metavar, help=f"{explained}; can be repeated.")


@click.group(
    cls=ExampleGroup,
    epilog="Only lines are added, where you would have put them. Added again, nothing changes.",
    examples=(
        "wsgen add node talker --publishes chatter:std_msgs/String",
        "wsgen add message Speed --field value:float64 --to my_interfaces",
    ),
)
def command() -> None:
    """Add a node, a message, a launch file and more to a package of anybody."""


@command.command("node")
@click.argument("name")
@click.option(
    "--language",
    type=Choice(("python", "cpp"), meant={"c++": "cpp", "cxx": "cpp", "py": "python"}),
    default="python",
    show_default=True,
    help="Language of the node.",
)
@_repeated("--publishes", "TOPIC:TYPE", "Topic on which it publishes")
@_repeated("--subscribes", "TOPIC:TYPE", "Topic to which it subscribes")
@_repeated("--parameter", "NAME:=VALUE", "Parameter with its default")
@click.option("--bare", is_flag=True, help="Add neither a launch file nor a test.")
@_shared
def add_node(
    name: str,
    *,
    language: str,
    publishes: tuple[str, ...],
    subscribes: tuple[str, ...],
    parameter: tuple[str, ...],
    bare: bool,
    **shared: Any,
) -> int:
    """Add a node, installed, with a launch file that starts it and a test that runs it."""
    from wsgen.porting.adding import nodes

    options = nodes.NodeOptions(language, publishes, subscribes, parameter, is_bare=bare)
    return _add(lambda addition: nodes.add_node(addition, name, options), **shared)


def _interface(kind: str, name: str, parts: tuple[tuple[str, ...], ...], **shared: Any) -> int:
    from wsgen.porting.adding.interfaces import KINDS, add_interface

    return _add(lambda addition: add_interface(addition, KINDS[kind], name, parts), **shared)


@command.command("message")
@click.argument("name")
@_repeated("--field", "NAME:TYPE", "Field")
@_shared
def add_message(name: str, *, field: tuple[str, ...], **shared: Any) -> int:
    """Add a message, with what generates it."""
    return _interface("message", name, (field,), **shared)


@command.command("service")
@click.argument("name")
@_repeated("--request", "NAME:TYPE", "Field of the request")
@_repeated("--response", "NAME:TYPE", "Field of the response")
@_shared
def add_service(
    name: str, *, request: tuple[str, ...], response: tuple[str, ...], **shared: Any
) -> int:
    """Add a service, with what generates it."""
    return _interface("service", name, (request, response), **shared)


@command.command("action")
@click.argument("name")
@_repeated("--goal", "NAME:TYPE", "Field of the goal")
@_repeated("--result", "NAME:TYPE", "Field of the result")
@_repeated("--feedback", "NAME:TYPE", "Field of the feedback")
@_shared
def add_action(
    name: str,
    *,
    goal: tuple[str, ...],
    result: tuple[str, ...],
    feedback: tuple[str, ...],
    **shared: Any,
) -> int:
    """Add an action, with what generates it."""
    return _interface("action", name, (goal, result, feedback), **shared)


@command.command("launch")
@click.argument("name")
@click.option("--rviz", "purpose", flag_value="rviz", help="Show the robot in RViz.")
@click.option("--simulator", "purpose", flag_value="simulator", help="Simulate the robot.")
@_repeated("--include", "[PACKAGE/]FILE", "Launch file that it includes")
@click.option("--robot", metavar="FILE", help="File of the robot.  [default: the only one]")
@click.option("--world", metavar="FILE", help="File of the world.  [default: the first one]")
@_shared
def add_launch(
    name: str,
    *,
    purpose: str | None,
    include: tuple[str, ...],
    robot: str | None,
    world: str | None,
    **shared: Any,
) -> int:
    """Add a launch file for RViz, for the simulator, or one that includes others."""
    from wsgen.porting.adding import launches

    options = launches.LaunchOptions(purpose, include, robot, world)
    return _add(lambda addition: launches.add_launch(addition, name, options), **shared)


@command.command("test")
@click.argument("name")
@_shared
def add_test(name: str, **shared: Any) -> int:
    """Add a test of pytest: of the robot that the package spawns, if it spawns one."""
    from wsgen.porting.adding.tests import add_test

    return _add(lambda addition: add_test(addition, name), **shared)


@command.command("world")
@click.argument("name")
@_shared
def add_world(name: str, **shared: Any) -> int:
    """Add a world for the simulator of the package."""
    from wsgen.porting.adding.worlds import add_world

    return _add(lambda addition: add_world(addition, name), **shared)


@command.command("sensor")
@click.argument("name")
@click.option(
    "--kind",
    type=Choice(("lidar", "camera", "depth", "imu", "gps", "contact"), meant={"laser": "lidar"}),
    required=True,
    help="Kind of the sensor.",
)
@click.option("--link", metavar="LINK", required=True, help="Link that carries it.")
@click.option("--robot", metavar="FILE", help="File of the robot.  [default: the only one]")
@_shared
def add_sensor(name: str, *, kind: str, link: str, robot: str | None, **shared: Any) -> int:
    """Add a sensor to the robot, with what simulates it and bridges its topics."""
    from wsgen.porting.adding import sensors

    options = sensors.SensorOptions(kind, link, robot)
    return _add(lambda addition: sensors.add_sensor(addition, name, options), **shared)


@command.command("controller")
@click.argument("name")
@click.option(
    "--kind",
    type=Choice(("position", "velocity", "effort", "broadcaster")),
    required=True,
    help="What it commands; `broadcaster` publishes the joint states.",
)
@_repeated("--joint", "JOINT", "Joint that it moves")
@click.option("--robot", metavar="FILE", help="File of the robot.  [default: the only one]")
@_shared
def add_controller(
    name: str, *, kind: str, joint: tuple[str, ...], robot: str | None, **shared: Any
) -> int:
    """Add a controller of ros2_control: parameters, interfaces of its joints, and spawner."""
    from wsgen.porting.adding import controllers

    options = controllers.ControllerOptions(kind, joint, robot)
    return _add(lambda addition: controllers.add_controller(addition, name, options), **shared)


@command.command("parameter")
@click.argument("given", metavar="NAME:=VALUE")
@click.option("--node", metavar="NAME", help="Node that has it.  [default: the only one]")
@_shared
def add_parameter(given: str, *, node: str | None, **shared: Any) -> int:
    """Add a parameter to a node: to its source, and to a YAML file that sets others of it."""
    from wsgen.porting.adding.parameters import add_parameter

    return _add(lambda addition: add_parameter(addition, given, node), **shared)


def _add(
    add: Callable[[Addition], object],
    *,
    to: str | None,
    workspace: str | None,
    distro: str | None,
    sim: str | None,
    diff: bool,
    force: bool,
    check: bool,
    quiet: bool,
) -> int:
    """Open the package, add to it, and write or show what changes; gives the exit code."""
    import os

    from wsgen.porting.adding.opening import open_addition
    from wsgen.porting.write import refuse_unsaved

    addition = open_addition(to, workspace, distro, sim, os.environ)
    add(addition)
    plan = addition.finish()
    if diff:
        from wsgen.cli.port import print_created

        print_created(plan.created, plan.files)
    elif plan.files or plan.created:
        if not force:
            refuse_unsaved([addition.folder], "what is added", [one.file for one in plan.files])
        if not _write(addition, plan, with_check=check, quiet=quiet):
            return EXIT_FAILED
    for line in _left(plan):
        echo(line, err=diff)
    for line in () if quiet else _said(plan, addition.name):
        echo(line, err=True)
    if not (quiet or diff or plan.is_empty):
        echo_next("Next: wsgen check  (then wsgen build)")
    is_useless = plan.pasted and not (plan.files or plan.created)
    return EXIT_FAILED if is_useless else EXIT_PASSED


def _write(addition: Addition, plan: AddPlan, *, with_check: bool, quiet: bool) -> bool:
    """Write what is added; with a check, take it back if more is reported. Whether it stays."""
    from wsgen.cli.words import short_name
    from wsgen.porting.adding.addition import write_addition
    from wsgen.porting.adding.proof import Reported

    reported = Reported(addition) if with_check else None
    written, stays = write_addition(plan, reported.is_as_before if reported else lambda: True)
    created = {file for file, _ in plan.created}
    for file in () if quiet or not stays else written:
        echo(f"{'Created' if file in created else 'Changed'} {short_name(file)}", err=True)
    if reported is not None and not stays:
        from wsgen.reporting.words import render_text

        echo("Nothing is added: wsgen check would then report this, too.")
        echo(render_text(reported.more))
    return stays


def _said(plan: AddPlan, package: str) -> Iterator[str]:
    from wsgen.cli.words import short_name

    if plan.is_empty:
        yield f"Nothing to add: {package} has all of it."
    for file in () if plan.is_empty else plan.kept:
        yield f"{short_name(file)} exists, and stays as it is."


def _left(plan: AddPlan) -> list[str]:
    """The lines that the author has to paste, and where."""
    from wsgen.cli.words import short_name

    lines = []
    for one in plan.pasted:
        lines += [f"{short_name(one.file)}: {one.where}"]
        lines += [f"    {line}" for line in one.text.splitlines()]
    return ["Left to you:", *lines] if lines else []
