"""`wsgen rule`."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from wsgen.cli.options import ExampleCommand, format_option, output_options
from wsgen.errors import EXIT_PASSED, RequestError

if TYPE_CHECKING:
    from wsgen.diagnostics import Rule


@click.command(cls=ExampleCommand, examples=("wsgen rule", "wsgen rule massless-root"))
@click.argument("name", metavar="[CODE|NAME]", required=False)
@format_option
@output_options
def command(
    name: str | None,
    *,
    output_format: str,
    quiet: bool,  # noqa: ARG001  there is no progress to hide
    verbose: bool,  # noqa: ARG001  nothing is left out
) -> int:
    """List all rules, or show the documentation of the one with this CODE or NAME."""
    from wsgen.rules.catalogue import all_rules, find_rule, to_markdown

    rules = all_rules()
    if name is not None:
        rule = find_rule(name)
        if rule is None:
            raise _unknown(name)
        rules = (rule,)
    if output_format == "json":
        from wsgen.report.json_report import render_rules

        click.echo(render_rules(rules), nl=False)
    elif name is not None:
        _show(to_markdown(rules[0]))
    else:
        _list(rules)
    return EXIT_PASSED


def _unknown(name: str) -> RequestError:
    import difflib

    from wsgen.rules.catalogue import all_rules

    names = [one for rule in all_rules() for one in (rule.name, rule.code)]
    near = difflib.get_close_matches(name, names, n=1)
    hint = f"Did you mean {near[0]!r}? " if near else ""
    return RequestError(
        f"No rule has the code or the name {name!r}.", hint=f"{hint}`wsgen rule` lists all rules."
    )


def _show(text: str) -> None:
    """Draw Markdown on a terminal; elsewhere it stays text."""
    if sys.stdout is None or not sys.stdout.isatty():
        click.echo(text, nl=False)
        return
    from rich.console import Console
    from rich.markdown import Markdown

    color = click.get_current_context().color
    Console(no_color=color is False).print(Markdown(text))


def _list(rules: tuple[Rule, ...]) -> None:
    width = max(len(rule.name) for rule in rules)
    for rule in rules:
        click.echo(f"{rule.code}  {rule.severity.value:7}  {rule.name:{width}}  {rule.summary}")
