"""Borders between passing and failing, where the answer is known."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from wsgen.sweeping.borders import Border, find_borders

Generator = np.random.Generator
Sampled = tuple[Any, Any]  # values and whether they pass
SEEDS = 200
SOME = 15  # seeds in the quick tests


def logistic(at: float, width: float, *, below: float = 1.0, above: float = 0.0) -> Any:
    """The share that passes changes along a logistic curve."""

    def make(chance: Generator, count: int) -> Sampled:
        x = chance.uniform(0, 1, count)
        share = below + (above - below) / (1 + np.exp(-(x - at) / width))
        return x, chance.uniform(size=count) < share

    return make


def measured(at: float, noise: float) -> Any:
    """What is compared with the border has normal noise."""

    def make(chance: Generator, count: int) -> Sampled:
        x = chance.uniform(0, 1, count)
        return x, x + chance.normal(0, noise, count) > at

    return make


def flipped(at: float, share: float) -> Any:
    """A step, and some runs that end in the other way by chance."""

    def make(chance: Generator, count: int) -> Sampled:
        x = chance.uniform(0, 1, count)
        return x, (x < at) ^ (chance.uniform(size=count) < share)

    return make


def shifted(at: float) -> Any:
    """Another parameter shifts the border."""

    def make(chance: Generator, count: int) -> Sampled:
        x = chance.uniform(0, 1, count)
        return x, x < at + 0.15 * chance.uniform(-1, 1, count)

    return make


def on_grid(at: float, noise: float, points: int) -> Any:
    """Each value occurs several times, as in a grid over several parameters."""

    def make(chance: Generator, count: int) -> Sampled:
        x = np.repeat(np.linspace(0, 1, points), count // points)
        return x, x + chance.normal(0, noise, len(x)) < at

    return make


def window(low: float, high: float, noise: float) -> Any:
    """What passes lies between two borders."""

    def make(chance: Generator, count: int) -> Sampled:
        x = chance.uniform(0, 1, count)
        shown = x + chance.normal(0, noise, count)
        return x, (shown > low) & (shown < high)

    return make


CASES: dict[str, tuple[Callable[[Generator, int], Sampled], list[float], bool]] = {
    "logistic": (logistic(0.43, 0.05), [0.43], True),
    "logistic near the end": (logistic(0.8, 0.04), [0.8], True),
    "some pass and some fail anyhow": (logistic(0.3, 0.03, below=0.9, above=0.2), [0.3], True),
    "normal noise": (measured(0.6, 0.1), [0.6], False),
    "a step": (flipped(0.3, 0.0), [0.3], True),
    "a step and 5 % by chance": (flipped(0.7, 0.05), [0.7], True),
    "a step and 20 % by chance": (flipped(0.5, 0.2), [0.5], True),
    "another parameter": (shifted(0.6), [0.6], True),
    "a coarse grid": (on_grid(0.47, 0.1, 5), [0.47], True),
    "a fine grid": (on_grid(0.47, 0.1, 25), [0.47], True),
    "two borders": (window(0.3, 0.7, 0.03), [0.3, 0.7], False),
}
# With all seeds; the others with a quarter of them.
THOROUGH = {"logistic", "a step and 5 % by chance", "another parameter", "a coarse grid"}


def covered(case: str, seeds: range, count: int) -> tuple[int, int]:
    """How many tables have the true borders in their intervals, and how many show borders."""
    make, truth, passes_below = CASES[case]
    hits = found = 0
    for seed in seeds:
        values, passed = make(np.random.default_rng(seed), count)
        borders = find_borders(values, passed, is_alone=False).borders
        if len(borders) != len(truth):
            continue
        found += 1
        assert borders[0].passes_below is passes_below
        assert all(border.low <= border.at <= border.high for border in borders)
        hits += all(
            border.low <= true <= border.high for border, true in zip(borders, truth, strict=True)
        )
    return hits, found


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_the_interval_has_the_truth(case: str) -> None:
    seeds = SEEDS if case in THOROUGH else SEEDS // 4
    hits, found = covered(case, range(seeds), 150)
    assert found >= 0.95 * seeds
    assert hits >= 0.9 * seeds


@pytest.mark.slow
@pytest.mark.parametrize("case", ["logistic", "a step and 5 % by chance", "a coarse grid"])
def test_the_interval_mostly_has_the_truth(case: str) -> None:
    hits, found = covered(case, range(1000, 1000 + SOME), 150)
    assert found == SOME
    assert hits >= SOME - 3


@pytest.mark.parametrize("case", ["logistic", "a step"])
def test_more_runs_say_more(case: str) -> None:
    make, (truth,), _ = CASES[case]
    widths = []
    for count in (50, 400, 3200):
        (border,) = find_borders(*make(np.random.default_rng(5), count), is_alone=False).borders
        assert abs(border.at - truth) < 0.1
        widths.append(border.high - border.low)
    assert widths[0] > 1.5 * widths[1] > 2.5 * widths[2]


def test_the_interval_is_not_idle() -> None:
    """Of a step among n values, it has some of them; of a curve, it is near what theory says."""
    chance = np.random.default_rng(1)
    make, _, _ = CASES["a step"]
    (border,) = find_borders(*make(chance, 1000), is_alone=False).borders
    assert border.high - border.low < 15 / 1000
    make, _, _ = CASES["logistic"]
    (border,) = find_borders(*make(chance, 1000), is_alone=False).borders
    # The information of a logistic curve of width w about its middle is n / (6 w) per unit length
    # where both of its ends are seen.
    deviation = math.sqrt(2 * 0.05 / 1000)
    assert border.high - border.low < 2 * 1.96 * deviation * 2


@pytest.mark.slow
@pytest.mark.parametrize("count", [12, 60, 300])
def test_chance_shows_no_border(count: int) -> None:
    seeds = range(100 if count < 100 else SOME)
    for seed in seeds:
        chance = np.random.default_rng(seed)
        values, passed = chance.uniform(size=count), chance.uniform(size=count) < 0.5
        found = find_borders(values, passed, is_alone=False)
        assert not found.borders
        assert found.reason


def test_100_000_runs() -> None:
    chance = np.random.default_rng(3)
    values = chance.uniform(0, 2, 100_000)
    (border,) = find_borders(values, values < 1.23, is_alone=False).borders
    assert border.low <= 1.23 <= border.high
    assert border.high - border.low < 0.001
    (border,) = find_borders(
        values, values + chance.normal(0, 0.02, len(values)) < 1.23, is_alone=False
    ).borders
    assert border.low <= 1.23 <= border.high
    assert border.high - border.low < 0.01


def test_values_over_decades() -> None:
    chance = np.random.default_rng(4)
    logarithms = chance.uniform(math.log(0.001), math.log(10), 300)
    passed = logarithms + chance.normal(0, 0.3, 300) < math.log(0.1)
    (border,) = find_borders(np.exp(logarithms), passed, is_alone=False).borders
    assert border.low < 0.1 < border.high
    assert border.low > 0.06
    assert border.high < 0.16


# ---- One parameter alone: what the runs say is certain.

GRID = np.linspace(0.0, 1.0, 11)


@pytest.mark.parametrize(
    ("passed", "expected"),
    [
        (GRID < 0.55, [(0.5, 0.6, True)]),
        (GRID > 0.55, [(0.5, 0.6, False)]),
        (GRID < 0.05, [(0.0, 0.1, True)]),
        ((GRID > 0.25) & (GRID < 0.75), [(0.2, 0.3, False), (0.7, 0.8, True)]),
        ((GRID < 0.25) | (GRID > 0.75), [(0.2, 0.3, True), (0.7, 0.8, False)]),
    ],
)
def test_a_grid_of_one_parameter(passed: Any, expected: list[tuple[float, float, bool]]) -> None:
    order = np.random.default_rng(0).permutation(11)
    found = find_borders(GRID[order], passed[order], is_alone=True)
    assert found.is_certain
    assert found.is_clear
    for border, (low, high, passes_below) in zip(found.borders, expected, strict=True):
        assert (border.low, border.high) == pytest.approx((low, high))
        assert border.at == pytest.approx((low + high) / 2)
        assert border.passes_below is passes_below


def test_two_runs_of_one_parameter() -> None:
    found = find_borders(np.array([1.0, 2.0]), np.array([True, False]), is_alone=True)
    assert found.borders == (Border(at=1.5, low=1.0, high=2.0, passes_below=True),)


def test_an_exception_beyond_the_border() -> None:
    values = np.linspace(0, 1, 41)
    passed = values < 0.5
    passed[24] = True  # 0.6 passes although 0.5 to 0.575 fail
    found = find_borders(values, passed, is_alone=True)
    (border,) = found.borders
    assert not found.is_certain
    assert border.low < 0.5 < border.high < 0.7
    assert found.shares == pytest.approx((1.0, 1 / 21))


def test_results_that_alternate() -> None:
    found = find_borders(np.arange(30.0), np.arange(30) % 2 == 0, is_alone=True)
    assert found.borders == ()
    assert found.reason == "the result changes 29 times along it"


# ---- What shows no border.


@pytest.mark.parametrize("is_alone", [True, False])
def test_all_pass_or_fail(*, is_alone: bool) -> None:
    for passed, reason in ((True, "every run passes"), (False, "no run passes")):
        found = find_borders(GRID, np.full(11, passed), is_alone=is_alone)
        assert (found.borders, found.reason) == ((), reason)


def test_too_little_is_known() -> None:
    passed = np.array([True, False, True, False, False])
    assert (
        find_borders(np.zeros(0), np.zeros(0, bool), is_alone=True).reason == "no run has a value"
    )
    assert find_borders(np.full(5, np.nan), passed, is_alone=True).reason == "no run has a value"
    assert find_borders(np.ones(5), passed, is_alone=False).reason == "it has one value"
    assert find_borders(np.arange(5.0), passed, is_alone=False).reason == "5 runs are too few"
    assert find_borders(np.arange(20.0) % 2, np.arange(20) % 2 == 0, is_alone=False).reason == (
        "it has two values"
    )


def test_missing_values_are_left_out() -> None:
    values = np.array([0.0, np.nan, 1.0, np.inf, 2.0])
    passed = np.array([True, False, True, True, False])
    (border,) = find_borders(values, passed, is_alone=True).borders
    assert (border.low, border.high) == (1.0, 2.0)


def test_a_change_without_an_end() -> None:
    """The share falls over the whole range: where the middle is, nothing says."""
    chance = np.random.default_rng(2)
    values = chance.uniform(0, 1, 400)
    found = find_borders(values, chance.uniform(size=400) < 0.9 - 0.35 * values, is_alone=False)
    assert found.borders == () or found.borders[0].high - found.borders[0].low > 0.3
    assert found.reason.startswith("the share that passes ") or found.borders


def test_the_same_table_gives_the_same_borders() -> None:
    make, _, _ = CASES["logistic"]
    values, passed = make(np.random.default_rng(9), 200)
    order = np.random.default_rng(1).permutation(200)
    assert find_borders(values, passed, is_alone=False) == find_borders(
        values[order], passed[order], is_alone=False
    )
