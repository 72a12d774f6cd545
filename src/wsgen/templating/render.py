"""Render a package: PackageSpec and Template -> the texts of its files. It writes no package."""

from __future__ import annotations

import unicodedata
from pathlib import Path
from typing import TYPE_CHECKING, cast

from wsgen import __version__
from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.model.package import WINDOWS_DEVICES
from wsgen.model.target import image
from wsgen.templating.environment import Environment, describe_error, syntax_place
from wsgen.templating.sources import ENDING, SourceError, find_source, is_past
from wsgen.templating.states import made_of
from wsgen.templating.template import MANIFEST, refuse
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    import re
    from collections.abc import Callable, Iterable, Iterator, Mapping
    from types import TracebackType

    from wsgen.model.package import PackageSpec
    from wsgen.model.target import Target
    from wsgen.templating.template import Template


MISSING_SOURCE = Rule(
    code="TPL003",
    name="missing-template-source",
    severity=Severity.ERROR,
    summary="A source that template.toml names is missing or outside of the template's folder.",
    why="`wsgen` renders each file of a package from its source, and does not read other files.",
    example="""[files]
"model/robot.xacro" = "../robot.xacro.j2\"""",
    instead="""[files]
"model/robot.xacro" = "robot.xacro.j2\"""",
)
FAILING_TEMPLATE = Rule(
    code="TPL004",
    name="failing-template",
    severity=Severity.ERROR,
    summary="A source of a template cannot be rendered.",
    what="Renders the sources with Jinja2 in a sandbox, with limits of time, memory and size.",
    why="`wsgen` writes no package with missing files. An undefined name is an error, as it would "
    "be an empty text in a file.",
    example='<mass value="{{ package.answers.mas }}"/>',
    instead='<mass value="{{ package.answers.mass }}"/>',
)
INVALID_PATH = Rule(
    code="TPL005",
    name="impossible-package-path",
    severity=Severity.ERROR,
    summary="A path of a file cannot be in a package, or a required file is missing.",
    what="Checks the paths in `[files]` of template.toml, with names filled in; package.xml and "
    "wsgen.toml are required.",
    why="A package must be usable on Linux, macOS and Windows, and colcon must find it.",
    example="""[files]
"build/robot.xacro" = "robot.xacro.j2\"""",
    instead="""[files]
"model/robot.xacro" = "robot.xacro.j2\"""",
)

MAXIMUM_BYTES = 255  # of one name, on most disks
MAXIMUM_PATH = 400  # characters: below the folders of a workspace it becomes longer
# Folders that colcon and git create: what lies there is not the package's.
RESERVED_FOLDERS = frozenset({"build", "install", "log", ".git"})
# colcon would ignore the package.
RESERVED_FILES = frozenset({"colcon_ignore", "ament_ignore", "catkin_ignore"})

_NAME = lazy_pattern(r"\{\{ *([a-z_.0-9]+) *\}\}")
_WINDOWS_CANNOT = frozenset('<>:"|?*\\')


class PathError(Exception):
    """A path that a package cannot have; the message is a clause that says why."""


def fill_in(pattern: str, spec: PackageSpec) -> str:
    """Fill in names: `{{ package.name }}` and the like.

    Raises:
        PathError: the pattern has another name, or a package cannot have the path.
    """
    names = _names(spec)

    def name(match: re.Match[str]) -> str:
        try:
            return names[match[1]]
        except KeyError:
            raise PathError(
                f"{match[0]} is not allowed in a path; these are: {', '.join(names)}"
            ) from None

    path = _NAME.sub(name, pattern)
    if "{" in path or "}" in path:
        raise PathError("it has other braces than those of names such as {{ package.name }}")
    problem = check_path(path)
    if problem is not None:
        raise PathError(problem)
    return path


def check_path(path: str) -> str | None:
    """Return why a package cannot have a path; None if it can."""
    return next(_problems(path), None)


def _problems(path: str) -> Iterator[str]:
    parts = path.split("/")
    if not {"", ".", ".."}.isdisjoint(parts):
        yield "it is not a path below the package's folder with single slashes"
    if not path.isprintable():
        yield "it has a character that does not print"
    elif len(path) > MAXIMUM_PATH or any(len(part.encode()) > MAXIMUM_BYTES for part in parts):
        yield "it is too long"
    for part in parts:
        if not _WINDOWS_CANNOT.isdisjoint(part) or part != part.strip(" ").rstrip("."):
            yield f"{part!r} is not a valid name on Windows"
        if part.split(".")[0].lower() in WINDOWS_DEVICES:
            yield f"{part!r} is a device on Windows"
    if parts[0].lower() in RESERVED_FOLDERS:
        yield f"{parts[0]!r} is a folder that colcon or git creates"
    if parts[-1].lower() in RESERVED_FILES:
        yield f"colcon ignores a package with a file {parts[-1]!r}"


def find_collision(paths: Iterable[str]) -> tuple[str, str] | None:
    """Find two paths that are equal on some disks, or of which one needs the other as a folder."""
    known: dict[str, str] = {}
    folders: dict[str, str] = {}
    for path in paths:
        # macOS and Windows ignore case, macOS also how accents are encoded.
        same = unicodedata.normalize("NFC", path).casefold()
        if same in known:
            return known[same], path
        known[same] = path
        while "/" in same:
            same = same.rpartition("/")[0]
            folders.setdefault(same, path)
    for same, path in known.items():
        if same in folders:
            return path, folders[same]
    return None


def _names(spec: PackageSpec) -> dict[str, str]:
    """The names that a path may have in it, and their values."""
    return {
        "package.name": spec.name,
        "package.target.distro": spec.target.distro,
        "package.target.simulator": spec.target.simulator,
        **{
            f"package.answers.{name}": value
            for name, value in spec.answers.items()
            if isinstance(value, str)
        },
    }


def report_error(error: Exception, *, path: str, source: str, folder: Path) -> Diagnostic:
    """Report an exception while the file at `path` in the package was rendered from `source`."""
    file, line = _find_place(error)
    if file is None:
        try:
            file = find_source(source, folder)
        except SourceError:  # the source itself is missing
            file = folder
    message, hint = describe_error(error)
    return FAILING_TEMPLATE.at(file, line, path, message=message, hint=hint)


def _find_place(error: Exception) -> tuple[Path | None, int | None]:
    """Find file and line of the innermost template that the exception passed through."""
    place: tuple[Path | None, int | None] = syntax_place(error)
    step: TracebackType | None = error.__traceback__
    while step is not None:
        name = step.tb_frame.f_code.co_filename
        # Jinja2 replaces the lines of its own code by those of the sources.
        if name.endswith(ENDING):
            place = (Path(name), step.tb_lineno)
        step = step.tb_next
    return place


# Path in the package, with slashes -> text of the file.
RenderedTree = dict[str, str]

MAXIMUM_FILE = 2**20  # characters: a loop may write without end
MAXIMUM_TREE = 2**23
# A package needs the first, and `wsgen update` will need the second.
NEEDED = ("package.xml", "wsgen.toml")
# Folders that only the build reads.
ONLY_FOR_BUILDING = {"cmake", "hooks", "scripts", "test"}


class TooLargeError(Exception):
    """A template renders more text than is allowed."""


def render_package(
    spec: PackageSpec, template: Template, added: Mapping[str, object] | None = None
) -> RenderedTree:
    """Render all files of a package, sorted by path; each text ends with a line end.

    `added` are more names for the sources, as for `render_tree`. This runs the template in this
    process; `render_apart` runs one of the user's.

    Raises:
        BrokenTemplateError: a file cannot be rendered, or not be written.
    """
    tree, diagnostics = render_tree(spec, template, added=added)
    refuse(diagnostics, template.folder)
    return tree


def render_tree(
    spec: PackageSpec,
    template: Template,
    *,
    environment: Environment | None = None,
    wanted: Callable[[str], bool] | None = None,
    added: Mapping[str, object] | None = None,
) -> tuple[RenderedTree, tuple[Diagnostic, ...]]:
    """Render the files as far as possible, and report the mistakes in the template.

    An environment for the folder of the template, if one is there already, has read its sources.
    `wanted` chooses files by their paths; None: all. `added` are more names for the sources, also
    in place of `made_of` and `wsgen_version`; its `files` are paths that the package has besides.
    """
    sources, diagnostics = _place(spec, template)
    if diagnostics:
        return {}, tuple(diagnostics)
    environment = environment or Environment(template.folder)
    added = added or {}
    files = sorted({*sources, *cast("Iterable[str]", added.get("files", ()))})
    context = {
        "made_of": made_of(template),
        "wsgen_version": __version__,
        **added,
        "package": spec,
        "variables": template.variables,
        "files": files,
        "folders": installed_folders(files),
    }
    tree: RenderedTree = {}
    for path in sorted(sources if wanted is None else filter(wanted, sources)):
        error = _render_into(tree, path, environment, sources[path], context)
        if error is not None:
            diagnostics.append(
                report_error(error, path=path, source=sources[path], folder=template.folder)
            )
        if isinstance(error, TimeoutError):  # no time is left for the others
            break
    if not is_past():  # compiled templates are kept by their names
        environment.keep_compiled()
    return tree, tuple(diagnostics)


def installed_folders(files: Iterable[str]) -> list[str]:
    """List the folders of a package that its users need, sorted."""
    folders = {path.partition("/")[0] for path in files if "/" in path}
    return sorted(folders - ONLY_FOR_BUILDING)


def _render_into(
    tree: RenderedTree,
    path: str,
    environment: Environment,
    source: str,
    context: Mapping[str, object],
) -> Exception | None:
    """Add a file to the tree, or return the exception that its source raises."""
    left = min(MAXIMUM_FILE, MAXIMUM_TREE - sum(map(len, tree.values())))
    pieces = []
    try:
        for piece in environment.get_template(source).generate(context):
            left -= len(piece)
            if left < 0:
                return TooLargeError(
                    f"the rendered text is too large: the limits are {MAXIMUM_FILE} characters a"
                    f" file and {MAXIMUM_TREE} a package"
                )
            pieces.append(piece)
    except Exception as error:  # noqa: BLE001  expressions in templates raise anything
        return error
    text = "".join(pieces)
    tree[path] = text if text.endswith("\n") or not text else f"{text}\n"
    return None


def _place(spec: PackageSpec, template: Template) -> tuple[dict[str, str], list[Diagnostic]]:
    """Return the path in the package -> name of the source, and report invalid ones."""
    placed: dict[str, str] = {}
    diagnostics = []
    for pattern, source in template.sources(spec.target, spec.answers).items():
        path = _place_one(pattern, source, spec, template)
        if isinstance(path, Diagnostic):
            diagnostics.append(path)
        else:
            placed[path] = source
    collision = find_collision(placed)
    if collision is not None:
        one, other = collision
        diagnostics.append(
            _invalid_path(
                template, f"The paths {one!r} and {other!r} exclude each other on some disks."
            )
        )
    for path in NEEDED:
        if path not in placed and not diagnostics:
            diagnostics.append(_invalid_path(template, f"The template does not create {path!r}."))
    return placed, diagnostics


def _place_one(
    pattern: str, source: str, spec: PackageSpec, template: Template
) -> str | Diagnostic:
    try:
        path = fill_in(pattern, spec)
        find_source(source, template.folder)
    except PathError as error:
        return _invalid_path(template, f"The path {pattern!r} cannot be in a package: {error}.")
    except SourceError as error:
        return _missing_source(template, pattern, f"The source {source!r} {error}.")
    return path


def _invalid_path(template: Template, message: str) -> Diagnostic:
    return INVALID_PATH.at(
        template.folder / MANIFEST,
        element="files",
        message=message,
        hint='Change [files]; `extends = "base"` adds the files that every package has.',
    )


def _missing_source(template: Template, pattern: str, message: str) -> Diagnostic:
    return MISSING_SOURCE.at(
        template.folder / MANIFEST,
        element=f"files.{pattern}",
        message=message,
        hint=f"Write the source below {template.folder}, or change [files].",
    )


# Service -> path of its workflow in the repository, and the source.
WORKFLOWS = {
    "github": (".github/workflows/wsgen.yml", "wsgen:workspace/github.yml.j2"),
    "gitlab": (".gitlab-ci.yml", "wsgen:workspace/gitlab.yml.j2"),
}
# The newest that has wheels of PyBullet (pyproject.toml); on a newer one wsgen takes MuJoCo.
NEWEST_PYTHON = (3, 13)


def render_source(source: str, **names: object) -> str:
    """Render a source that belongs to no template, such as `wsgen:added/node.py.j2`."""
    environment = Environment(Path())
    text = environment.get_template(source).render(**names)
    environment.keep_compiled()
    return text


def render_workflow(service: str, target: Target) -> RenderedTree:
    """Render the workflow of a service (a key of WORKFLOWS), by its path in the workspace.

    It builds and validates on the Python of the target, which will run the launch files, and on
    the newest Python with PyBullet.
    """
    path, source = WORKFLOWS[service]
    python = tuple(int(part) for part in target.fact("python").split("."))
    versions = [".".join(map(str, version)) for version in sorted({python, NEWEST_PYTHON})]
    text = render_source(
        source, target=target, image=image(target), pythons=versions, wsgen_version=__version__
    )
    return {path: text}
