"""All variants of a design."""

import json
import math
import statistics
import subprocess
import sys
import threading
import tracemalloc
from dataclasses import replace
from hashlib import sha256
from itertools import product
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsgen.errors import NotFoundError, RequestError
from wsgen.model.sweep import SAMPLERS, Axis, Design, Distribution, Variant
from wsgen.sweeping.design import Variants
from wsgen.sweeping.words import make_design, read_axes, read_distributions

ALL_KINDS = (
    Distribution(name="u", kind="uniform", numbers=(-1.0, 3.0)),
    Distribution(name="n", kind="normal", numbers=(10.0, 2.0)),
    Distribution(name="l", kind="loguniform", numbers=(0.01, 100.0)),
    Distribution(name="c", kind="choice", choices=("a", "b", "c")),
)


def drawn(sampler: str, samples: int = 8, seed: int = 7) -> Design:
    return Design(distributions=ALL_KINDS, samples=samples, sampler=sampler, seed=seed)


def rows(design: Design) -> list[dict[str, Any]]:
    return [dict(variant.values) for variant in Variants(design)]


def test_the_first_axis_is_the_slowest() -> None:
    found = list(Variants(make_design(read_axes(["a=1,2", "b=x,y,z"]), ())))
    assert [one.number for one in found] == [*range(6)]
    expected = [*product((1, 2), ("x", "y", "z"))]
    assert [(one.values["a"], one.values["b"]) for one in found] == expected


def test_each_point_of_the_grid_has_the_same_samples() -> None:
    design = make_design(
        read_axes(["a=1,2"]), read_distributions(["m=uniform(0,1)"]), samples=3, seed=1
    )
    found = rows(design)
    assert [one["a"] for one in found] == [1, 1, 1, 2, 2, 2]
    assert [one["m"] for one in found[:3]] == [one["m"] for one in found[3:]]
    assert len({one["m"] for one in found}) == 3
    assert list(found[0]) == list(design.names)


# The first and the third sample with seed 7, and a digest of 5000: they are the same with every
# version of Python, NumPy and scipy, or a sweep could not go on after an update.
GOLDEN = {
    "random": (
        [
            {"u": 2.00156806, "n": 10.3500267, "l": 3.10889635, "c": "b"},
            {"u": -0.893992374, "n": 12.9240872, "l": 0.0460557846, "c": "a"},
        ],
        "1c5d666f52d463e5",
    ),
    "lhs": (
        [
            {"u": 2.10107041, "n": 10.6023699, "l": 0.0506202681, "c": "c"},
            {"u": 1.96963967, "n": 11.114587, "l": 17.0088661, "c": "b"},
        ],
        "e241e790bc51a75f",
    ),
    "sobol": (
        [
            {"u": 1.60170741, "n": 12.7744073, "l": 0.025224693, "c": "c"},
            {"u": 0.0963486992, "n": 11.319, "l": 0.278486564, "c": "b"},
        ],
        "26a680a1df30fde8",
    ),
}


def digest(design: Design) -> str:
    return sha256(json.dumps(rows(design)).encode()).hexdigest()[:16]


@pytest.mark.slow
@pytest.mark.parametrize("sampler", SAMPLERS)
def test_a_seed_gives_these_values_everywhere(sampler: str) -> None:
    found = rows(drawn(sampler))
    assert ([found[0], found[2]], digest(drawn(sampler, 5000))) == GOLDEN[sampler]


@pytest.mark.slow
@pytest.mark.parametrize("sampler", SAMPLERS)
def test_samples_follow_their_distributions(sampler: str) -> None:
    found = rows(drawn(sampler, 4096))
    assert all(-1 <= one["u"] <= 3 and 0.01 <= one["l"] <= 100 for one in found)
    assert statistics.mean(one["u"] for one in found) == pytest.approx(1.0, abs=0.06)
    assert statistics.mean(one["n"] for one in found) == pytest.approx(10.0, abs=0.1)
    assert statistics.stdev(one["n"] for one in found) == pytest.approx(2.0, rel=0.04)
    assert statistics.mean(math.log10(one["l"]) for one in found) == pytest.approx(0.0, abs=0.06)
    for choice in "abc":
        assert sum(one["c"] == choice for one in found) == pytest.approx(4096 / 3, rel=0.07)


@pytest.mark.slow
def test_a_latin_hypercube_has_a_sample_in_each_interval() -> None:
    found = rows(drawn("lhs", 100))
    assert sorted(int((one["u"] + 1) / 4 * 100) for one in found) == [*range(100)]


@pytest.mark.slow
@pytest.mark.parametrize("sampler", SAMPLERS)
def test_variants_do_not_depend_on_the_order_they_are_asked_for(sampler: str) -> None:
    design = replace(drawn(sampler, 9000), axes=(Axis(name="a", values=(1, 2)),))
    forward = list(Variants(design))
    variants = Variants(design)
    numbers = [17_999, 0, 8999, 9000, 4095, 4096, 13_000, 1]
    assert [variants.variant(number) for number in numbers] == [forward[one] for one in numbers]


@pytest.mark.slow
def test_threads_share_the_variants() -> None:
    variants = Variants(drawn("sobol", 16_384))
    expected = list(Variants(drawn("sobol", 16_384)))
    found: dict[int, Variant] = {}

    def take(start: int) -> None:
        for number in range(start, variants.count, 997):
            found[number] = variants.variant(number)

    threads = [threading.Thread(target=take, args=(start,)) for start in range(0, 997, 250)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found
    assert all(expected[number] == variant for number, variant in found.items())


def test_random_values_stay_when_the_sweep_grows() -> None:
    few = Design(distributions=ALL_KINDS[:1], samples=10, seed=3)
    more = Design(distributions=(ALL_KINDS[1], ALL_KINDS[0]), samples=20, seed=3)
    assert [one["u"] for one in rows(few)] == [one["u"] for one in rows(more)][:10]


def test_seeds_and_names_give_other_values() -> None:
    assert rows(drawn("random", seed=1)) != rows(drawn("random", seed=2))
    twins = (ALL_KINDS[0], replace(ALL_KINDS[0], name="v"))
    assert all(one["u"] != one["v"] for one in rows(Design(distributions=twins, samples=20)))


@pytest.mark.slow
def test_a_million_variants_are_not_held() -> None:
    axes = read_axes(["a=0:1:1000"])
    design = make_design(axes, read_distributions(["m=normal(1,2)"]), samples=1000)
    tracemalloc.start()
    try:
        variants = Variants(design)
        assert variants.count == len(variants) == 1_000_000
        assert variants.variant(999_999).values["a"] == 1
        some = zip(variants, range(5000), strict=False)
        assert sum(1 for _ in some) == 5000
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 2e6


def test_a_number_beyond_the_last() -> None:
    variants = Variants(make_design(read_axes(["a=1,2"]), ()))
    for number in (-1, 2):
        with pytest.raises(IndexError):
            variants.variant(number)


def test_nothing_varies() -> None:
    with pytest.raises(RequestError, match="Nothing varies"):
        Variants(Design())


def test_too_many_variants() -> None:
    design = make_design(
        read_axes(["a=0:1:10000", "b=0:1:1000"]), read_distributions(["m=uniform(0,1)"])
    )
    with pytest.raises(RequestError, match="1,000,000,000 variants") as caught:
        Variants(design)
    assert "10,000 of a x 1,000 of b x 100 samples" in caught.value.message


@pytest.mark.parametrize(("samples", "has_hint"), [(64, False), (1, False), (100, True)])
def test_sobol_wants_a_power_of_two(
    samples: int, has_hint: bool, recwarn: pytest.WarningsRecorder
) -> None:
    variants = Variants(drawn("sobol", samples))
    assert sum(1 for _ in variants) == samples
    assert (variants.hint is not None) == has_hint
    assert "100 is not a power of two" in (variants.hint or "100 is not a power of two")
    assert "--samples 64 or 128" in (variants.hint or "--samples 64 or 128")
    assert not recwarn
    assert Variants(drawn("random", 100)).hint is None


@pytest.mark.parametrize("sampler", SAMPLERS)
def test_scipy_is_needed_by_two_samplers(sampler: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "scipy.stats", None)
    if sampler == "random":
        assert rows(drawn(sampler))
        return
    with pytest.raises(NotFoundError, match="scipy") as caught:
        Variants(drawn(sampler))
    assert "pip install 'wsgen[sweep]'" in caught.value.hint
    assert "--sampler random" in caught.value.hint


def test_a_grid_loads_neither_numpy_nor_scipy() -> None:
    code = (
        "import sys; from wsgen.sweeping.words import *; from wsgen.sweeping.design import *;"
        "from wsgen.sweeping.parameters import check_design;"
        "design = make_design(read_axes(['world.slope=0:1:3']), ());"
        "design = check_design(design, (), subject='x');"
        "assert len(list(Variants(design))) == 3;"
        "assert not {'numpy', 'scipy'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


@pytest.mark.slow
@given(
    st.lists(st.integers(1, 4), min_size=0, max_size=4),
    st.integers(1, 5),
    st.integers(0, 2**63 - 1),
)
def test_any_design_has_each_point_once(sizes: list[int], samples: int, seed: int) -> None:
    design = Design(
        axes=tuple(Axis(name=f"a{i}", values=tuple(range(n))) for i, n in enumerate(sizes)),
        distributions=ALL_KINDS,
        samples=samples,
        seed=seed,
    )
    variants = Variants(design)
    found = list(variants)
    assert len(found) == variants.count == math.prod(sizes) * samples
    points = [tuple(one.values[axis.name] for axis in design.axes) for one in found]
    assert points[::samples] == [*product(*(range(n) for n in sizes))]
    assert points == sorted(points)
    assert all(tuple(one.values) == design.names for one in found)
    assert [variants.variant(one.number) for one in found] == found
