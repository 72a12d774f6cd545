"""docs/live.md names what the simulator has."""

import re
from pathlib import Path

import pytest

from wsgen.live.nodes.simulator.plugins import PLUGINS
from wsgen.live.nodes.simulator.ros2_control.controllers import TYPES
from wsgen.live.nodes.simulator.sensors import SENSORS

PAGE = (Path(__file__).parents[2] / "docs" / "live.md").read_text(encoding="utf-8")


def named(part: str) -> set[str]:
    """What the first column of the tables in a part of the page names."""
    text = PAGE.split(f"<!-- {part} -->\n")[1].split(f"<!-- {part} end -->")[0]
    cells = [line.split("|")[1] for line in text.splitlines() if line.startswith("| `")]
    return {name for cell in cells for name in re.findall(r"`([^`]+)`", cell)}


@pytest.mark.parametrize(
    ("part", "known"), [("plugins", {*PLUGINS, *SENSORS}), ("controllers", {*TYPES})]
)
def test_tables(part: str, known: set[str]) -> None:
    assert named(part) == known
