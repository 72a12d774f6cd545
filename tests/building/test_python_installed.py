"""What is wrong in ament_python packages that build, and what is left out of the output."""

import shutil
from collections.abc import Sequence
from pathlib import Path

import pytest

from building.building import build_here
from kind_workspaces import WORKSPACES
from wsgen.building.installed import check_python_packages, without_warnings
from wsgen.building.run import BuildResult
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.packages.workspace.layout import Workspace, read_package

NAME = "beetle_bringup"


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """The folder of a Python package, in a workspace of its own."""
    shutil.copytree(WORKSPACES / "python_package", tmp_path, dirs_exist_ok=True)
    return tmp_path / "src" / NAME


def edit(file: Path, before: str, after: str) -> None:
    text = file.read_text()
    assert before in text
    file.write_text(text.replace(before, after))


def install(package: Path, script: str, *, folder: str = f"lib/{NAME}") -> None:
    """Leave what colcon and setuptools leave that is looked at."""
    root = package.parents[1]
    prefix = root / "install" / NAME
    for file in (
        prefix / "share" / NAME / "package.sh",
        prefix / folder / "drive_in_circles",
        prefix / "lib" / "python3.11" / "site-packages" / NAME / "__init__.py",
    ):
        file.parent.mkdir(parents=True)
        file.touch()
    shutil.copy(package / NAME / "drive_in_circles.py", file.parent)
    entries = root / "build" / NAME / f"{NAME}.egg-info" / "entry_points.txt"
    entries.parent.mkdir(parents=True)
    entries.write_text(f"[console_scripts]\ndrive_in_circles = {script}\n")


def check(package: Path, *output: str) -> list[Diagnostic]:
    found = read_package(package)
    assert found is not None
    workspace = Workspace(root=package.parents[1])
    return [*check_python_packages([found], workspace, {found.name: output})]


# What the console script starts; words of the message and of the hint.
TARGETS = {
    "function": (f"{NAME}.drive_in_circles:mian", "has no function mian", "Did you mean `main`?"),
    "no function": (f"{NAME}.drive_in_circles", "does not name a function", ":main, if that"),
    "module": (f"{NAME}.drive:main", "drive does not exist", "Did you mean"),
    "package": ("beetle_bring.x:main", "beetle_bring.x does not exist", "Define it"),
    "not installed": (f"{NAME}.new:main", "new is not installed", f"Create {NAME}/__init__.py"),
}


@pytest.mark.parametrize("case", TARGETS)
def test_a_script_that_cannot_start(case: str, package: Path) -> None:
    target, message, hint = TARGETS[case]
    (package / NAME / "new.py").touch()
    install(package, target)
    (diagnostic,) = check(package)
    assert (diagnostic.code, diagnostic.severity) == ("BLD043", Severity.WARNING)
    assert (diagnostic.file, diagnostic.line) == (package / "setup.py", 29)
    assert message in diagnostic.message
    assert hint in (diagnostic.hint or "")


@pytest.mark.parametrize("target", [f"{NAME}.drive_in_circles:main", "other_package.node:main"])
def test_a_script_that_starts(target: str, package: Path) -> None:
    install(package, target)
    assert check(package) == []


@pytest.mark.parametrize("has_cfg", [True, False])
def test_scripts_in_bin(has_cfg: bool, package: Path) -> None:
    if not has_cfg:
        (package / "setup.cfg").unlink()
    install(package, f"{NAME}.drive_in_circles:main", folder="bin")
    (diagnostic,) = check(package)
    place = (package / "setup.cfg", 4) if has_cfg else (package / "setup.py", None)
    assert (diagnostic.code, diagnostic.file, diagnostic.line) == ("BLD043", *place)
    assert f"into bin, not lib/{NAME}" in diagnostic.message
    assert f"install_scripts=$base/lib/{NAME}" in (diagnostic.hint or "")


def test_a_misspelt_argument(package: Path) -> None:
    edit(package / "setup.py", "data_files", "data_file")
    (diagnostic,) = check(
        package,
        *(
            f"/x/setuptools/dist.py:9: UserWarning: Unknown distribution option: '{name}'"
            for name in ("data_file", "tests_require")
        ),
    )
    assert (diagnostic.code, diagnostic.line) == ("BLD044", 11)
    assert diagnostic.hint == "Did you mean `data_files`?"


SHORT = (
    "/x/setuptools/dist.py:7: UserWarning: Usage of dash-separated 'script-dir' will not be",
    "  warnings.warn(",
)
LONG = (
    "/x/setuptools/dist.py:5: SetuptoolsDeprecationWarning: Invalid dash-separated key 'x-y'.",
    "!!",
    "",
    "        ****************",
    "        Usage of dash-separated 'install-scripts' will not be supported in future",
    "        ****************",
    "",
    "!!",
    "  opt = self._enforce_underscore(opt, section)",
)


def test_dashes_are_reported_once(package: Path) -> None:
    edit(package / "setup.cfg", "install_scripts", "install-scripts")
    (diagnostic,) = check(package, *LONG, *SHORT, *LONG)
    assert (diagnostic.severity, diagnostic.file) == (Severity.INFO, package / "setup.cfg")
    assert diagnostic.line == 4
    assert diagnostic.hint == "Write install_scripts, script_dir."


@pytest.mark.parametrize(
    "warning", [SHORT, LONG, ("warning: build_py: byte-compiling is disabled", "")]
)
def test_warnings_are_left_out(warning: Sequence[str]) -> None:
    assert without_warnings(["before", *warning, "after", "  more"]) == [
        "before",
        "after",
        "  more",
    ]


def built(package: Path) -> BuildResult:
    return build_here(package.parents[1])


@pytest.mark.slow
def test_a_real_build(package: Path) -> None:
    (package / "setup.cfg").unlink()
    result = built(package)
    assert result.succeeded
    assert [found.code for found in result.diagnostics] == ["BLD043"]
    assert result.unexplained_output == ()


@pytest.mark.slow
def test_files_that_are_left(package: Path) -> None:
    assert built(package).diagnostics == ()
    (package / "urdf" / "wheel.xacro").rename(package / "urdf" / "wheels.xacro")
    (diagnostic,) = built(package).diagnostics
    assert diagnostic.code == "BLD024"
    assert "no longer installs: urdf/wheel.xacro." in diagnostic.message
    assert "data_files in setup.py" in (diagnostic.hint or "")
