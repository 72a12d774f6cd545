"""Which names vary, and which values they take."""

import math

import pytest

from wsgen.errors import RequestError
from wsgen.model.sweep import Design
from wsgen.sweeping.parameters import (
    OWN,
    Parameter,
    check_design,
    own_values,
    subject_values,
    write_value,
)
from wsgen.sweeping.words import make_design, read_axes, read_distributions

KNOWN = (
    Parameter(name="radius", kind="number", minimum=0.01, maximum=0.5, unit="m"),
    Parameter(name="wheels", kind="integer", minimum=2, maximum=6),
    Parameter(name="has_arm", kind="boolean"),
    Parameter(name="color", kind="choice", choices=("red", "3")),
    Parameter(name="title", kind="text"),
    Parameter(name="world", kind="any"),
)


def check(*over: str, random: tuple[str, ...] = (), samples: int | None = None) -> Design:
    design = make_design(read_axes(over), read_distributions(random), samples=samples)
    return check_design(design, KNOWN, subject="The template rover")


def refused(*over: str, random: tuple[str, ...] = (), samples: int | None = None) -> RequestError:
    with pytest.raises(RequestError) as caught:
        check(*over, random=random, samples=samples)
    return caught.value


def typed(design: Design) -> list[tuple[object, ...]]:
    return [axis.values for axis in design.axes]


def test_values_get_the_type_of_their_parameter() -> None:
    design = check(
        "radius=0.1,0.2",
        "wheels=2:6:3",
        "has_arm=true,FALSE",
        "color=red,3",
        "title=1,2",
        "world=1,2",
        "world.slope=0,1",
    )
    assert typed(design) == [
        (0.1, 0.2),
        (2, 4, 6),
        (True, False),
        ("red", "3"),
        ("1", "2"),
        (1, 2),
        (0.0, 1.0),
    ]
    assert all(isinstance(one, float) for one in design.axes[-1].values)
    assert typed(check("wheels=2.0,4.0")) == [(2, 4)]
    assert check(random=("has_arm=choice(true,false)",)).distributions[0].choices == (True, False)


def test_an_unknown_name() -> None:
    error = refused("radus=1,2")
    assert "The template rover has no parameter `radus`" in error.message
    assert error.hint.startswith("Did you mean `radius`?")
    assert "wheels" in error.hint
    assert "wsgen sweep --help" in error.hint
    many = [Parameter(name=f"p{number}") for number in range(20)]
    with pytest.raises(RequestError, match="p11 and 8 more"):
        check_design(make_design(read_axes(["xyz=1,2"]), ()), many, subject="The file x")
    assert "Did you mean `world.friction`?" in refused("world.fricton=1,2").hint
    assert "Did you mean" not in refused("xyz=1,2").hint


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("radius=0.1,0.6", "0.6 is not allowed; it must be a number from 0.01 to 0.5 m"),
        ("radius=a,b", "a is not allowed; it must be a number"),
        ("wheels=2,7", "7 is not allowed; it must be an integer from 2 to 6"),
        ("wheels=2.5,3", "2.5 is not allowed; it must be an integer"),
        ("has_arm=yes,no", "yes is not allowed; it must be true or false"),
        ("color=red,blue", "blue is not allowed; it must be one of red, 3"),
        ("has_arm=1,true", "two of its values are the same"),
        ("world.friction=-0.1,1", "must be a number from 0"),
        ("world.slope=0:90deg:2", "less than pi/2 rad"),
        ("world.gravity=-9.8", "must be a number from 0 to 1000 m/s²"),
        ("robot.mass_scale=0,1", "greater than 0 and less than 1,000,000"),
        ("world.friction=1000001", "1,000,001 is not allowed; it must be a number from 0 to 1,000"),
        ("push.force=1e300", "1e+300 is not allowed; it must be a number from 0 to 1,000,000,000"),
        ("robot.mass_scale=x", "x is not allowed"),
    ],
)
def test_values_out_of_bounds_are_refused_before_anything_runs(word: str, expected: str) -> None:
    error = refused(word)
    assert expected in error.message
    assert word.partition("=")[0] in error.message
    assert error.hint


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("radius=uniform(0.1,0.6)", "0.6 is not allowed"),
        ("robot.mass_scale=uniform(-1,2)", "-1 is not allowed"),
        ("wheels=uniform(2,6)", "uniform draws any number, and wheels must be an integer"),
        ("has_arm=normal(1,2)", "must be true or false"),
        ("color=choice(red,green)", "green is not allowed"),
    ],
)
def test_distributions_out_of_bounds(word: str, expected: str) -> None:
    assert expected in refused(random=(word,)).message


def test_a_normal_distribution_is_checked_by_what_it_draws() -> None:
    wide = ("robot.mass_scale=normal(1,0.3)",)
    assert check(random=wide, samples=5)
    error = refused(random=wide, samples=10_000)
    assert "normal(1, 0.3) draws -" in error.message
    assert "greater than 0" in error.message
    assert "loguniform" in error.hint
    assert check(random=("world=normal(0,1e9)",), samples=1000)


@pytest.mark.parametrize("name", ["world", "radius"])
def test_a_normal_distribution_draws_finite_numbers(name: str) -> None:
    error = refused(random=(f"{name}=normal(1e308,1e308)",))
    assert "normal(1e+308, 1e+308) draws" in error.message
    assert "smaller deviation" in error.hint
    assert check(random=("world=normal(1e307,1e300)",))


def test_integers_keep_their_digits() -> None:
    number = Parameter(name="id", kind="integer")
    for word, expected in (("id=9007199254740993", 2**53 + 1), ("id=8.0", 8)):
        design = make_design(read_axes([word]), ())
        (axis,) = check_design(design, [number], subject="The file x").axes
        assert axis.values == (expected,)
    with pytest.raises(RequestError, match="must be an integer"):
        check_design(make_design(read_axes(["id=1e300"]), ()), [number], subject="The file x")


def test_a_parameter_with_the_name_of_one_of_wsgen() -> None:
    known = [Parameter(name="world.slope", kind="number")]
    design = make_design(read_axes(["world.slope=0,1"]), ())
    with pytest.raises(RequestError, match=r"has a parameter `world\.slope`") as caught:
        check_design(design, known, subject="The file x")
    assert "Rename the argument, for example `world_slope`" in caught.value.hint
    other = make_design(read_axes(["world.friction=0,1"]), ())
    assert check_design(other, known, subject="The file x").names == ("world.friction",)


def test_a_push_needs_a_force() -> None:
    for word in ("push.direction=0:1:3", "push.seconds=0.1,0.2"):
        assert "has no effect without push.force" in refused(word).message
        assert check(word, "push.force=10,20")
    assert check(random=("push.force=uniform(0,10)", "push.direction=uniform(-3,3)"))


def test_the_own_parameters_are_documented() -> None:
    assert len({one.name for one in OWN}) == len(OWN)
    assert all(one.meaning and one.kind == "number" for one in OWN)
    for one in OWN:
        assert one.default is None or one.is_within(float(one.default)) or not one.default
        assert math.isfinite(one.minimum)
        assert math.isfinite(one.maximum)


def test_values_are_split_and_written() -> None:
    values = {"world.slope": 0.1, "radius": 0.2, "push.force": 3}
    assert own_values(values) == {"world.slope": 0.1, "push.force": 3.0}
    assert subject_values(values) == {"radius": 0.2}
    assert [write_value(one) for one in (True, 0.1, 3, "x", 1e-9)] == [
        "true",
        "0.1",
        "3",
        "x",
        "1e-09",
    ]
