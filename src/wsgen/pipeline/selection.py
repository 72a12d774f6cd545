"""Which packages are judged, and by which of their launch files."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.errors import NotFoundError, RequestError
from wsgen.pipeline.launch_files import find_launch_files, may_spawn, name_launch_file
from wsgen.workspace.layout import find_packages
from wsgen.workspace.overlay import require_share

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.pipeline.request import ValidateRequest
    from wsgen.workspace.layout import Workspace
    from wsgen.workspace.overlay import Overlay


@dataclass(frozen=True, kw_only=True)
class Chosen:
    """A package to judge; without a launch file, the problem says why there is none."""

    name: str
    source: Path | None  # None: of an underlay
    share: Path | None  # None: not installed
    launch_file: Path | None = None
    problem: Diagnostic | None = None


def choose(
    workspace: Workspace, overlay: Overlay, request: ValidateRequest
) -> tuple[tuple[Chosen, ...], tuple[str, ...]]:
    """The packages to judge, and the names of those that are left out as they spawn nothing.

    Raises:
        RequestError: a package or launch file that is named does not exist, or it is not clear
            which launch file of a named package is meant.
        NotFoundError: a named package is not built, or there is nothing to judge.
    """
    sources = {package.name: package.path for package in find_packages(workspace)}
    if request.packages:
        return tuple(
            _choose_named(name, sources, workspace, overlay, request.launch_file)
            for name in dict.fromkeys(request.packages)
        ), ()
    if not sources:
        raise NotFoundError(
            f"There is no package in {workspace.root}.", hint="Make one with: wsgen new PACKAGE"
        )
    if len(sources) == 1:
        (name,) = sources
        return (_choose_named(name, sources, workspace, overlay, request.launch_file),), ()
    chosen, left_out = [], []
    for name, source in sources.items():
        package = _choose_unnamed(name, source, overlay.share(name), request.launch_file)
        if package is None:
            left_out.append(name)
        else:
            chosen.append(package)
    if not chosen:
        raise NotFoundError(
            f"No package of {workspace.root} has a launch file that spawns a robot"
            + (f" called {request.launch_file}." if request.launch_file else "."),
            hint="Name a package to see what it lacks: wsgen validate PACKAGE",
        )
    return tuple(chosen), tuple(left_out)


def _choose_named(
    name: str,
    sources: dict[str, Path],
    workspace: Workspace,
    overlay: Overlay,
    wanted: str | None,
) -> Chosen:
    if not re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_-]*", name):
        near = name.strip("./").rpartition("/")[2]
        raise RequestError(
            f"{name!r} is not the name of a package.",
            hint=f"Write: wsgen validate {near}"
            if near in sources
            else "Give the name of a package, or a .urdf, .xacro, .sdf or .world file.",
        )
    share = require_share(overlay, workspace, name)
    source = sources.get(name)
    files = find_launch_files(share)
    if wanted is not None:
        file = name_launch_file(files, wanted)
        if file is None:
            raise RequestError(
                f"{name} has not installed a launch file {wanted}.",
                hint=f"Installed: {', '.join(file.name for file in files) or 'none'}.",
            )
        return Chosen(name=name, source=source, share=share, launch_file=file)
    if not files:
        problem = _no_launch_file(source, share)
        return Chosen(name=name, source=source, share=share, problem=problem)
    spawning = [file for file in files if may_spawn(file)] or list(files)
    if len(spawning) > 1:
        raise RequestError(
            f"{name} has several launch files that may spawn a robot.",
            hint=f"Choose one with --launch: {', '.join(file.name for file in spawning)}.",
        )
    return Chosen(name=name, source=source, share=share, launch_file=spawning[0])


def _choose_unnamed(
    name: str, source: Path, share: Path | None, wanted: str | None
) -> Chosen | None:
    """One of several packages; None where neither source nor install space spawns a robot.

    What is wrong with one package is its own problem, so that the others are judged.
    """
    files = find_launch_files(share) if share else ()
    if wanted is not None:
        file = name_launch_file(files, wanted)
        if file is None:
            return None
        return Chosen(name=name, source=source, share=share, launch_file=file)
    spawning = [file for file in files if may_spawn(file)]
    written = [file for file in find_launch_files(source) if may_spawn(file)]
    if len(spawning) == 1:
        return Chosen(name=name, source=source, share=share, launch_file=spawning[0])
    if spawning:
        problem = _several_launch_files(name, spawning)
    elif not written:
        return None
    elif share is None:
        problem = _not_built(name, source)
    else:
        problem = _no_launch_file(source, share)
    return Chosen(name=name, source=source, share=share, problem=problem)


def _no_launch_file(source: Path | None, share: Path) -> Diagnostic:
    if source is not None and find_launch_files(source):
        return Diagnostic(
            code="PKG050",
            severity=Severity.ERROR,
            message="The package has a launch file, but does not install it.",
            file=source / "CMakeLists.txt",
            hint="Write in CMakeLists.txt: install(DIRECTORY launch DESTINATION "
            "share/${PROJECT_NAME}); then run `wsgen build`.",
        )
    return Diagnostic(
        code="PKG051",
        severity=Severity.ERROR,
        message="The package has no launch file.",
        file=source or share,
        hint="Launch files are named *.launch.py and lie in the package's folder launch/, which "
        "CMakeLists.txt installs.",
    )


def _not_built(name: str, source: Path) -> Diagnostic:
    return Diagnostic(
        code="PKG053",
        severity=Severity.ERROR,
        message=f"{name} is not installed: it was not built, or its build failed.",
        file=source,
        hint=f"Run: wsgen build {name}",
    )


def _several_launch_files(name: str, files: list[Path]) -> Diagnostic:
    names = ", ".join(file.name for file in files)
    return Diagnostic(
        code="PKG054",
        severity=Severity.ERROR,
        message=f"Several launch files may spawn a robot: {names}.",
        file=files[0].parent,
        hint=f"Choose one: wsgen validate {name} --launch {files[0].name}",
    )
