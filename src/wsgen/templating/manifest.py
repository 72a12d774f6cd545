"""A template: what can be asked of it, for which targets, and which files and needs it has.

A template is a folder with a `template.toml`, one that comes with wsgen or one of the user's;
docs/templates.md describes it, `templates/simple` is an example.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.errors import BrokenTemplateError, RequestError
from wsgen.suggestions import ask_for_nearest
from wsgen.templating.location import templates_folder
from wsgen.templating.manifest_file import MANIFEST, ManifestFile
from wsgen.templating.manifest_parts import Part, read_parts, read_targets, read_variables
from wsgen.templating.sources import SHIPPED

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.package import Answer
    from wsgen.model.target import Target
    from wsgen.templating.variables import Variable

KEYS = (
    "schema",
    "extends",
    "abstract",
    "description",
    "targets",
    "variables",
    "files",
    "dependencies",
    "parts",
)


class Template(NamedTuple):
    """A template with what it takes over from those that it extends.

    A named tuple: `wsgen new` pays for every dataclass that is defined.
    """

    name: str
    folder: Path
    is_shipped: bool  # with wsgen; the others are foreign code
    is_abstract: bool  # only made to be extended
    description: str
    targets: tuple[Target, ...]  # that it is made for
    tables: Mapping[str, dict[str, Any]]  # of the variables, as written
    variables: Mapping[str, Variable]
    parts: tuple[Part, ...]  # those that it takes over first

    def sources(self, target: Target, answers: Mapping[str, Answer]) -> dict[str, str]:
        """Pattern of the path in the package -> name of the source, as in `sources`."""
        return {
            path: source
            for part in self.parts
            if part.holds(target, answers)
            for path, source in part.files.items()
        }

    def dependencies(
        self, target: Target, answers: Mapping[str, Answer]
    ) -> dict[str, tuple[str, ...]]:
        """Element of package.xml -> packages; both in the order of the file."""
        merged: dict[str, set[str]] = {}
        for part in self.parts:
            if part.holds(target, answers):
                for kind, packages in part.dependencies.items():
                    merged.setdefault(kind, set()).update(packages)
        return {kind: tuple(sorted(packages)) for kind, packages in sorted(merged.items())}


def template_names() -> list[str]:
    """The templates that come with wsgen, without those that are only made to be extended."""
    return [name for name in _shipped() if not _load_shipped(name).is_abstract]


def load_template(given: str) -> Template:
    """The template of a name, or that in a folder of the user.

    Raises:
        RequestError: there is no such template.
        BrokenTemplateError: its template.toml cannot be used.
    """
    if is_shipped(given):
        template = _load_shipped(given)
    else:
        folder = Path(given).expanduser()
        if not (folder / MANIFEST).exists():
            raise _no_template(given, folder)
        template, faults = read_template(folder)
        refuse(faults, folder)
    if template.is_abstract:
        raise RequestError(
            f"Template {template.name!r} is only there to be extended.",
            hint=f"Templates: {', '.join(template_names())}.",
        )
    return template


def read_template(folder: Path) -> tuple[Template, tuple[Diagnostic, ...]]:
    """The template of the user in a folder, as far as it can be read, and what is wrong with it."""
    folder = folder.resolve()  # so that `-t .` has a name as well
    manifest = ManifestFile(folder / MANIFEST)
    name = folder.name
    if not name.isprintable():  # it is written into wsgen.toml
        manifest.wrong("The folder's name has characters that do not print.", "Rename the folder.")
    template = _read(manifest, name, is_shipped=False)
    return template, tuple(manifest.faults)


def refuse(faults: Sequence[Diagnostic], folder: Path) -> None:
    """Stop if there are faults in the user's template.

    Raises:
        BrokenTemplateError: there are; tells the first one, and how to see the others.
    """
    if not faults:
        return
    first = faults[0]
    place = f"{first.file}:{first.line}: " if first.line else f"{first.file}: "
    more = f" ({len(faults) - 1} more: wsgen templates --check {folder})"
    raise BrokenTemplateError(
        (place if first.file else "") + first.message,
        hint=(first.hint or "") + (more if len(faults) > 1 else ""),
    )


def _shipped() -> list[str]:
    return sorted(path.parent.name for path in templates_folder().glob(f"*/{MANIFEST}"))


def is_shipped(name: str) -> bool:
    """Whether a template of this name comes with wsgen."""
    return "/" not in name.strip(".") and (templates_folder() / name / MANIFEST).is_file()


def _load_shipped(name: str) -> Template:
    manifest = ManifestFile(templates_folder() / name / MANIFEST)
    template = _read(manifest, name, is_shipped=True)
    refuse(manifest.faults, template.folder)
    return template


def _no_template(given: str, folder: Path) -> RequestError:
    names = ", ".join(template_names())
    if folder.is_dir():
        return RequestError(
            f"The folder {given} has no {MANIFEST}.",
            hint=f"docs/templates.md says how to write a template; those of wsgen are: {names}.",
        )
    return RequestError(
        f"There is no template {given!r}.",
        hint=f"{ask_for_nearest(given, template_names())}Templates: {names}; or give a folder of "
        "yours.",
    )


def _read(manifest: ManifestFile, name: str, *, is_shipped: bool) -> Template:
    document = manifest.document
    if document:
        manifest.check_keys(document, KEYS)
    base = _read_base(manifest)
    tables = _merge_tables(manifest, base)
    variables = read_variables(manifest, tables)
    description = manifest.take(document, str, "description")
    if base is not None:
        description = description or base.description
    if not description and not manifest.faults:
        manifest.wrong("There is no `description`.", "Say in a sentence what it makes.")
    own = f"{SHIPPED}{name}/" if is_shipped else ""
    parts = read_parts(manifest, variables, own)
    targets = read_targets(manifest)
    return Template(
        name=name,
        folder=manifest.file.parent,
        is_shipped=is_shipped,
        is_abstract=manifest.take(document, bool, "abstract", default=False),
        description=description or "",
        targets=tuple(one for one in targets if base is None or one in base.targets),
        tables=tables,
        variables=variables,
        parts=(*(base.parts if base else ()), *parts),
    )


def _read_base(manifest: ManifestFile) -> Template | None:
    """The template that is extended; it comes with wsgen."""
    name = manifest.take(manifest.document, str, "extends")
    if name is None:
        return None
    if not is_shipped(name):
        manifest.wrong(
            f"There is no template {name!r} to extend.",
            f"Those of wsgen can be: {', '.join(_shipped())}.",
            "extends",
        )
        return None
    return _load_shipped(name)


def _merge_tables(manifest: ManifestFile, base: Template | None) -> dict[str, dict[str, Any]]:
    """The tables of the variables; of one that is taken over, single keys may be said anew."""
    tables = dict(base.tables) if base is not None else {}
    for name in manifest.take(manifest.document, dict, "variables", default={}):
        own = manifest.take(manifest.document["variables"], dict, "variables", name, default={})
        tables[name] = {**tables.get(name, {}), **own}
    return tables
