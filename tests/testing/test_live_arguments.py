"""What `live` and its runs refuse before anything happens, without ROS."""

from __future__ import annotations

import math
import sys
from contextlib import contextmanager
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

import pytest

from wsgen.errors import RequestError, SessionDiedError
from wsgen.live.nodes.messages import WrongFieldError, fill
from wsgen.testing import live as live_module
from wsgen.testing.live import Live

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from contextlib import AbstractContextManager

    from wsgen.live.session import LiveSession


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"engine": "boolet"}, "'boolet' is not a physics engine.\nUse bullet, dart, mujoco."),
        ({"engine": 3}, 'live() has engine=3.\nGive a name: engine="NAME".'),
        ({"package": 3}, 'live() has package=3.\nGive a name: package="NAME".'),
        ({"arguments": ["z:=1"]}, "live() has arguments=['z:=1'].\nGive names and values: "),
        ({"rate": 0}, "live() has rate=0.\nGive simulated seconds a second, above 0; "),
        ({"rate": -1.0}, "live() has rate=-1.0.\n"),
        ({"rate": math.inf}, "live() has rate=inf.\n"),
        ({"rate": "fast"}, "live() has rate='fast'.\n"),
        ({"may_fail": "driver"}, "live() has may_fail='driver'.\nGive a list of names: "),
        ({"may_fail": [3]}, "live() has may_fail=[3].\n"),
    ],
)
def test_what_no_run_can_have_is_refused(
    live: Callable[..., object], given: dict[str, object], said: str
) -> None:
    with pytest.raises(pytest.fail.Exception) as caught:
        live(**given)
    assert str(caught.value).startswith(f"wsgen: {said}")


def test_an_argument_without_effect_is_warned_of(
    live: Callable[..., AbstractContextManager[object]], monkeypatch: pytest.MonkeyPatch
) -> None:
    @contextmanager
    def run_live(*, opened: Callable[[object], None], **_: object) -> Iterator[object]:
        opened(SimpleNamespace(unused_arguments=("`wrold` has no effect.",), report=str))
        yield None

    monkeypatch.setattr(live_module, "run_live", run_live)
    run = live(arguments={"wrold": "b.sdf"})
    with pytest.warns(pytest.PytestWarning, match="`wrold` has no effect"), run:
        pass


class Messenger:
    """Stands for the process with rclpy: it answers no call."""

    def __init__(self) -> None:
        self.asked: list[Mapping[str, object]] = []

    def ask(self, do: str, **values: object) -> dict[str, Any]:
        self.asked.append({"do": do, **values})
        return {}

    send = ask

    def answer(self, *_: object) -> None:
        return None


@pytest.fixture
def messenger() -> Messenger:
    """The messenger of a run."""
    return Messenger()


@pytest.fixture
def ros(messenger: Messenger) -> Live:
    """A run whose time passes, and that has nothing."""
    session = SimpleNamespace(
        messenger=messenger,
        state=SimpleNamespace(seconds=0.0, poses={}),
        advance=lambda seconds: seconds,
    )
    return Live(cast("LiveSession", session))


@pytest.mark.parametrize("seconds", [math.nan, math.inf, -1.0, "5", True])
def test_a_call_is_not_waited_for_without_end(
    ros: Live, messenger: Messenger, seconds: float
) -> None:
    with pytest.raises(RequestError, match="is not a time in seconds"):
        ros.call("/reset", "std_srvs/srv/Empty", seconds=seconds)
    assert not messenger.asked


def test_a_call_ends_by_the_clock(ros: Live, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_module, "SECONDS_TO_ANSWER", 0.05)
    with pytest.raises(SessionDiedError, match=r"Nothing was heard of /reset for 0\.05 s"):
        ros.call("/reset", "std_srvs/srv/Empty", seconds=0.0)


def test_a_topic_is_the_same_with_and_without_its_slash(ros: Live, messenger: Messenger) -> None:
    for topic in ("cmd_vel", "/cmd_vel"):
        ros.publish(topic, "geometry_msgs/msg/Twist", rate=5.0)
    assert [one["topic"] for one in messenger.asked] == ["/cmd_vel", "/cmd_vel"]
    for rate in (0.0, math.nan, "5"):
        with pytest.raises(RequestError, match="is not a number above 0"):
            ros.publish("cmd_vel", "geometry_msgs/msg/Twist", rate=cast("float", rate))


# Fields of messages; these stand for those of ROS.


class Vector3:
    """As rosidl makes it: it has a type for each field."""

    def __init__(self) -> None:
        self.x = self.y = 0.0

    @staticmethod
    def get_fields_and_field_types() -> dict[str, str]:
        return {"x": "double", "y": "double"}


class Twist:
    """As rosidl makes it."""

    def __init__(self) -> None:
        self.linear, self.angular = Vector3(), Vector3()

    @staticmethod
    def get_fields_and_field_types() -> dict[str, str]:
        return dict.fromkeys(("linear", "angular"), "geometry_msgs/Vector3")


class Polygon:
    """With a list of messages."""

    SLOT_TYPES = (
        SimpleNamespace(
            value_type=SimpleNamespace(namespaces=["geometry_msgs", "msg"], name="Vector3")
        ),
    )

    def __init__(self) -> None:
        self.points: list[Vector3] = []

    @staticmethod
    def get_fields_and_field_types() -> dict[str, str]:
        return {"points": "sequence<geometry_msgs/Vector3>"}


def set_fields(message: Any, values: Mapping[str, Any]) -> str:
    """As rosidl_runtime_py does it."""
    for name, value in values.items():
        field = getattr(message, name)
        if isinstance(field, list):
            field[:] = [Vector3() for _ in value]
            for one, its_values in zip(field, value, strict=True):
                set_fields(one, its_values)
        elif isinstance(field, Vector3):
            set_fields(field, value)
        else:
            setattr(message, name, float(value))
    return "set"


def test_fields_are_set() -> None:
    twist = Twist()
    values = {"linear": {"x": 0.5}, "angular": {"y": 1}}
    assert fill(twist, values, set_fields, "geometry_msgs/msg/Twist") == "set"
    assert (twist.linear.x, twist.angular.y) == (0.5, 1.0)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (
            {"linea": {"x": 0.5}},
            (
                "geometry_msgs/msg/Twist has no field `linea`.\n"
                "Did you mean `linear`? Fields of geometry_msgs/msg/Twist: linear, angular."
            ),
        ),
        (
            {"linear": {"z": 0.5}},
            (
                "`linear` of geometry_msgs/msg/Twist has no field `z`.\n"
                "Fields of geometry_msgs/Vector3: x, y."
            ),
        ),
        (
            {"linear": {"x:0.5": None}},
            (
                "`linear` of geometry_msgs/msg/Twist has no field `x:0.5`.\n"
                "Write `x: 0.5`, with a blank. Fields of geometry_msgs/Vector3: x, y."
            ),
        ),
        (
            {"angular": {}, "linear": {"x": 0.5, "y": "fast"}},
            (
                "The field `linear.y` of geometry_msgs/msg/Twist does not take 'fast'.\n"
                "Its type is `double`: could not convert string to float: 'fast'."
            ),
        ),
        (
            {1: 0.5},
            "geometry_msgs/msg/Twist has no field `1`.\nFields of geometry_msgs/msg/Twist: linear",
        ),
        (
            {"linear": 0.5},
            (
                "The field `linear` of geometry_msgs/msg/Twist does not take 0.5.\n"
                "Its type is `geometry_msgs/Vector3`: "
            ),
        ),
    ],
)
def test_the_field_that_takes_no_such_value_is_named(values: dict[Any, Any], said: str) -> None:
    with pytest.raises(WrongFieldError) as caught:
        fill(Twist(), values, set_fields, "geometry_msgs/msg/Twist")
    assert str(caught.value).startswith(said)


@pytest.mark.parametrize(
    ("point", "said"),
    [
        (
            {"xx": 1.0},
            (
                "`points[1]` of geometry_msgs/msg/Polygon has no field `xx`.\n"
                "Did you mean `x`? Fields of geometry_msgs/Vector3: x, y."
            ),
        ),
        (
            {"x": "far"},
            (
                "The field `points[1].x` of geometry_msgs/msg/Polygon does not take 'far'.\n"
                "Its type is `double`: could not convert string to float: 'far'."
            ),
        ),
    ],
)
def test_fields_of_messages_in_lists_are_named(
    point: dict[str, Any], said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "geometry_msgs", SimpleNamespace())
    monkeypatch.setitem(sys.modules, "geometry_msgs.msg", SimpleNamespace(Vector3=Vector3))
    with pytest.raises(WrongFieldError) as caught:
        fill(Polygon(), {"points": [{"x": 1.0}, point]}, set_fields, "geometry_msgs/msg/Polygon")
    assert str(caught.value) == said
