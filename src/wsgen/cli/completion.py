"""Shell completion of packages, launch files and templates.

It runs while somebody types: nothing is evaluated or simulated, and an error completes nothing.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    import click
    from click.shell_completion import CompletionItem


Completer = Callable[["click.Context", "click.Parameter", str], "list[CompletionItem]"]


def _completer(find: Callable[[click.Context], Iterable[str]], *, also: str = "") -> Completer:
    """Complete what `find` returns, and `also` names of a kind that the shell knows: file, dir."""

    def complete(
        ctx: click.Context, _parameter: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        from click.shell_completion import CompletionItem

        names: list[str] = []
        with contextlib.suppress(Exception):
            names = sorted({name for name in find(ctx) if name.startswith(incomplete)})
        # First: bash forgets what comes before it.
        others = [CompletionItem(incomplete, type=also)] if also else []
        return others + [CompletionItem(name) for name in names]

    return complete


def _packages(ctx: click.Context) -> Iterable[str]:
    """The packages of the workspace that are not on the command line yet."""
    from wsgen.packages.workspace.layout import find_packages, open_workspace

    named = {*(ctx.params.get("packages") or ()), *(ctx.params.get("names") or ())}
    place = open_workspace(ctx.params.get("workspace"))
    return [one.name for one in find_packages(place) if one.name not in named]


def _launch_files(ctx: click.Context) -> Iterable[str]:
    """The launch files of the packages on the command line; of all packages if none is."""
    from wsgen.packages.workspace.layout import find_launch_files

    # Behind `--launch`, whose value is still to come, click has not sorted the words yet.
    named = ctx.params.get("names") or ctx.args or _packages(ctx)
    return [file.name for name in named for file in find_launch_files(_share(ctx, name))]


def _share(ctx: click.Context, package: str) -> Path:
    """The installed share folder of a package; its source if it is not built.

    Raises:
        StopIteration: The package does not exist.
    """
    import os
    from pathlib import Path

    from wsgen.packages.workspace.layout import find_packages, open_workspace

    place = open_workspace(ctx.params.get("workspace"))
    sourced = filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep))
    prefixes = (place.install / package, place.install, *map(Path, sourced))
    shares = [prefix / "share" / package for prefix in prefixes]
    sources = [one.path for one in find_packages(place) if one.name == package]
    return next(folder for folder in (*shares, *sources) if folder.is_dir())


def _programs(ctx: click.Context) -> Iterable[str]:
    """The programs of the package on the command line."""
    from wsgen.live.replacements import executables
    from wsgen.packages.workspace.layout import open_workspace

    package = ctx.params["package"]
    install = open_workspace(ctx.params.get("workspace")).install
    return [
        name
        for prefix in (install / package, install)
        for name in executables(prefix / "lib" / package)
    ]


def _templates(_ctx: click.Context) -> Iterable[str]:
    from wsgen.templating.template import template_names

    return template_names()


def _rules(_ctx: click.Context) -> Iterable[str]:
    from wsgen.checks.rules.catalogue import FAMILIES, all_rules

    return [*FAMILIES, *(name for rule in all_rules() for name in (rule.code, rule.name))]


complete_packages = _completer(_packages)
complete_packages_and_files = _completer(_packages, also="file")
complete_programs = _completer(_programs)
complete_launch_files = _completer(_launch_files)
complete_templates = _completer(_templates, also="dir")
complete_rules = _completer(_rules)


def complete_launch_words(
    ctx: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Complete a package or a file, then a launch file of the package, but not its arguments."""
    words = ctx.params.get("words") or ()
    if not words:
        return complete_packages_and_files(ctx, parameter, incomplete)
    if len(words) > 1:
        return []
    ctx.params["names"] = words
    return complete_launch_files(ctx, parameter, incomplete)
