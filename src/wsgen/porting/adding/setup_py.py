"""setup.py, to whose lists entries are added."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from wsgen.checks.fixes.launch_files import import_edit, tree_of
from wsgen.checks.fixes.source import Edit
from wsgen.porting.adding.addition import SETUP
from wsgen.porting.adding.places import Item, insert_above, insert_among
from wsgen.porting.python_edits import PythonEdits

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.checks.fixes.source import SourceText
    from wsgen.porting.adding.addition import Addition

SCRIPTS = "console_scripts"
DATA = "data_files"


def add_script(addition: Addition, name: str, target: str) -> None:
    """Add a program that calls a function, such as `my_robot.talker:main`."""
    file = addition.folder / SETUP
    text = f"{name} = {target}"
    edits = _add_script(addition.require(file), text)
    if not edits or not addition.edit(file, edits):
        addition.paste(file, f"'{text}',", f"Add it to `{SCRIPTS}` in `entry_points`.")


def _add_script(source: SourceText, text: str) -> list[Edit]:
    file, setup = _read(source)
    if file is None or setup is None:
        return []
    points = next((one for one in setup.keywords if one.arg == "entry_points"), None)
    if points is None:
        quoted = file.quoted
        lines = [
            "entry_points={",
            f"    {quoted(SCRIPTS)}: [",
            f"        {quoted(text)},",
            "    ],",
            "}",
        ]
        return _keyword(file, setup, lines)
    value = file.value(points.value)
    if not isinstance(value, ast.Dict):
        return []
    for key, scripts in zip(value.keys, value.values, strict=True):
        listed = file.value(scripts)
        if file.said(key) == SCRIPTS and isinstance(listed, ast.List):
            return _element(file, listed, text, file.quoted(text))
    if any(file.said(key) == SCRIPTS for key in value.keys):
        return []
    indent = file.source.indent_at(file.tree.start(points))
    lines = [f"{indent}    {file.quoted(SCRIPTS)}: [", f"{indent}        {file.quoted(text)},"]
    lines.append(f"{indent}    ],")
    return _first_inside(file, value, lines)


def add_data(addition: Addition, folder: str, pattern: str) -> None:
    """Install the files of a folder that match a pattern into the share folder."""
    file = addition.folder / SETUP
    source = addition.require(file)
    edits = _add_data(source, addition.name, folder, pattern)
    if not edits or not addition.edit(file, edits):
        entry = f"('share/' + package_name + '/{folder}', glob('{folder}/{pattern}')),"
        addition.paste(file, entry, f"Add it to `{DATA}`, and import glob from glob.")


def _add_data(source: SourceText, package: str, folder: str, pattern: str) -> list[Edit]:
    file, setup = _read(source)
    if file is None or setup is None:
        return []
    data = next((one.value for one in setup.keywords if one.arg == DATA), None)
    listed = file.value(data)
    if not isinstance(listed, ast.List) or not listed.elts:
        return []
    q = file.quoted
    joins = "os.path.join(" in source.text and "import os" in source.text
    name = "package_name" if "package_name" in file.names() else q(package)
    share = (
        f"os.path.join({q('share')}, {name}, {q(folder)})"
        if joins
        else f"{q('share/')} + {name} + {q(f'/{folder}')}"
        if name == "package_name"
        else q(f"share/{package}/{folder}")
    )
    names = {one.attr for one in file.tree.all(ast.Attribute)}
    is_module = any(
        one.name == "glob" and one.asname is None
        for node in file.tree.all(ast.Import)
        for one in node.names
    )
    call = "glob.glob" if is_module and "glob" in names else "glob"
    place = f"os.path.join({q(folder)}, {q(pattern)})" if joins else q(f"{folder}/{pattern}")
    edits = _element(file, listed, "", f"({share}, {call}({place}))")
    if edits and call == "glob" and not is_module:
        edits += import_edit(file.tree, "from glob import glob")
    elif edits and call == "glob":
        return []
    return edits


def _read(source: SourceText) -> tuple[_Setup | None, ast.Call | None]:
    tree = tree_of(source)
    if tree is None:
        return None, None
    file = _Setup(tree)
    calls = file.calls("setup")
    return file, calls[0] if len(calls) == 1 else None


class _Setup(PythonEdits):
    def names(self) -> set[str]:
        """The variables of the file."""
        return {
            target.id
            for node in self.tree.all(ast.Assign)
            for target in node.targets
            if isinstance(target, ast.Name)
        }


def _element(file: _Setup, listed: ast.List, key: str, text: str) -> list[Edit]:
    """An element of a list, on a line like its likes."""
    source, tree = file.source, file.tree
    if listed.elts:
        items = [Item(file.said(one) or "", tree.start(one), tree.end(one)) for one in listed.elts]
        edit = insert_among(source, items, key, _as_written(file, listed.elts, text), comma=",")
        if edit is not None:
            return [edit]
        start = tree.start(listed.elts[0])
        return [Edit(start=start, end=start, text=f"{text}, ")]
    start, end = tree.start(listed), tree.end(listed)
    if source.line_at(start) == source.line_at(end):
        return [Edit(start=start + 1, end=start + 1, text=text)]
    indent = source.indent_at(end - 1)
    return [insert_above(source, end - 1, f"{indent}    {text},")]


def _as_written(file: _Setup, likes: Sequence[ast.expr], text: str) -> str:
    """With the quotes of the one before it."""
    last = file.written(likes[-1])
    if isinstance(likes[-1], ast.Constant) and last[:1] in "'\"":
        return f"{last[0]}{text[1:-1]}{last[0]}"
    return text


def _keyword(file: _Setup, setup: ast.Call, lines: list[str]) -> list[Edit]:
    """An argument of setup(), in front of the last one, so that no comma has to be added."""
    if not setup.keywords:
        return []
    source = file.source
    place = file.tree.start(setup.keywords[-1])
    start = source.start_of(source.line_at(place))
    if source.text[start:place].strip():
        return []
    indent = source.indent_at(place)
    text = "\n".join(f"{indent}{one}" for one in lines)
    return [insert_above(source, place, f"{text},")]


def _first_inside(file: _Setup, value: ast.Dict, lines: list[str]) -> list[Edit]:
    start = file.tree.start(value) + 1
    source = file.source
    rest = source.text[start:].partition("\n")[0].strip()
    if rest:
        return []
    at = source.start_of(source.line_at(start) + 1)
    return [Edit(start=at, end=at, text="".join(f"{one}{source.newline}" for one in lines))]
