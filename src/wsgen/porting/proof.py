"""The proof of a port: the robots before and after, simulated in the same engine and compared.

"Before" is the package as it is, and "after" the port in memory; of a package that is ported
already, "before" is a commit.
"""

from __future__ import annotations

import math
import os
import shutil
import subprocess
from collections import Counter, defaultdict
from contextlib import suppress
from operator import itemgetter
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import RequestError
from wsgen.isolation.parent import make_scratch
from wsgen.model.transform import multiply, rotation_of_rpy, transpose
from wsgen.packages.workspace.layout import Workspace, find_packages, read_package
from wsgen.pipeline.clock import Clock
from wsgen.pipeline.reported import run_git
from wsgen.porting.measured import LIVE, NODES, SHARE, difference, find_spawners, measure
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from wsgen.events import Listener
    from wsgen.model.target import Target
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.pipeline.check import Targets
    from wsgen.pipeline.requests import RunLive
    from wsgen.porting.measured import Measured, Side
    from wsgen.porting.plan import PortPlan
    from wsgen.porting.robot_topics import RosTopic


# What stays the same: m and degrees of the rest pose, the share of a way, and of a mass.
NEAR, TILTED = 0.005, 1.0
OF_MASS = 1e-3
# A type of messages in Gazebo Classic -> that which takes its place in Gazebo Sim.
_SUCCESSORS = {"gazebo_msgs/ContactsState": "ros_gz_interfaces/Contacts"}
# How many commits are looked at for the package as it was, and how many of them with Classic.
_MOST_COMMITS, _MOST_OF_CLASSIC = 20, 6
_SOURCES = ("*.xml", "*.py", "*.txt", "*.xacro", "*.urdf", "*.sdf", "*.world", "*.gazebo")
_OF_CLASSIC = "gazebo_ros"
_PATIENCE = 120  # s, that git may take for the files of a commit


class Compared(NamedTuple):
    """One aspect of a robot, before and after."""

    robot: str
    aspect: str
    before: str
    after: str
    is_same: bool | None  # None: it cannot be compared
    is_detail: bool = False  # of the one before it
    # By how much it differs, where that is a number: m of the rest pose, the share of a way.
    difference: float | None = None


@dataclass(frozen=True, kw_only=True)
class Proof:
    """What was compared."""

    before: str  # what it is: "as it is", or a commit
    rows: tuple[Compared, ...]

    @property
    def passed(self) -> bool:
        """Whether nothing is known to differ."""
        return all(row.is_same is not False for row in self.rows)


def prove_port(  # noqa: PLR0913  two have defaults
    targets: Targets,
    target: Target,
    environment: Mapping[str, str],
    plan: Callable[[], PortPlan],
    *,
    before: Targets | None = None,
    listener: Listener | None = None,
    run_live: RunLive | None = None,
) -> Proof:
    """Compare packages before and after their port; nothing of the user's is written.

    Args:
        targets: The packages, for Gazebo Classic or ported already.
        target: What they are, or were, ported to.
        environment: That of the command.
        plan: Plans the port of those for Gazebo Classic.
        before: The packages as they were, where that is not for git to say.
        listener: Is told of each simulation.
        run_live: Runs launch files, for drives that are not simulated without ROS.

    Raises:
        RequestError: No launch file spawns a robot, or it is not known how the packages were.
    """
    with make_scratch() as scratch:
        name, after = "as given", targets
        if before is None:
            now = find_spawners(targets, environment)
            if not now.are_any:
                raise _nothing_spawned(now.problems)
            if now.of_classic:
                name, before, after = "as it is", targets, _ported(targets, plan(), scratch)
            else:
                commit, before = _before(targets, environment, scratch)
                name = f"commit {commit}"
        clock = Clock("before", listener)
        old = measure(before, environment, None, clock, run_live, repeats=True)
        if not old.robots:
            raise _nothing_spawned(old.problems)
        new = measure(after, environment, target.distro, Clock("after", listener), run_live)
    return Proof(before=name, rows=tuple(compare(old, new)))


def _nothing_spawned(problems: Mapping[str, str]) -> RequestError:
    return RequestError(
        "No launch file of the packages spawns a robot that could be compared."
        + "".join(f" {name}: {problem}" for name, problem in problems.items()),
        hint="Give the package with the launch file, or the workspace; `wsgen check` says what is "
        "wrong with it.",
    )


# The two sides


def _ported(targets: Targets, plan: PortPlan, scratch: Path) -> Targets:
    """The packages with their port, in a scratch folder: what is large are links."""
    new: dict[Path, bytes] = {one.file: one.data for one in plan.files}
    new |= {file: text.encode() for file, text in plan.created}
    packages = []
    for number, package in enumerate(targets.packages):
        folder = scratch / str(number) / package.path.name
        for file in _files_of(package.path):
            place = folder / file.relative_to(package.path)
            place.parent.mkdir(parents=True, exist_ok=True)
            if file in new:
                continue
            # Launch files may look for others beside themselves, wherever a link leads.
            if file.suffix == ".py" and not file.is_symlink():
                shutil.copy(file, place)
            else:
                place.symlink_to(file.resolve())
        for file, data in new.items():
            if file.is_relative_to(package.path):
                place = folder / file.relative_to(package.path)
                place.parent.mkdir(parents=True, exist_ok=True)
                place.write_bytes(data)
                if file.exists():
                    shutil.copymode(file, place)  # programs stay such
        packages.append(_package_at(folder, package))
    return targets._replace(packages=tuple(packages))


def _files_of(folder: Path) -> Iterator[Path]:
    for here, folders, files in os.walk(folder):
        folders[:] = [name for name in folders if name != ".git"]
        yield from (Path(here, name) for name in files)


def _package_at(folder: Path, like: PackageFolder) -> PackageFolder:
    found = read_package(folder)
    return like if found is None else found


def _before(targets: Targets, environment: Mapping[str, str], scratch: Path) -> tuple[str, Targets]:
    """The commit before the port, and the packages in it.

    It is the newest in which they spawn robots in Gazebo Classic with the most plugins for it: a
    port of several commits has half of them on the way.

    Raises:
        RequestError: There is none.
    """
    names = {package.name for package in targets.packages}
    listed = ", ".join(sorted(names))
    hint = "Give a folder with the package as it was: --before FOLDER"
    program, folder = shutil.which("git"), targets.packages[0].path
    top = run_git(program, folder, "rev-parse", "--show-toplevel") if program else None
    if program is None or top is None:
        raise RequestError(
            f"The launch files of {listed} start Gazebo Sim already, and {folder} is in no git "
            "repository that has it as it was before.",
            hint=hint,
        )
    root = Path(top.strip("\n"))
    found: list[tuple[int, str, Targets]] = []
    for number, commit in enumerate(_commits(program, root)):
        place = scratch / str(number)
        there = _checked_out(program, root, commit, place)
        packages = tuple(package for package in there if package.name in names)
        if not packages:
            continue
        around = (Workspace(root=place), *targets.workspaces)
        before = targets._replace(packages=packages, workspaces=around, only=())
        plugins = find_spawners(before, environment).of_classic
        if plugins:
            found.append((plugins, commit[:10], before))
        if len(found) == _MOST_OF_CLASSIC:
            break
    if found:
        _, commit, before = max(found, key=itemgetter(0))
        return commit, before
    raise RequestError(
        f"The launch files of {listed} start Gazebo Sim already, and no commit of {root} was found "
        "in which one of them spawns a robot in Gazebo Classic.",
        hint=hint,
    )


def _commits(program: str, root: Path) -> Iterator[str]:
    """Commits that name packages of Gazebo Classic: the newest first, then those before changes."""
    log = ("log", f"-{_MOST_COMMITS}", "--format=%P", f"-S{_OF_CLASSIC}", "--", *_SOURCES)
    parents = (run_git(program, root, *log) or "").split("\n")
    for commit in dict.fromkeys(["HEAD", *(line.partition(" ")[0] for line in parents)]):
        names_it = ("grep", "--quiet", _OF_CLASSIC, commit, "--", *_SOURCES)
        if commit and run_git(program, root, *names_it) is not None:
            found = run_git(program, root, "rev-parse", commit)
            yield commit if found is None else found.strip()


def _checked_out(program: str, root: Path, commit: str, place: Path) -> tuple[PackageFolder, ...]:
    """The packages in the files of a commit, in a new folder; git may not have all files."""
    place.mkdir()
    # With an index of its own, git leaves that of the user alone.
    variables = {**os.environ, "GIT_INDEX_FILE": f"{place}.index"}
    for words in (("read-tree", commit), ("checkout-index", "--all", f"--prefix={place}/")):
        with suppress(subprocess.TimeoutExpired):
            subprocess.run(
                [program, "-C", root, *words],
                env=variables,
                capture_output=True,
                timeout=_PATIENCE,
                check=False,
            )
    return find_packages(Workspace(root=place))


# The comparison


def compare(before: Side, after: Side) -> Iterator[Compared]:
    """What is the same of each robot that there was before, and what is not."""
    # Launch files that differ in the same aspects of a robot are shown as one.
    alike: dict[tuple[str, object], list[tuple[Measured, list[Compared]]]] = {}
    for old, new in _pairs(before.robots, after.robots):
        if new is None:
            why = after.problems.get(old.launch_file, "no launch file spawns it")
            rows = [Compared(old.entity, "robot", old.launch_file, why, is_same=False)]
        else:
            rows = [*_compare_robot(old, new)]
            why = after.problems.get(new.launch_file, "")
            if why and old.launch_file not in before.problems:
                rows = [Compared(old.entity, "launch file", "starts", why, is_same=False), *rows]
        shown = tuple((row.aspect, row.is_same) for row in rows)
        alike.setdefault((old.entity, shown), []).append((old, rows))
    names = Counter(entity for entity, _ in alike)
    for (entity, _), group in alike.items():
        first, rows = group[0]
        others = f" and {len(group) - 1} more" if group[1:] else ""
        is_alone = names[entity] == 1
        name = entity if is_alone else f"{entity} ({first.launch_file}{others})"
        yield from (row._replace(robot=name) for row in rows)


def _compare_robot(old: Measured, new: Measured) -> Iterator[Compared]:
    name = old.entity
    yield from _compare_parts(name, old, new)
    yield _compare_rest(name, old, new)
    yield from _compare_topics(name, old.topics, new.topics)
    yield from _compare_ways(name, old, new)


def _pairs(
    before: Sequence[Measured], after: Sequence[Measured]
) -> Iterator[tuple[Measured, Measured | None]]:
    """Each robot before with that after: of the same launch file and name, else of one of both.

    Launch files, robots and packages get other names in ports by hand.
    """
    keys: tuple[Callable[[Measured], object], ...] = (
        lambda one: (one.package, one.launch_file, one.entity),
        lambda one: (one.launch_file, one.entity),
        lambda one: (one.package, one.entity),
        lambda one: one.launch_file,
        lambda one: one.entity,
        lambda one: one.links,
    )
    found: dict[int, Measured] = {}
    left = [*after]
    for key in keys:
        groups = defaultdict(list)
        for one in left:
            groups[key(one)].append(one)
        for number, old in enumerate(before):
            if number not in found and (group := groups[key(old)]):
                found[number] = group.pop(0)
        left = [one for group in groups.values() for one in group]
    rest = [number for number in range(len(before)) if number not in found]
    if len({before[number].entity for number in rest}) == len({one.entity for one in left}) == 1:
        found.update(zip(rest, left, strict=False))  # the only one has another name
    for number, old in enumerate(before):
        # Several launch files that start the same are looked at once.
        same = (one for one in after if one.entity == old.entity)
        yield old, found.get(number) or next(same, None)


def _compare_parts(name: str, old: Measured, new: Measured) -> Iterator[Compared]:
    for aspect, here, there in (
        ("links", old.links, new.links),
        ("joints", old.joints, new.joints),
    ):
        yield Compared(name, aspect, str(len(here)), str(len(there)), here == there)
        for part in sorted(here ^ there):
            is_new = part in there
            yield Compared(
                *(name, part, "missing" if is_new else "there", "new" if is_new else "missing"),
                is_same=False,
                is_detail=True,
            )
    is_same = math.isclose(old.mass, new.mass, rel_tol=OF_MASS, abs_tol=1e-6)
    yield Compared(name, "mass", f"{old.mass:.6g} kg", f"{new.mass:.6g} kg", is_same)


def _compare_rest(name: str, old: Measured, new: Measured) -> Compared:
    def shown(one: Measured) -> str:
        if one.is_left_out:
            return "simulated in other worlds"
        if one.rest is None:
            return f"not simulated: {one.problem}" if one.problem else "not simulated"
        return " ".join(f"{value:.3f}" for value in one.rest.xyz) + " m"

    if old.rest is None or new.rest is None:
        # What could not be simulated before proves nothing; what cannot be now was broken.
        is_same = None if old.rest is None or new.is_left_out else False
        return Compared(name, "rest pose", shown(old), shown(new), is_same)
    away = math.dist(old.rest.xyz, new.rest.xyz)
    turn = multiply(transpose(rotation_of_rpy(old.rest.rpy)), rotation_of_rpy(new.rest.rpy))
    trace = sum(turn[axis][axis] for axis in range(3))
    angle = math.degrees(math.acos(max(-1.0, min(1.0, (trace - 1) / 2))))
    after = f"{away * 1000:.1f} mm and {angle:.1f}° away"
    is_same = away < NEAR and angle < TILTED
    return Compared(name, "rest pose", shown(old), after, is_same, difference=away)


def _compare_topics(
    name: str, old: Iterable[RosTopic], new: Iterable[RosTopic]
) -> Iterator[Compared]:
    here, there = _by_name(old), _by_name(new)
    details = []
    for way, topics in here.items():
        topic, is_published = way
        said = "" if is_published else " (read)"
        others = there.get(way, ())
        types = {_SUCCESSORS.get(one.type, one.type) for one in topics}
        frames = {one.frame for one in topics if one.frame}
        now = {one.frame for one in others if one.frame}
        shown = ", ".join(sorted({one.type for one in topics}))
        if not types & {one.type for one in others}:
            instead = ", ".join(sorted({one.type for one in others})) or "missing"
            details.append((f"{topic}{said}", shown, instead))
        elif frames and now and now.isdisjoint(frames):
            details.append((f"{topic}{said}", f"frame {_listed(frames)}", f"frame {_listed(now)}"))
    yield Compared(name, "topics", str(len(here)), str(len(there)), is_same=not details)
    for aspect, before, after in details:
        yield Compared(name, aspect, before, after, is_same=False, is_detail=True)


def _by_name(topics: Iterable[RosTopic]) -> dict[tuple[str, bool], list[RosTopic]]:
    found: dict[tuple[str, bool], list[RosTopic]] = {}
    for one in sorted(topics):
        found.setdefault((one.name, one.is_published), []).append(one)
    return found


def _listed(names: Iterable[str]) -> str:
    return ", ".join(sorted(names))


def _compare_ways(name: str, old: Measured, new: Measured) -> Iterator[Compared]:
    if old.problem_live:
        now = f"not run: {new.problem_live}" if new.problem_live else ""
        yield Compared(name, "live run", f"not run: {old.problem_live}", now, is_same=None)
    for task, way in old.ways.items():
        other = new.ways.get(task)
        if other is None:
            why = f": {new.problem_live}" if new.problem_live else ""
            now, is_same = f"not driven{why}", None if new.is_left_out else False
            if task != NODES and new.ways and (task == LIVE) != (LIVE in new.ways):
                now, is_same = "driven otherwise", None  # by a drive of another kind
            yield Compared(name, task, _shown_way(way), now, is_same)
            continue
        share = difference(way, other)
        is_same = share <= SHARE
        if task == NODES and not is_same and not old.is_repeated:
            is_same = None  # they do not do the same twice anyway
        shown = _shown_way(way), _shown_way(other)
        yield Compared(name, task, *shown, is_same, difference=share)


def _shown_way(way: tuple[float, float, float]) -> str:
    x, y, yaw = way
    return f"{x:.3f} {y:.3f} m, {yaw:.3f} rad"
