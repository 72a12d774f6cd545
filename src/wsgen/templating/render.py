"""PackageSpec and Template -> the texts of the package's files. Writes nothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import jinja2

from wsgen import __version__
from wsgen.templating.bytecode import CodeFile
from wsgen.templating.location import templates_folder
from wsgen.templating.text import markdown_text, toml_string, xml_text

if TYPE_CHECKING:
    from collections.abc import Mapping

    from jinja2.bccache import Bucket

    from wsgen.model.package import PackageSpec
    from wsgen.templating.bytecode import Entry
    from wsgen.templating.manifest import Template

# Path in the package, with slashes -> text of the file.
RenderedTree = dict[str, str]


class _CompiledTemplates(jinja2.BytecodeCache):
    """Jinja2's view of the file of compiled templates."""

    def __init__(self) -> None:
        self._file = CodeFile(jinja2.__version__)
        self._entries: dict[str, Entry] = self._file.read()
        self._grew = False

    def load_bytecode(self, bucket: Bucket) -> None:
        """Give the code if the source is still the same."""
        checksum, code = self._entries.get(bucket.key, ("", None))
        if code is not None and checksum == bucket.checksum:
            bucket.code = code

    def dump_bytecode(self, bucket: Bucket) -> None:
        """Keep code that was compiled just now."""
        if bucket.code is not None:
            self._entries[bucket.key] = (bucket.checksum, bucket.code)
            self._grew = True

    def save(self) -> None:
        """Write what was compiled."""
        if self._grew:
            self._file.write(self._entries)


def render_package(spec: PackageSpec, template: Template) -> RenderedTree:
    """All files of a package, sorted by path; each text ends with a line end."""
    compiled = _CompiledTemplates()
    environment = _environment(compiled)
    context: Mapping[str, object] = {"package": spec, "wsgen_version": __version__}
    tree = {
        path: environment.get_template(template.files[path]).render(context)
        for path in sorted(template.files)
    }
    compiled.save()
    return tree


def _environment(compiled: jinja2.BytecodeCache) -> jinja2.Environment:
    environment = jinja2.Environment(  # noqa: S701  XML is one format of several; see text.py
        loader=jinja2.FileSystemLoader(templates_folder()),
        undefined=jinja2.StrictUndefined,
        bytecode_cache=compiled,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters.update(
        markdown_text=markdown_text, toml_string=toml_string, xml_text=xml_text
    )
    return environment
