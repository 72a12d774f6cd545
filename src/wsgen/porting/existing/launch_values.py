"""What launch files of ROS 1 say in texts, as Python of a launch file of ROS 2.

Source: ros/ros_comm, roslaunch (`substitution_args.py`, `loader.py`); ros2/launch.
"""

from __future__ import annotations

import ast
import itertools
import keyword
import math
import re
import shlex
import textwrap
from typing import TYPE_CHECKING, NamedTuple, TypeGuard

from wsgen.text.markup import COMMENT
from wsgen.text.pythontree import parse_anew
from wsgen.text.yamlfile import NotYaml, Value, parse

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence


WIDTH = 99  # columns, as ament_flake8 has it
WRAPPED = 80  # of comments
# Name -> the module that a launch file imports it from.
MODULES = {
    **dict.fromkeys(
        (
            *("DeclareLaunchArgument", "ExecuteProcess", "GroupAction", "IncludeLaunchDescription"),
            *("SetEnvironmentVariable", "SetLaunchConfiguration", "Shutdown"),
        ),
        "launch.actions",
    ),
    **dict.fromkeys(("IfCondition", "UnlessCondition"), "launch.conditions"),
    "PythonLaunchDescriptionSource": "launch.launch_description_sources",
    **dict.fromkeys(
        (
            *("AnonName", "Command", "EnvironmentVariable", "IfElseSubstitution"),
            *("LaunchConfiguration", "PathJoinSubstitution", "PythonExpression"),
            "ThisLaunchFileDir",
        ),
        "launch.substitutions",
    ),
    **dict.fromkeys(
        (*("Node", "PushRosNamespace", "SetParameter", "SetParametersFromFile", "SetRemap"),),
        "launch_ros.actions",
    ),
    "ParameterValue": "launch_ros.parameter_descriptions",
    "FindPackageShare": "launch_ros.substitutions",
}
SHARE = "share"  # the variable with the share folder of the package itself
_SUBSTITUTION = re.compile(r"\$\((\w[\w-]*)(?:\s+([^()]*?))?\s*\)")
_EVAL = re.compile(r"\s*\$\(eval\s+(.*)\)\s*", re.DOTALL)
_TYPES = {"int": "int", "double": "float", "bool": "bool", "boolean": "bool", "float": "float"}
_OF_MATH = frozenset(vars(math)) - {"__name__"}
_BUILTINS = frozenset(("list", "dict", "map", "str", "float", "int", "True", "False"))
_QUOTED = "'"
# Of an expression, with nothing special about their parts.
_PLAIN = (
    *(ast.Attribute, ast.BinOp, ast.BoolOp, ast.Constant, ast.Dict, ast.List, ast.Subscript),
    ast.Tuple,
)


class UnsaidError(Exception):
    """What ROS 2 has no counterpart of; the converter lists it."""

    def __init__(self, what: str, advice: str) -> None:
        super().__init__(what)
        self.what = what
        self.advice = advice


class Item(NamedTuple):
    """What stands between brackets, with what is before it."""

    key: str  # `name=`, `'name': ` or nothing
    code: Code
    comments: tuple[str, ...] = ()  # lines above it, without `# `


class Tree(NamedTuple):
    """An expression with brackets."""

    head: str
    items: tuple[Item, ...]
    tail: str


Code = str | Tree


def listed(codes: Iterable[Code]) -> Tree:
    """A list."""
    return Tree("[", tuple(Item("", code) for code in codes), "]")


def mapped(pairs: Iterable[tuple[str, Code]], tail: str = "}") -> Tree:
    """A dictionary with texts for keys."""
    return Tree("{", tuple(Item(f"{key!r}: ", code) for key, code in pairs), tail)


def flat(code: Code) -> str:
    """An expression on one line."""
    if isinstance(code, str):
        return code
    inside = ", ".join(item.key + flat(item.code) for item in code.items)
    comma = "," if code.head == "(" and len(code.items) == 1 else ""
    return f"{code.head}{inside}{comma}{code.tail}"


def _has_comments(code: Code) -> bool:
    return isinstance(code, Tree) and any(
        item.comments or _has_comments(item.code) for item in code.items
    )


def written(code: Code, indent: int = 4, before: int = 0) -> str:
    """An expression, on lines of its own where it is long.

    Args:
        code: the expression.
        indent: columns that its line is indented by.
        before: columns that are taken before it, and behind it.
    """
    line = flat(code)
    if isinstance(code, str):
        return line
    if indent + before + len(line) <= WIDTH and not _has_comments(code):
        return line
    # What is alone in brackets needs no line of its own: `(['a'])`, `([{...}])`.
    heads = _heads(code)
    is_short = indent + before + len("".join(heads)) <= WIDTH
    if len(heads) > 1 and is_short and not _has_comments(code):
        inner = written(code.items[0].code, indent, before + len(heads[0]) + 1)
        return f"{heads[0]}{inner}{code.tail}"
    return "\n".join((code.head, *_lines(code.items, indent + 4), " " * indent + code.tail))


def _heads(code: Code) -> list[str]:
    """What opens an expression, and those that are alone in its brackets and in theirs."""
    heads = list[str]()
    while isinstance(code, Tree):
        only = code.items[0] if len(code.items) == 1 else Item("", "")
        heads.append(code.head + (only.key if isinstance(only.code, Tree) else ""))
        code = only.code
    return heads


def _lines(items: Iterable[Item], indent: int) -> Iterator[str]:
    """Each of the items on lines of its own."""
    space = " " * indent
    for item in items:
        yield from (f"{space}# {comment}".rstrip() for comment in item.comments)
        yield f"{space}{item.key}{written(item.code, indent, len(item.key) + 1)},"


def whole_file(
    values: Values,
    name: str,
    settings: Sequence[Item],
    started: Iterable[tuple[str, Code, Sequence[str]]],
) -> str:
    """A launch file in Python.

    Args:
        values: what its code was made by.
        name: of the launch file of ROS 1.
        settings: its arguments, and other actions that come first.
        started: the other actions: names for variables, code, and comments.
    """
    taken = {"arguments", "generate_launch_description", "LaunchDescription", SHARE, *MODULES}
    body, names = list[str](), list[str]()
    if settings:
        body += ["    arguments = [", *_lines(settings, 8), "    ]", ""]
        names.append("*arguments")
    for given, code, comments in started:
        variable = _variable(given, taken)
        taken.add(variable)
        body += [f"    # {line}".rstrip() for line in comments]
        body += [f"    {variable} = {written(code, before=len(variable) + 3)}", ""]
        names.append(variable)
    if re.search(rf"\b{SHARE}\b(?!')", "\n".join(body)):
        find = flat(values.call("FindPackageShare", repr(values.package)))
        body = [f"    {SHARE} = {find}", "", *body]
    modules = sorted({MODULES[one] for one in values.imports})
    imports = [
        _import(module, sorted(one for one in values.imports if MODULES[one] == module))
        for module in modules
    ]
    entries = "".join(f"        {one},\n" for one in names)
    lines = "\n".join(
        (
            f"{_docstring(f'Start what {name} started in ROS 1.')}\n",
            "from launch import LaunchDescription",
            *imports,
            "",
            "",
            "def generate_launch_description():",
            '    """Declare the arguments; describe what is started."""',
            *body,
            f"    return LaunchDescription([\n{entries}    ])\n",
        )
    )
    return "\n".join(
        f"{line}  # noqa: E501" if len(line) > WIDTH else line for line in lines.split("\n")
    )


def _docstring(text: str) -> str:
    clean = "".join(one for one in text if one.isprintable() and one not in '\\"')
    return f'"""{clean}"""'


def _import(module: str, names: Sequence[str]) -> str:
    line = f"from {module} import {', '.join(names)}"
    if len(line) <= WIDTH:
        return line
    return "\n".join((f"from {module} import (", *(f"    {one}," for one in names), ")"))


def _variable(name: str, taken: Collection[str]) -> str:
    """A name for a variable that is not taken."""
    plain = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_").lower() or "action"
    if plain[0].isdigit() or keyword.iskeyword(plain):
        plain = f"action_{plain}"
    numbered = (f"{plain}_{number}" for number in itertools.count(2))
    return next(one for one in itertools.chain([plain], numbered) if one not in taken)


def prose_above(text: str, line: int) -> tuple[str, ...]:
    """The comment that ends on the line before this one, wrapped; empty if it is XML."""
    before = "\n".join(text.split("\n")[: line - 1])
    found = next((one for one in COMMENT.finditer(before) if not before[one.end() :].strip()), None)
    if found is None or "\n" in before[found.end() :]:
        return ()
    inside = found[0].removeprefix("<!--").removesuffix("-->")
    if "<" in inside or "$(" in inside:
        return ()
    paragraphs = (
        "".join(filter(str.isprintable, one)).strip() for one in inside.strip().split("\n")
    )
    return tuple(line for one in paragraphs for line in textwrap.wrap(one, WRAPPED))


class Values:
    """The texts of a launch file, as Python."""

    def __init__(
        self,
        declared: dict[str, str | None],
        find: Callable[[str], str],
        place: Callable[[str], str],
        package: str,
    ) -> None:
        """Begin a launch file.

        Args:
            declared: its arguments, with their defaults.
            find: what a package is called now; raises UnsaidError where it is not known.
            place: where the file of a path, as roslaunch writes it, is now.
            package: what the package of the launch file is called now.
        """
        self.declared = declared
        self.find = find
        self.place = place
        self.package = package
        self.imports: set[str] = set()

    def call(self, name: str, /, *positional: Code, **keywords: Code | None) -> Tree:
        """A call of something that is imported; keywords without a value are left out."""
        self.imports.add(name)
        items = [Item("", code) for code in positional]
        items += [Item(f"{key}=", code) for key, code in keywords.items() if code is not None]
        return Tree(f"{name}(", tuple(items), ")")

    def share(self, package: str) -> str:
        """The share folder of a package, which is called this now."""
        if package == self.package:
            return SHARE
        return flat(self.call("FindPackageShare", repr(package)))

    def parts(self, text: str) -> list[str]:
        """A text as literals and substitutions, which follow each other.

        Raises:
            UnsaidError: a part of it has no counterpart.
        """
        evaluated = _EVAL.fullmatch(text)
        if evaluated is not None:
            return [flat(self.evaluated(evaluated[1]))]
        parts, place = list[str](), 0
        for found in _SUBSTITUTION.finditer(text):
            literal = text[place : found.start()]
            parts += [repr(literal)] if literal else []
            parts.append(self._substitution(found[1], found[2] or ""))
            place = found.end()
        rest = text[place:]
        if "$(" in rest:
            raise UnsaidError(
                f"`{rest}` is not a substitution that roslaunch knows.", "Write it in Python."
            )
        return [*parts, *([repr(rest)] if rest else [])]

    def _substitution(self, kind: str, rest: str) -> str:
        if kind == "arg":
            return flat(self.call("LaunchConfiguration", repr(self._declared(rest))))
        if kind == "find":
            return self.share(self.find(rest))
        if kind == "env":
            return flat(self.call("EnvironmentVariable", repr(rest)))
        if kind == "optenv":
            name, _, default = rest.partition(" ")
            return flat(
                self.call("EnvironmentVariable", repr(name), default_value=repr(default.strip()))
            )
        if kind == "dirname":
            return flat(self.call("ThisLaunchFileDir"))
        if kind == "anon":
            return flat(self.call("AnonName", repr(rest)))
        raise UnsaidError(
            f"`$({kind} ...)` is not a substitution that roslaunch knows.", "Write it in Python."
        )

    def _declared(self, name: str) -> str:
        if name not in self.declared:
            raise UnsaidError(
                f"The launch file does not declare the argument `{name}`.",
                f"Declare it, or remove $(arg {name}).",
            )
        return name

    def text(self, text: str) -> Code:
        """A text as one argument of the API of launch: a literal, a substitution, or a list."""
        return joined(self.parts(text))

    def path(self, text: str) -> Code:
        """The same of a path in a package or folder, whose parts are joined."""
        parts = self.parts(self.place(text))
        folders = (SHARE, "FindPackageShare(", "ThisLaunchFileDir(")
        texts = [text_of(one) for one in parts]
        # Every other part is a literal, and a substitution stands between slashes.
        ends = all((one or "/").startswith("/") for one in texts[1:])
        starts = all((one or "/").endswith("/") for one in texts[1:-1])
        is_path = len(parts) > 1 and parts[0].startswith(folders) and ends and starts
        if not is_path or None in texts[1::2] or (texts[-1] or "").endswith("/"):
            return joined(parts)
        names: list[Code] = [parts[0]]
        for part, literal in zip(parts[1:], texts[1:], strict=True):
            words = [] if literal is None else literal.split("/")
            names += [part] if literal is None else [repr(one) for one in words if one]
        return self.call("PathJoinSubstitution", listed(names))

    def holds_words(self, word: str) -> bool:
        """Whether a word is an argument that holds several words, or none, by default."""
        name = re.fullmatch(r"\$\(arg\s+(\S+?)\s*\)", word)
        default = self.declared.get(name[1]) if name is not None else None
        return default is not None and "$(" not in default and len(default.split()) != 1

    def command(self, words: Iterable[str]) -> Tree:
        """What prints a text: quotes keep words with substitutions or blanks together."""
        pieces = list[Code]()
        for word in words:
            is_plain = re.fullmatch(r"[\w./:=+-]+", word) or self.holds_words(word)
            quote = "" if is_plain else '"'
            pieces += [repr(f" {quote}" if pieces else quote), self.path(word), repr(quote)]
        code = joined(pieces)
        # roslaunch takes what a command writes to stderr for no error; launch does by default.
        return self.call("Command", code if _is_list(code) else listed([code]), on_stderr="'warn'")

    def flag(self, text: str) -> Code:
        """Whether something is so: `True`, `False`, or a substitution."""
        lower = text.strip().lower()
        if lower in {"true", "1", "false", "0"}:
            return str(lower in {"true", "1"})
        return self.text(text)

    def condition(self, attributes: Mapping[str, str]) -> Code | None:
        """The condition of an element with `if` or `unless`; None without."""
        for attribute, name in (("if", "IfCondition"), ("unless", "UnlessCondition")):
            if attribute in attributes:
                return self.call(name, self.text(attributes[attribute].strip()))
        return None

    def typed(self, text: str, kind: str = "auto") -> Code:
        """The value of a parameter, of the type that roslaunch gives it."""
        if kind == "yaml" and "$(" not in text:
            value = parse(text)
            if value is None or isinstance(value, NotYaml):
                raise UnsaidError(f"`{text}` is not YAML.", "Write the value in Python.")
            return self.plain(value, is_substituted=False)
        if kind not in {"auto", "str", "string", "yaml", *_TYPES}:
            raise UnsaidError(
                f"`{kind}` is not a type of parameters.", "Write the value in Python."
            )
        if "$(" in text:
            parts = self.parts(text)
            is_text = kind in {"str", "string"} or (
                kind == "auto"
                and any(text_of(one) or one == SHARE or "FindPackageShare" in one for one in parts)
            )
            type_ = "str" if is_text else _TYPES.get(kind)
            code = self.path(text)
            return code if type_ is None else self.call("ParameterValue", code, value_type=type_)
        return _plain_value(text, kind)

    def plain(self, value: Value, *, is_substituted: bool) -> Code:
        """A value of YAML as parameters have it; raises UnsaidError of what they cannot have."""
        content = value.content
        if isinstance(content, dict):
            return mapped(
                (key, self.plain(one, is_substituted=is_substituted))
                for key, one in content.items()
                if one.content != {}
            )
        mistake = next(unfit(value), None)
        if mistake is not None:
            raise UnsaidError(*mistake[1:])
        if isinstance(content, list):
            are_floats = any(isinstance(one.content, float) for one in content)
            return listed(
                _number(float(one.content))
                if are_floats
                else self.plain(one, is_substituted=is_substituted)
                for one in content
            )
        if isinstance(content, float):
            return _number(content)
        if isinstance(content, str) and is_substituted:
            return self.typed(content)
        return repr(content)

    def evaluated(self, expression: str) -> Tree:
        """An expression of `$(eval)`; its arguments become what they are compared with."""
        try:
            tree = parse_anew(expression.strip(), mode="eval")
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise UnsaidError(
                f"`{expression}` is not an expression of Python.", "Write it in Python."
            ) from None
        pieces = _Evaluated(self, expression.strip()).pieces(tree.body)
        code = joined(pieces)
        return self.call("PythonExpression", code if _is_list(code) else listed([code]))


def joined(parts: Iterable[Code]) -> Code:
    """Codes whose texts follow each other: literals beside each other are one."""
    merged = list[Code]()
    for part in parts:
        inner = [one.code for one in part.items] if _is_list(part) else [part]
        for one in inner:
            before, text = text_of(merged[-1]) if merged else None, text_of(one)
            if before is not None and text is not None:
                merged[-1] = repr(before + text)
            elif text != "":
                merged.append(one)
    return listed(merged) if len(merged) > 1 else merged[0] if merged else "''"


def _is_list(code: Code) -> TypeGuard[Tree]:
    return isinstance(code, Tree) and code.head == "["


def text_of(code: Code) -> str | None:
    """The text of a literal; None of other code."""
    is_literal = isinstance(code, str) and code[:1] in {"'", '"'}
    return str(ast.literal_eval(str(code))) if is_literal else None


def paired(codes: Iterable[Code]) -> Tree:
    """A list of arguments, where an option and its value share a line."""
    items = list[Item]()
    for code in codes:
        text = text_of(code)
        is_option = text is not None and re.match(r"-[^\d.]", text) is not None
        before = text_of(items[-1].code) if items and not items[-1].key else None
        if not is_option and before is not None and re.match(r"-[^\d.]", before):
            items[-1] = Item(f"{items[-1].code}, ", code)
        else:
            items.append(Item("", code))
    return Tree("[", tuple(items), "]")


def _number(number: float) -> str:
    return repr(number) if math.isfinite(number) else f"float('{number}')"


def _plain_value(text: str, kind: str) -> str:
    """A literal value, converted as roslaunch does."""
    lower = text.strip().lower()
    try:
        if kind in {"bool", "boolean"} or (kind == "auto" and lower in {"true", "false"}):
            return str({"true": True, "1": True, "false": False, "0": False}[lower])
        if kind in {"int", "double", "float", "auto"}:
            is_float = kind in {"double", "float"} or (kind == "auto" and "." in text)
            return _number(float(text)) if is_float else repr(int(text))
    except (ValueError, KeyError):
        if kind != "auto":
            raise UnsaidError(
                f"`{text}` is not a value of the type {kind}.", "Correct the value."
            ) from None
    return repr(text)


def unfit(value: Value) -> Iterator[tuple[int, str, str]]:
    """What parameters of ROS 2 cannot have: line, message, advice."""
    content = value.content
    if isinstance(content, dict):
        for one in content.values():
            yield from unfit(one)
    elif content is None:
        yield value.line, "A parameter has no value.", "Give it one, or remove it."
    elif isinstance(content, list):
        kinds = {type(one.content) for one in content}
        if not content:
            yield (
                value.line,
                "A parameter is an empty list, whose type ROS 2 does not know.",
                ("Remove it, so that the node takes its default."),
            )
        elif (
            kinds & {dict, list, type(None)}
            or len(kinds - {int, float}) + bool(kinds & {int, float}) > 1
        ):
            yield (
                value.line,
                "A parameter is a list of lists, mappings or several types.",
                ("Write it as lists of one type, each with its own name."),
            )


def split_words(text: str) -> list[str]:
    """The words of a command line as roslaunch splits it: substitutions stay whole."""
    found = list[str]()

    def keep(substitution: re.Match[str]) -> str:
        found.append(substitution[0])
        return f"\0{len(found) - 1}\0"

    marked = _SUBSTITUTION.sub(keep, text.replace("\0", ""))
    try:
        words = shlex.split(marked)
    except ValueError:
        raise UnsaidError(
            f"`{text}` has a quotation mark that is not closed.", "Close it."
        ) from None
    return [re.sub("\0(\\d+)\0", lambda one: found[int(one[1])], word) for word in words]


class _Evaluated:
    """An expression of roslaunch, with substitutions in the place of its names.

    roslaunch gives each argument the type that its text looks like. Here it is a text where it
    is compared with one, a truth where it is negated or chosen by, and a number in sums.
    """

    def __init__(self, values: Values, expression: str) -> None:
        self.values = values
        self.data = expression.encode()
        self.starts = [0]
        for line in self.data.splitlines(keepends=True):
            self.starts.append(self.starts[-1] + len(line))
        self.changes: list[tuple[int, int, list[str]]] = []  # start, end, code

    def pieces(self, node: ast.expr) -> list[str]:
        """The parts of the expression, as Python."""
        self.visit(node, "text")
        pieces, place = list[str](), 0
        for start, end, code in sorted(self.changes):
            pieces += [self._piece(place, start), *code]
            place = end
        return [*pieces, self._piece(place, len(self.data))]

    def _piece(self, start: int, end: int) -> str:
        return repr(self.data[start:end].decode().replace("\n", " "))

    def _change(self, node: ast.expr, code: list[str]) -> None:
        start = self.starts[node.lineno - 1] + node.col_offset
        end = self.starts[(node.end_lineno or 1) - 1] + (node.end_col_offset or 0)
        self.changes.append((start, end, code))

    def visit(self, node: ast.expr, kind: str) -> None:
        """Replace the names in a part of it, which is used as text, truth or number."""
        parts: list[tuple[ast.expr, str]]
        if isinstance(node, ast.Name):
            return self._name(node, kind)
        if isinstance(node, ast.Call):
            return self._call(node, kind)
        if isinstance(node, ast.IfExp):
            parts = [(node.test, "truth"), (node.body, kind), (node.orelse, kind)]
        elif isinstance(node, ast.UnaryOp):
            parts = [(node.operand, "truth" if isinstance(node.op, ast.Not) else "number")]
        elif isinstance(node, ast.Compare):
            sides = [node.left, *node.comparators]
            parts = [(one, _compared(sides)) for one in sides]
        elif isinstance(node, _PLAIN) and not getattr(node, "attr", "").startswith("_"):
            used = "truth" if isinstance(node, ast.BoolOp) else "text"
            if isinstance(node, ast.BinOp) and not _holds_text(node):
                used = "number"
            inner = ast.iter_child_nodes(node)
            parts = [(one, used) for one in inner if isinstance(one, ast.expr)]
        else:
            raise self._unsaid()
        for one, used in parts:
            self.visit(one, used)
        return None

    def _unsaid(self) -> UnsaidError:
        return UnsaidError(
            f"`$(eval {self.data.decode()})` has more than roslaunch evaluates.",
            "Write it in Python.",
        )

    def _call(self, node: ast.Call, kind: str) -> None:
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        texts = [
            one.value
            for one in node.args
            if isinstance(one, ast.Constant) and isinstance(one.value, str)
        ]
        if name == "arg" and len(texts) == 1:
            self._argument(node, texts[0], kind)
        elif name in {"find", "env", "optenv", "anon", "dirname"}:
            if len(texts) != len(node.args):
                raise self._unsaid()
            code = self.values._substitution(name, " ".join(texts))  # noqa: SLF001  the same module
            self._change(node, [repr(_QUOTED), code, repr(_QUOTED)])
        else:
            self.visit(node.func, "function")
            for one in node.args:
                self.visit(one, "number" if name in _OF_MATH else "text")

    def _name(self, node: ast.Name, kind: str) -> None:
        if kind == "function" or node.id in {"pi", "e", "tau", "inf"}:
            if node.id not in _OF_MATH | _BUILTINS:
                raise self._unsaid()
        elif node.id in {"true", "false"}:
            self._change(node, [repr(node.id.capitalize())])
        elif node.id not in _BUILTINS:
            self._argument(node, node.id, kind)

    def _argument(self, node: ast.expr, name: str, kind: str) -> None:
        code = self.values._substitution("arg", name)  # noqa: SLF001  the same module
        if kind == "number" and not _is_text(self.values.declared.get(name)):
            self._change(node, [code])
        elif kind == "truth":
            ends = "'.lower() in ('true', '1'))"
            self._change(node, [repr(f"({_QUOTED}"), code, repr(ends)])
        else:
            self._change(node, [repr(_QUOTED), code, repr(_QUOTED)])


def _holds_text(node: ast.expr) -> bool:
    """Whether a part of an expression surely is text, or a list of texts."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, str)
    if isinstance(node, ast.Call):
        name = node.func.id if isinstance(node.func, ast.Name) else ""
        return name in {"str", "find", "env", "optenv", "anon", "dirname"}
    inner = [one for one in ast.iter_child_nodes(node) if isinstance(one, ast.expr)]
    return any(_holds_text(one) for one in inner)


def _compared(sides: list[ast.expr]) -> str:
    """What the sides of a comparison are."""
    constants = [one.value for one in sides if isinstance(one, ast.Constant)]
    names = [one.id for one in sides if isinstance(one, ast.Name)]
    if any(isinstance(one, bool) for one in constants) or {"true", "false"} & {*names}:
        return "truth"
    is_number = any(isinstance(one, (int, float)) for one in constants)
    return "number" if is_number and not any(_holds_text(one) for one in sides) else "text"


def _is_text(default: str | None) -> bool:
    """Whether the default of an argument is neither a number nor computed."""
    try:
        float(default or "0")
    except ValueError:
        return "$(" not in (default or "")
    return False
