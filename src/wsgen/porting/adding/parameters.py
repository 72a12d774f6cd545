"""A parameter of a node: declared in its source, and set where a YAML file sets others."""

from __future__ import annotations

import ast
import re
from typing import TYPE_CHECKING

from wsgen.checks.fixes.launch_files import tree_of
from wsgen.errors import NotFoundError, RequestError
from wsgen.packages.workspace.layout import BUILD_MARKERS, LAUNCH_FILES
from wsgen.porting.adding.places import Item, insert_among, insert_below
from wsgen.porting.adding.types import Parameter, read_parameters
from wsgen.porting.python_edits import PythonEdits, argument
from wsgen.text.files import list_files
from wsgen.text.suggestions import ask_for_nearest

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from wsgen.checks.fixes.source import Edit, SourceText
    from wsgen.porting.adding.addition import Addition

_CPP = (".cpp", ".cc", ".cxx", ".hpp", ".h")
_OF_CPP = re.compile(r"[:,]\s*(?:rclcpp(?:_lifecycle)?::)?(?:Lifecycle)?Node\(\s*\"(\w+)\"")
_DECLARED_IN_CPP = re.compile(
    r"(?m)^([ \t]*)(?:this->)?(?:\w+\s*=\s*)?(?:this->)?declare_parameter\b[^;]*;"
)
# The body of a constructor, on lines of its own.
_CONSTRUCTOR = re.compile(
    r"Node\(\s*\"\w+\"[^(){}]*(?:\([^(){}]*\)[^(){}]*)*\)(?:\s*,\s*\w+\s*[({][^(){}]*[)}])*\s*\{"
    r"[ \t]*(?=\r?\n)"
)
_PARAMETERS = "ros__parameters"
_DECLARE, _DECLARE_ALL = "declare_parameter", "declare_parameters"


def add_parameter(addition: Addition, given: str, node: str | None) -> None:
    """Add a parameter to a node.

    Args:
        addition: The package that has the node.
        given: `NAME:=VALUE`.
        node: The name of the node; None: the only one.

    Raises:
        RequestError: It is not clear which node is meant.
        NotFoundError: The package has no such node.
    """
    parameter = read_parameters([given])[0]
    nodes: dict[str, list[Path]] = {}
    for name, file in _nodes(addition):
        nodes.setdefault(name, []).append(file)
    if node is None and len(nodes) != 1:
        raise RequestError(
            f"{addition.name} has {len(nodes)} nodes whose names are written out.",
            hint=f"Name it with --node: {', '.join(sorted(nodes)) or 'NAME'}",
        )
    name = node or next(iter(nodes))
    settings = [
        file
        for file in sorted(list_files(addition.folder, (".yaml", ".yml"), markers=BUILD_MARKERS))
        if insert_in_node(
            addition, file, name, parameter.name, [f"{parameter.name}: {parameter.yaml}"]
        )
    ]
    if name not in nodes and not settings:
        raise NotFoundError(
            f"{addition.name} has no node {name}: no source names it, and no file sets its "
            "parameters.",
            hint=f"{ask_for_nearest(name, nodes)}Its nodes: {', '.join(sorted(nodes)) or '-'}.",
        )
    for file in nodes.get(name, []):
        declare = _declare_in_python if file.suffix == ".py" else _declare_in_cpp
        declare(addition, file, parameter)


def _nodes(addition: Addition) -> Iterator[tuple[str, Path]]:
    """The nodes whose names are written out in the sources of a package."""
    for file in sorted(list_files(addition.folder, (".py", *_CPP), markers=BUILD_MARKERS)):
        if file.name.endswith(LAUNCH_FILES) or "test" in file.parts[len(addition.folder.parts) :]:
            continue
        source = addition.source(file)
        text = source.text if source else ""
        if file.suffix != ".py":
            yield from ((name, file) for name in _OF_CPP.findall(text))
        elif source is not None and "rclpy" in text:
            tree = tree_of(source)
            for call in PythonEdits(tree).calls("__init__", "create_node") if tree else ():
                said = call.args[0] if call.args else argument(call, None, "node_name")
                if isinstance(said, ast.Constant) and isinstance(said.value, str):
                    yield said.value, file


def insert_in_node(
    addition: Addition, file: Path, node: str, key: str, lines: Sequence[str]
) -> bool:
    """Insert lines where a file sets parameters of a node, unless it sets this one.

    Whether it sets any.
    """
    source = addition.source(file)
    if source is None:
        return False
    pattern = (
        rf"(?m)^([ \t]*)[\"']?/?{re.escape(node)}[\"']?:[ \t]*(?:#.*)?\r?\n(?:[ \t]*(?:#.*)?\r?\n)*"
    )
    found = re.search(rf"{pattern}\1([ \t]+){_PARAMETERS}:[ \t]*(?:#.*)?\r?\n", source.text)
    if found is None:
        return False
    outer = found[1] + found[2]
    last, indent = found.end() - 1, f"{outer}  "
    keys: list[str] = []
    for line in re.finditer(r"([ \t]*)([^\r\n]*)(?:\r?\n|\Z)", source.text[found.end() :]):
        if not line[0]:
            break
        if not line[2] or line[2].startswith("#"):
            continue
        if not line[1].startswith(outer) or len(line[1]) <= len(outer):
            break
        if not keys:
            indent = line[1]
        if line[1] == indent:
            keys.append(line[2].partition(":")[0].strip("\"' "))
        last = found.end() + line.end(2)
    if key not in keys:
        text = "\n".join(f"{indent}{line}" for line in lines)
        addition.edit(file, [insert_below(source, last, text)])
    return True


def _is_declared(source: SourceText, name: str) -> bool:
    """Whether a source declares a parameter, alone or in a list of them."""
    before = rf"(?:{_DECLARE}(?:<[^(]*>)?\(|\()\s*"
    return re.search(rf"{before}[\"']{re.escape(name)}[\"']\s*[,)]", source.text) is not None


def _declare_in_python(addition: Addition, file: Path, parameter: Parameter) -> None:
    source = addition.require(file)
    if _is_declared(source, parameter.name):
        return
    tree = tree_of(source)
    text = f"self.{_DECLARE}('{parameter.name}', {parameter.python})"
    edit = None if tree is None else _declared_beside(PythonEdits(tree), parameter)
    if edit is None or not addition.edit(file, [edit]):
        addition.paste(file, text, "Add it to __init__ of the node, below super().__init__().")


def _declared_beside(file: PythonEdits, parameter: Parameter) -> Edit | None:
    source, tree = file.source, file.tree
    quoted = file.quoted(parameter.name)
    for call in file.calls(_DECLARE_ALL):
        listed = file.value(argument(call, 1, "parameters"))
        if isinstance(listed, ast.List) and listed.elts:
            items = [Item("", tree.start(one), tree.end(one)) for one in listed.elts]
            return insert_among(source, items, "", f"({quoted}, {parameter.python})", comma=",")
    for called in (_DECLARE, "__init__"):
        calls = file.calls(called)
        if not calls:
            continue
        statement = _statement(file, calls[-1])
        if statement is None:
            continue
        indent = source.indent_at(tree.start(statement))
        written = f"self.{_DECLARE}({quoted}, {parameter.python})"
        is_kept = isinstance(statement, ast.Assign) and file.written(statement).endswith(").value")
        if is_kept:
            attribute = parameter.name.replace(".", "_")
            own = file.written(statement).partition("declare_parameter")[0]
            if re.match(r"self\.\w+\s*=\s*self\.", own):
                written = f"self.{attribute} = {written}.value"
        return insert_below(source, tree.end(statement), f"{indent}{written}")
    return None


def _statement(file: PythonEdits, node: ast.AST) -> ast.stmt | None:
    """The statement that a node is in, if a function begins above it."""
    around: ast.AST | None = node
    while around is not None and not isinstance(around, ast.stmt):
        around = file.parents.get(around)
    return around if isinstance(around, (ast.Expr, ast.Assign)) else None


def _declare_in_cpp(addition: Addition, file: Path, parameter: Parameter) -> None:
    source = addition.require(file)
    if _is_declared(source, parameter.name):
        return
    text = f'declare_parameter<{parameter.cpp_type}>("{parameter.name}", {parameter.cpp});'
    found = list(_DECLARED_IN_CPP.finditer(source.text))
    if found:
        prefix = "this->" if "this->declare_parameter" in found[-1][0] else ""
        line = f"{found[-1][1]}{prefix}{text}"
        if addition.edit(file, [insert_below(source, found[-1].end(), line)]):
            return
    opened = _CONSTRUCTOR.search(source.text)
    if opened and addition.edit(
        file,
        [insert_below(source, opened.end() - 1, f"{source.indent_at(opened.end() - 1)}  {text}")],
    ):
        return
    addition.paste(file, text, "Add it to the constructor of the node.")
