"""ROS without ROS, for what the simulator's plugins do."""

from __future__ import annotations

import importlib

import pytest

from ros_nodes.fake_ros import install_messages


@pytest.fixture
def messages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Messages that know their fields; what imports them is imported anew."""
    install_messages(monkeypatch)
    topics = importlib.import_module("wsgen.ros_nodes.simulator.topics")
    monkeypatch.setattr(topics, "COUNT_EVERY", -1.0)  # count subscriptions whenever they are asked
