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
from wsgen.description.xacro_names import USUAL, advice, message_of
from wsgen.description.xacro_place import Place, Sources, find
from wsgen.description.xacro_trace import Trace, trace

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

Fault = dict[str, Any]

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
    return {
        "message": f"not well-formed XML: {error}",
        "file": found.files[0] if found.files else None,
        "line": error.lineno,
        "element": None,
        "hint": "Look at this line and the one before it: tags, quotes, '&' and '<'.",
    }


def _encoding(found: Trace, _: Sources) -> Fault | None:
    if not isinstance(found.cause, UnicodeDecodeError) or not found.files:
        return None
    try:  # again, because the exception counts from the piece that was read
        Path(found.files[0]).read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        return {
            "message": f"the byte 0x{error.object[error.start]:02x} is no UTF-8",
            "file": found.files[0],
            "line": error.object.count(b"\n", 0, error.start) + 1,
            "element": None,
            "hint": "Save the file in UTF-8; it is in another encoding, Latin-1 perhaps.",
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
    name = str(getattr(found.cause, "name", found.cause))
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
    _markup,
    _encoding,
    _file,
    _package,
    _circle,
    xacro_names.of_name,
    xacro_names.of_argument,
    xacro_names.of_macro,
    xacro_names.of_expression,
)
