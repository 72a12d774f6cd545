"""Models of SDF files on their way into a scene."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from wsgen.isolation import parent
from wsgen.pipeline.prepare import MOST_MODELS, PrepareContext, prepare_models, read_file

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.isolation.result import Answered, Died


EGG = (
    '<collision name="c"><geometry><ellipsoid><radii>0.1 0.2 0.3</radii></ellipsoid></geometry>'
    "</collision>"
)


class Counting:
    """Runs child processes, and counts them."""

    def __init__(self) -> None:
        self.tasks: list[str] = []

    def __call__(self, task: str, *arguments: Any, **options: Any) -> Answered | Died:
        self.tasks.append(task)
        return parent.run(task, *arguments, **options)


def world_of(folder: Path, count: int, shape: str) -> Path:
    models = "".join(
        f'<model name="m{number}"><static>true</static><link name="l">{shape}</link></model>'
        for number in range(count)
    )
    file = folder / "many.world"
    file.write_text(f'<sdf version="1.9"><world name="w">{models}</world></sdf>')
    return file


@pytest.mark.slow
def test_the_models_of_a_file_share_a_child_process(tmp_path: Path) -> None:
    pytest.importorskip("numpy")
    counting = Counting()
    context = PrepareContext(share_of=lambda _: None, folder=tmp_path, run=counting)
    found = read_file(world_of(tmp_path, 5, EGG), context, {})
    prepared, diagnostics = prepare_models(found, context)
    assert diagnostics == ()
    assert len(counting.tasks) == 1
    assert [model.entity for model in prepared] == ["m0", "m1", "m2", "m3", "m4"]
    assert [link.name for model in prepared for link in model.lumped.links] == ["l"] * 5
    assert all(model.lumped.links[0].collisions[0].geometry.path for model in prepared)  # type: ignore[union-attr]


@pytest.mark.slow
def test_too_many_models_are_refused_before_anything_is_made_of_them(tmp_path: Path) -> None:
    counting = Counting()
    context = PrepareContext(share_of=lambda _: None, folder=tmp_path, run=counting)
    found = read_file(world_of(tmp_path, MOST_MODELS + 1, EGG), context, {})
    prepared, (problem,) = prepare_models(found, context)
    assert (prepared, counting.tasks) == ([], [])
    assert (problem.code, problem.file) == ("SPN035", tmp_path / "many.world")


def test_a_model_has_what_was_reported_of_it(tmp_path: Path) -> None:
    def model(name: str, tag: str) -> str:
        return f'<model name="{name}"><link name="l"><{tag}><mass>1</mass></{tag}></link></model>'

    context = PrepareContext(share_of=lambda _: None, folder=tmp_path, run=parent.run)
    file = tmp_path / "two.world"
    two = model("right", "inertial") + model("wrong", "inertal")
    for text, expected in (
        (f'<sdf version="1.9"><world name="w">{two}</world></sdf>', [[], ["ROB038"]]),
        (f'<sdf version="1.9">{model("wrong", "inertal")}</sdf>', [["ROB038"]]),
    ):
        file.write_text(text)
        prepared, _ = prepare_models(read_file(file, context, {}), context)
        assert [[one.code for one in model.diagnostics] for model in prepared] == expected
