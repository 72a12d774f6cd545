"""What the panel of the page says: about the robots, their links, and diagnostics."""

from __future__ import annotations

from collections import Counter
from html import escape
from typing import TYPE_CHECKING

from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.reporting.viewing.drawing import DrawnRobot


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
            f"{plain(robot.entity)}: {mass:.4g} kg, {_count(len(robot.links), 'link')}, "
            f"{_count(joints, 'movable joint')}"
        )
    if len(subjects) > MOST_ROBOTS:
        lines.append(f"and {len(subjects) - MOST_ROBOTS} more robots")
    models = len(robots) - len(subjects)
    if models:
        lines.append(_count(models, "model") + " of the world")
    counts = Counter(found.severity for found in diagnostics)
    if counts:
        parts = (
            _count(counts[severity], PLURALS[severity][:-1])
            for severity in COLORS
            if counts[severity]
        )
        lines.append(f"{', '.join(parts)}: see *Diagnostics*")
    if is_stale:
        lines.append("**The files have an error: the robot is shown as it was before.**")
    return "  \n".join(lines)


MOST_ROBOTS = 5  # that are named


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}{'' if number == 1 else 's'}"


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
