"""`wsgen build`."""

from __future__ import annotations

import click

from wsgen.cli.options import output_options, workspace_option
from wsgen.errors import EXIT_FAILED, EXIT_PASSED

COLCON_ARGUMENTS = "wsgen.colcon_arguments"


class BuildCommand(click.Command):
    """A command that keeps what follows `--` apart: click would add it to the packages."""

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
    epilog="What follows -- goes to colcon:  wsgen build -- --cmake-clean-cache",
)
@click.argument("packages", nargs=-1, metavar="[PACKAGE]... [-- COLCON ARGUMENT...]")
@workspace_option
@output_options
@click.pass_context
def command(
    ctx: click.Context,
    packages: tuple[str, ...],
    *,
    workspace: str | None,
    quiet: bool,
    verbose: bool,
) -> int:
    """Build the workspace, or some packages and what they need, with the real colcon."""
    return build_workspace(
        packages,
        colcon_arguments=ctx.meta.get(COLCON_ARGUMENTS, ()),
        workspace=workspace,
        quiet=quiet,
        verbose=verbose,
    )


def build_workspace(
    packages: tuple[str, ...],
    *,
    colcon_arguments: tuple[str, ...] = (),
    workspace: str | None,
    quiet: bool,
    verbose: bool,
) -> int:
    """Build, tell what was found, and return the exit code."""
    import os

    from wsgen.cli.findings import render_findings
    from wsgen.cli.progress import listening
    from wsgen.workspace.build import build
    from wsgen.workspace.layout import open_workspace

    with listening(quiet=quiet, verbose=verbose) as listener:
        result = build(
            open_workspace(workspace),
            packages=packages,
            colcon_arguments=colcon_arguments,
            environment=os.environ,
            listener=listener,
        )
    if not (quiet or verbose):
        for text in result.unexplained_output:
            click.echo(f"       {text}", err=True)
    for line in render_findings(result.diagnostics):
        click.echo(line, err=True)
    return EXIT_PASSED if result.succeeded else EXIT_FAILED
