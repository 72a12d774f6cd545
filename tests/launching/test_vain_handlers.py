"""Event handlers that wait for what never happens."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.diagnostics import Severity
from wsgen.launching.launch_warnings import VAIN_HANDLER

if TYPE_CHECKING:
    from install_space import InstallSpace

pytestmark = pytest.mark.slow

PUBLISHER = "publisher = Node(package='robot_state_publisher', executable='robot_state_publisher')"
SPAWNER = "spawn = Node(package='ros_gz_sim', executable='create')"
RVIZ = "rviz = Node(package='rviz2', executable='rviz2')"
OTHER = "other = Node(package='my_robot', executable='other')"
CLEAN_UP = "clean_up = ExecuteProcess(cmd=['ip', 'link', 'set', 'down', 'can0'])"
SIM = "sim = ExecuteProcess(cmd=['timeout', '9', 'gz', 'sim', '-s'])"
BEFORE = f"{PUBLISHER}\n{SPAWNER}\n{RVIZ}\n{OTHER}\n{CLEAN_UP}\n{SIM}"


def on(kind: str, target: str, then: str) -> str:
    """An event handler."""
    action = {"Exit": "on_exit", "Start": "on_start"}[kind]
    return f"RegisterEventHandler(OnProcess{kind}(target_action={target}, {action}={then}))"


ABSENT = "which is not in the LaunchDescription and never starts"
ENDLESS = "which does not end by itself"


@pytest.mark.parametrize(
    ("entities", "begins", "starts", "severity"),
    [
        (
            f"publisher, {on('Exit', 'spawn', '[other]')}",
            *(f"Exit` waits for `spawn`, {ABSENT}", "other", Severity.WARNING),
        ),
        (
            f"publisher, {on('Start', 'other', '[GroupAction([spawn])]')}",
            *(f"Start` waits for `other`, {ABSENT}", "create", Severity.ERROR),
        ),
        (
            f"publisher, {on('Exit', 'publisher', '[spawn]')}, {on('Exit', 'spawn', 'other')}",
            *(f"Exit` waits for the end of `robot_state_publisher`, {ENDLESS}", "create"),
            Severity.ERROR,
        ),
        (
            f"publisher, {on('Exit', 'publisher', 'lambda event, context: [other]')}",
            *(f"Exit` waits for the end of `robot_state_publisher`, {ENDLESS}", "other"),
            Severity.WARNING,
        ),
        (
            f"rviz, {on('Exit', 'rviz', '[spawn]')}",
            *(f"Exit` waits for the end of `rviz2`, {ENDLESS}", "create", Severity.ERROR),
        ),
        (
            "Node(package='ros_gz_bridge', executable='parameter_bridge', on_exit=[other])",
            *(f"Exit` waits for the end of `parameter_bridge`, {ENDLESS}", "other"),
            Severity.WARNING,
        ),
    ],
)
def test_what_never_starts_is_named(
    space: InstallSpace,
    entities: str,
    begins: str,
    starts: str,
    severity: Severity,
) -> None:
    plan = space.play(entities, before=BEFORE)
    (found,) = (one for one in plan.diagnostics if one.code == VAIN_HANDLER.code)
    assert found.message == f"`OnProcess{begins}: `{starts}` never starts."
    assert found.severity is severity
    assert found.line


@pytest.mark.parametrize(
    "entities",
    [
        f"spawn, {on('Exit', 'spawn', '[other]')}",
        f"{on('Exit', 'spawn', '[other]')}, {on('Start', 'publisher', '[spawn]')}, publisher",
        f"publisher, {on('Exit', 'publisher', '[EmitEvent(event=Shutdown_())]')}",
        f"rviz, {on('Exit', 'rviz', '[other]')}",
        f"publisher, {on('Exit', 'publisher', 'clean_up')}",
        "sim, " + on("Exit", "sim", "[spawn]"),
        # The handler is for the alternative that is not chosen.
        f"GroupAction([spawn], condition=IfCondition('false')), {on('Exit', 'spawn', '[other]')}",
        f"TimerAction(period=2.0, actions=[spawn]), {on('Exit', 'spawn', '[other]')}",
        f"OpaqueFunction(function=lambda c: [spawn]), {on('Exit', 'spawn', '[other]')}",
        "OpaqueFunction(function=lambda c: [spawn], condition=IfCondition('false')), "
        + on("Exit", "spawn", "[other]"),
        # What would start the one is in a handler for an alternative, too.
        "GroupAction([other], condition=IfCondition('false')), "
        + on("Exit", "other", "[spawn]")
        + ", "
        + on("Exit", "spawn", "[publisher]"),
        # It is started anew after a crash.
        f"publisher, {on('Exit', 'publisher', PUBLISHER.partition(' = ')[2])}",
    ],
)
def test_what_may_happen_is_not_reported(space: InstallSpace, entities: str) -> None:
    before = f"from launch.events import Shutdown as Shutdown_\n{BEFORE}"
    plan = space.play(entities, before=before)
    assert VAIN_HANDLER.code not in {one.code for one in plan.diagnostics}
