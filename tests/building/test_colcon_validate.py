"""`colcon validate`: colcon selects the packages and runs the jobs."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from importlib.metadata import entry_points
from pathlib import Path
from textwrap import dedent

import pytest

from building.building import COLCON, PACKAGE_XML
from cli.packages import wsgen
from wsgen.building import colcon_validate
from wsgen.building.colcon_validate import ENGINES, RESULT, Result, ValidateTask, read_result
from wsgen.cli.validate import command


def colcon(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [COLCON, *words],
        cwd=folder,
        env={**os.environ, "COLCON_HOME": str(folder / "home")},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A robot that stands, one whose xacro file is broken, and a package without a robot."""
    root = tmp_path_factory.mktemp("ws")
    for name in ("good_robot", "bad_robot"):
        assert wsgen(root, "new", name, "-w", str(root)).returncode == 0
    (model,) = (root / "src" / "bad_robot" / "model").glob("robot.xacro")
    model.write_text(model.read_text().replace("</robot>", "</robott>"))
    messages = root / "src" / "my_msgs"
    messages.mkdir()
    (messages / "package.xml").write_text(PACKAGE_XML.replace("demo", "my_msgs"))
    (messages / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.8)\n")
    return root


def most_at_once(log: Path) -> int:
    """How many packages colcon had in progress at a time."""
    now = most = 0
    for event in re.findall(
        r"^\[[\d.]+\] \(.*?\) (\w+)", (log / "events.log").read_text(), re.MULTILINE
    ):
        now += {"JobStarted": 1, "JobEnded": -1}.get(event, 0)
        most = max(most, now)
    return most


@pytest.mark.slow
def test_packages_pass_fail_and_are_skipped(workspace: Path) -> None:
    words = ("--parallel-workers", "2", "--seconds", "0.5", "--picture", "pictures")
    done = colcon(workspace, "validate", *words)
    assert done.returncode == 1, done.stdout + done.stderr
    # colcon's own handlers draw the events, and show the errors of what fails.
    for line in (
        "Finished <<< good_robot",
        "Failed   <<< bad_robot",
        "1 package failed: bad_robot",
    ):
        assert line in done.stdout + done.stderr
    assert "--- stderr: bad_robot\n" in done.stderr
    assert "xacro fails" in done.stderr
    assert "--- stderr: good_robot" not in done.stderr
    assert "Robots: 1 package passed, 1 package failed, 1 package skipped\n" in done.stdout
    assert "  my_msgs skipped: spawns no robot\n" in done.stdout
    assert "      try: " in done.stdout
    assert [file.name for file in (workspace / "pictures").iterdir()] == ["good_robot.png"]
    log = workspace / "log" / "latest_validate"
    assert "good_robot: passed" in (log / "good_robot" / "stdout.log").read_text()
    assert most_at_once(log) == 2
    assert (workspace / "build" / "COLCON_IGNORE").is_file()
    results = colcon(workspace, "test-result", "--verbose")
    assert results.returncode == 1
    assert "- bad_robot.gazebo_model_launch_py launch file (src/bad_robot/model/" in results.stdout
    assert "1 failure, 1 skipped" in results.stdout


@pytest.mark.slow
def test_without_ros_packages_are_built_in_order(workspace: Path) -> None:
    """As each finds those before it; the user's choice is stronger."""
    words = ("build", "--packages-select", "good_robot", "bad_robot", "--parallel-workers", "2")
    for more, expected in ((), 1), (("--executor", "parallel"), 2):
        done = colcon(workspace, *words, *more)
        assert done.returncode == 0, done.stdout + done.stderr
        assert most_at_once(workspace / "log" / "latest_build") == expected


@pytest.mark.slow
def test_the_selection_and_the_options(workspace: Path) -> None:
    words = ("--packages-up-to", "good_robot", "--executor", "sequential", "--seconds", "0.5")
    options = ("--launch", "gazebo_model.launch.py", "--arg", "z:=0.4", "--engine", "bullet")
    done = colcon(workspace, "validate", *words, *options, "--event-handlers", "console_direct+")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Robots: 1 package passed, 0 packages failed, 0 packages skipped\n" in done.stdout
    assert "0.00 0.00 0.400" in done.stdout
    refused = colcon(workspace, "validate", *words, "--seconds", "1000")
    assert refused.returncode == 2
    assert "    error: Invalid value for '--seconds'" in refused.stdout
    assert "      try: wsgen validate " in refused.stdout
    nothing = colcon(workspace, "validate", "--packages-select", "good_robt")
    assert nothing.returncode == 0, nothing.stdout + nothing.stderr
    assert "Robots: no package is selected\n  try: Go to the folder" in nothing.stdout


@pytest.mark.slow
def test_packages_elsewhere_and_another_install_space(workspace: Path, tmp_path: Path) -> None:
    """Two source trees beside the folder that colcon is run in, and packages built elsewhere."""
    first, second, here = (tmp_path / name for name in ("first", "second", "here"))
    shutil.copytree(workspace / "src" / "good_robot", first / "src" / "good_robot")
    shutil.copytree(workspace / "src" / "my_msgs", second / "my_msgs")
    here.mkdir()
    places = ("--base-paths", "../first", "../second", "--install-base", "../out")
    for words in (("validate", "--seconds", "0.2"), ("build", "--packages-select", "good_robot")):
        done = colcon(here, *words, *places)
        assert done.returncode == 0, done.stdout + done.stderr
        if words[0] == "validate":
            assert "Robots: 1 package passed, 0 packages failed, 1 package skipped" in done.stdout
    # What is built there counts: the source has changed since.
    (launch_file,) = (first / "src" / "good_robot" / "launch").iterdir()
    launch_file.write_text("def generate_launch_description():\n    raise ValueError\n")
    done = colcon(here, "validate", *places, "--packages-select", "good_robot")
    assert done.returncode == 0, done.stdout + done.stderr
    report = json.loads((here / "build" / "good_robot" / f"{RESULT}.json").read_text())
    (package,) = report["packages"]
    assert package["share"] == f"{tmp_path}/out/good_robot/share/good_robot"
    assert "PKG065" not in {one["code"] for one in package["diagnostics"]}


def test_the_verb_is_registered() -> None:
    found = entry_points(group="colcon_core.verb", name="validate")
    assert [one.value for one in found] == ["wsgen.building.colcon_verb:ValidateVerb"], (
        "install wsgen again: its entry points have changed"
    )


def test_colcon_loads_next_to_nothing_for_other_verbs() -> None:
    """All verbs are imported for each command, `colcon --help` too."""
    code = dedent(
        """
        import sys
        import colcon_core.verb, colcon_core.plugin_system, wsgen.building
        before = set(sys.modules)
        import wsgen.building.colcon_verb
        wsgen.building.colcon_verb.ValidateVerb()
        print(*sorted(set(sys.modules) - before))
        """
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == ["wsgen.building.colcon_verb"]


def test_the_engines_are_those_of_wsgen() -> None:
    (engine,) = (one for one in command.params if one.name == "engine")
    assert tuple(engine.type.choices) == ENGINES  # type: ignore[attr-defined]


def document(**values: object) -> dict[str, object]:
    return {"passed": True, "packages": [], "not_validated": [], **values}


def task(result: Result | None, problem: str = "") -> ValidateTask:
    made = ValidateTask("p", Path("build/p"))
    made.result = result
    made.problem = problem
    made.has_ended = True
    return made


def test_what_the_summary_says(tmp_path: Path) -> None:
    errors = [
        {
            "severity": "error",
            "code": "SPN059",
            "name": "tips-over",
            "message": f"It tips over {number}.",
            "file": "/ws/r.urdf",
            "line": number,
            "hint": None,
        }
        for number in range(5)
    ]
    package = {"robots": [{}], "diagnostics": errors, "picture": "/ws/p.png"}
    file = tmp_path / f"{RESULT}.json"
    file.write_text(json.dumps(document(passed=False, packages=[package])))
    result = read_result(file)
    assert result is not None
    assert (result.robots, result.skipped, len(result.errors)) == (1, (), 5)
    assert result.errors[1] == "/ws/r.urdf:1: error[SPN059] tips-over: It tips over 1."
    tasks = [task(result), task(None, "error: No.\n  try: Yes."), task(None)]
    lines = list(colcon_validate._summary(tasks))
    assert lines[1] == "Robots: 0 packages passed, 3 packages failed, 0 packages skipped"
    assert lines[2:] == [
        "  p failed",
        *(f"    {error}" for error in result.errors[:3]),
        "    and 2 more errors",
        "    picture: /ws/p.png",
        "  p failed",
        "    error: No.",
        "      try: Yes.",
        "  p failed",
        "    it was not validated to the end",
    ]
    file.write_text(json.dumps(document(not_validated=[{"reason": "spawns no robot"}] * 2)))
    lines = list(colcon_validate._summary([task(read_result(file))]))
    assert lines[2:] == ["  p skipped: spawns no robot"]
    assert list(colcon_validate._summary([]))[1:] == [
        "Robots: no package is selected",
        "  try: Go to the folder that contains src, and check the names that you select.",
    ]
    interrupted = [ValidateTask("q", tmp_path), task(read_result(file))]
    assert list(colcon_validate._summary(interrupted))[1].endswith(
        "0 packages failed, 1 package skipped, 1 package not validated"
    )


@pytest.mark.parametrize("text", [None, "", "{"])
def test_a_result_that_was_not_written(tmp_path: Path, text: str | None) -> None:
    file = tmp_path / "r.json"
    if text is not None:
        file.write_text(text)
    assert read_result(file) is None


def test_the_page_names_every_option() -> None:
    page = (Path(__file__).parents[2] / "docs" / "colcon.md").read_text()
    source = Path(colcon_validate.__file__).read_text()
    for option in re.findall(r'"(--[a-z-]+)",?\n? *(?:\n|default|type|metavar|choices)', source):
        assert f"`{option}" in page, option


def test_errors_in_files_of_any_name_can_be_printed(tmp_path: Path) -> None:
    file = os.fsdecode(b"r\xff.urdf")
    found = {"severity": "error", "code": "ROB022", "name": "n", "message": "m", "hint": file}
    package = {"diagnostics": [found | {"file": file, "line": 7}], "robots": [], "picture": file}
    document = {"passed": False, "packages": [package], "not_validated": []}
    (tmp_path / "r.json").write_text(json.dumps(document))
    result = read_result(tmp_path / "r.json")
    assert result is not None
    assert result.errors == ("r\ufffd.urdf:7: error[ROB022] n: m",)
    assert (result.hints, result.pictures) == (("r\ufffd.urdf",), ("r\ufffd.urdf",))
