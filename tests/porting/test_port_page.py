"""docs/port.md: its table is the data, its example is what wsgen does."""

from __future__ import annotations

import os
import re
import shutil
from pathlib import Path

from golden_support import golden_package
from wsgen.checks.fixes.plan import unified_diff
from wsgen.gazebo.sensors import SYSTEM_OF_SENSOR
from wsgen.gazebo.successors import AS_IN_ROS_2, CONVERSIONS, SENSOR_TYPES, WITHOUT_COUNTERPART
from wsgen.model.target import SIM, Target
from wsgen.pipeline.check import find_targets
from wsgen.porting.plan import plan_port

ELEMENT, QUOTED = re.compile(r"(<[^>]+>)"), r"`\1`"  # Markdown takes an element for HTML
PAGE = Path(__file__).parents[2] / "docs" / "port.md"


def table() -> str:
    """What plugins and sensors become."""
    lines = ["| in Gazebo Classic | in Gazebo Sim |", "|---|---|"]
    lines += [f"| `lib{name}.so` | {one.system} |" for name, one in CONVERSIONS.items()]
    lines.append("| `libgazebo_ros2_control.so` | `gz_ros2_control-system` |")
    lines += [
        f'| `<sensor type="{name}">` | `<sensor type="{new}">`, with {SYSTEM_OF_SENSOR[new]} |'
        for name, new in SENSOR_TYPES.items()
    ]
    lines += [f"| `lib{old}.so` | as `lib{new}.so` |" for old, new in AS_IN_ROS_2.items()]
    lines += [
        f"| `lib{name}.so`, which {what} | {ELEMENT.sub(QUOTED, advice)} |"
        for name, (what, advice) in WITHOUT_COUNTERPART.items()
    ]
    return "\n".join(lines)


def example(folder: Path) -> str:
    """The port of the tutorial's package."""
    package = folder / "src" / "gazebo_test"
    shutil.copytree(golden_package("simple-humble-classic"), package)
    settings = package / "wsgen.toml"
    lines = settings.read_text(encoding="utf-8").splitlines(keepends=True)
    # That of the templates changes whenever they do.
    kept = "".join(line for line in lines if not line.startswith("state ="))
    settings.write_text(kept, encoding="utf-8")
    plan = plan_port(find_targets([package]), Target(distro="jazzy", simulator=SIM), os.environ)
    assert plan.created == ()
    diff = [
        line
        for fix in plan.files
        for line in unified_diff(fix, fix.file.relative_to(package.resolve()).as_posix())
    ]
    return "\n".join(("```diff", *diff, "```"))


def test_the_page_shows_what_is(tmp_path: Path, *, regenerate: bool) -> None:
    page = written = PAGE.read_text(encoding="utf-8")
    for name, text in (("plugins", table()), ("example", example(tmp_path))):
        begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->\n"
        before, _, rest = written.partition(begin)
        written = f"{before}{begin}{text}\n{end}{rest.partition(end)[2]}"
    if regenerate:
        PAGE.write_text(written, encoding="utf-8")
    assert page == written
