"""Generate and compile the messages of a package of the workspace: a command that CMake runs.

    python -m wsgen.ros.environment.workspace_messages --package NAME --output FOLDER
        --dependencies A,B --ros PREFIX:PREFIX BASE:msg/NAME.msg ...

The first prefix is that of ROS; packages of the workspace come from AMENT_PREFIX_PATH, which colcon
sets. What is wrong in a file is written to standard error.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import WsgenError
from wsgen.ros.environment.environment import find_compiler, variables_of
from wsgen.ros.environment.interfaces import ADDED, OTHER_PACKAGE
from wsgen.ros.environment.messages import MessagePackage, build_messages
from wsgen.text.files import read_regular_text
from wsgen.text.suggestions import did_you_mean, misspelled_as, nearest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

COMMENT = re.compile(r"#.*")
OF_IDL = re.compile(r'#include\s+"([a-z][a-z0-9_]*)/')
# A field or a constant, and its type: float32[<=3] sizes, geometry_msgs/Pose pose.
FIELD = re.compile(
    r"(?:(?P<package>[a-z]\w*)/)?(?:msg/)?(?P<name>[A-Za-z]\w*)(?:<=\d+)?(?:\[[^\]]*\])?\s+[A-Za-z]"
)
PRIMITIVES = frozenset(
    (
        *("bool", "byte", "char", "float32", "float64", "string", "wstring"),
        *("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"),
        *("duration", "time"),  # which rosidl_adapter takes as well
    )
)
# What other languages call a type.
MEANT = {"double": "float64", "int": "int32", "uint": "uint32", "long": "int64", "str": "string"}
DEPENDENCY = re.compile(r"<\w*depend[^>]*>\s*([\w-]+)\s*</")


def main() -> int:
    """Build what the arguments say; gives the exit code."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--package", required=True)
    parser.add_argument("--output", required=True, type=Path)
    parser.add_argument("--dependencies", required=True)
    parser.add_argument("--ros", required=True)
    parser.add_argument("names", nargs="+")
    given = parser.parse_args()
    pairs = [name.rpartition(":") for name in given.names]
    try:
        declared = {name for name in given.dependencies.split(",") if name}
        ros, *messages = map(Path, given.ros.split(os.pathsep))
        overlays = [Path(entry) for entry in _split("AMENT_PREFIX_PATH")]
        prefixes = _with_messages([ros, *messages, *overlays])
        allowed = _closure(declared, prefixes)
        uses: set[str] = set()
        mistakes = []
        for base, _, name in pairs:
            file = Path(base, name)
            uses.update(package for _, package in _used(file) if package in allowed)
            mistakes += [
                f"{file}:{line}: error: {text}"
                for line, text in mistakes_in(file, given.package, allowed, prefixes)
            ]
            uses.update(ADDED.get(name.partition("/")[0], ()))
        absent = sorted(name for name in uses if not any(_has(one, name) for one in prefixes))
        mistakes += [
            f"error: {name} is neither in the workspace nor in the ROS of PyPI." for name in absent
        ]
        if mistakes:
            sys.stderr.write("".join(f"{mistake}\n" for mistake in mistakes))
            return 1
        shutil.rmtree(given.output, ignore_errors=True)
        environment = {**os.environ, **variables_of([*messages, ros], os.environ)}
        sources = _gathered(given.output / "sources", pairs)
        build_messages(
            MessagePackage(
                name=given.package,
                sources=given.output / "sources",
                files=tuple(sources),
                uses=frozenset(uses - {given.package}),
            ),
            given.output,
            prefixes=prefixes,
            compiler=find_compiler(os.environ, lambda _: None),
            environment=environment,
            listener=None,
        )
        shutil.rmtree(given.output / "sources")
    except WsgenError as error:
        sys.stderr.write(f"error: {error.message}\n{error.hint}\n")
        return 1
    return 0


def _gathered(folder: Path, pairs: list[tuple[str, str, str]]) -> list[Path]:
    """Copy interfaces into one folder; CMake may name several."""
    files = []
    for base, _, name in pairs:
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(Path(base, name), file)
        files.append(file)
    return files


def mistakes_in(
    file: Path, package: str, allowed: Collection[str], prefixes: Sequence[Path]
) -> Iterator[tuple[int, str]]:
    """Say which types in the file of an interface nobody has, each with the 1-based line.

    Args:
        file: It.
        package: That it belongs to.
        allowed: The packages whose types it may use.
        prefixes: Where these are.
    """
    for line, used in _used(file):
        if used not in {package, *allowed}:
            meant = misspelled_as(used, allowed)
            question = f" {did_you_mean(meant)}" if meant else ""
            declared = "among DEPENDENCIES of rosidl_generate_interfaces() in CMakeLists.txt"
            yield line, f"{used} is used, but it is not {declared}.{question}"
    if file.suffix == ".idl":
        return
    text = read_regular_text(file, errors="replace")
    for number, written in enumerate(text.splitlines(), start=1):
        match = FIELD.match(COMMENT.sub("", written).strip())
        if match is None:
            continue
        of, name = match["package"], match["name"]
        if of is None and name[0].islower() and name not in PRIMITIVES:
            meant = MEANT.get(name) or nearest(name, PRIMITIVES)
            yield number, f"{name} is not a type.{f' {did_you_mean(meant)}' if meant else ''}"
        elif of in allowed and of != package:
            folders = (prefix / "share" / of / "msg" for prefix in prefixes)
            known = {one.stem for folder in folders for one in folder.glob("*.idl")}
            if known and name not in known:
                meant = nearest(name, known)
                question = f" {did_you_mean(f'{of}/{meant}')}" if meant else ""
                yield number, f"{of} has no message {name}.{question}"


def _used(file: Path) -> list[tuple[int, str]]:
    """List the packages whose types a file uses, each with the 1-based line."""
    text = read_regular_text(file, errors="replace")
    found = []
    for number, line in enumerate(text.splitlines(), start=1):
        if file.suffix == ".idl":
            match = OF_IDL.search(line)
        else:
            match = OTHER_PACKAGE.match(COMMENT.sub("", line).strip())
        if match:
            found.append((number, match[1]))
    return found


def _closure(packages: set[str], prefixes: list[Path]) -> set[str]:
    """Return packages of messages and what they depend on, as CMake passes it on."""
    found: set[str] = set()
    open_ = list(packages)
    while open_:
        name = open_.pop()
        if name in found:
            continue
        found.add(name)
        for prefix in prefixes:
            manifest = prefix / "share" / name / "package.xml"
            if _has(prefix, name) and manifest.is_file():
                open_ += DEPENDENCY.findall(read_regular_text(manifest, errors="replace"))
                break
    return found


def _has(prefix: Path, package: str) -> bool:
    return (prefix / "lib" / f"lib{package}__rosidl_generator_c.so").is_file()


def _with_messages(prefixes: list[Path]) -> list[Path]:
    """Leave out prefixes without messages, each but the first."""
    kept = [prefix for prefix in prefixes[1:] if (prefix / "include").is_dir()]
    return list(dict.fromkeys([prefixes[0], *kept]))


def _split(name: str) -> list[str]:
    return [entry for entry in os.environ.get(name, "").split(os.pathsep) if entry]


if __name__ == "__main__":
    sys.exit(main())
