"""`wsgen rule`."""

from __future__ import annotations

import click

from wsgen.cli.options import ExampleCommand, format_option, output_options
from wsgen.cli.terminal import echo
from wsgen.errors import EXIT_PASSED, RequestError


@click.command(cls=ExampleCommand, examples=("wsgen rule", "wsgen rule massless-root"))
@click.argument("name", metavar="[CODE|NAME]", required=False)
@format_option
@output_options
def command(
    name: str | None,
    *,
    output_format: str,
    quiet: bool,
    verbose: bool,  # noqa: ARG001  nothing is left out
) -> int:
    """List all rules, or show the documentation of the rule with this CODE or NAME."""
    from wsgen.checks.rules.catalogue import all_rules, find_rule, to_markdown
    from wsgen.cli.terminal import draw_markdown, draw_table

    rules = all_rules()
    if name is not None:
        rule = find_rule(name)
        if rule is None:
            raise _unknown(name)
        rules = (rule,)
    if output_format == "json":
        from wsgen.reporting.json_report import render_rules

        echo(render_rules(rules), nl=False)
        return EXIT_PASSED
    if name is not None:
        from wsgen.checks.fixes.plan import FIXERS

        text = to_markdown(rules[0], has_fix=rules[0].name in FIXERS)
        lines = draw_markdown(text, quiet=quiet)
    else:
        rows = [(rule.code, rule.severity.value, rule.name, rule.summary) for rule in rules]
        lines = draw_table(rows, indent="", quiet=quiet)
    for line in lines:
        echo(line)
    return EXIT_PASSED


def _unknown(name: str) -> RequestError:
    from wsgen.checks.rules.catalogue import all_rules
    from wsgen.text.suggestions import ask_for_nearest

    names = [one for rule in all_rules() for one in (rule.name, rule.code)]
    return RequestError(
        f"No rule has the code or name {name!r}.",
        hint=f"{ask_for_nearest(name, names)}`wsgen rule` lists all rules.",
    )
