import pytest

from wsgen.errors import RequestError
from wsgen.model.target import DEFAULT_TARGET, TARGETS, Target, choose_target


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_every_target_can_be_chosen(target: Target) -> None:
    assert choose_target(target.distro, target.simulator) is target


def test_iron_means_classic() -> None:
    assert choose_target("iron") is DEFAULT_TARGET
    assert DEFAULT_TARGET.name == "iron-classic"


@pytest.mark.parametrize(
    ("distro", "simulator", "reason"),
    [
        ("jazzy", "classic", "Gazebo Classic is not released for ROS 2 jazzy"),
        ("jazzy", None, "ROS 2 jazzy with Gazebo Sim yet"),
        ("humble", "classic", "ROS 2 humble with Gazebo Classic yet"),
        ("iron", "gz", "ROS 2 iron with Gazebo Sim yet"),
        ("noetic", None, "'noetic' is no ROS 2 distribution"),
        ("", "classic", "'' is no ROS 2 distribution"),
    ],
)
def test_no_such_target(distro: str, simulator: str | None, reason: str) -> None:
    with pytest.raises(RequestError, match=reason) as caught:
        choose_target(distro, simulator)
    assert "--distro iron --sim classic" in caught.value.hint
