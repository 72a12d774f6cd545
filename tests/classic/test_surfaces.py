"""Bodies that slide, fall and press, in wsgen's engines and in the real Gazebo Classic.

`recorded/surfaces.json` has where the body of each world is after its time, m, and how it moves,
m/s, in Debian 11's Gazebo 11.1. `--regenerate` records it anew.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from classic.gazebo_classic import NEEDS_CLASSIC, GazeboClassic, recorded_in
from classic.worlds import ENGINES, SURFACES, not_followed, simulated, world_of
from wsgen.checks.rules.settings import FRICTION_DIRECTION, MIN_DEPTH, SOFT
from wsgen.model.engines import ENGINES as SPECS

if TYPE_CHECKING:
    from classic.worlds import Body

RECORDED = Path(__file__).with_name("recorded") / "surfaces.json"
LIVE = ("mu 0.5 on 100, 45 degrees",)

# What does not move as there, in these engines, and why.
ONE_WAY = "dartpy has one coefficient for all directions"
DIFFERENT = {
    "mu 0.1 alone, down along 0 degrees": (ONE_WAY, ("dart",)),
    "mu 0.5, mu2 0.1, down along 0 degrees": (ONE_WAY, ("dart",)),
    "mu 0.5, mu2 0.1, down along 45 degrees": (ONE_WAY, ("dart",)),
    "fdir1, mu 0.5, mu2 0.1, down along 90 degrees": not_followed(FRICTION_DIRECTION),
    "slip2 0.1, 10 degrees": ("with <slip1> and <slip2>, friction lets go there", tuple(SPECS)),
    "rests on a soft surface": not_followed(SOFT),
    "5 mm deep": ("DART pushes it out more slowly", ("dart",)),
    "5 mm deep, with min_depth": not_followed(MIN_DEPTH),
}
# The real one slips by some millimeters where friction should hold it.
SAME_HEIGHT = 0.0001  # m
SAME_PLACE = 0.02  # m, m/s
SAME_WAY = 0.005  # of the way

pytestmark = [pytest.mark.oracle, pytest.mark.slow]


def ask(one: Body, folder: Path) -> dict[str, Any]:
    file = folder / "w.world"
    file.write_text(world_of(one), encoding="utf-8")
    with GazeboClassic(file) as gazebo:
        gazebo.run(one.seconds)
        link = gazebo.state()["body"]["links"]["body::link"]
    return {
        "place": [round(part, 5) for part in link["pose"][:3]],
        "velocity": [round(part, 4) for part in link["linear"]],
    }


@pytest.fixture(scope="module")
def recorded(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("surfaces")
    return recorded_in(RECORDED, request, SURFACES, lambda name: ask(SURFACES[name], folder))


@NEEDS_CLASSIC
@pytest.mark.parametrize("name", LIVE)
def test_the_record_is_what_gazebo_classic_does(name: str, recorded: Any, tmp_path: Path) -> None:
    assert ask(SURFACES[name], tmp_path) == recorded[name]


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("name", SURFACES)
def test_moves_as_in_gazebo_classic(name: str, engine: str, recorded: Any, tmp_path: Path) -> None:
    place, velocity = simulated(SURFACES[name], engine, tmp_path)
    real = recorded[name]
    is_same = (
        place[:2] == pytest.approx(real["place"][:2], rel=SAME_WAY, abs=SAME_PLACE)
        and place[2] == pytest.approx(real["place"][2], abs=SAME_HEIGHT)
        and velocity[:2] == pytest.approx(real["velocity"][:2], rel=SAME_WAY, abs=SAME_PLACE)
    )
    _, different = DIFFERENT.get(name, ("", ()))
    assert is_same == (engine not in different)
