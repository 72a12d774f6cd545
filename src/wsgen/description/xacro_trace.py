"""What xacro was doing when it raised: read from the frames of the exception.

xacro's messages name neither the element nor the line. The frames of its functions hold the
element that was expanded, the attribute as it is written, and the values known at that moment.
The names of functions and variables are those of xacro 2.0 and 2.1; where a frame does not have
them, less is known and nothing breaks.
"""

from __future__ import annotations

import ast
import os
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

Frame = tuple[str, "Mapping[str, Any]"]  # function, its variables

MOST_SCOPES = 100  # deeper ones go in circles


class Trace(NamedTuple):
    """What xacro was at."""

    cause: BaseException  # the first exception
    inside: bool  # a document was being expanded, not only opened
    files: tuple[str, ...]  # that the element may be written in, likeliest first
    node: Any = None  # DOM element or text that was expanded; its attributes partly are values
    attribute: str | None = None  # of the element
    raw: str | None = None  # that attribute, or the value of `name`, as written
    name: str | None = None  # the property whose value was looked for
    expression: str | None = None  # the innermost one, without ${}
    values: Mapping[str, Any] = {}  # of the names in the expression
    names: tuple[str, ...] = ()  # all that an expression may use here
    macros: tuple[str, ...] = ()  # that are defined here


def trace(error: BaseException, files: Iterable[str | None]) -> Trace | None:
    """What xacro was at when it raised `error`; None where the error is not from xacro.

    `files` are those that xacro has read, the one being expanded first.
    """
    frames = list(_frames(error))
    if not frames:
        return None
    place = next((place for frame in reversed(frames) if (place := _place(*frame))), {})
    return Trace(
        cause=_first(error),
        inside=any(function == "eval_all" for function, _ in frames),
        files=tuple(dict.fromkeys(_files(frames, place.get("node"), files))),
        **place,
        **_expression(frames),
        macros=_keys(next(_all(frames, "macros"), None)),
    )


def _first(error: BaseException) -> BaseException:
    """The exception that the first XacroException was made of."""
    while isinstance(getattr(error, "exc", None), BaseException):
        error = error.exc  # type: ignore[attr-defined]  # as the line before says
    return error


def _frames(error: BaseException) -> Iterator[Frame]:
    """The calls inside xacro that led to the first exception, outermost first."""
    while True:
        step = error.__traceback__
        while step is not None:
            frame = step.tb_frame
            if frame.f_globals.get("__name__") == "xacro":
                yield frame.f_code.co_name, frame.f_locals
            step = step.tb_next
        wrapped = getattr(error, "exc", None)
        if not isinstance(wrapped, BaseException):
            return
        error = wrapped


def _place(function: str, known: Mapping[str, Any]) -> dict[str, Any]:
    """What a call was expanding; empty where this function does not know."""
    if function == "_resolve_" and isinstance(known.get("self"), dict):
        raw = dict.get(known["self"], known.get("key"))
        return {"name": known.get("key"), "raw": raw if isinstance(raw, str) else None}
    if function == "eval_default_arg" and known.get("macro") is not None:
        return {"node": known["macro"].body, "attribute": "params"}
    if function in {"grab_property", "grab_macro", "process_include"}:
        return {"node": known.get("elt")}
    if function == "handle_macro_call":
        in_parameters = "block" not in known and known.get("params") is not None
        return _of_attribute(known) if in_parameters else {"node": known.get("node")}
    if function == "eval_all":  # which evaluates the attributes first, then what is inside
        return {"node": known.get("node")} if "next" in known else _of_attribute(known)
    return {}


def _of_attribute(known: Mapping[str, Any]) -> dict[str, Any]:
    return {"node": known.get("node"), "attribute": known.get("name"), "raw": known.get("value")}


def _expression(frames: list[Frame]) -> dict[str, Any]:
    """The innermost expression with the values of its names, and all names that it may use."""
    for function, known in reversed(frames):
        if function == "handle_expr":
            expression, symbols = known.get("s"), known.get("symbols")
            return {
                "expression": expression,
                "values": {
                    name: dict.__getitem__(scope, name)
                    for name in _names_in(str(expression))
                    for scope in [_scope_of(name, symbols)]
                    if scope is not None
                },
                "names": (*_keys(symbols), *map(str, getattr(symbols, "root", ()))),
            }
    return {}


def _names_in(expression: str) -> list[str]:
    try:
        tree = ast.parse(expression.strip(), mode="eval")
    except (SyntaxError, ValueError):
        return []
    found = [(node.col_offset, node.id) for node in ast.walk(tree) if isinstance(node, ast.Name)]
    return [name for _, name in dict.fromkeys(sorted(found))]


def _scopes(symbols: Any) -> Iterator[dict[str, Any]]:
    """The tables of a name's scope and of those around it, without xacro's own symbols."""
    for _ in range(MOST_SCOPES):
        if not isinstance(symbols, dict) or not hasattr(symbols, "parent"):
            return
        yield symbols
        symbols = symbols.parent


def _scope_of(name: str, symbols: Any) -> dict[str, Any] | None:
    return next((scope for scope in _scopes(symbols) if dict.__contains__(scope, name)), None)


def _keys(table: Any) -> tuple[str, ...]:
    names = [str(name) for scope in _scopes(table) for name in dict.keys(scope)]
    return tuple(name for name in dict.fromkeys(names) if not name.startswith("*"))


def _all(frames: list[Frame], variable: str) -> Iterator[Any]:
    """The values of a variable, innermost call first."""
    for _, known in reversed(frames):
        if known.get(variable) is not None:
            yield known[variable]


def _files(frames: list[Frame], node: Any, read: Iterable[str | None]) -> Iterator[str]:
    """Files that the node may be written in, likeliest first."""
    top = node
    while getattr(top, "parentNode", None) is not None:
        top = top.parentNode
    for opened in _all(frames, "inp"):  # that could not be read
        name = getattr(opened, "name", None)
        if isinstance(name, (str, os.PathLike)):
            yield os.fspath(name)
    for known in (node, *_all(frames, "node")):
        file = getattr(getattr(known, "ownerDocument", None), "wsgen_file", None)  # see `Watch`
        if file is not None:
            yield file
    if getattr(top, "tagName", None) == "xacro:macro":
        for macro in _all(frames, "m"):
            yield from (file for file in getattr(macro, "history", [[]])[-1][-1:] if file)
    yield from (file for file in read if file)
