"""Options that several commands share."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

import click

if TYPE_CHECKING:
    from wsgen.model.target import Target


Function = TypeVar("Function", bound=Callable[..., Any])


class ExampleCommand(click.Command):
    """A command whose help ends with examples."""

    def __init__(self, *arguments: Any, examples: Sequence[str], **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.examples = examples  # as they are typed

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write them as they are: click would wrap long ones."""
        super().format_epilog(ctx, formatter)
        with formatter.section("Examples"):
            for example in self.examples:
                formatter.write(f"{'':{formatter.current_indent}}{example}\n")


workspace_option = click.option(
    "-w",
    "--workspace",
    type=click.Path(file_okay=False),
    metavar="DIR",
    help="The colcon workspace.  [default: the one around the current folder]",
)

format_option = click.option(
    "--format",
    "output_format",
    type=click.Choice(["text", "json"]),
    default="text",
    show_default=True,
    help="Form of the result on standard output.",
)

distro_option = click.option(
    "--distro",
    envvar="ROS_DISTRO",
    default="iron",
    metavar="NAME",
    help="ROS 2 distribution that is aimed at.  [default: $ROS_DISTRO, else iron]",
)

sim_option = click.option(
    "--sim",
    type=click.Choice(["classic", "gz"]),
    help="Gazebo Classic or Gazebo Sim.  [default: classic on iron, gz elsewhere]",
)

seconds_option = click.option(
    "--seconds",
    type=click.FloatRange(min=0.1, max=600.0),
    default=3.0,
    show_default=True,
    help="Simulated time.",
)

engine_option = click.option(
    "--engine",
    type=click.Choice(["bullet", "dart", "both"]),
    help="Physics engine; DART is Gazebo's own (pip install 'wsgen[dart]').  [default: bullet, "
    "and dart where Python has no PyBullet]",
)

picture_option = click.option(
    "--picture", type=click.Path(), metavar="DIR", help="Write a PNG of the end there."
)


def chosen_target(ctx: click.Context, distro: str, sim: str | None) -> Target:
    """The target that `distro_option` and `sim_option` mean."""
    from click.core import ParameterSource

    from wsgen.model.target import choose_target

    source = ctx.get_parameter_source("distro")
    return choose_target(distro, sim, is_from_environment=source is ParameterSource.ENVIRONMENT)


def chosen_engines(engine: str | None) -> tuple[str, ...]:
    """The engines that `engine_option` means; the first one's figures are reported."""
    from wsgen.simulation.run import default_engine

    return ("bullet", "dart") if engine == "both" else (engine or default_engine(),)


def _set_color(ctx: click.Context, _parameter: click.Parameter, value: str) -> None:
    # click itself leaves colors away where the output is no terminal.
    if value != "auto":
        ctx.color = value == "always"
        if ctx.obj is not None:  # for what is told after the command has failed
            ctx.obj.wanted = ctx.color


def output_options(function: Function) -> Function:
    """-q, -v and --color, for commands that show progress on standard error."""
    for option in (
        click.option("-q", "--quiet", is_flag=True, help="Show no progress and no next step."),
        click.option("-v", "--verbose", is_flag=True, help="Show all that is found or printed."),
        click.option(
            "--color",
            type=click.Choice(["auto", "always", "never"]),
            default="auto",
            envvar="WSGEN_COLOR",
            show_default=True,
            is_eager=True,
            expose_value=False,
            callback=_set_color,
            help="Colors; in auto, NO_COLOR turns them off.",
        ),
    ):
        function = option(function)
    return function
