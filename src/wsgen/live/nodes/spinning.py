"""What the programs of this package have in common: how they start, are spun, and end."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterUninitializedException,
)
from rclpy.executors import ExternalShutdownException
from rclpy.logging import get_logger

if TYPE_CHECKING:
    from collections.abc import Callable


HEARTBEAT_SECONDS = 1.0


class FatalError(Exception):
    """A node cannot start; the message is for its log."""


def run(name: str, make_node: Callable[[], Any], arguments: list[str] | None = None) -> int:
    """Make a node and spin it until a signal ends it; returns the exit code of the process.

    `name` is that of the log, where the node cannot be made. `arguments` are those of the process,
    its path first.
    """
    try:
        rclpy.init(args=sys.argv if arguments is None else arguments)
        node = make_node()
        # A signal that comes at a bad moment does not wake who waits without end.
        node.create_timer(
            HEARTBEAT_SECONDS, _nothing, clock=Clock(clock_type=ClockType.STEADY_TIME)
        )
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        return 0
    except (
        FatalError,
        InvalidParameterTypeException,
        InvalidParameterValueException,
        ParameterUninitializedException,
    ) as error:
        get_logger(name).fatal(str(error))
        return 1
    except Exception:
        if rclpy.ok():
            raise
        return 0  # a signal has ended ROS while the node was made: whatever it wanted of it fails
    finally:
        rclpy.try_shutdown()
    return 0


def leave_clock(node: Any) -> None:
    """Take no more messages of /clock, for a node that does not ask for the time.

    Gazebo Sim sends a thousand a second, each of which costs a node in Python 0.3 ms.
    """
    node._time_source.detach_node()  # noqa: SLF001  rclpy has no other way


def _nothing() -> None:
    """A timer's callback."""
