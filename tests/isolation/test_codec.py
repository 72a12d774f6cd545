"""What a child answers, as JSON and back."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Mapping  # noqa: TC003  type hints are read
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple

import pytest

from wsgen.diagnostics import Severity
from wsgen.isolation import parent
from wsgen.isolation.codec import decode, encode
from wsgen.isolation.result import Answered


@dataclass(frozen=True)
class Point:
    x: float
    y: float = 0.0


@dataclass(frozen=True)
class Other:
    x: float


class Named(NamedTuple):
    point: Point
    names: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Everything:
    place: Point | Other | None = None
    points: tuple[Point, ...] = ()
    pair: tuple[int, str] = (1, "a")
    numbers: Mapping[str, float] = field(default_factory=dict)
    lists: list[tuple[float, ...]] = field(default_factory=list)
    severity: Severity = Severity.INFO
    file: Path | None = None
    word: Literal["a", "b"] = "a"
    number_or_name: int | str = 0
    is_so: bool = False
    named: tuple[Named, ...] = ()


@pytest.mark.parametrize(
    "value",
    [
        Everything(),
        Everything(place=Point(1.0, 2.0)),
        Everything(place=Other(1.0)),  # as `Point(1.0)` but for its name
        Everything(
            points=(Point(1.5), Point(math.inf)),
            pair=(7, "seven"),
            numbers={"ü": 0.1, "": -0.0},
            lists=[(), (1.0, 2.0)],
            severity=Severity.ERROR,
            file=Path("a b/c"),
            named=(Named(Point(1.0), ("a",)), Named(Point(2.0))),
            word="b",
            number_or_name="seven",
            is_so=True,
        ),
    ],
)
def test_there_and_back(value: Everything) -> None:
    assert decode(json.loads(encode(value)), Everything) == value
    several = decode(json.loads(encode([value, value])), tuple[Everything, ...])
    assert several == (value, value)


def test_numbers_without_a_fraction_become_floats() -> None:
    point = decode(json.loads(encode(Point(1, 2))), Point)
    assert (type(point.x), type(point.y)) == (float, float)


@pytest.mark.parametrize(
    "changed",
    [
        {"points": 3},
        {"points": [1]},
        {"points": [{"$type": "Other", "x": 1.0}]},
        {"pair": [1]},
        {"pair": ["1", "a"]},
        {"numbers": {"a": "b"}},
        {"numbers": [["a", 1.0]]},
        {"word": "c"},
        {"is_so": 1},
        {"number_or_name": 1.5},
        {"number_or_name": True},
        {"another": 1},
        {"$type": "Point"},
    ],
)
def test_what_does_not_fit_is_refused(changed: dict[str, Any]) -> None:
    value = json.loads(encode(Everything()))
    with pytest.raises(TypeError, match="A child answered"):
        decode({**value, **changed}, Everything)


def test_what_json_does_not_have_is_refused() -> None:
    with pytest.raises(TypeError, match="A set cannot be written"):
        encode({"a": {1}})


def test_a_child_answers_with_a_dataclass(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    module = "from dataclasses import dataclass\n@dataclass\nclass Point:\n    x: float\n"
    (tmp_path / "points.py").write_text(module + "def make(x):\n    return Point(x)\n")
    monkeypatch.setattr(sys, "path", [*sys.path, str(tmp_path)])
    outcome = parent.run("points:make", 2.5)
    assert isinstance(outcome, Answered)
    assert decode(outcome.value, Point) == Point(2.5)


@pytest.mark.slow
def test_a_child_that_needs_no_dataclasses_does_not_load_them() -> None:
    script = "import sys, wsgen.isolation.child; print('dataclasses' in sys.modules)"
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "False"
