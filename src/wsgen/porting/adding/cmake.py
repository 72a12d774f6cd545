"""CMakeLists.txt, to which commands and their arguments are added."""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING

from wsgen.checks.fixes.build_files import OPTIONS, read_commands
from wsgen.checks.fixes.source import Edit
from wsgen.porting.adding.addition import CMAKE
from wsgen.porting.adding.places import Item, insert_above, insert_among, insert_below

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from wsgen.checks.fixes.build_files import Argument, Command
    from wsgen.checks.fixes.source import SourceText
    from wsgen.porting.adding.addition import Addition

_BLOCKS = ("if", "foreach", "while", "function", "macro", "block")
PROGRAMS = "lib/${PROJECT_NAME}"
_TARGETS = (
    *("add_executable", "add_library", "ament_target_dependencies", "target_link_libraries"),
    *("target_include_directories", "target_compile_features", "target_compile_definitions"),
    *("ament_auto_add_executable", "ament_auto_add_library", "target_compile_options"),
    *("rclcpp_components_register_node", "rclcpp_components_register_nodes"),
    *("set_target_properties", "add_dependencies", "rosidl_target_interfaces"),
    *("rosidl_generate_interfaces", "rosidl_get_typesupport_target"),
)
# What comes at the end: the tests, what is exported, and the package.
_LAST = ("ament_package", "ament_auto_package")
_COMPILED = {"C": "enable_language(C)", "CXX": "enable_language(CXX)"}


class CMake:
    """The commands of CMakeLists.txt, and places for new ones."""

    def __init__(self, addition: Addition) -> None:
        self.addition = addition
        self.file = addition.folder / CMAKE

    @property
    def source(self) -> SourceText:
        """The text, with what is inserted so far."""
        return self.addition.require(self.file)

    def calls(self, *names: str) -> list[Command]:
        """The calls of these commands, wherever they are."""
        return [one for one in read_commands(self.source) if one.name in names]

    def top(self) -> list[Command]:
        """The commands that are always run; of a block that is not, its first one and its last."""
        found, depth = [], 0
        for one in read_commands(self.source):
            if one.name.startswith("end") and one.name[3:] in _BLOCKS:
                depth -= 1
            if depth == 0:
                found.append(one)
            if one.name in _BLOCKS:
                depth += 1
        return found

    def uses_auto(self) -> bool:
        """Whether ament_auto finds, links and installs what package.xml and the folder have."""
        return bool(self.calls("ament_auto_package"))

    def add(self, text: str, edit: Edit | None, where: str) -> None:
        """Insert a text, or have the author do it."""
        if edit is None or not self.addition.edit(self.file, [edit]):
            self.addition.paste(self.file, text, where)

    # What is found

    def find(self, *packages: str) -> None:
        """Find packages, each below those that are found."""
        if self.calls("ament_auto_find_build_dependencies"):
            return
        facts, _ = self.addition.facts()
        known = {one.name for one in facts.required_packages if not one.in_tests}
        for package in packages:
            if package not in known and package != self.addition.name:
                text = f"find_package({package} REQUIRED)"
                where = "Add it below the other find_package()."
                self.add(text, self._found_beside(package, text), where)

    def _found_beside(self, package: str, text: str) -> Edit | None:
        source = self.source
        found = [one for one in self.top() if one.name == "find_package" and one.arguments]
        likes = [
            Item(one.arguments[0].text, one.start, one.end)
            for one in found
            if not one.arguments[0].text.startswith("ament_cmake")
        ]
        if likes and self._follow(likes):
            edit = insert_among(source, likes, package, text)
            if edit is not None:
                return edit
        if found:
            return insert_below(source, found[-1].end, text)
        project = next((one for one in self.top() if one.name == "project"), None)
        return project and insert_below(source, project.end, text, apart=True)

    def _follow(self, likes: Sequence[Item]) -> bool:
        """Whether packages are found one below the other, without comments that part them."""
        lines = [self.source.line_at(one.start) for one in likes]
        return lines == list(range(lines[0], lines[0] + len(lines)))

    def compile(self, *languages: str) -> None:
        """Have CMake look for compilers, where project() asks for none."""
        project = next((one for one in self.top() if one.name == "project"), None)
        words = [one.text for one in project.arguments] if project else []
        if project is None or not {"NONE", "LANGUAGES", "C", "CXX"} & {*words[1:]}:
            return
        enabled = {one.arguments[0].text for one in self.calls("enable_language") if one.arguments}
        for language in languages:
            if language not in {*words, *enabled}:
                text = _COMPILED[language]
                last = [one for one in self.top() if one.name == "enable_language"]
                place = last[-1] if last else project
                self.add(
                    text, insert_below(self.source, place.end, text), "Add it below project()."
                )

    # What is installed

    def install(self, kind: str, what: str, destination: str) -> None:
        """Install a program, target or folder beside others that go to the same place.

        Args:
            kind: PROGRAMS, TARGETS or DIRECTORY.
            what: Its path, or name.
            destination: Such as `lib/${PROJECT_NAME}`.
        """
        text = f"install({kind} {what} DESTINATION {destination})"
        source = self.source
        edit = None
        same = [one for one in self.top() if self._installs(one, kind, destination)]
        for command in reversed(same):
            items = _items(command.arguments[1:])
            edit = items and insert_among(source, items, what, _quoted_as(source, items, what))
            if edit:
                break
        where = "Add it below the other install()."
        self.add(text, edit or self._below_installed(text, same), where)

    def _installs(self, command: Command, kind: str, destination: str) -> bool:
        words = [one.text for one in command.arguments]
        if command.name != "install" or words[:1] != [kind] or "DESTINATION" not in words:
            return False
        place = words[words.index("DESTINATION") + 1 :][:1]
        own = destination.replace("${PROJECT_NAME}", self.addition.name)
        rest = {*words} - {"DESTINATION", "RUNTIME"}
        return bool({destination, own} & {*place}) and not OPTIONS & rest

    def _below_installed(self, text: str, same: Sequence[Command]) -> Edit | None:
        if same:
            return insert_below(self.source, same[-1].end, text)
        installed = [one for one in self.top() if one.name == "install"]
        if installed:
            return insert_below(self.source, installed[-1].end, text, apart=True)
        return self.before_end(text)

    def before_end(self, text: str) -> Edit | None:
        """Lines above the tests, what is exported and ament_package()."""
        top = self.top()
        last = next((one for one in top if one.name in _LAST), None)
        ends = [one for one in top if _is_of_end(one) or one is last]
        if last is None or not ends:
            return None
        return insert_above(self.source, ends[0].start, text, apart=True)

    # What is compiled

    def below_targets(self, text: str) -> Edit | None:
        """Lines below the targets that there are, or below what is found."""
        top = self.top()
        beside = [one for one in top if one.name in _TARGETS]
        beside = beside or [one for one in top if one.name == "find_package"]
        beside = beside or [one for one in top if one.name == "project"]
        return insert_below(self.source, beside[-1].end, text, apart=True) if beside else None

    def argument_beside(
        self, command: Command, among: Callable[[str], bool], text: str
    ) -> Edit | None:
        """An argument among those of a kind: on a line like theirs, or on the line of the last."""
        source = self.source
        likes = [one for one in command.arguments if among(one.text)]
        if not likes:
            return None
        items = [Item(one.text, one.start, one.end) for one in likes]
        written = _quoted_as(source, items, text)
        edit = insert_among(source, items, text, written)
        return edit or Edit(start=likes[-1].end, end=likes[-1].end, text=f" {written}")

    # Tests

    def test(self, name: str, path: str) -> None:
        """Add a test of pytest."""
        if any(
            one.name == "ament_add_pytest_test" and one.arguments and one.arguments[0].text == name
            for one in read_commands(self.source)
        ):
            return
        text = f"ament_add_pytest_test({name} {path} TIMEOUT 300)"
        tests = self.calls("ament_add_pytest_test")
        source = self.source
        if tests:
            indent = source.indent_at(tests[-1].start)
            self.add(text, insert_below(source, tests[-1].end, f"{indent}{text}"), "Add it.")
            return
        block = self._block_of_tests()
        find = "find_package(ament_cmake_pytest REQUIRED)"
        if block is not None:
            start, end = block
            unit = self._unit(start)
            lines = "\n".join(f"{source.indent_at(start.start)}{unit}{one}" for one in (find, text))
            self.add(lines, insert_above(source, end.start, lines), "Add it to if(BUILD_TESTING).")
            return
        lines = f"if(BUILD_TESTING)\n  {find}\n  {text}\nendif()"
        last = next((one for one in self.top() if one.name in _LAST), None)
        edit = last and insert_above(source, last.start, lines, apart=True)
        self.add(lines, edit, "Add it above ament_package().")

    def _block_of_tests(self) -> tuple[Command, Command] | None:
        top = self.top()
        for start, end in pairwise(top):
            words = [one.text for one in start.arguments]
            if start.name == "if" and words == ["BUILD_TESTING"]:
                return (start, end) if end.name == "endif" else None
        return None

    def _unit(self, start: Command) -> str:
        inner = [one for one in read_commands(self.source) if one.start > start.start]
        own = self.source.indent_at(start.start)
        indent = self.source.indent_at(inner[0].start) if inner else ""
        return indent.removeprefix(own) or "  "


def _is_of_end(command: Command) -> bool:
    words = [one.text for one in command.arguments]
    return command.name.startswith("ament_export_") or (
        command.name == "if" and "BUILD_TESTING" in words
    )


def _items(arguments: Sequence[Argument]) -> list[Item]:
    """What is installed: the arguments before the first option."""
    return list(_before_options(arguments))


def _before_options(arguments: Sequence[Argument]) -> Iterator[Item]:
    for one in arguments:
        if one.text == "DESTINATION" or one.text in OPTIONS:
            return
        yield Item(one.text, one.start, one.end)


def _quoted_as(source: SourceText, items: Sequence[Item], text: str) -> str:
    """A text in quotes, if the last one of its likes is."""
    is_quoted = source.text[items[-1].start] == '"'
    return f'"{text}"' if is_quoted else text


def is_path(folder: str, suffix: str) -> Callable[[str], bool]:
    """Whether an argument is a file of a folder."""
    pattern = re.compile(rf"(?:\$\{{\w+\}}/)?{folder}/[\w./-]+\.{suffix}")
    return lambda text: pattern.fullmatch(text) is not None
