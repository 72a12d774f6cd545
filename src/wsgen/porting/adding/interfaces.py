"""A message, service or action, with what generates it."""

from __future__ import annotations

from collections.abc import Sequence  # noqa: TC003  a NamedTuple
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.manifests import top_of
from wsgen.checks.fixes.source import Edit
from wsgen.errors import RequestError
from wsgen.porting.adding.addition import MANIFEST
from wsgen.porting.adding.cmake import CMake, is_path
from wsgen.porting.adding.places import Item, insert_above, insert_among, insert_below
from wsgen.porting.adding.types import check_type_name, read_fields

if TYPE_CHECKING:
    from wsgen.checks.fixes.build_files import Command
    from wsgen.porting.adding.addition import Addition
    from wsgen.porting.adding.types import Field

GENERATE = "rosidl_generate_interfaces"
_KEYWORDS = (
    *("DEPENDENCIES", "LIBRARY_NAME", "SKIP_INSTALL", "ADD_LINTER_TESTS"),
    "SKIP_GROUP_MEMBERSHIP_CHECK",
)
_ANY = r"(?:msg|srv|action|idl)"
_WHERE = f"Add it to {GENERATE}()."


class Kind(NamedTuple):
    """A kind of interfaces."""

    word: str
    folder: str  # and the suffix of its files
    options: tuple[str, ...]  # of the parts that `---` separates


KINDS = {
    "message": Kind("message", "msg", ("--field",)),
    "service": Kind("service", "srv", ("--request", "--response")),
    "action": Kind("action", "action", ("--goal", "--result", "--feedback")),
}


def add_interface(
    addition: Addition, kind: Kind, name: str, parts: Sequence[Sequence[str]]
) -> None:
    """Add an interface.

    Args:
        addition: The package.
        kind: Which one.
        name: In CamelCase.
        parts: The fields of each part, `NAME:TYPE`.

    Raises:
        RequestError: A name or type cannot be, or the package cannot generate any.
    """
    check_type_name(kind.word, name)
    own = addition.name
    if addition.is_python:
        raise RequestError(
            f"{own} is a package of the build type ament_python, and only CMake generates "
            "interfaces.",
            hint="Add it to a package of ament_cmake with --to, or create one: "
            f"ros2 pkg create {own}_interfaces --build-type ament_cmake",
        )
    cmake = CMake(addition)
    for command in cmake.calls("ament_python_install_package"):
        if command.arguments and command.arguments[0].text in {own, "${PROJECT_NAME}"}:
            raise RequestError(
                f"CMakeLists.txt installs the Python package {own}, which that of its interfaces "
                f"would replace (line {cmake.source.line_at(command.start)}).",
                hint="Add it to another package with --to, or create one: "
                f"ros2 pkg create {own}_interfaces --build-type ament_cmake",
            )
    root, _ = top_of(addition.require(addition.folder / MANIFEST))
    written = root.attributes.get("format") if root else None
    if written is None or written.text in {"1", "2"}:
        raise RequestError(
            f"package.xml of {own} has the format {written.text if written else 1}, and interfaces "
            "need `<member_of_group>` of format 3.",
            hint='Write <package format="3"> first.',
        )
    fields = [
        read_fields(words, option, addition)
        for option, words in zip(kind.options, parts, strict=True)
    ]
    path = f"{kind.folder}/{name}.{kind.folder}"
    addition.create(path, "interface", kind=kind.word, parts=fields)
    packages = _packages(fields, own)
    cmake.compile("C", "CXX")
    cmake.find("rosidl_default_generators", *packages)
    _generate(cmake, kind, path, packages)
    addition.depend("buildtool_depend", "rosidl_default_generators")
    addition.depend("depend", *packages, *(["action_msgs"] if kind.word == "action" else []))
    addition.depend("exec_depend", "rosidl_default_runtime")
    addition.depend("member_of_group", "rosidl_interface_packages")


def _packages(parts: Sequence[Sequence[Field]], own: str) -> list[str]:
    found = {one.package for part in parts for one in part if one.package is not None}
    return sorted(found - {own})


def _generate(cmake: CMake, kind: Kind, path: str, packages: Sequence[str]) -> None:
    """Have an interface be generated with those that are."""
    calls = cmake.calls(GENERATE)
    if not calls:
        _first(cmake, path, packages)
        return
    written = [
        one.text for command in cmake.calls(GENERATE, "set", "list") for one in command.arguments
    ]
    is_listed = any(word == path or word.endswith(f"/{path}") for word in written)
    if not is_listed and not _is_matched(cmake, kind):
        _list(cmake, calls[-1], kind, path)
    for package in packages:
        call = cmake.calls(GENERATE)[len(calls) - 1]
        if package not in [one.text for one in call.arguments]:
            cmake.add(
                package,
                _dependency(cmake, call, package),
                f"Add it to DEPENDENCIES of {GENERATE}().",
            )


def _first(cmake: CMake, path: str, packages: Sequence[str]) -> None:
    """Have the first interface of a package be generated."""
    own = {"${PROJECT_NAME}", cmake.addition.name}
    is_taken = any(
        command.arguments and command.arguments[0].text in own
        for command in cmake.calls("add_executable", "add_library", "add_custom_target")
    )
    lines = [
        f"{GENERATE}(${{PROJECT_NAME}}{'_interfaces' if is_taken else ''}",
        f'  "{path}"',
        *([f"  DEPENDENCIES {' '.join(packages)}"] if packages else []),
        *(["  LIBRARY_NAME ${PROJECT_NAME}"] if is_taken else []),
        ")",
    ]
    text = "\n".join(lines)
    found = [one for one in cmake.top() if one.name == "find_package"]
    edit = insert_below(cmake.source, found[-1].end, text, apart=True) if found else None
    cmake.add(text, edit, "Add it below what is found.")
    if not cmake.uses_auto():
        text = "ament_export_dependencies(rosidl_default_runtime)"
        exported = [
            one.text
            for command in cmake.calls("ament_export_dependencies")
            for one in command.arguments
        ]
        if "rosidl_default_runtime" not in exported:
            last = cmake.calls("ament_package")
            edit = insert_above(cmake.source, last[-1].start, text) if last else None
            cmake.add(text, edit, "Add it above ament_package().")


def _is_matched(cmake: CMake, kind: Kind) -> bool:
    """Whether the files of a kind are found by a pattern."""
    return any(
        f"{kind.folder}/*" in one.text
        for command in cmake.calls("file")
        if command.arguments and command.arguments[0].text.startswith("GLOB")
        for one in command.arguments
    )


def _list(cmake: CMake, call: Command, kind: Kind, path: str) -> None:
    """List a file where its likes are: in the call, or in a variable that the call names."""
    names = {one.text.strip("${}") for one in call.arguments if one.text.startswith("${")}
    sets = [
        one
        for one in cmake.calls("set", "list")
        if one.arguments and {one.text for one in one.arguments[:2]} & names
    ]
    for pattern in (is_path(kind.folder, kind.folder), is_path(_ANY, _ANY)):
        for command in (call, *reversed(sets)):
            edit = cmake.argument_beside(command, pattern, path)
            if edit is not None:
                cmake.add(path, edit, _WHERE)
                return
    cmake.add(f'"{path}"', _behind_target(cmake, call, f'"{path}"'), _WHERE)


def _behind_target(cmake: CMake, call: Command, text: str) -> Edit | None:
    """Behind the name of the target, on a line that the next argument begins."""
    if len(call.arguments) < 2:  # noqa: PLR2004
        return None
    following = call.arguments[1]
    source = cmake.source
    if source.line_at(following.start) > source.line_at(call.arguments[0].start):
        return insert_above(source, following.start, f"{source.indent_at(following.start)}{text}")
    return Edit(start=following.start, end=following.start, text=f"{text} ")


def _dependency(cmake: CMake, call: Command, package: str) -> Edit | None:
    source, words = cmake.source, [one.text for one in call.arguments]
    if "DEPENDENCIES" in words:
        start = words.index("DEPENDENCIES")
        end = next(
            (n for n, word in enumerate(words) if n > start and word in _KEYWORDS), len(words)
        )
        listed = call.arguments[start + 1 : end]
        items = [Item(one.text, one.start, one.end) for one in listed]
        edit = insert_among(source, items, package, package) if items else None
        last = listed[-1] if listed else call.arguments[start]
        if edit is None and not source.text[last.end :].partition("\n")[0].strip():
            return insert_below(source, last.end, f"{source.indent_at(last.end)}  {package}")
        return edit or Edit(start=last.end, end=last.end, text=f" {package}")
    last = call.arguments[-1]
    item = Item(last.text, last.start, last.end)
    text = f"DEPENDENCIES {package}"
    below = insert_among(source, [item], "", text)
    if below is not None and below.start > last.start:
        return below
    return Edit(start=last.end, end=last.end, text=f" {text}")
