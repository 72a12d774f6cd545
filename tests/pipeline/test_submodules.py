"""What is missing with a submodule that git has not fetched."""

from pathlib import Path

import pytest

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.launching.explain_missing import FILE_NOT_INSTALLED, PACKAGE_NOT_FOUND
from wsgen.pipeline.failed_builds import with_submodules

MODULES = """[submodule "sensors"]
\tpath = crane/parts/sensors
\turl = git@example.com:ada/sensors.git
[submodule "crane_msgs"]
\tpath = crane_msgs
\turl = ../crane_msgs.git
"""


PARTS = "crane/parts/sensors"


def found(code: str, message: str) -> Diagnostic:
    return Diagnostic(name="n", code=code, severity=Severity.ERROR, message=message, hint="Look.")


@pytest.fixture
def package(tmp_path: Path) -> Path:
    (tmp_path / ".gitmodules").write_text(MODULES)
    (tmp_path / "crane" / "parts" / "sensors").mkdir(parents=True)
    return tmp_path / "crane"


@pytest.mark.parametrize(
    ("code", "message", "path"),
    [
        (FILE_NOT_INSTALLED.code, "'/a/share/arm/parts/sensors/x' is not there.", PARTS),
        (FILE_NOT_INSTALLED.code, "'/a/crane/parts/sensors_2/x' is not there.", None),
        (FILE_NOT_INSTALLED.code, "'/a/crane/sensors/x' is not there.", None),
        (PACKAGE_NOT_FOUND.code, "The package 'crane_msgs' is not found.", "crane_msgs"),
        (PACKAGE_NOT_FOUND.code, "The package 'crane_msgs_py' is not found.", None),
        (PACKAGE_NOT_FOUND.code, "The package 'sensors' is not found.", PARTS),
        ("SPN056", "The model crane_msgs falls.", None),
    ],
)
def test_what_a_submodule_brings(
    package: Path, tmp_path: Path, code: str, message: str, path: str | None
) -> None:
    (one,) = with_submodules([found(code, message)], [package])
    if path is None:
        assert one.hint == "Look."
    else:
        command = "run `git submodule update --init --recursive`"
        assert one.hint == (f"git has not fetched the submodule {path}: {command} in {tmp_path}.")


def test_a_submodule_that_is_there(package: Path) -> None:
    (package / "parts" / "sensors" / "lidar.xacro").write_text("<robot/>")
    missing = found(FILE_NOT_INSTALLED.code, "'/a/crane/parts/sensors/x' is not there.")
    assert with_submodules([missing], [package]) == (missing,)
