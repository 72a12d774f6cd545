"""Find colcon workspaces and the packages in them, and explain why none was found."""

from __future__ import annotations

import os
import shlex
import stat
from dataclasses import field
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic
from wsgen.errors import NotFoundError, RequestError
from wsgen.packages.workspace.manifest import FOREIGN_MANIFEST, read_manifest
from wsgen.text.files import list_files, read_or_empty, read_regular, read_regular_text, real_path
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from wsgen.packages.workspace.manifest import Manifest


# Files and folders that mark a package without package.xml.
EVIDENCE = ("CMakeLists.txt", "setup.py", "launch", "model", "urdf", "worlds")


def refuse_missing_manifest(roots: Iterable[Path]) -> None:
    """Stop if a folder in `src` of one of the roots is a package except for its package.xml.

    Raises:
        NotFoundError: one is.
    """
    for root in roots:
        folder = next(_without_manifest(root / "src"), None)
        if folder is not None:
            raise NotFoundError(
                f"{folder} has no package.xml, so that {root} does not contain a package.",
                hint="Restore it (git checkout package.xml), write one, or create another package: "
                f"wsgen new PACKAGE -w {root}",
            )


def _without_manifest(source: Path) -> Iterator[Path]:
    for folder in _folders_in(source):
        if not (folder / "package.xml").exists() and any(
            (folder / name).exists() for name in EVIDENCE
        ):
            yield folder


INSTALL_LAYOUT = ".colcon_install_layout"  # colcon writes it into an install space
BUILT_BY = ".built_by"  # and this into a build space
FOR_ALL = stat.S_ISVTX | stat.S_IWOTH  # the mode of a folder in which everybody has files
# In the build folder of a package; colcon writes it after every build.
BUILD_RESULT = "colcon_build.rc"
LOG_OF_BUILD = "latest_build"  # a link to the log of the last `colcon build`
WRITTEN_BY_COLCON = (INSTALL_LAYOUT, BUILT_BY)
IGNORE_MARKERS = frozenset({"COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE"})
VIRTUAL_ENVIRONMENT = "pyvenv.cfg"  # that `python -m venv` and its like write
CONDA_ENVIRONMENT = "conda-meta"  # a folder
# In folders that are no part of a package around them.
BUILD_MARKERS = IGNORE_MARKERS | {INSTALL_LAYOUT, VIRTUAL_ENVIRONMENT, CONDA_ENVIRONMENT}
PYTHON_MARKERS = frozenset({"setup.py", "setup.cfg", "pyproject.toml"})
# How `ros2 launch` recognizes launch files.
LAUNCH_FUNCTION = b"def generate_launch_description("
MOST_BYTES = 1_000_000  # of a launch file that is known by its content
LAUNCH_FILES = ("launch.py", "launch.xml", "launch.yaml", "launch.yml")  # ends of names
# Next to `src`, these mark the source code of a single project.
PROJECT_MARKERS = PYTHON_MARKERS | {
    *("CMakeLists.txt", "Cargo.toml", "build.gradle", "go.mod", "meson.build", "package.json"),
    *("package.xml", "pom.xml"),
}
# Number of folders below `src` to search for a package, as a folder such as /usr/src may have
# millions of files.
EVIDENCE_LIMIT = 2000


@dataclass(frozen=True, kw_only=True)
class Workspace:
    """A colcon workspace with the folders in their usual places, but for what colcon is given."""

    root: Path  # absolute
    # Where colcon has found its packages, if it was asked; else they are looked for below `root`.
    package_folders: tuple[Path, ...] = ()
    install_base: Path | None = None  # None: the usual one

    @property
    def source(self) -> Path:
        """Where packages are written; colcon finds them anywhere below `root`."""
        return self.root / "src"

    @property
    def build(self) -> Path:
        """The build folders of CMake, one for each package."""
        return self.root / "build"

    @property
    def install(self) -> Path:
        """The install space, with setup.bash."""
        return self.install_base or self.root / "install"

    @property
    def log(self) -> Path:
        """The logs, one folder for each run."""
        return self.root / "log"


@dataclass(frozen=True, kw_only=True)
class PackageFolder:
    """A folder with a package.xml that is, or should be, a ROS package."""

    path: Path
    name: str  # the folder's name where the manifest cannot be read
    build_type: str  # empty where the manifest cannot be read
    test_dependencies: frozenset[str] = frozenset()
    diagnostics: tuple[Diagnostic, ...] = ()  # of the manifest
    manifest: Manifest | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, kw_only=True)
class Inventory:
    """The packages that colcon finds in a workspace."""

    packages: tuple[PackageFolder, ...] = ()  # ROS packages, ordered by path
    others: tuple[Path, ...] = ()  # packages without manifest: plain CMake, Python
    has_python: bool = False  # colcon needs its extensions for Python packages


def open_workspace(given: str | None, *, takes_packages: bool = True) -> Workspace:
    """Return the workspace at the given folder, or else that of the current folder.

    It is the one that `find_workspace` finds. Else it is the only one in the current folder, so
    that users need not change the folder after `wsgen new`; or else, unless `takes_packages` is
    False, the package around the current folder or the folder itself, if it has packages. A given
    folder must be the workspace itself, as for `wsgen new`.

    Raises:
        NotFoundError: no workspace was found.
        RequestError: several were found, or the given folder is around a workspace, or its `src`.
    """
    if given is not None:
        root = Path(given).expanduser().absolute()
        if not root.is_dir():
            raise NotFoundError(
                f"The workspace {root} does not exist.",
                hint="Name the folder with src, or create one: wsgen new PACKAGE -w DIR",
            )
        _refuse_surroundings(root)
        if root.name == "src" and not _is_marked(root) and not (root / "src").is_dir():
            around = find_workspace(root)
            if around is not None and around.source == root:
                raise RequestError(
                    f"{root} is the folder src of a workspace, not the workspace.",
                    hint=f"Name the workspace: -w {shlex.quote(str(around.root))}",
                )
        return Workspace(root=root)
    here = current_folder()
    workspace = find_workspace(here)
    if workspace is not None:
        return workspace
    inside = _workspaces_in(here)
    if len(inside) > 1:
        raise RequestError(
            f"{here} has several colcon workspaces.",
            hint=f"Change into one, or choose: -w {' | '.join(folder.name for folder in inside)}",
        )
    if inside:
        return Workspace(root=inside[0])
    if takes_packages:
        package = _package_around(here)
        if package is not None or (not _is_exposed(here) and _holds_packages(here)):
            return Workspace(root=package or here)
    refuse_missing_manifest((here, *_folders_in(here)))
    above = next((one for one in here.parents if not _is_exposed(one) and _is_workspace(one)), None)
    raise NotFoundError(
        f"{here} is not in a colcon workspace, and has none.",
        hint="Change into one, name it with --workspace, or create one: wsgen new PACKAGE"
        if above is None
        else f"{here.name} is outside of the src of {above}. To use that workspace: "
        f"-w {shlex.quote(str(above))}",
    )


def current_folder() -> Path:
    """The current folder by the links through which the shell has entered it.

    A package that is a link in `src` is in that workspace for who has changed into it there.
    """
    shown = os.environ.get("PWD", "")
    try:
        if os.path.isabs(shown) and os.path.samefile(shown, "."):  # noqa: PTH117, PTH121
            return Path(os.path.normpath(shown))
    except OSError:
        pass
    return Path.cwd()


def workspace_if_any(given: str | None) -> Workspace | None:
    """Open the given workspace, or that of the current folder as `open_workspace` finds it.

    It is for commands that work without one: where none is found, or several, what is sourced may
    have the package.

    Raises:
        NotFoundError: the given folder does not exist.
        RequestError: the given folder is around a workspace.
    """
    if given is not None:
        return open_workspace(given)
    try:
        return open_workspace(None)
    except (NotFoundError, RequestError):
        return None


def find_workspace(start: Path) -> Workspace | None:
    """Find the workspace that a folder is or lies in; None if there is none.

    It is the nearest folder of these: the folder itself, if its `src` has packages or is that of no
    other project; one above it in whose `src` it lies; and one in which colcon has built. A build
    inside `src`, by mistake, does not hide the workspace around it.
    """
    start = start.absolute()
    marked: Workspace | None = None
    package, around = _package_around(start), _around(start)
    for folder in (start, *start.parents):
        source = folder / "src"
        is_inside = start == source or source in start.parents
        is_near = is_inside or start == folder
        if _exists(folder / "COLCON_IGNORE"):
            continue
        has_marks = (is_near or folder in around) and _is_marked(folder)
        if has_marks and marked is None:
            marked = Workspace(root=folder)
        if not is_near or _exists(folder / "package.xml"):
            continue
        if _is_exposed(folder) and not has_marks:
            continue
        # What is in `src` instead of packages may be the code of a project or of a package.
        is_code = marked or not _may_hold_packages(folder) or package in folder.parents
        if _has_source(folder) or (not is_code and source.is_dir()):
            return Workspace(root=folder)
    return marked


def workspace_around(folder: Path) -> Workspace | None:
    """Find the workspace or the clone whose packages belong to a folder; to look them up only.

    A folder beside `src` belongs to the workspace where that is the one of the current folder.
    """
    found = find_workspace(folder) or find_source_tree(folder)
    if found is None:
        here = find_workspace(current_folder())
        found = here if here is not None and folder.absolute().is_relative_to(here.root) else None
    return found


def with_surroundings(workspace: Workspace) -> tuple[Workspace, ...]:
    """The workspace, after the clone that has it where it is a single package.

    What it needs may be a package beside it. Nothing is written there.
    """
    tree = find_source_tree(workspace.root) if _exists(workspace.root / "package.xml") else None
    return (workspace,) if tree in {None, workspace} else (tree, workspace)


def find_source_tree(start: Path) -> Workspace | None:
    """Find the packages that a folder belongs to where no workspace is: those of a clone.

    It is the repository around the folder, or else the package around it with those beside it.
    """
    start = start.absolute()
    folders = _around(start)
    package = _package_around(start)
    repository = next((folder for folder in folders if _exists(folder / ".git")), None)
    if repository is not None and _holds_packages(repository, package):
        return Workspace(root=repository)
    if package is None:
        return None
    beside = package.parent
    has_others = any(file.parent != package for file in beside.glob("*/package.xml"))
    is_whole = has_others and beside in folders and _holds_packages(beside, package)
    return Workspace(root=beside if is_whole else package)


def _package_around(start: Path) -> Path | None:
    return next((one for one in _around(start) if _exists(one / "package.xml")), None)


def _may_hold_packages(folder: Path) -> bool:
    markers = PROJECT_MARKERS | IGNORE_MARKERS
    return not any(_exists(folder / name) for name in markers)


def _exists(path: Path) -> bool:
    """Whether it exists; not where a folder above the current one cannot be entered."""
    return os.path.exists(path)  # noqa: PTH110  pathlib raises an error there


def _is_exposed(folder: Path) -> bool:
    """Whether `src` in this folder may have any purpose."""
    return folder in {Path(folder.anchor), Path.home()}


def _around(start: Path) -> list[Path]:
    """A folder and those above it, but for those with whatever else a user or everybody has."""
    return [
        folder
        for folder in (start, *start.parents)
        if not (_is_exposed(folder) or (folder != start and _is_of_everybody(folder)))
    ]


def _is_of_everybody(folder: Path) -> bool:
    """Whether everybody may write there, as in /tmp."""
    try:
        return folder.stat().st_mode & FOR_ALL == FOR_ALL
    except OSError:
        return False


def find_packages(workspace: Workspace) -> tuple[PackageFolder, ...]:
    """List the ROS packages that colcon would find, with the mistakes in their manifests."""
    return take_inventory(workspace).packages


def take_inventory(workspace: Workspace) -> Inventory:
    """Crawl the workspace as colcon does."""
    packages: list[PackageFolder] = []
    others: list[Path] = []
    has_python = False
    for folder, names in _folders_of(workspace):
        has_python = has_python or not PYTHON_MARKERS.isdisjoint(names)
        package = read_package(folder) if "package.xml" in names else None
        if package is not None:
            packages.append(package)
            has_python = has_python or package.build_type == "ament_python"
        elif not names.isdisjoint({"CMakeLists.txt", *PYTHON_MARKERS}):
            others.append(folder)
    return Inventory(packages=tuple(packages), others=tuple(others), has_python=has_python)


def _folders_of(workspace: Workspace) -> Iterator[tuple[Path, frozenset[str]]]:
    """The folders that may be packages, each with the names of its files."""
    if not workspace.package_folders:
        yield from crawl(workspace.root)
    for folder in workspace.package_folders:
        yield from islice(crawl(folder), 1)


def read_package(folder: Path) -> PackageFolder | None:
    """Read the package in a folder; None if its package.xml is not one of ROS, or a dead link."""
    manifest = read_manifest(folder / "package.xml")
    if not isinstance(manifest, Diagnostic):
        return PackageFolder(
            path=folder,
            name=manifest.name,
            build_type=manifest.build_type,
            test_dependencies=manifest.test_dependencies,
            manifest=manifest,
        )
    is_dead_link = manifest.line is None and not (folder / "package.xml").exists()
    if manifest.code == FOREIGN_MANIFEST.code or is_dead_link:
        return None
    return PackageFolder(path=folder, name=folder.name, build_type="", diagnostics=(manifest,))


def find_launch_files(folder: Path) -> tuple[Path, ...]:
    """List the launch files below a folder, by path; not those of builds, which colcon ignores.

    `ros2 launch` takes a file of any name: so is, in a folder `launch`, Python with the function of
    a launch file.
    """
    return tuple(
        file
        for file in list_files(folder, (".py", *LAUNCH_FILES), markers=BUILD_MARKERS)
        if file.name.endswith(LAUNCH_FILES)
        or (file.parent.name == "launch" and has_launch_function(file))
    )


def has_launch_function(file: Path) -> bool:
    """Whether a file has the function of a launch file in Python."""
    try:
        return LAUNCH_FUNCTION in read_regular(file, MOST_BYTES)
    except (OSError, ValueError):
        return False


def crawl(root: Path, *, with_ignored: bool = False) -> Iterator[tuple[Path, frozenset[str]]]:
    """Yield the folders that colcon searches, each with the names of its files.

    Like colcon, it follows links, skips hidden and ignored folders, and does not search below a
    package. `with_ignored` also yields folders below ignored ones. A CMakeLists.txt that catkin has
    left behind is not among the files. As wsgen has colcon do, it skips environments of Python
    (`is_python_environment`).
    """
    visited = set()
    for name, folders, files in os.walk(root, followlinks=True):
        real = real_path(name)
        is_skipped = not with_ignored and not IGNORE_MARKERS.isdisjoint(files)
        if real in visited or is_skipped or is_python_environment({*folders, *files}):
            folders.clear()
            continue
        visited.add(real)
        found = frozenset(files)
        if "CMakeLists.txt" in found and "package.xml" not in found and _is_of_catkin(name):
            found -= {"CMakeLists.txt"}
        yield Path(name), found
        if not {"package.xml", "CMakeLists.txt", "setup.py"}.isdisjoint(found):
            folders.clear()
        folders[:] = sorted(folder for folder in folders if not folder.startswith("."))


CMAKE_SIZE_LIMIT = 2**16  # bytes; that of catkin has 3 kB


def _is_of_catkin(folder: str) -> bool:
    """Whether CMakeLists.txt makes a workspace of catkin, or is a link to a catkin without one."""
    file = os.path.join(folder, "CMakeLists.txt")  # noqa: PTH118  as in os.walk
    if not os.path.isfile(file):  # noqa: PTH113
        return True
    try:
        lines = read_regular(Path(file), CMAKE_SIZE_LIMIT).splitlines()
    except (OSError, ValueError):
        return False
    return b"catkin_workspace()" in lines


def is_python_environment(names: Collection[str]) -> bool:
    """Whether a folder with these files and folders is an environment of venv or conda.

    Such a folder in a workspace has the packages of wsgen's wheels, or all those of a ROS from
    conda, which nobody wants to build. A workspace or package in an environment remains one.
    """
    is_environment = VIRTUAL_ENVIRONMENT in names or CONDA_ENVIRONMENT in names
    return is_environment and {"src", "package.xml"}.isdisjoint(names)


def _refuse_surroundings(root: Path) -> None:
    """Stop if build, install and log would be created around a workspace."""
    if _is_marked(root) or (root / "src").is_dir() or (root / "package.xml").exists():
        return
    inside = _workspaces_in(root)
    if inside:
        raise RequestError(
            f"{root} is not a workspace; it contains {' and '.join(path.name for path in inside)}.",
            hint=f"Write: -w {shlex.quote(str(inside[0]))}",
        )


def _workspaces_in(folder: Path) -> list[Path]:
    return [path for path in _folders_in(folder) if _is_workspace(path)]


def _folders_in(folder: Path) -> list[Path]:
    try:
        return [path for path in sorted(folder.iterdir()) if path.is_dir()]
    except OSError:
        return []


def _is_workspace(folder: Path) -> bool:
    """Whether a folder is a workspace with packages."""
    return not (
        _exists(folder / "COLCON_IGNORE") or _exists(folder / "package.xml")
    ) and _holds_packages(folder / "src")


def _is_marked(folder: Path) -> bool:
    """Whether colcon has built or installed here."""
    if _exists(folder / "install" / INSTALL_LAYOUT) or _exists(folder / "log" / LOG_OF_BUILD):
        return True
    try:
        return read_regular_text(folder / "build" / BUILT_BY).strip() == "colcon"
    except (OSError, ValueError):
        return False


def _has_source(folder: Path) -> bool:
    source = folder / "src"
    try:
        if not any(source.iterdir()):
            return True  # mkdir -p ws/src, the first step of every tutorial
    except OSError:
        return False
    return _holds_packages(source)


def _holds_packages(folder: Path, package: Path | None = None) -> bool:
    """Whether colcon finds packages in a folder, or the given one if there is one."""
    return any(
        "package.xml" in names and package in {None, place}
        for place, names in islice(crawl(folder), EVIDENCE_LIMIT)
    )


# The options of spawn_entity.py and of create, with a name that is written out after them.
NAMED = lazy_pattern(r"""['"]-(?:entity|name)['"]\s*,\s*['"]([^'"]+)['"]""")


def ignored_packages(workspace: Workspace) -> Iterator[tuple[Path, Path]]:
    """Yield the packages that colcon ignores, each with the marker file."""
    yield from ignored_below(workspace.source)


def ignored_below(root: Path) -> Iterator[tuple[Path, Path]]:
    """Yield the packages in a folder that colcon ignores, each with the marker file.

    Those that it has built or installed itself are left out.
    """
    for folder, names in crawl(root, with_ignored=True):
        if "package.xml" not in names:
            continue
        depth = len(folder.relative_to(root).parts)
        around = (folder, *folder.parents)[: depth + 1]
        if any((parent / name).exists() for parent in around for name in WRITTEN_BY_COLCON):
            continue
        for parent in around:
            for marker in sorted(IGNORE_MARKERS):
                if (parent / marker).exists():
                    yield folder, parent / marker


def ignored_package(workspace: Workspace, name: str) -> RequestError | None:
    """The error for the name of a package that colcon ignores; None where it ignores none."""
    for folder, marker in ignored_packages(workspace):
        package = read_package(folder)
        if package is not None and package.name == name:
            return RequestError(
                f"colcon ignores the package {name} in {folder}, because {marker} exists.",
                hint=f"Remove {marker} to build the package.",
            )
    return None


def spawned_entities(workspace: Workspace) -> frozenset[str]:
    """Find the names in the launch files of its packages, except computed ones."""
    return frozenset(
        name
        for package in find_packages(workspace)
        for file in sorted(package.path.glob("launch/*.py"))
        for name in NAMED.findall(read_or_empty(file))
    )


# As tried: with `$`, `:` and the backquote the build passes, but sourcing the install space does
# not bring in the package; with the others CMake fails, or loses a part of the path.
REFUSED = frozenset(';$:`"\\[]?<>\n\r')


def check_workspace_path(path: Path) -> None:
    """Stop if the path has a character that breaks builds.

    Raises:
        RequestError: it has one.
    """
    refused = sorted(REFUSED.intersection(str(path)))
    if refused:
        named = " and ".join("a line break" if sign in "\n\r" else sign for sign in refused)
        raise RequestError(
            f"A workspace cannot be in {str(path)!r}: CMake and colcon do not support {named} "
            "in a path.",
            hint="Rename the folder, or use another one; letters, digits, spaces, `-`, `_` and "
            "`.` are safe.",
        )
