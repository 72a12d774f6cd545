"""setup.py and setup.cfg are read without running them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.packages.build_files.facts import read_build_facts

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.model.build_facts import BuildFacts

FILES = ("launch/a.launch.py", "urdf/b.urdf", "bot/__init__.py", "bot/node.py", "resource/bot")
CONFIGURATION = "[develop]\nscript_dir=$base/lib/bot\n[install]\ninstall_scripts=$base/lib/bot\n"


def read(folder: Path, text: str, configuration: str = CONFIGURATION) -> BuildFacts:
    for name in FILES:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).touch()
    (folder / "setup.py").write_text(text)
    (folder / "setup.cfg").write_text(configuration)
    return read_build_facts(folder, "bot", "ament_python")[0]


def shared(facts: BuildFacts) -> list[str]:
    return sorted(name for name in facts.shared("bot") if name != "package.xml")


HEAD = """
import os
from glob import glob
from pathlib import Path
from setuptools import find_packages, setup

package_name = 'bot'
"""
ROWS = HEAD + "setup(name=package_name, packages=[package_name], data_files=[\n{}\n])"
BY_LOOP = """
data_files = [('share/' + package_name, ['package.xml'])]
for folder in ('launch', 'urdf', 'no_such_folder'):
    for path, folders, names in os.walk(folder):
        files = [os.path.join(path, name) for name in names]
        if files:
            data_files.append((os.path.join('share', package_name, path), files))
setup(name=package_name, packages=find_packages(exclude=['test']), data_files=data_files)
"""
BY_FUNCTION = """
def package_files(data_files, folders):
    found = {}
    for folder in folders:
        for (path, _, names) in os.walk(folder):
            for name in names:
                place = f'share/{package_name}/{path}'
                found.setdefault(place, [])
                found[place].append(os.path.join(path, name))
    for place in found.keys():
        data_files.append((place, found[place]))
    return data_files

setup(data_files=package_files([], ['launch/', 'urdf']))
"""
BY_PATH = """
here = Path(__file__).parent
rows = [(f'share/{package_name}/{one.parent}', [str(one)]) for one in Path('.').rglob('*.*')
        if one.suffix in ('.py', '.urdf') and str(one.parent) in ['launch', 'urdf']]
setup(**{'data_files': rows})
"""


@pytest.mark.parametrize(
    "text",
    [
        ROWS.format(
            "('share/' + package_name + '/launch', glob('launch/*')),"
            "(os.path.join('share', package_name, 'urdf'), glob(os.path.join('urdf', '*.*')))"
        ),
        ROWS.format(
            "(f'share/{package_name}/launch', ['launch/a.launch.py']),"
            "('share/%s/urdf' % package_name, ['urdf/' + name for name in os.listdir('urdf')])"
        ),
        ROWS.format(
            "*[('share/{}/{}'.format('bot', d), glob(d + '/*')) for d in ('launch', 'urdf')]"
        ),
        HEAD + BY_LOOP,
        HEAD + BY_FUNCTION,
        HEAD + BY_PATH,
        ROWS.format(
            "*[('share/bot/' + d, glob(os.path.join(os.path.dirname(__file__), d, '*')))"
            " for d in ('launch', 'urdf')]"
        ),
    ],
)  # fmt: skip
def test_data_files(tmp_path: Path, text: str) -> None:
    facts = read(tmp_path, text)
    assert shared(facts) == ["launch/a.launch.py", "urdf/b.urdf"]
    assert facts.is_whole


@pytest.mark.parametrize(
    "text",
    [
        "setup(data_files=find_them())",
        "setup(data_files=[('share/bot', ['package.xml'])] + elsewhere.rows)",
        "setup(**generate_distutils_setup(packages=['bot']))",
        "setup(data_files=[(place(), ['package.xml'])])",
        "def f(): return f()\nsetup(data_files=f())",
        "while True: pass",
        "this is no Python",
        "return",
    ],
)
def test_what_cannot_be_known_is_not_whole(tmp_path: Path, text: str) -> None:
    assert not read(tmp_path, HEAD + text).is_whole


def test_scripts_and_lines(tmp_path: Path) -> None:
    text = ROWS.format("('share/bot/urdf',\n  ['urdf/b.urdf'])").removesuffix(")")
    text += ", entry_points={\n'console_scripts': [\n'go = bot.node:main',\n],\n})"
    facts = read(tmp_path, text)
    (script,) = facts.executables
    assert (script.name, script.entry_point, script.line) == ("go", "bot.node:main", 13)
    assert facts.shared("bot")["urdf/b.urdf"].line == 10
    assert [one.name for one in facts.python_packages] == ["bot"]
    assert read(tmp_path, text, "").executables == ()


def test_setup_cfg(tmp_path: Path) -> None:
    configuration = CONFIGURATION + (
        "[metadata]\nname = bot\n[options]\npackages = find:\n"
        "[options.data_files]\nshare/bot/urdf =\n    urdf/b.urdf\n"
        "[options.entry_points]\nconsole_scripts =\n    go = bot.node:main\n"
    )
    facts = read(tmp_path, "from setuptools import setup\nsetup()\n", configuration)
    assert shared(facts) == ["urdf/b.urdf"]
    assert [(one.name, one.line) for one in facts.executables] == [("go", 14)]
    assert [one.name for one in facts.python_packages] == ["bot"]


def test_python_packages_and_their_folders(tmp_path: Path) -> None:
    """package_dir names the folder of a package, or of the one that it is below."""
    text = "setup(packages=['bot', 'bot.parts', 'own'], package_dir={'': 'src', 'bot': 'code'})"
    for folder in ("code/parts", "src/own"):
        (tmp_path / folder).mkdir(parents=True)
    found = read(tmp_path, HEAD + text).python_packages
    assert {one.name: one.source.relative_to(tmp_path).as_posix() for one in found} == {
        "bot": "code",
        "bot.parts": "code/parts",
        "own": "src/own",
    }


def test_packages_that_setuptools_finds(tmp_path: Path) -> None:
    """Not in folders whose names no module can have, nor in those without __init__.py."""
    for folder in ("bot/parts", "bot/v1.2", "bot/data", "test"):
        (tmp_path / folder).mkdir(parents=True)
        if folder != "bot/data":
            (tmp_path / folder / "__init__.py").touch()
    facts = read(tmp_path, HEAD + "setup(packages=find_packages(exclude=['test']))")
    assert [one.name for one in facts.python_packages] == ["bot", "bot.parts"]
    reported = read_build_facts(tmp_path, "bot", "ament_python")[1]
    assert "missing-python-package" not in {one.name for one in reported}


def test_scripts_in_one_text(tmp_path: Path) -> None:
    """Entry points may be written as a file of setuptools has them, in sections."""
    points = "[other]\nx = bot.node:other\n[console_scripts]\ngo = bot.node:main\n"
    facts = read(tmp_path, f"{HEAD}setup(entry_points={points!r})")
    assert [(one.name, one.entry_point) for one in facts.executables] == [("go", "bot.node:main")]
