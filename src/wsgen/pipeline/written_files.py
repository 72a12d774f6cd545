"""Whether the files of a package are what their endings say: XML, Python, TOML, a manifest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen import tomlfile
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.workspace.package_xml import check_package_xml
from wsgen.workspace.settings import read_settings
from wsgen.xmltree import Malformed, parse

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

XML = {".config", ".dae", ".gazebo", ".sdf", ".urdf", ".world", ".xacro", ".xml"}


def check_written_files(package: Path) -> Iterator[Diagnostic]:
    """Yield what is wrong with the form of the files of a package's folder."""
    yield from check_package_xml(package / "package.xml")
    yield from read_settings(package)[1]
    for file in sorted(path for path in package.rglob("*") if path.is_file()):
        if file.suffix in XML and file.name != "package.xml":
            root = parse(file.read_bytes())
            if isinstance(root, Malformed):
                yield _malformed(file, "well-formed XML", root.message, root.line)
        elif file.suffix == ".py":
            try:
                compile(file.read_bytes(), file.name, "exec", dont_inherit=True)
            except SyntaxError as error:
                yield _malformed(file, "Python", error.msg, error.lineno)
            except ValueError as error:  # a NUL in it
                yield _malformed(file, "Python", str(error), None)
        elif file.suffix == ".toml":
            try:
                tomlfile.load(file)
            except ValueError as error:
                yield _malformed(file, "TOML", str(error), None)


def _malformed(file: Path, form: str, why: str, line: int | None) -> Diagnostic:
    return Diagnostic(
        code="TPL006",
        severity=Severity.ERROR,
        message=f"{file.name} is not {form}: {why}.",
        file=file,
        line=line,
        hint="Mend the source; `wsgen new -t FOLDER` writes the file to look at.",
    )
