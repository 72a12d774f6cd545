"""`wsgen templates`."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from wsgen.cli.completion import complete_templates
from wsgen.cli.options import ExampleCommand, format_option, output_options
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, RequestError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.templating.manifest import Template
    from wsgen.templating.variables import Variable


@click.command(
    cls=ExampleCommand,
    examples=("wsgen templates simple", "wsgen templates --check my_templates/crane"),
)
@click.argument("name", metavar="[NAME|FOLDER]", required=False, shell_complete=complete_templates)
@click.option(
    "--check",
    "is_check",
    is_flag=True,
    help="Render it for every target, and try what comes out as `wsgen validate` does.",
)
@format_option
@output_options
def command(
    name: str | None,
    *,
    is_check: bool,
    output_format: str,
    quiet: bool,  # noqa: ARG001  there is no progress to hide
    verbose: bool,  # noqa: ARG001  nothing is left out
) -> int:
    """List the templates; with a NAME or the FOLDER of one, its variables."""
    from wsgen.templating.manifest import load_template, template_names

    if is_check:
        if name is None:
            raise RequestError(
                "--check needs a template.", hint="Name its folder: wsgen templates --check FOLDER"
            )
        return _check(name, output_format)
    templates = [load_template(one) for one in ([name] if name else template_names())]
    if output_format == "json":
        from wsgen.report.json_report import render_templates

        click.echo(render_templates(templates), nl=False)
    elif name:
        click.echo("\n".join(_describe(templates[0])))
    else:
        width = max(len(template.name) for template in templates)
        for template in templates:
            click.echo(f"{template.name:{width}}  {template.description}")
    return EXIT_PASSED


def _check(name: str, output_format: str) -> int:
    from wsgen.diagnostics import has_errors

    found = _find_faults(name)
    if output_format == "json":
        from wsgen.report.json_report import render_template_check

        click.echo(render_template_check(found), nl=False)
    else:
        from wsgen.cli.output import render_findings

        for line in render_findings(found):
            click.echo(line)
        verdict = "failed" if has_errors(found) else "passed"
        click.echo(click.style(f"{name}: {verdict}", bold=True))
    return EXIT_FAILED if has_errors(found) else EXIT_PASSED


def _find_faults(name: str) -> Sequence[Diagnostic]:
    """What is wrong with template.toml; if nothing is, what is wrong with its packages."""
    from pathlib import Path

    from wsgen.pipeline.template_check import check_template
    from wsgen.templating.manifest import is_shipped, load_template, read_template

    if is_shipped(name) or not Path(name).is_dir():
        return check_template(load_template(name))
    template, faults = read_template(Path(name))
    return faults or check_template(template)


def _describe(template: Template) -> list[str]:
    """What a person reads of one template."""
    return [
        click.style(template.name, bold=True),
        f"  {template.description}",
        f"  targets: {', '.join(target.name for target in template.targets)}",
        "",
        *_table([_row(variable) for variable in template.variables.values()]),
    ]


def _row(variable: Variable) -> tuple[str, ...]:
    from wsgen.templating.variables import show

    return (f"{variable.name}={show(variable.default)}", variable.expected, variable.help)


def _table(rows: Sequence[tuple[str, ...]]) -> list[str]:
    if not rows:
        return ["  It has no variables."]
    widths = [max(len(row[column]) for row in rows) for column in range(2)]
    return [f"  {one:{widths[0]}}  {two:{widths[1]}}  {three}" for one, two, three in rows]
