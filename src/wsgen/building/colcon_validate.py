"""What `colcon validate` does: a job for each package, each with a `wsgen validate` of its own."""

from __future__ import annotations

import json
import os
import signal
import sys
from collections import OrderedDict
from itertools import takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from colcon_core.argument_default import wrap_default_value
from colcon_core.argument_type import get_cwd_path_resolver
from colcon_core.event.command import Command, CommandEnded
from colcon_core.event.output import StderrLine, StdoutLine
from colcon_core.event_handler import add_event_handler_arguments
from colcon_core.executor import Job, OnError, add_executor_arguments, execute_jobs
from colcon_core.package_selection import add_arguments as add_packages_arguments
from colcon_core.package_selection import get_packages
from colcon_core.subprocess import run
from colcon_core.task import TaskContext, TaskExtensionPoint
from colcon_core.verb import check_and_mark_build_tool

from wsgen.building.toolchain import EXECUTOR, IN_ORDER
from wsgen.errors import EXIT_FAILED, EXIT_PASSED, EXIT_SIGNALLED
from wsgen.text.files import read_regular_text
from wsgen.text.printable import clean
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator, Sequence


RESULT = "wsgen_validate"  # the name of the result files, below build/PACKAGE
# As the command line of wsgen knows them; it refuses what is none of them.
ENGINES = ("bullet", "dart", "mujoco", "gazebo", "all")
# Exit codes of a process that Ctrl-C or a job's end stops; negative before wsgen takes signals.
INTERRUPTED = {
    *(EXIT_SIGNALLED + number for number in (signal.SIGINT, signal.SIGTERM)),
    *(-number for number in (signal.SIGINT, signal.SIGTERM)),
}
MOST_SHOWN = 3  # errors of a package, in the summary


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of the verb, and those by which colcon selects packages and runs jobs."""
    parser.add_argument(
        "--build-base",
        default=wrap_default_value("build"),
        type=get_cwd_path_resolver(),
        help="The base path for the result files, which `colcon test-result` reads "
        "(default: %(default)s)",
    )
    parser.add_argument(
        "--install-base",
        default=wrap_default_value("install"),
        type=get_cwd_path_resolver(),
        help="The base path of the packages that are built (default: %(default)s)",
    )
    parser.add_argument(
        "--launch",
        metavar="FILE",
        help="Name of the launch file of each package (default: all that spawn a robot)",
    )
    parser.add_argument(
        "--arg",
        action="append",
        default=[],
        metavar="NAME:=VALUE",
        help="Launch argument; can be repeated",
    )
    parser.add_argument("--engine", choices=ENGINES, help="Physics engine (default: bullet)")
    parser.add_argument(
        "--seconds", type=float, metavar="SECONDS", help="Simulated time (default: 3)"
    )
    parser.add_argument(
        "--picture",
        type=get_cwd_path_resolver(),
        metavar="DIR",
        help="Directory for a PNG of the final state of each robot",
    )
    parser.add_argument(
        "--abort-on-error",
        action="store_true",
        help="Abort after the first package that fails",
    )
    _add_executor_arguments(parser)
    add_event_handler_arguments(parser)
    add_packages_arguments(parser)


def _add_executor_arguments(parser: argparse.ArgumentParser) -> None:
    """Let the executor be the one that colcon prefers: no package needs another one's result."""
    before = os.environ.pop(EXECUTOR, None) if IN_ORDER in os.environ else None
    try:
        add_executor_arguments(parser)
    finally:
        if before is not None:
            os.environ[EXECUTOR] = before


def validate(context: Any) -> int:
    """Validate the packages that the arguments select; the exit code."""
    args = context.args
    check_and_mark_build_tool(args.build_base)
    # As `colcon build` does: what lies there are no packages.
    Path(args.build_base, "COLCON_IGNORE").touch()
    decorators = get_packages(args, recursive_categories=("run",))
    jobs: OrderedDict[str, Job] = OrderedDict()
    # Without `..`, and with the links that they are given by.
    folders = [os.path.abspath(one.descriptor.path) for one in decorators]  # noqa: PTH100
    for decorator in decorators:
        if decorator.selected:
            package = decorator.descriptor
            jobs[package.name] = _job(package, args, folders)
    on_error = OnError.interrupt if args.abort_on_error else OnError.continue_
    code: int = execute_jobs(context, jobs, on_error=on_error)
    for line in _summary([job.task for job in jobs.values()]):
        print(line)  # noqa: T201  colcon's verbs print their results
    return code


def _job(package: Any, args: argparse.Namespace, folders: Sequence[str]) -> Job:
    folder = Path(args.build_base, package.name).absolute()
    # None depends on another one: what is built is validated.
    task_context = TaskContext(pkg=package, args=args, dependencies=OrderedDict())
    return Job(
        identifier=package.name,
        dependencies=set(),
        task=ValidateTask(package.name, folder, folders),
        task_context=task_context,
    )


class ValidateTask(TaskExtensionPoint):  # type: ignore[misc]  # colcon is not typed
    """Validates one package in a process of its own."""

    TASK_NAME = "validate"

    def __init__(self, package: str, folder: Path, folders: Sequence[str] = ()) -> None:
        super().__init__()
        self.package = package
        self.folders = folders  # of all packages, which this one may need
        self.folder = folder  # for the result files
        self.result: Result | None = None  # None: it was not validated to the end
        self.problem = ""  # why not, in the words of wsgen
        self.has_ended = False  # False: it was not started, or interrupted

    async def validate(self) -> int:
        """Run wsgen, and show what it prints; the exit code."""
        self.folder.mkdir(parents=True, exist_ok=True)
        report = self.folder / f"{RESULT}.json"
        for old in (report, report.with_suffix(".xml")):
            old.unlink(missing_ok=True)
        words = _words(self.package, self.folder, self.folders, self.context.args)
        post = self.context.put_event_into_queue
        reported: list[bytes] = []  # its progress, or why it cannot do what it is asked for

        def notify(line: bytes) -> None:
            reported.append(line)
            post(StdoutLine(line))  # what is on standard error is a problem to colcon

        here = str(Path.cwd())
        post(Command(words, cwd=here, env=None, shell=False))
        done = await run(words, lambda line: post(StdoutLine(line)), notify, cwd=here)
        code: int = done.returncode
        post(CommandEnded(words, cwd=here, env=None, shell=False, returncode=code))
        self.has_ended = code not in INTERRUPTED
        self.result = read_result(report) if code in {EXIT_PASSED, EXIT_FAILED} else None
        if self.result is None:
            for line in reported:
                post(StderrLine(line))
            texts = [line.decode(errors="replace").rstrip() for line in reported]
            self.problem = _problem(texts)
            return code or EXIT_FAILED
        # colcon shows standard error of jobs that fail, and nothing else.
        for text in self.result.errors:
            post(StderrLine(f"{text}\n".encode()))
        return code


def _words(
    package: str, folder: Path, folders: Sequence[str], args: argparse.Namespace
) -> list[str]:
    """The command line for a package."""
    words = [sys.executable, "-m", "wsgen", "validate", package, "--workspace", str(Path.cwd())]
    # Packages may be anywhere, and installed anywhere; wsgen would look below the current folder.
    words += ["--install-base", str(args.install_base)]
    words += [word for one in folders for word in ("--package-folder", str(Path(one).absolute()))]
    words += ["--json", str(folder / f"{RESULT}.json"), "--junit", str(folder / f"{RESULT}.xml")]
    for option in ("launch", "engine", "seconds", "picture"):
        value = getattr(args, option)
        if value is not None:
            words += [f"--{option}", str(value)]
    for argument in args.arg:
        words += ["--arg", argument]
    return words


@dataclass(frozen=True, kw_only=True)
class Result:
    """What came out of a package."""

    passed: bool
    robots: int
    errors: tuple[str, ...] = ()  # with their places
    hints: tuple[str, ...] = ()  # of these errors
    pictures: tuple[str, ...] = ()
    skipped: tuple[str, ...] = ()  # why nothing of it was simulated


def _problem(said: Sequence[str]) -> str:
    """The first error that wsgen wrote, with what to do about it."""
    lines = iter(said)
    error = next((line for line in lines if line.startswith("error: ")), "")
    hints = takewhile(lambda line: line.startswith("  try: "), lines)
    return "\n".join((error, *hints)) if error else ""


def read_result(file: Path) -> Result | None:
    """What the JSON of `wsgen validate` says; None where it was not written."""
    try:
        document = json.loads(read_regular_text(file))
    except (OSError, ValueError):
        return None
    packages = document["packages"]
    errors = [
        one for package in packages for one in package["diagnostics"] if one["severity"] == "error"
    ]
    return Result(
        passed=document["passed"],
        robots=sum(len(package["robots"]) for package in packages),
        errors=tuple(clean(_line(one)) for one in errors),
        hints=tuple(clean(one["hint"] or "") for one in errors),
        pictures=tuple(clean(package["picture"]) for package in packages if package["picture"]),
        skipped=()
        if packages
        else tuple(clean(one["reason"]) for one in document["not_validated"])
        or ("nothing to validate",),
    )


def _line(found: dict[str, Any]) -> str:
    place = ":".join(str(part) for part in (found["file"], found["line"]) if part is not None)
    text = f"error[{found['code']}] {found['name']}: {found['message']}"
    return f"{place}: {text}" if place else text


class _Sorted(NamedTuple):
    """The tasks by what came out of them."""

    passed: list[ValidateTask]
    failed: list[ValidateTask]
    skipped: list[ValidateTask]
    not_ended: list[ValidateTask]


def _sort(tasks: Sequence[ValidateTask]) -> _Sorted:
    found = _Sorted([], [], [], [])
    for task in tasks:
        result = task.result
        if not task.has_ended:
            found.not_ended.append(task)
        elif result is None or not result.passed:
            found.failed.append(task)
        elif result.skipped:
            found.skipped.append(task)
        else:
            found.passed.append(task)
    return found


def _summary(tasks: Sequence[ValidateTask]) -> Iterator[str]:
    """How many passed, why others did not, and what has no robot."""
    if not tasks:  # colcon itself says nothing about that, and it is no error to it
        yield ""
        yield "Robots: no package is selected"
        yield "  try: Go to the folder that contains src, and check the names that you select."
        return
    found = _sort(tasks)
    numbers = {"passed": found.passed, "failed": found.failed, "skipped": found.skipped}
    if found.not_ended:
        numbers["not validated"] = found.not_ended
    yield ""
    yield "Robots: " + ", ".join(
        f"{len(those)} package{'' if len(those) == 1 else 's'} {what}"
        for what, those in numbers.items()
    )
    for task in found.failed:
        yield f"  {task.package} failed"
        if task.result is None:
            lines = task.problem.splitlines() or ["it was not validated to the end"]
            yield from (f"    {line}" for line in lines)
            continue
        errors = list(zip(task.result.errors, task.result.hints, strict=True))
        for error, hint in errors[:MOST_SHOWN]:
            yield f"    {error}"
            if hint:
                yield f"      try: {hint}"
        if len(errors) > MOST_SHOWN:
            yield f"    and {len(errors) - MOST_SHOWN} more errors"
        yield from (f"    picture: {picture}" for picture in task.result.pictures)
    for task in found.skipped:
        reasons = task.result.skipped if task.result else ()
        yield f"  {task.package} skipped: {'; '.join(dict.fromkeys(reasons))}"
