"""Jinja2 as templates meet it.

All templates run in its sandbox, those of wsgen as well: what is written for the ones works in the
others, and the compiled templates are the same. Nothing in it depends on time or chance, so that
the same answers give the same files.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import jinja2
from jinja2.sandbox import ImmutableSandboxedEnvironment

from wsgen.templating.bytecode import CodeFile
from wsgen.templating.sources import SHIPPED, SourceError, read_source
from wsgen.templating.text import markdown_text, toml_string, toml_value, xml_text

if TYPE_CHECKING:
    from collections.abc import Callable

    from jinja2.bccache import Bucket

    from wsgen.templating.bytecode import Entry

# The first that an exception is of.
_HINTS: tuple[tuple[type[Exception], str], ...] = (
    (jinja2.TemplateSyntaxError, "Mend the tag in this line."),
    (
        jinja2.TemplateNotFound,
        "Name a file below the template's folder, or wsgen:TEMPLATE/FILE for one of wsgen's.",
    ),
    (
        jinja2.exceptions.SecurityError,
        "Templates may not do that; docs/templates.md lists what there is.",
    ),
    (
        jinja2.UndefinedError,
        "Mend the name, or declare the variable; docs/templates.md lists what there is.",
    ),
    (RecursionError, "Break the circle."),
    (TimeoutError, "See what is repeated here, and how often."),
    (Exception, "Mend the expression in this line."),
)


class Environment(ImmutableSandboxedEnvironment):
    """An environment whose templates are the sources of wsgen and of one folder."""

    def __init__(self, folder: Path) -> None:
        self._compiled = _CompiledTemplates()
        super().__init__(
            loader=_Loader(folder),
            undefined=jinja2.StrictUndefined,
            bytecode_cache=self._compiled,
            trim_blocks=True,
            lstrip_blocks=True,
            keep_trailing_newline=True,
        )
        self.filters.update(
            markdown_text=markdown_text,
            toml_string=toml_string,
            toml_value=toml_value,
            xml_text=xml_text,
        )
        del self.globals["lipsum"]
        del self.filters["random"]

    def keep_compiled(self) -> None:
        """Write what was compiled, for the next time."""
        self._compiled.save()


class _Loader(jinja2.BaseLoader):
    """Finds sources by their names."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def get_source(
        self,
        environment: jinja2.Environment,  # noqa: ARG002  Jinja2's signature
        template: str,
    ) -> tuple[str, str, Callable[[], bool]]:
        """The text of a source; it does not change while wsgen runs."""
        try:
            text, file = read_source(template, self._folder)
        except SourceError as error:
            raise jinja2.TemplateNotFound(template, f"{template!r} {error}") from error
        return text, str(file), lambda: True


class _CompiledTemplates(jinja2.BytecodeCache):
    """Jinja2's view of the file of compiled templates, which holds those of wsgen alone."""

    def __init__(self) -> None:
        self._file = CodeFile(jinja2.__version__)
        self._entries: dict[str, Entry] = self._file.read()
        self._grew = False

    def get_cache_key(self, name: str, filename: str | None = None) -> str:  # noqa: ARG002  Jinja2's signature
        """The name: that of a source of wsgen says which it is."""
        return name

    def load_bytecode(self, bucket: Bucket) -> None:
        """Give the code if the source is still the same."""
        checksum, code = self._entries.get(bucket.key, ("", None))
        if code is not None and checksum == bucket.checksum:
            bucket.code = code

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep code that was compiled just now."""
        if bucket.code is not None and bucket.key.startswith(SHIPPED):
            self._entries[bucket.key] = (bucket.checksum, bucket.code)
            self._grew = True

    def save(self) -> None:
        """Write what was compiled."""
        if self._grew:
            self._file.write(self._entries)


def words_for(error: Exception) -> tuple[str, str]:
    """What an exception from within a template says, and what to do about it."""
    said = str(error)
    if isinstance(error, jinja2.TemplateSyntaxError):
        said = error.message or "This is no tag of Jinja2"
    elif isinstance(error, jinja2.TemplateNotFound):
        said = f"The source {said}"
    elif isinstance(error, RecursionError):
        said = "The template includes or calls itself without end"
    elif not type(error).__module__.startswith(("wsgen.", "jinja2.")):
        said = f"{type(error).__name__}: {said}" if said else type(error).__name__
    hints = (hint for kind, hint in _HINTS if isinstance(error, kind))
    return f"{said[:1].upper()}{said[1:].rstrip('.')}.", next(hints)


def syntax_place(error: Exception) -> tuple[Path | None, int | None]:
    """File and line of a template that cannot be compiled: its code was never run."""
    if isinstance(error, jinja2.TemplateSyntaxError) and error.filename:
        return Path(error.filename), error.lineno
    return None, None
