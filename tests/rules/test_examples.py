"""The documentation of the rules holds: a bad example is reported, and a good one is silent.

Each example that is code is planted into a sound package, and the package is checked.
"""

from __future__ import annotations

import io
import os
from typing import TYPE_CHECKING

import pytest
import trimesh
from PIL import Image

from mesh_samples import binary_stl, dae
from planted_examples import NOT_PLANTED, PLANTS, cmake, finish_robot, manifest
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.pipeline.check import CheckRequest, check
from wsgen.pipeline.reported import Filters, filter_outcome
from wsgen.rules.catalogue import all_rules

if TYPE_CHECKING:
    from pathlib import Path

    from planted_examples import Files

BY_CODE = {rule.code: rule for rule in all_rules()}
SERIOUS = {Severity.ERROR, Severity.WARNING}


def complete(files: Files, distro: str) -> dict[str, str]:
    """The files of a whole package: with a manifest and a build file, where they are not given."""
    folders = sorted({name.partition("/")[0] for name in files if "/" in name} - {"src", "scripts"})
    given = {
        name: finish_robot(text) if name.endswith((".urdf", ".xacro")) and text else text
        for name, text in files.items()
    }
    whole = {
        "package.xml": manifest(distro),
        "CMakeLists.txt": cmake(" ".join(folders)),
    } | given
    return {name: text for name, text in whole.items() if text is not None}


def _glb() -> bytes:
    return bytes(trimesh.creation.box((1, 1, 1)).export(file_type="glb"))


def _stl(edge: float) -> bytes:
    return bytes(trimesh.creation.box((edge, edge, edge)).export(file_type="stl"))


def _png() -> bytes:
    buffer = io.BytesIO()
    Image.new("L", (33, 33), 100).save(buffer, "png")
    return buffer.getvalue()


CONTENT = {
    "STL": binary_stl(),
    "STL_MM": _stl(200),
    "STL_OF_50": _stl(50),
    "DAE": dae().encode(),
    "GLB": _glb(),
    "PNG": _png(),
}


def write(folder: Path, name: str, files: dict[str, str]) -> None:
    for path, text in files.items():
        file = folder / name / path.replace("my_robot", name)
        if path.endswith("/"):
            file.mkdir(parents=True)
            continue
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(CONTENT.get(text) or text.replace("my_robot", name).encode())


SOURCED: dict[str, dict[str, str]] = {"fortress": {"ROS_DISTRO": "humble"}, "unknown": {}}


def check_all(folder: Path, distro: str) -> dict[str, list[Diagnostic]]:
    """What is reported, by package."""
    environment = {
        "PATH": os.environ["PATH"],
    } | SOURCED.get(distro, {"ROS_DISTRO": distro})
    outcome = check(CheckRequest(paths=[folder]), environment=environment)
    found: dict[str, list[Diagnostic]] = {}
    for one in filter_outcome(outcome, Filters()).diagnostics:
        name = one.file.relative_to(folder).parts[0] if one.file else ""
        found.setdefault(name, []).append(one)
    return found


def test_each_rule_is_planted_or_it_says_why_not() -> None:
    not_planted = [code for codes in NOT_PLANTED.values() for code in codes]
    assert sorted([*PLANTS, *not_planted]) == sorted(BY_CODE)


@pytest.mark.slow
def test_bad_examples_are_reported_and_good_ones_are_silent(tmp_path: Path) -> None:
    found: dict[str, list[Diagnostic]] = {}
    for distro in sorted({plant.distro for plant in PLANTS.values()}):
        folder = tmp_path / distro
        for code, plant in PLANTS.items():
            if plant.distro == distro:
                rule = BY_CODE[code]
                bad = complete(plant.plant(rule.example), distro)
                write(folder, f"bad_{code.lower()}", bad)
                if plant.is_good_code:
                    good = complete(plant.plant(rule.instead, is_good=True), distro)
                    write(folder, f"good_{code.lower()}", good)
        found |= check_all(folder, distro)
    wrong = []
    for code, plant in PLANTS.items():
        reported = found.get(f"bad_{code.lower()}", [])
        if code not in {one.code for one in reported}:
            wrong.append(f"{code} is not reported of its example, but {_shown(reported)}")
        serious = [one for one in found.get(f"good_{code.lower()}", []) if one.severity in SERIOUS]
        if plant.is_good_code and serious:
            wrong.append(f"{code}: {_shown(serious)} of what to use instead")
    assert not wrong, "\n".join(wrong)


def _shown(found: list[Diagnostic]) -> str:
    return "; ".join(f"{one.code} {one.line}: {one.message}" for one in found)
