"""Which launch files can only describe, by what is written in them.

A plain launch file imports nothing but `launch`, `launch_ros`, `ament_index_python`, `typing` and
`os`, and of `os` it uses what reads. It stores nothing but variables of its own. So it leaves
nothing behind that the next one evaluated in the same process would meet; any other one gets a
process of its own. This is about accident, not about malice: both run in a child process.
"""

from __future__ import annotations

import ast
import builtins
from functools import cache
from typing import TYPE_CHECKING, Any

from wsgen.text.pythontree import parse, parse_anew

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping


MOST_BYTES = 200_000  # of a launch file; a longer one is made by a program
_PACKAGES = frozenset(("launch", "launch_ros", "ament_index_python", "typing"))
_PATH_FUNCTIONS = frozenset(
    (
        *("abspath", "basename", "dirname", "exists", "expanduser", "expandvars", "isdir"),
        *("isfile", "join", "normpath", "realpath", "splitext"),
    )
)
_BUILTINS = frozenset(
    (
        *("bool", "dict", "enumerate", "float", "int", "isinstance", "len", "list", "max", "min"),
        *("range", "reversed", "round", "set", "sorted", "str", "sum", "tuple", "zip"),
        *("any", "all", "abs", "Exception", "KeyError", "RuntimeError", "ValueError", "__file__"),
        "__name__",
    )
)
# What has state of its own, or would be another way to modules.
_NAMES_TO_MORE = frozenset(
    (
        *("builtins", "expose", "frontend", "importlib", "logging", "os", "subprocess", "sys"),
        *("expose_action", "expose_substitution", "get_logger", "launch_config"),
    )
)
_EXPRESSIONS = frozenset(
    (
        *(ast.Expression, ast.Constant, ast.Name, ast.Load, ast.List, ast.Tuple, ast.Dict, ast.Set),
        *(ast.JoinedStr, ast.FormattedValue, ast.IfExp, ast.BoolOp, ast.And, ast.Or),
        *(ast.UnaryOp, ast.Not, ast.USub, ast.UAdd, ast.BinOp, ast.Add, ast.Sub, ast.Mult),
        *(ast.Div, ast.Mod, ast.Compare, ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE),
        *(ast.Is, ast.IsNot, ast.In, ast.NotIn),
    )
)
_NODES = _EXPRESSIONS | {
    *(ast.Module, ast.FunctionDef, ast.arguments, ast.arg, ast.Return, ast.Assign, ast.AnnAssign),
    *(ast.AugAssign, ast.Expr, ast.If, ast.For, ast.Pass, ast.Break, ast.Continue, ast.Raise),
    *(ast.Import, ast.ImportFrom, ast.alias, ast.Store, ast.Call, ast.keyword, ast.Attribute),
    *(ast.Subscript, ast.Slice, ast.Starred, ast.Lambda, ast.ListComp, ast.DictComp, ast.SetComp),
    *(ast.GeneratorExp, ast.comprehension),
}


def is_plain(source: bytes) -> bool:
    """Whether a launch file in Python is plain; False also where it is no Python."""
    if len(source) > MOST_BYTES:
        return False
    try:
        tree = parse(source)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return False
    nodes = _walk(tree)
    return nodes is not None and _uses_plain_names(nodes)


# Fields that hold no node, or one that says what the node that has it is asked for.
_WITHOUT_NODES = frozenset(("arg", "attr", "conversion", "ctx", "id", "kind", "level", "module"))


@cache
def _fields_of(kind: Any) -> tuple[str, ...]:
    """The fields of a kind of node that may hold nodes."""
    if kind is ast.Constant:
        return ()
    return tuple(name for name in kind._fields if name not in _WITHOUT_NODES)


def _walk(tree: ast.AST) -> list[ast.AST] | None:
    """All nodes but contexts such as `ast.Load`; None as soon as one is not plain."""
    nodes = [tree]
    for node in nodes:  # which grows
        kind: Any = type(node)
        check = _CHECKS.get(kind)
        if kind not in _NODES or (check is not None and not check(node)):
            return None
        for name in _fields_of(kind):
            value = getattr(node, name, None)
            if isinstance(value, list):
                nodes += [one for one in value if isinstance(one, ast.AST)]
            elif isinstance(value, ast.AST):
                nodes.append(value)
    return nodes


def is_plain_expression(text: str) -> bool:
    """Whether an expression of Python calls nothing, and looks nothing up in an object."""
    try:
        tree = parse_anew(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return False
    return all(type(node) in _EXPRESSIONS for node in ast.walk(tree))


def _is_plain_attribute(node: ast.Attribute) -> bool:
    is_read = isinstance(node.ctx, ast.Load)
    return is_read and not node.attr.startswith("_") and node.attr not in _NAMES_TO_MORE


def _is_plain_import(node: ast.Import | ast.ImportFrom) -> bool:
    names = {one.name for one in node.names}
    if isinstance(node, ast.Import):
        return all(name == "os" or _is_of_package(name) for name in names)
    if node.module == "os.path":
        return names <= _PATH_FUNCTIONS
    return not node.level and _is_of_package(node.module or "") and _is_of_launch(names)


def _is_of_package(module: str) -> bool:
    parts = module.split(".")
    return parts[0] in _PACKAGES and _is_of_launch(parts)


def _is_of_launch(names: Iterable[str]) -> bool:
    return _NAMES_TO_MORE.isdisjoint(names) and not any(name[0] in "_*" for name in names)


_CHECKS: Mapping[type[ast.AST], Callable[[Any], bool]] = {
    ast.Attribute: _is_plain_attribute,
    ast.FunctionDef: lambda node: not node.decorator_list,
    ast.Import: _is_plain_import,
    ast.ImportFrom: _is_plain_import,
    ast.Subscript: lambda node: isinstance(node.ctx, ast.Load),
}


def _uses_plain_names(nodes: list[ast.AST]) -> bool:
    """Whether all names are those of the file, or known to only read."""
    own: set[str] = set()
    systems: set[str] = set()  # the module `os`
    used: list[str] = []
    for node in nodes:
        if isinstance(node, ast.Name):
            (used.append if isinstance(node.ctx, ast.Load) else own.add)(node.id)
        elif isinstance(node, ast.FunctionDef):
            own.add(node.name)
        elif isinstance(node, ast.arg):
            own.add(node.arg)
        elif isinstance(node, ast.Import):
            for one in node.names:
                name = one.asname or one.name.partition(".")[0]
                (systems if one.name == "os" else own).add(name)
        elif isinstance(node, ast.ImportFrom):
            own.update(one.asname or one.name for one in node.names)
    # A builtin that is also a variable somewhere may be either one.
    if not (own | systems).isdisjoint(vars(builtins)) or not own.isdisjoint(systems):
        return False
    reads = sum(_is_read_of(node, systems) for node in nodes) if systems else 0
    return (
        all(name in own or name in systems or name in _BUILTINS for name in used)
        and sum(name in systems for name in used) == reads
    )


def _is_read_of(node: ast.AST, systems: set[str]) -> bool:
    """Whether a node is a whole use of `os` that only reads."""
    words: list[str] = []
    function = node.func if isinstance(node, ast.Call) else None
    if isinstance(node, ast.Subscript):  # os.environ["NAME"]
        function = node.value
        words.append("[]")
    while isinstance(function, ast.Attribute):
        words.append(function.attr)
        function = function.value
    if not isinstance(function, ast.Name) or function.id not in systems:
        return False
    match words[::-1]:
        case ["path", name]:
            return name in _PATH_FUNCTIONS
        case ["getenv"] | ["getcwd"] | ["environ", "get"] | ["environ", "[]"]:
            return True
    return False


EVALUATE, EXPAND = "evaluate", "expand"  # the commands
