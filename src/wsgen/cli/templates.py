"""`wsgen templates`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.options import ExampleCommand, complete_templates, format_option, output_options
from wsgen.cli.terminal import echo
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, RequestError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.templating.spec import Variable
    from wsgen.templating.template import Template


@click.command(
    cls=ExampleCommand,
    examples=("wsgen templates simple", "wsgen templates --check my_templates/crane"),
)
@click.argument("name", metavar="[NAME|FOLDER]", required=False, shell_complete=complete_templates)
@click.option(
    "--check",
    "is_check",
    is_flag=True,
    help="Render the template for every target, then validate the packages.",
)
@format_option
@output_options
def command(
    name: str | None,
    *,
    is_check: bool,
    output_format: str,
    quiet: bool,
    verbose: bool,  # noqa: ARG001  nothing is left out
) -> int:
    """List the templates, or the variables of the template with this NAME or in this FOLDER."""
    from wsgen.templating.template import load_template, template_names

    if is_check:
        if name is None:
            raise RequestError(
                "--check needs a template.", hint="Give its folder: wsgen templates --check FOLDER"
            )
        return _check(name, output_format)
    templates = [load_template(one) for one in ([name] if name else template_names())]
    if output_format == "json":
        from wsgen.reporting.json_report import render_templates

        echo(render_templates(templates), nl=False)
    elif name:
        echo("\n".join(_describe(templates[0], quiet=quiet)))
    else:
        from wsgen.cli.terminal import draw_table

        rows = [(template.name, template.description) for template in templates]
        for line in draw_table(rows, indent="", quiet=quiet):
            echo(line)
    return EXIT_PASSED


def _check(name: str, output_format: str) -> int:
    from wsgen.diagnostics import has_errors

    found = _diagnose(name)
    if output_format == "json":
        from wsgen.reporting.json_report import render_template_check

        echo(render_template_check(found), nl=False)
    else:
        from wsgen.cli.output import render_diagnostics

        for line in render_diagnostics(found):
            echo(line)
        result = "failed" if has_errors(found) else "passed"
        echo(click.style(f"{name}: {result}", bold=True))
    return EXIT_FAILED if has_errors(found) else EXIT_PASSED


def _diagnose(name: str) -> Sequence[Diagnostic]:
    """The diagnostics of template.toml; if it has none, those of its packages."""
    from pathlib import Path

    from wsgen.pipeline.template_check import check_template
    from wsgen.templating.template import is_shipped, load_template, read_template

    if is_shipped(name) or not Path(name).is_dir():
        return check_template(load_template(name))
    template, found = read_template(Path(name))
    return found or check_template(template)


def _describe(template: Template, *, quiet: bool) -> list[str]:
    """The text for one template."""
    from wsgen.cli.terminal import draw_table, fit_lines

    rows = [_row(variable) for variable in template.variables.values()]
    return [
        click.style(template.name, bold=True),
        *fit_lines(
            (
                f"  {template.description}",
                f"  targets: {', '.join(target.name for target in template.targets)}",
            )
        ),
        "",
        *(draw_table(rows, quiet=quiet) or ["  This template has no variables."]),
    ]


def _row(variable: Variable) -> tuple[str, ...]:
    from wsgen.templating.spec import show

    return (f"{variable.name}={show(variable.default)}", variable.expected, variable.help)
