"""Fixes in package.xml and wsgen.toml."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.checks.fixes.source import Edit, is_surely, join_additions, read_tags
from wsgen.text.suggestions import suggested

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Sequence

    from wsgen.checks.fixes.source import SourceText, Tag
    from wsgen.diagnostics import Diagnostic


DEPENDENCY = re.compile(r"<(\w*depend|member_of_group)>([\w-]+)</\1>")
# The order of elements in package.xml; a dependency goes behind the last of its kind, else behind
# the last of those before it.
ORDER = (
    *("name", "version", "description", "maintainer", "license", "url", "author"),
    *("buildtool_depend", "buildtool_export_depend", "build_depend", "build_export_depend"),
    *("depend", "exec_depend", "doc_depend", "test_depend", "group_depend", "member_of_group"),
)
VERSION = re.compile(r"\d+(?:\.\d+)?")
FULL_VERSION = 3  # numbers


def top_of(source: SourceText) -> tuple[Tag | None, list[Tag]]:
    """The root, and the elements in it."""
    tags = read_tags(source.text)
    root = tags[0] if tags and tags[0].name == "package" else None
    return root, [tag for tag in tags if len(tag.path) == 1]


def add_dependencies(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Add to package.xml the dependencies that the hint writes out."""
    _, top = top_of(source)
    declared = {(tag.name, text_of(source, tag)) for tag in top if tag.name in ORDER and tag.end}
    return declare(
        source,
        [
            (tag, name)
            for tag, name in DEPENDENCY.findall(diagnostic.hint or "")
            if not {(tag, name), ("depend", name)} & declared
        ],
    )


def declare(
    source: SourceText, dependencies: Iterable[tuple[str, str]], *, gone: Collection[Tag] = ()
) -> list[Edit]:
    """Add dependencies, each a tag with a name, behind those of their kind that do not go."""
    root, top = top_of(source)
    top = [tag for tag in top if tag not in gone]
    if root is None or root.end is None:
        return []
    edits = []
    for tag, name in dict.fromkeys(dependencies):
        if tag not in ORDER:
            continue
        place, indent = _place_for(source, tag, name, root, top)
        edits.append(
            Edit(start=place, end=place, text=f"{source.newline}{indent}<{tag}>{name}</{tag}>")
        )
    return join_additions(edits)


def _place_for(
    source: SourceText, kind: str, name: str, root: Tag, top: Sequence[Tag]
) -> tuple[int, str]:
    """Where an element goes, and its indent: behind the last of those that precede it."""
    before = ORDER[: ORDER.index(kind) + 1]
    those = [tag for tag in top if tag.name == kind]
    names = [text_of(source, tag) for tag in those]
    if len(names) > 1 and names == sorted(names) and names[0] < name:
        those = [tag for tag, one in zip(those, names, strict=True) if one < name]
    those = those or [tag for tag in top if tag.name in before]
    if not those:
        return root.start.end, "  "
    last = those[-1]
    place = (last.end or last.start).end
    rest = re.compile(r"[ \t]*(?:<!--[^\n]*?-->[ \t]*)?(?=\r?\n)").match(source.text, place)
    return (rest.end() if rest else place), source.indent_at(last.start.start)


def text_of(source: SourceText, tag: Tag) -> str:
    """What is between the tags of an element."""
    return source.text[tag.start.end : tag.end.start].strip() if tag.end else ""


def remove_dependency(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Remove the element on the line, which declares what another one declares too."""
    _, top = top_of(source)
    on_line = [
        tag
        for tag in top
        if tag.name.endswith("depend") and source.line_at(tag.start.start) == diagnostic.line
    ]
    if len(on_line) != 1 or on_line[0].end is None:
        return []
    start, end = source.whole_lines(on_line[0].start.start, on_line[0].end.end)
    return [Edit(start=start, end=end, text="")]


def write_dependency(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Declare the dependency on the line with the tag that the hint writes out, or with it too."""
    if (diagnostic.hint or "").startswith("Add"):
        return add_dependencies(diagnostic, source)
    _, top = top_of(source)
    meant = DEPENDENCY.search(diagnostic.hint or "")
    on_line = [
        tag
        for tag in top
        if tag.name.endswith("depend") and source.line_at(tag.start.start) == diagnostic.line
    ]
    if meant is None or len(on_line) != 1 or on_line[0].end is None:
        return []
    tag, end = on_line[0], on_line[0].end
    written = text_of(source, tag)
    if tag.name == meant[1] and written and len(DEPENDENCY.findall(diagnostic.hint or "")) == 1:
        place = source.text.index(written, tag.start.end)
        return [Edit(start=place, end=place + len(written), text=meant[2])]
    if written != meant[2] or tag.name == meant[1]:
        return []
    starts = (tag.start.start + len("<"), end.start + len("</"))
    return [Edit(start=start, end=start + len(tag.name), text=meant[1]) for start in starts]


def rename_dependency(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested name of a dependency."""
    _, top = top_of(source)
    meant = suggested(diagnostic.hint)
    on_line = [
        tag
        for tag in top
        if tag.name.endswith("depend")
        and source.line_at(tag.start.start) <= (diagnostic.line or 0)
        and tag.end is not None
        and source.line_at(tag.end.end) >= (diagnostic.line or 0)
    ]
    if len(on_line) != 1 or meant is None or on_line[0].end is None:
        return []
    written = text_of(source, on_line[0])
    if not is_surely(written, meant) or written == meant:
        return []
    content = on_line[0].content()
    start = source.text.index(written, content.start)
    return [Edit(start=start, end=start + len(written), text=meant)]


def remove_build_type_as_dependency(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Remove a dependency on a build type that is exported as such."""
    if "<build_type" not in _uncommented(source):
        return []
    return remove_dependency(diagnostic, source)


def write_format_3(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Take format 1, that of ROS 1, to format 3."""
    root, top = top_of(source)
    if root is None:
        return []
    written = root.attributes.get("format")
    place = root.start.start + len("<package")
    edits = [
        Edit(start=written.value.start, end=written.value.end, text="3")
        if written
        else Edit(start=place, end=place, text=' format="3"')
    ]
    for tag in top:
        if tag.name == "run_depend" and tag.end is not None:
            starts = (tag.start.start + len("<"), tag.end.start + len("</"))
            edits += [Edit(start=start, end=start + len("run"), text="exec") for start in starts]
    return edits


_NAME = re.compile(r"<name>[\w-]+</name>")
_BUILD_TYPE = re.compile(r"<build_type>(\w+)</build_type>")


def add_name(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Name the package as the hint writes it out."""
    root, top = top_of(source)
    name = _NAME.search(diagnostic.hint or "")
    if root is None or name is None or any(tag.name == "name" for tag in top):
        return []
    indent = source.indent_at(top[0].start.start) if top else "  "
    text = f"{source.newline}{indent}{name[0]}"
    return [Edit(start=root.start.end, end=root.start.end, text=text)]


def fix_build_type(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the build type that the hint names, for which the package has the file."""
    meant = _BUILD_TYPE.search(diagnostic.hint or "")
    written = [tag for tag in read_tags(source.text) if tag.name == "build_type" and tag.end]
    if meant is None or len(written) != 1:
        return []
    span = written[0].content()
    return [Edit(start=span.start, end=span.end, text=meant[1])]


def add_build_type(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Say in package.xml that the package is built with CMakeLists.txt or setup.py."""
    folder = source.file.parent
    kinds = [
        kind
        for kind, file in (("ament_cmake", "CMakeLists.txt"), ("ament_python", "setup.py"))
        if (folder / file).is_file()
    ]
    if not kinds or "<build_type" in _uncommented(source):
        return []
    return add_export(source, f"<build_type>{kinds[0]}</build_type>")


def add_export(source: SourceText, written: str) -> list[Edit]:
    """Add an element to `<export>`, and that too where it is missing."""
    root, top = top_of(source)
    if root is None or root.end is None:
        return []
    newline = source.newline
    export = next((tag for tag in top if tag.name == "export"), None)
    if export is None:
        indent = source.indent_at(top[-1].start.start) if top else "  "
        lines = [f"{indent}<export>", f"{indent}{indent}{written}", f"{indent}</export>", ""]
        place = source.start_of(source.line_at(root.end.start))
        if source.text[place : root.end.start].strip():
            place, lines = root.end.start, ["", *lines]
        return [Edit(start=place, end=place, text=newline.join(lines))]
    indent = source.indent_at(export.start.start)
    inside = f"{newline}{indent}{indent or '  '}{written}"
    if export.is_empty:
        text = f"<export>{inside}{newline}{indent}</export>"
        return [Edit(start=export.start.start, end=export.start.end, text=text)]
    rest = source.text[export.start.end : (export.end or export.start).start]
    text = inside if rest[:1] in {"\r", "\n"} else f"{inside}{newline}{indent}"
    return [Edit(start=export.start.end, end=export.start.end, text=text)]


def _uncommented(source: SourceText) -> str:
    return re.sub(r"<!--.*?-->", "", source.text, flags=re.DOTALL)


def fix_version(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Give the version three numbers."""
    _root, top = top_of(source)
    versions = [tag for tag in top if tag.name == "version"]
    text = text_of(source, versions[0]) if len(versions) == 1 else ""
    if not VERSION.fullmatch(text):
        return []
    numbers = [*text.split("."), "0", "0"][:FULL_VERSION]
    start = source.text.index(text, versions[0].start.end)
    return [Edit(start=start, end=start + len(text), text=".".join(numbers))]


_RULE = re.compile(r"rule '([^']+)'")
_KEY = re.compile(r"has no key `([^`]+)`")


def fix_allowed_rule(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested rule in wsgen.toml."""
    named, meant = _RULE.search(diagnostic.message), suggested(diagnostic.hint)
    if named is None or meant is None or not is_surely(named[1], meant):
        return []
    places = list(re.finditer(rf"(?<=[\"']){re.escape(named[1])}(?=[\"'])", source.text))
    if len(places) != 1:
        return []
    return [Edit(start=places[0].start(), end=places[0].end(), text=meant)]


def fix_settings_key(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested key in wsgen.toml."""
    named, meant = _KEY.search(diagnostic.message), suggested(diagnostic.hint)
    if named is None or meant is None or not is_surely(named[1], meant):
        return []
    start = source.start_of(diagnostic.line or 0)
    end = source.start_of((diagnostic.line or 0) + 1)
    places = list(re.finditer(rf"\b{re.escape(named[1])}\b", source.text[start:end]))
    if len(places) != 1:
        return []
    return [Edit(start=start + places[0].start(), end=start + places[0].end(), text=meant)]
