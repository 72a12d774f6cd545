"""The generated CMakeLists gives no warning, from Ubuntu 22.04's CMake to the newest."""

import os
import re
import subprocess
import sys
from pathlib import Path

import cmake as cmake_wheel
import pytest

from golden_support import CASES, golden_package

pytestmark = pytest.mark.slow

# Ubuntu 22.04, Ubuntu 24.04, the last before 4, the newest that wsgen's dependencies bring.
VERSIONS = ("3.22.6", "3.28.4", "3.31.6", "newest")
# Not at a border: what the older and the newer one accept, they accept, too. They try the file with
# the most commands.
BETWEEN = ("3.28.4", "3.31.6")


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(one, marks=[pytest.mark.thorough] if one in BETWEEN else [])
        for one in VERSIONS
    ],
)
def cmake(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The binary of one CMake version."""
    if request.param == "newest":
        return Path(cmake_wheel.CMAKE_BIN_DIR, "cmake")
    folder = tmp_path_factory.mktemp("cmake")
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-compile"]
    subprocess.run(
        [*pip, "--target", str(folder), f"cmake=={request.param}"], check=True, capture_output=True
    )
    return folder / "cmake" / "data" / "bin" / "cmake"


def test_no_warning(cmake: Path, tmp_path: Path, request: pytest.FixtureRequest) -> None:
    # Most goldens have one and the same.
    cases = {(golden_package(case) / "CMakeLists.txt").read_text(): case for case in CASES}
    if request.node.callspec.params["cmake"] in BETWEEN:
        longest = max(cases, key=len)
        cases = {longest: cases[longest]}
    environment = {
        **os.environ,
        "VIRTUAL_ENV": sys.prefix,
        "CMAKE_PREFIX_PATH": sys.prefix,
    }
    for case in cases.values():
        run = subprocess.run(
            [
                cmake,
                "-S",
                golden_package(case),
                "-B",
                tmp_path / case,
                "--warn-uninitialized",
                "-Wdev",
                "-Wdeprecated",
            ],
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        # CMake names the file of a warning, ours without a folder; those of ament_cmake's own
        # files are not ours to fix.
        ours = re.findall(r"^CMake .*Warning.* at CMakeLists\.txt.*$", run.stderr, re.MULTILINE)
        assert (run.returncode, ours) == (0, []), run.stderr


def test_a_warning_would_be_seen(cmake: Path, tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.20)\nproject(p LANGUAGES NONE)\n"
        'message(WARNING "w")\nmessage("${not_there}")\n'
    )
    run = subprocess.run(
        [cmake, "-S", tmp_path, "-B", tmp_path / "build", "--warn-uninitialized", "-Wdev"],
        capture_output=True,
        text=True,
        check=False,
    )
    found = re.findall(r"^CMake .*Warning.* at CMakeLists\.txt.*$", run.stderr, re.MULTILINE)
    assert len(found) == 2
