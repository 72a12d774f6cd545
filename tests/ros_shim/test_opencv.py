"""Nodes that show pictures in windows, where there is no screen or no OpenCV with windows."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from wsgen.ros_environment.processes import SHIM

if TYPE_CHECKING:
    from pathlib import Path

OPENCV = """
class error(Exception):
    pass

def _function(name):
    def function(*args, **named):
        "What it does."
        if {is_built}:
            if args == ("bad",):
                raise error("bad window")
            print("real", name)
            return 7
        raise error("The function is not implemented. Rebuild the library")
    function.__name__ = name
    return function

for name in "imshow waitKey createTrackbar getTrackbarPos getWindowProperty cvtColor".split():
    globals()[name] = _function(name)
"""
NODE = """
import cv2
from cv2 import imshow
cv2.createTrackbar("hue", "tuner", 30, 179, print)
imshow("view", None)
hue = cv2.getTrackbarPos(winname="tuner", trackbarname="hue")
print(hue, cv2.waitKey(delay=1), cv2.getWindowProperty("view", 4))
print(imshow.__name__, imshow.__doc__, hasattr(cv2, "selectROI"), cv2.__file__)
"""


def run(
    folder: Path, text: str, *, is_built: bool, display: str, slowly: str = ""
) -> subprocess.CompletedProcess[str]:
    installed = folder / "installed"
    (installed / "cv2").mkdir(parents=True)
    opencv = OPENCV.replace("{is_built}", str(is_built))
    (installed / "cv2" / "__init__.py").write_text(f"{slowly}\n{opencv}")
    script = folder / "tuner"
    script.write_text(text)
    environment = {**os.environ, "PYTHONPATH": f"{SHIM}{os.pathsep}{installed}", "DISPLAY": display}
    environment.pop("WAYLAND_DISPLAY", None)
    words = [sys.executable, str(script)]
    return subprocess.run(words, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("is_built", "display", "why"),
    [
        (True, "", "neither DISPLAY nor WAYLAND_DISPLAY is set"),
        (False, ":0", "this OpenCV was built without windows"),
    ],
)
def test_windows_that_cannot_be_shown(
    tmp_path: Path, is_built: bool, display: str, why: str
) -> None:
    done = run(tmp_path, NODE, is_built=is_built, display=display)
    real = str(tmp_path / "installed" / "cv2" / "__init__.py")
    assert done.stdout.splitlines() == ["30 -1 1.0", f"imshow What it does. False {real}"]
    (line,) = done.stderr.splitlines()
    assert line.startswith(f"[WARN] [tuner]: OpenCV shows no windows: {why}. ")


def test_windows_of_a_screen_are_those_of_opencv(tmp_path: Path) -> None:
    text = (
        NODE + "cv2.cvtColor()\ntry:\n    cv2.imshow('bad')\nexcept cv2.error as e:\n    print(e)\n"
    )
    done = run(tmp_path, text, is_built=True, display=":0")
    assert done.stderr == ""
    calls = [line for line in done.stdout.splitlines() if line.startswith("real ")]
    names = ("createTrackbar", "imshow", "getTrackbarPos", "waitKey", "getWindowProperty")
    assert calls == [f"real {name}" for name in (*names, "cvtColor")]
    assert done.stdout.endswith("bad window\n")


THREADS = """
import threading
found = []

def find():
    import cv2
    found.append(cv2.imshow.__doc__)

threads = [threading.Thread(target=find) for _ in range(8)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
print(found == ["What it does."] * 8)
"""


def test_threads_may_import_it_at_the_same_time(tmp_path: Path) -> None:
    done = run(tmp_path, THREADS, is_built=True, display="", slowly="import time; time.sleep(0.2)")
    assert (done.stdout, done.stderr) == ("True\n", "")


def test_opencv_that_is_not_installed() -> None:
    code = (
        "import sys; sys.path = [p for p in sys.path if 'site-packages' not in p]\n"
        "try:\n    import cv2\nexcept ImportError as error:\n    print(error.name)\n"
        "import cv2\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(SHIM)}
    done = subprocess.run(
        [sys.executable, "-S", "-c", code],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "cv2\n"
    lines = done.stderr.splitlines()
    assert lines[-1] == "ModuleNotFoundError: No module named 'cv2'"
    own, of_stand_in = (line for line in lines if line.startswith("  File "))
    assert own.startswith('  File "<string>", line 6')
    assert of_stand_in.startswith(f'  File "{SHIM / "cv2" / "__init__.py"}"')


def test_what_opencv_lacks_is_named(tmp_path: Path) -> None:
    done = run(tmp_path, "import cv2", is_built=True, display="", slowly="import no_such_module")
    assert done.stderr.splitlines()[-1] == "ModuleNotFoundError: No module named 'no_such_module'"
    assert str(tmp_path / "installed" / "cv2" / "__init__.py") in done.stderr
