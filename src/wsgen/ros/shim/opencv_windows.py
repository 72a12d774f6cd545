"""OpenCV as it is installed; without a screen its windows do nothing, instead of ending the node.

Every third node that looks at pictures shows them with `imshow`. OpenCV without windows
(`opencv-python-headless`) raises an exception there, and the one with windows ends the process
where it finds no display. A node of a live run works on without them, and its log says so once.

What Python executes at its start (`ros/start`) gives the package to `put_in` when a node has
imported it. So it is there, or not, as without wsgen.
"""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import ModuleType

DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
NOT_BUILT = "not implemented"  # in what OpenCV without windows raises
NO_KEY = -1
# What functions of windows give where there is none; the rest is in `_Windows`.
ANSWERS = {
    "destroyAllWindows": None,
    "destroyWindow": None,
    "displayOverlay": None,
    "displayStatusBar": None,
    "getWindowImageRect": (0, 0, 0, 0),
    "getWindowProperty": 1.0,  # nodes end when a window is not visible
    "imshow": None,
    "moveWindow": None,
    "namedWindow": None,
    "resizeWindow": None,
    "setMouseCallback": None,
    "setTrackbarMax": None,
    "setTrackbarMin": None,
    "setWindowProperty": None,
    "setWindowTitle": None,
    "startWindowThread": 0,
}


class _Windows:
    """The functions of windows: OpenCV's own, until they turn out not to work."""

    def __init__(self, real: ModuleType) -> None:
        self._real = real
        self._are_there = True
        self._sliders: dict[tuple[str, str], int] = {}
        if not any(os.environ.get(name) for name in DISPLAYS):
            # Said when a window is wanted: most nodes want none.
            self._missing = f"neither {DISPLAYS[0]} nor {DISPLAYS[1]} is set"
        else:
            self._missing = ""

    def put_in(self) -> None:
        """Take the place of OpenCV's functions."""
        without: dict[str, Callable[..., Any]] = {
            name: (lambda *_args, _answer=answer, **_named: _answer)
            for name, answer in ANSWERS.items()
        }
        without |= {
            "createTrackbar": self._create_trackbar,
            "getTrackbarPos": self._trackbar,
            "setTrackbarPos": self._set_trackbar,
            "waitKey": self._wait,
            "waitKeyEx": self._wait,
            "pollKey": lambda: NO_KEY,
        }
        for name, replacement in without.items():
            function = getattr(self._real, name, None)
            if function is not None:
                setattr(self._real, name, self._either(function, replacement))

    def _either(self, function: Callable[..., Any], without: Callable[..., Any]) -> Any:
        def call(*args: Any, **named: Any) -> Any:
            if self._are_there and not self._missing:
                try:
                    return function(*args, **named)
                except self._real.error as error:
                    if NOT_BUILT not in str(error):
                        raise
                    self._missing = "this OpenCV was built without windows"
            if self._are_there:
                self._are_there = False
                program = Path(sys.argv[0]).name
                sys.stderr.write(
                    f"[WARN] [{program}]: OpenCV shows no windows: {self._missing}. On a machine "
                    "with a screen, install 'opencv-python<5' instead of opencv-python-headless\n"
                )
                sys.stderr.flush()
            return without(*args, **named)

        call.__name__ = call.__qualname__ = function.__name__
        call.__doc__ = function.__doc__
        return call

    @staticmethod
    def _wait(delay: int = 0) -> int:
        # Without an end nobody could press the key; with one, it sets the pace of a loop.
        time.sleep(max(delay, 0) / 1000)
        return NO_KEY

    def _create_trackbar(
        self,
        trackbarName: str,  # noqa: N803  as OpenCV has it
        windowName: str,  # noqa: N803
        value: int = 0,
        count: int = 0,
        onChange: Any = None,  # noqa: N803
    ) -> None:
        self._sliders[trackbarName, windowName] = min(value, count)

    def _trackbar(self, trackbarname: str, winname: str) -> int:
        return self._sliders.get((trackbarname, winname), NO_KEY)

    def _set_trackbar(self, trackbarname: str, winname: str, pos: int) -> None:
        self._sliders[trackbarname, winname] = pos


def put_in(opencv: ModuleType) -> None:
    """Have the functions of windows do nothing where there are none."""
    _Windows(opencv).put_in()
