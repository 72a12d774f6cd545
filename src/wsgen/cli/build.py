"""`wsgen build`."""

from __future__ import annotations

import click

from wsgen.cli.options import (
    ExampleCommand,
    complete_packages,
    format_option,
    output_options,
    workspace_option,
)
from wsgen.cli.terminal import echo, echo_next
from wsgen.errors import EXIT_FAILED, EXIT_PASSED

COLCON_ARGUMENTS = "wsgen.colcon_arguments"


class BuildCommand(ExampleCommand):
    """A command that separates the arguments after `--`; click would add them to the packages."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Put colcon's arguments into the context."""
        if "--" in args:
            split = args.index("--")
            ctx.meta[COLCON_ARGUMENTS] = args[split + 1 :]
            args = args[:split]
        return super().parse_args(ctx, args)


@click.command(
    cls=BuildCommand,
    options_metavar="[OPTIONS]",
    epilog="Arguments after -- are passed to colcon.",
    examples=("wsgen build my_robot", "wsgen build -- --cmake-clean-cache"),
)
@click.argument(
    "packages",
    nargs=-1,
    metavar="[PACKAGE]... [-- COLCON ARGUMENT...]",
    shell_complete=complete_packages,
)
@workspace_option
@click.option(
    "--strict",
    is_flag=True,
    help="Without a sourced ROS: exit with 1 if a package cannot be compiled.",
)
@format_option
@output_options
@click.pass_context
def command(
    ctx: click.Context,
    packages: tuple[str, ...],
    *,
    workspace: str | None,
    strict: bool,
    output_format: str,
    quiet: bool,
    verbose: bool,
) -> int:
    """Build the workspace with colcon, or only these packages and their dependencies."""
    return build_workspace(
        packages,
        colcon_arguments=ctx.meta.get(COLCON_ARGUMENTS, ()),
        workspace=workspace,
        strict=strict,
        output_format=output_format,
        quiet=quiet,
        verbose=verbose,
    )


def build_workspace(
    packages: tuple[str, ...],
    *,
    colcon_arguments: tuple[str, ...] = (),
    workspace: str | None,
    strict: bool = False,
    output_format: str = "text",
    quiet: bool,
    verbose: bool,
    goes_on: bool = False,
) -> int:
    """Build, print the diagnostics, and return the exit code.

    The next step is not printed if wsgen `goes_on` to take it.
    """
    import os
    import shlex

    from wsgen.building.left_out import NOT_COMPILED
    from wsgen.building.run import build
    from wsgen.cli.output import render_alike, render_diagnostics
    from wsgen.cli.progress import listening
    from wsgen.cli.words import announce_place, next_command
    from wsgen.diagnostics import Severity
    from wsgen.packages.workspace.layout import open_workspace

    place = open_workspace(workspace)
    announce_place(place, workspace)
    with listening(quiet=quiet, verbose=verbose) as listener:
        result = build(
            place,
            packages=packages,
            colcon_arguments=colcon_arguments,
            strict=strict,
            environment=os.environ,
            listener=listener,
        )
    if not (quiet or verbose):
        for text in result.unexplained_output:
            echo(f"       {text}", err=True)
    if output_format == "json":
        from wsgen.reporting.json_report import render_build

        echo(render_build(result), nl=False)
    else:
        notes = [
            found
            for found in result.diagnostics
            if found.code == NOT_COMPILED.code and found.severity is not Severity.ERROR
        ]
        others = [found for found in result.diagnostics if found not in notes]
        for line in (*render_diagnostics(others), *render_alike(notes)):
            echo(line)
        if result.not_built and "--continue-on-error" not in colcon_arguments and not quiet:
            words = [*packages, "--", *colcon_arguments, "--continue-on-error"]
            build_all = next_command(place, shlex.join(["wsgen", "build", *words]))
            echo_next(
                f"Next: {build_all}  (builds the packages that do not depend on the failed ones)"
            )
        has_built = any(package.outcome == "built" for package in result.packages)
        if result.succeeded and not (quiet or goes_on):
            validate = " ".join(["wsgen validate", *packages])
            echo_next(f"Next: {next_command(place, validate)}")
        elif has_built and not (result.succeeded or quiet):
            validate = next_command(place, "wsgen validate")
            echo_next(f"Next: fix the errors, or validate what is built: {validate}")
    return EXIT_PASSED if result.succeeded else EXIT_FAILED
