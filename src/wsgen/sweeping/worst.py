"""The worst variants of a sweep as files that one can look at.

Of a robot with other masses, inertias and frictions only the numbers change in its text, URDF or
SDF: comments and layout stay. An engine makes of the new text what `apply` makes of the robot of
the old one.
"""

from __future__ import annotations

import json
import math
import os
import re
import time
from typing import TYPE_CHECKING

import numpy as np

from wsgen.checks.fixes.source import Edit, children, read_tags
from wsgen.checks.fixes.source import apply as apply_edits
from wsgen.checks.rules.catalogue import without_allowed
from wsgen.diagnostics import Severity
from wsgen.errors import RequestError, WouldOverwriteError
from wsgen.events import StepEnded, StepStarted, post
from wsgen.isolation import parent
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.run_robots import simulate_robots
from wsgen.sweeping.parameters import (
    FRICTION,
    FRICTION_SCALE,
    INERTIA_SCALE,
    MASS_SCALE,
    OWN,
    own_values,
    write_value,
)
from wsgen.sweeping.run_variant import apply, can_run, pushes_of
from wsgen.templating.write import explain_failure, make_parents, unfinished_folder, write_files
from wsgen.text.files import read_regular_text, write_file
from wsgen.text.suggestions import ask_for_nearest
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from wsgen.checks.fixes.source import Span, Tag
    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.model.sweep import Column, Value, Variant
    from wsgen.sweeping.design import Variants
    from wsgen.sweeping.subject import Subject
    from wsgen.sweeping.sweep import SweepRequest
    from wsgen.sweeping.table import Series, TableData


RECORD = "variant.json"  # in each folder: which run of which sweep it is
NUMBERS = ("number", "integer")  # kinds of columns
NOTICEABLE_TILT = 0.01  # rad
PICTURE = "robot.png"
VIDEO = "robot.gif"
NOT_IN_THE_ROBOT = frozenset(one.name for one in OWN) - {
    FRICTION,
    FRICTION_SCALE,
    INERTIA_SCALE,
    MASS_SCALE,
}


@dataclass(frozen=True, kw_only=True)
class Choice:
    """Which variants are written."""

    count: int
    column: str | None = None  # whose largest values they have; None: those that fail and tilt most


@dataclass(frozen=True, kw_only=True)
class WorstVariant:
    """A variant that was written."""

    number: int
    values: Mapping[str, Value]
    passed: bool
    folder: Path
    picture: Path | None
    video: Path | None


def read_choice(word: str) -> Choice:
    """Read `K` or `K:COLUMN`.

    Raises:
        RequestError: It is something else.
    """
    count, _, column = word.partition(":")
    if not (count.isascii() and count.isdigit() and int(count)) or (":" in word and not column):
        raise RequestError(
            f"--worst {word} does not say how many variants.",
            hint="Write for example --worst 3, or --worst 3:drift for the largest values of a "
            "column.",
        )
    return Choice(count=int(count), column=column or None)


def check_choice(choice: Choice, columns: Sequence[Column], out: Path) -> None:
    """Check before the first run that the worst variants can be chosen and written.

    Raises:
        RequestError: The table will have no such column of numbers.
        WouldOverwriteError: A file is in the place of the folder.
    """
    names = [one.name for one in columns if one.kind in NUMBERS and not one.is_parameter]
    if choice.column is not None and choice.column not in names:
        raise RequestError(
            f"The table has no column `{choice.column}` of numbers.",
            hint=f"{ask_for_nearest(choice.column, names)}Columns: {', '.join(names)}.",
        )
    folder = _folder(out)
    if os.path.lexists(folder) and not folder.is_dir():
        raise WouldOverwriteError(
            f"{folder}, where the worst variants go, is a file.",
            hint="Remove it, or choose another --out.",
        )


def _folder(out: Path) -> Path:
    return out.with_name(f"{out.name}-worst" if out.suffix != ".csv" else f"{out.stem}-worst")


def choose(data: TableData, choice: Choice) -> list[int]:
    """The rows of the worst variants, the worst first; those without a robot come last."""
    figures = [one for one in data.figures if one.column.kind in NUMBERS]
    tilt, drift = _largest(data, figures, "tilt"), _largest(data, figures, "drift")
    if choice.column is not None:
        (named,) = (one.numbers for one in figures if one.column.name == choice.column)
        keys = [-np.abs(named)]
    else:
        # Less is noise of the engine.
        keys = [data.passed, -np.round(tilt / NOTICEABLE_TILT), -drift]
    # Of equal variants the first run; NaN comes last.
    order = np.lexsort((data.numbers, *reversed(keys), np.isnan(tilt)))
    return [int(row) for row in order[: choice.count]]


def _largest(data: TableData, figures: list[Series], name: str) -> NDArray[np.float64]:
    """That figure of the robot for which it is largest; NaN where none has it."""
    found = [one.numbers for one in figures if one.column.name.rpartition(".")[2] == name] or [
        np.full(data.count, np.nan)
    ]
    largest: NDArray[np.float64] = np.fmax.reduce(found)
    return largest


def write_worst(  # noqa: PLR0913  of what, which, and where
    request: SweepRequest,
    rows: Sequence[int],
    subject: Subject,
    variants: Variants,
    data: TableData,
    *,
    out: Path,
    inputs: Mapping[str, str],
    listener: Listener | None,
) -> Iterator[WorstVariant]:
    """Write the variants of some rows into a folder each, beside the table.

    `inputs` are those of the table's header; the subject is one that is drawn.

    Raises:
        WouldOverwriteError: A folder of this name has something else.
        NotReadableError: It cannot be written.
    """
    parent_folder = _folder(out)
    for row in rows:
        variant = variants.variant(int(data.numbers[row]))
        folder = parent_folder / f"run-{variant.number}"
        record = _record(variant, inputs)
        if os.path.lexists(folder):
            _refuse_other(folder, record)
        else:
            step = ("worst", f"run {variant.number}")
            post(listener, StepStarted(step=step))
            started = time.monotonic()
            _write(request, subject, variant, folder, record)
            seconds = time.monotonic() - started
            post(listener, StepEnded(step=step, succeeded=True, seconds=seconds))
        yield WorstVariant(
            number=variant.number,
            values=variant.values,
            passed=bool(data.passed[row]),
            folder=folder,
            picture=_if_there(folder / PICTURE),
            video=_if_there(folder / VIDEO),
        )


def _if_there(file: Path) -> Path | None:
    return file if file.is_file() else None


def _record(variant: Variant, inputs: Mapping[str, str]) -> str:
    document = {
        "run": variant.number,
        "parameters": dict(variant.values),
        "inputs": dict(inputs),
    }
    return json.dumps(document, indent=2) + "\n"


def _refuse_other(folder: Path, record: str) -> None:
    try:
        is_same = read_regular_text(folder / RECORD) == record
    except (OSError, ValueError):
        is_same = False
    if not is_same:
        raise WouldOverwriteError(
            f"{folder} exists, with something else than this variant.",
            hint="Remove it, or move it away.",
        )


def _write(
    request: SweepRequest, subject: Subject, variant: Variant, folder: Path, record: str
) -> None:
    try:
        make_parents(folder.parent, [])
        # The packages of variants have one name; each folder is a workspace of its own.
        (folder.parent / "COLCON_IGNORE").touch()
        with unfinished_folder(folder.parent) as unfinished:
            filled = unfinished / folder.name
            filled.mkdir()
            _fill(request, subject, variant, filled)
            write_file(filled / RECORD, record)
            filled.rename(folder)
    except OSError as error:
        raise explain_failure(error, folder) from error


def _fill(request: SweepRequest, subject: Subject, variant: Variant, folder: Path) -> None:
    """Put the robots, the package of a template, a picture, a video and a text into a folder."""
    own = own_values(variant.values)
    robots: list[tuple[str, Path | None]] = []
    for entity, text, file in subject.texts(variant.values):
        tags = read_tags(text)
        suffix = "sdf" if tags and tags[0].name == "sdf" else "urdf"
        name = f"{_file_name(entity)}.{suffix}"
        if any(name == other for other, _ in robots):
            name = f"{_file_name(entity)}-{len(robots)}.{suffix}"
        write_file(
            folder / name, scale_text(text if file is None else _with_meshes(text, file), own)
        )
        robots.append((name, file))
    package = subject.package(variant.values)
    if package is not None:
        name, tree = package
        (folder / "src").mkdir()
        write_files(tree, folder / "src" / name)
    varied = apply(subject.prepare(variant.values), variant.values)
    found: Sequence[Diagnostic] = varied.diagnostics
    if varied.world is not None and can_run(varied):
        simulated = simulate_robots(
            varied.world,
            varied.prepared,
            ValidateRequest(
                seconds=request.seconds,
                engines=(request.engine,),
                picture_folder=folder,
                video=folder / VIDEO,
            ),
            PICTURE.removesuffix(".png"),
            run=parent.run,
            behavior_plan=varied.behavior_plan,
            pushes=pushes_of(varied, request.seconds),
            keep_engines=True,
        )
        found = simulated.diagnostics_after(varied.diagnostics)
    reported = without_allowed(found, varied.allow)
    text = _read_me(subject, variant, robots, package and package[0], reported)
    text += "".join(
        f"\n![{what}]({name})\n"
        for what, name in (
            ("The robot at the end of the simulation", PICTURE),
            ("The simulation", VIDEO),
        )
        if (folder / name).is_file()
    )
    write_file(folder / "README.md", text)


def _file_name(entity: str) -> str:
    """The name of an entity, as far as it can be that of a file."""
    return re.sub(r"[^\w.-]", "_", entity).lstrip(".") or "robot"


def _with_meshes(text: str, file: Path) -> str:
    """The text with the whole paths of meshes that it names beside its file."""
    edits = []
    for tag in read_tags(text):
        named = tag.attributes.get("filename") if tag.name == "mesh" else None
        if named is not None and "://" not in named.text:
            whole = file.absolute().parent / named.text
            if whole.is_file():
                edits.append(Edit(start=named.value.start, end=named.value.end, text=str(whole)))
    return apply_edits(text, edits)


def _in_table(value: Value) -> str:
    """A value in a table of Markdown."""
    return write_value(value).replace("\\", "\\\\").replace("|", "\\|").replace("\n", " ")


def _read_me(
    subject: Subject,
    variant: Variant,
    robots: Sequence[tuple[str, Path | None]],
    package: str | None,
    reported: Sequence[Diagnostic],
) -> str:
    errors = [one for one in reported if one.severity is Severity.ERROR]
    lines = [
        f"# Run {variant.number} of a sweep of {subject.name}",
        "",
        "| parameter | value |",
        "|---|---|",
        *(f"| {name} | {_in_table(value)} |" for name, value in variant.values.items()),
        "",
        *(f"- {one.code} {one.name}: {one.message}" for one in errors),
        *(["- The variant passes."] if not errors else []),
        "",
    ]
    for name, file in robots:
        origin = f", from {file.name}" if file is not None else ""
        lines += [f"`{name}` is the robot of this variant{origin}: `wsgen view {name}`", ""]
    if package is not None:
        lines += [f"`src/{package}` is its package: `wsgen build && wsgen validate`", ""]
    if any(name in NOT_IN_THE_ROBOT for name in own_values(variant.values)):
        lines += [
            "World, spawn pose and push count in the picture and the video alone. These show a",
            "slope as steep as it is, and a push as an arrow.",
            "",
        ]
    return "\n".join(lines)


FRICTION_OF_SDF = ("surface", "friction", "ode")  # of a <collision> in SDF, around <mu> and <mu2>
FRICTION_OF_GAZEBO = ("mu1", "mu2")  # in the <gazebo> of a link
MOMENTS = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
COEFFICIENTS = ("mu", "mu2")
DEFAULT_FRICTION = 1.0


def scale_text(text: str, own: Mapping[str, float]) -> str:
    """The text with the numbers that wsgen's own parameters change in it.

    Args:
        text: A URDF, expanded, or an SDF model.
        own: Factors on the masses and inertias of links, on their inertias alone, and on their
            frictions; and the friction of the ground: where it is the smaller one, it is that of
            the contact.
    """
    mass, inertia, friction = (
        own.get(name, 1.0) for name in (MASS_SCALE, INERTIA_SCALE, FRICTION_SCALE)
    )
    tags = read_tags(text)
    edits: list[Edit] = []
    if (mass, inertia) != (1.0, 1.0):
        edits += _of_inertials(text, tags, mass, mass * inertia)
    if friction != 1.0 or FRICTION in own:
        is_urdf = any(tag.name == "robot" and not tag.path for tag in tags)
        edit = _of_urdf if is_urdf else _of_sdf
        edits += edit(text, tags, friction, own.get(FRICTION, math.inf))
    return apply_edits(text, edits)


def _of_inertials(text: str, tags: Sequence[Tag], mass: float, inertia: float) -> Iterator[Edit]:
    for tag in tags:
        if not tag.path or tag.path[-1].name not in {"inertial", "inertia"}:
            continue
        if tag.name == "mass":
            yield from _scaled(text, _number(tag), mass)
        elif tag.name == "inertia":
            for name in MOMENTS:
                if name in tag.attributes:
                    yield from _scaled(text, tag.attributes[name].value, inertia)
        elif tag.name in MOMENTS:
            yield from _scaled(text, tag.content(), inertia)


def _number(tag: Tag) -> Span:
    """Where the number of a `<mass>` is: URDF has it in an attribute, SDF as text."""
    value = tag.attributes.get("value")
    return tag.content() if value is None else value.value


def _scaled(text: str, place: Span, factor: float, highest: float = float("inf")) -> Iterator[Edit]:
    try:
        number = float(text[place.start : place.end])
    except ValueError:  # not a number, which is reported where the robot is read
        return
    yield _edit(place.start, place.end, _written(min(highest, factor * number)))


def _edit(start: int, end: int, text: str) -> Edit:
    return Edit(start=start, end=end, text=text)


def _written(number: float) -> str:
    return f"{number:.12g}"


def _of_urdf(text: str, tags: Sequence[Tag], friction: float, highest: float) -> Iterator[Edit]:
    """Frictions in `<gazebo>` elements; links without any get one."""
    given: dict[str, set[str]] = {}  # coefficients, by the link that they are for
    for tag in tags:
        around = [one for one in tag.path if one.name == "gazebo"]
        if not around:
            continue
        is_in_collision = (
            tuple(one.name for one in tag.path[-len(FRICTION_OF_SDF) :]) == FRICTION_OF_SDF
        )
        if tag.name in FRICTION_OF_GAZEBO or (is_in_collision and tag.name in COEFFICIENTS):
            reference = around[0].attributes.get("reference")
            coefficient = "mu1" if tag.name == "mu" else tag.name
            given.setdefault(reference.text if reference else "", set()).add(coefficient)
            yield from _scaled(text, tag.content(), friction, highest)
    default = _written(min(highest, friction * DEFAULT_FRICTION))
    if float(default) == DEFAULT_FRICTION:
        return
    (robot,) = (tag for tag in tags if tag.name == "robot" and not tag.path)
    end = robot.content().end
    solid = {tag.path[-1].start for tag in tags if tag.name == "collision" and tag.path}
    for link in children(tags, robot):
        name = link.attributes.get("name")
        if link.name != "link" or name is None or link.start not in solid:
            continue
        missing = [one for one in FRICTION_OF_GAZEBO if one not in given.get(name.text, ())]
        if missing:
            values = "".join(f"<{one}>{default}</{one}>" for one in missing)
            yield _edit(end, end, f'  <gazebo reference="{name.text}">{values}</gazebo>\n')


def _of_sdf(text: str, tags: Sequence[Tag], friction: float, highest: float) -> Iterator[Edit]:
    """Frictions in the `<surface>` of collisions; those without any get one."""
    default = _written(min(highest, friction * DEFAULT_FRICTION))
    inside: dict[Span, list[Tag]] = {}  # elements, by the start of the one around them
    for tag in tags:
        if tag.path:
            inside.setdefault(tag.path[-1].start, []).append(tag)
    for collision in tags:
        if collision.name != "collision" or collision.end is None:
            continue
        inner, around = collision, list[str](FRICTION_OF_SDF)
        while around:
            found = [one for one in inside.get(inner.start, ()) if one.name == around[0]]
            if not found or found[0].end is None:
                break
            inner = found[0]
            del around[0]
        there = [one for one in inside.get(inner.start, ()) if one.name in COEFFICIENTS]
        for tag in there:
            yield from _scaled(text, tag.content(), friction, highest)
        missing = [one for one in COEFFICIENTS if one not in {tag.name for tag in there}]
        if missing and float(default) != DEFAULT_FRICTION:
            opened = "".join(f"<{one}>" for one in around)
            closed = "".join(f"</{one}>" for one in reversed(around))
            values = "".join(f"<{one}>{default}</{one}>" for one in missing)
            end = inner.content().end
            yield _edit(end, end, f"{opened}{values}{closed}")
