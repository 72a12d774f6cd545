"""Tables that are data: text files beside the modules that read them."""

from __future__ import annotations

from pathlib import Path


def read_table(module: str, name: str) -> dict[str, tuple[str, ...]]:
    """The rows of a file: the words of each by its first one; `#` begins a line of comment.

    Args:
        module: The `__file__` of the module that the file lies beside.
        name: That of the file.
    """
    lines = Path(module).with_name(name).read_text(encoding="utf-8").splitlines()
    rows = (line.split() for line in lines if not line.startswith("#"))
    return {first: tuple(others) for first, *others in rows}


def read_markup_names(
    module: str, name: str
) -> tuple[dict[str, tuple[str, ...]], dict[str, tuple[str, ...]]]:
    """The elements and the attributes that elements have, of a table with `@` before the latter."""
    table = read_table(module, name)
    return (
        {tag: tuple(one for one in names if one[0] != "@") for tag, names in table.items()},
        {tag: tuple(one[1:] for one in names if one[0] == "@") for tag, names in table.items()},
    )
