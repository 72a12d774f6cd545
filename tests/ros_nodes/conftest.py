"""ROS without ROS, for what the simulator's plugins do."""

from __future__ import annotations

import pytest

from ros_nodes.fake_ros import install_messages


@pytest.fixture
def messages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Messages that know their fields; what imports them is imported anew."""
    install_messages(monkeypatch)
