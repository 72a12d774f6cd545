"""Nodes that show pictures in windows, where there is no screen or no OpenCV with windows."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from wsgen.ros.environment.processes import SHIM, START

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
    folder: Path,
    text: str,
    *,
    is_built: bool = True,
    display: str = "",
    slowly: str = "",
    package: str = OPENCV,
    ours: tuple[Path, ...] = (START, SHIM),
) -> subprocess.CompletedProcess[str]:
    installed = folder / "installed"
    (installed / "cv2").mkdir(parents=True, exist_ok=True)
    opencv = package.replace("{is_built}", str(is_built))
    (installed / "cv2" / "__init__.py").write_text(f"{slowly}\n{opencv}")
    script = folder / "tuner"
    script.write_text(text)
    path = os.pathsep.join(map(str, (installed, *ours)))
    environment = {**os.environ, "PYTHONPATH": path, "DISPLAY": display}
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


LIBRARY = """
import sys
package = sys.modules.pop("cv2")  # as OpenCV does it: the library has the name, too
path, sys.path = sys.path, [__file__.rpartition("/")[0] + "/library", *sys.path]
import cv2
assert cv2 is not package
sys.path = path
sys.modules["cv2"] = package
globals().update({k: v for k, v in vars(cv2).items() if not k.startswith("__")})
"""


def test_a_package_that_imports_its_library_by_its_own_name(tmp_path: Path) -> None:
    library = tmp_path / "installed" / "cv2" / "library"
    library.mkdir(parents=True)
    (library / "cv2.py").write_text(OPENCV.replace("{is_built}", "True"))
    text = 'import cv2\nprint(cv2.imshow("view", None), cv2.cvtColor(None))'
    done = run(tmp_path, text, package=LIBRARY)
    assert done.stdout == "real cvtColor\nNone 7\n"
    assert "OpenCV shows no windows" in done.stderr


ABSENT = """
import importlib.util, sys
sys.path = [one for one in sys.path if "site-packages" not in one]
print(importlib.util.find_spec("cv2"))
try:
    import cv2
except ImportError as error:
    print(error.name, "cv2" in sys.modules)
import cv2
"""


def test_opencv_that_is_not_installed() -> None:
    path = os.pathsep.join(map(str, (START, SHIM)))
    done = subprocess.run(
        [sys.executable, "-c", ABSENT],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "None\ncv2 False\n"
    *lines, last = done.stderr.splitlines()
    assert last == "ModuleNotFoundError: No module named 'cv2'"
    (own,) = (line for line in lines if line.startswith("  File "))
    assert own.startswith('  File "<string>", line 9')


def test_opencv_of_a_sourced_ros_is_left_alone(tmp_path: Path) -> None:
    done = run(tmp_path, NODE, is_built=True, display="", ours=(START,))
    assert done.stdout.startswith("real createTrackbar\nreal imshow\n")


def test_what_opencv_lacks_is_named(tmp_path: Path) -> None:
    done = run(tmp_path, "import cv2", is_built=True, display="", slowly="import no_such_module")
    assert done.stderr.splitlines()[-1] == "ModuleNotFoundError: No module named 'no_such_module'"
    assert str(tmp_path / "installed" / "cv2" / "__init__.py") in done.stderr
