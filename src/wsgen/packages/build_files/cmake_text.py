"""Read the commands in a CMakeLists.txt, as CMake's lexer does.

Also what the others keep of a call, and the keywords of commands of CMake and ament, with the one
that a misspelled word means.
"""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.text.files import read_regular
from wsgen.text.suggestions import misspelled_as
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence
    from pathlib import Path


# cmake-language(7), "Lexical Elements". An unquoted argument may hold quoted parts, as in
# -DA="b c", and $(NAME).
_BRACKET = r"\[(?P<{0}>=*)\[.*?\](?P={0})\]"
_TOKEN = lazy_pattern(
    rf"""
    (?P<blank>[ \t\r\n]+)
  | (?P<comment>\#{_BRACKET.format("equals")}|\#[^\n]*)
  | (?P<bracket>{_BRACKET.format("signs")})
  | (?P<quoted>"(?:[^"\\]|\\.)*")
  | (?P<open>\()
  | (?P<close>\))
  | (?P<unquoted>(?:\\.|\$\([^()\s"]*\)|[^\s()\#"\\]|(?<=[^\s(])"(?:[^"\\]|\\.)*")+)
    """,
    re.DOTALL | re.VERBOSE,
)
_NAME = lazy_pattern(r"[A-Za-z_]\w*")
SIZE_LIMIT = 2**20  # bytes; build files are written by hand

BLOCKS = ("block", "foreach", "function", "if", "macro", "while")  # each ends with end...()
QUOTED = "quoted"
UNQUOTED = "unquoted"
BRACKET = "bracket"


class Argument(NamedTuple):
    """One argument of a command, as it is written."""

    text: str  # without its quotation marks or brackets
    kind: str  # QUOTED, UNQUOTED or BRACKET; a parenthesis is unquoted
    line: int  # 1-based
    start: int = 0  # where it is in the text, with its quotation marks or brackets
    stop: int = 0


class Call(NamedTuple):
    """One call of a command."""

    command: str  # in lower case: CMake ignores case
    written: tuple[Argument, ...]
    line: int  # 1-based, of the command
    end: int  # 1-based, of the closing parenthesis
    start: int  # where the command begins in the text
    stop: int  # behind its closing parenthesis

    @property
    def arguments(self) -> tuple[str, ...]:
        """The texts of the arguments."""
        return tuple([argument.text for argument in self.written])

    @property
    def argument_lines(self) -> tuple[int, ...]:
        """The line of each argument."""
        return tuple([argument.line for argument in self.written])


class SyntaxMistake(NamedTuple):
    """Where CMake cannot go on parsing."""

    message: str
    line: int  # 1-based
    hint: str


def read_calls(file: Path) -> tuple[Call, ...]:
    """List the calls in the order of the text; empty if the file cannot be read."""
    text = read_text(file)
    return () if text is None else parse(text)[0]


def read_text(file: Path) -> str | None:
    """The text of a file of CMake; None if it cannot be read."""
    try:
        data = read_regular(file, SIZE_LIMIT)
    except (OSError, ValueError):  # a name with a null byte
        return None
    if len(data) > SIZE_LIMIT:
        return None
    return re.sub("\r\n?", "\n", data.decode("utf-8-sig", "replace"))


def parse(text: str) -> tuple[tuple[Call, ...], SyntaxMistake | None]:
    """The calls before the first mistake of syntax, and that."""
    parser = _Parser(text)
    mistake = parser.parse()
    return tuple(parser.calls), mistake


class _Parser:
    def __init__(self, text: str) -> None:
        self.text = text
        self.calls: list[Call] = []
        # Of a command whose parenthesis must follow: its name, line and place in the text.
        self._name: tuple[str, int, int] | None = None
        self._written: list[Argument] = []
        self._open = 0  # parentheses

    def parse(self) -> SyntaxMistake | None:
        """Collect the calls up to the first mistake."""
        line, position = 1, 0
        while position < len(self.text):
            token = _TOKEN.match(self.text, position)
            if token is None:
                return self._no_token(position, line)
            if token.lastgroup not in {"blank", "comment"}:
                mistake = self._add(token, token.lastgroup or "", line)
                if mistake is not None:
                    return mistake
            line += token[0].count("\n")
            position = token.end()
        if self._name is None:
            return None
        name, line, _ = self._name
        if self._open:
            return SyntaxMistake(
                f"The parenthesis of {name}( is not closed.", line, "Add `)` where it ends."
            )
        return _no_parenthesis(name, line)

    def _add(self, token: re.Match[str], kind: str, line: int) -> SyntaxMistake | None:
        if self._open:
            self._open += {"open": 1, "close": -1}.get(kind, 0)
            if not self._open and self._name is not None:
                name, first_line, start = self._name
                written = tuple(self._written)
                self.calls.append(Call(name.lower(), written, first_line, line, start, token.end()))
                self._name, self._written = None, []
            else:
                self._written.append(_argument(token, kind, line))
        elif self._name is None:
            if kind != UNQUOTED or not _NAME.fullmatch(token[0]):
                return _no_command(token[0], line)
            self._name = (token[0], line, token.start())
        elif kind == "open":
            self._open = 1
        else:
            return _no_parenthesis(*self._name[:2])
        return None

    def _no_token(self, position: int, line: int) -> SyntaxMistake:
        if self.text[position] == '"':
            found = _find_open_quote(self.text)
            return SyntaxMistake(
                "This line opens a quotation mark that is not closed.",
                line if found is None else found,
                'Close it: "..."',
            )
        return SyntaxMistake("A backslash ends the file.", line, "Remove the backslash.")


def _no_parenthesis(name: str, line: int) -> SyntaxMistake:
    return SyntaxMistake(
        f"`{name}` is not followed by a parenthesis.",
        line,
        f"Write `{name}(...)`, or `#` before a comment.",
    )


def _argument(token: re.Match[str], kind: str, line: int) -> Argument:
    text = token[0]
    if kind == QUOTED:
        text = text[1:-1].replace("\\\n", "")
    elif kind == BRACKET:
        width = len(token["signs"]) + 2
        text = text[width:-width].removeprefix("\r").removeprefix("\n")
    else:
        kind = UNQUOTED
    return Argument(text, kind, line, token.start(), token.end())


def _no_command(word: str, line: int) -> SyntaxMistake:
    if word == ")":
        return SyntaxMistake(
            "The closing parenthesis does not match an opening one.",
            line,
            "Remove it, or add `(` before.",
        )
    return SyntaxMistake(
        f"`{word.splitlines()[0]}` is not a command.",
        line,
        "Write a command with its arguments in parentheses, or # before a comment.",
    )


def find_open_block(file: Path) -> tuple[Call | None, Call | None]:
    """Find the call that opens a block that is not closed, or closes one that is not open.

    Returns:
        The call that opens a block without an end, and the call that ends another block instead;
        either may be None, and both are if all blocks match.
    """
    return open_block(read_calls(file))


def open_block(calls: tuple[Call, ...]) -> tuple[Call | None, Call | None]:
    """As `find_open_block`, of the calls of a file."""
    opened: list[Call] = []
    for call in calls:
        if call.command in BLOCKS:
            opened.append(call)
        elif call.command.startswith("end") and call.command[3:] in BLOCKS:
            if not opened or opened[-1].command != call.command[3:]:
                return (opened[-1] if opened else None), call
            opened.pop()
    return (opened[-1] if opened else None), None


_QUOTED = r'"(?:[^"\\]|\\.)*"'
_COMMENT = lazy_pattern(rf"{_QUOTED}|(#\[(=*)\[.*?\]\2\]|#[^\n]*)", re.DOTALL)
_STRING = lazy_pattern(rf'{_QUOTED}|".*\Z', re.DOTALL)  # the last one may have no end


def _find_open_quote(text: str) -> int | None:
    text = _COMMENT.sub(lambda match: "\n" * match[0].count("\n") if match[1] else match[0], text)
    for match in _STRING.finditer(text):
        first_line, line_break, _ = match[0].partition("\n")
        if not match[0].endswith('"', 1) or (line_break and first_line.rstrip().endswith(")")):
            return text.count("\n", 0, match.start()) + 1
    return None


_VISIBILITY = ("PUBLIC", "PRIVATE", "INTERFACE")
KEYWORDS: dict[str, Sequence[str]] = {
    "add_library": (
        *("SHARED", "STATIC", "MODULE", "OBJECT", "INTERFACE", "ALIAS", "IMPORTED"),
        "EXCLUDE_FROM_ALL",
    ),
    "ament_auto_package": ("INSTALL_TO_PATH", "INSTALL_TO_SHARE"),
    "find_package": (
        *("REQUIRED", "COMPONENTS", "OPTIONAL_COMPONENTS", "QUIET", "CONFIG", "EXACT", "MODULE"),
        *("NAMES", "PATHS", "HINTS", "NO_MODULE", "NO_DEFAULT_PATH"),
    ),
    "install": (
        *("TARGETS", "FILES", "PROGRAMS", "DIRECTORY", "SCRIPT", "CODE", "EXPORT", "TYPE"),
        *("DESTINATION", "COMPONENT", "CONFIGURATIONS", "PERMISSIONS", "FILE_PERMISSIONS"),
        *("DIRECTORY_PERMISSIONS", "USE_SOURCE_PERMISSIONS", "OPTIONAL", "PATTERN", "REGEX"),
        *("EXCLUDE", "EXCLUDE_FROM_ALL", "FILES_MATCHING", "MESSAGE_NEVER", "RENAME"),
        *("ARCHIVE", "LIBRARY", "RUNTIME", "OBJECTS", "INCLUDES", "NAMESPACE", "FILE"),
        *("PUBLIC_HEADER", "PRIVATE_HEADER", "RESOURCE", "FRAMEWORK", "BUNDLE", "FILE_SET"),
    ),
    "project": ("VERSION", "LANGUAGES", "DESCRIPTION", "HOMEPAGE_URL"),
    "rosidl_generate_interfaces": ("DEPENDENCIES", "LIBRARY_NAME", "SKIP_INSTALL"),
    "target_include_directories": (*_VISIBILITY, "SYSTEM", "BEFORE", "AFTER"),
    "target_link_libraries": _VISIBILITY,
}
_WORD = lazy_pattern(r"[A-Z][A-Z_]{3,}")


def meant_keyword(command: str, word: str, *, folders: Collection[str] = ()) -> str | None:
    """The keyword that an unquoted word of a call surely means; None if it is one or none.

    A name in one of the folders, which paths are relative to, is none.
    """
    known = KEYWORDS.get(command, ())
    if word in known or not known or not _WORD.fullmatch(word):
        return None
    if any(os.path.lexists(os.path.join(folder, word)) for folder in folders):
        return None
    return misspelled_as(word, known)


def word_keyword(command: str, word: str) -> str:
    """Say that CMake does not know the word."""
    return f"{command}() has no keyword {word}."


class InstallRule(NamedTuple):
    """A call of install(), or of a command that calls it."""

    kind: str  # DIRECTORY, FILES, PROGRAMS, TARGETS, ...
    names: tuple[tuple[Argument, str], ...]  # each as it is written, and its path or name
    destination: str | None  # relative to the prefix; None: it has none
    file: Path
    call: Call
    folder: Path  # that paths are relative to
    is_certain: bool  # no condition around it is unknown
    in_tests: bool
    place: Argument | None = None  # the argument with the destination
    is_optional: bool = False
    rename: str = ""
    # PATTERN or REGEX, its text, and whether it excludes.
    patterns: tuple[tuple[str, str, bool], ...] = ()
    matching_only: bool = False  # FILES_MATCHING
    # Which files can be run: "all", "none", or those that can in the source: "source".
    runnable: str = "none"


class Mention(NamedTuple):
    """A call that a check looks at."""

    call: Call
    arguments: tuple[Argument, ...]  # expanded
    file: Path
    is_certain: bool
    in_tests: bool
    folder: Path  # that paths are relative to
    order: int  # grows from call to call


def texts(mention: Mention) -> list[str]:
    """The arguments of a call as texts."""
    return [argument.text for argument in mention.arguments]


def sections(
    words: Sequence[Argument], keywords: Collection[str]
) -> tuple[list[Argument], dict[str, list[Argument]]]:
    """The arguments before the first keyword, and those after each."""
    first: list[Argument] = []
    found: dict[str, list[Argument]] = {}
    current = first
    for word in words:
        if word.text in keywords:
            current = found.setdefault(word.text, [])
        else:
            current.append(word)
    return first, found
