"""Modules that a program will lack, which `wsgen run` names before it becomes the program."""

from __future__ import annotations

import os
import sys
from importlib.machinery import ModuleSpec
from typing import TYPE_CHECKING

import pytest

from wsgen.live.python_failures import lacking_modules, syntax_error
from wsgen.ros.environment.processes import SHIM

if TYPE_CHECKING:
    from pathlib import Path

NODE = """
import os, numpy.linalg
import not_there.inside as it, here
from also_not import x
from . import sibling
try:
    import may_lack
except ImportError:
    may_lack = None

def main():
    import lacks_later
"""


@pytest.fixture
def script(tmp_path: Path) -> Path:
    """A console script as setuptools installs it, with its module."""
    site = tmp_path / "lib" / "python3.12" / "site-packages"
    (site / "my_pkg").mkdir(parents=True)
    (site / "my_pkg" / "node.py").write_text(NODE)
    (site / "here.py").touch()
    (site / "my_pkg-0.dist-info").mkdir()
    entries = "[console_scripts]\ndriver2 = my_pkg.other:main\ndriver = my_pkg.node:main\n"
    (site / "my_pkg-0.dist-info" / "entry_points.txt").write_text(entries)
    script = tmp_path / "lib" / "my_pkg" / "driver"
    script.parent.mkdir()
    script.write_text("import re\n")
    return script


def _lacking(script: Path) -> list[str]:
    site = script.parents[1] / "python3.12" / "site-packages"
    return list(lacking_modules([sys.executable, str(script)], {"PYTHONPATH": str(site)}))


def test_what_the_module_of_a_console_script_lacks(script: Path) -> None:
    assert _lacking(script) == ["not_there", "also_not"]


def test_a_module_that_a_finder_of_its_own_finds_is_there(
    script: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    class Finder:
        @staticmethod
        def find_spec(name: str, *_: object) -> ModuleSpec | None:
            return ModuleSpec(name, None) if name == "not_there" else None

    monkeypatch.setattr(sys, "meta_path", [*sys.meta_path, Finder])
    assert _lacking(script) == ["also_not"]


def test_what_a_script_lacks(script: Path) -> None:
    alone = script.with_name("alone.py")
    alone.write_text("import not_there\nimport beside\n")
    alone.with_name("beside.py").touch()
    assert _lacking(alone) == ["not_there"]


@pytest.mark.parametrize(
    "before",
    [
        "import sys\nsys.path.append('/opt/mine')\n",
        "import os, sys\nif os.name:\n    sys.path.append('/opt/mine')\n",
        "import site\nsite.addsitedir('/opt/mine')\n",
        "HERE = __import__('pathlib').Path(__file__)\n",
    ],
)
def test_what_comes_after_other_statements_may_be_found(script: Path, before: str) -> None:
    alone = script.with_name("alone.py")
    start = '"""A driver."""\nfrom __future__ import annotations\nimport not_there\n'
    alone.write_text(f"{start}{before}import mine\n")
    assert _lacking(alone) == ["not_there"]


def test_what_cannot_be_read_lacks_nothing_that_is_known(script: Path) -> None:
    broken = script.with_name("broken.py")
    broken.write_text("import not_there\ndef x(\n")
    assert _lacking(broken) == []
    assert _lacking(script.with_name("nothing")) == []
    assert list(lacking_modules(["python"], {})) == []


def test_a_program_that_is_no_python(script: Path) -> None:
    site = script.parents[1] / "python3.12" / "site-packages"
    words, variables = [sys.executable, str(script)], {"PYTHONPATH": str(site)}
    assert syntax_error(words, variables) is None
    module = site / "my_pkg" / "node.py"
    module.write_text(f"{NODE}\nspeed = = 1\n")
    assert syntax_error(words, variables) == (module, len(NODE.splitlines()) + 2)
    (site / "my_pkg-0.dist-info" / "entry_points.txt").unlink()
    assert syntax_error(words, variables) is None
    script.write_text("def main(:\n")
    assert syntax_error(words, variables) == (script, 1)
    script.unlink()
    assert syntax_error(words, variables) is None
    assert syntax_error(["./driver"], variables) is None


def test_what_the_path_of_nodes_has_is_not_lacking(script: Path, tmp_path: Path) -> None:
    site = tmp_path / "lib" / "python3.12" / "site-packages"
    (site / "my_pkg" / "node.py").write_text("import cv2\nimport message_filters\n")
    words = [sys.executable, str(script)]
    path = f"{site}{os.pathsep}{SHIM}"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sys, "path", [])
        assert list(lacking_modules(words, {"PYTHONPATH": path})) == ["cv2"]
