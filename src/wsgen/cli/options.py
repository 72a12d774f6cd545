"""Options that several commands share, and their completion in a shell.

Completion runs while somebody types: nothing is evaluated or simulated, and an error completes
nothing.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import click

from wsgen.errors import RequestError
from wsgen.text.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from pathlib import Path

    from click.shell_completion import CompletionItem

    from wsgen.model.target import Target


Function = TypeVar("Function", bound=Callable[..., Any])


class ExampleCommand(click.Command):
    """A command whose help ends with examples."""

    def __init__(self, *arguments: Any, examples: Sequence[str], **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.examples = examples  # whole command lines

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write them unwrapped; click would wrap long ones."""
        super().format_epilog(ctx, formatter)
        with formatter.section("Examples"):
            for example in self.examples:
                formatter.write(f"{'':{formatter.current_indent}}{example}\n")


class Choice(click.Choice[str]):
    """One of some words; a misspelled one is met with the nearest.

    Args:
        words: That may be given.
        meant: Other names, and the word that each of them means, to be suggested.
    """

    def __init__(self, words: Sequence[str], meant: Mapping[str, str] | None = None) -> None:
        super().__init__(words, case_sensitive=False)
        self.meant = meant or {}

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> str:
        """The word that is given."""
        try:
            return super().convert(value, param, ctx)
        except click.BadParameter as error:
            near = self.meant.get(value.lower()) or nearest(value.lower(), self.choices)
            if near is None:
                raise
            raise RequestError(f"{error.format_message()}", hint=did_you_mean(near)) from error


workspace_option = click.option(
    "-w",
    "--workspace",
    type=click.Path(file_okay=False),
    metavar="DIR",
    help="Colcon workspace.  [default: the workspace around the current folder]",
)

format_option = click.option(
    "--format",
    "output_format",
    type=Choice(["text", "json"]),
    default="text",
    show_default=True,
    help="Format of the result on standard output.",
)

github_format_option = click.option(
    "--format",
    "output_format",
    type=Choice(["text", "json", "github"]),
    default="text",
    show_default=True,
    help="Format of the result on standard output; `github` annotates the files of a pull request.",
)

distro_option = click.option(
    "--distro",
    envvar="ROS_DISTRO",
    default="iron",
    metavar="NAME",
    help="Target ROS 2 distribution.  [default: $ROS_DISTRO, else iron]",
)

sim_option = click.option(
    "--sim",
    type=Choice(["classic", "gz"], meant={"ign": "gz", "ignition": "gz"}),
    help="Target simulator: Gazebo Classic or Gazebo Sim.  [default: classic on iron, else gz]",
)

argument_option = click.option(
    "--arg",
    "arguments",
    multiple=True,
    metavar="NAME:=VALUE",
    help="Launch argument, or argument of a xacro FILE; can be repeated.",
)

answer_option = click.option(
    "--answer",
    "answers",
    multiple=True,
    metavar="TEXT",
    help="Answer to a question of the launch file; can be repeated.  "
    "[default: lines of standard input, unless that is a terminal]",
)

# Of `wsgen.model.sweep`, which only sweeps load; a test compares them.
RUN_SECONDS = click.FloatRange(min=0.1, max=600.0)

seconds_option = click.option(
    "--seconds",
    type=RUN_SECONDS,
    default=3.0,
    show_default=True,
    help="Simulated time in seconds.",
)


def _engine_option(*more: str, explained: str = "") -> Callable[[Function], Function]:
    meant = {"both": "all", "pybullet": "bullet", "dartsim": "dart"}
    return click.option(
        "--engine",
        type=Choice(["bullet", "dart", "mujoco", *more, "all"], meant=meant),
        help="Physics engine: PyBullet, DART (that of Gazebo Sim; pip install 'wsgen[dart]') or "
        f"MuJoCo (pip install 'wsgen[mujoco]'); {explained}`all` compares those that are "
        "installed.  [default: bullet, or mujoco where PyBullet is not available]",
    )


engine_option = _engine_option()
engine_or_gazebo_option = _engine_option(
    "gazebo",
    explained="`gazebo` compares the default engine with the Gazebo on the PATH (gz sim, ign "
    "gazebo or gzserver), ",
)


def jobs_option(what: str) -> Callable[[Function], Function]:
    """-j, with a help that says what is done so many at a time."""
    return click.option(
        "-j",
        "--jobs",
        type=click.IntRange(min=1, max=256),
        default=1,
        show_default=True,
        metavar="N",
        help=what,
    )


picture_option = click.option(
    "--picture",
    type=click.Path(),
    metavar="DIR",
    help="Directory for a PNG of the final state.",
)


def page_options(function: Function) -> Function:
    """--host, --port and --no-browser, for commands that serve a page."""
    for option in (
        click.option(
            "--host",
            default="127.0.0.1",
            show_default=True,
            metavar="ADDRESS",
            help="Address to listen on; 0.0.0.0 lets other machines open the page.",
        ),
        click.option(
            "--port",
            type=click.IntRange(min=1, max=65535),
            metavar="N",
            help="Port to listen on.  [default: the first free one from 8080]",
        ),
        click.option(
            "--no-browser", is_flag=True, help="Print the address without opening a browser."
        ),
    ):
        function = option(function)
    return function


def chosen_target(ctx: click.Context, distro: str, sim: str | None) -> Target:
    """The target that `distro_option` and `sim_option` select."""
    from click.core import ParameterSource

    from wsgen.model.target import choose_target

    source = ctx.get_parameter_source("distro")
    return choose_target(distro, sim, is_from_environment=source is ParameterSource.ENVIRONMENT)


def chosen_answers(given: Sequence[str]) -> Callable[[], Sequence[str]]:
    """What gives the answers of `answer_option`; standard input is read where they are needed."""
    if given:
        return lambda: given
    import sys
    from threading import Lock

    lock, lines = Lock(), list[str]()

    def read() -> Sequence[str]:
        with lock:  # launch files are evaluated in parallel, and each gets all lines
            if not lines and sys.stdin is not None and not sys.stdin.isatty():
                lines.extend(sys.stdin.read().splitlines())
        return lines

    return read


def chosen_engines(engine: str | None) -> tuple[str, ...]:
    """The engines that `engine_option` selects; results come from the first one."""
    from wsgen.simulation.run import all_engines, default_engine

    if engine == "all":
        return all_engines()
    return (default_engine() if engine in {None, "gazebo"} else engine,)


def chosen_gazebo(engine: str | None) -> Literal["no", "required", "if installed"]:
    """Whether `engine_or_gazebo_option` has the Gazebo of this machine simulate."""
    if engine == "gazebo":
        return "required"
    return "if installed" if engine == "all" else "no"


def _set_color(ctx: click.Context, _parameter: click.Parameter, value: str) -> None:
    # click itself removes colors where the output is not a terminal.
    if value != "auto":
        ctx.color = value == "always"
        if ctx.obj is not None:  # for errors printed after the command has failed
            ctx.obj.wanted = ctx.color


def output_options(function: Function) -> Function:
    """-q, -v and --color, for commands that show progress on standard error."""
    for option in (
        click.option(
            "-q", "--quiet", is_flag=True, help="Show no progress, table headings or next steps."
        ),
        click.option(
            "-v",
            "--verbose",
            is_flag=True,
            help="Show all diagnostics, and the output of other programs.",
        ),
        click.option(
            "--color",
            type=Choice(["auto", "always", "never"]),
            default="auto",
            envvar="WSGEN_COLOR",
            show_default=True,
            is_eager=True,
            expose_value=False,
            callback=_set_color,
            help="When to use colors; with auto, NO_COLOR disables them.",
        ),
    ):
        function = option(function)
    return function


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
