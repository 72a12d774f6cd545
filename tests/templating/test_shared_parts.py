"""What robots have in common exists once: a change of it reaches all that have it, and no other."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from golden_support import CASES
from templating.broken_templates import spec_for
from wsgen.model.target import Target
from wsgen.templating import location
from wsgen.templating.manifest import load_template
from wsgen.templating.render import RenderedTree, render_package


def render_all() -> dict[str, RenderedTree]:
    trees = {}
    for case, (name, target) in CASES.items():
        template = load_template(name)
        trees[case] = render_package(spec_for(template, target=target), template)
    return trees


@pytest.mark.parametrize(
    ("source", "path", "concerns"),
    [
        ("package.xml.j2", "package.xml", lambda _: True),
        ("gazebo_model.launch.py.j2", "launch/gazebo_model.launch.py", lambda _: True),
        ("gz/start.py.j2", "launch/gazebo_model.launch.py", lambda one: one.simulator == "gz"),
        (
            "classic/start.py.j2",
            "launch/gazebo_model.launch.py",
            lambda one: one.simulator == "classic",
        ),
        ("gz/empty_world.world.j2", "model/empty_world.world", lambda one: one.simulator == "gz"),
        ("gz/bridge.yaml.j2", "config/bridge.yaml", lambda one: one.simulator == "gz"),
        ("run.md.j2", "README.md", lambda _: True),
        ("licenses/Apache-2.0.txt.j2", "LICENSE", lambda _: False),  # rendered with MIT
    ],
)
def test_a_change_reaches_exactly_the_packages_that_it_concerns(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    source: str,
    path: str,
    concerns: Callable[[Target], bool],
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    before = render_all()
    shutil.copytree(location.templates_folder(), tmp_path / "templates")
    monkeypatch.setattr(location, "_PACKAGE", tmp_path / "src" / "wsgen")
    file = tmp_path / "templates" / "base" / source
    file.write_text("changed\n" + file.read_text(encoding="utf-8"), encoding="utf-8")
    after = render_all()
    for case, (_, target) in CASES.items():
        changed = {name for name in before[case] if before[case][name] != after[case][name]}
        assert changed == ({path} if concerns(target) else set()), case
