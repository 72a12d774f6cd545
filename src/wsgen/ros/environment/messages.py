"""Messages that PyPI lacks, built once into the user's cache.

Colcon and CMake would build for every language and middleware: 30 s of CPU time for tf2_msgs, which
has one message that matters. Python nodes with Fast DDS need a fifth of that: the generators run in
one process (`message_generator.py`), and what they write is compiled several files at a time.

The compiler is that of the system, or PyPI's ziglang where there is none: it compiles C and C++
where nobody is root.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import time
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError
from wsgen.events import OutputLine, StepEnded, StepProgressed, StepStarted, post
from wsgen.ros.environment.interfaces import (
    buildable,
    dependencies,
    digest,
    in_order,
    write_interfaces,
)
from wsgen.ros.environment.wheels import being_made, cache_folder, download, site_packages, unpack
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

    from wsgen.events import Listener


C_NAMES = ("cc", "gcc", "clang")
CXX_NAMES = ("c++", "g++", "clang++")
SHOWN_LINES = 3  # of the errors of a compiler


@dataclass(frozen=True, kw_only=True)
class Compiler:
    """Commands that compile C and C++."""

    c: tuple[str, ...]
    cxx: tuple[str, ...]


def system_compiler(environment: Mapping[str, str]) -> Compiler | None:
    """Return the compiler of the system: that of CC and CXX, or of the PATH; None without one."""
    path = environment.get("PATH", os.defpath)

    def command(variable: str, names: Sequence[str]) -> tuple[str, ...]:
        if chosen := environment.get(variable):
            return tuple(shlex.split(chosen))
        found = next((name for name in names if shutil.which(name, path=path)), None)
        return (found,) if found else ()

    c, cxx = command("CC", C_NAMES), command("CXX", CXX_NAMES)
    return Compiler(c=c, cxx=cxx) if c and cxx else None


def python_headers() -> Path:
    """Return the folder of Python.h.

    Raises:
        NotFoundError: Python is installed without it, as Debian and Ubuntu do.
    """
    folder = Path(sysconfig.get_path("include"))
    if not (folder / "Python.h").is_file():
        version = sysconfig.get_python_version()
        raise NotFoundError(
            f"Messages cannot be compiled: Python.h is missing in {folder}.",
            hint=f"Install it: {_headers_command(version)}; or install wsgen with a "
            f"Python that has it (uv tool install --python {version} 'wsgen[ros]').",
        )
    return folder


def _headers_command(version: str) -> str:
    """What installs the headers of the system's Python, by the package manager that is there."""
    commands = {
        "apt-get": f"sudo apt install python{version}-dev",
        "dnf": "sudo dnf install python3-devel",
        "zypper": f"sudo zypper install python{version.replace('.', '')}-devel",
        "apk": "sudo apk add python3-dev",
    }
    return next((commands[name] for name in commands if shutil.which(name)), commands["apt-get"])


def run_all(commands: Sequence[Sequence[str]], *, environment: Mapping[str, str]) -> None:
    """Run commands of a compiler, as many at a time as there are cores.

    Raises:
        NotFoundError: one fails; the message has its first errors.
    """

    def run(command: Sequence[str]) -> None:
        try:
            done = subprocess.run(
                command,
                env=dict(environment),
                stdin=subprocess.DEVNULL,
                capture_output=True,
                text=True,
                errors="replace",
                check=False,
            )
            said, status = done.stderr, done.returncode
        except OSError as error:
            said, status = str(error), 1
        if status != 0:
            lines = [line for line in said.splitlines() if "error" in line] or said.splitlines()
            raise NotFoundError(
                f"{command[0]} does not compile messages: {' '.join(lines[:SHOWN_LINES])}",
                hint="Install another compiler (sudo apt install g++), or name one with CC and "
                "CXX.",
            )

    with ThreadPoolExecutor(max(1, len(os.sched_getaffinity(0)))) as pool:
        for _ in pool.map(run, commands):
            pass


VERSION = "0.13.0"
# What the wheels of ROS are built for; the libraries of this machine are at least as new.
TARGET = ("-target", "x86_64-linux-gnu.2.28")


def make_zig(environment: Mapping[str, str], listener: Listener) -> Compiler:
    """Return the compiler, which is downloaded into the user's cache unless it is there.

    Raises:
        NotFoundError: it cannot be downloaded.
        NotReadableError: the cache cannot be used.
    """
    folder = cache_folder(environment) / f"ziglang-{VERSION}"
    if not folder.exists():
        _bring(folder, environment, listener)
    program = str(site_packages(folder) / "ziglang" / "zig")
    return Compiler(c=(program, "cc", *TARGET), cxx=(program, "c++", *TARGET))


def _bring(target: Path, environment: Mapping[str, str], listener: Listener) -> None:
    step = ("ros", "ziglang")
    started = time.monotonic()
    succeeded = False
    post(
        listener,
        StepStarted(step=step, detail="a compiler, because this machine has none", takes_long=True),
    )

    def progress(detail: str) -> None:
        post(listener, StepProgressed(step=step, detail=detail))

    try:
        with being_made(target, listener, step) as folder:
            if folder is not None:
                wheels = folder / "wheels"
                found = download(
                    [f"ziglang=={VERSION}"],
                    wheels,
                    environment=environment,
                    listener=listener,
                    step=step,
                )
                unpack(found, folder, change=lambda _, content: content, progress=progress)
                shutil.rmtree(wheels)
                (site_packages(folder) / "ziglang" / "zig").chmod(0o755)
        succeeded = True
    finally:
        seconds = time.monotonic() - started
        post(listener, StepEnded(step=step, succeeded=succeeded, seconds=seconds))


GENERATOR = Path(__file__).with_name("message_generator.py")
RECIPE = "3"  # of the libraries; one more when they are built otherwise
HOT = ("tf2_msgs",)  # what is sent at high rates
PER_FILE = 16  # sources of C++ that are compiled as one
LARGEST = 40  # the same for C
INDEX = "share/ament_index/resource_index"
# A static variable of a file that describes a type.
STATIC = lazy_pattern(r"^static [^=;(]*?(\w+)(?:\[\d*\])? =", re.MULTILINE)


@dataclass(frozen=True, kw_only=True)
class _Library:
    """One of the libraries of a package; `uses` are the kinds that it is linked with."""

    kind: str
    own: tuple[str, ...] = ()  # kinds of libraries of the same package
    of_others: tuple[str, ...] = ()  # kinds of libraries of packages that it uses
    more: tuple[str, ...] = ()  # libraries of ROS
    is_cxx: bool = False


LIBRARIES = (
    _Library(
        kind="rosidl_generator_c",
        of_others=("rosidl_generator_c",),
        more=("rosidl_runtime_c", "rcutils"),
    ),
    _Library(
        kind="rosidl_typesupport_fastrtps_c",
        own=("rosidl_generator_c",),
        of_others=("rosidl_typesupport_fastrtps_c", "rosidl_generator_c"),
        more=(
            "rosidl_typesupport_fastrtps_c",
            "rosidl_typesupport_fastrtps_cpp",
            "fastcdr",
            "rmw",
            "rosidl_runtime_c",
            "rcutils",
        ),
        is_cxx=True,
    ),
    _Library(
        kind="rosidl_typesupport_introspection_c",
        own=("rosidl_generator_c",),
        of_others=("rosidl_typesupport_introspection_c", "rosidl_generator_c"),
        more=("rosidl_typesupport_introspection_c", "rosidl_runtime_c"),
    ),
    _Library(
        kind="rosidl_typesupport_c",
        own=("rosidl_generator_c",),
        of_others=("rosidl_typesupport_c", "rosidl_generator_c"),
        more=("rosidl_typesupport_c", "rosidl_runtime_c"),
        is_cxx=True,
    ),
    _Library(
        kind="rosidl_generator_py",
        own=("rosidl_generator_c", "rosidl_typesupport_c"),
        of_others=("rosidl_generator_py", "rosidl_generator_c"),
        more=("rosidl_runtime_c",),
    ),
)


def make_messages(
    packages: Collection[str],
    prefix: Path,
    *,
    compiler: Callable[[], Compiler],
    environment: Mapping[str, str],
    listener: Listener,
) -> list[Path]:
    """Build packages of messages, unless they are there, and return their prefixes.

    Args:
        packages: names of `interfaces.buildable()`; what they use is built, too.
        prefix: of ROS; the messages are beside it.
        compiler: is called if something is compiled.
        environment: variables of the environment of ROS.
        listener: receives progress.

    Raises:
        NotFoundError: there is no compiler, or no header of Python.
        NotReadableError: the cache cannot be used.
    """
    prefixes: dict[str, Path] = {}
    means = _Means(compiler=compiler, environment=environment, listener=listener)
    for package in in_order(set(packages)):
        target = _target(package, prefix)
        if not target.exists():
            _make(package, target, [prefix, *prefixes.values()], means)
        prefixes[package] = target
    return list(prefixes.values())


def built_messages(prefix: Path) -> list[Path]:
    """List the prefixes of all messages that are built for the ROS in a prefix."""
    targets = [_target(package, prefix) for package in buildable()]
    return [target for target in targets if target.exists()]


def _target(package: str, prefix: Path) -> Path:
    name = f"{package}-{digest(package)}-{RECIPE}-numpy{_numpy_version()}"
    return prefix.parent / f"{prefix.name}-messages" / name


@dataclass(frozen=True, kw_only=True)
class _Means:
    """What builds need, whichever package they are of."""

    compiler: Callable[[], Compiler]
    environment: Mapping[str, str]
    listener: Listener


def _make(package: str, target: Path, prefixes: list[Path], means: _Means) -> None:
    step = ("ros", package)
    started = time.monotonic()
    succeeded = False
    target.parent.mkdir(exist_ok=True)
    post(means.listener, StepStarted(step=step, detail="compiled once", takes_long=True))
    try:
        with being_made(target, means.listener, step) as folder:
            if folder is not None:
                sources = folder / "share" / package
                write_interfaces(package, sources)
                build_messages(
                    MessagePackage(
                        name=package,
                        sources=sources,
                        files=tuple(sorted(file for file in sources.glob("*/*"))),
                        uses=frozenset(dependencies(package)),
                    ),
                    folder,
                    prefixes=prefixes,
                    compiler=means.compiler(),
                    environment=means.environment,
                    listener=means.listener,
                )
                marker = folder / INDEX / "packages" / package
                marker.parent.mkdir(parents=True, exist_ok=True)
                marker.touch()
        succeeded = True
    finally:
        seconds = time.monotonic() - started
        post(means.listener, StepEnded(step=step, succeeded=succeeded, seconds=seconds))


@dataclass(frozen=True, kw_only=True)
class MessagePackage:
    """A package of messages."""

    name: str
    sources: Path  # folder with msg, srv, action
    files: tuple[Path, ...]  # below `sources`
    uses: frozenset[str]  # packages of messages whose types they use, and those of the generators


def build_messages(  # noqa: PLR0913  a request
    package: MessagePackage,
    folder: Path,
    *,
    prefixes: Sequence[Path],
    compiler: Compiler,
    environment: Mapping[str, str],
    listener: Listener | None,
) -> None:
    """Build a package of messages into a folder that is then a prefix: lib, include, share.

    Args:
        package: what is built.
        folder: is created; files of the same names are replaced.
        prefixes: where messages are that it uses; that of ROS is the first.
        compiler: that of C and C++.
        environment: variables of the environment of ROS.
        listener: receives progress.

    Raises:
        NotFoundError: the files are wrong, or the compiler does not work.
    """
    build = folder / "build"
    shutil.rmtree(build, ignore_errors=True)
    build.mkdir(parents=True)
    work = _Work(
        package=package.name,
        request=package,
        folder=folder,
        prefixes=tuple(prefixes),
        compiler=compiler,
        environment=environment,
        listener=listener,
    )
    work.generate()
    work.compile()
    work.install()


@dataclass(frozen=True, kw_only=True)
class _Work:
    """The build of one package in a folder that becomes its prefix."""

    package: str
    request: MessagePackage
    folder: Path
    prefixes: tuple[Path, ...]  # of ROS, and of messages built before
    compiler: Compiler
    environment: Mapping[str, str]
    listener: Listener | None

    @property
    def _share(self) -> Path:
        return self.folder / "share" / self.package

    @property
    def _build(self) -> Path:
        return self.folder / "build"

    @property
    def _include(self) -> Path:
        return self.folder / "include" / self.package

    @property
    def _introspection(self) -> Path:
        """Beside the other headers: files of both have the same names."""
        return self.folder / "include" / f"{self.package}__introspection"

    def _progress(self, detail: str) -> None:
        post(self.listener, StepProgressed(step=("ros", self.package), detail=detail))

    def generate(self) -> None:
        """Have ROS generate code."""
        self._progress("generate its code")
        for folder in (self._include, self._introspection):
            folder.mkdir(parents=True, exist_ok=True)
        shares = [
            (share.name, str(share))
            for prefix in self.prefixes
            for share in sorted((prefix / "share").iterdir())
        ]
        request = {
            "package": self.package,
            "source": str(self.request.sources),
            "files": [str(file.relative_to(self.request.sources)) for file in self.request.files],
            "share": str(self._share),
            "code": str(self._include),
            "introspection": str(self._introspection),
            "python": str(site_packages(self.folder)),
            "resources": str(self.prefixes[0] / "share"),
            "shares": shares,
        }
        # -I would ignore PYTHONPATH; -P is not known to 3.10. The folder of the script has nothing
        # that the generators import.
        done = subprocess.run(
            [sys.executable, str(GENERATOR)],
            input=json.dumps(request),
            env=dict(self.environment),
            capture_output=True,
            text=True,
            errors="replace",
            check=False,
        )
        if done.returncode != 0:
            for line in done.stderr.splitlines():
                post(
                    self.listener,
                    OutputLine(step=("ros", self.package), text=line, is_error_stream=True),
                )
            said = (done.stderr.strip().splitlines() or ["they say nothing"])[-1]
            raise NotFoundError(
                f"The generators of ROS refuse the interfaces of {self.package}: {said}",
                hint="Fix the file that they name.",
            )

    def compile(self) -> None:
        """Compile the code, and link the libraries."""
        self._progress("compile it")
        objects, commands = self._compile_commands()
        run_all(commands, environment=self.environment)
        self._progress("link it")
        libraries = self.folder / "lib"
        libraries.mkdir(exist_ok=True)
        for library in LIBRARIES:
            output = libraries / f"lib{self.package}__{library.kind}.so"
            self._link(output, objects[library.kind], self._needs(library), is_cxx=library.is_cxx)
        self._link(
            site_packages(self.folder)
            / self.package
            / f"{self.package}_s__rosidl_typesupport_c.so",
            objects["extension"],
            [
                *(f"{self.package}__{library.kind}" for library in reversed(LIBRARIES)),
                "rosidl_typesupport_c",
            ],
            is_cxx=False,
        )

    def install(self) -> None:
        """Remove what only the build needs, and write the package into the ament index."""
        shutil.rmtree(self._build)
        for folder in (self._include, self._introspection, site_packages(self.folder)):
            for file in [*folder.rglob("*.c"), *folder.rglob("*.cpp"), *folder.glob("*.json")]:
                file.unlink()
        names = [str(file.relative_to(self.request.sources)) for file in self.request.files]
        marker = self.folder / INDEX / "rosidl_interfaces" / self.package
        marker.parent.mkdir(parents=True, exist_ok=True)
        marker.write_text("\n".join(names), encoding="utf-8")

    def _needs(self, library: _Library) -> list[str]:
        others = sorted(self.request.uses)
        return [
            *(f"{self.package}__{kind}" for kind in library.own),
            *(f"{other}__{kind}" for kind in library.of_others for other in others),
            *library.more,
        ]

    def _link(
        self, output: Path, objects: Iterable[str], names: list[str], *, is_cxx: bool
    ) -> None:
        linker = self.compiler.cxx if is_cxx else self.compiler.c
        folders = [f"-L{prefix / 'lib'}" for prefix in (self.folder, *self.prefixes)]
        command = [*linker, "-shared", "-o", str(output), *objects, *folders]
        command += ["-Wl,--allow-shlib-undefined", *(f"-l{name}" for name in names)]
        run_all([command], environment=self.environment)

    def _compile_commands(self) -> tuple[dict[str, list[str]], list[list[str]]]:
        """Return the object files by the kind of their library, and what compiles them."""
        code = self._include / self.package
        python = site_packages(self.folder) / self.package
        includes = [f"-I{self._include}", f"-I{self._introspection}"]
        for prefix in self.prefixes:
            root = prefix / "include"
            folders = [root, *(entry for entry in sorted(root.iterdir()) if entry.is_dir())]
            includes += [word for entry in folders for word in ("-isystem", str(entry))]
        of_python = [word for entry in _python_includes() for word in ("-isystem", str(entry))]
        objects: dict[str, list[str]] = {}
        commands: list[tuple[int, list[str]]] = []

        def add(kind: str, sources: list[Path], size: int, flags: list[str]) -> None:
            for start in range(0, len(sources), size):
                part = sources[start : start + size]
                is_cxx = part[0].suffix == ".cpp"
                file = self._build / f"{kind}{len(commands)}{part[0].suffix}"
                file.write_text("".join(map(_included, part, count())), "utf-8")
                output = str(file.with_suffix(".o"))
                objects.setdefault(kind, []).append(output)
                compiler = self.compiler.cxx if is_cxx else self.compiler.c
                command = [*compiler, "-c", "-fPIC", "-w", *(["-std=c++17"] if is_cxx else [])]
                command += [f'-DROS_PACKAGE_NAME="{self.package}"', *flags, *includes]
                weight = len(part) * (3 if is_cxx else 1)
                commands.append((weight, [*command, str(file), "-o", output]))

        def found(folder: Path, pattern: str) -> list[Path]:
            return sorted(folder.glob(pattern))

        # Compiling takes half of the time without optimization; nodes send most messages rarely.
        fast = ["-O1" if self.package in HOT else "-O0", "-DNDEBUG"]
        cxx = found(code, "*/detail/*__type_support_c.cpp")
        add("rosidl_typesupport_fastrtps_c", cxx, PER_FILE, fast)
        add("rosidl_generator_py", found(python, "*/_*_s.c"), PER_FILE, [*fast, *of_python])
        extension = found(python, "_*_s.ep.rosidl_typesupport_c.c")
        add("extension", extension, 1, [*fast, *of_python])
        add("rosidl_typesupport_c", found(code, "*/*__type_support.cpp"), LARGEST, ["-O0"])
        described = found(self._introspection / self.package, "*/detail/*__type_support.c")
        add("rosidl_typesupport_introspection_c", described, LARGEST, ["-O0"])
        add("rosidl_generator_c", found(code, "*/detail/*__functions.c"), LARGEST, fast)
        add("rosidl_generator_c", found(code, "*/detail/*__type_support.c"), LARGEST, ["-O0"])
        add("rosidl_generator_c", found(code, "*/detail/*__description.c"), LARGEST, ["-O0"])
        commands.sort(key=lambda one: -one[0])
        return objects, [command for _, command in commands]


def _included(source: Path, number: int) -> str:
    """Return the lines that include a source between others of its kind.

    Those that describe types define the same static names.
    """
    is_description = source.stem.endswith("__description")
    names = STATIC.findall(source.read_text(encoding="utf-8")) if is_description else []
    return "".join(
        [
            *(f"#define {name} {name}__of_{number}\n" for name in names),
            f'#include "{source}"\n',
            *(f"#undef {name}\n" for name in names),
        ]
    )


def _python_includes() -> list[Path]:
    import numpy as np  # noqa: PLC0415  who finds the messages built saves 60 ms

    return [python_headers(), Path(np.get_include())]


def _numpy_version() -> str:
    """The major version: what is compiled for 1 does not work with 2."""
    from importlib.metadata import version  # noqa: PLC0415  as above

    return version("numpy").partition(".")[0]
