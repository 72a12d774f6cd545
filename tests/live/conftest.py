from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from live_launch import Launch

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path


@pytest.fixture
def launch(tmp_path: Path) -> Iterator[Callable[..., Launch]]:
    """Start the body of a `generate_launch_description`."""
    started: list[Launch] = []

    def start(text: str, **options: Any) -> Launch:
        folder = tmp_path / str(len(started))
        folder.mkdir()
        started.append(Launch(text, folder, **options))
        return started[-1]

    yield start
    for one in started:
        if one.process.poll() is None:
            one.process.kill()
            one.process.wait()
