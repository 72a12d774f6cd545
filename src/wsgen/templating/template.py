"""Read a template: its variables, the targets it is made for, its files and dependencies.

A template is a folder with a `template.toml`, one that comes with wsgen or one of the user's.
docs/templates.md describes it; `templates/simple` is an example.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.diagnostics import Rule, Severity
from wsgen.errors import BrokenTemplateError, RequestError
from wsgen.model.package import PYTHON_KEYWORDS, check_package_name
from wsgen.model.target import SIMULATORS, TARGETS
from wsgen.templating.sources import SHIPPED, templates_folder
from wsgen.templating.spec import TYPES, Variable
from wsgen.text import tomlfile
from wsgen.text.suggestions import ask_for_nearest
from wsgen.text.tomlfile import find_line

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.package import Answer
    from wsgen.model.target import Target


MANIFEST = "template.toml"
SCHEMA = 1
MAXIMUM_BYTES = 2**20

UNREADABLE_TEMPLATE = Rule(
    code="TPL001",
    name="unreadable-template",
    severity=Severity.ERROR,
    summary="`template.toml` cannot be read, is empty or is not TOML.",
    why="`wsgen` knows the variables, the targets and the files of a template only from this file.",
    example="schema = ",
    instead="schema = 1",
)
INVALID_TEMPLATE = Rule(
    code="TPL002",
    name="invalid-template",
    severity=Severity.ERROR,
    summary="A key or a value in template.toml is invalid.",
    what="Checks all keys and the types of their values, names and bounds of variables, targets, "
    "conditions and dependencies.",
    why="`wsgen` refuses the template instead of ignoring what it does not understand.",
    example="""[variables.mass]
help = "Mass of the body"
type = "float"
default = 1.0""",
    instead="""[variables.mass]
help = "Mass of the body"
type = "number"
unit = "kg"
default = 1.0
minimum = 0.1
maximum = 100.0""",
)

_KINDS = {
    str: "a text",
    bool: "true or false",
    int: "an integer",
    dict: "a table",
    list: "a list",
}


class ManifestFile:
    """The document of one file, and the mistakes in it."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.diagnostics: list[Diagnostic] = []
        self.document = self._load()

    def report(self, message: str, hint: str, *where: str) -> None:
        """Report a mistake at a path of keys."""
        line = find_line(self.file.read_text(encoding="utf-8"), where)
        element = ".".join(where) or None
        self.diagnostics.append(
            INVALID_TEMPLATE.at(self.file, line, element, message=message, hint=hint)
        )

    def take(self, table: Mapping[str, Any], kind: type, *where: str, default: Any = None) -> Any:
        """Return the value at a path of keys, or the default if it is missing or invalid."""
        value = table.get(where[-1])
        if value is None:
            return default
        if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
            self.report(
                f"`{where[-1]}` is {_name_kind(value)}; it must be {_KINDS[kind]}.",
                "docs/templates.md describes each key.",
                *where,
            )
            return default
        return value

    def take_texts(self, table: Mapping[str, Any], *where: str) -> tuple[str, ...]:
        """Return a list of texts; empty if it is missing or invalid."""
        values = self.take(table, list, *where, default=[])
        if not all(isinstance(value, str) for value in values):
            self.report(f"`{where[-1]}` is not a list of texts.", 'Write ["one", "two"].', *where)
            return ()
        return tuple(values)

    def check_keys(self, table: Mapping[str, Any], known: tuple[str, ...], *where: str) -> None:
        """Report unknown keys, which nothing would read."""
        for key in table:
            if key not in known:
                self.report(
                    f"The key `{key}` is unknown here.", f"Keys: {', '.join(known)}.", *where, key
                )

    def _load(self) -> dict[str, Any]:
        try:
            if self.file.is_file() and self.file.stat().st_size > MAXIMUM_BYTES:
                return self._unreadable("is too large", f"The limit is {MAXIMUM_BYTES} bytes.")
            # Reading from a pipe would wait without end.
            document = tomlfile.load(self.file) if self.file.is_file() else {}
        except OSError as error:
            return self._unreadable(f"cannot be read: {error.strerror}", "Make it readable.")
        except ValueError as error:
            return self._unreadable(f"is not TOML: {error}", "Fix the named line.")
        if not document:
            what = "is empty or not a file" if self.file.exists() else "does not exist"
            return self._unreadable(what, f"Write a file with: schema = {SCHEMA}")
        if document.get("schema") != SCHEMA:
            is_there = "schema" in document
            self.report(
                f"`schema` is {document['schema']!r}." if is_there else "`schema` is missing.",
                f"Write: schema = {SCHEMA}",
                "schema",
            )
        return document

    def _unreadable(self, what: str, hint: str) -> dict[str, Any]:
        self.diagnostics.append(
            UNREADABLE_TEMPLATE.at(self.file, message=f"{MANIFEST} {what}.", hint=hint)
        )
        return {}


def _name_kind(value: object) -> str:
    for kind, name in _KINDS.items():
        if type(value) is kind:
            return name
    return "a number" if isinstance(value, float) else "a date or a time"


DEPENDENCIES = (
    "build_depend",
    "build_export_depend",
    "buildtool_depend",
    "buildtool_export_depend",
    "depend",
    "doc_depend",
    "exec_depend",
    "test_depend",
)
VARIABLE_KEYS = ("help", "type", "unit", "default", "minimum", "maximum", "choices")
PART_KEYS = ("when", "files", "dependencies")
# What a condition may name besides variables.
TARGET_WORDS = ("distro", "simulator")


class Part(NamedTuple):
    """Files and dependencies of a package that depend on one condition."""

    when: Mapping[str, tuple[Answer, ...]]  # variable, distro or simulator -> accepted values
    files: Mapping[str, str]  # pattern of the path in the package -> name of the source
    dependencies: Mapping[str, tuple[str, ...]]  # as in PackageSpec

    def holds(self, target: Target, answers: Mapping[str, Answer]) -> bool:
        """Whether the condition is met."""
        values = {"distro": target.distro, "simulator": target.simulator, **answers}
        return all(values[name] in wanted for name, wanted in self.when.items())


def read_variables(
    manifest: ManifestFile, tables: Mapping[str, Mapping[str, Any]]
) -> dict[str, Variable]:
    """Read the variables of a template from their tables, inherited ones included."""
    variables = {}
    for name, table in tables.items():
        # `package.answers.NAME` must mean the answer, and xacro must take NAME for a property.
        if (
            not re.fullmatch(r"[a-z][a-z0-9_]*", name)
            or name in PYTHON_KEYWORDS
            or name in TARGET_WORDS
            or hasattr(dict, name)
        ):
            manifest.report(
                f"A variable cannot be named `{name}`.",
                "Use lower-case letters a to z, digits and underscores, and no keyword of Python.",
                *("variables", name),
            )
        else:
            variable = _read_variable(manifest, name, table)
            if variable is not None:
                variables[name] = variable
    return variables


def _read_variable(manifest: ManifestFile, name: str, table: Mapping[str, Any]) -> Variable | None:
    where = ("variables", name)
    before = len(manifest.diagnostics)
    manifest.check_keys(table, VARIABLE_KEYS, *where)
    kind = table.get("type")
    needed = {"help", "type", "default"}
    if kind not in TYPES:
        manifest.report(
            f"The type {kind!r} is unknown.", f"Types: {', '.join(TYPES)}.", *where, "type"
        )
    elif kind in {"number", "integer"}:
        needed |= {"minimum", "maximum"} | ({"unit"} if kind == "number" else set())
    elif kind == "choice":
        needed |= {"choices"}
    for key in sorted(needed - set(table)):
        manifest.report(
            f"The variable `{name}` has no `{key}`.", f"Add a line: {key} = ...", *where
        )
    variable = Variable(
        name=name,
        help=manifest.take(table, str, *where, "help", default=""),
        type=str(kind),
        default=_number(table.get("default"), str(kind)),
        unit=manifest.take(table, str, *where, "unit", default=""),
        minimum=_bound(manifest, table, *where, "minimum"),
        maximum=_bound(manifest, table, *where, "maximum"),
        choices=manifest.take_texts(table, *where, "choices"),
    )
    if len(manifest.diagnostics) == before and not variable.accepts(variable.default):
        manifest.report(
            f"The default of `{name}` is {variable.default!r}; it must be {variable.expected}.",
            "Change the default, or the bounds.",
            *where,
            "default",
        )
    return variable if len(manifest.diagnostics) == before else None


def _number(value: Any, kind: str) -> Any:
    """Convert a number, which TOML may have without a point."""
    return float(value) if kind == "number" and type(value) is int else value


def _bound(manifest: ManifestFile, table: Mapping[str, Any], *where: str) -> float:
    bound = table.get(where[-1], 0.0)
    if isinstance(bound, bool) or not isinstance(bound, (int, float)):
        manifest.report(f"`{where[-1]}` is not a number.", "Write a number.", *where)
        return 0.0
    return bound


def read_targets(manifest: ManifestFile) -> tuple[Target, ...]:
    """Read the targets that a template is made for; by default all."""
    words = manifest.take_texts(manifest.document, "targets")
    known = {word for target in TARGETS for word in (target.name, target.distro, target.simulator)}
    for word in words:
        if word not in known:
            manifest.report(
                f"The target {word!r} is unknown.",
                f"Write a simulator ({', '.join(SIMULATORS)}), a distribution (jazzy), or both"
                " (jazzy-gz).",
                "targets",
            )
    if "targets" not in manifest.document:
        return TARGETS
    if manifest.document["targets"] == []:
        manifest.report("`targets` is empty.", "Remove it to support all targets.", "targets")
    return tuple(
        target for target in TARGETS if {target.name, target.distro, target.simulator} & set(words)
    )


def read_parts(manifest: ManifestFile, variables: Mapping[str, Variable], own: str) -> list[Part]:
    """Read the unconditional part of a template, then the others; `own` qualifies its sources."""
    document = manifest.document
    parts = [_read_part(manifest, document, {}, own)]
    for index, table in enumerate(manifest.take(document, list, "parts", default=[])):
        where = ("parts", str(index))
        if not isinstance(table, dict):
            manifest.report("A part is not a table.", "Write it below [[parts]].", "parts")
            continue
        manifest.check_keys(table, PART_KEYS, *where)
        when = _read_condition(manifest, table, variables, *where, "when")
        parts.append(_read_part(manifest, table, when, own, *where))
    return parts


def _read_part(
    manifest: ManifestFile,
    table: Mapping[str, Any],
    when: Mapping[str, tuple[Answer, ...]],
    own: str,
    *where: str,
) -> Part:
    files = {}
    for path, source in manifest.take(table, dict, *where, "files", default={}).items():
        if not isinstance(source, str):
            manifest.report(
                f"The source of {path!r} is not a text.",
                'Write: "path/in/the/package" = "source.j2"',
                *(*where, "files", path),
            )
        else:
            files[path] = source if source.startswith(SHIPPED) else own + source
    dependencies = {}
    needed = manifest.take(table, dict, *where, "dependencies", default={})
    manifest.check_keys(needed, DEPENDENCIES, *where, "dependencies")
    for kind in needed:
        if kind in DEPENDENCIES:
            names = manifest.take_texts(needed, *where, "dependencies", kind)
            dependencies[kind] = names
            for name in names:
                _check_dependency(manifest, name, *where, "dependencies", kind)
    return Part(when, files, dependencies)


def _check_dependency(manifest: ManifestFile, name: str, *where: str) -> None:
    # A rosdep key of the system, python3-numpy, has dashes.
    problem = check_package_name(re.sub(r"[-.]", "_", name))
    if problem is not None:
        manifest.report(f"The dependency {name!r} {problem}.", "Name a ROS package.", *where)


def _read_condition(
    manifest: ManifestFile,
    table: Mapping[str, Any],
    variables: Mapping[str, Variable],
    *where: str,
) -> dict[str, tuple[Answer, ...]]:
    condition: dict[str, tuple[Answer, ...]] = {}
    for name, value in manifest.take(table, dict, *where, default={}).items():
        values = tuple(value) if isinstance(value, list) else (value,)
        if name in variables:
            usable = all(variables[name].accepts(one) for one in values)
            expected = variables[name].expected
        elif name in TARGET_WORDS:
            known = {getattr(target, name) for target in TARGETS}
            usable = all(isinstance(one, str) and one in known for one in values)
            expected = f"one of {', '.join(sorted(known))}"
        else:
            manifest.report(
                f"The condition names `{name}`, which is not a variable.",
                f"It may name {', '.join((*TARGET_WORDS, *variables))}.",
                *where,
                name,
            )
            continue
        if usable:
            condition[name] = values
        else:
            manifest.report(
                f"`{name}` is {value!r}; it must be {expected}.",
                "Write a value, or a list.",
                *where,
                name,
            )
    return condition


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
    """A template, with what it inherits from those that it extends.

    A named tuple: `wsgen new` pays for every dataclass that is defined.
    """

    name: str
    folder: Path
    is_shipped: bool  # with wsgen; other templates are foreign code
    is_abstract: bool  # only to be extended
    description: str
    targets: tuple[Target, ...]  # that it is made for
    tables: Mapping[str, dict[str, Any]]  # of the variables, as written
    variables: Mapping[str, Variable]
    parts: tuple[Part, ...]  # inherited ones first
    shipped: tuple[str, ...] = ()  # templates of wsgen: itself, and those that are extended

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
    """List the templates that come with wsgen, without the abstract ones."""
    return [name for name in _shipped() if not _load_shipped(name).is_abstract]


def load_template(given: str, *, may_be_abstract: bool = False) -> Template:
    """Load a template by its name, or from a folder of the user.

    Raises:
        RequestError: the template does not exist.
        BrokenTemplateError: its template.toml is invalid.
    """
    if is_shipped(given):
        template = _load_shipped(given)
    else:
        folder = Path(given).expanduser()
        if not (folder / MANIFEST).exists():
            raise _no_template(given, folder)
        template, diagnostics = read_template(folder)
        refuse(diagnostics, folder)
    if template.is_abstract and not may_be_abstract:
        raise RequestError(
            f"Template {template.name!r} is abstract: other templates extend it.",
            hint=f"Choose one of {', '.join(template_names())}.",
        )
    return template


def read_template(folder: Path) -> tuple[Template, tuple[Diagnostic, ...]]:
    """Read the template in a folder of the user, as far as possible, and report its mistakes."""
    folder = folder.resolve()  # so that `-t .` has a name as well
    manifest = ManifestFile(folder / MANIFEST)
    name = folder.name
    if not name.isprintable():  # it is written into wsgen.toml
        manifest.report(
            "The name of the folder has characters that do not print.", "Rename the folder."
        )
    template = _read(manifest, name, is_shipped=False)
    return template, tuple(manifest.diagnostics)


def refuse(diagnostics: Sequence[Diagnostic], folder: Path) -> None:
    """Stop if the user's template has mistakes.

    Raises:
        BrokenTemplateError: it has; names the first one, and how to see the others.
    """
    if not diagnostics:
        return
    first = diagnostics[0]
    place = f"{first.file}:{first.line}: " if first.line else f"{first.file}: "
    more = f" ({len(diagnostics) - 1} more: wsgen templates --check {folder})"
    raise BrokenTemplateError(
        (place if first.file else "") + first.message,
        hint=(first.hint or "") + (more if len(diagnostics) > 1 else ""),
    )


def _shipped() -> list[str]:
    return sorted(path.parent.name for path in templates_folder().glob(f"*/{MANIFEST}"))


def is_shipped(name: str) -> bool:
    """Whether a template of this name comes with wsgen."""
    return "/" not in name.strip(".") and (templates_folder() / name / MANIFEST).is_file()


def _load_shipped(name: str) -> Template:
    manifest = ManifestFile(templates_folder() / name / MANIFEST)
    template = _read(manifest, name, is_shipped=True)
    refuse(manifest.diagnostics, template.folder)
    return template


def _no_template(given: str, folder: Path) -> RequestError:
    names = ", ".join(template_names())
    if folder.is_dir():
        return RequestError(
            f"The folder {given} has no {MANIFEST}.",
            hint=f"Write one as docs/templates.md describes, or choose one of wsgen: {names}.",
        )
    return RequestError(
        f"Template {given!r} does not exist.",
        hint=f"{ask_for_nearest(given, template_names())}Templates: {names}; or name a folder with "
        f"a {MANIFEST}.",
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
    if not description and not manifest.diagnostics:
        manifest.report("`description` is missing.", "Describe in a sentence what it creates.")
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
        shipped=(*([name] if is_shipped else []), *(base.shipped if base else ())),
    )


def _read_base(manifest: ManifestFile) -> Template | None:
    """Load the template that is extended, one of wsgen's."""
    name = manifest.take(manifest.document, str, "extends")
    if name is None:
        return None
    if not is_shipped(name):
        manifest.report(
            f"The template {name!r} to extend does not exist.",
            f"Templates of wsgen can be extended: {', '.join(_shipped())}.",
            "extends",
        )
        return None
    return _load_shipped(name)


def _merge_tables(manifest: ManifestFile, base: Template | None) -> dict[str, dict[str, Any]]:
    """Merge the tables of the variables; single keys replace those of an inherited one."""
    tables = dict(base.tables) if base is not None else {}
    for name in manifest.take(manifest.document, dict, "variables", default={}):
        own = manifest.take(manifest.document["variables"], dict, "variables", name, default={})
        tables[name] = {**tables.get(name, {}), **own}
    return tables
