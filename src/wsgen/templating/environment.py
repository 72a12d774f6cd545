"""The Jinja2 environment of templates, and the cache of compiled templates.

All templates run in Jinja2's sandbox, also those of wsgen, so that the same source behaves alike in
both. The environment depends on neither time nor chance: the same answers give the same files.

Compiling the templates costs more than all the rest of `wsgen new`, so the compiled templates are
kept in one file in the user's cache folder. A missing or broken file is ignored. Loading code means
trusting whoever wrote it: folder and file must belong to the user and be writable by nobody else.
The folder is opened once, so that it cannot be replaced meanwhile.
"""

from __future__ import annotations

import contextlib
import marshal
import os
import stat
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import jinja2
from jinja2.sandbox import ImmutableSandboxedEnvironment

from wsgen import __version__
from wsgen.templating.sources import SHIPPED, SourceError, read_source

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from types import CodeType

    from jinja2.bccache import Bucket

    from wsgen.model.package import Answer


# Of one compiled template: the checksum of its source, and its code.
Entry = tuple[str, "CodeType"]
# Raise it when the options of the Jinja2 environment change: the code depends on them.
FORMAT = 2


class CodeFile:
    """The file of compiled templates for this Python, this wsgen and this Jinja2."""

    def __init__(self, jinja_version: str) -> None:
        self._name = (
            f"templates-{FORMAT}-{__version__}-{jinja_version}-{sys.implementation.cache_tag}"
        )

    def read(self) -> dict[str, Entry]:
        """Read the file; nothing if it is missing, broken or not trusted."""
        try:
            with _open_folder() as folder:
                flags = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK  # a FIFO is empty
                descriptor = os.open(self._name, flags, dir_fd=folder)
                with open(descriptor, "rb") as file:  # noqa: PTH123  a descriptor, not a path
                    _trust(descriptor)
                    entries = marshal.loads(file.read())  # noqa: S302  trusted, see above
        except (OSError, RuntimeError, ValueError, EOFError, TypeError):
            return {}
        return entries if isinstance(entries, dict) else {}

    def write(self, entries: dict[str, Entry]) -> None:
        """Replace the file, if possible."""
        with contextlib.suppress(OSError, RuntimeError), _open_folder() as folder:
            unfinished = f"{self._name}.{os.getpid()}"
            flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
            descriptor = os.open(unfinished, flags, 0o600, dir_fd=folder)
            try:
                with open(descriptor, "wb") as file:  # noqa: PTH123  a descriptor, not a path
                    file.write(marshal.dumps(entries))
                os.replace(unfinished, self._name, src_dir_fd=folder, dst_dir_fd=folder)
            except OSError:
                os.unlink(unfinished, dir_fd=folder)
                raise


@contextlib.contextmanager
def _open_folder() -> Iterator[int]:
    """Open wsgen's cache folder, which is created if it is missing, and yield its descriptor.

    Raises:
        OSError, RuntimeError: it cannot be created, or is not known to be the user's alone.
    """
    if not hasattr(os, "geteuid"):  # on Windows, which opens no folders, too
        raise PermissionError
    cache = Path(os.environ.get("XDG_CACHE_HOME", ""))
    if not cache.is_absolute():  # the XDG specification ignores it then, and so an empty one
        cache = Path.home() / ".cache"
    folder = cache / "wsgen"
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    try:
        _trust(descriptor)
        yield descriptor
    finally:
        os.close(descriptor)


def _trust(descriptor: int) -> None:
    status = os.fstat(descriptor)
    if status.st_uid != os.geteuid() or status.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        raise PermissionError


# The first type that matches an exception counts.
_HINTS: tuple[tuple[type[Exception], str], ...] = (
    (jinja2.TemplateSyntaxError, "Fix the tag in this line."),
    (
        jinja2.TemplateNotFound,
        "Name a file below the template's folder, or wsgen:TEMPLATE/FILE for one of wsgen's.",
    ),
    (
        jinja2.exceptions.SecurityError,
        "Templates may not do that; docs/templates.md lists what they may use.",
    ),
    (
        jinja2.UndefinedError,
        "Fix the name, or declare the variable; docs/templates.md lists the names.",
    ),
    (RecursionError, "Remove the recursion."),
    (TimeoutError, "Check the loops here, and how often they run."),
    (Exception, "Fix the expression in this line."),
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
            markdown_message=markdown_message,
            toml_string=toml_string,
            toml_value=toml_value,
            xml_text=xml_text,
        )
        del self.globals["lipsum"]
        del self.filters["random"]

    def keep_compiled(self) -> None:
        """Write newly compiled templates to the cache."""
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
        """Read a source; it does not change while wsgen runs."""
        try:
            text, file = read_source(template, self._folder)
        except SourceError as error:
            raise jinja2.TemplateNotFound(template, f"{template!r} {error}") from error
        return text, str(file), lambda: True


class _CompiledTemplates(jinja2.BytecodeCache):
    """Jinja2's interface to the file of compiled templates, which holds only those of wsgen."""

    def __init__(self) -> None:
        self._file = CodeFile(jinja2.__version__)
        self._entries: dict[str, Entry] = self._file.read()
        self._grew = False

    def get_cache_key(self, name: str, filename: str | None = None) -> str:  # noqa: ARG002  Jinja2's signature
        """Return the name, which identifies a source of wsgen."""
        return name

    def load_bytecode(self, bucket: Bucket) -> None:
        """Load the code if the source has not changed."""
        checksum, code = self._entries.get(bucket.key, ("", None))
        if code is not None and checksum == bucket.checksum:
            bucket.code = code

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep newly compiled code."""
        if bucket.code is not None and bucket.key.startswith(SHIPPED):
            self._entries[bucket.key] = (bucket.checksum, bucket.code)
            self._grew = True

    def save(self) -> None:
        """Write newly compiled templates."""
        if self._grew:
            self._file.write(self._entries)


def page_environment(
    folder: Path, filters: Mapping[str, Callable[..., object]], clean: Callable[[str], str]
) -> jinja2.Environment:
    """An environment for pages of HTML that come with wsgen, and show texts of users.

    Every text is escaped, and goes through `clean` before, but what `markupsafe` marks.
    """
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(folder),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        finalize=lambda value: clean(value) if type(value) is str else value,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(filters)
    return environment


def describe_error(error: Exception) -> tuple[str, str]:
    """Describe an exception that a template raises, and what to do about it."""
    said = str(error)
    if isinstance(error, jinja2.TemplateSyntaxError):
        said = error.message or "This is not a tag of Jinja2"
    elif isinstance(error, jinja2.TemplateNotFound):
        said = f"The source {said}"
    elif isinstance(error, RecursionError):
        said = "The template includes or calls itself without end"
    elif not type(error).__module__.startswith(("wsgen.", "jinja2.")):
        said = f"{type(error).__name__}: {said}" if said else type(error).__name__
    hints = (hint for kind, hint in _HINTS if isinstance(error, kind))
    return f"{said[:1].upper()}{said[1:].rstrip('.')}.", next(hints)


def syntax_place(error: Exception) -> tuple[Path | None, int | None]:
    """Return file and line of a template that cannot be compiled."""
    if isinstance(error, jinja2.TemplateSyntaxError) and error.filename:
        return Path(error.filename), error.lineno
    return None, None


# Characters that are special in Markdown; the second group at the start of a paragraph.
_MARKDOWN = str.maketrans({character: f"\\{character}" for character in "\\`*_[]<>&|#~"})
_MARKDOWN_LIST = ("-", "+", "=", *(f"{digit}{sign}" for digit in "0123456789" for sign in ".)"))


def xml_text(text: str) -> str:
    """Escape text between tags."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def toml_string(text: str) -> str:
    """Write a basic string with its quotes."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def toml_value(value: Answer) -> str:
    """Write a number, `true` or `false`, or a string with its quotes."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return toml_string(value) if isinstance(value, str) else repr(value)


def markdown_message(text: str) -> str:
    """Escape a message of wsgen, whose names stand between backticks, as they do in Markdown."""
    parts = enumerate(" ".join(text.split()).split("`"))
    return "`".join(part if place % 2 else part.translate(_MARKDOWN) for place, part in parts)


def markdown_text(text: str) -> str:
    """Escape a paragraph that shows the text as it is."""
    line = " ".join(text.split()).translate(_MARKDOWN)
    # A digit and its sign would begin a numbered list; escaping the sign prevents it.
    if line.startswith(_MARKDOWN_LIST):
        sign = 1 if line[0].isdigit() else 0
        line = f"{line[:sign]}\\{line[sign:]}"
    return line
