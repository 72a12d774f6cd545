"""Names that `wsgen topic` cannot use: a package that is not there, a topic that none can be."""

from __future__ import annotations

import importlib
import sys
import types
from typing import TYPE_CHECKING, Any

import pytest

from wsgen.ros.environment.processes import SHIM

if TYPE_CHECKING:
    from pathlib import Path


def graph_without_ros(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The module, with an rclpy that has an exception alone."""
    rclpy: Any = types.ModuleType("rclpy")
    rclpy.exceptions = types.SimpleNamespace(NameValidationException=NameError)
    monkeypatch.setitem(sys.modules, "rclpy", rclpy)
    monkeypatch.syspath_prepend(SHIM)
    module = "wsgen.live.nodes.graph"
    monkeypatch.delitem(sys.modules, module, raising=False)
    graph = importlib.import_module(module)
    monkeypatch.delitem(sys.modules, module)
    return graph


def test_a_name_that_no_topic_can_have(monkeypatch: pytest.MonkeyPatch) -> None:
    graph = graph_without_ros(monkeypatch)

    def refuse(_topic: str) -> None:
        raise RuntimeError("failed to resolve name: it must not be empty, at /project/src/x.c:73")

    with pytest.raises(graph.Refusal, match=r"^failed to resolve name: it must not be empty$"):
        graph.full_name(types.SimpleNamespace(resolve_topic_name=refuse), "")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("geometry_msg/msg/Twist", "Did you mean `geometry_msgs/msg/Twist`? If not, build it"),
        ("gemoetry_msgs/Twist", "Did you mean `geometry_msgs/msg/Twist`?"),
        ("geometry_msgs/msgs/Twist", "Did you mean `geometry_msgs/msg/Twist`?"),
        ("control_msg/msg/JointJog", "Did you mean `control_msgs/msg/JointJog`?"),  # to be built
        ("rover_msgs/msg/Goal", "The package `rover_msgs` is not built here: build it with"),
    ],
)
def test_the_hint_of_an_absent_package(
    name: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    index = tmp_path / "share" / "ament_index" / "resource_index" / "rosidl_interfaces"
    index.mkdir(parents=True)
    (index / "geometry_msgs").touch()
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"/not_there:{tmp_path}")
    graph = graph_without_ros(monkeypatch)
    with pytest.raises(graph.MissingMessages) as caught:
        graph.message_class(name)
    assert str(caught.value).startswith(f"The message type '{name}' is invalid\n")
    assert words in str(caught.value)
    assert caught.value.package == name.partition("/")[0]
