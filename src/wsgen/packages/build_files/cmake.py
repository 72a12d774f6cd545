"""Evaluate CMakeLists.txt without CMake: what it finds, compiles and installs.

Where a condition is not known, both of its branches count.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, NamedTuple

from wsgen.packages.build_files import cmake_commands, cmake_values
from wsgen.packages.build_files.cmake_text import (
    BRACKET,
    KEYWORDS,
    QUOTED,
    UNQUOTED,
    Argument,
    Call,
    InstallRule,
    Mention,
    SyntaxMistake,
    meant_keyword,
    open_block,
    parse,
    read_text,
)
from wsgen.packages.build_files.cmake_values import (
    BUILD,
    PREFIX,
    SEMICOLON,
    UNKNOWN,
    Conditions,
    expand,
    split_list,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from pathlib import Path

    from wsgen.model.build_facts import RequiredPackage, Target


MOST_STEPS = 20_000  # calls; more than that is an endless loop
DEEPEST = 30  # functions, files and folders inside each other
WORK_OF_A_STEP = 200  # what a regular expression may do in the time of a call
MOST_LETTERS = 2**17  # of an argument; a variable may double itself without end


class Block(NamedTuple):
    """A block and the calls in it."""

    head: Call
    branches: tuple[tuple[Call, Body], ...]  # more than one of an if()


Body = tuple["Call | Block", ...]


class Reader:
    """Evaluates the files of one package."""

    def __init__(self, source: Path, name: str, manifest_line: int | None = None) -> None:
        self.source = source
        self.manifest_line = manifest_line  # 1-based, of the name in package.xml
        self.name = name  # of the package, as package.xml has it
        self.build_file = source / "CMakeLists.txt"
        self.rules: list[InstallRule] = []
        self.mentions: dict[str, list[Mention]] = {}
        self.required: list[RequiredPackage] = []
        self.targets: dict[str, Target] = {}
        self.outputs: dict[str, str] = {}  # target -> the name of its file
        self.environment: list[tuple[str, str]] = []  # of the hooks: variable, path
        self.produced: set[str] = set()  # paths that commands write
        self.components: list[tuple[str, Mention]] = []  # programs of rclcpp_components
        # Keywords: the file, the command, the word as it is written, and what it means.
        self.misspelled: list[tuple[Path, str, Argument, str]] = []
        self.mistake: tuple[Path, SyntaxMistake] | None = None
        self.open_block: tuple[Path, Call | None, Call | None] | None = None
        self.is_whole = True
        self.knows_commands = True  # False: a command or an included file is not known
        self.last_line: int | None = None  # of the last call in CMakeLists.txt
        self.has_foreign = False  # commands of other packages may set any variable
        self.functions: dict[str, tuple[Call, Body, Path]] = {}
        self.variables: dict[str, str] = {}
        self.file = self.build_file
        self.folder = source
        self.is_certain = True
        self.in_tests = False
        self.depth = 0
        self._steps = 0
        self._stop: str = ""  # return, break or continue, while it is under way
        self._parents: list[dict[str, str]] = []  # the variables around a function or a folder

    def read(self) -> None:
        """Evaluate the CMakeLists.txt of the package."""
        source = str(self.source)
        self.variables.update(
            {
                **dict.fromkeys(("UNIX", "LINUX", "CMAKE_HOST_UNIX"), "1"),
                **dict.fromkeys(("CMAKE_SYSTEM_NAME", "CMAKE_HOST_SYSTEM_NAME"), "Linux"),
                **dict.fromkeys(("CMAKE_SOURCE_DIR", "CMAKE_CURRENT_SOURCE_DIR"), source),
                **dict.fromkeys(("CMAKE_BINARY_DIR", "CMAKE_CURRENT_BINARY_DIR"), BUILD),
                "CMAKE_INSTALL_PREFIX": PREFIX,
                "BUILD_TESTING": "ON",
            }
        )
        try:
            self.run_file(self.build_file)
        except RecursionError:  # blocks, references or parentheses in each other
            self.file, self.folder, self.is_certain = self.build_file, self.source, True
            self.is_whole = self.knows_commands = False

    # What is known.

    def look_up(self, kind: str, name: str) -> str:
        """The value of a variable in a text."""
        if kind == "ENV":
            return {"ROS_VERSION": "2"}.get(name, UNKNOWN)
        found = self.look_up_name(name)
        return "" if found is None else found

    def look_up_name(self, name: str) -> str | None:
        """The value of a variable; None if it is not defined, UNKNOWN if it may be."""
        found = self.variables.get(name)
        if found is not None:
            return found
        if name in NEVER_DEFINED or (name.startswith("PROJECT_") and name not in OF_PROJECT):
            return None
        if name.startswith("CMAKE_") and name not in USUALLY_UNDEFINED:
            return UNKNOWN
        return UNKNOWN if self.has_foreign and name not in USUALLY_UNDEFINED else None

    def exists(self, path: str) -> bool | None:
        """Whether a path exists; None where that is not known."""
        if UNKNOWN in path or path.startswith((BUILD, PREFIX)):
            return None
        place = os.path.join(self.folder, path)
        if not self.is_inside(place):
            return None
        return True if os.path.exists(place) else None if self.is_produced(place) else False

    def is_inside(self, path: str) -> bool:
        """Whether a path lies in the package."""
        return f"{os.path.normpath(path)}/".startswith(f"{self.source}/")

    def is_produced(self, path: str) -> bool:
        """Whether a command may write the path."""
        path = os.path.normpath(path)
        return any(f"{path}/".startswith(f"{one}/") or one.startswith(f"{path}/")
                   for one in self.produced)  # fmt: skip

    def _is_command(self, name: str) -> bool | None:
        return True if name.lower() in self.functions else None

    def _is_target(self, name: str) -> bool | None:
        return True if name in self.targets else None

    def matches(self, pattern: str, text: str) -> bool | None:
        """Whether a regular expression matches in a text; None where that is not known."""
        regex = cmake_values.compiled_regex(pattern) if self._steps <= MOST_STEPS else None
        if regex is None:
            return None
        self.count(min(regex.tries(text), cmake_values.MOST_TRIES) // WORK_OF_A_STEP)
        return regex.search(text)

    def count(self, steps: int) -> None:
        """Count work that takes as long as that many calls."""
        self._steps += steps

    def line_of_last(self, command: str) -> int | None:
        """The line of the last call of a command in CMakeLists.txt, or of its last call at all."""
        lines = [
            one.call.line
            for one in self.mentions.get(command, ())
            if one.file == self.build_file and one.call.command == command
        ]
        return lines[-1] if lines else self.last_line

    # Files, blocks and calls.

    def run_file(self, file: Path) -> bool:
        """Evaluate a file; False if it cannot be read."""
        text = read_text(file) if self.depth < DEEPEST else None
        if text is None:
            return False
        calls, mistake = parse(text)
        if mistake is not None and self.mistake is None:
            self.mistake = (file, mistake)
            self.is_whole = False
        opened, closing = open_block(calls)
        if (opened or closing) and mistake is None and self.open_block is None:
            self.open_block = (file, opened, closing)
            self.is_whole = False
        before, self.file = self.file, file
        here = {name: self.variables.get(name) for name in LIST_VARIABLES}
        if calls and file == self.build_file:
            self.last_line = calls[-1].line
        self.variables["CMAKE_CURRENT_LIST_FILE"] = str(file)
        self.variables["CMAKE_CURRENT_LIST_DIR"] = str(file.parent)
        self.depth += 1
        self.run(_nest(calls))
        self.depth -= 1
        self.file = before
        for name, value in here.items():
            if value is not None:
                self.variables[name] = value
        if self._stop == "return":
            self._stop = ""
        return True

    def run(self, body: Body) -> None:
        """Evaluate calls and blocks in order."""
        for one in body:
            if self._stop:
                return
            if isinstance(one, Block):
                self._run_block(one)
            else:
                self.run_call(one)

    def _run_block(self, block: Block) -> None:
        command = block.head.command
        if command == "if":
            self._run_if(block)
        elif command == "foreach":
            self._run_foreach(block)
        elif command in {"function", "macro"}:
            arguments = self.expand(block.head.written)
            if arguments:
                self.functions[arguments[0].text.lower()] = (
                    block.head,
                    block.branches[0][1],
                    self.file,
                )
        elif command == "while":
            self._maybe([block.branches[0][1]])
        else:
            self.run(block.branches[0][1])

    def _run_if(self, block: Block) -> None:
        possible: list[tuple[Body, bool]] = []
        for call, body in block.branches:
            is_of_tests = any(one.text in TEST_VARIABLES for one in call.written)
            holds = True if call.command == "else" else self.holds(call)
            if holds is not False:
                possible.append((body, is_of_tests))
            if holds:
                break
        else:
            possible.append(((), False))
        if len(possible) == 1:
            before, self.in_tests = self.in_tests, self.in_tests or possible[0][1]
            self.run(possible[0][0])
            self.in_tests = before
        else:
            self._maybe([body for body, _ in possible])

    def holds(self, call: Call) -> bool | None:
        """Whether the condition of an if() holds."""
        # Not kept: it would hold what holds it, until the garbage collector looks for both.
        conditions = Conditions(
            self.look_up_name, self.exists, self._is_command, self._is_target, self.matches
        )
        return conditions.evaluate(self.expand(call.written))

    def _maybe(self, bodies: Sequence[Body]) -> None:
        """Evaluate each of several bodies, one of which is run."""
        certain, self.is_certain = self.is_certain, False
        before = dict(self.variables)
        ends: list[dict[str, str]] = []
        for body in bodies:
            self.variables = dict(before)
            self.run(body)
            if self._stop != "return":
                ends.append(self.variables)
            self._stop = ""
        self.is_certain = certain
        merged = ends[0] if ends else before
        for other in ends[1:]:
            for name in merged.keys() | other.keys():
                if merged.get(name) != other.get(name):
                    merged[name] = UNKNOWN
        self.variables = merged

    def _run_foreach(self, block: Block) -> None:
        words = self.expand(block.head.written)
        body = block.branches[0][1]
        if not words:
            return
        name, values = words[0].text, [word.text for word in words[1:]]
        if values[:1] == ["IN"]:
            values = self._foreach_values(values[1:])
        elif values[:1] == ["RANGE"]:
            values = _range(values[1:])
        for value in values:
            if UNKNOWN in value:
                self.variables[name] = UNKNOWN
                self._maybe([body, ()])
            else:
                self.variables[name] = value
                self.run(body)
            if self._stop in {"break", "continue"}:
                has_ended, self._stop = self._stop == "break", ""
                if has_ended:
                    break
            if self._stop:
                return

    def _foreach_values(self, words: Sequence[str]) -> list[str]:
        values: list[str] = []
        kind = ""
        for word in words:
            if word in {"LISTS", "ITEMS", "ZIP_LISTS"}:
                kind = word
            elif kind == "LISTS":
                values += split_list(self.look_up("", word))
            elif kind == "ZIP_LISTS":
                return [UNKNOWN]
            else:
                values.append(word)
        return values

    def expand(self, written: Iterable[Argument]) -> list[Argument]:
        """The arguments of a call, with the values of variables."""
        found: list[Argument] = []
        for argument in written:
            if argument.kind == BRACKET or ("$" not in argument.text and "\\" not in argument.text
                                            and ";" not in argument.text):  # fmt: skip
                found.append(argument)
                continue
            text = expand(argument.text, self.look_up)
            if len(text) > MOST_LETTERS:
                text = UNKNOWN
            if argument.kind == QUOTED:
                found.append(argument._replace(text=text))
            else:
                found += [Argument(part, UNQUOTED, argument.line) for part in split_list(text)]
        if any(SEMICOLON in one.text for one in found):
            found = [one._replace(text=one.text.replace(SEMICOLON, ";")) for one in found]
        return found

    def run_call(self, call: Call) -> None:
        """Evaluate one call."""
        self._steps += 1
        if self._steps > MOST_STEPS:
            self.is_whole, self._stop = False, "return"
            return
        name = call.command
        if name in {"return", "break", "continue"}:
            self._stop = name
            if name == "return" and self.file == self.build_file and not self._parents:
                # The rest may be read in another run, as that of a superbuild is.
                self.is_whole = self.knows_commands = False
            return
        arguments = self.expand(call.written)
        if name in self.functions:
            self._run_function(call, arguments)
            return
        if name in KEYWORDS:
            arguments = self._with_meant_keywords(name, arguments)
        mention = Mention(
            call,
            tuple(arguments),
            self.file,
            self.is_certain,
            self.in_tests,
            self.folder,
            self._steps,
        )
        self.mentions.setdefault(name, []).append(mention)
        handler: Callable[[Reader, Mention], None] | None = cmake_commands.COMMANDS.get(name)
        if handler is not None:
            handler(self, mention)
        elif not cmake_commands.is_harmless(name):
            self.has_foreign = True
            self.is_whole = self.knows_commands = False

    def _with_meant_keywords(self, command: str, words: list[Argument]) -> list[Argument]:
        """The arguments of a call as they are meant; misspelled keywords are noted."""
        found = []
        for position, word in enumerate(words):
            meant = None
            if word.kind == UNQUOTED and position > 0:  # the first is a name or a form
                meant = meant_keyword(command, word.text, folders=[str(self.folder)])
            if meant is not None:
                self.misspelled.append((self.file, command, word, meant))
            found.append(word if meant is None else word._replace(text=meant))
        return found

    def _run_function(self, call: Call, arguments: list[Argument]) -> None:
        head, body, file = self.functions[call.command]
        if self.depth >= DEEPEST:
            self.is_whole = False
            return
        parameters = [argument.text for argument in head.written[1:]]
        values = [argument.text for argument in arguments]
        is_function = head.command == "function"
        around = self.variables
        given = {
            **dict(zip(parameters, values, strict=False)),
            "ARGC": str(len(values)),
            "ARGV": ";".join(values),
            "ARGN": ";".join(values[len(parameters) :]),
            **{f"ARGV{number}": value for number, value in enumerate(values)},
        }
        before, self.file = self.file, file
        if is_function:
            self._parents.append(around)
            self.variables = {**around, **given}
        else:
            hidden = {name: around.get(name) for name in given}
            self.variables.update(given)
        self.depth += 1
        self.run(body)
        self.depth -= 1
        self.file = before
        if self._stop == "return":
            self._stop = ""
        if is_function:
            self.variables = self._parents.pop()
        else:
            for name, value in hidden.items():
                if value is None:
                    self.variables.pop(name, None)
                else:
                    self.variables[name] = value

    def set(self, name: str, value: str, *, in_parent: bool = False) -> None:
        """Set a variable here, or around the function or folder."""
        if not in_parent:
            self.variables[name] = value
        elif self._parents:
            parent = self._parents[-1]
            is_same = self.is_certain or parent.get(name) == value
            parent[name] = value if is_same else UNKNOWN

    def run_folder(self, folder: Path) -> bool:
        """Evaluate the CMakeLists.txt of a folder; False if there is none."""
        before = self.folder
        self.folder = folder
        self._parents.append(self.variables)
        below = os.path.relpath(folder, self.source)
        self.variables = {
            **self.variables,
            "CMAKE_CURRENT_SOURCE_DIR": str(folder),
            "CMAKE_CURRENT_BINARY_DIR": f"{BUILD}/{below}",
        }
        found = self.run_file(folder / "CMakeLists.txt")
        self.variables = self._parents.pop()
        self.folder = before
        return found

    def path_of(self, text: str) -> str:
        """The absolute path that a text stands for."""
        if text.startswith(UNKNOWN) or "$<" in text:
            return UNKNOWN
        return os.path.join(self.folder, text)


# Parts of the variables that CMake sets for each file.
LIST_VARIABLES = ("CMAKE_CURRENT_LIST_FILE", "CMAKE_CURRENT_LIST_DIR")
TEST_VARIABLES = frozenset({"BUILD_TESTING", "CATKIN_ENABLE_TESTING", "${BUILD_TESTING}"})
# What CMake defines on other systems alone.
NEVER_DEFINED = frozenset({"WIN32", "APPLE", "MSVC", "ANDROID", "MINGW", "CYGWIN", "IOS", "MSYS"})
# What project() defines, of which not all has a value here.
OF_PROJECT = frozenset({"PROJECT_DESCRIPTION", "PROJECT_HOMEPAGE_URL", "PROJECT_IS_TOP_LEVEL"})
# What a build by colcon does not define, if the user does not.
USUALLY_UNDEFINED = frozenset(
    {
        *("BUILD_SHARED_LIBS", "CMAKE_BUILD_TYPE", "CMAKE_CXX_STANDARD", "CMAKE_C_STANDARD"),
        "CMAKE_POSITION_INDEPENDENT_CODE",
    }
)


def _range(words: Sequence[str]) -> list[str]:
    try:
        numbers = [int(word) for word in words]
    except ValueError:
        return [UNKNOWN]
    if len(numbers) == 1:
        numbers = [0, *numbers]
    if len(numbers) < 2 or abs(numbers[1] - numbers[0]) > MOST_STEPS:
        return [UNKNOWN]
    step = numbers[2] if len(numbers) > 2 and numbers[2] else 1
    return [str(number) for number in range(numbers[0], numbers[1] + 1, step)]


def _nest(calls: Sequence[Call]) -> Body:
    body, _ = _nest_until(calls, 0, frozenset())
    return body


def _nest_until(calls: Sequence[Call], index: int, ends: frozenset[str]) -> tuple[Body, int]:
    """The calls up to one of these commands, with blocks in them; and where that is."""
    found: list[Call | Block] = []
    while index < len(calls):
        call = calls[index]
        if call.command in ends:
            break
        if call.command in {"block", "foreach", "function", "if", "macro", "while"}:
            block, index = _block(calls, index)
            found.append(block)
        else:
            found.append(call)
        index += 1
    return tuple(found), index


def _block(calls: Sequence[Call], index: int) -> tuple[Block, int]:
    head = branch = calls[index]
    ends = frozenset({f"end{head.command}", *(("elseif", "else") if head.command == "if" else ())})
    branches: list[tuple[Call, Body]] = []
    while True:
        body, index = _nest_until(calls, index + 1, ends)
        branches.append((branch, body))
        if index >= len(calls) or calls[index].command.startswith("end"):
            return Block(head, tuple(branches)), index
        branch = calls[index]
