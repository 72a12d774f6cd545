"""What a package installs and requires, as its build files say it."""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003
from dataclasses import field
from pathlib import Path  # noqa: TC003

from wsgen.text.values import dataclass


@dataclass(frozen=True, kw_only=True)
class InstalledFile:
    """A file that the build installs."""

    source: Path | None  # absolute; None: the build makes it
    destination: str  # relative to the prefix: "share/PACKAGE/launch/robot.launch.py"
    file: Path  # the build file whose command installs it
    line: int  # 1-based, of the argument that names the file or its folder

    def is_of_share(self, package: str) -> bool:
        """Whether it lies in the share folder of the package."""
        return self.destination.startswith(f"share/{package}/")


@dataclass(frozen=True, kw_only=True)
class Executable:
    """A program that `ros2 run` finds: one in lib/PACKAGE."""

    name: str
    file: Path  # the build file
    line: int  # 1-based
    source: Path | None = None  # of a script
    entry_point: str | None = None  # "module:function" of a console script


@dataclass(frozen=True, kw_only=True)
class Target:
    """A program or library that CMake compiles, installed or not."""

    name: str
    kind: str  # executable, shared, static, module, interface
    file: Path
    line: int  # 1-based
    is_installed: bool = False
    in_tests: bool = False


@dataclass(frozen=True, kw_only=True)
class RequiredPackage:
    """A package that `find_package()` looks for."""

    name: str
    file: Path
    line: int  # 1-based
    required: bool  # REQUIRED; False, too, where it may not be called at all
    in_tests: bool  # inside if(BUILD_TESTING)


@dataclass(frozen=True, kw_only=True)
class PythonPackage:
    """A Python package, or a module, that is installed."""

    name: str  # dotted, as it is imported
    source: Path  # the folder, or the file of a module
    file: Path  # the build file
    line: int  # 1-based


@dataclass(frozen=True, kw_only=True)
class BuildFacts:
    """What the build files of a package say. What may be installed counts as installed."""

    build_file: Path  # CMakeLists.txt or setup.py
    installed: tuple[InstalledFile, ...] = ()
    executables: tuple[Executable, ...] = ()
    targets: tuple[Target, ...] = ()
    required_packages: tuple[RequiredPackage, ...] = ()
    python_packages: tuple[PythonPackage, ...] = ()
    # What the package adds to paths in the environment: variable, and path below the prefix.
    environment: tuple[tuple[str, str], ...] = ()
    # Folders that are installed as they are: below the prefix -> the source folder.
    folders: Mapping[str, Path] = field(default_factory=dict)
    # Commands that not every distribution has -> file and 1-based line of each call.
    dated_calls: Mapping[str, tuple[tuple[Path, int], ...]] = field(default_factory=dict)
    is_whole: bool = True  # False: it may install more than can be read from the files

    def shared(self, package: str) -> dict[str, InstalledFile]:
        """What is in the share folder of the package, by the path below it."""
        start = f"share/{package}/"
        return {
            one.destination[len(start) :]: one
            for one in self.installed
            if one.destination.startswith(start)
        }
