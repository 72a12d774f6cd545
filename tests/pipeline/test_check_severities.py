"""What `wsgen check` reports of packages that are not on this machine."""

from pathlib import Path

import pytest

from wsgen.descriptions.rules import MISSING_COLLISION_MESH, MISSING_VISUAL_MESH
from wsgen.descriptions.xacro.reader import XACRO_FILE_FAILS
from wsgen.diagnostics import Diagnostic
from wsgen.launching.explain_missing import PACKAGE_NOT_FOUND
from wsgen.pipeline.check_severities import without_absent_packages

ROBOT = Path("r.xacro")


def not_found(package: str) -> list[Diagnostic]:
    """Of two meshes, and of an include that is reported twice."""
    problem = f"is in the package `{package}`, which was not found"
    missing = f"package '{package}' is not found"
    return [
        MISSING_COLLISION_MESH.at(ROBOT, 3, message=f"The mesh `m` {problem}.", hint=""),
        MISSING_VISUAL_MESH.at(ROBOT, 2, message=f"The mesh `m` {problem}.", hint=""),
        PACKAGE_NOT_FOUND.at(ROBOT, 5, message=f"The {missing}.", hint=""),
        XACRO_FILE_FAILS.at(ROBOT, 5, message=f"xacro cannot expand: the {missing}.", hint=""),
    ]


@pytest.mark.parametrize(
    ("package", "expected"),
    [
        ("customer_arm", ["info", "info", "info"]),  # declared
        ("ur_description", ["info", "info", "info"]),  # released
        ("my_arm", ["warning", "warning", "error"]),
    ],
)
def test_packages_that_others_have(package: str, expected: list[str]) -> None:
    found = list(without_absent_packages(not_found(package), {"customer_arm"}))
    assert [one.severity.value for one in found] == expected


def test_what_is_missing_in_a_package_that_is_here_stays_an_error() -> None:
    missing = MISSING_COLLISION_MESH.at(
        ROBOT, 3, message="The mesh `package://ur_description/m` does not exist.", hint=""
    )
    assert list(without_absent_packages([missing], {"ur_description"})) == [missing]
