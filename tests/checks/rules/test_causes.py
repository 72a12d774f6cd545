"""What of a run is folded into the diagnostic about the description that explains it."""

from __future__ import annotations

import pytest

from wsgen.checks.rules.catalogue import all_rules
from wsgen.checks.rules.consequences import (
    CONSEQUENCES,
    explains_no_drive,
    fold_consequences,
    joints_beyond_limits,
)
from wsgen.diagnostics import Diagnostic, Severity

ERROR, WARNING, INFO = Severity


def about(code: str, severity: Severity = WARNING, element: str = "robot") -> Diagnostic:
    return Diagnostic(
        name="some-rule", code=code, severity=severity, message=f"About {code}.", element=element
    )


def folded(*prepared: Diagnostic, run: Diagnostic) -> bool:
    return not fold_consequences(prepared, [run]).run


def test_the_cause_takes_over_severity_and_message() -> None:
    run = [about("SPN065", WARNING), about("SPN061", ERROR), about("SPN055", ERROR)]
    (cause,), left = fold_consequences([about("ROB049")], run)
    assert left == ()
    assert (cause.code, cause.severity) == ("ROB049", ERROR)
    assert cause.message == "About ROB049. In the simulation, about SPN061."


def test_a_consequence_that_names_its_engine_is_not_put_into_another_sentence() -> None:
    falls = Diagnostic(
        name="some-rule", code="SPN056", severity=ERROR, message="In DART: The robot falls."
    )
    (cause,), _ = fold_consequences([about("ROB053")], [falls])
    assert cause.message == "About ROB053. In DART: The robot falls."


def test_an_information_makes_no_warning_of_a_cause_and_none_harmless() -> None:
    (cause,), _ = fold_consequences([about("ROB070", INFO)], [about("SPN061", WARNING)])
    assert cause.severity is WARNING
    (cause,), _ = fold_consequences([about("ROB053", ERROR)], [about("SPN056", WARNING)])
    assert cause.severity is ERROR


def test_what_nothing_explains_stays() -> None:
    prepared = [about("ROB053"), about("ROB052")]
    run = [about("SPN059", ERROR), about("SPN060", INFO), about("SPN056", ERROR)]
    result = fold_consequences(prepared, run)
    assert [found.code for found in result.run] == ["SPN059", "SPN060"]
    assert [found.severity for found in result.prepared] == [ERROR, WARNING]


def test_one_consequence_has_one_cause_the_first_of_the_table() -> None:
    inertias = [about("ROB050", element=f"link[@name='{name}']/inertial/inertia") for name in "ab"]
    prepared = [*inertias, about("ROB049")]
    result = fold_consequences(prepared, [about("SPN061", ERROR)])
    assert [found.severity for found in result.prepared] == [WARNING, WARNING, ERROR]
    result = fold_consequences(inertias, [about("SPN061", ERROR)])
    assert [found.severity for found in result.prepared] == [ERROR, WARNING]


def test_a_warning_about_motion_has_its_cause_in_joints_that_are_not_actuated() -> None:
    assert folded(about("ROB050"), run=about("SPN058", ERROR))
    assert not folded(about("ROB050"), run=about("SPN058", WARNING))


@pytest.mark.parametrize(
    ("code", "element", "explains"),
    [
        ("ROB038", "link[@name='a']/colision", True),
        ("ROB038", "link[@name='visual']/colision", True),
        ("ROB038", "link[@name='a/visual']/colision", True),
        ("ROB038", "joint[@name='a']/orgin", True),
        ("ROB038", "gazebo/statc", True),
        ("ROB038", "/sdf/model[@name='m']/link[@name='a']/pse", True),
        ("ROB077", "/sdf/model[@name='m']/link[@name='a']/collision[@name='c']/pose", True),
        ("ROB066", "link[@name='a']/collision/geometry/mesh", True),
        ("ROB060", "link[@name='a']/collision/geometry/mesh", True),
        ("ROB040", "link[@name='a']", True),
        # The parser does not read what comes behind it, either.
        ("ROB024", "link[@name='a']/visual/geometry", True),
        ("ROB016", "link[@name='a']/visual/origin/@xyz", True),
        ("ROB016", "material[@name='m']/color/@rgba", False),
        ("ROB038", "link[@name='a']/visaul", False),
        ("ROB077", "link[@name='a']/visual/origin/@xzy", False),
        ("ROB038", "transmision", False),
        ("ROB038", "gazebo/plugn", False),
        ("ROB077", "robot/@versoin", False),
        ("ROB038", "/sdf/model[@name='m']/link[@name='a']/visual[@name='v']/pse", False),
        ("WLD031", "/sdf/model[@name='m']/link[@name='a']/visual[@name='v']/geometry", False),
        ("ROB066", "link[@name='a']/visual/geometry/mesh", False),
    ],
)
def test_what_is_only_seen_explains_no_motion(code: str, element: str, *, explains: bool) -> None:
    cause = about(code, element=element)
    assert folded(cause, run=about("SPN056", ERROR)) is explains


def test_joints_that_their_limits_move() -> None:
    limit = "joint[@name='lift']/limit"
    prepared = [about("ROB070", element=limit), about("ROB023", element="joint[@name='x']/limit")]
    assert joints_beyond_limits(prepared) == {"lift"}


def test_the_table_is_about_rules_that_exist() -> None:
    codes = {rule.code for rule in all_rules()}
    for row in CONSEQUENCES:
        follows = {*row.follows, *row.errors}
        assert {row.cause, *follows} <= codes
        assert not row.cause.startswith("SPN")
        assert follows
        assert all(code.startswith("SPN") for code in follows)
    causes = [row.cause for row in CONSEQUENCES]
    assert len(causes) == len(set(causes))


def test_what_keeps_a_drive_from_working() -> None:
    drive = "gazebo/plugin[@filename='libgazebo_ros_diff_drive.so']/left_joint"
    assert explains_no_drive(about("ROB102", ERROR, drive))
    assert explains_no_drive(about("ROB040", ERROR, "link[@name='wheel']"))
    assert not explains_no_drive(about("ROB102", WARNING, drive))
    laser = "gazebo/plugin[@filename='libgazebo_ros_ray_sensors.so']"
    assert not explains_no_drive(about("ROB100", ERROR, laser))


@pytest.mark.parametrize(
    ("code", "element", "explains"),
    [
        ("ROB144", "link[@name='wheel']/collision", True),
        ("ROB134", "plugin[@name='d']/wheel_radius", True),
        ("ROB103", "gazebo/plugin[@filename='gz-sim-diff-drive-system']/wheel_radus", True),
        ("ROB103", "gazebo/plugin[@filename='gz-sim-imu-system']/topik", False),
        ("ROB053", "robot", False),
    ],
)
def test_why_a_robot_does_not_drive_as_commanded(
    code: str, element: str, *, explains: bool
) -> None:
    short = about("SPN085", ERROR, "behavior `drives`")
    assert folded(about(code, element=element), run=short) is explains
