"""Where values of launch files are written, and which files an evaluation read; in the child.

Only who compares two launches asks for it, see `LaunchRequest.with_origins`.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import os
import shlex
import site
import stat
import sys
import sysconfig
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.isolation.child import scratch_folder
from wsgen.launching.record import RECORD
from wsgen.model.plan import FileRead
from wsgen.text.files import read_whole
from wsgen.text.yamlfile import merge_repeated

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator


_WSGEN = os.path.dirname(os.path.dirname(__file__))
_SYSTEM = ("/proc", "/sys")
_CODE = (".py", ".pyc", ".so", ".pyd")
_METADATA = (".dist-info", ".egg-info")
_CHUNK = 2**20  # bytes
_LARGEST = 2**30  # bytes; the evaluation has 30 s for everything
# The variables with folders in which Gazebo looks for a world that is given by its name.
_RESOURCE_PATHS = (
    "GZ_SIM_RESOURCE_PATH",
    "IGN_GAZEBO_RESOURCE_PATH",
    "GAZEBO_RESOURCE_PATH",
    "SDF_PATH",
)
_WORLDS = (".sdf", ".world")


def line_of_parameter(file: str, line: int, name: str) -> int:
    """The line of a parameter in the call at a line of a Python file, or the line itself."""
    found = line
    for call in _calls(file).get(line, ()):
        for written in _items(file, _keyword(call, "parameters")):
            found = _lines_of_dict(file, written, "").get(name, found)
    return found


def line_of_item(file: str, line: int, keyword: str, number: int) -> int:
    """The line of an item of a list that the call at a line is given, or the line itself."""
    for call in _calls(file).get(line, ()):
        items = _items(file, _keyword(call, keyword))
        if number < len(items) and not any(isinstance(one, ast.Starred) for one in items):
            return items[number].lineno
    return line


def _keyword(call: ast.Call, name: str) -> ast.expr | None:
    return next((one.value for one in call.keywords if one.arg == name), None)


def _items(file: str, written: ast.expr | None) -> list[ast.expr]:
    written = _resolve(file, written)
    return list(written.elts) if isinstance(written, (ast.List, ast.Tuple)) else []


def _resolve(file: str, written: ast.expr | None) -> ast.expr | None:
    """What a name stands for that one line of the file sets."""
    if isinstance(written, ast.Name):
        values = _assigned(file).get(written.id, [])
        return values[0] if len(values) == 1 else written
    return written


def _lines_of_dict(file: str, written: ast.expr, prefix: str) -> dict[str, int]:
    """The lines of the values of a dictionary, by the names of the parameters."""
    found: dict[str, int] = {}
    resolved = _resolve(file, written)
    if not isinstance(resolved, ast.Dict):
        return found
    for key, value in zip(resolved.keys, resolved.values, strict=True):
        if isinstance(key, ast.Constant) and isinstance(key.value, str):
            name = f"{prefix}{key.value}"
            found[name] = key.lineno
            if isinstance(value, ast.Dict):
                found.update(_lines_of_dict(file, value, f"{name}."))
    return found


@functools.cache
def _syntax(file: str) -> ast.AST:
    try:
        return ast.parse(read_whole(Path(file)))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):  # XML and YAML, too
        return ast.Module(body=[], type_ignores=[])


@functools.cache
def _calls(file: str) -> dict[int, list[ast.Call]]:
    found: dict[int, list[ast.Call]] = {}
    for node in ast.walk(_syntax(file)):
        if isinstance(node, ast.Call):
            found.setdefault(node.lineno, []).append(node)
    return found


@functools.cache
def _assigned(file: str) -> dict[str, list[ast.expr]]:
    found: dict[str, list[ast.expr]] = {}
    for node in ast.walk(_syntax(file)):
        if isinstance(node, ast.Assign):
            for target in node.targets:
                if isinstance(target, ast.Name):
                    found.setdefault(target.id, []).append(node.value)
    return found


@functools.cache
def key_lines(text: str, *, merges_repeated: bool) -> Any:
    """The mapping of a YAML file with the line of its key (1-based) in place of each value."""
    import yaml  # see launch.utilities.type_utils

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)(text)
    try:
        node = loader.get_single_node()
        if merges_repeated:
            merge_repeated(node)
        return {} if node is None else _key_lines(loader, node, {})
    except (yaml.YAMLError, ValueError, RecursionError):
        return {}
    finally:
        loader.dispose()


def _key_lines(loader: Any, node: Any, instead: Any) -> Any:
    """The lines in a mapping; `instead` for what is none."""
    if node.id != "mapping":
        return instead
    loader.flatten_mapping(node)
    return {
        loader.construct_object(key, deep=True): _key_lines(loader, value, key.start_mark.line + 1)
        for key, value in node.value
        if key.id == "scalar"
    }


def note_opened(path: object, mode: object, flags: object) -> None:
    """Note a file that is opened for reading; called for each that is opened in this process."""
    if isinstance(path, bytes):
        path = os.fsdecode(path)
    if not isinstance(path, (str, os.PathLike)):
        return  # a descriptor that was opened before
    reads = "r" in str(mode) or (mode is None and not int(str(flags or 0)) & os.O_WRONLY)
    if reads:
        RECORD.read.setdefault(os.path.abspath(path), "read")


def files_read() -> Iterator[FileRead]:
    """The files that the evaluation read and those that processes are given, by their paths."""
    uses = {path: use for path, use in list(RECORD.read.items()) if not _is_ours(path)}
    uses |= dict.fromkeys(_modules(), "module")
    uses |= {os.path.abspath(file): "launch file" for file in RECORD.launch_files}
    for text in _given_texts():
        for path in _paths(text):
            uses.setdefault(os.path.abspath(path), "given")
    for path in sorted(uses):
        if stat.S_ISREG(_mode(path)):
            yield FileRead(path=Path(path), use=uses[path], sha256=_sha256(path))


def _is_ours(path: str) -> bool:
    """Whether a file is one of wsgen, Python, the system, or the bookkeeping of packages."""
    is_code = path.endswith(_CODE)
    folders = (*_system_folders(), *_libraries()) if is_code else _system_folders()
    parts = path.split(os.sep)
    return (
        is_code  # those that were imported are listed as modules
        or path.startswith(tuple(f"{folder}{os.sep}" for folder in folders))
        or "ament_index" in parts
        or any(part.endswith(_METADATA) for part in parts)
    )


_PACKAGES = ("site-packages", "dist-packages")


@functools.cache
def _system_folders() -> tuple[str, ...]:
    scratch = scratch_folder()
    return (_WSGEN, *_SYSTEM, *([os.fspath(scratch)] if scratch else []))


@functools.cache
def _libraries() -> tuple[str, ...]:
    """Where Python has modules that are none of the user's workspace."""
    paths = {sysconfig.get_path(name) for name in ("stdlib", "platstdlib", "purelib", "platlib")}
    # A .pth file adds those of another environment; a sourced workspace has its own in PYTHONPATH.
    of_workspace = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    added = {one for one in sys.path if os.path.basename(one) in _PACKAGES} - {*of_workspace}
    return tuple({*paths, *site.getsitepackages(), *added})


def _modules() -> Iterator[str]:
    """The modules that the launch files imported, but for those of libraries."""
    known = tuple(f"{folder}{os.sep}" for folder in (_WSGEN, *_libraries()))
    for module in list(sys.modules.values()):
        file = getattr(module, "__file__", None)
        if isinstance(file, str) and file.endswith(".py"):
            path = os.path.abspath(file)
            if not path.startswith(known):
                yield path


def _given_texts() -> Iterator[str]:
    """The texts that processes and launch files which are not run are given."""
    for process in RECORD.processes:
        values: Iterable[Any] = (*process.parameters.values(), *process.arguments)
        for value in (*values, *(process.command or ())):
            yield from (item for item in _each(value) if isinstance(item, str))
    for include in RECORD.includes:
        yield from include.arguments.values()


def _each(value: Any) -> Iterable[Any]:
    return value if isinstance(value, list) else (value,)


def _paths(text: str) -> Iterator[str]:
    """The absolute paths in a text, and the files of worlds that it names."""
    if text.lstrip().startswith("<") or "\n" in text:
        return
    words = [text]
    with suppress(ValueError):  # a quote that is not closed
        words += shlex.split(text)
    for word in words:
        path = word.removeprefix("file://").partition(":=")[2] or word.removeprefix("file://")
        if os.path.isabs(path):
            yield path
        elif path.endswith(_WORLDS):
            yield from _in_resource_paths(path)


def _in_resource_paths(name: str) -> Iterator[str]:
    folders = [
        folder
        for variable in _RESOURCE_PATHS
        for folder in os.environ.get(variable, "").split(os.pathsep)
    ]
    for folder in filter(None, folders):
        for path in (os.path.join(folder, name), os.path.join(folder, "worlds", name)):
            if os.path.isfile(path):
                yield path
                return


def _mode(path: str) -> int:
    try:
        return os.stat(path).st_mode
    except (OSError, ValueError):  # removed, or a text with a null character
        return 0


def _sha256(path: str) -> str | None:
    digest = hashlib.sha256()
    try:
        if os.path.getsize(path) > _LARGEST:
            return None
        with open(path, "rb") as file:  # of thousands
            while chunk := file.read(_CHUNK):
                digest.update(chunk)
    except OSError:
        return None
    return digest.hexdigest()
