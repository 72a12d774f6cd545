"""Find the robots and worlds that a package describes."""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING

from wsgen.packages.workspace.layout import BUILD_MARKERS
from wsgen.text.files import list_files
from wsgen.text.markup import read_text, without_comments
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path


SUFFIXES = (".urdf", ".xacro")
OF_SDF = (".sdf", ".world")
ROBOT = lazy_pattern(r"<robot\b[^>]*?\sname\s*=")  # a file of macros has no name
INCLUDED = lazy_pattern(r"<xacro:include\b[^>]*?\sfilename\s*=\s*[\"']([^\"']+)")
# What describes a robot: files of macros have nothing of it outside of them.
MACRO = lazy_pattern(r"<xacro:macro\b.*?</xacro:macro>", re.DOTALL)
PART = lazy_pattern(r"<(?:link|joint|xacro:(?!arg\b|property\b|macro\b)\w+)\b")


def find_descriptions(folder: Path) -> Iterator[Path]:
    """The files of whole robots below a folder, then those of SDF worlds and models.

    Where a package is its own workspace, the folders of its builds are in it; they are left out.
    """
    files = list_files(folder, (*SUFFIXES, *OF_SDF), markers=BUILD_MARKERS)
    yield from _whole_robots(files)
    for suffix in OF_SDF:
        yield from (file for file in files if os.path.normcase(file.name).endswith(suffix))


def find_robot_files(folder: Path) -> tuple[Path, ...]:
    """The URDF and xacro files of whole robots below a folder: no other file includes them."""
    return _whole_robots(list_files(folder, SUFFIXES, markers=BUILD_MARKERS))


def _whole_robots(files: Iterable[Path]) -> tuple[Path, ...]:
    texts = {
        file: without_comments(read_text(file) or "")
        for file in files
        if file.suffix in SUFFIXES and ".srdf" not in file.suffixes
    }
    included = {
        name.rpartition("/")[2] for text in texts.values() for name in INCLUDED.findall(text)
    }
    return tuple(
        file
        for file, text in texts.items()
        if file.name not in included
        and (_is_urdf(file, text) or (ROBOT.search(text) and PART.search(MACRO.sub("", text))))
    )


def _is_urdf(file: Path, text: str) -> bool:
    """Whether a file that no xacro file includes is meant as a whole robot, whatever it lacks."""
    return file.suffix == ".urdf" and "<robot" in text and "xacro" not in text
