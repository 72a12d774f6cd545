"""Read the robot of a source, whatever it is written in, as a URDF and the files that it names."""

from __future__ import annotations

import re
from html import unescape
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.source import read_tags
from wsgen.descriptions.urdf.reader import DECLARATION, TEXT_LIMIT
from wsgen.diagnostics import Severity
from wsgen.errors import NotReadableError
from wsgen.porting.existing.description import Description
from wsgen.porting.existing.mjcf import read_mjcf
from wsgen.porting.existing.resources import (
    find_files,
    find_references,
    not_found,
    refuse_outside,
    usable,
)
from wsgen.porting.existing.sdf_model import read_sdf_model
from wsgen.porting.existing.xacro_source import Expanded, expand_source, refuse_macros
from wsgen.text.files import read_regular
from wsgen.text.xmltree import Malformed, parse

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.porting.existing.sources import Source


KINDS = {"urdf": "a URDF", "xacro": "a xacro file", "sdf": "an SDF model", "mjcf": "an MJCF model"}
_ENCODING = re.compile(rb"<\?xml[^>]*?encoding\s*=\s*[\"']([\w.-]+)")
_NO_LINE_END = re.compile(r"[^\n]")
_MESH = re.compile(r'<mesh filename="([^"]*)"')
_PACKAGE = re.compile(r"(?:package|model)://([\w.-]+)/")


class Read(NamedTuple):
    """A robot that was read."""

    source: Source
    description: Description
    missing: tuple[str, ...] = ()  # names of meshes that do not exist
    # Of a xacro file: its arguments, and sentences about what was left out and where they are from.
    arguments: Mapping[str, str] = {}
    fixes: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


def read_robot(  # noqa: PLR0913  what is asked for, and where
    source: Source,
    arguments: Mapping[str, str],
    *,
    copy_outside: bool,
    fixes: bool,
    environment: Mapping[str, str],
    scratch: Path,
) -> Read:
    """Read a robot; the source then owns the package that it lies in, too.

    Args:
        source: What was found.
        arguments: Of a xacro file.
        copy_outside: Whether files that are not of the source are copied.
        fixes: Whether meshes may be missing, and what xacro includes.
        environment: In which xacro runs.
        scratch: For what xacro is to find.

    Raises:
        NotReadableError: The file cannot be read, or not be expanded.
        NotFoundError: A mesh does not exist.
        RequestError: A file is not of the source.
    """
    if source.kind in {"mjcf", "sdf"}:
        if source.kind == "mjcf":
            description = read_mjcf(source.file, folder=source.roots[0])
        else:
            description = read_sdf_model(source.file, environment=environment)
        named = dict.fromkeys(map(unescape, _MESH.findall(description.text)))
        missing = tuple(one for one in named if one not in description.meshes)
        if missing and not fixes:
            raise not_found(missing, source)
        if not copy_outside:
            included = {file.name: file for file in description.included}
            refuse_outside({**included, **description.meshes}, source)
        return Read(source, description, missing)
    expanded = Expanded("", (), arguments)
    if source.kind == "xacro":
        expanded = expand_source(source, arguments, environment, scratch, fixes=fixes)
        refuse(expanded.found, source)
        refuse_macros(source, expanded.text or "")
    text = expanded.text if source.kind == "xacro" else _read_urdf(source)
    text = _named(text or "", source.file)
    for package in dict.fromkeys(_PACKAGE.findall(text)):
        source = source.with_package(package)
    references = find_references(text, (*source.roots, *source.packages.values()))
    found = find_files(references, source, copy_outside=copy_outside, skip_missing=fixes)
    root = parse(text)
    name = ("" if isinstance(root, Malformed) else root.get("name")) or source.file.stem
    description = Description(name, text, source.file, found.files, (), taken=found.taken)
    return Read(source, description, found.missing, *expanded[2:])


def _named(text: str, file: Path) -> str:
    """The text with a name of the robot, for which that of its file serves if it has none."""
    robot = next((one for one in read_tags(text) if one.name == "robot"), None)
    if robot is None or ((named := robot.attributes.get("name")) and named.text.strip()):
        return text
    place = robot.start.start + len("<robot")
    return f'{text[:place]} name="{usable(file.stem)}"{text[place:]}'


def _read_urdf(source: Source) -> str:
    try:
        data = read_regular(source.file, 4 * TEXT_LIMIT)  # bytes of UTF-8
    except OSError as error:
        raise NotReadableError(
            f"{source.shown} cannot be read: {error.strerror}.", hint="Make it readable."
        ) from error
    text = _with_declaration(_decoded(data))
    root = parse(text)
    if isinstance(root, Malformed):
        raise NotReadableError(
            f"{source.shown}:{root.line}: the file is not XML: {root.message}",
            hint=f"Fix the line; wsgen check --fix {source.file} may do it.",
        )
    return text


def _decoded(data: bytes) -> str:
    """The text of a file, in the encoding that it declares."""
    declared = _ENCODING.search(data[:200])
    if declared is not None:
        try:
            return data.decode(declared[1].decode())
        except (LookupError, UnicodeDecodeError):
            pass
    return data.decode("utf-8-sig", "replace")  # as Gazebo reads it


def _with_declaration(text: str) -> str:
    """The text with a declaration at its start, where xacro looks for it; the lines stay."""
    found = DECLARATION.match(text)
    if found is None:
        return text
    return f'<?xml version="1.0"?>{_NO_LINE_END.sub("", found[0])}{text[found.end() :]}'


def refuse(found: Sequence[Diagnostic], source: Source, *, can_fix: bool = False) -> None:
    """Stop at the first error, which `--fix` may fix.

    Raises:
        NotReadableError: There is one.
    """
    errors = [one for one in found if one.severity is Severity.ERROR]
    if errors:
        first = errors[0]
        place = f"{first.file or source.shown}:{first.line}" if first.line else source.shown
        more = f" ({len(errors) - 1} more: wsgen check {source.file})" if len(errors) > 1 else ""
        fix = " Or add --fix." if can_fix else ""
        raise NotReadableError(f"{place}: {first.message}", hint=f"{first.hint or ''}{fix}{more}")
