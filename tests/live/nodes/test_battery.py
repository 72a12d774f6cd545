"""The battery of Gazebo Sim."""

from __future__ import annotations

import importlib
from typing import Any

import pytest

from live.nodes.fake_ros import FakeRos, live_scene, plugin, simulation_of
from live.nodes.gz_bridge import bridged
from live.nodes.sensor_messages import install_sensor_messages

NAME = "gz-sim-linearbatteryplugin-system"
CELL = (
    "<battery_name>b</battery_name><voltage>12.6</voltage><capacity>2</capacity>"
    "<open_circuit_voltage_constant_coef>12.6</open_circuit_voltage_constant_coef>"
    "<open_circuit_voltage_linear_coef>-3</open_circuit_voltage_linear_coef>"
    "<resistance>0.1</resistance><smooth_current_tau>0.5</smooth_current_tau>"
    "<power_load>25</power_load>"
)
FIXED = f"{CELL}<fix_issue_225>true</fix_issue_225>"
STATE = ("/b", "/model/rover/battery/b/state", "sensor_msgs/msg/BatteryState", "BatteryState")


@pytest.fixture(autouse=True)
def _messages(monkeypatch: pytest.MonkeyPatch) -> None:
    install_sensor_messages(monkeypatch)
    topics = importlib.import_module("wsgen.live.nodes.simulator.topics")
    monkeypatch.setattr(topics, "COUNT_EVERY", -1.0)


def carrying(content: str, *rules: Any) -> tuple[Any, FakeRos]:
    simulation, ros = simulation_of(live_scene(plugin(NAME, content), simulator="gz"))
    simulation.spawn("rover")
    bridged(ros, simulation, STATE, *rules)
    return simulation, ros


def counted(steps: int, *, is_fixed: bool) -> tuple[float, float, float]:
    """Voltage, charge and share, by LinearBatteryPlugin.cc, in steps of 1 ms."""
    voltage, current, charge, share = 12.6, 0.0, 2.0, 1.0
    currents: list[float] = []
    for _ in range(steps):
        current += 0.001 / 0.5 * (25 / voltage - current)
        charge -= 0.001 * current / 3600
        voltage = 12.6 - 3 * (1 - charge / 2) - 0.1 * current
        currents = [*currents[-99:], current]
        share = charge / 2 if is_fixed else share - sum(currents) * 0.001 / 3600 / 2
    return voltage, charge, share


@pytest.mark.parametrize("is_fixed", [False, True])
def test_it_drains_as_gazebos_does(is_fixed: bool) -> None:
    content = FIXED if is_fixed else CELL
    simulation, ros = carrying(f"{content}<start_draining>true</start_draining>")
    simulation.advance(2.001)
    found = ros.published("/b")
    assert len(found) == 101  # 50 Hz
    message = found[-1]
    voltage, charge, share = counted(2000, is_fixed=is_fixed)
    assert (message.voltage, message.charge) == pytest.approx((voltage, charge), rel=1e-9)
    assert message.percentage == pytest.approx(share * (100 if is_fixed else 1), rel=1e-9)
    assert message.current == pytest.approx(25 / 12.4, rel=0.05)
    assert (message.capacity, message.power_supply_status) == (2.0, 2)
    simulation.reset(with_time=True)
    simulation.advance(0.001)
    assert ros.published("/b")[-1].charge == 2.0


def test_it_drains_when_a_joint_is_driven() -> None:
    simulation, ros = carrying(f"{FIXED}<invert_current_sign>true</invert_current_sign>")
    simulation.advance(0.5)
    message = ros.published("/b")[-1]
    assert (message.current, message.charge, message.power_supply_status) == (0.0, 2.0, 4)
    from wsgen.simulation.engine import Motor  # noqa: PLC0415

    robot = simulation.host.robots["rover"]
    robot.drive({"left": Motor(0.0, 1.0)})
    simulation.advance(1.0)
    assert ros.published("/b")[-1].charge == 2.0  # a motor that stands still
    robot.drive({"left": Motor(1.0, 1.0)})
    simulation.advance(1.5)
    message = ros.published("/b")[-1]
    assert message.current < -1.0
    assert message.charge < 2.0
    robot.drive({"left": Motor(0.0, 1.0)})
    simulation.advance(2.0)
    assert ros.published("/b")[-1].charge < message.charge - 1e-4  # for ever, once it has begun


def test_it_is_charged_by_topics() -> None:
    from std_msgs.msg import Bool  # noqa: PLC0415  a fake

    content = (
        f"{FIXED}<initial_charge>1</initial_charge><enable_recharge>true</enable_recharge>"
        "<charging_time>0.5</charging_time><recharge_by_topic>true</recharge_by_topic>"
    )
    rules = [
        (f"/{word}", f"/model/rover/battery/b/recharge/{word}", "std_msgs/msg/Bool", "Boolean")
        for word in ("start", "stop")
    ]
    simulation, ros = carrying(content, *rules)
    simulation.advance(0.1)
    assert ros.published("/b")[-1].power_supply_status == 3
    ros.send("/start", Bool(data=True))
    simulation.advance(3.1)
    message = ros.published("/b")[-1]
    assert message.power_supply_status == 1
    assert message.current == pytest.approx(-4.0, rel=0.01)  # 2 A h in half an hour
    assert message.charge == pytest.approx(1 + 4 * 2.5 / 3600, rel=1e-4)
    ros.send("/stop", Bool(data=True))
    simulation.advance(3.2)
    assert ros.published("/b")[-1].power_supply_status == 3


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ("<battery_name>b</battery_name>", "no <voltage>"),
        (CELL.replace("<capacity>2", "<capacity>0"), "its <capacity> is 0"),
        (f"{CELL}<enable_recharge>true</enable_recharge>", "no <charging_time>"),
        (f"{CELL}<power_draining_topic>/d</power_draining_topic>", "the <power_draining_topic>"),
        (
            f"{CELL}<stop_power_draining_topic>/d</stop_power_draining_topic>",
            "the <stop_power_draining_topic>",
        ),
    ],
)
def test_what_it_cannot_do(content: str, problem: str) -> None:
    _, ros = carrying(content)
    assert problem in ros.warnings[0]
