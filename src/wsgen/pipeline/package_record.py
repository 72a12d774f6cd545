"""How a package was made: what `wsgen new` records in its `wsgen.toml`, and a new record there."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.packages.workspace.settings import FILE
from wsgen.templating.environment import toml_value
from wsgen.templating.spec import show
from wsgen.text import tomlfile
from wsgen.text.files import read_regular_text

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.model.package import Answer


OF_EXISTING = "existing"  # the template of `wsgen new --from`
_PACKAGE_KEYS = ("name", "description", "license", "maintainer_name", "maintainer_email")
# Of the templates; where a new record has them not, the old ones go.
_MADE_OF = ("state", "folder", "commit")
# A line with a key of one word and a value on the same line, and a comment behind it.
_LINE = re.compile(
    r"""(?P<key>\s*["']?(?P<name>[\w-]+)["']?\s*=\s*)"""
    r"""(?P<value>"(?:[^"\\]|\\.)*"|'[^']*'|[^\s#"']+)(?P<rest>\s*(?:\#.*)?)"""
)
_HEADER = re.compile(r"\s*\[+\s*([^\]]*?)\s*\]")


class Record(NamedTuple):
    """How a package was made."""

    file: Path
    wsgen: str  # version
    template: str  # its name
    made_of: Mapping[str, str]  # see `states`; of a template of the user, its folder and commit
    distro: str
    simulator: str
    package: Mapping[str, str]  # name, description, license, maintainer_name, maintainer_email
    answers: Mapping[str, Answer]

    def line_of(self, *where: str) -> str:
        """File and line of a key, for messages."""
        line = tomlfile.find_line(read_regular_text(self.file, tomlfile.SIZE_LIMIT), where)
        return f"{self.file}:{line}" if line else str(self.file)


def read_record(folder: Path) -> Record:
    """Read how the package in a folder was made.

    Raises:
        NotFoundError: it has no wsgen.toml.
        NotReadableError: that cannot be read, or lacks what `wsgen new` writes.
        RequestError: it does not say what the package was made of.
    """
    file = folder / FILE
    try:
        document = tomlfile.load(file)
    except FileNotFoundError:
        raise NotFoundError(
            f"{folder} has no {FILE}: wsgen did not create this package.",
            hint="`wsgen update` is for packages of `wsgen new`.",
        ) from None
    except OSError as error:
        raise NotReadableError(
            f"{file} cannot be read: {error.strerror}.", hint="Check who may read it (ls -l)."
        ) from error
    except ValueError as error:
        raise NotReadableError(
            f"{file} is not TOML: {error}.", hint="Fix it; `wsgen check` says how."
        ) from error

    def text(*where: str) -> str:
        table = document.get(where[0], {}) if where[1:] else document
        value = table.get(where[-1]) if isinstance(table, dict) else None
        if not isinstance(value, str):
            raise NotReadableError(
                f"{file} has no text `{where[-1]}`{f' in [{where[0]}]' if where[1:] else ''}.",
                hint="`wsgen new` writes it: take it from your version control, or from a package "
                "of `wsgen new` with the same template.",
            )
        return value

    version, template = text("wsgen"), text("template")
    if not isinstance(document.get("state"), str):
        raise _unknown_state(folder, version, template, document)
    answers = document.get("answers", {})
    return Record(
        file=file,
        wsgen=version,
        template=template,
        made_of={key: text(key) for key in _MADE_OF if key in document},
        distro=text("target", "distro"),
        simulator=text("target", "simulator"),
        package={key: text("package", key) for key in _PACKAGE_KEYS},
        answers=answers if isinstance(answers, dict) else {},
    )


def _unknown_state(
    folder: Path, version: str, template: str, document: Mapping[str, Any]
) -> RequestError:
    name = folder.name
    if template == OF_EXISTING:
        return RequestError(
            f"{name} was made of a robot that existed (wsgen new --from), whose source is not "
            "recorded: nothing can be merged.",
            hint=f"For another distribution: wsgen port {name} --to DISTRO; for the rest make it "
            f"anew beside: wsgen new {name} --from SOURCE -w NEW, and compare.",
        )
    options = {"distro": "--distro ", "simulator": "--sim "}
    settings = "".join(
        f" {options.get(key, f'--set {key}=')}{show(value)}"
        for table in map(document.get, ("target", "answers"))
        if isinstance(table, dict)
        for key, value in table.items()
    )
    return RequestError(
        f"{folder / FILE} has no `state`: wsgen {version}, which made the package, did not record "
        "the state of its templates.",
        hint=f"Make it anew beside, and compare: wsgen new {name} -t {template}{settings} -w NEW "
        f"&& git diff --no-index {folder} NEW/src/{name}",
    )


Values = dict[tuple[str, str], "Answer"]  # table (empty: above all) and key -> value


def values_of(  # noqa: PLR0913  what a record has
    *,
    wsgen: str,
    template: str,
    made_of: Mapping[str, str],
    distro: str,
    simulator: str,
    answers: Mapping[str, Answer],
) -> Values:
    """The values of a new record, by their places."""
    return {
        ("", "wsgen"): wsgen,
        ("", "template"): template,
        **{("", key): value for key, value in made_of.items()},
        ("target", "distro"): distro,
        ("target", "simulator"): simulator,
        **{("answers", key): value for key, value in answers.items()},
    }


def with_record(text: str, values: Values, file: Path) -> str:
    """The text of a wsgen.toml with these values; comments and all else stay.

    Keys that the record has no more are removed; one with a comment becomes a comment.

    Raises:
        RequestError: `file`, which has the text, has a value in a way that cannot be edited.
    """
    lines: list[str] = []
    left = dict(reversed(values.items()))
    table, last = "", {"": 0}  # where the last key of each table is, in `lines`
    for line in text.splitlines(keepends=True):
        header, found = _HEADER.match(line), _LINE.fullmatch(line.rstrip("\r\n"))
        if header is not None:
            table = header[1]
            last.setdefault(table, len(lines) + 1)
        elif found is not None:
            where, ending = (table, found["name"]), line[found.end() :]
            if where in left:
                value = toml_value(left.pop(where))
                line = f"{found['key']}{value}{found['rest']}{ending}"  # noqa: PLW2901
            elif table == "answers" or (table == "" and found["name"] in _MADE_OF):
                if not found["rest"].strip():
                    continue
                line = f"# {line.lstrip()}"  # noqa: PLW2901
            last[table] = len(lines) + 1
        lines.append(line)
    document = tomlfile.parse(text) if left else {}
    for table, key in left:
        found_table = document.get(table, {}) if table else document
        if table not in last or not isinstance(found_table, dict) or key in found_table:
            raise RequestError(
                f"{file} cannot be updated: `{key}` does not stand alone on a line"
                f"{f' below [{table}]' if table else ', above all tables'}.",
                hint=f"Write {f'a line [{table}], and below it ' if table else ''}`{key} = …`, as "
                "`wsgen new` does.",
            )
    end = "\r\n" if "\r\n" in text else "\n"
    new = [(last[table], f"{key} = {toml_value(left[table, key])}") for table, key in left]
    for number, line in sorted(new, key=lambda one: one[0], reverse=True):
        lines.insert(number, line + end)
    return "".join(lines)
