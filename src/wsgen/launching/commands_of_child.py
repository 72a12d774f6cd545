"""The commands of the child that evaluates many launch files (`plain_child`)."""

from __future__ import annotations

EVALUATE, EXPAND = "evaluate", "expand"  # the commands
