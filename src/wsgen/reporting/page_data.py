"""What the script of a page gets: the numbers of its plots and 3D views, packed, and plotly.js.

One text holds a header in JSON and arrays of numbers behind it, compressed and in base64: nothing
that a user writes can end the element that it stands in, and sixty robots fit on a page. plotly.js
comes with PyPI's plotly, whose Python package is never imported.
"""

from __future__ import annotations

import base64
import gzip
import json
import math
import re
import sys
from array import array
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen.errors import NotFoundError
from wsgen.model.behavior import Drive, Reach
from wsgen.model.robot import JointType

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from wsgen.model.behavior import Task, TimeSeries
    from wsgen.model.outcome import PackageOutcome, RobotOutcome, SceneView


LEVELS = 65535  # of a number between the least and the greatest of its column
ALIGNMENT = 4  # bytes, of where an array begins
LENGTH_BYTES = 4  # of the length of the header, little-endian


class Packer:
    """Collects arrays, and gives what stands for each of them in the header."""

    def __init__(self) -> None:
        self._data = bytearray()

    def column(self, values: Sequence[float]) -> dict[str, float]:
        """Numbers, each as one of `LEVELS` steps from the least of them to the greatest."""
        low, high = min(values, default=0.0), max(values, default=0.0)
        step = (high - low) / LEVELS or 1.0
        # A step that is next to 0 is not exact.
        levels = array("H", (min(LEVELS, round((value - low) / step)) for value in values))
        if sys.byteorder == "big":
            levels.byteswap()
        return {"at": self.add(levels.tobytes()), "n": len(levels), "low": low, "step": step}

    def add(self, data: bytes) -> int:
        """Add bytes; gives where they begin."""
        at = len(self._data)
        self._data += data
        self._data += bytes(-len(self._data) % ALIGNMENT)
        return at

    def pack(self, header: dict[str, Any]) -> str:
        """All of it as a text of ASCII characters."""
        text = json.dumps(header, allow_nan=False, separators=(",", ":")).encode()
        text += b" " * (-len(text) % ALIGNMENT)
        whole = len(text).to_bytes(LENGTH_BYTES, "little") + text + bytes(self._data)
        return compress(whole)


def compress(data: bytes) -> str:
    """Bytes as gzip in base64, the same every time."""
    return base64.b64encode(gzip.compress(data, 9, mtime=0)).decode()


def pack_package(package: PackageOutcome, clean: Callable[[str], str]) -> str | None:
    """The time series and the view of a package; None where it has neither.

    `clean` makes names of the user printable.
    """
    packer = Packer()
    robots = [_robot(robot, packer, clean) for robot in package.robots]
    view = None if package.view is None else _view(package.view, packer, clean)
    if view is None and not any(robot["series"] for robot in robots):
        return None
    return packer.pack({"robots": robots, "view": view})


def _robot(robot: RobotOutcome, packer: Packer, clean: Callable[[str], str]) -> dict[str, Any]:
    tasks = {one.name: one.task for one in robot.behaviors}
    slides = _slides(robot)
    return {
        "entity": clean(robot.entity),
        "series": [
            {
                "engine": engine.engine,
                "behavior": None if series.behavior is None else clean(series.behavior),
                "goal": _goal(series, tasks.get(series.behavior or ""), packer),
                **_series(series, slides, packer, clean),
            }
            for engine in robot.engines
            for series in engine.time_series
            if series.seconds
        ],
    }


def _goal(series: TimeSeries, task: Task | None, packer: Packer) -> dict[str, Any] | None:
    """The corners of the area on the ground in which a behavior has to end, in the world, m.

    Where one coordinate alone is checked, it is a strip along the way.
    """
    if task is None or isinstance(task, Reach) or (task.x is None and task.y is None):
        return None
    drive = task if isinstance(task, Drive) else task.as_drive
    slack = drive.slack(drive.x, drive.y)
    east, north, _ = series.positions[0]
    cos, sin = math.cos(series.heading), math.sin(series.heading)
    ways = [(x - east, y - north) for x, y, _ in series.positions]
    ahead = _reach(drive.x, slack, [cos * x + sin * y for x, y in ways])
    left = _reach(drive.y, slack, [cos * y - sin * x for x, y in ways])
    corners = [(ahead[i], left[j]) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1), (0, 0))]
    return {
        "x": packer.column([east + cos * x - sin * y for x, y in corners]),
        "y": packer.column([north + sin * x + cos * y for x, y in corners]),
    }


def _reach(wanted: float | None, slack: float, way: Sequence[float]) -> tuple[float, float]:
    """From where to where a coordinate may be at the end; as far as the way where any is good."""
    if wanted is None:
        return min(way) - slack, max(way) + slack
    return wanted - slack, wanted + slack


def _slides(robot: RobotOutcome) -> set[str]:
    """The names of the joints whose positions are lengths."""
    joints = robot.description.joints if robot.description else ()
    return {joint.name for joint in joints if joint.type is JointType.PRISMATIC}


def _series(
    series: TimeSeries, slides: set[str], packer: Packer, clean: Callable[[str], str]
) -> dict[str, Any]:
    x, y, z = zip(*series.positions, strict=True)
    joints = sorted(
        series.joint_positions.items(), key=lambda joint: min(joint[1]) - max(joint[1])
    )  # what moves most is first
    return {
        "seconds": packer.column(series.seconds),
        "x": packer.column(x),
        "y": packer.column(y),
        "height": packer.column(z),
        "speed": packer.column(series.speeds),
        "tilt": packer.column([math.degrees(tilt) for tilt in series.tilts]),
        "joints": [
            {"name": clean(name), "slides": name in slides, **packer.column(positions)}
            for name, positions in joints
        ],
    }


def _view(view: SceneView, packer: Packer, clean: Callable[[str], str]) -> dict[str, Any] | None:
    if not view.parts:
        return None
    return {"ground": view.has_ground, "tile": view.tile, "parts": [*_parts(view, packer, clean)]}


def _parts(
    view: SceneView, packer: Packer, clean: Callable[[str], str]
) -> Iterator[dict[str, Any]]:
    for part in view.parts:
        corners, triangles = base64.b64decode(part.corners), base64.b64decode(part.triangles)
        yield {
            "entity": clean(part.entity),
            "link": clean(part.link),
            "rgba": part.rgba,
            "round": part.is_round,
            "robot": part.is_robot,
            "low": part.low,
            "step": part.step,
            "corners": {"at": packer.add(corners), "n": len(corners) // 2},
            "triangles": {
                "at": packer.add(triangles),
                "n": len(triangles) // (4 if part.has_wide_numbers else 2),
                "wide": part.has_wide_numbers,
            },
        }


SCRIPT = "package_data/plotly.min.js"


class PlotlyLibrary(NamedTuple):
    """A script that defines `Plotly`, under the MIT license; its first lines say so."""

    script: str
    version: str


def _find() -> Path | None:
    spec = find_spec("plotly")
    file = Path(spec.origin).parent / SCRIPT if spec is not None and spec.origin else None
    return file if file is not None and file.is_file() else None


def require_plotly(*, extra: str = "report") -> None:
    """Check that it is installed; `extra` is the one of wsgen that brings it.

    Raises:
        NotFoundError: It is not; the hint says how to install it.
    """
    if _find() is None:
        raise NotFoundError(
            "plotly, which draws the plots of the report, is not installed.",
            hint=f"Install it: pip install 'wsgen[{extra}]'",
        )


def read_plotly(*, extra: str = "report") -> PlotlyLibrary:
    """Read the script; `extra` is the one of wsgen that brings it.

    Raises:
        NotFoundError: It is not installed.
    """
    require_plotly(extra=extra)
    script = (_find() or Path()).read_text(encoding="utf-8")
    found = re.search(r"plotly\.js v([\w.+-]+)", script[:500])
    return PlotlyLibrary(script, found[1] if found else "")
