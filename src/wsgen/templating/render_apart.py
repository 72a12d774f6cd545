"""Render a template of the user in a child process, where it can neither hang nor eat memory.

The sandbox keeps a template from the machine, not from counting to 10**18.
"""

from __future__ import annotations

import signal
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.isolation import parent
from wsgen.isolation.outcome import Died, Limits
from wsgen.templating.manifest import refuse
from wsgen.templating.render import render_tree

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import FrameType

    from wsgen.isolation.parent import Run
    from wsgen.model.package import PackageSpec
    from wsgen.templating.manifest import Template
    from wsgen.templating.render import RenderedTree


# Of CPU time, for one package; ours take 0.02. The child stops itself first, where it can say in
# which line.
SECONDS = 5.0
SPARE_SECONDS = 2.0
MEMORY = 2**29  # bytes


class TooSlowError(TimeoutError):
    """A template took longer than it may."""


def render_package_apart(spec: PackageSpec, template: Template) -> RenderedTree:
    """All files of a package, as `render_package` gives them.

    Raises:
        BrokenTemplateError: the template does not give files that can be written.
    """
    tree, faults = render_tree_apart(spec, template)
    refuse(faults, template.folder)
    return tree


def render_tree_apart(
    spec: PackageSpec, template: Template, *, run: Run = parent.run, seconds: float = SECONDS
) -> tuple[RenderedTree, tuple[Diagnostic, ...]]:
    """The files as far as they can be rendered, and what is wrong with the template."""
    answer = run(
        "wsgen.templating.render_apart:render_here",
        *(spec, template, seconds),
        limits=Limits(seconds=seconds + SPARE_SECONDS, memory=MEMORY),
    )
    if isinstance(answer, Died):
        return {}, (
            Diagnostic(
                code="TPL004",
                severity=Severity.ERROR,
                message=f"Rendering the template {answer.reason}.",
                file=template.folder,
                hint=answer.hint("Look for loops and powers of large numbers."),
            ),
        )
    tree: RenderedTree = answer.value["tree"]
    return tree, tuple(_read_fault(fault) for fault in answer.value["faults"])


def render_here(spec: PackageSpec, template: Template, seconds: float) -> dict[str, Any]:
    """What the child does; its answer is JSON."""

    def stop(_number: int, _frame: FrameType | None) -> None:
        raise TooSlowError(f"the template needs more than {seconds:g} s of CPU time")

    signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    tree, faults = render_tree(spec, template)
    signal.setitimer(signal.ITIMER_PROF, 0)
    return {"tree": tree, "faults": [_write_fault(fault) for fault in faults]}


def _write_fault(fault: Diagnostic) -> Sequence[object]:
    file = None if fault.file is None else str(fault.file)
    return (fault.code, fault.message, file, fault.line, fault.element, fault.hint)


def _read_fault(values: Sequence[Any]) -> Diagnostic:
    code, message, file, line, element, hint = values
    return Diagnostic(
        code=code,
        severity=Severity.ERROR,
        message=message,
        file=None if file is None else Path(file),
        line=line,
        element=element,
        hint=hint,
    )
