"""What tests need that not every machine has."""

from __future__ import annotations

import os

import pytest

from wsgen.ros.environment.environment import why_no_ros

_why = why_no_ros(os.environ)
needs_ros = pytest.mark.skipif(
    _why is not None, reason="" if _why is None else f"needs ROS: {_why.message} {_why.hint}"
)
