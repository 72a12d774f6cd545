"""An outcome -> the page of `wsgen validate --html`: one file, which loads nothing.

What a user wrote is text on it and never markup. Plots and 3D views are drawn by the page's script
from what `page_data` packs, when they come into sight.
"""

from __future__ import annotations

import base64
import hashlib
import html
import math
import os
import re
from collections import Counter
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen import __version__
from wsgen.checks.fixes.plan import FIXERS
from wsgen.checks.rules.catalogue import find_rule
from wsgen.diagnostics import Severity
from wsgen.model.engines import name_engines
from wsgen.model.robot import JointType, Mesh
from wsgen.reporting.page_data import compress, pack_package, read_plotly
from wsgen.reporting.words import (
    cause_of,
    result_of,
    start_tree,
    what_is_expected,
    what_it_did,
    what_it_is_to_do,
    write_xyz,
)
from wsgen.templating.environment import page_environment
from wsgen.text.printable import clean

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.behavior import BehaviorOutcome
    from wsgen.model.outcome import EngineOutcome, Outcome, PackageOutcome, RobotOutcome
    from wsgen.model.plan import Process
    from wsgen.model.robot import Collision, Joint, Visual


FOLDER = Path(__file__).parent / "page"
MOST_CHARACTERS = 240  # of a value of a launch file; a robot description has thousands
MOST_ALIKE = 3  # warnings of one rule that are shown at once
MOST_MEDIA = 40 * 2**20  # bytes of a video that is put into the page
STAGES = {  # of the clock, and what they do
    "launch": "evaluate launch files",
    "expand": "read robots and worlds",
    "run": "run the launch file",
    "load": "start the engine",
    "simulate": "simulate",
}
SEVERITIES = (Severity.ERROR, Severity.WARNING, Severity.INFO)
MEDIA_TYPES = {".mp4": "video/mp4", ".gif": "image/gif"}


def render_page(outcome: Outcome, folder: Path, *, when: datetime | None = None) -> str:
    """The page of an outcome; paths on it are relative to the folder if they are below it.

    Raises:
        NotFoundError: plotly is not installed.
    """
    texts = _Texts(folder)
    packages = [_package(package, number) for number, package in enumerate(outcome.packages)]
    environment = page_environment(
        FOLDER,
        {
            "marked": mark_code,
            "path": texts.path,
            "xyz": write_xyz,
            "number": write_number,
            "fixed": write_fixed,
            "clip": texts.clip,
            "program": texts.program,
            "details": texts.details,
            "cause": cause_of,
            "shapes": name_shapes,
            "asked": what_it_is_to_do,
            "expected": what_is_expected,
            "reached": what_it_did,
        },
        clean,
    )
    script = read_script("page.js")
    library = read_plotly() if any(package["data"] for package in packages) else None
    found = [one for package in outcome.packages for one in package.diagnostics]
    return environment.get_template("page.html").render(
        outcome=outcome,
        title=_title(outcome),
        packages=packages,
        passed=sum(package.passed for package in outcome.packages),
        failed=[package for package in packages if not package["passed"]],
        counts=_counts(found),
        not_validated=outcome.not_validated,
        rules=list(filter(None, map(find_rule, sorted({one.code for one in found})))),
        fixers=FIXERS,
        version=__version__,
        when=when or datetime.now().astimezone(),
        style=Html((FOLDER / "page.css").read_text(encoding="utf-8")),
        script=Html(script),
        library=None if library is None else compress(library.script.encode()),
        library_version=library.version if library else "",
        hashes=[hash_script(one) for one in (script, library.script if library else None) if one],
    )


class Html(str):
    """A text that is markup already."""

    __slots__ = ()

    def __html__(self) -> str:
        return self


def mark_code(text: str) -> Html:
    """A message with what is between backticks as code; all else of it is escaped."""
    escaped = html.escape(clean(text))
    return Html(re.sub(r"`([^`\n]+)`", r"<code>\1</code>", escaped))


def write_number(value: float | None, digits: int = 4) -> str:
    """A number with so many significant digits; a dash for none."""
    if value is None:
        return "–"
    return f"{value + 0.0:.{digits}g}" if math.isfinite(value) else str(value)


def write_fixed(value: float | None, digits: int) -> str:
    """A number with so many digits behind the point; a dash for none."""
    if value is None:
        return "–"
    return f"{round(value, digits) + 0.0:.{digits}f}" if math.isfinite(value) else str(value)


def read_script(name: str) -> str:
    """The script of a page, after what all pages share."""
    return "\n".join((FOLDER / part).read_text(encoding="utf-8") for part in ("common.js", name))


def hash_script(script: str) -> str:
    """What allows a script in a Content Security Policy."""
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()


class _Texts:
    """How paths are written."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def path(self, file: Path | None) -> str:
        """Relative to the folder if it is below it."""
        if file is None:
            return ""
        relative = os.path.relpath(file, self._folder)
        return os.fspath(file) if relative.startswith("..") else relative

    def clip(self, text: str) -> str:
        """A value on one line, with paths below the folder relative to it."""
        start = re.escape(f"{self._folder}{os.sep}")
        line = re.sub(rf"(?<![^\s\"'=]){start}", "", " ".join(text.split()))
        return line if len(line) <= MOST_CHARACTERS else f"{line[: MOST_CHARACTERS - 1]}…"

    def program(self, process: Process) -> str:
        """What a process runs."""
        if process.command is not None:
            return self.clip(" ".join(process.command))
        program = str(process.executable)
        return f"{process.package} {program}" if process.package else program

    def details(self, process: Process) -> Iterator[tuple[str, str]]:
        """What it is given: arguments, parameters and remappings."""
        if process.arguments:
            yield "arguments", self.clip(" ".join(process.arguments))
        for name, value in process.parameters.items():
            if process.description_file is not None and str(value).lstrip().startswith("<"):
                yield name, f"{len(value)} characters from {self.path(process.description_file)}"
            else:
                yield name, self.clip(str(value))
        for source, target in process.remappings:
            yield source, f"→ {target}"


def _title(outcome: Outcome) -> str:
    """What the tab of the browser says."""
    failed = sum(not package.passed for package in outcome.packages)
    if not outcome.is_complete:
        result = "interrupted"
    elif not outcome.packages:
        result = "nothing validated"
    elif failed:
        result = f"{failed} of {len(outcome.packages)} failed"
    else:
        result = "passed" if len(outcome.packages) == 1 else f"all {len(outcome.packages)} passed"
    name = f"{_name(outcome.packages[0])}: " if len(outcome.packages) == 1 else ""
    return f"{name}{result} – wsgen validate"


def _name(package: PackageOutcome) -> str:
    file = package.file or package.launch_file
    return package.package or (file.name if file else "(file)")


def _counts(found: Iterable[Diagnostic]) -> dict[str, int]:
    severities = [one.severity for one in found]
    return {severity.value: severities.count(severity) for severity in SEVERITIES}


def _package(package: PackageOutcome, number: int) -> dict[str, Any]:
    """What the template shows of a package."""
    world = package.world
    name = _name(package)
    has_launch = package.package is not None and package.launch_file is not None
    engines = dict.fromkeys(one.engine for robot in package.robots for one in robot.engines)
    first = next(
        (one.message for one in package.diagnostics if one.severity is Severity.ERROR), None
    )
    return {
        "id": f"package-{number}",
        "number": number,
        "name": name,
        "label": f"{name} {package.launch_file.name}"
        if has_launch and package.launch_file
        else name,
        "passed": package.passed,
        "file": package.file,
        "launch_file": package.launch_file,
        "world": world if world is not None and (package.robots or world.file) else None,
        "engines": name_engines(engines) if engines else "",
        "has_engines": len(engines) > 1,
        "has_robots": len(package.robots) > 1,
        "seconds": package.seconds.get("total"),
        "stages": [*_stages(package)],
        "counts": _counts(package.diagnostics),
        "first_error": first,
        **_diagnostics(package.diagnostics),
        "robots": [
            _robot(robot, f"{number}-{index}") for index, robot in enumerate(package.robots)
        ],
        "results": [row for robot in package.robots for row in _results(robot)],
        "behaviors": [row for robot in package.robots for row in _behaviors(robot)],
        "mass": sum(robot.mass for robot in package.robots if math.isfinite(robot.mass)),
        "plan": package.plan,
        "starts": start_tree(package.plan.processes) if package.plan else (),
        "view": package.view,
        "view_label": _view_label(package),
        "video": _video(package.video),
        "data": pack_package(package, clean),
    }


def _diagnostics(found: Sequence[Diagnostic]) -> dict[str, Any]:
    """Errors first; of warnings and notes of one rule some, and the others by their rule."""
    shown: list[Diagnostic] = []
    more: dict[str, list[Diagnostic]] = {}
    alike: Counter[str] = Counter()
    for one in sorted(found, key=lambda one: SEVERITIES.index(one.severity)):
        alike[one.code] += one.severity is not Severity.ERROR
        hidden = alike[one.code] > MOST_ALIKE
        (more.setdefault(one.code, []) if hidden else shown).append(one)
    return {"diagnostics": shown, "more_diagnostics": [*more.values()]}


def _stages(package: PackageOutcome) -> Iterator[tuple[str, float, float]]:
    """What was done, how long that took (s), and its share of all."""
    total = package.seconds.get("total", 0.0)
    known = {text: package.seconds.get(stage, 0.0) for stage, text in STAGES.items()}
    known["draw, check and wait"] = max(0.0, total - sum(known.values()))
    whole = max(total, sum(known.values())) or 1.0
    for text, seconds in known.items():
        yield text, seconds, seconds / whole


def _view_label(package: PackageOutcome) -> str:
    """What a person who does not see the picture reads."""
    ends = [
        f"{robot.entity}: {result_of(robot.engines[0]) if robot.engines else 'not simulated'}"
        for robot in package.robots
    ]
    return f"{_name(package)} at the end of the simulation. {'; '.join(ends)}"


def _video(file: Path | None) -> dict[str, str] | None:
    """A video that was recorded, as a part of the page, if it is not too large."""
    media_type = MEDIA_TYPES.get(file.suffix.lower()) if file is not None else None
    if file is None or media_type is None or not file.is_file():
        return None
    if file.stat().st_size > MOST_MEDIA:
        return None
    data = base64.b64encode(file.read_bytes()).decode()
    return {"type": media_type, "data": data, "name": file.name}


def _robot(robot: RobotOutcome, number: str) -> dict[str, Any]:
    description = robot.description
    parents = {joint.child: joint.name for joint in description.joints} if description else {}
    series = [one for engine in robot.engines for one in engine.time_series if one.seconds]
    rest = robot.rest
    phases = [*dict.fromkeys(one.behavior for one in series)]
    failed = {one.name for one in robot.behaviors if not one.passed}
    return {
        "id": f"robot-{number}",
        "entity": robot.entity,
        "mass": robot.mass,
        "links": description.links if description else (),
        "parents": parents,
        "joints": [
            (joint, _numbers_of(joint, rest.joint_positions.get(joint.name) if rest else None))
            for joint in (description.joints if description else ())
        ],
        "phases": phases,
        "phase": next((number for number, one in enumerate(phases) if one in failed), 0),
        "plots": [*_plots(robot)],
    }


class Plot(NamedTuple):
    """A plot of a robot; `summary` says in words what it shows while the robot stands."""

    kind: str  # as the script knows it
    title: str
    summary: str


def _plots(robot: RobotOutcome) -> Iterator[Plot]:
    """The plots of a robot in the first engine that simulated it."""
    everything = [one for engine in robot.engines for one in engine.time_series if one.seconds]
    if not everything:
        return
    standing = everything[0]
    heights = [z for _, _, z in standing.positions]
    yield Plot("height", "Height of the root link, m", _from_to(heights, "m", 3))
    yield Plot("speed", "Speed, m/s", f"at most {max(standing.speeds):.2f} m/s")
    tilts = [math.degrees(tilt) for tilt in standing.tilts]
    yield Plot("tilt", "Tilt, degrees", _from_to(tilts, "degrees", 1))
    if any(one.behavior is not None for one in everything):
        yield Plot("path", "Path on the ground, m", "the way of the root link")
    slides = {
        joint.name
        for joint in (robot.description.joints if robot.description else ())
        if joint.type is JointType.PRISMATIC
    }
    names = standing.joint_positions.keys()
    for kind, title, chosen in (
        ("angles", "Joint angles, rad", names - slides),
        ("slides", "Joint positions, m", names & slides),
    ):
        if chosen:
            widest = max(
                chosen,
                key=lambda name: (
                    max(standing.joint_positions[name]) - min(standing.joint_positions[name])
                ),
            )
            moved = standing.joint_positions[widest]
            yield Plot(
                kind,
                title,
                f"{len(chosen)} joint{'s' if len(chosen) > 1 else ''}; {widest} moves most: "
                f"{_from_to(moved, 'm' if kind == 'slides' else 'rad', 3)}",
            )


def _from_to(values: Sequence[float], unit: str, digits: int) -> str:
    first, last, low, high = (
        write_fixed(value, digits) for value in (values[0], values[-1], min(values), max(values))
    )
    if low == high:
        return f"stays at {first} {unit}"
    way = f"from {first} to {last} {unit}"
    beyond = [
        f"{word} {value}"
        for word, value in (("lowest", low), ("highest", high))
        if value not in {first, last}
    ]
    return ", ".join([way, *beyond])


def name_shapes(shapes: Iterable[Visual | Collision]) -> str:
    """What the shapes are, as "box, 2 meshes"."""
    geometries = [shape.geometry for shape in shapes]
    kinds = ["mesh" if isinstance(one, Mesh) else type(one).__name__.lower() for one in geometries]
    return ", ".join(
        kind if kinds.count(kind) == 1 else f"{kinds.count(kind)} {_plural(kind)}"
        for kind in dict.fromkeys(kinds)
    )


def _plural(kind: str) -> str:
    return f"{kind}es" if kind.endswith(("x", "sh")) else f"{kind}s"


def _numbers_of(joint: Joint, position: float | None) -> tuple[float | None, ...]:
    """The bounds of a joint, where they count, and where it is at the end."""
    limit = joint.limit
    lower = upper = effort = velocity = None
    if limit is not None and joint.type in {JointType.REVOLUTE, JointType.PRISMATIC}:
        lower, upper = limit.lower, limit.upper
    if limit is not None and joint.is_movable:
        effort, velocity = limit.effort, limit.velocity
    return lower, upper, effort, velocity, position


def _results(robot: RobotOutcome) -> Iterator[dict[str, Any]]:
    """A row for each engine."""
    for one in robot.engines or (None,):
        rest = one.rest if one else None
        yield {
            "entity": robot.entity,
            "engine": one.name if one else "–",
            "mass": one.simulated.mass if one and one.simulated else None,
            "movable": f"{robot.movable_joints} of {robot.joints}",
            "spawned": robot.spawn_pose.xyz,
            "end": rest.pose_in_world.xyz if rest else None,
            "tilt": math.degrees(rest.tilt) if rest else None,
            "speed": rest.speed if rest else None,
            "result": result_of(one) if one else "not simulated",
            "tone": _tone(one),
        }


def _tone(one: EngineOutcome | None) -> str:
    """How a result is painted: as bad, good, or as what may be meant and is to be looked at."""
    if one is None or not one.passed:
        return "bad"
    return "good" if result_of(one).startswith(("stands", "settled")) else "mild"


def _behaviors(robot: RobotOutcome) -> Iterator[tuple[str, str, BehaviorOutcome]]:
    """The robot and the engine of each behavior."""
    each: list[tuple[str, Sequence[BehaviorOutcome]]] = [
        (one.name, one.behaviors) for one in robot.engines
    ] or [("–", robot.behaviors)]
    for number in range(len(robot.behaviors)):
        for engine, behaviors in each:
            if number < len(behaviors):
                yield robot.entity, engine, behaviors[number]
