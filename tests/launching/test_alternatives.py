"""The values of arguments that are tried for a launch file that fails without them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from wsgen.launching.evaluate import MOST_TRIED, alternatives, evaluate, with_assumed

if TYPE_CHECKING:
    from install_space import InstallSpace
    from wsgen.model.plan import LaunchArgument


def tried(space: InstallSpace, entities: str, **given: str) -> list[dict[str, str]]:
    plan = space.play(entities, arguments=given)

    def ask() -> tuple[LaunchArgument, ...]:
        file, prefix = plan.launch_file, str(space.prefix)
        return evaluate(
            file,
            package="my_robot",
            arguments=given,
            environment={"AMENT_PREFIX_PATH": prefix},
            only_arguments=True,
        ).arguments

    return list(alternatives(plan, given, ask))


DECLARED = "DeclareLaunchArgument('x'{}), {}"
EXPRESSION = "LogInfo(msg='a', condition=IfCondition(PythonExpression([{}])))"
READ = "LaunchConfiguration('x')"
QUOTED = "\"'\", LaunchConfiguration('x'), \"' == 'arm'\""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("declared", "used", "values"),
    [
        (", choices=['a', 'b']", "", ["a", "b"]),
        (", description='\"one\" or `two`'", "", ["one", "two"]),
        ("", f"LogInfo(msg='a', condition=UnlessCondition({READ}))", ["true", "false"]),
        ("", EXPRESSION.format(f"'not ', {READ}"), ["True", "False"]),
        ("", EXPRESSION.format(QUOTED), ["arm"]),
        ("", "LogInfo(msg='', condition=LaunchConfigurationEquals('x', 'arm'))", ["arm"]),
        (", description='name of the robot'", f"LogInfo(msg={READ})", []),
        (f", choices=[str(n) for n in range({MOST_TRIED} * 2)]", "", [*map(str, range(6))]),
    ],
)
def test_an_argument_without_a_value(
    space: InstallSpace, declared: str, used: str, values: list[str]
) -> None:
    found = tried(space, DECLARED.format(declared, used))
    assert found == [{"x": value} for value in values]


@pytest.mark.slow
def test_several_arguments_are_given_together(space: InstallSpace) -> None:
    both = (
        "DeclareLaunchArgument('x', choices='ab'.split('x') + ['c']), DeclareLaunchArgument('y'{})"
    )
    assert tried(space, both.format(", choices=['d']")) == [
        {"x": "ab", "y": "d"},
        {"x": "c", "y": "d"},
    ]
    assert tried(space, both.format("")) == []  # nothing says what `y` may be
    assert tried(space, both.format(""), y="z") == [{"x": "ab"}, {"x": "c"}]


@pytest.mark.slow
def test_a_truth_value_of_launch_that_python_reads(space: InstallSpace) -> None:
    default = "DeclareLaunchArgument('x', default_value='true'), {}"
    wrong = default.format(EXPRESSION.format(f"'not ', {READ}"))
    assert tried(space, wrong) == [{"x": "True"}]
    assert tried(space, wrong, x="false") == []
    plan = space.play(wrong)
    assert [found.code for found in plan.diagnostics] == ["LCH030"]
    assert "x is no" not in plan.diagnostics[0].message
    assert "True as the value" in (plan.diagnostics[0].hint or "")
    other = space.play(wrong, arguments={"x": "True"})
    found = with_assumed(other, plan, {"x": "True"})
    assert [one.code for one in found.diagnostics] == ["LCH030", "LCH092"]
    assert "x:=True" in found.diagnostics[1].message


@pytest.mark.slow
def test_an_empty_default(space: InstallSpace) -> None:
    entities = (
        "DeclareLaunchArgument('x', default_value='', description=\"'one'\"), "
        f"LogInfo(msg='', condition=IfCondition({READ}))"
    )
    assert tried(space, entities) == [{"x": "one"}, {"x": "true"}, {"x": "false"}]


@pytest.mark.slow
def test_other_failures_are_left_alone(space: InstallSpace) -> None:
    assert tried(space, "DeclareLaunchArgument('x', default_value='true'), no_name") == []
    assert tried(space, f"LogInfo(msg={READ})") == []
