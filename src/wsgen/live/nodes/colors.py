"""Colors of what tools of ROS print into the logs of their nodes."""

from __future__ import annotations

import os
import sys

_COLORS = {"blue": 94, "cyan": 96, "green": 92, "yellow": 93, "red": 91, "bold": 1}


def colored(text: str, *names: str) -> str:
    """The text in colors, where ROS's own tools would color it."""
    wanted = os.environ.get("RCUTILS_COLORIZED_OUTPUT")
    if wanted == "0" or (wanted != "1" and not sys.stdout.isatty()):
        return text
    return "".join(f"\033[{_COLORS[name]}m" for name in names) + text + "\033[0m"
