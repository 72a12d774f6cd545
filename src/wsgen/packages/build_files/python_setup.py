"""What setup.py and setup.cfg of an ament_python package say, and what they install."""

from __future__ import annotations

import ast
import os
import posixpath
import re
import sys
import warnings
from configparser import ConfigParser, Error
from dataclasses import field
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

from wsgen.model.build_facts import BuildFacts, Executable, InstalledFile, PythonPackage
from wsgen.packages.build_files.python_values import (
    UNKNOWN,
    Evaluator,
    Glob,
    StepsError,
    find_packages,
    items_of,
    line_of,
)
from wsgen.packages.source_shares import INDEX
from wsgen.text.files import read_regular, read_regular_text
from wsgen.text.pythontree import parse_anew
from wsgen.text.suggestions import nearest
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator


SIZE_LIMIT = 2**20  # bytes; build files are written by hand


CONSOLE_SCRIPTS = "console_scripts"
SURELY = 0.85  # so alike, as difflib counts, are a name and the one that it misspells


@dataclass(frozen=True, kw_only=True)
class DataFile:
    """A file in data_files."""

    folder: str  # as it is written: below the prefix
    name: str  # as it is written: below the folder of setup.py
    line: int


@dataclass(frozen=True, kw_only=True)
class Script:
    """An entry point of console_scripts."""

    name: str  # "" where setuptools cannot read it: `target` is the whole text
    target: str  # module:function
    file: Path
    line: int


@dataclass(frozen=True, kw_only=True)
class Setup:
    """What is known of the call of setup()."""

    file: Path
    syntax_error: tuple[int, str] | None = None
    call_line: int | None = None  # None: setup() is not called, as far as it can be seen
    keyword_lines: dict[str, int] = field(default_factory=dict)
    name: str | None = None  # None: not known
    data_files: tuple[DataFile, ...] = ()
    scripts: tuple[Script, ...] = ()
    scripts_group: str = CONSOLE_SCRIPTS  # their key in entry_points, as it is written
    script_files: tuple[tuple[str, int], ...] = ()  # of `scripts`
    packages: tuple[tuple[str, int], ...] | None = None  # None: not known
    modules: tuple[tuple[str, int], ...] = ()
    package_folders: dict[str, str] = field(default_factory=dict)  # package_dir
    globs: tuple[Glob, ...] = ()
    install_scripts: str | None = None  # of setup.cfg
    calls_nothing: bool = False  # surely not even setup()
    is_whole: bool = True  # False: data_files has more than can be known

    def line_of(self, *keywords: str) -> int | None:
        """The line of the first of the arguments that there is, or of the call."""
        lines = (self.keyword_lines[name] for name in keywords if name in self.keyword_lines)
        return next(lines, self.call_line)


class Configuration:
    """setup.cfg, with lines."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.exists = file.is_file()
        self._sections = ConfigParser(interpolation=None)
        self._lines: list[str] = []
        self.mistake: tuple[int, str] | None = None
        if self.exists:
            try:
                text = read_regular_text(file, errors="replace")
                self._lines = text.splitlines()
                self._sections.read_string(text)
            except OSError:
                self.exists = False
            except Error as error:
                found = re.search(r"\[line:? +(\d+)\]", str(error))
                self.mistake = (int(found[1]) if found else 1, error.message.splitlines()[0])

    def get(self, section: str, *names: str) -> str | None:
        """The value of an option that has one of these names."""
        if self.mistake is not None:
            return None
        for name in names:
            value = self._sections.get(section, name, fallback=None)
            if value is not None:
                return value.strip()
        return None

    def items(self, section: str) -> list[tuple[str, str]]:
        """The options of a section."""
        if self.mistake is not None or not self._sections.has_section(section):
            return []
        return self._sections.items(section)

    def line_with(self, text: str) -> int | None:
        """The 1-based line that begins with a text."""
        return next(
            (n for n, line in enumerate(self._lines, 1) if line.strip().startswith(text)), None
        )


def parse(file: Path) -> ast.Module:
    """The syntax tree of a file of Python; warnings are for who runs it.

    Raises:
        SyntaxError: It is not Python.
        OSError, ValueError, RecursionError, MemoryError: It cannot be read.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        tree: ast.Module = parse_anew(read_regular(file, SIZE_LIMIT))
        return tree


def read_setup(folder: Path) -> tuple[Setup, Configuration]:
    """Read setup.py and setup.cfg of a folder."""
    file = folder / "setup.py"
    configuration = Configuration(folder / "setup.cfg")
    try:
        tree = parse(file)
    except SyntaxError as error:
        line = error.lineno or 1
        return Setup(file=file, syntax_error=(line, error.msg), is_whole=False), configuration
    except (OSError, ValueError, RecursionError, MemoryError):
        return Setup(file=file, is_whole=False), configuration
    evaluator = Evaluator(file)
    is_whole = True
    try:
        evaluator.run(tree)
    except (StepsError, RecursionError):
        is_whole = False
    except Exception:  # noqa: BLE001  a return outside of a function, and the like
        is_whole = False
    if not evaluator.calls:
        return (
            Setup(
                file=file,
                is_whole=False,
                globs=tuple(evaluator.globs),
                calls_nothing=_calls_nothing(tree),
            ),
            configuration,
        )
    line, arguments, lines, has_all = evaluator.calls[-1]
    has_one = len(evaluator.calls) == 1
    return (
        _make(
            Arguments(arguments, lines, line),
            configuration,
            file,
            globs=tuple(evaluator.globs),
            is_whole=is_whole and has_all and has_one,
        ),
        configuration,
    )


def _calls_nothing(tree: ast.Module) -> bool:
    """Whether a file surely does not call setup(): no call, and no module that may have one."""
    known = {*sys.stdlib_module_names, "setuptools"}
    for node in ast.walk(tree):
        if isinstance(node, (ast.Call, ast.FunctionDef, ast.ClassDef)):
            return False
        names = (
            [alias.name for alias in node.names]
            if isinstance(node, ast.Import)
            else [f"{'.' * node.level}{node.module or ''}"]
            if isinstance(node, ast.ImportFrom)
            else []
        )
        if any(name.partition(".")[0] not in known for name in names):
            return False
    return True


class Arguments:
    """The keyword arguments of setup()."""

    def __init__(self, values: dict[str, Any], lines: dict[str, int], line: int) -> None:
        self.values = values
        self.lines = lines
        self.line = line

    def line_of(self, name: str) -> int:
        """The line of an argument, or of the call."""
        return self.lines.get(name, self.line)


def _make(
    arguments: Arguments,
    configuration: Configuration,
    file: Path,
    *,
    globs: tuple[Glob, ...],
    is_whole: bool,
) -> Setup:
    files: list[DataFile] = []
    has_all = _read_data_files(arguments, files)
    for folder, names in configuration.items("options.data_files"):
        line = configuration.line_with(folder) or 1
        files += [DataFile(folder=folder, name=name, line=line) for name in names.split()]
    name = arguments.values.get("name", configuration.get("metadata", "name"))
    folders = arguments.values.get("package_dir", {})
    has_all = has_all and not (configuration.get("options", "data_files"))
    return Setup(
        file=file,
        call_line=arguments.line,
        keyword_lines=arguments.lines,
        name=name if isinstance(name, str) else None,
        data_files=tuple(files),
        scripts=tuple(_read_scripts(arguments, configuration, file)),
        scripts_group=_group_of_scripts(arguments.values.get("entry_points")),
        script_files=_read_texts(arguments, "scripts") or (),
        packages=_read_packages(arguments, configuration, file.parent),
        modules=_read_texts(arguments, "py_modules") or (),
        package_folders={
            key: value
            for key, value in (folders.items() if isinstance(folders, dict) else ())
            if isinstance(key, str) and isinstance(value, str)
        },
        globs=globs,
        install_scripts=configuration.get("install", "install_scripts", "install-scripts"),
        is_whole=is_whole and has_all,
    )


def _read_data_files(arguments: Arguments, files: list[DataFile]) -> bool:
    """Add the files; False if there are others that are not known."""
    line = arguments.line_of("data_files")
    rows = items_of(arguments.values.get("data_files", []) or [])
    if rows is None:
        return False
    has_all = True
    for row in rows:
        if isinstance(row, (str, PurePath)):
            files.append(DataFile(folder="", name=str(row), line=line_of(row, line)))
            continue
        if not isinstance(row, (tuple, list)) or len(row) != len(("folder", "names")):
            has_all = False
            continue
        folder, names = row[0], items_of(row[1]) if not isinstance(row[1], str) else None
        if not isinstance(folder, (str, PurePath)) or names is None:
            has_all = False
            continue
        place = line_of(row, line_of(folder, line))
        for name in names:
            if isinstance(name, (str, PurePath)):
                files.append(
                    DataFile(folder=str(folder), name=str(name), line=line_of(name, place))
                )
            else:
                has_all = False
    return has_all


def _group_of_scripts(points: object) -> str:
    """The key of the console scripts, also a misspelled one."""
    if not isinstance(points, dict) or CONSOLE_SCRIPTS in points:
        return CONSOLE_SCRIPTS
    names = [key for key in points if isinstance(key, str) and key != "gui_scripts"]
    return nearest(CONSOLE_SCRIPTS, names, cutoff=SURELY) or CONSOLE_SCRIPTS


def _read_scripts(
    arguments: Arguments, configuration: Configuration, file: Path
) -> Iterator[Script]:
    points = arguments.values.get("entry_points")
    line = arguments.line_of("entry_points")
    texts: Any = []
    if isinstance(points, dict):
        texts = points.get(_group_of_scripts(points), [])
    elif isinstance(points, str):
        texts = _section_of(points)
    if isinstance(texts, str):
        texts = texts.splitlines()
    for text in items_of(texts) or []:
        name, equals, target = str(text).partition("=")
        if isinstance(text, str) and equals and name.strip():
            target = target.partition("[")[0].strip()
            yield Script(name=name.strip(), target=target, file=file, line=line_of(text, line))
        elif isinstance(text, str) and ":" in text and not equals:
            yield Script(name="", target=text.strip(), file=file, line=line_of(text, line))
    for text in (configuration.get("options.entry_points", "console_scripts") or "").splitlines():
        name, equals, target = text.partition("=")
        if equals:
            yield Script(
                name=name.strip(),
                target=target.partition("[")[0].strip(),
                file=configuration.file,
                line=configuration.line_with(name.strip()) or 1,
            )


def _section_of(text: str) -> list[str]:
    """The lines below [console_scripts]."""
    lines: list[str] = []
    is_inside = False
    for line in text.splitlines():
        if line.strip().startswith("["):
            is_inside = line.strip() == "[console_scripts]"
        elif is_inside and line.strip():
            lines.append(line)
    return lines


def _read_packages(
    arguments: Arguments, configuration: Configuration, folder: Path
) -> tuple[tuple[str, int], ...] | None:
    if "packages" in arguments.values:
        return _read_texts(arguments, "packages")
    written = configuration.get("options", "packages")
    line = arguments.line
    if written is None:
        is_found = "py_modules" not in arguments.values and "ext_modules" not in arguments.values
        return None if is_found else ()  # setuptools looks for packages where none is named
    if written.startswith(("find:", "find_namespace:")):
        where = configuration.get("options.packages.find", "where") or "."
        names = find_packages(os.path.join(folder, where), marker=written.startswith("find:"))
        return tuple((name, line) for name in names)
    return tuple((name, line) for name in re.split(r"[,\s]+", written) if name)


def _read_texts(arguments: Arguments, name: str) -> tuple[tuple[str, int], ...] | None:
    values = items_of(arguments.values.get(name, []) or [])
    line = arguments.line_of(name)
    if values is None or UNKNOWN in values:
        return None
    return tuple(
        (str(one), line_of(one, line)) for one in values if isinstance(one, (str, PurePath))
    )


def folder_of(package: str, setup: Setup) -> str:
    """The folder of a Python package, as package_dir of setuptools says it."""
    parts = package.split(".")
    for length in range(len(parts), -1, -1):
        folder = setup.package_folders.get(".".join(parts[:length]))
        if folder is not None:
            return os.path.join(folder, *parts[length:])
    return os.path.join(*parts)


def python_facts(setup: Setup, source: Path, name: str) -> BuildFacts:
    """What setup.py and setup.cfg have colcon install."""
    line = setup.call_line or 1
    # colcon installs both where data_files does not have them.
    installed = {
        f"{INDEX}/{name}": InstalledFile(
            source=None, destination=f"{INDEX}/{name}", file=setup.file, line=line
        ),
        f"share/{name}/package.xml": InstalledFile(
            source=source / "package.xml",
            destination=f"share/{name}/package.xml",
            file=setup.file,
            line=line,
        ),
    }
    for one in setup.data_files:
        path = source / one.name
        place = posixpath.normpath(posixpath.join(one.folder, path.name))
        if path.is_file() and not place.startswith(("/", "..")):
            installed[place] = InstalledFile(
                source=Path(os.path.normpath(path)),
                destination=place,
                file=setup.file,
                line=one.line,
            )
    executables: list[Executable] = []
    if installs_scripts_for_ros(setup, name):
        executables += [
            Executable(name=one.name, file=one.file, line=one.line, entry_point=one.target)
            for one in setup.scripts
            if one.name and setup.scripts_group == CONSOLE_SCRIPTS
        ]
        executables += [
            Executable(name=os.path.basename(file), file=setup.file, line=at, source=source / file)
            for file, at in setup.script_files
        ]
    executables += [
        Executable(
            name=posixpath.basename(one.destination),
            file=one.file,
            line=one.line,
            source=one.source,
        )
        for one in installed.values()
        if posixpath.dirname(one.destination) == f"lib/{name}"
        and one.source is not None
        and os.access(one.source, os.X_OK)
    ]
    return BuildFacts(
        build_file=setup.file,
        installed=tuple(installed.values()),
        executables=tuple(executables),
        python_packages=tuple(_python_packages(setup, source)),
        is_whole=setup.is_whole and setup.call_line is not None,
    )


def installs_scripts_for_ros(setup: Setup, name: str) -> bool:
    """Whether setup.cfg has setuptools write scripts to lib/PACKAGE."""
    place = (setup.install_scripts or "").replace("$base/", "").rstrip("/")
    return place == f"lib/{name}"


def _python_packages(setup: Setup, source: Path) -> Iterator[PythonPackage]:
    for package, line in setup.packages or ():
        folder = source / folder_of(package, setup)
        if folder.is_dir():
            yield PythonPackage(name=package, source=folder, file=setup.file, line=line)
    for module, line in setup.modules:
        file = source / setup.package_folders.get("", "") / f"{module.replace('.', '/')}.py"
        if file.is_file():
            yield PythonPackage(name=module, source=file, file=setup.file, line=line)
