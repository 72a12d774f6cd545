"""What is wrong in setup.py and setup.cfg: each rule in a bad and in a good case."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.packages.build_files.facts import read_build_facts

if TYPE_CHECKING:
    from pathlib import Path

SETUP = """\
import os
from glob import glob
from setuptools import find_packages, setup

package_name = 'bot'

setup(
    name=package_name,
    version='0.1.0',
    packages=[package_name],
    data_files=[
        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),
        ('share/' + package_name, ['package.xml']),
        ('share/' + package_name + '/launch', glob('launch/*.launch.py')),
        (os.path.join('share', package_name, 'urdf'), glob('urdf/*')),
    ],
    entry_points={
        'console_scripts': [
            'go = bot.node:main',
        ],
    },
)
"""
CONFIGURATION = "[develop]\nscript_dir=$base/lib/bot\n[install]\ninstall_scripts=$base/lib/bot\n"
FILES = {
    "package.xml": "",
    "launch/a.launch.py": "",
    "urdf/b.urdf": "",
    "resource/bot": "",
    "bot/__init__.py": "",
    "bot/node.py": "def main():\n    pass\n",
}


def report(
    folder: Path, text: str, configuration: str | None = CONFIGURATION, without: str = ""
) -> list[tuple[str, str, int | None, str]]:
    """Name, file, line and severity of what is reported about a package `bot`."""
    for name, content in FILES.items():
        file = folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        if name != without:
            file.write_text(content)
    (folder / "setup.py").write_text(text)
    if configuration is not None:
        (folder / "setup.cfg").write_text(configuration)
    found = read_build_facts(folder, "bot", "ament_python")[1]
    assert all(one.hint for one in found)
    return [
        (one.name, one.file.name if one.file else "", one.line, one.severity.value) for one in found
    ]


def test_a_sound_package(tmp_path: Path) -> None:
    assert report(tmp_path, SETUP) == []


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("version='0.1.0',", "version='0.1.0'", ("setup-failure", 9, "error")),
        ("['package.xml']", "['package.xm']", ("missing-data-file", 13, "error")),
        ("glob('urdf/*')", "['urdf']", ("missing-data-file", 15, "error")),
        ("packages=[package_name]", "packages=['bots']", ("missing-python-package", 10, "error")),
        ("data_files=", "data_file=", ("unknown-setup-option", 11, "warning")),
        ("'go = bot.node:main'", "'go = bot.node:man'", ("broken-console-script", 19, "error")),
        ("'go = bot.node:main'", "'go = bot.nod:main'", ("broken-console-script", 19, "error")),
        ("'go = bot.node:main'", "'go = bot.node'", ("broken-console-script", 19, "error")),
        ("'go = bot.node:main'", "'go: bot.node:main'", ("broken-console-script", 19, "error")),
        ("'go = bot.node:main'", "'go = bot.node:main' 'on = bot.node:main'",
         ("broken-console-script", 19, "error")),
        ("'go = bot.node:main'", "'go = bot/node.py:main'",
         ("broken-console-script", 19, "error")),
        ("'console_scripts'", "'console_script'", ("broken-console-script", 18, "warning")),
        ("packages=[package_name]", "packages=[]", ("broken-console-script", 19, "error")),
        ("*.launch.py", "*_launch.py", ("empty-glob", 14, "warning")),
        ("'share/' + package_name + '/launch'", "'share/launch'",
         ("wrong-destination", 14, "warning")),
        ("'share/' + package_name + '/launch'", "'launch'", ("wrong-destination", 14, "warning")),
        ("        ('share/' + package_name + '/launch', glob('launch/*.launch.py')),\n", "",
         ("folder-not-installed", 11, "warning")),
        ("        ('share/' + package_name, ['package.xml']),\n", "",
         ("missing-marker", 11, "warning")),
        ("        ('share/ament_index/resource_index/packages', ['resource/' + package_name]),\n",
         "", ("missing-marker", 11, "warning")),
        ("name=package_name", "name='bots'", ("different-setup-name", 8, "warning")),
    ],
)  # fmt: skip
def test_mistakes(tmp_path: Path, old: str, new: str, expected: tuple[str, int, str]) -> None:
    assert old in SETUP
    found = report(tmp_path, SETUP.replace(old, new))
    assert (expected[0], "setup.py", *expected[1:]) in found
    allowed = {expected[0], "folder-not-installed", "missing-marker", "broken-console-script"}
    assert {name for name, _, _, _ in found} <= allowed


@pytest.mark.parametrize(
    ("configuration", "expected"),
    [
        (None, ("broken-console-script", "setup.py", None, "warning")),
        ("[develop]\nscript_dir=$base/lib/bot\n",
         ("broken-console-script", "setup.cfg", 1, "warning")),
        (CONFIGURATION.replace("install_scripts=$base/lib/bot", "install_scripts=$base/lib/bots"),
         ("broken-console-script", "setup.cfg", 4, "warning")),
        ("script_dir=$base/lib/bot\n", ("setup-failure", "setup.cfg", 1, "error")),
    ],
)  # fmt: skip
def test_setup_cfg(
    tmp_path: Path, configuration: str | None, expected: tuple[str, str, int | None, str]
) -> None:
    assert report(tmp_path, SETUP, configuration) == [expected]


@pytest.mark.parametrize("name", ["resource/bot", "bot/node.py"])
def test_files_that_are_missing(tmp_path: Path, name: str) -> None:
    (found,) = report(tmp_path, SETUP, without=name)
    assert found[0] == ("missing-data-file" if "resource" in name else "broken-console-script")


def test_a_launch_file_that_the_pattern_leaves_out(tmp_path: Path) -> None:
    (tmp_path / "launch").mkdir()
    (tmp_path / "launch" / "b_launch.py").touch()
    found = report(tmp_path, SETUP)
    assert found == [("uninstalled-launch-file", "setup.py", 11, "warning")]


def test_a_script_in_a_folder_without_init(tmp_path: Path) -> None:
    text = SETUP.replace("packages=[package_name]", "packages=find_packages()")
    (found,) = report(tmp_path, text, without="bot/__init__.py")
    assert found == ("broken-console-script", "setup.py", 19, "error")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("packages=[package_name]", "packages=find_packages(exclude=['test'])"),
        ("'go = bot.node:main'", "'go = other_package.node:main'"),
        ("glob('urdf/*')", "glob('urdf/*') + glob('urdf/*.xacro') + glob('meshes/*')"),
        ("setup(\n", "setup(\n    **read_more(),\n"),
        ("['package.xml']", "['package.xml', *more()]"),
        ("install_scripts=$base/lib/bot", "install-scripts=$base/lib/bot"),
    ],
)
def test_what_may_be_right_is_not_reported(tmp_path: Path, old: str, new: str) -> None:
    assert report(tmp_path, SETUP.replace(old, new), CONFIGURATION.replace(old, new)) == []


@pytest.mark.parametrize("text", ["", "# nothing\n", "import os\nname = 'bot'\n"])
def test_a_setup_file_that_calls_nothing(tmp_path: Path, text: str) -> None:
    (found,) = report(tmp_path, text)
    assert found == ("setup-failure", "setup.py", 1, "error")


@pytest.mark.parametrize(
    "text",
    ["import real_setup\n", "from .tools import *\n", "exec(open('real_setup.py').read())\n"],
)
def test_a_setup_file_that_may_call_setup(tmp_path: Path, text: str) -> None:
    assert report(tmp_path, text) == []


def test_messages_end_with_one_period(tmp_path: Path) -> None:
    (tmp_path / "setup.py").write_text(SETUP)
    (tmp_path / "setup.cfg").write_text("no section\n")
    _, found = read_build_facts(tmp_path, "bot", "ament_python")
    assert found
    assert not [one.message for one in found if one.message.endswith("..")]
