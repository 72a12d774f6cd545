"""The engines that all tests about engines are run with."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

import pytest

from wsgen.model.engines import ENGINES
from wsgen.simulation.run import missing_engines

if TYPE_CHECKING:
    from simulation.robots import NewEngine


CLASSES = {"bullet": "BulletEngine", "dart": "DartEngine", "mujoco": "MujocoEngine"}


@pytest.fixture(params=ENGINES)
def new_engine(request: pytest.FixtureRequest) -> NewEngine:
    """Makes an engine of a world; a test that takes this is run with every engine."""
    name: str = request.param
    if missing_engines([name]):
        pytest.skip(f"{ENGINES[name].title} is not installed")
    module = importlib.import_module(f"wsgen.simulation.{name}")
    made: NewEngine = getattr(module, CLASSES[name])
    return made
