"""The diagram of docs/architecture.md is what the code does."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src" / "wsgen"

# One module each; xacro's and colcon's doors lie deeper than one import.
FOREIGN = {
    "pybullet": "simulation/bullet.py",
    "coacd": "descriptions/meshes/worker.py",
    "trimesh": "descriptions/meshes/worker.py",
    "shapely": "descriptions/meshes/shape_worker.py",
    "dartpy": "simulation/dart.py",
    "mujoco": "simulation/mujoco_body.py",
    "mcap": "live/nodes/mcap_recording.py",
    "distributed": "sweeping/dask_cluster.py",
    "av": "rendering/video.py",
    "pyarrow": "sweeping/table.py",
    "matplotlib": "sweeping/plots.py",
    "scipy": "sweeping/samples.py",
    "viser": "reporting/viewing/page.py",
    "websockets": "reporting/viewing/page.py",
    "xacro": "descriptions/xacro/expansion.py",
    "jinja2": "templating/environment.py",
    "catkin_pkg": "packages/workspace/package_xml.py",
    "lxml": "text/xmltree.py",
}


def test_imports_point_down() -> None:
    linter = Path(sys.executable).with_name("lint-imports")
    run = subprocess.run(
        [linter, "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stdout + run.stderr


def test_the_diagram_in_the_documentation_is_the_contract() -> None:
    contract = (ROOT / "pyproject.toml").read_text().split("layers = [")[1].split("]")[0]
    layers = [line.strip(' ",') for line in contract.strip().splitlines()]
    diagram = (ROOT / "docs" / "architecture.md").read_text().split("<!-- layers -->")[1]
    assert diagram.split("```")[1].strip().splitlines() == layers


@pytest.mark.parametrize("page", ["docs/architecture.md", "CONTRIBUTING.md"])
def test_modules_that_are_named_are_there(page: str) -> None:
    named = set(re.findall(r"`((?:\w+/)+\w+\.py)`", (ROOT / page).read_text()))
    roots = (SOURCE, ROOT)
    lost = {name for name in named if not any((root / name).is_file() for root in roots)}
    assert {name for name in lost if not name.endswith("/NAME.py")} == set()
    assert named


@pytest.mark.parametrize("library", FOREIGN)
def test_a_foreign_library_has_one_door(library: str) -> None:
    doors = {
        path.relative_to(SOURCE).as_posix()
        for path in SOURCE.rglob("*.py")
        for line in path.read_text().splitlines()
        if line.strip().startswith((f"import {library}", f"from {library}"))
    }
    assert doors == {FOREIGN[library]}


def test_only_the_command_line_imports_click_and_rich() -> None:
    users = {
        path.relative_to(SOURCE).parts[0]
        for path in SOURCE.rglob("*.py")
        for line in path.read_text().splitlines()
        if line.strip().startswith(("import click", "from click", "import rich", "from rich"))
    }
    assert users == {"cli"}


def test_what_starts_nodes_and_nodes_do_not_import_each_other() -> None:
    """They are processes apart: one of ROS may have another Python than the one that starts it."""
    folder = SOURCE / "live"
    for file in folder.rglob("*.py"):
        is_node = file.is_relative_to(folder / "nodes")
        other = (
            r"from wsgen\.live(\.(?!nodes\b)| import)" if is_node else r"from wsgen\.live\.nodes"
        )
        assert re.search(other, file.read_text(encoding="utf-8")) is None, file
