from pathlib import Path

import pytest

from wsgen.live.nodes.messages import SEPARATOR, definition_of

TEXTS = {
    "sensor_msgs/msg/LaserScan": "# a scan\nstd_msgs/Header header # of it\nfloat32[] ranges\n",
    "std_msgs/msg/Header": "builtin_interfaces/Time stamp\nstring frame_id\n",
    "builtin_interfaces/msg/Time": "int32 sec\nuint32 nanosec\n",
    "demo/msg/Many": (
        "int8 A=1\nstring<=10 name\nOne[<=3] some\nOne[2] two\nsensor_msgs/LaserScan scan\n"
        "wstring text\nOne one\nint32[] numbers [1, 2]\n#Two no\n"
    ),
    "demo/msg/One": "std_msgs/Header header\nMany[0] never\n",
}


@pytest.fixture
def shares(tmp_path: Path) -> Path:
    for name, text in TEXTS.items():
        file = tmp_path / f"{name}.msg"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
    return tmp_path


def parts(text: str) -> list[str]:
    return [part.split("\n", 1)[0] for part in text.split(SEPARATOR + "\n")]


def test_each_message_comes_once_with_those_in_it(shares: Path) -> None:
    text = definition_of("sensor_msgs/msg/LaserScan", lambda name: shares / name)
    assert parts(text) == ["# a scan", "MSG: std_msgs/Header", "MSG: builtin_interfaces/Time"]
    assert text.startswith(TEXTS["sensor_msgs/msg/LaserScan"])
    assert text.endswith(f"MSG: builtin_interfaces/Time\n{TEXTS['builtin_interfaces/msg/Time']}")


def test_names_without_a_package_bounds_and_cycles(shares: Path) -> None:
    text = definition_of("demo/msg/Many", lambda name: shares / name)
    assert set(parts(text)[1:]) == {
        "MSG: demo/One",
        "MSG: sensor_msgs/LaserScan",
        "MSG: std_msgs/Header",
        "MSG: builtin_interfaces/Time",
    }
    assert len(parts(text)) == 5


def test_a_message_that_is_not_installed(shares: Path) -> None:
    with pytest.raises(OSError, match="Missing"):
        definition_of("demo/msg/Missing", lambda name: shares / name)


def test_the_feedback_of_an_action_is_made_of_its_file(shares: Path) -> None:
    folder = shares / "demo" / "action"
    folder.mkdir()
    (folder / "Go.action").write_text("One goal\n---\nbool well\n---\n# how far\nMany[] seen\n")
    ids = shares / "unique_identifier_msgs" / "msg"
    ids.mkdir(parents=True)
    (ids / "UUID.msg").write_text("uint8[16] uuid\n")
    text = definition_of("demo/action/Go_FeedbackMessage", lambda name: shares / name)
    first, *others = text.split(SEPARATOR + "\n")
    assert first == "unique_identifier_msgs/UUID goal_id\ndemo/Go_Feedback feedback\n\n"
    assert "MSG: demo/Go_Feedback\n# how far\nMany[] seen\n\n" in others
    assert {"MSG: unique_identifier_msgs/UUID", "MSG: demo/Many"} <= set(parts(text))
    assert "well" not in text


def test_a_message_may_be_called_like_feedback(shares: Path) -> None:
    (shares / "demo" / "msg" / "My_Feedback.msg").write_text("bool well\n")
    assert definition_of("demo/msg/My_Feedback", lambda name: shares / name) == "bool well\n"
