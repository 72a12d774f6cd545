"""The states of the templates that are kept: those of now, each whole, and each can be rendered."""

import re
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from template_history import LEFT_OUT, add_states, folders_now, listing, state
from wsgen.errors import NotFoundError
from wsgen.model.target import TARGETS, Target, choose_target
from wsgen.templating.history import (
    ARCHIVE,
    FILES_FOLDER,
    STATES_FOLDER,
    past_target,
    unpack,
)
from wsgen.templating.render import render_package
from wsgen.templating.sources import templates_folder, templates_of
from wsgen.templating.spec import make_maintainer, make_spec
from wsgen.templating.states import FACTS, STATES_FILE, made_of
from wsgen.templating.template import load_template, template_names

REGENERATE = "pytest --regenerate tests/templating/test_history.py"


def kept_states() -> list[str]:
    with zipfile.ZipFile(ARCHIVE) as archive:
        return sorted(
            name.removeprefix(STATES_FOLDER)
            for name in archive.namelist()
            if name.startswith(STATES_FOLDER)
        )


def test_the_states_of_now_are_kept() -> None:
    """--regenerate has written them before (tests/conftest.py)."""
    now = sorted(state(name, files) for name, files in folders_now().items())
    assert STATES_FILE.read_text().split() == now, REGENERATE
    assert set(now) <= set(kept_states()), REGENERATE


def test_the_archive_has_each_file_of_each_state() -> None:
    with zipfile.ZipFile(ARCHIVE) as archive:
        names = archive.namelist()
        assert len(names) == len(set(names))
        assert archive.testzip() is None
        for one in kept_states():
            lines = archive.read(f"{STATES_FOLDER}{one}").decode().splitlines()
            files = {
                line.split(" ", 1)[1]: archive.read(f"{FILES_FOLDER}{line.split()[0]}")
                for line in lines
            }
            assert state(one.rpartition("-")[0], files) == one


def test_a_state_is_added_once_and_others_stay() -> None:
    files = {"a.j2": b"one\n", "b.j2": b"two\n"}
    first = add_states(b"", {"arm": files})
    assert add_states(first, {"arm": files}) == first
    second = add_states(first, {"arm": files | {"b.j2": b"three\n"}, "base": {"c.j2": b"one\n"}})
    assert second.startswith(first[:100])
    assert listing(files) != listing({"a.j2": b"one\n"})


@pytest.mark.parametrize("name", template_names())
def test_a_template_names_no_sources_but_those_of_its_states(name: str) -> None:
    template = load_template(name)
    recorded = {one.rpartition("-")[0] for one in made_of(template)["state"].split()}
    assert recorded == {*template.shipped, FACTS}
    for folder in template.shipped:
        for file in (templates_folder() / folder).rglob("*.*"):
            named = re.findall(r"wsgen:(\w+)/", file.read_text(encoding="utf-8"))
            assert set(named) <= recorded, file


def test_what_cannot_be_updated_has_no_state() -> None:
    assert made_of(load_template("existing", may_be_abstract=True)) == {}
    assert "existing" in LEFT_OUT


@pytest.mark.parametrize("name", template_names())
def test_the_states_of_now_render_what_the_templates_do(name: str, tmp_path: Path) -> None:
    target = choose_target("jazzy", "gz")
    tree = rendered(name, target)
    unpack(made_of(load_template(name))["state"], tmp_path)
    assert rendered(name, past_target(target, tmp_path), tmp_path) == tree


def rendered(name: str, target: Target, past: Path | None = None) -> dict[str, str]:
    with templates_of(past):
        template = load_template(name)
        spec = make_spec(
            "my_robot",
            template=template,
            target=target if past is None else choose_target(target.distro, target.simulator),
            maintainer=make_maintainer("Ada", "ada@example.com"),
            license_name="MIT",
        )
        return render_package(spec, template, {"made_of": {}})


@pytest.mark.slow
def test_every_state_can_be_rendered(tmp_path: Path) -> None:
    """A filter or a name that goes would keep packages from being updated."""
    for number, states in enumerate(moments()):
        past = tmp_path / str(number)
        unpack(" ".join(states.values()), past)
        for name in template_names():
            if name in states:
                assert rendered(name, choose_target("jazzy", "gz"), past)


def moments() -> Iterator[dict[str, str]]:
    """The states at one time each; what was added at once is in alphabetical order."""
    with zipfile.ZipFile(ARCHIVE) as archive:
        names = [one for one in archive.namelist() if one.startswith(STATES_FOLDER)]
    states: dict[str, str] = {}
    before = ""
    for one in (name.removeprefix(STATES_FOLDER) for name in names):
        folder = one.rpartition("-")[0]
        if folder <= before:
            yield dict(states)
        states[folder] = one
        before = folder
    yield states


def test_facts_are_those_of_then(tmp_path: Path) -> None:
    for target in TARGETS:
        assert past_target(target, tmp_path) == target  # none are kept
    facts = folders_now()[FACTS]["targets.json"].replace(b"gz_frame_id", b"old_frame_id")
    (tmp_path / FACTS).mkdir()
    (tmp_path / FACTS / "targets.json").write_bytes(facts)
    target = choose_target("jazzy", "gz")
    past = past_target(target, tmp_path)
    assert past.frame_tag == "old_frame_id"
    assert past.plugins == target.plugins
    assert past.programs == target.programs
    assert (past.ros, past.fact("python")) == (target.ros, target.fact("python"))


def test_an_unknown_state_says_so(tmp_path: Path) -> None:
    with pytest.raises(NotFoundError, match="`arm-00000000`"):
        unpack("arm-00000000", tmp_path)
    with pytest.raises(NotFoundError):
        unpack("../../arm", tmp_path)
    assert not list(tmp_path.iterdir())
