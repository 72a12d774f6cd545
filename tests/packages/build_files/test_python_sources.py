"""Syntax errors in installed Python files are reported, and newer syntax is not."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import pytest

from wsgen.packages.build_files import python_sources
from wsgen.packages.build_files.facts import read_build_facts
from wsgen.packages.build_files.python_sources import check_python_syntax

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

SETUP = """\
from setuptools import setup

setup(name='bot', packages=['bot'],
      entry_points={'console_scripts': ['talk = bot.talk:main']})
"""
CONFIGURATION = "[install]\ninstall_scripts=$base/lib/bot\n"
SOUND = "def main():\n    print('hello')\n"
CMAKE = """\
cmake_minimum_required(VERSION 3.8)
project(bot)
find_package(ament_cmake REQUIRED)
install(PROGRAMS scripts/walk.py scripts/run DESTINATION lib/bot)
ament_package()
"""


def check_module(
    folder: Path, text: str | bytes, distro: str | None = "humble", name: str = "talk.py"
) -> list[Diagnostic]:
    """Check an ament_python package in which a module has this text."""
    for file, content in {
        "setup.py": SETUP,
        "setup.cfg": CONFIGURATION,
        "bot/__init__.py": "",
        "bot/talk.py": SOUND,
        f"bot/{name}": text,
    }.items():
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        data = content if isinstance(content, bytes) else content.encode()
        (folder / file).write_bytes(data)
    facts, _ = read_build_facts(folder, "bot", "ament_python")
    return list(check_python_syntax(facts, distro))


def check_scripts(folder: Path, walk: str, run: str = "#!/bin/sh\n((\n") -> list[Diagnostic]:
    """Check an ament_cmake package that installs two programs."""
    (folder / "scripts").mkdir()
    (folder / "CMakeLists.txt").write_text(CMAKE)
    (folder / "scripts" / "walk.py").write_text(walk)
    (folder / "scripts" / "run").write_text(run)
    facts, _ = read_build_facts(folder, "bot", "ament_cmake")
    return list(check_python_syntax(facts, None))


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("def main()\n    pass\n", 1, "colon"),
        ("def main():\nprint('x')\n", 2, "Indent"),
        ("import os\nprint 'hello'\n", 2, "2to3"),
        ("x = (1,\ny = 2\n", 1, "bracket"),
        ("x = 'open\n", 1, "quotation"),
        (b"# ok\nx = '\xe9'\n", None, "UTF-8"),
        ("x = 1\n".encode("utf-16"), 1, "UTF-8"),
    ],
)
def test_a_mistake_is_reported(tmp_path: Path, text: str | bytes, line: int, words: str) -> None:
    [found] = check_module(tmp_path, text)
    assert found.code == "BLD066"
    assert found.severity.value == "error"
    assert found.file == tmp_path / "bot/talk.py"
    assert line is None or found.line == line
    assert words in (found.hint or "")
    assert "bot/talk.py is not valid Python" in found.message


def test_a_module_that_no_program_is_made_of_is_a_warning(tmp_path: Path) -> None:
    [found] = check_module(tmp_path, "def x(\n", name="other.py")
    assert found.severity.value == "warning"


def test_a_program_may_be_a_script(tmp_path: Path) -> None:
    [found] = check_scripts(tmp_path, "#!/usr/bin/env python3\nif True\n    pass\n")
    assert (found.line, found.severity.value) == (2, "error")


def test_a_program_without_an_ending_is_read_by_its_first_line(tmp_path: Path) -> None:
    run = "#!/usr/bin/env python3\nif True\n    pass\n"
    [found] = check_scripts(tmp_path, SOUND, run)
    assert found.file == tmp_path / "scripts/run"


@pytest.mark.parametrize(
    "text",
    [
        SOUND,
        "x = '\\d'\n",  # warns
        "{{ x }}\nimport {{ name }}\n",  # a template
        f"x = {'(' * 500}{')' * 500}\n",
        b"# -*- coding: latin-1 -*-\n" + b"x = '\xe9'\n",
        "\ufeffx = 1\n",
    ],
)
def test_a_sound_module(tmp_path: Path, text: str | bytes) -> None:
    assert check_module(tmp_path, text) == []


NEWER = [
    "try:\n    pass\nexcept* ValueError:\n    pass\n",
    "type Name = int\n",
    "def first[T](x: T) -> T:\n    return x\n",
    "class Box[T]:\n    pass\n",
    "x = f'{d['a']}'\n",
    'x = f"""{\n  1  # one\n}"""\n',
    "x = t'{d}'\n",
    "try:\n    pass\nexcept ValueError, TypeError:\n    pass\n",
    "x = a[*b]\n",
]


@pytest.mark.parametrize("text", NEWER)
@pytest.mark.parametrize("distro", ["lyrical", None])
def test_a_newer_syntax_is_no_mistake(tmp_path: Path, text: str, distro: str | None) -> None:
    """On every Python that wsgen runs on, as the target has one that is as new."""
    assert check_module(tmp_path, text, distro) == []


@pytest.mark.parametrize("text", ["x = = 1\n", "def main()\n    pass\n", "x = [1, 2\n"])
@pytest.mark.parametrize("distro", ["lyrical", None])
def test_a_mistake_is_one_in_every_python(tmp_path: Path, text: str, distro: str | None) -> None:
    assert len(check_module(tmp_path, text, distro)) == 1


def test_what_the_python_of_the_target_lacks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(python_sources, "OWN", (3, 14))  # reads what follows in any case
    text = "try:\n    pass\nexcept* ValueError:\n    pass\n"
    if sys.version_info < (3, 11):
        pytest.skip("this Python lacks it, too")
    [found] = check_module(tmp_path, text, "humble")
    assert found.line in {3, 4}  # Pythons differ
    assert "valid Python 3.10" in found.message
    assert "3.11" in (found.hint or "")
