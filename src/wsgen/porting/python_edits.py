"""Read a launch file in Python, and note edits in it."""

from __future__ import annotations

import ast
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.launch_files import import_edit
from wsgen.checks.fixes.source import Edit
from wsgen.porting.ported import Unported
from wsgen.text.pythontree import name_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.checks.fixes.launch_files import Located, Tree

PAIR = 2  # values of a tuple that are a name and its value


class Text(NamedTuple):
    """A text that is written out."""

    node: ast.Constant
    text: str


class Entry(NamedTuple):
    """A key with its value, in a dictionary or in a list of pairs."""

    key: ast.expr
    value: ast.expr
    whole: tuple[Located, Located]  # the first and the last node of it


class PythonEdits:
    """The syntax of a file, and what is to be changed in it."""

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.source = tree.source
        self.edits: list[Edit] = []
        self.unported: list[Unported] = []
        self.imports: list[str] = []
        self.done: set[ast.AST] = set()  # what edits are about
        text = tree.source.text
        self.quote = '"' if text.count('"') > text.count("'") else "'"
        self.parents = {
            child: parent for parent in tree.nodes for child in ast.iter_child_nodes(parent)
        }
        self._values: dict[str, list[ast.expr]] = {}  # by the names that they are assigned to
        for node in tree.all(ast.Assign):
            for target in node.targets:
                if isinstance(target, ast.Name):
                    self._values.setdefault(target.id, []).append(node.value)

    # What is written

    def calls(self, *names: str) -> list[ast.Call]:
        """All calls of what has one of these names."""
        return [call for call in self.tree.all(ast.Call) if name_of(call) in names]

    def value(self, node: ast.expr | None) -> ast.expr | None:
        """What a name stands for, where it is assigned once; else the node."""
        if isinstance(node, ast.Name) and len(values := self._values.get(node.id, [])) == 1:
            return values[0]
        return node

    def is_list(self, node: ast.expr) -> bool:
        """Whether a node is a list, or the name of one."""
        values = self._values.get(node.id, [node]) if isinstance(node, ast.Name) else [node]
        return all(isinstance(value, (ast.List, ast.Tuple)) for value in values)

    def text(self, node: ast.expr | None) -> Text | None:
        """The text that a node, or the name of one, is."""
        value = self.value(node)
        if isinstance(value, ast.Constant) and isinstance(value.value, str):
            return Text(value, value.value)
        return None

    def said(self, node: ast.expr | None) -> str | None:
        """The text alone."""
        found = self.text(node)
        return None if found is None else found.text

    def texts(self, node: ast.AST, depth: int = 3) -> Iterator[Text]:
        """The texts in a node, and in what its names stand for."""
        for inner in ast.walk(node):
            if isinstance(inner, ast.Constant) and isinstance(inner.value, str):
                yield Text(inner, inner.value)
            elif isinstance(inner, ast.Name) and depth:
                value = self.value(inner)
                if value is not inner and value is not None:
                    yield from self.texts(value, depth - 1)

    def entries(self, node: ast.expr | None) -> dict[str, Entry] | None:
        """What a dictionary or a list of pairs has, by its keys; None where it is computed."""
        if node is None:
            return {}
        if isinstance(node, ast.Call) and name_of(node) == "items":
            function = node.func
            inside = function.value if isinstance(function, ast.Attribute) else None
            return None if inside is None else self.entries(self.value(inside))
        found: list[Entry] = []
        if isinstance(node, ast.Dict):
            for key, value in zip(node.keys, node.values, strict=True):
                if key is None:
                    return None
                found.append(Entry(key, value, (key, value)))
        elif isinstance(node, (ast.List, ast.Tuple)):
            for one in node.elts:
                if not isinstance(one, ast.Tuple) or len(one.elts) != PAIR:
                    return None
                found.append(Entry(one.elts[0], one.elts[1], (one, one)))
        else:
            return None
        named = {self.said(entry.key): entry for entry in found}
        return None if None in named else {name: one for name, one in named.items() if name}

    def written(self, node: Located) -> str:
        """The source of a node."""
        return self.source.text[self.tree.start(node) : self.tree.end(node)]

    def quoted(self, text: str) -> str:
        """A text as Python, with the quotes that the file prefers."""
        return f"{self.quote}{text}{self.quote}"

    def is_first_on_line(self, node: Located) -> bool:
        """Whether nothing but a bracket is before it on its line."""
        before = self.source.text[: self.tree.start(node)].rpartition("\n")[2]
        return not before.strip(" \t([{")

    # What is changed

    def replace(self, first: Located, text: str, last: Located | None = None) -> None:
        """Write a text in place of nodes; of two for one node, the first counts."""
        if first in self.done:
            return
        for node in (first, last or first):
            self.done.update(ast.walk(node))
        end = self.tree.end(last or first)
        self.edits.append(Edit(start=self.tree.start(first), end=end, text=text))

    def rename(self, text: Text, *names: tuple[str, str]) -> None:
        """Change parts of a text, and keep its quotes."""
        written = self.written(text.node)
        for old, new in names:
            written = written.replace(old, new)
        self.replace(text.node, written)

    def insert(self, place: int, text: str) -> None:
        """Add a text."""
        self.edits.append(Edit(start=place, end=place, text=text))

    def remove(self, first: Located, last: Located) -> None:
        """Remove elements of a list or dictionary, with the comma behind them."""
        source = self.source
        start, end = self.tree.start(first), self.tree.end(last)
        rest = source.text[end:]
        behind = len(rest) - len(rest.lstrip())
        if rest[behind : behind + 1] == ",":
            end += behind + 1
            whole = source.whole_lines(start, end)
            if whole[1] > end:
                start, end = whole
            else:
                end += len(source.text[end:]) - len(source.text[end:].lstrip(" "))
        else:  # the last one: with the comma before it
            start = len(source.text[:start].rstrip().removesuffix(","))
        self.done.update(ast.walk(first), ast.walk(last))
        self.edits.append(Edit(start=start, end=end, text=""))

    def leave(self, node: Located, what: str, advice: str, *, is_note: bool = False) -> None:
        """List what is left to the author."""
        self.unported.append(Unported(self.source.file, node.lineno, what, advice, is_note))

    def all_edits(self) -> tuple[Edit, ...]:
        """The edits, with the imports that they need.

        Those that add at one place are one, and those that remove neighbors: of two, each takes
        the comma between them.
        """
        edits = [one for one in self.edits if one.text or one.start == one.end]
        for one in sorted(set(self.edits) - set(edits), key=lambda one: one.start):
            if edits and not edits[-1].text and one.start < edits[-1].end:
                edits[-1] = replace(edits[-1], end=max(edits[-1].end, one.end))
            else:
                edits.append(one)
        for statement in dict.fromkeys(self.imports):
            edits += import_edit(self.tree, statement)
        added: dict[int, str] = {}
        for edit in edits:
            if edit.start == edit.end:
                added[edit.start] = added.get(edit.start, "") + edit.text
        return (
            *(edit for edit in edits if edit.start != edit.end),
            *(Edit(start=at, end=at, text=text) for at, text in added.items()),
        )


def argument(call: ast.Call, index: int | None, *names: str) -> ast.expr | None:
    """The argument of a call that has one of these names, or this place."""
    for keyword in call.keywords:
        if keyword.arg in names:
            return keyword.value
    return call.args[index] if index is not None and index < len(call.args) else None
