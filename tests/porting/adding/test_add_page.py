"""docs/add.md: its table has every kind, its example is what wsgen does."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from golden_support import golden_package
from porting.adding.added import added
from wsgen.checks.fixes.plan import unified_diff
from wsgen.cli.add import command
from wsgen.porting.adding.nodes import NodeOptions, add_node

PAGE = Path(__file__).parents[3] / "docs" / "add.md"


def example(folder: Path) -> str:
    """What changes in the tutorial's package."""
    package = folder / "src" / "gazebo_test"
    shutil.copytree(golden_package("simple-jazzy-gz"), package)
    options = NodeOptions(publishes=["chatter:std_msgs/String"], parameters=["rate:=2.0"])
    plan, _ = added(package, lambda one: add_node(one, "talker", options))
    names = [file.relative_to(package).as_posix() for file, _ in plan.created]
    assert names == ["scripts/talker.py", "launch/talker.launch.py", "test/test_talker.py"]
    diff = [
        line
        for fix in plan.files
        for line in unified_diff(fix, fix.file.relative_to(package).as_posix())
    ]
    return "\n".join(("```diff", *diff, "```"))


def test_the_page_shows_what_is(tmp_path: Path, *, regenerate: bool) -> None:
    page = PAGE.read_text(encoding="utf-8")
    begin, end = "<!-- example -->\n", "<!-- end of example -->\n"
    before, _, rest = page.partition(begin)
    written = f"{before}{begin}{example(tmp_path)}\n{end}{rest.partition(end)[2]}"
    if regenerate:
        PAGE.write_text(written, encoding="utf-8")
    assert page == written


def test_the_page_has_every_kind() -> None:
    rows = re.findall(r"(?m)^\| (`\w+ .*?`) \|", PAGE.read_text(encoding="utf-8"))
    words = {word.partition(" ")[0] for row in rows for word in re.findall(r"`([^`]+)`", row)}
    assert words == {*command.commands}
