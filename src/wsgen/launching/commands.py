"""Find the programs that a command line runs, and the requests of services that it makes.

Programs are found through shells, terminals, wrappers and `ros2 run`. A request is the YAML of
`ros2`, a mapping in braces, or the text format of Protocol Buffers of `gz`: `name: value` and
`name { ... }`, with commas or without.
"""

from __future__ import annotations

import itertools
import os
import re
import shlex
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.diagnostics import Rule, Severity
from wsgen.launching import known_packages
from wsgen.model.plan import Include, Process
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan


COMMAND_WITHOUT_SHELL = Rule(
    code="LCH040",
    name="command-without-shell",
    severity=Severity.ERROR,
    summary="A command line is a single word, which is not split without a shell.",
    why="`launch` looks for a program with that whole name, including its blanks, and does not "
    "find one.",
    example="ExecuteProcess(cmd=['gz sim -r', world])",
    instead="ExecuteProcess(cmd=['gz', 'sim', '-r', world])",
)

_SHELLS = frozenset(("bash", "dash", "fish", "sh", "zsh"))
_INTERPRETERS = frozenset(("perl", "python", "python3", "ruby"))
# Program -> its options whose value is a word of its own. What follows the options is run.
_WRAPPERS: dict[str, tuple[str, ...]] = {
    "chrt": ("-T", "-P", "-D"),
    "env": ("-u", "-C"),
    "exec": ("-a",),
    "gdb": ("-ex", "-x"),
    "nice": ("-n",),
    "nohup": (),
    "optirun": (),
    "prime-run": (),
    "setsid": (),
    "stdbuf": ("-i", "-o", "-e"),
    "sudo": ("-u", "-g"),
    "taskset": ("-c",),
    "time": (),
    "timeout": ("-k", "-s"),
    "unbuffer": (),
    "valgrind": (),
    "vglrun": ("-d",),
    "xvfb-run": ("-e", "-f", "-n", "-p", "-s", "-w"),
    **dict.fromkeys(("!", "(", "do", "else", "if", "then", "until", "while", "{"), ()),
}
_WITH_NUMBER = frozenset(("chrt", "taskset", "timeout"))  # before what they run
# Program -> the options that what it runs follows.
_TERMINALS = {
    "gnome-terminal": ("--", "-e", "-x", "--command"),
    "konsole": ("-e",),
    "lxterminal": ("-e", "--command"),
    "terminator": ("-e", "-x", "--command", "--execute"),
    "x-terminal-emulator": ("-e",),
    "xfce4-terminal": ("-e", "-x", "--command", "--execute"),
    "xterm": ("-e",),
}
# What a shell puts in place of it is the path of the program that it names.
_LOOKED_UP = lazy_pattern(
    r"\$\(\s*(?:which|command -v)\s+([\w./-]+)\s*\)|`\s*which\s+([\w./-]+)\s*`"
)
_ASSIGNMENT = lazy_pattern(r"[A-Za-z_]\w*=")
# `gz` and `ign` have commands that exit at once, too.
_GZ = frozenset(("gz", "ign"))
_GZ_SERVERS = (("sim",), ("gazebo",))
_OPERATORS = ";&|\n<>"


def programs(process: Process) -> list[Process]:
    """What a process runs, each as it would be started alone; a node is itself.

    `ros2 run` is the node that it starts; of other programs the name is the executable.
    """
    if process.command is None:
        return [_with_ros_arguments(process)]
    return [_program(process, words) for words in _command_lines(process)]


def runs_for_ever(process: Process) -> bool:
    """Whether a process runs something that does not exit by itself."""
    return any(
        nested_launch(program) is not None
        or (
            known_packages.runs_for_ever(program.executable or "")
            and (program.executable not in _GZ or program.arguments[:1] in _GZ_SERVERS)
        )
        for program in programs(process)
    )


def started_programs(plan: LaunchPlan) -> list[Process]:
    """What all processes of the plan run."""
    return [program for process in plan.processes for program in programs(process)]


def started_launch_files(plan: LaunchPlan) -> tuple[Include, ...]:
    """The launch files that the plan includes, and those that it runs with `ros2 launch`."""
    included = {(include.package, include.file.name) for include in plan.includes}
    nested = (nested_launch(program) for program in started_programs(plan))
    return (
        *plan.includes,
        *(one for one in nested if one and (one.package, one.file.name) not in included),
    )


def has_gaps(plan: LaunchPlan) -> bool:
    """Whether an argument is empty by default, as somebody is meant to give it."""
    return any(argument.default == "" for argument in plan.arguments)


def nested_launch(program: Process) -> Include | None:
    """The launch file that `ros2 launch` runs."""
    if program.executable != "ros2" or program.arguments[:1] != ("launch",):
        return None
    words = [word for word in program.arguments[1:] if not word.startswith("-")]
    given = dict(word.split(":=", 1) for word in words if ":=" in word)
    names = [word for word in words if ":=" not in word]
    if not names:
        return None
    package = names[0] if len(names) > 1 else None
    return Include(package=package, file=Path(names[-1]), arguments=given, evaluated=False)


def commands_without_shell(plan: LaunchPlan) -> Iterator[Diagnostic]:
    """Report the command lines that no shell splits."""
    for process in plan.processes:
        if process.command and _lacks_shell(process) and not plan.is_unknown(process.command[0]):
            line = process.command[0]
            yield COMMAND_WITHOUT_SHELL.at(
                process.file,
                process.line,
                line,
                message=f"'{line}' is one item of `cmd`, which `launch` takes for the name of a "
                "program.",
                hint="Write each word as a separate item, or add shell=True.",
            )


def _lacks_shell(process: Process) -> bool:
    """Whether a whole command line is the name of the program, as it is without a shell."""
    program = process.command[0] if process.command else ""
    return not process.is_shell and len(program.split()) > 1 and not program.startswith(("/", "."))


def split(line: str) -> list[str]:
    """The words of a command line; of one that cannot be split, what blanks separate."""
    try:
        return shlex.split(keep_separators(line))
    except ValueError:
        return line.split()


def keep_separators(line: str) -> str:
    """A command line from which `shlex` takes no backslash of a path of Windows."""
    return line.replace("\\", r"\\") if os.name == "nt" else line


def _command_lines(process: Process) -> Iterator[list[str]]:
    command = process.command or ()
    if process.is_shell or _lacks_shell(process):
        yield from _in_shell(" ".join(command))
    else:
        yield from _unwrapped(list(command))


def shell_commands(text: str) -> Iterator[list[str]]:
    """The words of each command of a text for a shell; redirections are words of their own.

    A text with a quote that is not closed is taken apart at its blanks.
    """
    lexer = shlex.shlex(text, posix=True, punctuation_chars=_OPERATORS)
    lexer.whitespace_split = True
    lexer.whitespace = " \t\r"
    lexer.commenters = ""
    try:
        tokens = list(lexer)
    except ValueError:
        tokens = text.split()
    words: list[str] = []
    for token in tokens:
        if token and not token.strip(_OPERATORS) and not is_redirection(token):
            yield words
            words = []
        else:
            words.append(token)
    yield words


def is_redirection(word: str) -> bool:
    """Whether the next word of a command for a shell is a file that it reads or writes."""
    return bool(word) and not word.strip(_OPERATORS) and ("<" in word or ">" in word)


def _in_shell(text: str) -> Iterator[list[str]]:
    """The programs of a text for a shell, which may have several commands."""
    text = _LOOKED_UP.sub(lambda found: found[1] or found[2], text)
    for words in shell_commands(text):
        before = ["", *words]
        yield from _unwrapped(
            [
                word
                for word, previous in zip(words, before, strict=False)
                if not (is_redirection(word) or is_redirection(previous))
            ]
        )


def _unwrapped(words: list[str]) -> Iterator[list[str]]:
    """The programs that a command line runs in the end."""
    while words and _ASSIGNMENT.match(words[0]):
        words = words[1:]
    if not words:
        return
    program, rest = words[0].rpartition("/")[2], words[1:]
    if program in _SHELLS:
        text = _text_for_shell(rest)
        yield from _after_options(rest, ()) if text is None else _in_shell(text)
    elif program in _TERMINALS:
        starts = [place for place, word in enumerate(rest) if word in _TERMINALS[program]]
        inside = rest[starts[0] + 1 :] if starts else []
        yield from _in_shell(inside[0]) if len(inside) == 1 else _unwrapped(inside)
    elif program in _WRAPPERS:
        yield from _after_options(rest, _WRAPPERS[program], has_number=program in _WITH_NUMBER)
    elif program in _INTERPRETERS and rest and rest[0] not in {"-m", "-c"}:
        yield from _after_options(rest, ())
    else:
        yield [program, *rest]


def _text_for_shell(words: Sequence[str]) -> str | None:
    """What `bash -c` runs; None where it runs a file."""
    for word, text in itertools.pairwise(words):
        if not word.startswith("-"):
            return None
        if word.endswith("c") and not word.startswith("--"):
            return text
    return None


def _after_options(
    words: Sequence[str], with_value: Sequence[str], *, has_number: bool = False
) -> Iterator[list[str]]:
    words = list(words)
    while words and words[0].startswith("-"):
        del words[: 2 if words[0] in with_value else 1]
    yield from _unwrapped(words[1:] if has_number else words)


def _program(process: Process, words: Sequence[str]) -> Process:
    """A program of a command line, described as the process that runs it."""
    if words[:2] != ["ros2", "run"]:
        return replace(process, executable=words[0], arguments=tuple(words[1:]))
    words = list(words[2:])
    while words and words[0].startswith("-"):
        del words[: 2 if words[0] == "--prefix" else 1]
    package, executable, *arguments = (*words, "", "") if len(words) < 2 else words  # noqa: PLR2004
    return _with_ros_arguments(
        replace(process, package=package, executable=executable, arguments=tuple(arguments))
    )


def _with_ros_arguments(node: Process) -> Process:
    """The node with what follows `--ros-args` as parameters and remappings."""
    if "--ros-args" not in node.arguments:
        return node
    place = node.arguments.index("--ros-args")
    parameters, remappings = dict(node.parameters), list(node.remappings)
    namespace = node.namespace
    for option, word in itertools.pairwise(node.arguments[place:]):
        name, found, value = word.partition(":=")
        if not found:
            continue
        if option in {"-p", "--param"}:
            parameters[name] = value
        elif name == "__ns":
            namespace = value
        elif option in {"-r", "--remap"}:
            remappings.append((name, value))
    return replace(
        node,
        arguments=node.arguments[:place],
        parameters=parameters,
        remappings=tuple(remappings),
        namespace=namespace,
    )


SPAWNING_REQUESTS = {"SpawnEntity": "xml", "EntityFactory": "sdf"}  # type -> field for a text
ROBOT = lazy_pattern(r"<(?:robot|sdf)\b")
_TOKEN = lazy_pattern(
    r"""(?P<space>[\s,;]+)
    |(?P<brace>[{}\[\]])
    |"(?P<double>(?:[^"\\]|\\.)*)"
    |'(?P<single>(?:[^'\\]|\\.|'')*)'
    |(?P<colon>:)
    |(?P<plain>[^\s,;{}\[\]"'][^,;{}\[\]\n]*?(?=:(?:[\s"'{]|$)|[\s,;{}\[\]]|$))""",
    re.DOTALL | re.VERBOSE,
)
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r", "0": "\0"}
_ESCAPE = lazy_pattern(r"\\(.)", re.DOTALL)


def read_request(text: str) -> dict[str, Any] | None:
    """The fields of a request, texts or such mappings; None where the text is no request."""
    tokens: list[tuple[str, str]] = []
    place = 0
    text = text.strip()
    while place < len(text):
        found = _TOKEN.match(text, place)
        if found is None or found.lastgroup is None:
            return None
        place = found.end()
        if found.lastgroup != "space":
            tokens.append((found.lastgroup, found[found.lastgroup]))
    if tokens[:1] == [("brace", "{")]:
        if tokens.pop() != ("brace", "}"):
            return None
        tokens.pop(0)
    try:
        fields = _fields(tokens)
    except ValueError:
        return None
    return None if tokens else fields  # the tokens of all fields are taken


def requested_texts(words: Iterable[str]) -> Iterator[str]:
    """The robots in the requests that are words of a command line."""
    for word in words:
        if ROBOT.search(word):
            # Where the words are for a shell, there are quotes around the request.
            fields = read_request(word) or read_request(word.strip("'")) or {}
            yield from (fields[name] for name in SPAWNING_REQUESTS.values() if name in fields)


def _fields(tokens: list[tuple[str, str]]) -> dict[str, Any]:
    """Take `name: value` from the tokens, up to the end or to a closing brace.

    Raises:
        ValueError: The tokens are no fields.
    """
    fields: dict[str, Any] = {}
    while tokens and tokens[0] != ("brace", "}"):
        if len(tokens) < 3 or tokens[0][0] == "brace":  # noqa: PLR2004  name, colon or brace, value
            raise ValueError
        name = tokens.pop(0)[1]
        if tokens[0][0] == "colon":
            tokens.pop(0)
        elif tokens[0] != ("brace", "{"):
            raise ValueError
        kind, value = tokens.pop(0)
        if (kind, value) == ("brace", "{"):
            fields[name] = _fields(tokens)
            if not tokens:
                raise ValueError
            tokens.pop(0)
        elif kind in {"double", "single", "plain"}:
            fields[name] = value if kind == "plain" else _unescaped(kind, value)
        else:
            raise ValueError
    return fields


def _unescaped(kind: str, text: str) -> str:
    if kind == "single":
        text = text.replace("''", "'")
    return _ESCAPE.sub(lambda found: _ESCAPES.get(found[1], found[1]), text)
