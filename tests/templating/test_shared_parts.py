"""What robots have in common exists once: a change of it reaches all that have it, and no other."""

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from golden_support import CASES
from templating.broken_templates import spec_for
from wsgen.model.target import Target
from wsgen.templating import sources
from wsgen.templating.render import RenderedTree, render_package
from wsgen.templating.template import load_template


def render_all() -> dict[str, RenderedTree]:
    """The package of each case of the matrix, with the templates that are there now."""
    trees = {}
    for case, (name, target) in CASES.items():
        template = load_template(name)
        trees[case] = render_package(spec_for(template, target=target), template)
    return trees


@pytest.fixture(scope="module")
def before() -> dict[str, RenderedTree]:
    """The packages from the templates as they are."""
    return render_all()


def every(_name: str, _target: Target) -> bool:
    """The whole matrix."""
    return True


def none(_name: str, _target: Target) -> bool:
    """No case of the matrix."""
    return False


def classic(_name: str, target: Target) -> bool:
    """Every template for Gazebo Classic."""
    return target.simulator == "classic"


def gz(_name: str, target: Target) -> bool:
    """Every template for Gazebo Sim."""
    return target.simulator == "gz"


def with_joints(name: str, _target: Target) -> bool:
    """The templates whose robots move."""
    return name in {"arm", "diff_drive", "wanderer"}


def with_lidar(name: str, _target: Target) -> bool:
    """The templates whose robots have a lidar."""
    return name in {"diff_drive", "wanderer"}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("source", "paths", "concerns"),
    [
        ("base/package.xml.j2", ["package.xml"], every),
        ("base/inertia.xacro.j2", ["model/inertia.xacro"], every),
        ("base/robot.xacro.j2", ["model/robot.xacro"], every),
        ("base/materials.xacro.j2", ["model/robot.xacro"], with_joints),
        ("base/gazebo_model.launch.py.j2", ["launch/gazebo_model.launch.py"], every),
        ("base/display.launch.py.j2", ["launch/display.launch.py"], with_joints),
        ("base/robot.rviz.j2", ["config/robot.rviz"], with_joints),
        ("base/gz/start.py.j2", ["launch/gazebo_model.launch.py"], gz),
        ("base/classic/start.py.j2", ["launch/gazebo_model.launch.py"], classic),
        ("base/classic/empty_world.world.j2", ["model/empty_world.world"], classic),
        ("base/gz/empty_world.world.j2", ["model/empty_world.world"], gz),
        ("base/gz/bridge.yaml.j2", ["config/bridge.yaml"], gz),
        ("base/run.md.j2", ["README.md"], every),
        ("base/parameters.md.j2", ["README.md"], every),
        ("base/display.md.j2", ["README.md"], with_joints),
        ("base/wsgen.toml.j2", ["wsgen.toml"], every),
        ("base/licenses/Apache-2.0.txt.j2", ["LICENSE"], none),  # rendered with MIT
        ("arm/robot.xacro.j2", ["model/robot.xacro"], lambda name, _: name == "arm"),
        ("diff_drive/lidar.xml.j2", ["model/robot.gazebo"], with_lidar),
    ],
)
def test_a_change_reaches_exactly_the_packages_that_it_concerns(
    before: dict[str, RenderedTree],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    *,
    source: str,
    paths: list[str],
    concerns: Callable[[str, Target], bool],
) -> None:
    changed = changed_by(source, before, tmp_path, monkeypatch)
    assert changed == {
        case: with_worlds(name, paths) if concerns(name, target) else set()
        for case, (name, target) in CASES.items()
    }


def with_worlds(name: str, paths: list[str]) -> set[str]:
    """The paths, and the world of the template that extends the empty one."""
    extends = name == "wanderer" and "model/empty_world.world" in paths
    return {*paths, "model/boxes.world"} if extends else set(paths)


@pytest.mark.slow
def test_a_change_of_the_publisher_reaches_both_launch_files(
    before: dict[str, RenderedTree], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    changed = changed_by("base/robot_state_publisher.py.j2", before, tmp_path, monkeypatch)
    for case, paths in changed.items():
        both = {"launch/gazebo_model.launch.py", "launch/display.launch.py"}
        assert paths == (both if with_joints(*CASES[case]) else {"launch/gazebo_model.launch.py"})


@pytest.mark.slow
def test_gazebo_classic_paints_named_visuals(before: dict[str, RenderedTree]) -> None:
    """It does so only if the name begins with that of the link."""
    painted = set()
    for tree in before.values():
        text = str(tree["model/robot.xacro"])
        for link, content in re.findall(r'<link name="([^"]+)">(.*?)</link>', text, re.DOTALL):
            for name in re.findall(r'<visual name="([^"]+)"', content):
                assert name.startswith(f"{link}_")
                painted.add(name)
    assert "${name}_tire" in painted


def changed_by(
    source: str, before: dict[str, RenderedTree], folder: Path, monkeypatch: pytest.MonkeyPatch
) -> dict[str, set[str]]:
    """Case -> the files that another first line in a source changes."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder / "cache"))
    shutil.copytree(sources.templates_folder(), folder / "templates")
    monkeypatch.setattr(sources, "_PACKAGE", folder / "src" / "wsgen")
    file = folder / "templates" / source
    file.write_text(changed_text(file.read_text(encoding="utf-8")), encoding="utf-8")
    after = render_all()
    return {
        case: {name for name in before[case] if before[case][name] != after[case][name]}
        for case in CASES
    }


def changed_text(text: str) -> str:
    """A text with another first line, within a block where one extends another."""
    if "{% block robot %}\n" in text and "{% extends" in text:
        return text.replace("{% block robot %}\n", "{% block robot %}\nchanged\n", 1)
    return "changed\n" + text
