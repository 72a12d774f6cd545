"""Elements of an XML text, and edits of them that keep comments and layout."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from wsgen.checks.fixes.source import Edit, read_tags

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.checks.fixes.source import SourceText, Tag

_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
# A blank line before what is removed, and one or the end of an element behind it.
_BLANK_BEFORE = re.compile(r"\n([ \t]*\r?\n)\Z")
_BLANK_OR_END = re.compile(r"[ \t]*(?:\r?\n|</)")
_LONGEST_BLANK = 200  # characters
CONDITIONS = ("xacro:if", "xacro:unless")
COMPUTED = "$"  # in what xacro replaces
_UNIT = "  "  # of indentation, where the text does not show one


class Node:
    """An element with its children."""

    def __init__(self, source: SourceText, tag: Tag, parent: Node | None) -> None:
        self.source = source
        self.tag = tag
        self.parent = parent
        self.written: list[Node] = []  # its children, as they are written

    @property
    def name(self) -> str:
        """Its name."""
        return self.tag.name

    @property
    def start(self) -> int:
        """Where it begins."""
        return self.tag.start.start

    @property
    def end(self) -> int:
        """Where it ends, its end tag included."""
        return (self.tag.end or self.tag.start).end

    @property
    def line(self) -> int:
        """1-based."""
        return self.source.line_at(self.start)

    @property
    def text(self) -> str:
        """What it contains, without comments and the blanks around it."""
        content = self.tag.content()
        return _COMMENT.sub("", self.source.text[content.start : content.end]).strip()

    def get(self, attribute: str) -> str:
        """An attribute as it is written; an empty text without it."""
        found = self.tag.attributes.get(attribute)
        return found.text.strip() if found else ""

    def children(self, *names: str) -> Iterator[Node]:
        """Those of these names, or all; those that xacro leaves out or not are among them."""
        for child in self.written:
            if child.name in CONDITIONS:
                yield from child.children(*names)
            elif not names or child.name in names:
                yield child

    def find(self, path: str) -> Node | None:
        """The first element at a path such as `camera/image`."""
        first, _, rest = path.partition("/")
        for child in self.children(first):
            found = child.find(rest) if rest else child
            if found is not None:
                return found
        return None

    def value(self, path: str) -> str:
        """The text of the element at a path; an empty text without it."""
        found = self.find(path)
        return found.text if found is not None else ""

    def ancestors(self) -> Iterator[Node]:
        """The elements around it, the nearest first."""
        around = self.parent
        while around is not None:
            yield around
            around = around.parent

    def is_in(self, *names: str) -> bool:
        """Whether an element of one of these names is around it."""
        return any(one.name in names for one in self.ancestors())

    @property
    def conditions(self) -> list[str]:
        """The conditions of xacro that it depends on, as they are written."""
        return [
            f"{one.name} {one.get('value')}" for one in self.ancestors() if one.name in CONDITIONS
        ]

    @property
    def macro(self) -> Node | None:
        """The macro of xacro that it is in, whose parameters it may use."""
        return next((one for one in self.ancestors() if one.name == "xacro:macro"), None)

    @property
    def holder(self) -> Node | None:
        """What has it, if not in a condition of xacro."""
        return next((one for one in self.ancestors() if one.name not in CONDITIONS), None)


def read_nodes(source: SourceText) -> list[Node]:
    """All elements, in the order of their start tags."""
    found: list[Node] = []
    by_start: dict[int, Node] = {}
    for tag in read_tags(source.text):
        parent = by_start[tag.path[-1].start.start] if tag.path else None
        node = Node(source, tag, parent)
        by_start[tag.start.start] = node
        found.append(node)
        if parent is not None:
            parent.written.append(node)
    return found


class Block:
    """An element to add; `content` is its text, or its children."""

    def __init__(
        self, name: str, content: str | Sequence[Block] = (), attributes: str = ""
    ) -> None:
        self.name = name
        self.content = content
        self.attributes = attributes

    def lines(self, unit: str) -> Iterator[str]:
        """How it is written, with this for each level of indentation."""
        start = f"{self.name} {self.attributes}".rstrip()
        if isinstance(self.content, str):
            yield f"<{start}>{self.content}</{self.name}>"
        elif not self.content:
            yield f"<{start}/>"
        else:
            yield f"<{start}>"
            for child in self.content:
                yield from (f"{unit}{line}" for line in child.lines(unit))
            yield f"</{self.name}>"


class Copy(Block):
    """An element to add as another one is written, with what it contains."""

    def __init__(self, node: Node) -> None:
        super().__init__(node.name)
        self._node = node

    def lines(self, unit: str) -> Iterator[str]:  # noqa: ARG002  it has a layout
        """As in the base."""
        source = self._node.source
        indent = source.indent_at(self._node.start)
        for line in source.text[self._node.start : self._node.end].splitlines():
            yield line.removeprefix(indent)


class Editor:
    """Collects the edits of a text; what is added at one place is added by one of them."""

    def __init__(self, source: SourceText) -> None:
        self.source = source
        self._edits: list[Edit] = []
        self._inside: dict[int, tuple[Node, list[Block]]] = {}  # by the start of an element
        self._behind: dict[int, tuple[Node, list[Block]]] = {}
        self._gone: list[tuple[int, int]] = []  # what is written anew as a whole, or not at all

    def finish(self) -> tuple[Edit, ...]:
        """All edits that change something; none of them touches another one."""
        for node, blocks in self._inside.values():
            self._add_inside(node, blocks)
        for node, blocks in self._behind.values():
            lines = self._lines(blocks, self.source.indent_at(node.start), self._unit(node))
            text = "".join(f"{self._newline}{line}" for line in lines)
            self._edit(node.end, node.end, text)
        edits = dict.fromkeys(self._edits)
        return (
            *self._removals(edit for edit in edits if not edit.text),
            *(edit for edit in edits if edit.text and self._is_effective(edit)),
        )

    def _is_effective(self, edit: Edit) -> bool:
        """Whether an edit changes something that stays."""
        if edit.text == self.source.text[edit.start : edit.end]:
            return False
        return not any(
            start <= edit.start
            and edit.end <= end
            and (edit.start, edit.end) != (start, end)
            and not (edit.start == edit.end and edit.start in (start, end))
            for start, end in self._gone
        )

    def _removals(self, edits: Iterable[Edit]) -> Iterator[Edit]:
        """What is removed; of blank lines around it, one stays."""
        text = self.source.text
        spans: list[list[int]] = []
        for edit in sorted(filter(self._is_effective, edits), key=lambda one: one.start):
            if spans and spans[-1][1] == edit.start:
                spans[-1][1] = edit.end
            else:
                spans.append([edit.start, edit.end])
        for start, end in spans:
            before = _BLANK_BEFORE.search(text, max(0, start - _LONGEST_BLANK), start)
            is_line = before is not None and _BLANK_OR_END.match(text, end) is not None
            yield Edit(start=before.start(1) if before and is_line else start, end=end, text="")

    @property
    def _newline(self) -> str:
        return self.source.newline

    def _edit(self, start: int, end: int, text: str) -> None:
        self._edits.append(Edit(start=start, end=end, text=text))

    def write(self, start: int, end: int, text: str) -> None:
        """Write a text in the place of another one."""
        self._edit(start, end, text)

    def rename(self, node: Node, name: str) -> None:
        """Give an element another name."""
        if name == node.name:
            return
        start = node.start + 1
        self._edit(start, start + len(node.name), name)
        if node.tag.end is not None:
            start = node.tag.end.start + len("</")
            self._edit(start, start + len(node.name), name)

    def set_text(self, node: Node, text: str) -> None:
        """Write a text into an element that has no others; comments in it stay."""
        content = node.tag.content()
        written = self.source.text[content.start : content.end]
        place = next(re.finditer(re.escape(node.text), written), None) if node.text else None
        if node.tag.end is None:
            self._edit(node.tag.start.end - len("/>"), node.tag.start.end, f">{text}</{node.name}>")
        elif place is not None:
            self._edit(content.start + place.start(), content.start + place.end(), text)
        else:
            self._edit(content.end, content.end, text)

    def set_attribute(self, node: Node, name: str, value: str) -> None:
        """Write an attribute."""
        found = node.tag.attributes.get(name)
        if found is not None:
            self._edit(*found.value, value)
        else:
            at = node.start + 1 + len(node.name)
            self._edit(at, at, f' {name}="{value}"')

    def append(self, node: Node, *blocks: Block) -> None:
        """Add elements behind the last one in an element."""
        self._inside.setdefault(node.start, (node, []))[1].extend(blocks)

    def prepend(self, node: Node, *blocks: Block) -> None:
        """Add elements in front of the first one in an element."""
        if node.tag.end is None:
            self.append(node, *blocks)
            return
        lines = self._lines(blocks, self._indent_in(node), self._unit(node))
        at = node.tag.start.end
        self._edit(at, at, "".join(f"{self._newline}{line}" for line in lines))

    def add_behind(self, node: Node, *blocks: Block) -> None:
        """Add elements behind an element."""
        self._behind.setdefault(node.start, (node, []))[1].extend(blocks)

    def put(self, node: Node, name: str, text: str) -> None:
        """Have an element contain one of this name with this text."""
        found = node.find(name)
        if found is None:
            self.append(node, Block(name, text))
        else:
            self.set_text(found, text)

    def remove(self, node: Node) -> None:
        """Remove an element with its line, but for the comments in it."""
        text = self.source.text
        comments = _COMMENT.findall(text[node.start : node.end])
        start, end = self.source.whole_lines(node.start, node.end)
        self._gone.append((start, end))
        if not comments:
            self._edit(start, end, "")
        elif (start, end) == (node.start, node.end):
            self._edit(start, end, " ".join(comments))
        else:
            indent = self.source.indent_at(node.start)
            self._edit(start, end, "".join(f"{indent}{one}{self._newline}" for one in comments))

    def cut(self, node: Node) -> None:
        """Remove an element with its line and all that it contains, which stands elsewhere now."""
        start, end = self.source.whole_lines(node.start, node.end)
        self._gone.append((start, end))
        self._edit(start, end, "")

    def replace(self, node: Node, blocks: Iterable[Block]) -> None:
        """Put elements in the place of one; comments in it come before them."""
        comments = _COMMENT.findall(self.source.text[node.start : node.end])
        indent = self.source.indent_at(node.start)
        lines = [*comments, *self._lines(blocks, indent, self._unit(node))]
        self._gone.append((node.start, node.end))
        text = f"{self._newline}{indent}".join(one.removeprefix(indent) for one in lines)
        self._edit(node.start, node.end, text)

    def comment_out(self, node: Node) -> None:
        """Make a comment of an element; comments in it stay comments."""
        text = self.source.text[node.start : node.end]
        if "--" in _COMMENT.sub("", text):
            self.remove(node)
            return
        inner = _COMMENT.sub(lambda found: f"-->{found[0]}<!--", text)
        self._gone.append((node.start, node.end))
        self._edit(node.start, node.end, f"<!-- {inner} -->")

    def _unit(self, node: Node) -> str:
        """What one level of indentation is, around an element."""
        own = self.source.indent_at(node.start)
        for inner in node.written:
            indent = self.source.indent_at(inner.start)
            if indent != own and indent.startswith(own):
                return indent[len(own) :]
        for around in node.ancestors():
            indent = self.source.indent_at(around.start)
            if indent != own and own.startswith(indent):
                return own[len(indent) :]
        return _UNIT

    @staticmethod
    def _lines(blocks: Iterable[Block], indent: str, unit: str) -> list[str]:
        return [f"{indent}{line}" for block in blocks for line in block.lines(unit)]

    def _add_inside(self, node: Node, blocks: Sequence[Block]) -> None:
        own, unit = self.source.indent_at(node.start), self._unit(node)
        lines = self._lines(blocks, self._indent_in(node), unit)
        end = node.tag.end
        if end is None:
            at = node.tag.start.end - len("/>")
            text = self._newline.join((">", *lines, f"{own}</{node.name}>"))
            self._edit(at, node.tag.start.end, text)
        elif self._begins_line(end.start):
            at = self.source.start_of(self.source.line_at(end.start))
            self._edit(at, at, "".join(f"{line}{self._newline}" for line in lines))
        else:
            text = self._newline.join(("", *lines, own))
            self._edit(end.start, end.start, text)

    def _indent_in(self, node: Node) -> str:
        """The blanks before the elements in an element."""
        first = next(iter(node.written), None)
        if first is not None and self._begins_line(first.start):
            return self.source.indent_at(first.start)
        return f"{self.source.indent_at(node.start)}{self._unit(node)}"

    def _begins_line(self, place: int) -> bool:
        start = self.source.start_of(self.source.line_at(place))
        return not self.source.text[start:place].strip()
