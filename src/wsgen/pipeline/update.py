"""Update a package: merge what its template has become into what the user has made of it.

Three trees of files are merged: the template of then with the answers of then, the template of now
with the answers of now, and the files that are there. What only one side has changed is taken; no
line of the user goes.
"""

from __future__ import annotations

import os
import shutil
import stat
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen import __version__
from wsgen.errors import RequestError
from wsgen.isolation.parent import make_scratch
from wsgen.model.target import TARGETS, choose_target
from wsgen.packages.workspace.layout import (
    NAMED,
    current_folder,
    find_packages,
    open_workspace,
)
from wsgen.packages.workspace.settings import FILE
from wsgen.pipeline.merged_files import CONFLICT, Change, Merging, bytes_of
from wsgen.pipeline.own_templates import folder_of, made_of_own, unpack_commit
from wsgen.pipeline.package_record import read_record, values_of
from wsgen.pipeline.reported import run_git
from wsgen.templating.history import past_target, unpack
from wsgen.templating.render import render_package
from wsgen.templating.render_apart import render_package_apart
from wsgen.templating.sources import templates_of
from wsgen.templating.spec import check_target, make_maintainer, make_spec, resolve_answers, show
from wsgen.templating.states import made_of
from wsgen.templating.template import is_shipped, load_template
from wsgen.templating.write import remove_leftovers, unfinished_folder
from wsgen.text.files import explain_write_error
from wsgen.text.printable import count_of
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from wsgen.model.package import Answer, PackageSpec
    from wsgen.model.target import Target
    from wsgen.pipeline.package_record import Record
    from wsgen.templating.template import Template

    Tree = Mapping[str, bytes]


MANIFEST = "package.xml"


class UpdateRequest(NamedTuple):
    """What is asked for."""

    settings: Sequence[str] = ()  # NAME=VALUE: answers that change
    distro: str | None = None  # None: as it is
    simulator: str | None = None
    template: str | None = None  # folder of a template of the user, if it has moved
    prefer: str = ""  # OURS or THEIRS in conflicts; empty: mark them


class UpdatePlan(NamedTuple):
    """What an update would do."""

    folder: Path
    template: str
    wsgen: str  # version that made or updated the package last
    changes: tuple[Change, ...]
    notes: tuple[str, ...]  # sentences

    @property
    def writes(self) -> tuple[Change, ...]:
        """Those that write or remove files; that of wsgen.toml last."""
        written = (one for one in self.changes if one.before != one.after)
        return tuple(sorted(written, key=lambda one: one.path == FILE))

    @property
    def conflicts(self) -> tuple[Change, ...]:
        """What the user has to decide."""
        return tuple(one for one in self.changes if one.kind == CONFLICT)


class _Side(NamedTuple):
    """A template, and what a package is made of it with."""

    template: Template
    spec: PackageSpec
    added: Mapping[str, object]  # for its sources
    past: Path | None = None  # the templates of wsgen, if not those of now

    def render(self, entities: Collection[str] = ()) -> dict[str, bytes]:
        spec = replace(self.spec, taken_entities=frozenset(entities))
        if self.template.is_shipped:
            with templates_of(self.past):
                tree = render_package(spec, self.template, self.added)
        else:
            tree = render_package_apart(spec, self.template, self.added, self.past)
        return {path: text.encode() for path, text in tree.items()}


def find_package(given: str | None, workspace: str | None) -> Path:
    """The folder of a package, by its name or folder; by default the one around the current folder.

    Raises:
        RequestError: there is no such package, or several to choose from.
    """
    if given is not None and (Path(given) / MANIFEST).is_file():
        return Path(given).absolute()
    if given is None and workspace is None:
        here = current_folder()
        around = next((one for one in (here, *here.parents) if (one / MANIFEST).is_file()), None)
        if around is not None:
            return around
    folders = {one.name: one.path for one in find_packages(open_workspace(workspace))}
    if given is not None and given in folders:
        return folders[given]
    made = [name for name, path in folders.items() if (path / FILE).is_file()]
    if given is None and len(made) == 1:
        return folders[made[0]]
    if given is not None:
        message = f"The workspace has no package {given!r}."
    else:
        message = f"The workspace has {count_of(len(made), 'package')} of `wsgen new`."
    raise RequestError(
        message,
        hint=f"{ask_for_nearest(given or '', made)}Name one of these: {', '.join(made)}."
        if made
        else "`wsgen update` is for packages of `wsgen new`.",
    )


def plan_update(folder: Path, request: UpdateRequest) -> UpdatePlan:
    """Plan the update of the package in a folder; nothing is written.

    Raises:
        NotFoundError: It has no wsgen.toml, or the template of then or of now is missing.
        NotReadableError: A file cannot be read.
        RequestError: An answer or target is invalid, or what the package was made of is unknown.
        BrokenTemplateError: A template cannot be rendered.
    """
    record = read_record(folder)
    notes: list[str] = []
    with make_scratch() as scratch:
        now = _now(record, request, notes)
        then = _then(record, now, scratch)
        base = then.render()
        entities = _renamed_entities(base, then, folder)
        if entities:
            base = then.render(entities)
        theirs = now.render(entities)
    values = values_of(
        wsgen=__version__,
        template=record.template,
        made_of=now.added["made_of"],  # type: ignore[arg-type]
        distro=now.spec.target.distro,
        simulator=now.spec.target.simulator,
        answers=now.spec.answers,
    )
    label = f"template {record.template} (wsgen {__version__})"
    merging = Merging(folder, base, theirs, values, request.prefer, label)
    changes = tuple(merging.changes())
    return UpdatePlan(folder, record.template, record.wsgen, changes, tuple(notes))


def _now(record: Record, request: UpdateRequest, notes: list[str]) -> _Side:
    """What the package is made of now."""
    is_own = not is_shipped(record.template) or "folder" in record.made_of
    if is_own and "folder" not in record.made_of and request.template is None:
        raise RequestError(
            f"{record.line_of('template')}: this wsgen has no template {record.template!r}.",
            hint="If it is one of yours, name its folder: --template FOLDER. If wsgen had it, use "
            f"wsgen {record.wsgen}.",
        )
    if not is_own and request.template is not None:
        raise RequestError(
            f"The package was made of wsgen's template {record.template!r}, not of a folder.",
            hint="Omit --template.",
        )
    name = record.template
    if is_own:
        name = str(folder_of(record.made_of, request.template, name))
    template = load_template(name)
    target = _target(record, request)
    answers = _answers(record, template, request.settings, notes)
    package = record.package
    try:
        spec = make_spec(
            package["name"],
            template=template,
            target=target,
            maintainer=make_maintainer(package["maintainer_name"], package["maintainer_email"]),
            license_name=package["license"],
            description=package["description"],
        )
    except RequestError as error:
        check_target(template, target)  # a mistake of the request, not of the file
        raise RequestError(
            f"{record.line_of('package')}: {error.message}", hint=error.hint
        ) from error
    spec = replace(spec, answers=answers, dependencies=template.dependencies(target, answers))
    made = made_of_own(template) if is_own else made_of(template)
    return _Side(template, replace(spec, template=record.template), {"made_of": made})


def _target(record: Record, request: UpdateRequest) -> Target:
    """The target of now: that of then, but for what is asked for."""
    distro = request.distro or record.distro
    kept = any((one.distro, one.simulator) == (distro, record.simulator) for one in TARGETS)
    simulator = request.simulator or (record.simulator if kept or not request.distro else None)
    try:
        return choose_target(distro, simulator)
    except RequestError as error:
        if request.distro or request.simulator:
            raise
        raise RequestError(
            f"{record.line_of('target')}: {error.message}", hint=error.hint
        ) from error


def _answers(
    record: Record, template: Template, settings: Sequence[str], notes: list[str]
) -> dict[str, Answer]:
    """The answers of now: those of then, but for what is asked for and what has changed."""
    variables = dict(template.variables)
    known = dict(record.answers)
    set_now = {setting.partition("=")[0] for setting in settings}
    for name, variable in template.variables.items():
        if name not in known:
            notes.append(f"The template has a new variable: {name} = {show(variable.default)}.")
            continue
        value = _typed(known[name], variable.type)
        if variable.accepts(value):
            variables[name] = variable._replace(default=value)
        elif name not in set_now:
            raise RequestError(
                f"{record.line_of('answers', name)}: `{name}` is {known[name]!r}; it must be "
                f"{variable.expected}.",
                hint=f"Choose another value: --set {name}={show(variable.default)}",
            )
    notes += (
        f"The template has no variable {name} any more: its answer is left out."
        for name in sorted(known.keys() - template.variables.keys())
    )
    return resolve_answers(variables, settings, template.name)


def _typed(value: Answer, kind: str) -> Answer:
    """A number of a variable, which TOML may have without a point."""
    return float(value) if kind == "number" and type(value) is int else value


def _then(record: Record, now: _Side, scratch: Path) -> _Side:
    """What the package was made of, or updated to last."""
    state = record.made_of["state"]
    past = None
    if state != now.added["made_of"]["state"]:  # type: ignore[index]
        past = scratch / "wsgen"
        unpack(state, past)
    name = record.template
    if not now.template.is_shipped:
        name = str(unpack_commit(now.template.folder, record.made_of, scratch))
    with templates_of(past):
        template = load_template(name)
    target = _target(record, UpdateRequest())
    answers = {}
    for key, variable in template.variables.items():
        value = _typed(record.answers.get(key, variable.default), variable.type)
        if not variable.accepts(value):
            raise RequestError(
                f"{record.line_of('answers', key)}: `{key}` is {value!r}; when the package was "
                f"made, it had to be {variable.expected}.",
                hint="Write what the package was made with, and change it with --set.",
            )
        answers[key] = value
    for key in record.answers:
        if key not in template.variables:
            raise RequestError(
                f"{record.line_of('answers', key)}: the template {record.template!r} has no "
                f"variable `{key}`.",
                hint=f"Remove it; variables: {', '.join(template.variables) or 'none'}.",
            )
    spec = replace(
        now.spec,
        target=target if past is None else past_target(target, past),
        answers=answers,
        dependencies=template.dependencies(target, answers),
    )
    added = {"made_of": record.made_of, "wsgen_version": record.wsgen}
    return _Side(template, spec, added, past)


def _renamed_entities(base: Tree, then: _Side, folder: Path) -> frozenset[str]:
    """The names in the simulator that robots of other packages had when this one was made.

    Nothing says them but the launch files: the robot has the name of the package instead.
    """
    launch_files = [path for path in base if NAMED.search(base[path].decode())]
    usual = {name for path in launch_files for name in NAMED.findall(base[path].decode())}
    texts = [bytes_of(folder / path) or b"" for path in launch_files]
    own = {name for text in texts for name in NAMED.findall(text.decode("utf-8", "replace"))}
    return (
        frozenset(usual - own) if then.spec.name in own and usual.isdisjoint(own) else frozenset()
    )


def refuse_unsaved(folder: Path) -> None:
    """Stop where git has changes in a folder that are not committed.

    Raises:
        RequestError: it has.
    """
    program = shutil.which("git")
    status = run_git(program, folder, "status", "--porcelain", "--", ".") if program else None
    if status and status.strip():
        raise RequestError(
            f"{folder} has changes that are not committed "
            f"({count_of(len(status.splitlines()), 'file')}): they would be mixed with the update.",
            hint="Commit or stash them first, or use --force. Use --diff to see the update without "
            "writing.",
        )


def write_update(plan: UpdatePlan) -> None:
    """Write what is planned: all of it, or nothing.

    Raises:
        NotReadableError: A file cannot be written; all are as before.
    """
    undo: list[tuple[Path, Path | None]] = []  # a place, and where its file is meanwhile
    try:
        remove_leftovers(plan.folder)
        with unfinished_folder(plan.folder) as unfinished:
            ready = [_prepare(one, plan.folder, unfinished) for one in plan.writes]
            try:
                for number, (place, new) in enumerate(ready):
                    kept = unfinished / f"kept-{number}" if os.path.lexists(place) else None
                    if kept is not None:
                        place.rename(kept)
                    undo.append((place, kept))
                    if new is not None:
                        place.parent.mkdir(parents=True, exist_ok=True)
                        new.rename(place)
            except BaseException:
                for place, kept in reversed(undo):
                    if kept is not None:
                        kept.replace(place)
                    else:
                        place.unlink(missing_ok=True)
                        _remove_empty(place.parent, plan.folder)
                raise
    except OSError as error:
        raise explain_write_error(error, Path(error.filename or plan.folder)) from error
    for place, new in ready:
        if new is None:
            _remove_empty(place.parent, plan.folder)


def _remove_empty(folder: Path, top: Path) -> None:
    """Remove empty folders below `top`, from the innermost on."""
    with suppress(OSError):
        while folder != top:
            folder.rmdir()
            folder = folder.parent


def _prepare(change: Change, folder: Path, unfinished: Path) -> tuple[Path, Path | None]:
    """A place, and the file that is to be there, ready beside it; None: none is to be."""
    place = folder / change.path
    if change.after is None:
        return place, None
    file = unfinished / str(len(list(unfinished.iterdir())))
    with file.open("xb") as stream:
        stream.write(change.after)
        stream.flush()
        os.fsync(stream.fileno())  # some disks report only now that they are full
    mode = file.stat().st_mode
    if change.before is not None:
        mode = place.stat().st_mode
    if change.after.startswith(b"#!") and not (change.before or b"").startswith(b"#!"):
        mode |= (mode & 0o444) >> 2  # a program, as `wsgen new` writes one
    file.chmod(stat.S_IMODE(mode))
    return place, file
