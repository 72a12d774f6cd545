"""Why ament_python packages fail: what is said, where, and what to do."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from building.building import build_here
from kind_workspaces import WORKSPACES
from wsgen.building.explain import explain
from wsgen.building.failure import Failure
from wsgen.diagnostics import Diagnostic

NAME = "beetle_bringup"
FROM_COLCON = (
    '  File "/lib/colcon_core/task.py", line 9, in build\nCalledProcessError: Command failed\n'
)


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """The folder of a Python package that builds, in a workspace of its own."""
    shutil.copytree(WORKSPACES / "python_package", tmp_path, dirs_exist_ok=True)
    return tmp_path / "src" / NAME


def edit(file: Path, before: str, after: str) -> None:
    text = file.read_text()
    assert before in text
    file.write_text(text.replace(before, after))


def explained(package: Path, output: str) -> Diagnostic:
    (diagnostic,) = explain(
        Failure(
            package=NAME,
            folder=package,
            is_python=True,
            build_folder=package.parents[1] / "build" / NAME,
            output=output,
            siblings=(),
            distro="",
            log=None,
        )
    )
    return diagnostic


# What setuptools prints, what is changed; the code, the line of setup.py, words of both texts.
OUTPUTS: dict[str, tuple[str, Callable[[Path], object], tuple[str, int, str, str]]] = {
    "no marker": (
        f"error: can't copy 'resource/{NAME}': doesn't exist or not a regular file",
        lambda package: shutil.rmtree(package / "resource"),
        ("BLD041", 13, "does not exist", f"mkdir -p resource; touch resource/{NAME}"),
    ),
    "marker of another name": (
        "error: can't copy 'resource/beetle': doesn't exist or not a regular file",
        lambda package: edit(package / "setup.py", f"= '{NAME}'", "= 'beetle'"),
        ("BLD041", 13, "resource/beetle, which", f"the name in package.xml, {NAME}"),
    ),
    "no such file": (
        "error: can't copy 'urdf/beetle.xacro': doesn't exist or not a regular file",
        lambda package: edit(package / "setup.py", "glob('urdf/*')", "['urdf/beetle.xacro']"),
        ("BLD041", 16, "urdf/beetle.xacro, which does not exist", "mean `beetle.urdf.xacro`?"),
    ),
    "folder by a pattern": (
        "error: can't copy 'urdf/parts': doesn't exist or not a regular file",
        lambda package: (package / "urdf" / "parts").mkdir(),
        ("BLD041", 16, "urdf/parts, which is a folder", "a separate entry for urdf/parts"),
    ),
    "absolute path": (
        f"{FROM_COLCON}AssertionError: 'data_files' must be relative, '/a/b' is absolute",
        lambda _package: None,
        ("BLD041", 11, "the absolute path /a/b", "relative to the folder of setup.py"),
    ),
    "no package": (
        "error: package directory 'beetle_bring' does not exist",
        lambda _package: None,
        ("BLD042", 10, "names beetle_bring, but", f"Did you mean `{NAME}`?"),
    ),
    "no module": (
        f"{FROM_COLCON}RuntimeError: Provided py_modules 'drive.py' does not exist",
        lambda package: edit(package / "setup.py", "packages=find", "py_modules=['drive'], p=find"),
        ("BLD042", 10, "drive.py", "Create it"),
    ),
    "refused argument": (
        "error in beetle setup command: 'zip_safe' must be a boolean value (got 'yes')",
        lambda _package: None,
        ("BLD040", 21, "'zip_safe' must be a boolean", "Fix the argument"),
    ),
}


@pytest.mark.parametrize("case", OUTPUTS)
def test_output_of_setuptools(case: str, package: Path) -> None:
    output, change, (code, line, message, hint) = OUTPUTS[case]
    change(package)
    diagnostic = explained(package, output)
    assert (diagnostic.code, diagnostic.file, diagnostic.line) == (code, package / "setup.py", line)
    assert message in diagnostic.message
    assert hint in (diagnostic.hint or "")


# What is changed in a file; the line, words of message and hint. colcon tells nothing about these.
STOPS = {
    "syntax": (
        ("setup.py", "version='0.1.0',", "version='0.1.0'"),
        (9, "SyntaxError", "a missing comma"),
    ),
    "missing import": (
        ("setup.py", "from glob import glob\n", ""),
        (14, "name 'glob' is not defined", "Add at the top: from glob import glob"),
    ),
    "module of ROS": (
        ("setup.py", "import os\n", "import os\nimport ament_package_of_nobody, tf2_ros\n"),
        (2, "No module named 'ament_package_of_nobody'", "pip install ament_package_of_nobody"),
    ),
    "released module": (
        ("setup.py", "import os\n", "import os\nfrom rclpy.node import Node\n"),
        (2, "No module named 'rclpy'", "Source a ROS that has rclpy"),
    ),
    "missing file": (
        ("setup.py", "import os\n", "import os\nopen('README.md')\n"),
        (2, "FileNotFoundError", "Fix the line, or what it reads."),
    ),
    "setup.cfg": (
        ("setup.cfg", "[install]\n", "[install]\ninstall_scripts\n"),
        (4, "setup.cfg cannot be read", "name=value"),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", STOPS)
def test_setup_stops(case: str, package: Path) -> None:
    (name, before, after), (line, message, hint) = STOPS[case]
    edit(package / name, before, after)
    diagnostic = explained(package, FROM_COLCON)
    assert (diagnostic.code, diagnostic.file, diagnostic.line) == ("BLD040", package / name, line)
    assert message in diagnostic.message
    assert hint in (diagnostic.hint or "")


@pytest.mark.slow
def test_each_package_has_its_own_cause(package: Path) -> None:
    """`colcon` mixes what the setup.py of all packages print."""
    for number, text in enumerate(("version=", "1 / 0")):
        copy = shutil.copytree(package, package.with_name(f"copy_{number}"))
        edit(copy / "package.xml", f"<name>{NAME}<", f"<name>{copy.name}<")
        edit(copy / "setup.py", "package_name =", f"{text}\npackage_name =")
    edit(package / "setup.py", "import os\n", "import os\n\nraise RuntimeError('mine')\n")
    (package / "CMakeLists.txt").write_text("")  # does not make it a package of CMake
    result = build_here(package.parents[1], colcon_arguments=("--continue-on-error",))
    found = {diagnostic.element: diagnostic for diagnostic in result.diagnostics}
    assert {diagnostic.code for diagnostic in found.values()} == {"BLD040"}
    assert (found[NAME].line, "mine" in found[NAME].message) == (3, True)
    assert (found["copy_0"].line, "SyntaxError" in found["copy_0"].message) == (5, True)
    assert (found["copy_1"].line, "ZeroDivisionError" in found["copy_1"].message) == (5, True)


@pytest.mark.slow
@pytest.mark.parametrize("link", [(), ("--symlink-install",)])
def test_a_folder_in_data_files(link: tuple[str, ...], package: Path) -> None:
    (package / "urdf" / "parts").mkdir()
    (diagnostic,) = build_here(package.parents[1], colcon_arguments=link).diagnostics
    assert (diagnostic.code, diagnostic.line) == ("BLD041", 16)
    assert "urdf/parts, which is a folder" in diagnostic.message


def test_no_setup(package: Path) -> None:
    (package / "setup.py").unlink()
    diagnostic = explained(package, "AssertionError: Expected [...] to pass")
    assert (diagnostic.code, diagnostic.hint) == (
        "BLD021",
        "Restore it (git checkout setup.py), or write one.",
    )
    (package / "CMakeLists.txt").write_text("")
    assert "<build_type>ament_cmake</build_type>" in (explained(package, "").hint or "")
