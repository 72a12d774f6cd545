"""A run names, once, what its engines do not follow of a robot for Gazebo Classic."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from planted_packages import check_all
from wsgen.checks.rules.settings import SETTING_NOT_SIMULATED
from wsgen.packages.workspace.layout import Workspace
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.validate import validate

GOLDEN = Path(__file__).parents[1] / "golden"
SOFT = '<gazebo reference="base_link"><kp>1000</kp><kd>10</kd></gazebo>'

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(("kind", "count"), [("iron-classic", 1), ("jazzy-gz", 0)])
def test_a_run_for_gazebo_classic_names_it_once_and_check_does_not(
    kind: str, count: int, tmp_path: Path
) -> None:
    shutil.copytree(GOLDEN / f"simple-{kind}" / "ws_gazebo", tmp_path, dirs_exist_ok=True)
    file = tmp_path / "src" / "gazebo_test" / "model" / "robot.gazebo"
    text = file.read_text(encoding="utf-8").replace("</robot>", f"{SOFT}\n</robot>")
    file.write_text(text, encoding="utf-8")
    outcome = validate(
        Workspace(root=tmp_path),
        ValidateRequest(seconds=0.02, engines=("bullet",)),
        environment={"PATH": os.environ["PATH"]},
    )
    code = SETTING_NOT_SIMULATED.code
    found = [
        one
        for package_outcome in outcome.packages
        for one in package_outcome.diagnostics
        if one.code == code
    ]
    assert len(found) == count
    for one in found:
        assert one.file == file
        assert one.line == text[: text.index(SOFT)].count("\n") + 1
    checked = check_all(tmp_path / "src", kind.partition("-")[0])
    assert code not in {one.code for some in checked.values() for one in some}
