"""Tables, trees, documentation and a status line, drawn with rich.

No other module imports rich, and this one imports it when it has something to draw: importing it
takes a large part of the time of a short command. Texts carry the styles of `click.style` and are
never read as rich's markup, so that a name may contain brackets. A drawing is a list of lines for
`click.echo`, which knows whether colors are wanted.

On a terminal, the lines fit its width. In a pipe or a file, no cell is wrapped or cut off.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, NamedTuple

import click

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rich.console import Console, RenderableType
    from rich.tree import Tree


UNLIMITED = 1_000_000  # columns
NARROWEST = 12  # columns that a wrapped cell gets, however narrow the terminal
INDENT = "  "


class Branch(NamedTuple):
    """A node of a tree: its lines, and the nodes below it."""

    label: str
    below: tuple[Branch, ...] = ()


def draw_table(
    rows: Sequence[Sequence[str]],
    *,
    headings: Sequence[str] = (),
    wrapped: Sequence[int] = (-1,),
    indent: str = INDENT,
    quiet: bool = False,
) -> list[str]:
    """The lines of a table; on a narrow terminal the columns `wrapped` are wrapped.

    A terminal that is too narrow for the other columns breaks lines itself: no cell is cut off.
    With `quiet`, a line a row without headings and alignment, which takes no library.
    """
    if not rows:
        return []
    if quiet:
        return [indent + "  ".join(filter(None, row)) for row in rows]
    from rich import box
    from rich.table import Table
    from rich.text import Text

    gap = 2
    table = Table(
        box=box.SIMPLE_HEAD if headings else None,
        show_header=bool(headings),
        header_style="",
        show_edge=False,
        pad_edge=False,
        padding=(0, gap - 1 if headings else gap, 0, 0),  # the box has a column between two
    )
    head = [Text.from_ansi(click.style(heading, bold=True)) for heading in headings]
    body = [[Text.from_ansi(cell) for cell in row] for row in rows]
    count, needed = len(rows[0]), 0
    for column in range(count):
        is_wrapped = column in {index % count for index in wrapped}
        width = max(row[column].cell_len for row in [*([head] if head else []), *body])
        needed += gap + (min(width, NARROWEST) if is_wrapped else width)
        table.add_column(head[column] if head else "", no_wrap=not is_wrapped, overflow="fold")
    for row in body:
        table.add_row(*row)
    return _lines(table, indent=indent, at_least=needed)


def draw_tree(tree: Branch, *, quiet: bool = False) -> list[str]:
    """The lines of a tree; with `quiet` indented only, which takes no library."""
    return list(_indented(tree)) if quiet else _lines(_to_rich(tree), indent="")


def _indented(tree: Branch, indent: str = "") -> Iterator[str]:
    yield from (indent + line for line in tree.label.splitlines())
    for branch in tree.below:
        yield from _indented(branch, indent + INDENT)


def _to_rich(tree: Branch) -> Tree:
    from rich.console import Group
    from rich.padding import Padding
    from rich.text import Text
    from rich.tree import Tree

    def draw(line: str) -> Padding:  # which a line keeps where it is wrapped
        text = line.lstrip(" ")
        return Padding(Text.from_ansi(text), (0, 0, 0, len(line) - len(text)), expand=False)

    drawn = Tree(Group(*(draw(line) for line in tree.label.splitlines())))
    drawn.children += [_to_rich(branch) for branch in tree.below]
    return drawn


def draw_markdown(text: str, *, quiet: bool = False) -> list[str]:
    """The lines of a Markdown document on a terminal; in a pipe or with `quiet`, its text."""
    if quiet or not _is_terminal():
        return text.splitlines()
    from rich.markdown import Markdown

    return _lines(Markdown(text), indent="")


def _lines(drawing: RenderableType, *, indent: str, at_least: int = 1) -> list[str]:
    console = _make_console(width=max(_width() - len(indent), at_least))
    with console.capture() as capture:
        console.print(drawing)
    return [f"{indent}{line.rstrip(' ')}".rstrip() for line in capture.get().splitlines()]


def _make_console(*, width: int) -> Console:
    """Colors as click has them, and no guess about what text means: `click.echo` decides."""
    from rich.console import Console

    return Console(
        force_terminal=True,
        color_system="standard",
        no_color=False,
        legacy_windows=False,
        width=width,
        markup=False,
        highlight=False,
        emoji=False,
    )


def _width() -> int:
    if not _is_terminal():
        return UNLIMITED
    import shutil

    return shutil.get_terminal_size().columns


def _is_terminal() -> bool:
    return sys.stdout is not None and sys.stdout.isatty()


class StatusLine:
    """One line with a spinner below what is printed on standard error, a terminal."""

    def __init__(self) -> None:
        from rich.console import Console

        color = click.get_current_context().color
        self._status = Console(stderr=True, no_color=color is False).status("")

    def show(self, text: str) -> None:
        """Show this text, as it is: rich would read a string as its markup."""
        from rich.text import Text

        self._status.update(Text(text))
        self._status.start()

    def hide(self) -> None:
        """Remove the line, so that others can be printed."""
        self._status.stop()
