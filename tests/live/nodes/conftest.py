"""ROS without ROS, for what the simulator's plugins do."""

from __future__ import annotations

import importlib
import signal
from typing import TYPE_CHECKING

import pytest

from live.nodes.fake_ros import install_messages

if TYPE_CHECKING:
    from collections.abc import Iterator


@pytest.fixture
def messages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Messages that know their fields; what imports them is imported anew."""
    install_messages(monkeypatch)
    topics = importlib.import_module("wsgen.live.nodes.simulator.topics")
    monkeypatch.setattr(topics, "COUNT_EVERY", -1.0)  # count subscriptions whenever they are asked


@pytest.fixture(autouse=True)
def _signals() -> Iterator[None]:
    """Programs that a test calls leave the signals of this process as they end: ignored."""
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = [signal.getsignal(number) for number in numbers]
    yield
    for number, handler in zip(numbers, before, strict=True):
        signal.signal(number, handler)
