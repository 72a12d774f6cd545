"""Evaluate setup.py without running it: texts, lists and files, as far as they can be known."""

from __future__ import annotations

import ast
import fnmatch
import glob
import os
from contextlib import suppress
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence


MOST_STEPS = 50_000  # nodes; more than that is an endless loop
DEEPEST = 30  # functions inside each other


class Unknown:
    """Stands for a value that is not known."""

    def __repr__(self) -> str:
        return "UNKNOWN"


UNKNOWN = Unknown()


class Text(str):
    """A text that is written at a line."""

    __slots__ = ("line",)
    line: int


class Row(tuple[Any, ...]):  # noqa: SLOT001  a tuple has no slots of its own
    """A tuple that is written at a line."""

    line: int


class Reference(NamedTuple):
    """A module, or a name in one."""

    name: str  # dotted: os.path.join


class Function(NamedTuple):
    """A function of the file, and the variables around it."""

    node: ast.FunctionDef | ast.Lambda
    around: dict[str, Any]


class Glob(NamedTuple):
    """A call that looks for files by a pattern."""

    pattern: str
    line: int
    found: int  # number of files and folders


class _ReturnError(Exception):
    def __init__(self, value: Any) -> None:
        super().__init__()
        self.value = value


class _LoopError(Exception):
    def __init__(self, *, is_break: bool) -> None:
        super().__init__()
        self.is_break = is_break


class StepsError(Exception):
    """The file takes too many steps."""


def line_of(value: Any, otherwise: int) -> int:
    """The line that a value is written at, or another one."""
    return getattr(value, "line", otherwise)


class Evaluator:
    """Evaluates one file; `calls` has the keyword arguments of setup()."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.folder = file.parent
        self.globs: list[Glob] = []
        self.calls: list[tuple[int, dict[str, Any], dict[str, int], bool]] = []
        self._steps = 0
        self._depth = 0
        self._globals: dict[str, Any] = {
            "__file__": file.name,  # colcon executes it in its folder, by this name
            "__name__": "__main__",
            **{name: Reference(name) for name in BUILTINS},
        }

    def run(self, tree: ast.Module) -> None:
        """Evaluate a module.

        Raises:
            StepsError: It does not come to an end.
            RecursionError: An expression is nested too deeply.
        """
        self._run(tree.body, self._globals)

    # Statements.

    def _run(self, body: Sequence[ast.stmt], names: dict[str, Any]) -> None:
        for one in body:
            self._count()
            method = self._method_for(one)
            if method is not None:
                method(one, names)

    def _method_for(self, node: ast.AST) -> Callable[[Any, dict[str, Any]], Any] | None:
        """The method that evaluates a node, which is called like its class; None: none does."""
        return getattr(self, f"_{type(node).__name__.lower()}", None)

    def _count(self) -> None:
        self._steps += 1
        if self._steps > MOST_STEPS:
            raise StepsError

    def _assign(self, node: ast.Assign, names: dict[str, Any]) -> None:
        value = self.evaluate(node.value, names)
        for target in node.targets:
            self._bind(target, value, names)

    def _annassign(self, node: ast.AnnAssign, names: dict[str, Any]) -> None:
        if node.value is not None:
            self._bind(node.target, self.evaluate(node.value, names), names)

    def _augassign(self, node: ast.AugAssign, names: dict[str, Any]) -> None:
        load = ast.copy_location(_as_load(node.target), node.target)
        before, more = self.evaluate(load, names), self.evaluate(node.value, names)
        if isinstance(node.op, ast.Add) and isinstance(before, list):
            before.extend(more if isinstance(more, (list, tuple)) else [UNKNOWN])
        else:
            self._bind(node.target, _operate(node.op, before, more), names)

    def _bind(self, target: ast.expr, value: Any, names: dict[str, Any]) -> None:
        if isinstance(target, ast.Name):
            names[target.id] = value
        elif isinstance(target, (ast.Tuple, ast.List)):
            parts = list(value) if isinstance(value, (list, tuple)) else []
            if len(parts) != len(target.elts):
                parts = [UNKNOWN] * len(target.elts)
            for one, part in zip(target.elts, parts, strict=True):
                self._bind(one.value if isinstance(one, ast.Starred) else one, part, names)
        elif isinstance(target, ast.Subscript):
            holder = self.evaluate(target.value, names)
            key = self.evaluate(target.slice, names)
            if isinstance(holder, dict) and isinstance(key, (str, int)):
                holder[key] = value

    def _for(self, node: ast.For, names: dict[str, Any]) -> None:
        values = items_of(self.evaluate(node.iter, names))
        if values is None:
            self._bind(node.target, UNKNOWN, names)
            values = [UNKNOWN]
        for value in values:
            self._bind(node.target, value, names)
            try:
                self._run(node.body, names)
            except _LoopError as loop:
                if loop.is_break:
                    return
        self._run(node.orelse, names)

    def _if(self, node: ast.If, names: dict[str, Any]) -> None:
        test = self.truth(self.evaluate(node.test, names))
        if test is None:
            for body in (node.body, node.orelse):
                with suppress(_LoopError):
                    self._run(body, names)
        else:
            self._run(node.body if test else node.orelse, names)

    def _while(self, node: ast.While, names: dict[str, Any]) -> None:
        with suppress(_LoopError):
            self._run(node.body, names)

    def _try(self, node: ast.Try, names: dict[str, Any]) -> None:
        self._run([*node.body, *node.orelse, *node.finalbody], names)

    def _with(self, node: ast.With, names: dict[str, Any]) -> None:
        for item in node.items:
            if item.optional_vars is not None:
                self._bind(item.optional_vars, UNKNOWN, names)
        self._run(node.body, names)

    def _import(self, node: ast.Import, names: dict[str, Any]) -> None:
        for one in node.names:
            top = one.name.partition(".")[0]
            names[one.asname or top] = Reference(one.name if one.asname else top)

    def _importfrom(self, node: ast.ImportFrom, names: dict[str, Any]) -> None:
        for one in node.names:
            names[one.asname or one.name] = Reference(f"{node.module}.{one.name}")
            if one.name == "*":
                for known in FUNCTIONS:
                    module, _, name = known.rpartition(".")
                    if module == node.module:
                        names[name] = Reference(known)

    def _functiondef(self, node: ast.FunctionDef, names: dict[str, Any]) -> None:
        names[node.name] = Function(node, names)

    def _classdef(self, node: ast.ClassDef, names: dict[str, Any]) -> None:
        names[node.name] = UNKNOWN

    def _return(self, node: ast.Return, names: dict[str, Any]) -> None:
        raise _ReturnError(self.evaluate(node.value, names) if node.value else None)

    def _expr(self, node: ast.Expr, names: dict[str, Any]) -> None:
        self.evaluate(node.value, names)

    def _break(self, node: ast.Break | ast.Continue, names: dict[str, Any]) -> None:
        raise _LoopError(is_break=isinstance(node, ast.Break))

    # Expressions.

    _continue = _break

    def evaluate(self, node: ast.expr, names: dict[str, Any]) -> Any:
        """The value of an expression."""
        self._count()
        method = self._method_for(node)
        return UNKNOWN if method is None else method(node, names)

    @staticmethod
    def truth(value: Any) -> bool | None:
        """The truth of a value; None if it is not known."""
        if isinstance(value, (Unknown, Reference)):
            return None
        return bool(value)

    def _constant(self, node: ast.Constant, names: dict[str, Any]) -> Any:
        if not isinstance(node.value, str):
            return node.value
        text = Text(node.value)
        text.line = node.lineno
        return text

    def _name(self, node: ast.Name, names: dict[str, Any]) -> Any:
        if node.id in names:
            return names[node.id]
        return self._globals.get(node.id, UNKNOWN)

    def _attribute(self, node: ast.Attribute, names: dict[str, Any]) -> Any:
        value = self.evaluate(node.value, names)
        if isinstance(value, Reference):
            name = f"{value.name}.{node.attr}"
            return {"os.sep": "/", "os.path.sep": "/", "os.curdir": "."}.get(name, Reference(name))
        if isinstance(value, PurePath) and node.attr in PATH_PARTS:
            return getattr(value, node.attr)
        return UNKNOWN

    def _list(self, node: ast.List | ast.Tuple | ast.Set, names: dict[str, Any]) -> Any:
        values: list[Any] = []
        for one in node.elts:
            if isinstance(one, ast.Starred):
                more = items_of(self.evaluate(one.value, names))
                values += [UNKNOWN] if more is None else more
            else:
                values.append(self.evaluate(one, names))
        if isinstance(node, ast.List):
            return values
        row = Row(values)
        row.line = node.lineno
        return row

    _tuple = _set = _list

    def _dict(self, node: ast.Dict, names: dict[str, Any]) -> Any:
        found: dict[Any, Any] = {}
        for key, value in zip(node.keys, node.values, strict=True):
            content = self.evaluate(value, names)
            if key is None:
                if isinstance(content, dict):
                    found.update(content)
                continue
            name = self.evaluate(key, names)
            if isinstance(name, (str, int)):
                found[name] = content
        return found

    def _joinedstr(self, node: ast.JoinedStr, names: dict[str, Any]) -> Any:
        parts: list[str] = []
        for one in node.values:
            inner = one.value if isinstance(one, ast.FormattedValue) else one
            value = self.evaluate(inner, names)
            if not isinstance(value, (str, int, PurePath)):
                return UNKNOWN
            parts.append(str(value))
        text = Text("".join(parts))
        text.line = node.lineno
        return text

    def _binop(self, node: ast.BinOp, names: dict[str, Any]) -> Any:
        left, right = self.evaluate(node.left, names), self.evaluate(node.right, names)
        value = _operate(node.op, left, right)
        if type(value) is str:
            value = Text(value)
            value.line = line_of(left, node.lineno)
        return value

    def _boolop(self, node: ast.BoolOp, names: dict[str, Any]) -> Any:
        value: Any = UNKNOWN
        for one in node.values:
            value = self.evaluate(one, names)
            test = self.truth(value)
            if test is None or test is isinstance(node.op, ast.Or):
                return value
        return value

    def _unaryop(self, node: ast.UnaryOp, names: dict[str, Any]) -> Any:
        value = self.evaluate(node.operand, names)
        if isinstance(node.op, ast.Not):
            test = self.truth(value)
            return UNKNOWN if test is None else not test
        return -value if isinstance(node.op, ast.USub) and isinstance(value, int) else UNKNOWN

    def _compare(self, node: ast.Compare, names: dict[str, Any]) -> Any:
        left, right = self.evaluate(node.left, names), self.evaluate(node.comparators[0], names)
        compare = _COMPARISONS.get(type(node.ops[0]))
        if len(node.ops) > 1 or compare is None or _has_unknown(left) or _has_unknown(right):
            return UNKNOWN
        try:
            return compare(left, right)
        except TypeError:
            return UNKNOWN

    def _ifexp(self, node: ast.IfExp, names: dict[str, Any]) -> Any:
        test = self.truth(self.evaluate(node.test, names))
        if test is None:
            return UNKNOWN
        return self.evaluate(node.body if test else node.orelse, names)

    def _subscript(self, node: ast.Subscript, names: dict[str, Any]) -> Any:
        value = self.evaluate(node.value, names)
        if isinstance(value, (Unknown, Reference, Function)):
            return UNKNOWN
        try:
            if isinstance(node.slice, ast.Slice):
                bounds = (node.slice.lower, node.slice.upper, node.slice.step)
                key: Any = slice(*(one and self.evaluate(one, names) for one in bounds))
            else:
                key = self.evaluate(node.slice, names)
            return value[key]
        except (TypeError, KeyError, IndexError, ValueError):
            return UNKNOWN

    def _listcomp(
        self, node: ast.ListComp | ast.SetComp | ast.GeneratorExp, names: dict[str, Any]
    ) -> Any:
        found: list[Any] = []
        for inner in self._rows(node.generators, {**names}):
            found.append(self.evaluate(node.elt, inner))  # noqa: PERF401  it may change
        return found

    _setcomp = _generatorexp = _listcomp

    def _dictcomp(self, node: ast.DictComp, names: dict[str, Any]) -> Any:
        found: dict[Any, Any] = {}
        for inner in self._rows(node.generators, {**names}):
            key = self.evaluate(node.key, inner)
            if isinstance(key, (str, int)):
                found[key] = self.evaluate(node.value, inner)
        return found

    def _rows(
        self, generators: Sequence[ast.comprehension], names: dict[str, Any]
    ) -> Iterator[dict[str, Any]]:
        if not generators:
            yield names
            return
        values = items_of(self.evaluate(generators[0].iter, names))
        for value in [UNKNOWN] if values is None else list(values):
            inner = {**names}
            self._bind(generators[0].target, value, inner)
            tests = [self.truth(self.evaluate(one, inner)) for one in generators[0].ifs]
            if False not in tests:
                yield from self._rows(generators[1:], inner)

    def _lambda(self, node: ast.Lambda, names: dict[str, Any]) -> Any:
        return Function(node, names)

    def _call(  # noqa: PLR0911  one for each kind of function
        self, node: ast.Call, names: dict[str, Any]
    ) -> Any:
        if isinstance(node.func, ast.Attribute):
            holder = self.evaluate(node.func.value, names)
            if not isinstance(holder, Reference):
                arguments = self._arguments(node, names)[0]
                try:
                    return self._method(holder, node.func.attr, arguments, node)
                except ValueError:
                    return UNKNOWN
            function: Any = Reference(f"{holder.name}.{node.func.attr}")
        else:
            function = self.evaluate(node.func, names)
        if isinstance(function, Reference) and function.name in SETUPS:
            self._setup(node, names)
            return None
        arguments, keywords = self._arguments(node, names)
        if isinstance(function, Function):
            return self.call(function, arguments, keywords)
        implementation = FUNCTIONS.get(function.name) if isinstance(function, Reference) else None
        if implementation is None:
            return UNKNOWN
        try:
            return implementation(self, node, arguments, keywords)
        except (TypeError, ValueError, IndexError, OSError, AttributeError):
            return UNKNOWN

    def _arguments(self, node: ast.Call, names: dict[str, Any]) -> tuple[list[Any], dict[str, Any]]:
        arguments: list[Any] = []
        for one in node.args:
            if isinstance(one, ast.Starred):
                more = items_of(self.evaluate(one.value, names))
                arguments += [UNKNOWN] if more is None else list(more)
            else:
                arguments.append(self.evaluate(one, names))
        keywords = {
            one.arg: self.evaluate(one.value, names) for one in node.keywords if one.arg is not None
        }
        return arguments, keywords

    def _setup(self, node: ast.Call, names: dict[str, Any]) -> None:
        found: dict[str, Any] = {}
        lines: dict[str, int] = {}
        is_whole = True
        for one in node.keywords:
            value = self.evaluate(one.value, names)
            if one.arg is not None:
                found[one.arg] = value
                lines[one.arg] = one.value.lineno if one.arg is None else one.lineno
            elif isinstance(value, dict):
                found.update(value)
            else:
                is_whole = False
        self.calls.append((node.lineno, found, lines, is_whole))

    def call(self, function: Function, arguments: list[Any], keywords: Mapping[str, Any]) -> Any:
        """Call a function of the file."""
        node = function.node
        if self._depth >= DEEPEST:
            raise StepsError
        parameters = [one.arg for one in (*node.args.posonlyargs, *node.args.args)]
        defaults = [self.evaluate(one, function.around) for one in node.args.defaults]
        names: dict[str, Any] = dict.fromkeys(parameters, UNKNOWN)
        names.update(
            zip(parameters[len(parameters) - len(defaults) :], defaults, strict=True)
            if defaults
            else ()
        )
        names.update(zip(parameters, arguments, strict=False))
        names.update(keywords)
        if node.args.vararg is not None:
            names[node.args.vararg.arg] = tuple(arguments[len(parameters) :])
        inner = names if function.around is self._globals else {**function.around, **names}
        self._depth += 1
        try:
            if isinstance(node, ast.Lambda):
                return self.evaluate(node.body, inner)
            self._run(node.body, inner)
        except _ReturnError as returned:
            return returned.value
        finally:
            self._depth -= 1
        return None

    def _method(self, holder: Any, name: str, arguments: list[Any], node: ast.Call) -> Any:
        if isinstance(holder, PurePath):
            # pathlib does not accept subclasses of str.
            words = [str(one) if isinstance(one, str) else one for one in arguments]
            return self._path_method(holder, name, words, node)
        if isinstance(holder, list) and name == "extend":
            more = items_of(arguments[0]) if arguments else None
            holder.extend([UNKNOWN] if more is None else more)
            return None
        known = next((METHODS[kind] for kind in METHODS if isinstance(holder, kind)), frozenset())
        if name not in known:
            return UNKNOWN
        is_text = isinstance(holder, str)
        if is_text and any(_has_unknown(one) for one in arguments):
            return UNKNOWN
        try:
            value = getattr(holder, name)(*arguments)
        except (TypeError, ValueError, KeyError, IndexError, AttributeError):
            return UNKNOWN
        return list(value) if name in {"items", "keys", "values"} else value

    def _path_method(  # noqa: PLR0911  one for each kind of method
        self, path: PurePath, name: str, arguments: list[Any], node: ast.Call
    ) -> Any:
        place = Path(self.folder, path)
        if name in {"glob", "rglob"} and arguments and isinstance(arguments[0], str):
            self.check_inside(str(path))
            found = [*getattr(place, name)(arguments[0])]
            self.globs.append(Glob(f"{path}/{arguments[0]}", node.lineno, len(found)))
            return [self._like(path, one) for one in sorted(found)]
        if name == "iterdir" and place.is_dir():
            return [self._like(path, one) for one in sorted(place.iterdir())]
        if name in {"exists", "is_dir", "is_file"}:
            return getattr(place, name)()
        if name in {"resolve", "absolute"}:
            return place
        if name in {"joinpath", "as_posix", "relative_to", "with_suffix", "with_name"}:
            try:
                return getattr(path, name)(*arguments)
            except (TypeError, ValueError):
                return UNKNOWN
        return UNKNOWN

    def check_inside(self, path: str) -> None:
        """Stop where files are looked for outside of the package, which may be many.

        Raises:
            ValueError: The path is not in the folder of the file.
        """
        place = os.path.normpath(os.path.join(self.folder, path))
        if not f"{place}/".startswith(f"{self.folder}/"):
            raise ValueError(path)

    def _like(self, path: PurePath, found: Path) -> Path:
        """A path that was found, relative if the path that it was looked for at is."""
        return found if path.is_absolute() else found.relative_to(self.folder)


def items_of(value: Any) -> list[Any] | None:
    """What a loop over a value takes; None if that is not known."""
    if isinstance(value, (list, tuple, set, frozenset, dict, range)):
        return list(value)
    return list(value) if isinstance(value, str) else None


def _has_unknown(value: Any) -> bool:
    if isinstance(value, (list, tuple)):
        return any(_has_unknown(one) for one in value)
    return isinstance(value, (Unknown, Reference, Function))


def _as_load(target: ast.expr) -> ast.expr:
    if isinstance(target, ast.Name):
        return ast.Name(id=target.id, ctx=ast.Load())
    return target


def _operate(  # noqa: PLR0911  one for each operator
    operator: ast.operator, left: Any, right: Any
) -> Any:
    if isinstance(operator, ast.Add) and isinstance(left, (list, tuple)):
        right = list(right) if isinstance(right, (list, tuple)) else [UNKNOWN]
        return [*left, *right]
    if isinstance(operator, ast.Add) and isinstance(right, list):
        return [UNKNOWN, *right]
    if _has_unknown(left) or _has_unknown(right):
        return UNKNOWN
    try:
        if isinstance(operator, ast.Add):
            return left + right
        if isinstance(operator, ast.Div):
            return left / (str(right) if isinstance(right, str) else right)
        if isinstance(operator, ast.Mod):
            return left % (tuple(right) if isinstance(right, tuple) else right)
    except (TypeError, ValueError, ZeroDivisionError):
        return UNKNOWN
    return UNKNOWN


_COMPARISONS: dict[type, Callable[[Any, Any], bool]] = {
    ast.Eq: lambda one, other: one == other,
    ast.NotEq: lambda one, other: one != other,
    ast.In: lambda one, other: one in other,
    ast.NotIn: lambda one, other: one not in other,
    ast.Is: lambda one, other: one is other,
    ast.IsNot: lambda one, other: one is not other,
    ast.Gt: lambda one, other: one > other,
    ast.GtE: lambda one, other: one >= other,
    ast.Lt: lambda one, other: one < other,
    ast.LtE: lambda one, other: one <= other,
}
PATH_PARTS = frozenset({"name", "parent", "parts", "stem", "suffix"})
METHODS: dict[type, frozenset[str]] = {
    str: frozenset(
        {
            *("capitalize", "count", "endswith", "find", "format", "isidentifier", "join", "lower"),
            *("lstrip", "partition", "removeprefix", "removesuffix", "replace", "rpartition"),
            *("rsplit", "rstrip", "split", "splitlines", "startswith", "strip", "title", "upper"),
        }
    ),
    list: frozenset({"append", "copy", "count", "index", "insert", "pop", "remove", "reverse"}),
    dict: frozenset({"copy", "get", "items", "keys", "pop", "setdefault", "update", "values"}),
    set: frozenset({"add", "discard", "union", "update"}),
}
SETUPS = frozenset({"setuptools.setup", "distutils.core.setup", "setup"})


# Functions: each gets the evaluator, the call, the positional and the keyword arguments.


def _strict(*values: Any) -> None:
    if any(_has_unknown(value) for value in values):
        raise ValueError(values)


def _glob(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
    pattern = words[0]
    if not isinstance(pattern, (str, PurePath)) or "root_dir" in options:
        return UNKNOWN
    self.check_inside(str(pattern).partition("*")[0])
    is_recursive = options.get("recursive", len(words) > 1 and words[1])
    found = glob.glob(str(pattern), root_dir=self.folder, recursive=bool(is_recursive))
    self.globs.append(Glob(str(pattern), node.lineno, len(found)))
    return sorted(found)


def _join(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
    _strict(*words)
    text = Text(os.path.join(*map(str, words)))
    text.line = line_of(words[0], node.lineno)
    return text


def _on_text(function: Callable[[str], Any]) -> Callable[..., Any]:
    def call(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
        _strict(*words)
        return function(*map(str, words))

    return call


def _on_disk(function: Callable[[str], Any]) -> Callable[..., Any]:
    def call(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
        _strict(*words)
        return function(os.path.join(self.folder, str(words[0]) if words else "."))

    return call


def _on_values(function: Callable[..., Any]) -> Callable[..., Any]:
    def call(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
        if any(isinstance(word, (Unknown, Reference)) for word in words):
            return UNKNOWN
        value = function(*words)
        return value if isinstance(value, (str, int, list, tuple, set, dict)) else list(value)

    return call


def _walk(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
    _strict(words[0])
    top = str(words[0])
    self.check_inside(top)
    found: list[Any] = []
    for folder, folders, files in os.walk(os.path.join(self.folder, top)):
        folders.sort()
        below = os.path.relpath(folder, os.path.join(self.folder, top))
        place = top if below == "." else os.path.join(top, below)
        found.append((place, list(folders), sorted(files)))
    return found


def _abspath(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
    _strict(*words)
    return os.path.normpath(os.path.join(self.folder, str(words[0])))


def _path(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
    _strict(*words)
    return Path(*map(str, words))


def _map(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
    values = items_of(words[1])
    if values is None:
        return UNKNOWN
    if isinstance(words[0], Function):
        return [self.call(words[0], [value], {}) for value in values]
    implementation = FUNCTIONS.get(words[0].name) if isinstance(words[0], Reference) else None
    if implementation is None:
        return [UNKNOWN]
    return [implementation(self, node, [value], {}) for value in values]


def _sorted(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
    values = items_of(words[0])
    return UNKNOWN if values is None else sorted(values, key=str)


def find_packages(
    folder: str, include: Iterable[str] = ("*",), exclude: Iterable[str] = (), *, marker: bool
) -> list[str]:
    """The Python packages in a folder, as setuptools finds them."""
    found: list[str] = []
    include, exclude = [*include], [*exclude]
    for place, folders, _ in os.walk(folder):
        kept: list[str] = []
        for name in sorted(folders):
            path = os.path.join(place, name)
            package = os.path.relpath(path, folder).replace(os.sep, ".")
            if "." in name or (marker and not os.path.isfile(os.path.join(path, "__init__.py"))):
                continue
            if any(fnmatch.fnmatchcase(package, one) for one in include) and not any(
                fnmatch.fnmatchcase(package, one) for one in exclude
            ):
                found.append(package)
            kept.append(name)
        folders[:] = kept
    return found


def _find_packages(*, marker: bool) -> Callable[..., Any]:
    def call(self: Evaluator, node: ast.Call, words: list[Any], options: dict[str, Any]) -> Any:
        values = dict(zip(("where", "exclude", "include"), words, strict=False)) | options
        _strict(*values.values())
        folder = os.path.join(self.folder, str(values.get("where", ".")))
        return find_packages(
            os.path.normpath(folder),
            values.get("include", ("*",)),
            values.get("exclude", ()),
            marker=marker,
        )

    return call


FUNCTIONS: dict[str, Callable[..., Any]] = {
    "glob.glob": _glob,
    "glob.iglob": _glob,
    "os.path.join": _join,
    "os.path.abspath": _abspath,
    "os.path.realpath": _abspath,
    "os.path.basename": _on_text(os.path.basename),
    "os.path.dirname": _on_text(os.path.dirname),
    "os.path.normpath": _on_text(os.path.normpath),
    "os.path.split": _on_text(os.path.split),
    "os.path.splitext": _on_text(os.path.splitext),
    "os.path.exists": _on_disk(os.path.exists),
    "os.path.isdir": _on_disk(os.path.isdir),
    "os.path.isfile": _on_disk(os.path.isfile),
    "os.path.relpath": _on_text(os.path.relpath),
    "os.listdir": _on_disk(lambda path: sorted(os.listdir(path))),
    "os.getcwd": lambda self, node, words, options: str(self.folder),
    "os.walk": _walk,
    "pathlib.Path": _path,
    "pathlib.PurePath": _path,
    "setuptools.find_packages": _find_packages(marker=True),
    "setuptools.find_namespace_packages": _find_packages(marker=False),
    "list": _on_values(list),
    "tuple": _on_values(tuple),
    "set": _on_values(lambda *values: list(dict.fromkeys(*values))),
    "dict": lambda self, node, words, options: {**(words[0] if words else {}), **options},
    "str": _on_text(str),
    "len": _on_values(len),
    "range": _on_values(lambda *numbers: list(range(*numbers)[:MOST_STEPS])),
    "enumerate": _on_values(enumerate),
    "zip": _on_values(zip),
    "sorted": _sorted,
    "reversed": _on_values(lambda values: list(values)[::-1]),
    "map": _map,
    "itertools.chain": _on_values(lambda *values: [one for value in values for one in value]),
    "print": lambda self, node, words, options: None,
}
BUILTINS = tuple(name for name in FUNCTIONS if "." not in name)
