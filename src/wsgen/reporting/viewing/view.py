"""Show the robots of a package or file, and show them again when one of their files changes.

Files are looked at by their times and sizes: of some hundred files it takes 1 ms. The events of a
system are not used: they are lost on network drives and in containers.
"""

from __future__ import annotations

import errno
import os
import socket
import time
from collections import Counter
from contextlib import ExitStack
from html import escape
from typing import TYPE_CHECKING, Protocol

from wsgen.diagnostics import Severity, has_errors
from wsgen.errors import NotFoundError, RequestError, WsgenError
from wsgen.isolation.parent import make_scratch
from wsgen.packages.source_shares import BUILD_FOLDERS
from wsgen.pipeline.file_validation import UNUSABLE_FILE
from wsgen.rendering.surfaces import forget_surfaces
from wsgen.reporting.viewing import INSTALL, LIBRARY, is_viewer_installed
from wsgen.reporting.viewing.drawing import draw
from wsgen.text.printable import count_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.pipeline.describe import DescribedScene
    from wsgen.reporting.viewing.drawing import DrawnRobot


LOOK_EVERY = 0.5  # s; between two looks at the files
QUIET_FOR = 0.2  # s without a change: an editor or a build has written all that it writes
MOST_LOOKS = 50  # at files that do not stop changing
DEFAULT_PORT = 8080
PORTS = 100  # that are tried from there


def check_viewer() -> None:
    """Check that the page can be served.

    Raises:
        NotFoundError: The library is not installed.
    """
    if not is_viewer_installed():
        raise NotFoundError(
            f"{LIBRARY}, which shows robots in a browser, is not installed.",
            hint=f"Install it: {INSTALL}",
        )


def choose_port(host: str, port: int | None) -> int:
    """The port to listen on: the one that is asked for, or the first free one.

    Raises:
        RequestError: It is taken, or there is no such address on this machine.
    """
    if port is not None:
        _try_port(host, port)
        return port
    for number in range(DEFAULT_PORT, DEFAULT_PORT + PORTS):
        try:
            _try_port(host, number)
        except PortTakenError:
            continue
        return number
    raise RequestError(
        f"All ports from {DEFAULT_PORT} to {DEFAULT_PORT + PORTS - 1} are taken.",
        hint="Choose another one: --port N",
    )


class PortTakenError(RequestError):
    """Something else listens there."""


def _try_port(host: str, port: int) -> None:
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        with socket.socket(family, kind, protocol) as trial:
            if os.name == "posix":  # as servers do: a connection that has ended keeps no port
                trial.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            trial.bind(address)
    except OSError as error:
        raise not_listening(host, port, error) from error


def not_listening(host: str, port: int, error: OSError) -> RequestError:
    """Why a page cannot be served there."""
    if error.errno in {errno.EADDRINUSE, errno.EACCES}:
        why = "is taken" if error.errno == errno.EADDRINUSE else "is reserved for the system"
        return PortTakenError(
            f"The port {port} of {host} {why}.",
            hint="Choose another one: --port N; without --port, a free one is chosen.",
        )
    return RequestError(
        f"wsgen cannot listen on {host}: {error.strerror or error}.",
        hint="Give an address of this machine: --host 127.0.0.1, or 0.0.0.0 for all.",
    )


class Viewer(Protocol):
    """What shows robots: `wsgen.reporting.viewing.page.JointPage`."""

    def show(self, robots: Sequence[DrawnRobot], *, links: str) -> None:
        """Show robots instead of those before."""

    def report(self, *, summary: str, diagnostics: str) -> None:
        """Show what is reported."""


class View:
    """The robots that `read` reads, on a page; read again when one of their files changes.

    `read` is given a folder for what it reads from meshes, which is there as long as the robots are
    shown: the page reads from it what it is asked to show.
    """

    def __init__(self, read: Callable[[Path], DescribedScene]) -> None:
        self._read = read
        self._watcher = Watcher()
        self._late: list[str] = []  # paths that changed while they were read
        self._robots: list[DrawnRobot] = []
        self._shown: DescribedScene | None = None
        self._folder = ExitStack()  # of what is shown

    def close(self) -> None:
        """Remove the folder."""
        self._folder.close()

    def open(self, viewer: Viewer | None = None) -> DescribedScene:
        """Read the robots; show them if there is a viewer, and what is reported of them.

        Where an error in the files has taken a robot away, all stays as it was shown before.

        Raises:
            WsgenError: As `read`.
        """
        with ExitStack() as stack:
            found = self._read(stack.enter_context(make_scratch()))
            self._late = self._watcher.changed()
            self._watcher.watch(found.files)
            is_stale = self._lacks_robots(found)
            if not is_stale:
                forget_surfaces()
                self._robots, self._shown = draw(found), found
                if viewer is not None:
                    viewer.show(self._robots, links=links_table(self._robots))
                self._folder, before = stack.pop_all(), self._folder
                before.close()
        if viewer is not None:
            self._report(viewer, found.diagnostics, is_stale=is_stale)
        return found

    def show(self, viewer: Viewer) -> None:
        """Show what has been read."""
        viewer.show(self._robots, links=links_table(self._robots))
        if self._shown is not None:
            self._report(viewer, self._shown.diagnostics, is_stale=False)

    def _lacks_robots(self, found: DescribedScene) -> bool:
        """Whether errors have taken away a robot that is shown, or leave none to show."""
        if not found.can_be_shown:
            return True
        entities = {robot.entity for robot in found.robots if robot.readable is not None}
        before = {robot.entity for robot in self._robots if not robot.is_static_model}
        return has_errors(found.diagnostics) and not before <= entities

    def _report(self, viewer: Viewer, diagnostics: Sequence[Diagnostic], *, is_stale: bool) -> None:
        shown = self._shown
        viewer.report(
            summary=summary(
                shown.name if shown else "",
                shown.launch_file if shown else None,
                self._robots,
                diagnostics,
                is_stale=is_stale,
            ),
            diagnostics=diagnostics_list(diagnostics),
        )

    def follow(
        self,
        viewer: Viewer,
        *,
        on_change: Callable[[Sequence[str], DescribedScene | WsgenError], None],
        is_over: Callable[[], bool] = lambda: False,
    ) -> None:
        """Read and show the robots again at each change of a file, until it is over.

        `on_change` gets the paths that have changed, and what was read then. What cannot be read
        leaves on the page what is there, and what is reported about it.
        """
        while not is_over():
            time.sleep(LOOK_EVERY)
            changed = [*self._late, *self._watcher.changed()]
            if not changed:
                continue
            changed += self._wait_for_quiet()
            found: DescribedScene | WsgenError
            try:
                found = self.open(viewer)
            except WsgenError as error:  # the file is gone, for example, and may come back
                found, self._late = error, []
                problem = UNUSABLE_FILE.at(None, message=error.message, hint=error.hint)
                self._report(viewer, [problem], is_stale=True)
            on_change(list(dict.fromkeys(changed)), found)

    def _wait_for_quiet(self) -> list[str]:
        changed = []
        for _ in range(MOST_LOOKS):
            time.sleep(QUIET_FOR)
            more = self._watcher.changed()
            if not more:
                break
            changed += more
        return changed


MOST_FILES = 5_000  # that are looked at
LEFT_OUT = BUILD_FOLDERS | {"node_modules"}  # names of folders
MARKS = ("package.xml", "model.config")  # of a folder that belongs together
MOST_LEVELS = 6  # from a file to the folder of its package
OF_EDITORS = ("~", ".swp", ".swx", ".tmp", ".bak", ".orig", ".pyc", "4913")  # ends of names
OF_ROBOTS = (  # what a file outside of packages may refer to beside it
    *(".urdf", ".xacro", ".sdf", ".world", ".yaml", ".yml"),
    *(".stl", ".dae", ".obj", ".mtl", ".glb", ".gltf", ".bin", ".ply"),
    *(".png", ".jpg", ".jpeg"),
)

Signature = tuple[int, int, int] | None  # None: it does not exist


class Watcher:
    """Remembers how files are, and says which have changed.

    Watched are the files themselves, and all that is in the packages and models that they are in:
    what is missing now may be put there, and a mesh file names its textures itself.
    """

    def __init__(self, files: Iterable[Path] = ()) -> None:
        self._files: dict[str, Signature] = {}
        self._folders: dict[str, tuple[Signature, frozenset[str]]] = {}
        self.watch(files)

    def watch(self, files: Iterable[Path]) -> None:
        """Watch these files instead of those before, as they are now."""
        self._files, self._folders = {}, {}
        places: dict[Path, bool] = {}  # and whether it is a package, of which everything counts
        for file in files:
            self._files[str(file)] = _signature(str(file))
            package = _package_of(file)
            places[package or file.parent] = package is not None
        for place, is_package in places.items():
            if is_package:
                for folder, names, inner in _walk(str(place)):
                    self._folders[folder] = (_signature(folder), names)
                    self._add(folder, names - inner)
            else:
                beside = _names(str(place))
                self._add(str(place), (one for one in beside if one.lower().endswith(OF_ROBOTS)))

    def _add(self, folder: str, names: Iterable[str]) -> None:
        for name in names:
            path = os.path.join(folder, name)  # noqa: PTH118  thousands of them
            if len(self._files) < MOST_FILES and path not in self._files:
                self._files[path] = _signature(path)

    def changed(self) -> list[str]:
        """The paths that have changed since the last call, or since they are watched."""
        changed = []
        for path, before in self._files.items():
            now = _signature(path)
            if now != before:
                changed.append(path)
                self._files[path] = now
        for folder, (before, names) in self._folders.items():
            now = _signature(folder)
            if now != before:  # an editor's own files come and go, too
                found = _names(folder)
                changed += [os.path.join(folder, name) for name in sorted(found - names)]  # noqa: PTH118
                self._folders[folder] = (now, found)
        return changed


def _signature(path: str) -> Signature:
    try:
        found = os.stat(path)  # noqa: PTH116  thousands of them
    except (OSError, ValueError):
        return None
    return (found.st_mtime_ns, found.st_size, found.st_ino)


def _package_of(file: Path) -> Path | None:
    for folder in list(file.absolute().parents)[:MOST_LEVELS]:
        if any((folder / mark).is_file() for mark in MARKS):
            return folder
    return None


def _names(folder: str) -> frozenset[str]:
    """The names of files and folders in a folder that count."""
    try:
        names = os.listdir(folder)  # noqa: PTH208
    except OSError:
        return frozenset()
    return frozenset(
        name
        for name in names
        if name not in LEFT_OUT and not name.startswith(".") and not name.endswith(OF_EDITORS)
    )


def _walk(folder: str) -> Iterator[tuple[str, frozenset[str], frozenset[str]]]:
    """A folder and those below it: the names in it, and which of them are of folders."""
    waiting = [folder]
    count = 0
    while waiting and count < MOST_FILES:
        place = waiting.pop(0)
        names = _names(place)
        count += len(names) + 1
        paths = {name: os.path.join(place, name) for name in names}  # noqa: PTH118
        inner = frozenset(name for name, path in paths.items() if os.path.isdir(path))  # noqa: PTH112
        yield place, names, inner
        # A link may lead to a folder above.
        waiting += [paths[name] for name in sorted(inner) if not os.path.islink(paths[name])]  # noqa: PTH114


COLORS = {Severity.ERROR: "#c92a2a", Severity.WARNING: "#b35c00", Severity.INFO: "#1864ab"}
PLURALS = {Severity.ERROR: "errors", Severity.WARNING: "warnings", Severity.INFO: "notes"}
STYLE = (
    "font-size: 0.8em; line-height: 1.35; padding: 0 0.75em 0.5em 0.75em; overflow-wrap: anywhere"
)
CELL = "padding: 0.1em 0.4em 0.1em 0"
MARKDOWN = str.maketrans({character: f"\\{character}" for character in "\\`*_{}[]<>()#+-.!|~"})


def summary(
    name: str,
    launch_file: Path | None,
    robots: Sequence[DrawnRobot],
    diagnostics: Sequence[Diagnostic],
    *,
    is_stale: bool = False,
) -> str:
    """Markdown: what is shown, and how much is reported about it.

    It is stale where the files cannot be read any more: what is shown was read before.
    """
    lines = [f"**{plain(name)}**" + (f" {plain(launch_file.name)}" if launch_file else "")]
    subjects = [robot for robot in robots if not robot.is_static_model]
    for robot in subjects[:MOST_ROBOTS]:
        mass = sum(link.mass or 0.0 for link in robot.links)
        joints = len(robot.robot.movable_joints)
        lines.append(
            f"{plain(robot.entity)}: {mass:.4g} kg, {count_of(len(robot.links), 'link')}, "
            f"{count_of(joints, 'movable joint')}"
        )
    if len(subjects) > MOST_ROBOTS:
        lines.append(f"and {len(subjects) - MOST_ROBOTS} more robots")
    models = len(robots) - len(subjects)
    if models:
        lines.append(count_of(models, "model") + " of the world")
    counts = Counter(found.severity for found in diagnostics)
    if counts:
        parts = (
            count_of(counts[severity], PLURALS[severity][:-1])
            for severity in COLORS
            if counts[severity]
        )
        lines.append(f"{', '.join(parts)}: see *Diagnostics*")
    if is_stale:
        lines.append("**The files have an error: the robot is shown as it was before.**")
    return "  \n".join(lines)


MOST_ROBOTS = 5  # that are named


def plain(text: str) -> str:
    """A text in which no character means something to Markdown, or is an element of HTML."""
    return " ".join(text.split()).translate(MARKDOWN)


def diagnostics_list(diagnostics: Sequence[Diagnostic]) -> str:
    """HTML: errors first; of each the message, the place and what to do."""
    if not diagnostics:
        return f'<div style="{STYLE}">No diagnostics.</div>'
    order = list(COLORS)
    ordered = sorted(diagnostics, key=lambda found: order.index(found.severity))
    return f'<div style="{STYLE}">{"".join(map(_diagnostic, ordered))}</div>'


def _diagnostic(found: Diagnostic) -> str:
    place = ""
    if found.file is not None:
        line = "" if found.line is None else f":{found.line}"
        place = f"<br><code>{escape(found.file.name)}{line}</code>"
        place = f'<span title="{escape(str(found.file))}">{place}</span>'
    hint = f"<br><i>{escape(found.hint)}</i>" if found.hint else ""
    return (
        f'<p style="margin: 0.6em 0"><b style="color: {COLORS[found.severity]}">'
        f"{found.severity.value}</b> {escape(found.name)}<br>"
        f"{escape(found.message)}{place}{hint}</p>"
    )


def links_table(robots: Sequence[DrawnRobot]) -> str:
    """HTML: the links of the robots, with their masses and what joins them."""
    subjects = [robot for robot in robots if not robot.is_static_model]
    return f'<div style="{STYLE}">{"".join(_table(robot) for robot in subjects)}</div>'


def _table(robot: DrawnRobot) -> str:
    rows = "".join(_rows(robot))
    return (
        f"<p><b>{escape(robot.entity)}</b></p>"
        '<table style="border-collapse: collapse; width: 100%; text-align: left">'
        f'<tr><th style="{CELL}">link</th><th style="{CELL}">mass, kg</th>'
        f'<th style="{CELL}">joint</th></tr>{rows}</table>'
    )


def _rows(robot: DrawnRobot) -> Iterator[str]:
    for link in robot.links:
        joint = "" if link.joint is None else f"{link.joint.name} ({link.joint.type.value})"
        mass = "" if link.mass is None else f"{link.mass:.4g}"
        cells = (link.name, mass, joint)
        yield (
            "<tr>" + "".join(f'<td style="{CELL}">{escape(cell)}</td>' for cell in cells) + "</tr>"
        )
