"""What the simulator of a launch has: where it looks for meshes, and the systems of its world."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.launch_files import VARIABLES, SearchPath, mesh_packages, no_resource_path
from wsgen.checks.rules.systems import (
    Need,
    Place,
    WorldSystems,
    missing_default_systems,
    missing_sensor_systems,
    needs_of,
    place_of,
    systems_of_shipped,
    systems_of_world,
    systems_within,
)
from wsgen.descriptions.sdf.lookup import is_brought_along
from wsgen.descriptions.sdf.source import load, read_document
from wsgen.gazebo.systems import DEFAULT_SYSTEMS, loaded_class
from wsgen.launching.commands import started_launch_files, started_programs
from wsgen.launching.explain_missing import where_written
from wsgen.launching.simulators import simulator_kinds
from wsgen.model.target import CLASSIC, SIM
from wsgen.packages.source_shares import may_have_sources
from wsgen.packages.workspace.layout import INSTALL_LAYOUT
from wsgen.text.files import bytes_or_empty, real_path
from wsgen.text.xmltree import Malformed, children, parse

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan, Process
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.started import Started
    from wsgen.text.xmltree import Element


# The launch files that give Gazebo the exports of all package.xml, by package; up to their dot.
_READERS = {
    "gazebo_ros": (CLASSIC, ("gazebo", "gzserver")),
    "ros_gz_sim": (SIM, ("gz_sim", "gz_server", "ros_gz_sim")),
}
LIMIT = 2**20  # bytes
_SCRIPTS = (".bash", ".sh", ".sh.in", ".zsh")
_BUILD_FILES = ("CMakeLists.txt", "setup.py")


def check_search_path(
    started: Started, overlay: Overlay, environment: Mapping[str, str], sources: Iterable[Path]
) -> Iterator[Diagnostic]:
    """Report robots whose meshes the simulator of the launch does not find.

    Args:
        started: What the launch file starts.
        overlay: The packages.
        environment: That of the launch, with what the launch file sets.
        sources: The source folders of the workspace, as far as `overlay` does not have them.
    """
    plan, kinds = started.plan, simulator_kinds(started.plan)
    own = set(overlay.packages())
    used = {one for spawn in started.spawns for one in mesh_packages(spawn.description)} & own
    if len(kinds) != 1 or not used:
        return
    (kind,) = kinds
    folders = [*_folders(plan, kind, environment)]
    if any(map(plan.is_unknown, folders)):
        return
    exports = _exports(overlay)
    reads = _reads_exports(plan, kind)
    other = CLASSIC if kind == SIM else SIM
    set_here = {**plan.environment, **overlay.environment}
    path = SearchPath(
        folders=(*folders, *(folder for one in exports.values() for folder in one if reads)),
        reads_exports=reads,
        has_exports=any(exports.get(one) for one in used),
        set_in_vain=next((name for name in VARIABLES[other] if set_here.get(name)), ""),
    )
    is_merged = _is_merged(overlay)

    def has(package: str) -> bool:
        share = overlay.share(package)
        exported = [
            folder
            for one, given in exports.items()
            for folder in given
            # Each package has a prefix of its own, where wsgen has laid out one for all.
            if one == package or is_merged or share is None or Path(folder) != share.parent
        ]
        places = (*folders, *(exported if reads else ()), *_models_of_home(kind, environment))
        # The folder of a package that is not built may have another name.
        source = share.parent if share is not None and share in overlay.sources.values() else None
        return any(
            Path(folder, package).is_dir() or Path(os.path.normpath(folder)) == source
            for folder in places
        )

    missing = {package for package in used if not has(package)}
    if missing and not _is_set_by_hand(kind, overlay, sources):
        yield from no_resource_path(started.spawns, kind, path, missing.__contains__)


def environment_of_simulator(started: Started, overlay: Overlay) -> dict[str, str]:
    """The environment that the launch starts its simulator in, with the exports of package.xml."""
    plan = started.plan
    found = {**overlay.environment, **plan.environment}
    for server in _servers(plan):
        found.update(server.environment)
    for kind in simulator_kinds(plan):
        folders = [*_folders(plan, kind, found)]
        if _reads_exports(plan, kind):
            folders += (folder for one in _exports(overlay).values() for folder in one)
        for name in VARIABLES[kind][:2] if folders else ():
            found[name] = os.pathsep.join(dict.fromkeys(folders))
    return found


def _folders(plan: LaunchPlan, kind: str, environment: Mapping[str, str]) -> Iterator[str]:
    """The folders of the variables, as the launch and the process of the simulator have them."""
    for variables in (environment, *(one.environment for one in started_programs(plan))):
        for name in VARIABLES[kind]:
            yield from filter(None, variables.get(name, "").split(os.pathsep))


def _models_of_home(kind: str, environment: Mapping[str, str]) -> tuple[str, ...]:
    home = environment.get("HOME")
    return (f"{home}/.gazebo/models",) if home and kind == CLASSIC else ()


def _reads_exports(plan: LaunchPlan, kind: str) -> bool:
    """Whether what starts the simulator gives it the exports of package.xml."""
    return any(
        kind == of and include.file.name.partition(".")[0] in names
        for include in started_launch_files(plan)
        for of, names in (_READERS.get(include.package or "", ("", ())),)
    ) or any(one.package == "ros_gz_sim" and kind == SIM for one in _servers(plan))


def _servers(plan: LaunchPlan) -> Iterator[Process]:
    return (one for one in started_programs(plan) if "gzserver" in (one.executable or "").lower())


def _exports(overlay: Overlay) -> dict[str, list[str]]:
    """The folders of `<gazebo_ros gazebo_model_path=...>`, by the package that exports them."""
    found: dict[str, list[str]] = {}
    for package in overlay.packages():
        share = overlay.share(package)
        root = None if share is None else parse(bytes_or_empty(share / "package.xml", LIMIT))
        if share is None or root is None or isinstance(root, Malformed):
            continue
        for export in children(root, "export"):
            for one in children(export, "gazebo_ros"):
                text = (one.get("gazebo_model_path") or "").replace("${prefix}", str(share))
                folders = map(os.path.normpath, filter(None, text.split(os.pathsep)))
                found.setdefault(package, []).extend(folders)
    return found


def _is_merged(overlay: Overlay) -> bool:
    """Whether all packages of the workspace are built into one prefix."""
    places = (overlay.install, *(one.root / "install" for one in overlay.workspaces))
    return any(
        bytes_or_empty(place / INSTALL_LAYOUT, LIMIT).strip() == b"merged" for place in places
    )


def _is_set_by_hand(kind: str, overlay: Overlay, sources: Iterable[Path]) -> bool:
    """Whether a script or a hook of the workspace sets a variable in a way that is not evaluated.

    Somebody may have to source it. Hooks are evaluated, but for those of packages that are not
    built, and of what no function of ament does.
    """
    shares = filter(None, map(overlay.share, overlay.packages()))
    manifests = (Path(real_path(share / "package.xml")) for share in shares)
    folders = {*(one.parent for one in manifests), *sources}
    not_built = set(overlay.sources.values())
    names = "|".join(VARIABLES[kind])
    setting = re.compile(rf"(?m)^(?!\s*#).*\b(?:{names})\b".encode())
    plain = re.compile(rf"(?m)^(?!\s*#|\s*ament_\w+_value).*\b(?:{names})\b".encode())
    for folder in folders:
        has_hooks = any(
            b"environment_hooks" in bytes_or_empty(folder / one, LIMIT) for one in _BUILD_FILES
        )
        for file in _files(folder):
            text = bytes_or_empty(file, LIMIT)
            if ".dsv" in file.name:
                is_set = folder in not_built and setting.search(text) is not None
            else:
                is_set = plain.search(text) is not None
            is_hook = "hook" in file.parent.name or "env" in file.parent.name
            if is_set and (has_hooks or not is_hook):
                return True
    return False


def _files(folder: Path) -> Iterator[Path]:
    for place, names, files in os.walk(folder):
        names[:] = filter(may_have_sources, names)
        for name in files:
            if name.endswith((*_SCRIPTS, ".dsv", ".dsv.in")) or name == "Dockerfile":
                yield Path(place, name)


class StartedWorld(NamedTuple):
    """The world that a launch starts in Gazebo Sim, as its systems are concerned."""

    element: Element | None  # None: one that Gazebo brings along
    file: Path | None
    distro: str | None
    defaults: tuple[str, ...]  # the classes in server.config

    def systems(self, *, is_lenient: bool = False) -> WorldSystems | None:
        """Those that it loads; None where that is not known."""
        if self.element is None and self.file is not None:
            return systems_of_shipped(self.file.name)
        return systems_of_world(self.element, self.distro, self.defaults, is_lenient=is_lenient)


def find_started_world(
    started: Started,
    file: Path | None,
    *,
    environment: Mapping[str, str],
    distro: str | None,
) -> StartedWorld | None:
    """The world of a launch; None of Gazebo Classic, and where it is not known.

    Args:
        started: What the launch file starts.
        file: The file of its world, where it has been found.
        environment: That of the launch, with what the launch file sets.
        distro: The distribution, if it is known.
    """
    simulator, defaults = started.simulator, _defaults(environment)
    if simulator is None or simulator.kind != "gz" or defaults is None:
        return None
    if not simulator.world:
        return StartedWorld(None, None, distro, defaults) if simulator.is_world_known else None
    if file is None:
        is_shipped = is_brought_along(simulator.world)
        return StartedWorld(None, Path(simulator.world), distro, defaults) if is_shipped else None
    source = load(file, [])
    world = None if source is None else next(children(source.root, "world"), None)
    return None if world is None else StartedWorld(world, file, distro, defaults)


# Where Gazebo finds its server.config if not in the home directory.
_CONFIG_VARIABLES = ("GZ_SIM_SERVER_CONFIG_PATH", "IGN_GAZEBO_SERVER_CONFIG_PATH")


def _defaults(environment: Mapping[str, str]) -> tuple[str, ...] | None:
    """The classes in server.config; None where that cannot be read."""
    named = next((environment[one] for one in _CONFIG_VARIABLES if environment.get(one)), None)
    if named is None:
        return DEFAULT_SYSTEMS
    source = load(Path(named), [])
    if source is None:
        return None
    plugins = source.root.iter("plugin")
    names = (loaded_class(one.get("filename") or "", one.get("name") or "") for one in plugins)
    return tuple(name for name in names if name)


def check_systems(
    started: Started, world: StartedWorld, files: Collection[Path]
) -> Iterator[Diagnostic]:
    """Report what of the robots and of the world has no system that simulates it.

    `files` are those that the world and what is spawned were read from.
    """
    systems = world.systems(is_lenient=True)
    if systems is None:
        return
    roots = [root for root in _roots(started, files) if root is not world.element]
    needs: list[Need] = []
    within: set[str] = set()
    for root in roots:
        within |= systems_within(root)
        needs += needs_of(root, world.distro)
    if world.element is not None and world.file is not None:
        yield from missing_default_systems(world.element, world.file, systems, is_spawned_into=True)
        place = place_of(world.element, world.file)
    else:
        place = _place_of_start(started.plan, world.file)
    yield from missing_sensor_systems(place, systems, within, needs, is_spawned_into=True)


def _roots(started: Started, files: Collection[Path]) -> Iterator[Element]:
    """The robots that are spawned, and the documents of the world and its models."""
    for text in dict.fromkeys(spawn.description for spawn in started.spawns):
        if "<sensor" in text or "<plugin" in text:
            root, _ = read_document(text)
            if root is not None:
                yield root
    for file in sorted(files):
        source = load(file, [])
        if source is not None:
            yield source.root


def _place_of_start(plan: LaunchPlan, world: Path | None) -> Place:
    """The launch file, at the line that starts Gazebo without a world of the workspace."""
    texts = (*((world.name,) if world else ()), "gz_args", "gz_sim.launch.py", "ros_gz_sim")
    found = (where_written(text, plan.evaluated_files) for text in texts)
    file, line = next((one for one in found if one), (plan.launch_file, None))
    subject = f"The world `{world.name}` of Gazebo" if world else "The empty world of Gazebo"
    return Place(Path(file), line, world.name if world else None, subject, is_file=False)
