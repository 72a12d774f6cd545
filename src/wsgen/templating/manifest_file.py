"""A `template.toml` as it is written: read, and what is wrong with its form collected.

What a value means is for `manifest` and `manifest_parts` to say; here it is read with its type.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from wsgen import tomlfile
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.tomlfile import find_line

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

MANIFEST = "template.toml"
SCHEMA = 1
MAXIMUM_BYTES = 2**20

_KINDS = {
    str: "a text",
    bool: "true or false",
    int: "an integer",
    dict: "a table",
    list: "a list",
}


class ManifestFile:
    """The document of one file, and what was found wrong with it."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.faults: list[Diagnostic] = []
        self.document = self._load()

    def wrong(self, message: str, hint: str, *where: str) -> None:
        """Add that something is wrong at a place: the way of keys that leads to it."""
        self.faults.append(
            Diagnostic(
                code="TPL002",
                severity=Severity.ERROR,
                message=message,
                file=self.file,
                line=find_line(self.file.read_text(encoding="utf-8"), where),
                element=".".join(where) or None,
                hint=hint,
            )
        )

    def take(self, table: Mapping[str, Any], kind: type, *where: str, default: Any = None) -> Any:
        """The value at the last key of the way, or the default if it is missing or of no use."""
        value = table.get(where[-1])
        if value is None:
            return default
        if not isinstance(value, kind) or (kind is int and isinstance(value, bool)):
            self.wrong(
                f"`{where[-1]}` is {_name_kind(value)} where {_KINDS[kind]} is wanted.",
                "docs/templates.md shows each key.",
                *where,
            )
            return default
        return value

    def take_texts(self, table: Mapping[str, Any], *where: str) -> tuple[str, ...]:
        """A list of texts; empty if it is missing or of no use."""
        values = self.take(table, list, *where, default=[])
        if not all(isinstance(value, str) for value in values):
            self.wrong(f"`{where[-1]}` is no list of texts.", 'Write ["one", "two"].', *where)
            return ()
        return tuple(values)

    def check_keys(self, table: Mapping[str, Any], known: tuple[str, ...], *where: str) -> None:
        """Add the keys that mean nothing: a misspelt one would be passed over in silence."""
        for key in table:
            if key not in known:
                self.wrong(
                    f"There is no key `{key}` here.", f"Keys: {', '.join(known)}.", *where, key
                )

    def _load(self) -> dict[str, Any]:
        try:
            if self.file.is_file() and self.file.stat().st_size > MAXIMUM_BYTES:
                return self._unreadable("is too large", f"{MAXIMUM_BYTES} bytes are the limit.")
            # A pipe would be waited for without end.
            document = tomlfile.load(self.file) if self.file.is_file() else {}
        except OSError as error:
            return self._unreadable(f"cannot be read: {error.strerror}", "Make it readable.")
        except RecursionError:
            return self._unreadable("is nested too deeply", "Write plain tables.")
        except ValueError as error:
            return self._unreadable(f"is no TOML: {error}", "Mend it at the place that is named.")
        if not document:
            return self._unreadable("is no file with anything in it", f"Write: schema = {SCHEMA}")
        if document.get("schema") != SCHEMA:
            is_there = "schema" in document
            self.wrong(
                f"`schema` is {document['schema']!r}." if is_there else "`schema` is missing.",
                f"Write: schema = {SCHEMA}",
                "schema",
            )
        return document

    def _unreadable(self, what: str, hint: str) -> dict[str, Any]:
        self.faults.append(
            Diagnostic(
                code="TPL001",
                severity=Severity.ERROR,
                message=f"{MANIFEST} {what}.",
                file=self.file,
                hint=hint,
            )
        )
        return {}


def _name_kind(value: object) -> str:
    for kind, name in _KINDS.items():
        if type(value) is kind:
            return name
    return "a number" if isinstance(value, float) else "a date or a time"
