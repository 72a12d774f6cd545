"""The functions that child processes call by name, and the classes that are imported by it."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

from wsgen.model.engines import ENGINES

SOURCE = Path(__file__).parents[2] / "src"
TASK = re.compile(r"wsgen\.\S+:\S+")


def task_names() -> list[str]:
    return sorted(
        {
            *(
                f"{spec.tasks}:{name}"
                for spec in ENGINES.values()
                for name in ("simulate", "serve")
            ),
            *(spec.engine for spec in ENGINES.values()),
            *(
                node.value
                for path in SOURCE.rglob("*.py")
                # Parsing all would be a third of the collection of all tests.
                if TASK.search(text := path.read_text(encoding="utf-8"))
                for node in ast.walk(ast.parse(text))
                if isinstance(node, ast.Constant)
                and isinstance(node.value, str)
                and TASK.fullmatch(node.value)
            ),
        }
    )


@pytest.mark.slow
def test_the_names_are_found() -> None:
    assert "wsgen.descriptions.meshes.worker:inspect" in task_names()
    assert "wsgen.pipeline.tasks.launch:evaluate_launch" in task_names()
    assert "wsgen.pipeline.tasks.dart:simulate" in task_names()


@pytest.mark.parametrize("name", task_names())
def test_a_task_is_a_function_or_class_of_its_module(name: str) -> None:
    """Read, not imported: the module may need a library that is not here."""
    module, _, function = name.partition(":")
    file = SOURCE.joinpath(*module.split(".")).with_suffix(".py")
    assert file.is_file(), f"{name}: no module {module}"
    tree = ast.parse(file.read_text(encoding="utf-8"))
    found = [node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)]
    assert function in found, f"{module} has no {function}"
