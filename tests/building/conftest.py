"""Fixtures of all modules of this folder."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.building import colcon
from wsgen.isolation import system

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.fixture(scope="module", autouse=True)
def forked_colcon() -> Iterator[None]:
    """Have this process fork colcon where it builds, which saves starting it."""
    with pytest.MonkeyPatch.context() as patched:
        if system.has_guards():
            from building.forked_colcon import SUBPROCESS  # noqa: PLC0415  only on Linux

            patched.setattr(colcon, "subprocess", SUBPROCESS)
        yield
