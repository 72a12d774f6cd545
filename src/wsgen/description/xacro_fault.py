"""Explain what xacro found fault with: file, line, what is wrong, and what to do.

Each explainer looks at one kind of exception and gives a fault, or None where it is not its kind.
A fault has the key message, and where they are known file, line, element and hint; besides
`missing` (a file that is not there, and nothing of its package either) and `package` (one that is
not found).
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.parsers.expat import ExpatError

from wsgen.description import xacro_names
from wsgen.description.markup import SIZE_LIMIT, read_text, without_comments
from wsgen.description.xacro_names import USUAL, message_of
from wsgen.description.xacro_place import Place, Sources, find
from wsgen.description.xacro_trace import Trace, trace
from wsgen.files import irregular_kind, read_regular, save_as_utf8, wide_encoding
from wsgen.suggestions import advice
from wsgen.xmlsyntax import find_mistake

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

Fault = dict[str, Any]

XACRO = "http://www.ros.org/wiki/xacro"
PREFIX = re.compile(r"[<\s]([\w.-]+):[\w.-]+")  # of an element or attribute
ROOT = re.compile(r"<([\w.-]+)((?:\s[^<>]*)?)>")
PACKAGES = Path("share", "ament_index", "resource_index", "packages")  # below a prefix


def explain(error: BaseException, files: Iterable[str | None]) -> Fault | None:
    """The fault that an exception is about; None where xacro did not raise it.

    `files` are those that xacro has read, the one being expanded first.
    """
    found = trace(error, files)
    if found is None or isinstance(error, (SystemExit, KeyboardInterrupt)):
        return None
    sources = Sources(found.files)
    place = find(found, sources) or Place(found.files[0] if found.files else None)
    told: Fault | None = None
    for explainer in _EXPLAINERS:
        told = told or explainer(found, sources)
    fault = {
        "message": message_of(found),
        "file": place.file,
        "line": place.line,
        "element": _element(found),
        "hint": USUAL,
        **(told or {}),
    }
    return {key: value for key, value in fault.items() if value is not None}


def _element(found: Trace) -> str | None:
    if found.expression is not None:
        return f"${{{found.expression}}}"
    if found.name is not None:
        return f"xacro:property[@name='{found.name}']"
    return getattr(found.node, "tagName", None)


def _markup(found: Trace, _: Sources) -> Fault | None:
    error = found.cause
    if not isinstance(error, ExpatError):
        return None
    if "unbound prefix" in str(error) and found.files:
        return _undeclared_prefix(Path(found.files[0]), error.lineno)
    file = found.files[0] if found.files else None
    text = None if file is None else read_text(Path(file))
    mistake = None if text is None else find_mistake(text.encode(), "utf-8")
    return {
        "message": f"not well-formed XML: {mistake.message if mistake else error}",
        "file": file,
        "line": mistake.line if mistake else error.lineno,
        "element": None,
        "hint": mistake.hint
        if mistake
        else "Look at this line and the one before it: tags, quotes, '&' and '<'.",
    }


def _undeclared_prefix(file: Path, line: int) -> Fault | None:
    """A prefix that the root element does not declare; most often that of xacro itself."""
    text = without_comments(read_text(file) or "")
    used = PREFIX.search(text.split("\n", line - 1)[-1])
    root = ROOT.search(text)
    if used is None or root is None:
        return None
    prefix, root_line = used[1], text.count("\n", 0, root.start()) + 1
    rest = " ".join(root[2].split())
    address = XACRO if prefix == "xacro" else "ADDRESS"
    start = f'<{root[1]} xmlns:{prefix}="{address}"' + (f" {rest}>" if rest else ">")
    return {
        "message": f"line {line} uses the prefix `{prefix}:`, and <{root[1]}> in line {root_line} "
        "does not declare it",
        "file": str(file),
        "line": root_line,
        "element": str(root[1]),
        "hint": f"Write line {root_line} as {start}",
    }


def _encoding(found: Trace, _: Sources) -> Fault | None:
    error = found.cause
    if not isinstance(error, (UnicodeDecodeError, ExpatError)) or not found.files:
        return None
    fault = {"file": found.files[0], "element": None}
    try:  # again, because the exception counts from the piece that was read
        data = read_regular(Path(found.files[0]), SIZE_LIMIT)
        wide = wide_encoding(data)
        if wide:
            message = f"it is in {wide}, and xacro reads UTF-8 alone"
            return {**fault, "message": message, "line": 1, "hint": save_as_utf8(wide)}
        data.decode("utf-8")
    except UnicodeDecodeError as again:
        return {
            **fault,
            "message": f"the byte 0x{again.object[again.start]:02x} is no UTF-8",
            "line": again.object.count(b"\n", 0, again.start) + 1,
            "hint": f"It is in another encoding, Latin-1 perhaps. {save_as_utf8('ISO-8859-1')}",
        }
    except OSError:
        pass
    return None


def _file(found: Trace, _: Sources) -> Fault | None:
    """A file that is included or loaded, or the first one."""
    error = found.cause
    if not isinstance(error, OSError) or not error.filename:
        return None
    path = os.path.normpath(os.fspath(error.filename))
    kind = irregular_kind(path)
    if kind is not None:
        return {
            "message": f"'{path}' is {kind}, not a regular file",
            "element": _element(found),
            "hint": "Name a regular file.",
        }
    share = re.match(r".*/share/[^/]+(?=/)", path)
    if not found.inside or (share and not Path(share[0]).is_dir()):
        return {"message": str(error), "missing": path}
    folder, name = Path(path).parent, Path(path).name
    while not folder.is_dir() and folder != folder.parent:
        folder, name = folder.parent, folder.name
    install = "Check the spelling. If it is right, let CMakeLists.txt install it, and build again."
    is_include = getattr(found.node, "tagName", None) == "xacro:include"
    return {
        "message": f"{(error.strerror or 'cannot be read').lower()}: '{path}'",
        "element": found.node.getAttribute("filename") if is_include else _element(found),
        "hint": advice(name, sorted(entry.name for entry in folder.iterdir()), install),
    }


def _package(found: Trace, _: Sources) -> Fault | None:
    if type(found.cause).__name__ != "PackageNotFoundError":
        return None
    # ament_index_python's has a sentence about the package in the place of its name.
    told = str(getattr(found.cause, "name", found.cause))
    quoted = re.search(r"package '([^']*)' not found", told)
    name = quoted[1] if quoted else told
    add = (
        f"Check the spelling. If it is right, add <exec_depend>{name}</exec_depend> to "
        "package.xml, and build it in this workspace or install it."
    )
    return {
        "message": f"the package '{name}' is not found",
        "package": name,
        "element": name,
        "hint": advice(name, _packages(), add),
    }


def _packages() -> list[str]:
    """The packages that the environment has."""
    names: list[str] = []
    for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        index = Path(prefix, PACKAGES)
        if index.is_dir():
            names += sorted(entry.name for entry in index.iterdir())
    return names


def _circle(found: Trace, _: Sources) -> Fault | None:
    if not isinstance(found.cause, RecursionError):
        return None
    return {
        "message": "it goes round in a circle: a macro calls itself, or a file includes itself, "
        "without end",
        "hint": "Put it into <xacro:if> with a condition that becomes false.",
    }


_EXPLAINERS: tuple[Callable[[Trace, Sources], Fault | None], ...] = (
    _encoding,
    _markup,
    _file,
    _package,
    _circle,
    xacro_names.of_attribute,
    xacro_names.of_command,
    xacro_names.of_name,
    xacro_names.of_argument,
    xacro_names.of_macro,
    xacro_names.of_expression,
)
