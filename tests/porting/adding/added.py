"""Packages to which something is added: our own workspaces, and texts as people write them."""

from __future__ import annotations

import os
import shutil
from typing import TYPE_CHECKING

from kind_workspaces import WORKSPACES
from wsgen.porting.adding.addition import Addition, AddPlan, write_addition
from wsgen.porting.adding.opening import open_addition

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

MANIFEST = """<?xml version="1.0"?>
<package format="3">
  <name>{name}</name>
  <version>0.1.0</version>
  <description>A package</description>
  <maintainer email="a@example.com">A</maintainer>
  <license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <export><build_type>{build_type}</build_type></export>
</package>
"""


def package(
    folder: Path, name: str, files: dict[str, str], build_type: str = "ament_cmake"
) -> Path:
    """A package with these files, and a package.xml."""
    place = folder / "src" / name
    files = {"package.xml": MANIFEST.format(name=name, build_type=build_type), **files}
    for path, text in files.items():
        file = place / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8", newline="")
    return place


def workspace(folder: Path, kind: str) -> Path:
    """A copy of one of our workspaces."""
    shutil.copytree(WORKSPACES / kind, folder / kind)
    return folder / kind


def opened(place: Path, distro: str | None = None, simulator: str | None = None) -> Addition:
    """A package to which something is added."""
    return open_addition(os.fspath(place), None, distro, simulator, {})


def added(
    place: Path,
    add: Callable[[Addition], object],
    distro: str | None = None,
    grows: str = "",
) -> tuple[AddPlan, dict[str, list[str]]]:
    """Add to a package, write it, and add again, which changes nothing.

    Gives also the lines that each file of before has more; none of them has lost any, but in the
    file in which a line `grows` none of them has lost a character.
    """
    addition = opened(place, distro)
    add(addition)
    plan = addition.finish()
    write_addition(plan)
    again = opened(place, distro)
    add(again)
    assert (again.finish().files, again.finish().created) == ((), ())
    lines = {}
    for fix in plan.files:
        before, after = fix.before.splitlines(), fix.after.splitlines()
        path = fix.file.relative_to(place).as_posix()
        is_grown = path == grows
        rest = iter(fix.after if is_grown else after)
        assert all(one in rest for one in (fix.before if is_grown else before)), f"{path} lost one"
        new = list(after)
        for line in before:
            if line in new:
                new.remove(line)
        lines[path] = [one.strip() for one in new if one.strip()]
    return plan, lines
