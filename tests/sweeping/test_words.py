"""What a user writes about what varies."""

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsgen.errors import RequestError
from wsgen.model.sweep import Axis, Distribution
from wsgen.sweeping.parameters import write_value
from wsgen.sweeping.words import (
    DEFAULT_SAMPLES,
    make_axis,
    make_design,
    read_axes,
    read_axis,
    read_distribution,
    read_distributions,
)


def values(text: str) -> tuple[object, ...]:
    return read_axis("x", text).values


def test_a_range_has_both_ends_and_no_rounding() -> None:
    assert values("0:0.6:7") == (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
    assert values("1:-1:3") == (1, 0, -1)
    assert [type(one) for one in values("0:10:3")] == [int] * 3
    assert [type(one) for one in values("0:1:3")] == [float] * 3
    assert [type(one) for one in values("0.0:10:3")] == [float] * 3
    assert values(" 1e-3 : 3e-3 : 3 ") == (0.001, 0.002, 0.003)


def test_degrees_become_radians() -> None:
    assert values("0:30deg:4") == tuple(math.radians(angle) for angle in (0, 10, 20, 30))
    assert values("-5deg:5deg:3") == (math.radians(-5), 0.0, math.radians(5))
    assert values("90deg, 180 deg") == (math.pi / 2, math.pi)
    drawn = read_distribution("x", "uniform(-10deg, 10deg)")
    assert drawn.numbers == (math.radians(-10), math.radians(10))


def test_values_are_numbers_if_all_are() -> None:
    assert values("1,2,5") == (1, 2, 5)
    assert values("1, 2.5") == (1.0, 2.5)
    assert values("1, two") == ("1", "two")
    assert values("true,false") == ("true", "false")
    assert values("'1',2") == ("1", "2")
    assert values("bullet") == ("bullet",)
    assert values('"a, b", c') == ("a, b", "c")
    assert values('"it\'s"') == ("it's",)
    assert values('"model://sun"') == ("model://sun",)
    assert values('""') == ("",)


def test_distributions() -> None:
    assert read_distributions(["a=uniform(0.5, 2)", "b = Normal(1,0.1)"]) == (
        Distribution(name="a", kind="uniform", numbers=(0.5, 2.0)),
        Distribution(name="b", kind="normal", numbers=(1.0, 0.1)),
    )
    assert read_distribution("c", "choice(1, 2, 5)").choices == (1, 2, 5)
    assert read_distribution("c", "choice('a(b)', c)").choices == ("a(b)", "c")
    assert read_distribution("d", "loguniform(1e-3,10)").numbers == (0.001, 10.0)


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("a", "`=` is missing"),
        ("=1", "the name is missing"),
        ("a=", "no value is given"),
        ("a=  ", "no value is given"),
        ("a=1,,2", "is empty"),
        ("a=1,", "is empty"),
        ("a='x", "a quote is missing"),
        ("a=x'y'", "a quote is missing"),
        ("a=nan", "nan cannot be simulated"),
        ("a=1,-inf", "-inf cannot be simulated"),
        ("a=1e999", "too large"),
        ("a=1,1", "1 is given twice"),
        ("a=1,1.0", "1.0 is given twice"),
        ("a=x,x", "x is given twice"),
        ("a=0:1", "three parts, START:STOP:COUNT"),
        ("a=0:1:", "three parts, START:STOP:COUNT"),
        ("a=0:1:2:3", "three parts, START:STOP:COUNT"),
        ("a=0:x:3", "'x' is not a number"),
        ("a=0:nan:3", "nan cannot be simulated"),
        ("a=0:1:0", "COUNT is 0"),
        ("a=0:1:1", "COUNT is 1"),
        ("a=0:1:-3", "COUNT is -3"),
        ("a=0:1:2.5", "is not an integer"),
        ("a=0:1:100000000000000000000", "COUNT is 1"),
        ("a=1:1:5", "are equal"),
        ("a=1:1.0000000000000002:5", "too near to each other"),
        ("a=10:20deg:3", "one end is in degrees"),
        ("a=uniform(1,2)", "a distribution has no place in a grid"),
    ],
)
def test_an_axis_that_is_none(word: str, message: str) -> None:
    with pytest.raises(RequestError) as caught:
        read_axes([word])
    assert message in caught.value.message
    assert word in caught.value.message
    assert caught.value.hint


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("a=1,2", "a distribution is a name with numbers in parentheses"),
        ("a=", "a distribution is a name with numbers in parentheses"),
        ("a=uniform(1,2", "a distribution is a name with numbers in parentheses"),
        ("a=unifrom(1,2)", "not have the distribution `unifrom`"),
        ("a=uniform()", "no value is given"),
        ("a=uniform(1)", "not 1 number"),
        ("a=uniform(1,2,3)", "not 3 numbers"),
        ("a=uniform(x,1)", "'x' is not a number"),
        ("a=uniform('0',1)", "'0' is not a number"),
        ("a=uniform(1,1)", "not less than HIGH"),
        ("a=normal(1,0)", "is not greater than 0"),
        ("a=normal(1,-2)", "is not greater than 0"),
        ("a=normal(nan,1)", "nan cannot be simulated"),
        ("a=loguniform(0,1)", "has no logarithm"),
        ("a=loguniform(-1,1)", "has no logarithm"),
        ("a=choice()", "no value is given"),
        ("a=choice(1,1)", "given twice"),
    ],
)
def test_a_distribution_that_is_none(word: str, message: str) -> None:
    with pytest.raises(RequestError) as caught:
        read_distributions([word])
    assert message in caught.value.message
    assert word in caught.value.message


HUGE, LONG = "1" + 400 * "0", 5_000 * "7"


@pytest.mark.parametrize(
    "text",
    [
        f"{HUGE},1",
        f"1.5,-{HUGE}",
        f"0:{HUGE}:3",
        f"-{HUGE}:1.5:3",
        f"0:1:{LONG}",
        f"{LONG}",
        f"{LONG}deg,1",
        f"0:{LONG}:3",
        "9223372036854775808,1",
        "-9223372036854775809",
        "0:9223372036854775808:2",
    ],
)
def test_numbers_that_nothing_can_hold(text: str) -> None:
    with pytest.raises(RequestError, match=r"is too large|64 bits|COUNT is 7") as caught:
        read_axis("x", text)
    assert len(caught.value.message) < 600
    assert caught.value.hint
    for kind in ("uniform(0,{})", "choice(1,{})"):
        with pytest.raises(RequestError, match=r"is too large|64 bits"):
            read_distribution("x", kind.format(LONG))
    with pytest.raises(RequestError, match="64 bits"):
        make_axis("x", [10**400, 1], "x")


def test_numbers_that_are_just_not_too_large() -> None:
    assert values("9223372036854775807,-9223372036854775808") == (2**63 - 1, -(2**63))
    assert values("1e20,1.5") == (1e20, 1.5)
    assert values(f"{5_000 * '0'}1") == (1,)
    assert values(f"0:0.{5_000 * '3'}:2") == (0.0, 1 / 3)
    assert values("1:1e-999999999:3") == (1.0, 0.5, 0.0)
    assert values(f"'{HUGE}'") == (HUGE,)
    with pytest.raises(RequestError, match=r"the difference of LOW, -1e.308, and HIGH"):
        read_distribution("x", "uniform(-1e308,1e308)")


def test_hints_ask_for_what_was_meant() -> None:
    with pytest.raises(RequestError, match="Did you mean `uniform`"):
        read_distribution("a", "unifrom(1,2)")
    with pytest.raises(RequestError, match=r"--random 'a=uniform\(1,2\)'"):
        read_axis("a", "uniform(1,2)")


def test_a_name_varies_once() -> None:
    with pytest.raises(RequestError, match="a varies twice"):
        read_axes(["a=1,2", "a=3,4"])
    with pytest.raises(RequestError, match="a varies twice"):
        make_design(read_axes(["a=1,2"]), read_distributions(["a=uniform(1,2)"]))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"samples": 10}, "--samples has no effect"),
        ({"samples": 10, "seed": 1}, "--samples and --seed have no effect"),
        ({"sampler": "lhs"}, "--sampler has no effect"),
    ],
)
def test_options_of_samples_need_something_random(options: dict[str, int], message: str) -> None:
    axes = read_axes(["a=1,2"])
    with pytest.raises(RequestError, match=message):
        make_design(axes, (), **options)  # type: ignore[arg-type]
    assert make_design(axes, ()).samples == 1


@pytest.mark.parametrize(
    "options",
    [{"samples": 0}, {"samples": 10**8}, {"sampler": "sobel"}, {"seed": -1}, {"seed": 2**64}],
)
def test_options_of_samples_that_are_out_of_bounds(options: dict[str, int]) -> None:
    random = read_distributions(["a=uniform(1,2)"])
    with pytest.raises(RequestError, match=f"--{next(iter(options))}"):
        make_design((), random, **options)  # type: ignore[arg-type]
    assert make_design((), random).samples == DEFAULT_SAMPLES


numbers = st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(10**12), 10**12)


@pytest.mark.slow
@given(st.lists(numbers, min_size=1, max_size=5, unique=True))
def test_any_numbers_are_read_as_they_are_written(given_values: list[float]) -> None:
    text = ",".join(map(write_value, given_values))
    assert values(text) == tuple(given_values)


@pytest.mark.slow
@given(st.lists(st.text(st.characters(exclude_characters='"')), min_size=1, unique=True))
def test_any_text_is_read_in_quotes(texts: list[str]) -> None:
    assert values(",".join(f'"{text}"' for text in texts)) == tuple(texts)


@pytest.mark.slow
@given(st.text())
def test_any_word_is_read_or_refused_with_a_hint(word: str) -> None:
    for read in (read_axis, read_distribution):
        try:
            read("x", word)
        except RequestError as error:  # noqa: PERF203  few words are read
            assert error.hint  # noqa: PT017


@pytest.mark.slow
@given(
    st.floats(-1e6, 1e6).filter(lambda one: abs(one) > 1e-3),
    st.integers(2, 50),
)
def test_the_steps_of_a_range_are_equal(stop: float, count: int) -> None:
    found = values(f"0:{stop!r}:{count}")
    assert len(found) == count
    assert (found[0], found[-1]) == (0, stop)
    exact = [Fraction(stop) * place / (count - 1) for place in range(count)]
    assert found == pytest.approx([float(one) for one in exact], rel=1e-15)


def test_names_may_be_anything_without_an_equals_sign() -> None:
    assert read_axes(["a.b-c d=x=y"]) == (Axis(name="a.b-c d", values=("x=y",)),)
