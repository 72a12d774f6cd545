"""Render a template of the user in a child process, with limits of time and memory.

The sandbox protects the machine from a template, but not from a loop up to 10**18.
"""

from __future__ import annotations

import signal
from collections.abc import Mapping  # noqa: TC003  the type hints of the request are read
from pathlib import Path  # noqa: TC003  same
from types import MappingProxyType
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic  # noqa: TC001  the type hints of the answer are read
from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died, Limits
from wsgen.templating.render import FAILING_TEMPLATE, render_tree
from wsgen.templating.sources import templates_of
from wsgen.templating.template import refuse
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from types import FrameType

    from wsgen.isolation.parent import Run
    from wsgen.model.package import PackageSpec
    from wsgen.templating.render import RenderedTree
    from wsgen.templating.template import Template


# Of CPU time, for one package; ours take 0.02. The child stops itself first, as it knows the line.
SECONDS = 5.0
SPARE_SECONDS = 2.0
MEMORY = 2**29  # bytes


@dataclass(frozen=True)
class RenderRequest:
    """What the child renders."""

    spec: PackageSpec
    template: Template
    seconds: float  # of CPU time, at most
    added: Mapping[str, object]  # more names for the sources, as for `render_tree`
    past: Path | None  # the templates of wsgen of then, if not those of now


@dataclass(frozen=True)
class Rendered:
    """What the child answers."""

    tree: dict[str, str]  # the text of each file, by its path in the package
    diagnostics: tuple[Diagnostic, ...]  # mistakes in the template


class TooSlowError(TimeoutError):
    """A template exceeds its limit of time."""


def render_package_apart(
    spec: PackageSpec,
    template: Template,
    added: Mapping[str, object] = MappingProxyType({}),
    past: Path | None = None,
) -> RenderedTree:
    """Render all files of a package, as `render_package` does.

    `past` has the templates of wsgen of then, if not those of now.

    Raises:
        BrokenTemplateError: a file cannot be rendered, or not be written.
    """
    tree, diagnostics = render_tree_apart(spec, template, added=added, past=past)
    refuse(diagnostics, template.folder)
    return tree


def render_tree_apart(  # noqa: PLR0913  the last two are rare
    spec: PackageSpec,
    template: Template,
    *,
    run: Run = parent.run,
    seconds: float = SECONDS,
    added: Mapping[str, object] = MappingProxyType({}),
    past: Path | None = None,
) -> tuple[RenderedTree, tuple[Diagnostic, ...]]:
    """Render the files as far as possible, and report the mistakes in the template."""
    answer = run(
        "wsgen.templating.render_apart:render_here",
        RenderRequest(spec, template, seconds, dict(added), past),
        limits=Limits(seconds=seconds + SPARE_SECONDS, memory=MEMORY),
    )
    if isinstance(answer, Died):
        return {}, (
            FAILING_TEMPLATE.at(
                template.folder,
                message=f"Rendering the template {answer.reason}.",
                hint=answer.hint("Look for loops and powers of large numbers."),
            ),
        )
    rendered = decode(answer.value, Rendered)
    return rendered.tree, rendered.diagnostics


def render_here(request: RenderRequest) -> Rendered:
    """Render in the child."""

    def stop(_number: int, _frame: FrameType | None) -> None:
        raise TooSlowError(f"the template needs more than {request.seconds:g} s of CPU time")

    has_timer = hasattr(signal, "setitimer")  # Windows has the limit of the child alone
    if has_timer:
        signal.signal(signal.SIGPROF, stop)
        signal.setitimer(signal.ITIMER_PROF, request.seconds)
    with templates_of(request.past):
        tree, diagnostics = render_tree(request.spec, request.template, added=request.added)
    if has_timer:
        signal.setitimer(signal.ITIMER_PROF, 0)
    return Rendered(tree, tuple(diagnostics))
