"""Source the overlay: the environment of a user after `source install/setup.bash`."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.suggestions import suggest
from wsgen.values import dataclass
from wsgen.workspace.layout import Workspace, find_packages

if TYPE_CHECKING:
    from collections.abc import Mapping


INDEX = Path("share", "ament_index", "resource_index", "packages")
SECONDS_TO_SOURCE = 300.0  # wall-clock; a setup file may never end, and the machine may be busy


@dataclass(frozen=True, kw_only=True)
class Overlay:
    """A sourced install space."""

    install: Path
    environment: Mapping[str, str]
    prefixes: tuple[Path, ...]  # of AMENT_PREFIX_PATH: the first that has a package wins

    def share(self, package: str) -> Path | None:
        """Find the package's share folder as ament_index does; None if it is not installed."""
        for prefix in self.prefixes:
            if (prefix / INDEX / package).is_file():
                return prefix / "share" / package
        return None

    def packages(self) -> tuple[str, ...]:
        """List the names of the packages of this install space, without those of its underlays."""
        names = {
            marker.name
            for prefix in self.prefixes
            if prefix.is_relative_to(self.install) and (prefix / INDEX).is_dir()
            for marker in (prefix / INDEX).iterdir()
        }
        return tuple(sorted(names))


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


def require_share(overlay: Overlay, workspace: Workspace | None, package: str) -> Path:
    """Find the package's share folder.

    Raises:
        NotFoundError: the package is in the workspace but not installed.
        RequestError: the package is unknown.
    """
    share = overlay.share(package)
    if share is not None:
        return share
    written = [] if workspace is None else [found.name for found in find_packages(workspace)]
    if package in written:
        raise NotFoundError(
            f"The package {package} is in {workspace and workspace.root} but not installed.",
            hint=f"Build it: wsgen build {package}",
        )
    raise RequestError(
        f"Package {package} does not exist.",
        hint=suggest(package, {*written, *overlay.packages()}),
    )


def _choose_shell(install: Path, environment: Mapping[str, str]) -> tuple[str, Path]:
    """Choose bash, as users do, or sh if it is missing."""
    setups = [("bash", install / "setup.bash"), ("sh", install / "setup.sh")]
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
