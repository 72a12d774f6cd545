"""PackageSpec and Template -> the texts of the package's files. Writes nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen import __version__
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.templating.environment import Environment
from wsgen.templating.faults import explain
from wsgen.templating.manifest import refuse
from wsgen.templating.manifest_file import MANIFEST
from wsgen.templating.package_paths import PathError, fill_in, find_collision
from wsgen.templating.sources import SourceError, find_source

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.model.package import PackageSpec
    from wsgen.templating.manifest import Template

# Path in the package, with slashes -> text of the file.
RenderedTree = dict[str, str]

MAXIMUM_FILE = 2**20  # characters: a loop that writes for ever is no template
MAXIMUM_TREE = 2**23
# Without them it is no package, or none that `wsgen update` could bring changes to.
NEEDED = ("package.xml", "wsgen.toml")
# Folders that the build reads and nobody after it.
ONLY_FOR_BUILDING = {"cmake", "hooks", "test"}


class TooLargeError(Exception):
    """More text came out of a template than a package can use."""


def render_package(spec: PackageSpec, template: Template) -> RenderedTree:
    """All files of a package, sorted by path; each text ends with a line end.

    This runs the template here and now: one of the user's is for `render_apart`.

    Raises:
        BrokenTemplateError: the template does not give files that can be written.
    """
    tree, faults = render_tree(spec, template)
    refuse(faults, template.folder)
    return tree


def render_tree(
    spec: PackageSpec, template: Template
) -> tuple[RenderedTree, tuple[Diagnostic, ...]]:
    """The files as far as they can be rendered, and what is wrong with the template."""
    sources, faults = _place(spec, template)
    if faults:
        return {}, tuple(faults)
    environment = Environment(template.folder)
    context = {
        "package": spec,
        "variables": template.variables,
        "files": sorted(sources),
        "folders": installed_folders(sources),
        "wsgen_version": __version__,
    }
    tree: RenderedTree = {}
    for path in sorted(sources):
        error = _render_into(tree, path, environment, sources[path], context)
        if error is not None:
            faults.append(explain(error, path=path, source=sources[path], folder=template.folder))
        if isinstance(error, TimeoutError):  # there is no time for the others
            break
    environment.keep_compiled()
    return tree, tuple(faults)


def installed_folders(files: Iterable[str]) -> list[str]:
    """The folders of a package that its users need, sorted."""
    folders = {path.partition("/")[0] for path in files if "/" in path}
    return sorted(folders - ONLY_FOR_BUILDING)


def _render_into(
    tree: RenderedTree,
    path: str,
    environment: Environment,
    source: str,
    context: Mapping[str, object],
) -> Exception | None:
    """Add a file to the tree, or say what keeps its source from being rendered."""
    left = min(MAXIMUM_FILE, MAXIMUM_TREE - sum(map(len, tree.values())))
    pieces = []
    try:
        for piece in environment.get_template(source).generate(context):
            left -= len(piece)
            if left < 0:
                return TooLargeError(
                    f"what is rendered is too large: {MAXIMUM_FILE} characters a file and"
                    f" {MAXIMUM_TREE} a package are the limits"
                )
            pieces.append(piece)
    except Exception as error:  # noqa: BLE001  expressions in templates raise anything
        return error
    text = "".join(pieces)
    tree[path] = text if text.endswith("\n") or not text else f"{text}\n"
    return None


def _place(spec: PackageSpec, template: Template) -> tuple[dict[str, str], list[Diagnostic]]:
    """Path in the package -> name of the source; and paths and sources that cannot be."""
    placed: dict[str, str] = {}
    faults = []
    for pattern, source in template.sources(spec.target, spec.answers).items():
        path = _place_one(pattern, source, spec, template)
        if isinstance(path, Diagnostic):
            faults.append(path)
        else:
            placed[path] = source
    collision = find_collision(placed)
    if collision is not None:
        one, other = collision
        faults.append(
            _misplaced(
                template, f"The paths {one!r} and {other!r} exclude each other on some disk."
            )
        )
    for path in NEEDED:
        if path not in placed and not faults:
            faults.append(_misplaced(template, f"The template makes no {path!r}."))
    return placed, faults


def _place_one(
    pattern: str, source: str, spec: PackageSpec, template: Template
) -> str | Diagnostic:
    try:
        path = fill_in(pattern, spec)
        find_source(source, template.folder)
    except PathError as error:
        return _misplaced(template, f"The path {pattern!r} cannot be in a package: {error}.")
    except SourceError as error:
        return _missing(template, pattern, f"The source {source!r} {error}.")
    return path


def _misplaced(template: Template, message: str) -> Diagnostic:
    return Diagnostic(
        code="TPL005",
        severity=Severity.ERROR,
        message=message,
        file=template.folder / MANIFEST,
        element="files",
        hint='Change [files]; `extends = "base"` brings what every package has.',
    )


def _missing(template: Template, pattern: str, message: str) -> Diagnostic:
    return Diagnostic(
        code="TPL003",
        severity=Severity.ERROR,
        message=message,
        file=template.folder / MANIFEST,
        element=f"files.{pattern}",
        hint=f"Write that file below {template.folder}, or change [files].",
    )
