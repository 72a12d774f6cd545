"""docs/from.md: its example is what wsgen does; docs/json.md has every key."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from existing_robots import write_arm
from reporting.test_json_report import documented_keys, keys
from wsgen.cli import run
from wsgen.descriptions.rules import NO_LINK
from wsgen.diagnostics import Severity
from wsgen.packages.workspace.layout import Workspace
from wsgen.pipeline.create import CreatedPackage
from wsgen.porting.existing.comparison import ComparedRow
from wsgen.porting.existing.package import ExistingRobot
from wsgen.porting.ported import Unported
from wsgen.reporting.json_report import render_created

PAGE = Path(__file__).parents[3] / "docs" / "from.md"
COMMAND = "wsgen new my_arm --from arm_description --distro jazzy"


@pytest.mark.slow
def test_the_example(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    *,
    regenerate: bool,
) -> None:
    write_arm(tmp_path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "120")
    maintainer = ("--maintainer-name", "Ada", "--maintainer-email", "ada@example.com")
    assert run([*COMMAND.split()[1:], *maintainer]) == 0
    lines = re.sub(r"─+", "", capsys.readouterr().out).splitlines()
    shown = "\n".join(line.rstrip() for line in lines if line.strip())
    text = f"```\n$ {COMMAND}\n{shown}\n```"
    page = PAGE.read_text(encoding="utf-8")
    before, _, rest = page.partition("<!-- example -->\n")
    after = rest.partition("<!-- end of example -->\n")[2]
    written = f"{before}<!-- example -->\n{text}\n<!-- end of example -->\n{after}"
    if regenerate:
        PAGE.write_text(written, encoding="utf-8")
    assert PAGE.read_text(encoding="utf-8") == written


def test_every_key(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(["new", "some_robot", "-w", str(tmp_path), "--format", "json", "--dry-run"]) == 0
    plain = json.loads(capsys.readouterr().out)
    robot = ExistingRobot(
        created=CreatedPackage(Workspace(root=tmp_path), tmp_path, (), (), is_written=False),
        source="a.urdf",
        kind="urdf",
        rows=(ComparedRow("links", "1", "2", is_same=False, differing=("a",)),),
        notes=("Done.",),
        unported=(Unported(tmp_path, 1, "What.", "Do."),),
        diagnostics=(NO_LINK.at(None, message="m", hint="h", severity=Severity.WARNING),),
    )
    document = json.loads(render_created(robot.created, robot))
    assert set(document) - {"robot"} == set(plain)
    of_check = {name for name in keys(document) if name.startswith("robot.diagnostics[].")}
    assert documented_keys("wsgen new") == keys(document) - of_check
    assert document["robot"]["same"] is False
