"""What is wrong with setup.py and setup.cfg of an ament_python package."""

from __future__ import annotations

import ast
import os
import posixpath
import re
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.packages.build_files.install_checks import (
    RESOURCES,
    WRONG_DESTINATION,
    find_elsewhere,
    find_resources,
    is_misplaced,
    uninstalled_folders,
)
from wsgen.packages.build_files.python_setup import (
    CONSOLE_SCRIPTS,
    folder_of,
    parse,
    python_facts,
    read_setup,
)
from wsgen.packages.source_shares import INDEX
from wsgen.text.suggestions import ask_for_nearest, did_you_mean, nearest
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts, PythonPackage
    from wsgen.packages.build_files.python_setup import Configuration, DataFile, Script, Setup
    from wsgen.packages.build_files.python_values import Glob


SETUP_FAILURE = Rule(
    code="BLD040",
    name="setup-failure",
    severity=Severity.ERROR,
    summary="`setup.py` or `setup.cfg` of a Python package stops with an error.",
    what="Runs setup.py once more where `colcon` does not pass on what it printed.",
    why="`colcon` runs setup.py to learn what to install, and does not build the package.",
    example="""setup(
    name=package_name
    version='0.1.0',
)""",
    instead="""setup(
    name=package_name,
    version='0.1.0',
)""",
)
MISSING_DATA_FILE = Rule(
    code="BLD041",
    name="missing-data-file",
    severity=Severity.ERROR,
    summary="`data_files` in setup.py names a file that cannot be installed.",
    why="The build stops where a file does not exist or is a folder, which `glob('urdf/*')` also "
    "returns, and where its path is absolute. Git does not keep empty folders, but "
    "it keeps the empty file `resource/PACKAGE`, if it was added.",
    example="('share/' + package_name + '/urdf', glob('urdf/*')),  # urdf/parts is a folder",
    instead="('share/' + package_name + '/urdf', glob('urdf/*.*')),",
)
MISSING_PYTHON_PACKAGE = Rule(
    code="BLD042",
    name="missing-python-package",
    severity=Severity.ERROR,
    summary="`setup.py` names a Python package or module that does not exist.",
    why="The build stops where the folder of `packages` or the file of `py_modules` is missing.",
    example="packages=['my_robot'],  # without my_robot/__init__.py",
    instead="mkdir my_robot; touch my_robot/__init__.py",
)
BROKEN_SCRIPT = Rule(
    code="BLD043",
    name="broken-console-script",
    severity=Severity.WARNING,
    severity_varies="an error where setuptools cannot read the script, and stops; of `wsgen check` "
    "also where its module or function does not exist, and where a launch file starts it",
    summary="`ros2 run` and launch files do not find a console script, or it cannot start.",
    what="Looks for the scripts of `entry_points` in `lib/PACKAGE` of the install space, and for "
    "their modules and functions in what was installed.",
    why="ROS looks for executables in `lib/PACKAGE`; setuptools writes them to `bin`, where "
    "`setup.cfg` does not say otherwise. A script without its function ends with an ImportError.",
    example="[develop]\nscript_dir=$base/lib/my_robot  # setup.cfg without [install]",
    instead="""[develop]
script_dir=$base/lib/my_robot
[install]
install_scripts=$base/lib/my_robot""",
)
UNKNOWN_SETUP_OPTION = Rule(
    code="BLD044",
    name="unknown-setup-option",
    severity=Severity.WARNING,
    severity_varies="information where only a later setuptools will not know it",
    summary="The build ignores, or will ignore, an unknown option in `setup.py` or `setup.cfg`.",
    what="Reads the warnings of setuptools, which `colcon` does not show.",
    why="The option has no effect, and nothing of what it lists is installed.",
    example="setup(data_file=[('share/' + package_name, ['package.xml'])])",
    instead="setup(data_files=[('share/' + package_name, ['package.xml'])])",
)
MISSING_MARKER = Rule(
    code="BLD063",
    name="missing-marker",
    severity=Severity.WARNING,
    summary="`data_files` in setup.py lacks the marker of the package, or its package.xml.",
    what="Looks in data_files for `resource/PACKAGE` in "
    "`share/ament_index/resource_index/packages`, and for package.xml in `share/PACKAGE`.",
    why="ROS knows a package by both files. `colcon` installs them itself today, warns about it, "
    "and will cease to.",
    example="data_files=[('share/' + package_name, ['package.xml'])],",
    instead="""data_files=[
    ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
    ('share/' + package_name, ['package.xml']),
],""",
)
DIFFERENT_SETUP_NAME = Rule(
    code="BLD064",
    name="different-setup-name",
    severity=Severity.WARNING,
    summary="`package.xml` and setup.py name the package differently.",
    why="ROS knows the package by the name in package.xml. Everything that setup.py derives from "
    "its own name, such as the share folder, belongs to another package.",
    example="package_name = 'my_robots'  # package.xml: <name>my_robot</name>",
    instead="package_name = 'my_robot'",
)
EMPTY_GLOB = Rule(
    code="BLD065",
    name="empty-glob",
    severity=Severity.WARNING,
    summary="A pattern in setup.py matches no file of a folder that has files.",
    what="Looks at glob() where the folder of the pattern exists and has files.",
    why="`glob()` returns an empty list, so that nothing is installed, and the build does not "
    "report it.",
    example="glob('launch/*.launch.py')  # the file is launch/robot_launch.py",
    instead="glob('launch/*launch.[pxy][yma]*')",
)

SETUP_KEYWORDS = frozenset(
    (
        *("author", "author_email", "classifiers", "cmdclass", "data_files", "description"),
        *("entry_points", "extras_require", "include_package_data", "install_requires"),
        *("keywords", "license", "long_description", "maintainer", "maintainer_email", "name"),
        *("package_data", "package_dir", "packages", "py_modules", "python_requires", "scripts"),
        *("url", "version", "zip_safe"),
    )
)
FORMER_KEYWORDS = frozenset({"setup_requires", "test_suite", "tests_require", "use_2to3"})
OTHER_KEYWORDS = frozenset(
    {
        *("dependency_links", "download_url", "eager_resources", "exclude_package_data"),
        *("ext_modules", "ext_package", "features", "license_files", "namespace_packages"),
        *("long_description_content_type", "options", "platforms", "project_urls", "provides"),
        *("license_file", "obsoletes", "requires", "script_args", "script_name", "test_loader"),
        *("libraries", "headers", "include_dirs", "package_name", "distclass", "ext_modules"),
    }
)


def read_python(source: Path, name: str) -> tuple[BuildFacts, tuple[Diagnostic, ...]]:
    """Read setup.py and setup.cfg of a package, and report what is wrong with them."""
    setup, configuration = read_setup(source)
    facts = python_facts(setup, source, name)
    return facts, tuple(check_setup(setup, configuration, facts, source, name))


def check_setup(
    setup: Setup, configuration: Configuration, facts: BuildFacts, source: Path, package: str
) -> Iterator[Diagnostic]:
    """Check what setup.py and setup.cfg say."""
    yield from syntax(setup, configuration, package)
    if setup.calls_nothing:
        yield SETUP_FAILURE.at(
            setup.file,
            1,
            package,
            message=f"{package}: setup.py does not call setup(), so that colcon finds nothing to "
            "install.",
            hint="Restore it (git checkout setup.py), or copy one from a package of `wsgen new` "
            "or `ros2 pkg create --build-type ament_python`.",
        )
    if setup.call_line is None:
        return
    yield from name(setup, package)
    yield from keywords(setup, package)
    yield from data_files(setup, source, package)
    if setup.is_whole:
        yield from markers(setup, package)
    yield from globs(setup.globs, setup.file, source)
    yield from python_packages(setup, source, package)
    yield from script_folder(setup, configuration, package)
    yield from entry_points(setup.scripts, facts.python_packages, setup, source, package)
    misplaced: set[str] = set()
    for found, top in destinations(setup, package):
        misplaced.add(top)
        yield found
    if facts.is_whole:
        yield from uninstalled_folders(
            find_resources(source),
            facts,
            package,
            misplaced,
            line=setup.line_of("data_files"),
            how=lambda folder: (
                f"Add to data_files in setup.py: ('share/{package}/{folder}', glob('{folder}/*'))"
            ),
        )


def syntax(setup: Setup, configuration: Configuration, package: str) -> Iterator[Diagnostic]:
    """Report what Python or setuptools cannot read."""
    if setup.syntax_error is not None:
        line, message = setup.syntax_error
        yield SETUP_FAILURE.at(
            setup.file,
            line,
            package,
            message=f"{package}: setup.py is not valid Python: {message.rstrip('.')}.",
            hint="Look there and in the line before for a missing comma, bracket or quotation "
            "mark.",
        )
    if configuration.mistake is not None:
        line, message = configuration.mistake
        yield SETUP_FAILURE.at(
            configuration.file,
            line,
            package,
            message=f"{package}: setup.cfg cannot be read: {message.rstrip('.')}.",
            hint=f"Write sections as [install] and options as install_scripts=$base/lib/{package}.",
        )


def name(setup: Setup, package: str) -> Iterator[Diagnostic]:
    """Compare the name with that of package.xml."""
    given = setup.name
    if given is not None and given.replace("-", "_") != package.replace("-", "_"):
        yield DIFFERENT_SETUP_NAME.at(
            setup.file,
            getattr(given, "line", setup.line_of("name")),
            package,
            message=f"setup.py names the package {given}, but package.xml names it {package}.",
            hint=f"Write the name of package.xml: '{package}'",
        )


def keywords(setup: Setup, package: str) -> Iterator[Diagnostic]:
    """Report arguments that setuptools ignores."""
    for keyword, line in setup.keyword_lines.items():
        if keyword in SETUP_KEYWORDS | FORMER_KEYWORDS | OTHER_KEYWORDS:
            continue
        meant = nearest(keyword, SETUP_KEYWORDS, cutoff=0.8)
        if meant is not None:
            yield word_keyword(keyword, meant, setup.file, line, package)


def word_keyword(
    keyword: str, meant: str, file: Path, line: int | None, package: str
) -> Diagnostic:
    """Report an argument that setuptools does not know."""
    return UNKNOWN_SETUP_OPTION.at(
        file,
        line,
        package,
        message=f"{package}: setuptools does not know the argument {keyword} of setup(), and "
        "ignores it.",
        hint=did_you_mean(meant),
    )


def data_files(setup: Setup, source: Path, package: str) -> Iterator[Diagnostic]:
    """Report files in data_files that cannot be installed."""
    for one in setup.data_files:
        if os.path.isabs(one.name):
            if not one.name.startswith(f"{source}/"):
                continue
            yield MISSING_DATA_FILE.at(
                setup.file,
                one.line,
                package,
                message=f"{package}: data_files has the absolute path {one.name}, which colcon "
                "refuses.",
                hint="Write paths relative to the folder of setup.py: glob('launch/*.launch.py')",
            )
        elif not (source / one.name).is_file():
            yield word_data_file(one.name, source, setup.file, one.line, package)


def word_data_file(
    name: str, source: Path, file: Path, line: int | None, package: str
) -> Diagnostic:
    """Report a file of data_files that does not exist, or is a folder."""
    path = source / name
    folder, _, base = name.rpartition("/")
    if path.is_dir():
        message = f"data_files names {name}, which is a folder; only files are allowed."
        hint = f"Write a pattern that matches only files, and a separate entry for {name}."
    else:
        beside = [entry.name for entry in path.parent.iterdir()] if path.parent.is_dir() else []
        message = f"data_files names {name}, which does not exist."
        hint = f"{ask_for_nearest(base, beside)}Create it, or remove it from data_files."
        meant = find_elsewhere(source, base)
        if meant is not None:
            message = f"{message.removesuffix('.')}; {meant} does."
            hint = did_you_mean(meant)
        elif folder == "resource":
            hint = (
                f"Create the empty file: mkdir -p {folder}; touch {name}"
                if base == package
                else f"Use the name in package.xml, {package}."
            )
    return MISSING_DATA_FILE.at(file, line, package, message=f"{package}: {message}", hint=hint)


def markers(setup: Setup, package: str) -> Iterator[Diagnostic]:
    """Report that data_files lacks the marker of the package or its package.xml."""
    places = {_place(one): one for one in setup.data_files}
    line = setup.line_of("data_files")
    if f"{INDEX}/{package}" not in places:
        yield MISSING_MARKER.at(
            setup.file,
            line,
            package,
            message=f"data_files does not install the marker resource/{package}.",
            hint=f"Create the empty file resource/{package}, and add to data_files: ('{INDEX}', "
            f"['resource/{package}'])",
        )
    if f"share/{package}/package.xml" not in places:
        yield MISSING_MARKER.at(
            setup.file,
            line,
            package,
            message="data_files does not install package.xml.",
            hint=f"Add to data_files: ('share/{package}', ['package.xml'])",
        )


def _place(one: DataFile) -> str:
    return posixpath.normpath(posixpath.join(one.folder, posixpath.basename(one.name)))


def globs(found: Iterable[Glob], file: Path, source: Path) -> Iterator[Diagnostic]:
    """Report patterns that match nothing in a folder that has files."""
    for one in found:
        folder, _, _ = one.pattern.rpartition("/")
        if one.found or re.search(r"[*?\[]", folder) or not folder:
            continue
        place = source / folder
        if not place.is_dir() or not f"{place.resolve()}/".startswith(f"{source.resolve()}/"):
            continue
        files = sorted(
            entry.name
            for entry in place.iterdir()
            if entry.is_file() and not entry.name.startswith((".", "__init__", "README"))
        )
        # A pattern for one more kind of file is a habit; one that leaves all files out is not.
        if files and not any(
            other.found for other in found if other.pattern.rpartition("/")[0] == folder
        ):
            yield EMPTY_GLOB.at(
                file,
                one.line,
                one.pattern,
                message=f"glob('{one.pattern}') finds no file; {folder} has "
                f"{', '.join(files[:3])}.",
                hint=f"Write a pattern that matches them: glob('{folder}/*"
                f"{os.path.splitext(files[0])[1]}')",
            )


def python_packages(setup: Setup, source: Path, package: str) -> Iterator[Diagnostic]:
    """Report packages and modules that do not exist."""
    for module, line in setup.packages or ():
        if not (source / folder_of(module, setup)).is_dir():
            yield word_package(module, source, setup.file, line, package)
    for module, line in setup.modules:
        folder = setup.package_folders.get("", "")
        if not (source / folder / f"{module.replace('.', '/')}.py").is_file():
            yield word_module(module, source, setup.file, line, package)


def word_package(
    module: str, source: Path, file: Path, line: int | None, package: str
) -> Diagnostic:
    """Report a Python package without a folder."""
    known = [entry.parent.name for entry in source.glob("*/__init__.py")]
    return MISSING_PYTHON_PACKAGE.at(
        file,
        line,
        package,
        message=f"{package}: packages names {module}, but the package has no folder of that name.",
        hint=f"{ask_for_nearest(module, known)}Create it with an empty file __init__.py, or "
        "write packages=[] if the package has no Python modules.",
    )


def word_module(
    module: str, source: Path, file: Path, line: int | None, package: str
) -> Diagnostic:
    """Report a Python module without a file."""
    known = [entry.name for entry in source.glob("*.py")]
    return MISSING_PYTHON_PACKAGE.at(
        file,
        line,
        package,
        message=f"{package}: py_modules names a module without a file: {module}.",
        hint=f"{ask_for_nearest(module, known)}Create it, or remove it from py_modules.",
    )


def script_folder(setup: Setup, configuration: Configuration, package: str) -> Iterator[Diagnostic]:
    """Report that setuptools writes scripts where ROS does not look."""
    names = [one.name for one in setup.scripts if one.name]
    if not names or configuration.mistake is not None:
        return
    place = (setup.install_scripts or "").rstrip("/")
    if place in {f"$base/lib/{package}", f"lib/{package}"} or "%" in place:
        return
    yield word_script_folder(names, configuration, setup.file, package)


def word_script_folder(
    names: Sequence[str], configuration: Configuration, setup: Path, package: str
) -> Diagnostic:
    """Report the console scripts that setuptools writes elsewhere than to lib/PACKAGE."""
    place = f"$base/lib/{package}"
    exists = configuration.exists
    return BROKEN_SCRIPT.at(
        configuration.file if exists else setup,
        (configuration.line_with("install_scripts") or configuration.line_with("[") or 1)
        if exists
        else None,
        package,
        message=f"{package}: ROS does not find {', '.join(names)}, which setuptools installs into "
        f"bin, not lib/{package}.",
        hint=f"Write in setup.cfg: [install] install_scripts={place}, and [develop] "
        f"script_dir={place}.",
    )


def entry_points(
    scripts: Iterable[Script],
    installed: Iterable[PythonPackage],
    setup: Setup,
    source: Path,
    package: str,
) -> Iterator[Diagnostic]:
    """Report console scripts whose module or function does not exist or is not installed."""
    packages = {one.name: one.source for one in installed}
    if setup.scripts_group != CONSOLE_SCRIPTS and setup.scripts:
        names = ", ".join(one.name for one in setup.scripts if one.name)
        yield BROKEN_SCRIPT.at(
            setup.file,
            getattr(setup.scripts_group, "line", setup.line_of("entry_points")),
            package,
            message=f"{package}: setuptools does not install {names}: the group in entry_points is "
            f"`{setup.scripts_group}`.",
            hint=did_you_mean(CONSOLE_SCRIPTS),
        )
    for one in scripts:
        if not one.name or not _TARGET.fullmatch(one.target):
            yield _unread_script(one, package)
            continue
        problem = _problem_of(one.target, packages, setup, source, package)
        if problem is not None:
            found = word_script(one.name, problem, one.file, one.line, package)
            yield replace(found, severity=Severity.ERROR)  # an ImportError, however it is started


# Module and function, or the module alone, which has a diagnostic of its own.
_TARGET = lazy_pattern(r"(?:[\w.]+\s*(?::\s*[\w.]+)?)?\s*:?\s*")


def _unread_script(script: Script, package: str) -> Diagnostic:
    """Report a console script that setuptools refuses, so that the build stops."""
    text = f"{script.name} = {script.target}" if script.name else script.target
    if not script.name:
        hint = f"Write '{text.replace(':', ' =', 1)}'."
    elif "=" in script.target:
        hint = "Write a comma between the scripts, each in quotes: 'NAME = MODULE:FUNCTION',"
    else:
        hint = "Write 'NAME = MODULE:FUNCTION', with dots in the name of the module."
    return BROKEN_SCRIPT.at(
        script.file,
        script.line,
        package,
        severity=Severity.ERROR,
        message=f"{package}: setuptools cannot read the console script '{text}', and stops.",
        hint=hint,
    )


def word_script(
    script: str, problem: tuple[str, str], file: Path, line: int | None, package: str
) -> Diagnostic:
    """Report a console script that cannot start."""
    return BROKEN_SCRIPT.at(
        file,
        line,
        package,
        message=f"{package}: the console script {script} cannot start: {problem[0]}.",
        hint=problem[1],
    )


def _problem_of(  # noqa: PLR0911  one for each problem
    target: str, packages: dict[str, Path], setup: Setup, source: Path, package: str
) -> tuple[str, str] | None:
    module, _, function = (part.strip() for part in target.partition(":"))
    if not module:
        return None
    if not function:
        return (
            f"it does not name a function of {module}",
            f"Write {module}:main, if that is the function.",
        )
    parent, _, base = module.rpartition(".")
    folder = packages.get(parent) if parent else None
    if folder is not None:
        for file in (folder / f"{base}.py", folder / base / "__init__.py"):
            if file.is_file():
                return _function_missing(file, module, function)
    if module in packages:
        top = packages[module]
        return _function_missing(top / "__init__.py" if top.is_dir() else top, module, function)
    if setup.packages is None or not setup.is_whole:
        return None
    top_name = module.partition(".")[0]
    path = module.replace(".", "/")
    if (source / f"{path}.py").is_file():
        place = os.path.dirname(path)
        has_init = (source / place / "__init__.py").is_file()
        return (
            f"the module {module} is not installed",
            f"List {parent or module} in packages of setup.py."
            if has_init
            else f"Create {place}/__init__.py, and list it in packages.",
        )
    if top_name == package or nearest(top_name, [package]) or (source / top_name).is_dir():
        known = [
            ".".join(file.relative_to(source).with_suffix("").parts)
            for file in source.glob("*/*.py")
            if file.stem != "__init__"
        ]
        return (
            f"the module {module} does not exist",
            f"{ask_for_nearest(module, known)}Define it, or name another one.",
        )
    return None


def _function_missing(file: Path, module: str, function: str) -> tuple[str, str] | None:
    try:
        tree = parse(file)
    except (OSError, SyntaxError, ValueError, RecursionError):
        return None
    wanted = function.partition(".")[0]
    known: list[str] = []
    for node in ast.walk(tree):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            known.append(node.name)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            known += [one.asname or one.name.partition(".")[0] for one in node.names]
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            known.append(node.id)
    if wanted in known or "*" in known:
        return None
    functions = [one.name for one in tree.body if isinstance(one, ast.FunctionDef)]
    return (
        f"{module} has no function {wanted}",
        f"{ask_for_nearest(wanted, functions)}Define it, or name another one.",
    )


def destinations(setup: Setup, package: str) -> Iterator[tuple[Diagnostic, str]]:
    """Report resources that data_files installs elsewhere than to the share folder."""
    reported: set[tuple[str, int]] = set()
    for one in setup.data_files:
        top = one.name.removeprefix("./").split("/")[0]
        folder = os.path.normpath(one.folder) if one.folder else ""
        if top not in RESOURCES or "/" not in one.name or (folder, one.line) in reported:
            continue
        if folder.startswith("/"):
            where = f"{folder}, outside of the install space"
        elif is_misplaced(folder, package):
            where = folder or "the prefix"
        else:
            continue
        reported.add((folder, one.line))
        found = WRONG_DESTINATION.at(
            setup.file,
            one.line,
            top,
            message=f"{top} is installed to {where}; ROS looks for it in share/{package}.",
            hint=f"Write: 'share/{package}/{os.path.dirname(one.name)}'",
        )
        yield found, top
