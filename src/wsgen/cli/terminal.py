"""Tables, trees, documentation and a status line, drawn with rich.

No other module imports rich, and this one imports it when it has something to draw: importing it
takes a large part of the time of a short command. Texts carry the styles of `click.style` and are
never read as rich's markup, so that a name may contain brackets. A drawing is a list of lines for
`click.echo`, which knows whether colors are wanted.

On a terminal, the lines fit its width. In a pipe or a file, no cell is wrapped or cut off.
"""

from __future__ import annotations

import re
import sys
import time
from typing import TYPE_CHECKING, NamedTuple

import click

from wsgen.text.printable import clean_line, clean_styled

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from rich.console import Console, RenderableType
    from rich.text import Text
    from rich.tree import Tree


UNLIMITED = 1_000_000  # columns
NARROWEST = 20  # columns that a wrapped cell gets in a table
INDENT = "  "
LONG = 10.0  # s; what takes longer says for how long it has been going on


def echo(text: str = "", *, err: bool = False, nl: bool = True, color: bool | None = None) -> None:
    """`click.echo` of what users' files, names and messages of other programs may have got into.

    Nothing of it moves the cursor, hides or turns text, or sets the title of the window.
    """
    click.echo(clean_styled(text), err=err, nl=nl, color=color)


class Branch(NamedTuple):
    """A node of a tree: its lines, and the nodes below it."""

    label: str
    below: tuple[Branch, ...] = ()


def draw_table(
    rows: Sequence[Sequence[str]],
    *,
    headings: Sequence[str] = (),
    wrapped: Sequence[int] = (-1,),
    alike: Sequence[Sequence[str]] = (),
    indent: str = INDENT,
    quiet: bool = False,
) -> list[str]:
    """The lines of a table; on a narrow terminal the columns `wrapped` are wrapped.

    Where that would leave too little for them, or break a word, what would be in a wrapped column
    is below the rest of its row; of a table with headings each cell is beside its heading. No cell
    is cut off. Tables without headings have the same layout if each gets the rows of all as
    `alike`. With `quiet`, a line a row without headings and alignment, which takes no library.
    """
    if not rows:
        return []
    if quiet:
        return [indent + "  ".join(filter(None, row)).replace("\n", " ") for row in rows]
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
    body, others = (
        [[Text.from_ansi(cell.replace("\n", " ")) for cell in row] for row in some]
        for some in (rows, alike)
    )
    count, needed, available = len(rows[0]), -gap, _width() - len(indent)
    broken = {index % count for index in wrapped}
    for column in range(count):
        cells = [row[column] for row in [*([head] if head else []), *body, *others]]
        width = max(cell.cell_len for cell in cells)
        if column in broken:
            word = max(len(word) for cell in cells for word in cell.plain.split() or [""])
            width = min(width, max(word, NARROWEST))
        needed += gap + width
        least = max(cell.cell_len for cell in cells) if others and column not in broken else None
        table.add_column(
            head[column] if head else "", no_wrap=column not in broken, min_width=least
        )
    for row in body:
        table.add_row(*row)
    if needed > available:
        return _lines(_stacked(body, head, broken), indent=indent)
    return _lines(table, indent=indent)


def _stacked(rows: list[list[Text]], head: list[Text], wrapped: set[int]) -> RenderableType:
    """A table for a terminal that is too narrow: what is wrapped has lines of its own."""
    from rich.console import Group
    from rich.padding import Padding
    from rich.table import Table
    from rich.text import Text

    if not head:
        lines: list[RenderableType] = []
        for row in rows:
            kept = (cell for column, cell in enumerate(row) if column not in wrapped)
            lines.append(Text("  ").join(kept))
            lines += [Padding(row[one], (0, 0, 0, 4)) for one in sorted(wrapped) if row[one]]
        return Group(*lines)
    table = Table(
        box=None, show_header=False, show_edge=False, pad_edge=False, padding=(0, 2, 0, 0)
    )
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    for number, row in enumerate(rows):
        if number:
            table.add_row()
        for heading, cell in zip(head, row, strict=True):
            table.add_row(heading, cell)
    return table


def fit_lines(lines: Iterable[str]) -> Iterator[str]:
    """Wrap lines to the terminal; what is wrapped continues below the second column, if any."""
    width = _width()
    for line in lines:
        if len(click.unstyle(line)) <= width:
            yield line
            continue
        plain = click.unstyle(line)
        start = re.match(r" *\S+ {2,}", plain)
        near = start is not None and start.end() <= width // 3
        indent = start.end() if start and near else len(plain) - len(plain.lstrip()) + len(INDENT)
        shown, *words = re.findall(r" *\S+", line)
        for word in words:
            if len(click.unstyle(shown + word)) > width:
                yield shown
                shown, word = " " * indent, word.lstrip(" ")  # noqa: PLW2901
            shown += word
        yield shown


def echo_next(line: str, *, err: bool = True) -> None:
    """Print what to do next: a command, and in parentheses what it does.

    Where the terminal is too narrow, what it does comes below the command, and the command goes on
    in further lines, which a shell takes as one.
    """
    for part in _next_lines(line, _width(err=err)):
        echo(part, err=err)


def _next_lines(line: str, width: int) -> Iterator[str]:
    if len(line) <= width:
        yield line
        return
    command, blanks, comment = line.partition("  (")
    indent = " " * (len("Next: ") + len(INDENT))
    is_command = _COMMAND.match(command) is not None
    shown, *words = _SHELL_WORD.findall(command)
    for word in words:
        if len(shown + word) + len(_GOES_ON) > width and shown.strip():
            yield shown + (_GOES_ON if is_command else "")
            shown, word = indent, word.lstrip(" ")  # noqa: PLW2901
        shown += word
    yield shown
    shown = indent
    for word in f"({comment}".split() if blanks else ():
        if len(shown + word) > width and shown.strip():
            yield shown.rstrip()
            shown = indent
        shown += f"{word} "
    if shown.strip():
        yield shown.rstrip()


_COMMAND = re.compile(r"(?:Next:)? *(?:cd|ros2|wsgen) ")
_SHELL_WORD = re.compile(r" *(?:'[^']*'|\"[^\"]*\"|[^\s'\"])+")
_GOES_ON = " \\"


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


def _lines(drawing: RenderableType, *, indent: str) -> list[str]:
    console = _make_console(width=max(_width() - len(indent), NARROWEST))
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


def _width(*, err: bool = False) -> int:
    if not _is_terminal(err=err):
        return UNLIMITED
    import shutil

    return shutil.get_terminal_size().columns


def _is_terminal(*, err: bool = False) -> bool:
    stream = sys.stderr if err else sys.stdout
    return stream is not None and stream.isatty()


class _Since:
    """A text, and for how long it is shown, where that is long: rich asks for it now and then."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._began = time.monotonic()

    def __rich__(self) -> Text:
        from rich.text import Text

        seconds = time.monotonic() - self._began
        return Text(self._text + (f"  {seconds:.0f} s" if seconds >= LONG else ""))


class StatusLine:
    """One line with a spinner below what is printed on standard error, a terminal."""

    def __init__(self) -> None:
        from rich.console import Console

        color = click.get_current_context().color
        self._status = Console(stderr=True, no_color=color is False).status("")

    def show(self, text: str) -> None:
        """Show this text, as it is: rich would read a string as its markup."""
        self._status.update(_Since(clean_line(text)))
        self._status.start()

    def hide(self) -> None:
        """Remove the line, so that others can be printed."""
        self._status.stop()
