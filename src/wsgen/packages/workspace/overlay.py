"""Source the overlay: the environment of a user after `source install/setup.bash`."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
from contextlib import contextmanager
from dataclasses import field, replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.isolation.parent import make_scratch
from wsgen.packages.source_shares import INDEX, is_used, note_use, serve_sources
from wsgen.packages.workspace.layout import (
    BUILD_RESULT,
    Workspace,
    find_packages,
    ignored_package,
    with_surroundings,
)
from wsgen.text.files import read_regular_text
from wsgen.text.suggestions import advice, some_of, suggest
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from wsgen.packages.workspace.layout import PackageFolder


SETUPS = {"bash": "setup.bash", "sh": "setup.sh"}
SECONDS_TO_SOURCE = 300.0  # wall-clock; a setup file may never end, and the machine may be busy


NAMED = 5  # at most so many packages are named in a message

SOURCE_USED = Rule(
    code="PKG065",
    name="source-used",
    severity=Severity.INFO,
    severity_varies="an error where the package is built and not registered",
    summary="A package is not built, or not registered; its source folder is used as its share "
    "folder.",
    what="Looks for packages of the workspace, or of the repository, that no install space has in "
    "its ament index and that the launch files and robots look up.",
    why="The robot is simulated as if each package installed every file under its own name. "
    "`ros2 launch` finds only what is built, and what CMakeLists.txt or setup.py installs.",
    example="git clone …/my_robot\nwsgen validate",
    instead="git clone …/my_robot\nwsgen build\nwsgen validate",
)


@dataclass(frozen=True, kw_only=True)
class Overlay:
    """A sourced install space."""

    install: Path
    environment: Mapping[str, str]
    prefixes: tuple[Path, ...]  # of AMENT_PREFIX_PATH: the first that has a package wins
    # Packages of the workspace that are not installed -> their source, which serves as share folder
    sources: Mapping[str, Path] = field(default_factory=dict)
    # Those of `sources` that colcon has built; the ament index does not have them.
    unregistered: frozenset[str] = frozenset()
    workspaces: tuple[Workspace, ...] = ()  # that it is of
    written: tuple[PackageFolder, ...] = ()  # the packages of these, with what is wrong in them

    def ignored(self, package: str) -> RequestError | None:
        """The error for a package of the workspaces that colcon ignores; None where it is none."""
        found = (ignored_package(workspace, package) for workspace in self.workspaces)
        return next(filter(None, found), None)

    def share(self, package: str) -> Path | None:
        """Find the package's share folder as ament_index does; None if it does not exist.

        An installed package wins over one that is not built, whose source folder it is.
        """
        for prefix in self.prefixes:
            if (prefix / INDEX / package).is_file():
                return prefix / "share" / package
        return self.sources.get(package)

    def look_up(self, package: str) -> Path | None:
        """Find the package's share folder for what is validated, which then uses the package."""
        share = self.share(package)
        if share is not None:
            note_use(package, self.environment)
        return share

    def packages(self) -> tuple[str, ...]:
        """List the names of the packages of this install space, and of those served by sources."""
        names = {
            marker.name
            for prefix in self.prefixes
            if prefix.is_relative_to(self.install) and (prefix / INDEX).is_dir()
            for marker in (prefix / INDEX).iterdir()
        }
        return tuple(sorted({*names, *self.sources}))

    def not_built(self, explained: Collection[str] = ()) -> tuple[Diagnostic, ...]:
        """Say which packages were looked up that no ament index has; nothing where all are there.

        They are not built, or their build does not register them; `explained` are those of which
        something else says that.
        """
        used = sorted(
            name
            for name in self.sources
            if name not in explained and is_used(name, self.environment)
        )
        return (
            *self._sources_used(
                [name for name in used if name not in self.unregistered],
                "Not built",
                "Run `wsgen build` to check what the packages install, too.",
            ),
            *self._sources_used(
                [name for name in used if name in self.unregistered],
                "Built, but not registered in the ament index, where ROS looks",
                "Call ament_package() at the end of CMakeLists.txt, then run `wsgen build`.",
                Severity.ERROR,
            ),
        )

    def _sources_used(
        self, names: Sequence[str], why: str, hint: str, severity: Severity | None = None
    ) -> Iterator[Diagnostic]:
        if names:
            folders = "Source folders are" if len(names) > 1 else "Its source folder is"
            yield SOURCE_USED.at(
                self.sources[names[0]] if len(names) == 1 else None,
                message=f"{why}: {some_of(names, NAMED)}. "
                f"{folders} used as share folder{'s' if len(names) > 1 else ''}.",
                hint=hint,
                severity=severity,
            )


def source_overlay(place: Workspace | Path, environment: Mapping[str, str]) -> Overlay:
    """Source the setup file of a workspace, or of an install folder, in a shell.

    Args:
        place: a workspace, or a folder with setup.bash or setup.sh.
        environment: the variables to begin with.

    Raises:
        NotFoundError: it has not been built, or no shell was found.
        NotReadableError: the setup file fails.
    """
    install = place.install if isinstance(place, Workspace) else place.absolute()
    shell, setup = _choose_shell(install, environment)
    try:
        finished = subprocess.run(
            [shell, "-c", '. "$0" >&2 && env -0', str(setup)],
            # A sourced setup.sh cannot know its own path, and the one that colcon wrote into it
            # must not have spaces; setup.bash ignores it.
            env={**environment, "COLCON_CURRENT_PREFIX": str(install)},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
            timeout=SECONDS_TO_SOURCE,
        )
    except subprocess.TimeoutExpired as error:
        raise NotReadableError(
            f"Sourcing {setup} did not end within {SECONDS_TO_SOURCE:g} s.",
            hint="Try again when the machine is less busy, or find where it waits: "
            f"{Path(shell).name} -xc '. {setup}'",
        ) from error
    if finished.returncode != 0 or not finished.stdout:
        said = finished.stderr.decode("utf-8", "replace").strip().splitlines()[-3:]
        raise NotReadableError(
            f"{setup} cannot be sourced: {' / '.join(said) or 'it fails without output'}.",
            hint=f"Remove {install} and build again: wsgen build",
        )
    variables = _read_variables(finished.stdout)
    variables.pop("COLCON_CURRENT_PREFIX", None)
    prefixes = variables.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    return Overlay(
        install=install,
        environment=variables,
        prefixes=tuple(Path(prefix) for prefix in prefixes if prefix),
    )


def overlay_of(environment: Mapping[str, str]) -> Overlay:
    """The overlay that is sourced in an environment; it may have no prefix."""
    path = environment.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    prefixes = tuple(Path(prefix) for prefix in path if prefix)
    return Overlay(
        install=prefixes[0] if prefixes else Path(),
        environment=dict(environment),
        prefixes=prefixes,
    )


@contextmanager
def open_overlay(
    workspaces: Sequence[Workspace], environment: Mapping[str, str], *, near: Path | None = None
) -> Iterator[Overlay]:
    """Source the workspaces, as far as they are built, the last one over the others.

    The source folders of their other packages, and of those around a workspace that is a package
    in a clone, serve as share folders while the context is open. Of
    packages with one name the one that `near` lies in counts, else the first.

    Raises:
        NotFoundError: no shell was found.
        NotReadableError: a setup file fails.
    """
    overlay = overlay_of(environment)
    places = tuple(
        dict.fromkeys(place for workspace in workspaces for place in with_surroundings(workspace))
    )
    sources: dict[str, Path] = {}
    built: set[str] = set()
    written: list[PackageFolder] = []
    for workspace in places:
        if any((workspace.install / setup).is_file() for setup in SETUPS.values()):
            overlay = source_overlay(workspace, overlay.environment)
        for package in find_packages(workspace):
            written.append(package)
            is_near = near is not None and near.is_relative_to(package.path)
            if re.fullmatch(r"[\w-]+", package.name) and not package.diagnostics:
                sources[package.name] = (
                    package.path if is_near else sources.get(package.name, package.path)
                )
                if _is_built(workspace, package.name):
                    built.add(package.name)
    sources = {name: path for name, path in sources.items() if overlay.share(name) is None}
    overlay = replace(overlay, workspaces=places, written=tuple(written))
    if not sources:
        yield overlay
        return
    with make_scratch() as folder:
        variables = serve_sources(sources, folder, overlay.environment)
        yield replace(
            overlay,
            environment=variables,
            sources=sources,
            unregistered=frozenset(built & sources.keys()),
        )


def _is_built(workspace: Workspace, package: str) -> bool:
    """Whether colcon has built a package: it then writes what sources it, merged or not.

    An older build may have written that: the last one must not have failed.
    """
    try:
        result = read_regular_text(workspace.build / package / BUILD_RESULT, errors="replace")
    except OSError:
        result = "0"  # of another build folder
    return result.strip() == "0" and any(
        (prefix / "share" / package / "package.sh").is_file()
        for prefix in (workspace.install / package, workspace.install)
    )


def require_share(overlay: Overlay, workspace: Workspace | None, package: str) -> Path:
    """Find the package's share folder.

    Raises:
        NotFoundError: the package is in the workspace, but its package.xml cannot be read.
        RequestError: the package is unknown.
    """
    share = overlay.share(package)
    if share is not None:
        return share
    for found in () if workspace is None else find_packages(workspace):
        if found.name == package and found.diagnostics:
            problem = found.diagnostics[0]
            raise NotFoundError(
                f"The package {package} cannot be read: {problem.message}", hint=problem.hint or ""
            )
    ignored = None if workspace is None else ignored_package(workspace, package)
    if ignored is not None:
        raise ignored
    known = overlay.packages()
    if workspace is None or not known:  # what is known is what wsgen or ROS brings
        hint = advice(
            package, known, "Go to the workspace of the package, or source its install/setup.bash."
        )
    else:
        hint = suggest(package, known)
    if os.path.isdir(package):  # noqa: PTH112  a name may hold what no path can
        hint = f"Select packages by name, not by folder. {hint}"
    raise RequestError(f"Package {package} does not exist.", hint=hint)


def _choose_shell(install: Path, environment: Mapping[str, str]) -> tuple[str, Path]:
    """Choose bash, as users do, or sh if it is missing."""
    setups = [(shell, install / setup) for shell, setup in SETUPS.items()]
    written = [(name, setup) for name, setup in setups if setup.is_file()]
    if not written:
        raise NotFoundError(
            f"The workspace is not built: {setups[0][1]} does not exist.",
            hint="Build the workspace: wsgen build",
        )
    for name, setup in written:
        shell = shutil.which(name, path=environment.get("PATH", os.defpath))
        if shell is not None:
            return shell, setup
    raise NotFoundError(
        f"No shell was found to source {written[0][1]}.",
        hint="Install bash, or put it on PATH.",
    )


def _read_variables(output: bytes) -> dict[str, str]:
    """Read the output of `env -0`; bytes that are not UTF-8 become surrogates."""
    pairs = (os.fsdecode(entry).partition("=") for entry in output.split(b"\0") if entry)
    return {name: value for name, equals, value in pairs if equals}
