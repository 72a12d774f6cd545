"""Where the border between passing and failing lies along one parameter, and how well it is known.

Where a parameter alone varies, what the runs say is certain: the border lies between the last value
that passes and the first one that fails. Otherwise the other parameters scatter it, and the share
that passes is fitted by maximum likelihood:

    share(x) = low + (high - low) / (1 + exp(-(x - at) / width))

with the shares `low` and `high` on the two sides. The interval of `at` has all values that the runs
do not contradict: those whose profile likelihood ratio stays below `CRITICAL`. For a smooth change
that ratio has a chi-squared distribution; for a step, the one of the larger of the maxima of two
random walks (Hinkley, Biometrika 57, 1970), whose quantile is larger. The larger one is taken, as
a step may be what it is: the interval covers at least 95 %.

All of it is a function of the numbers alone: the same table gives the same borders.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Numbers = NDArray[np.float64]


CRITICAL = -2.0 * math.log(1.0 - math.sqrt(0.95))  # 7.35; a chi-squared distribution has 3.84
# Likelihood ratios above which a border, and a second one, are more than chance. Without any
# border, they are exceeded in less than 1 of 100 tables, wherever one looks for it.
SIGNIFICANT = 16.0
FEWEST = 8  # runs from which a share can be fitted
BINS = 32  # of the runs, while their likelihood is computed
OUTER_BINS = 6  # on each side of what is looked at closely
LEVELS = 8  # of looking closer
STEPS = 15  # of expectation and maximization
WIDTHS = (0.0, 0.01, 0.025, 0.06, 0.12, 0.25, 0.5)  # of the range that is looked at
# Values over decades: from this ratio of the largest to the smallest one on, where half of them are
# below this share of the middle.
LOG_RATIO = 30.0
LOG_SHARE = 0.4
SURE = 0.02  # of the runs may pass or fail on the wrong side of a border that holds


@dataclass(frozen=True, kw_only=True)
class Border:
    """A value of a parameter; below it runs pass and above it they fail, or the other way round."""

    at: float
    low: float  # the interval in which it lies: certainly, or with a probability of 95 %
    high: float
    passes_below: bool


@dataclass(frozen=True, kw_only=True)
class Dependence:
    """How passing depends on a parameter that is a number."""

    borders: tuple[Border, ...] = ()  # none, one or two, in their order
    shares: tuple[float, ...] = ()  # of runs that pass below, between and above them, from 0 to 1
    is_certain: bool = False  # no other parameter varies, and every run follows
    reason: str = ""  # why no border is visible

    @property
    def is_clear(self) -> bool:
        """Whether practically every run passes on one side and fails on the other."""
        return all(share <= SURE or share >= 1.0 - SURE for share in self.shares)


def find_borders(values: Numbers, passed: NDArray[np.bool_], *, is_alone: bool) -> Dependence:
    """Find where runs begin to fail, or to pass.

    Args:
        values: Of the parameter, shape (n,); runs without a finite value are left out.
        passed: Of the same runs, shape (n,).
        is_alone: No other parameter varies.
    """
    known = np.isfinite(values)
    x, runs, passes = _count(values[known], passed[known])
    reason = _trivial(x, runs, passes)
    if reason:
        return Dependence(reason=reason)
    is_unanimous = is_alone and bool(np.all((passes == 0) | (passes == runs)))
    certain = _certain(x, passes > 0) if is_unanimous else None
    if certain is not None:
        return certain
    if runs.sum() < FEWEST:
        return Dependence(reason=f"{int(runs.sum())} runs are too few")
    if len(x) == 2:  # noqa: PLR2004  where it lies between them, no run says
        return Dependence(reason="it has two values")
    fitted = _fit_all(x, runs, passes)
    if is_unanimous and not fitted.borders:
        changes = int(np.count_nonzero(np.diff(passes > 0)))
        return Dependence(reason=f"the result changes {changes} times along it")
    return fitted


def is_over_decades(values: Numbers) -> bool:
    """Whether positive values are spread so that their logarithms are what one looks at."""
    if not len(values):
        return False
    low, high = float(values.min()), float(values.max())
    return (
        low > 0
        and high / low > LOG_RATIO
        and float(np.median(values)) < LOG_SHARE * (low + high) / 2
    )


def _trivial(x: Numbers, runs: Numbers, passes: Numbers) -> str:
    """Say why these runs show no border; empty where they may."""
    if not len(x):
        return "no run has a value"
    if passes.sum() == runs.sum():
        return "every run passes"
    if passes.sum() == 0:
        return "no run passes"
    return "it has one value" if len(x) == 1 else ""


def _count(values: Numbers, passed: NDArray[np.bool_]) -> tuple[Numbers, Numbers, Numbers]:
    """Return the different values, sorted, how often each occurs, and how often it passes."""
    x, index = np.unique(values, return_inverse=True)
    runs = np.bincount(index, minlength=len(x)).astype(np.float64)
    passes = np.bincount(index, weights=passed.astype(np.float64), minlength=len(x))
    return x, runs, passes.astype(np.float64)


def _certain(x: Numbers, passes: NDArray[np.bool_]) -> Dependence | None:
    """Of runs that follow one or two borders without exception; None for others."""
    last = np.flatnonzero(passes[1:] != passes[:-1])  # before each change
    if len(last) > 2:  # noqa: PLR2004
        return None
    borders = tuple(
        Border(
            at=float(x[i] + (x[i + 1] - x[i]) / 2),
            low=float(x[i]),
            high=float(x[i + 1]),
            passes_below=bool(passes[i]),
        )
        for i in last
    )
    zones = [float(passes[0]), *(float(passes[i + 1]) for i in last)]
    return Dependence(borders=borders, shares=tuple(zones), is_certain=True)


def _fit_all(x: Numbers, runs: Numbers, passes: Numbers) -> Dependence:
    """Fit one border, or two where these explain much more."""
    is_log = is_over_decades(x)
    scale = np.log(x) if is_log else x
    split = _split(scale, runs, passes)
    if split is not None:
        sides = (scale < split, scale >= split)
        fits = [_fit(scale[side], runs[side], passes[side]) for side in sides]
        if all(fit is not None and fit.ratio > SIGNIFICANT for fit in fits):
            first, second = (fit for fit in fits if fit is not None)
            if first.passes_below != second.passes_below:
                return _bounded([first, second], scale, runs, passes, is_log=is_log)
    fit = _fit(scale, runs, passes)
    if fit is None or fit.ratio < SIGNIFICANT:
        return Dependence(reason="alone it does not explain which runs pass")
    return _bounded([fit], scale, runs, passes, is_log=is_log)


def _bounded(
    fits: Sequence[_Fit], scale: Numbers, runs: Numbers, passes: Numbers, *, is_log: bool
) -> Dependence:
    """Return the borders, if they are known better than to lie somewhere in the range."""
    zone = np.searchsorted([fit.at for fit in fits], scale)
    good, total = (
        np.bincount(zone, weights=of, minlength=len(fits) + 1).astype(np.float64)
        for of in (passes, runs)
    )
    shares = tuple(_ratio(good, total, otherwise=0.0).tolist())
    if any(fit.low <= scale[0] or fit.high >= scale[-1] for fit in fits):
        ways = "rises" if shares[-1] > shares[0] else "falls"
        return Dependence(
            shares=shares,
            reason=f"the share that passes {ways} gradually, without a visible border",
        )
    back = np.exp if is_log else np.asarray
    return Dependence(
        borders=tuple(
            Border(
                at=float(back(fit.at)),
                low=float(back(fit.low)),
                high=float(back(fit.high)),
                passes_below=fit.passes_below,
            )
            for fit in fits
        ),
        shares=shares,
    )


@dataclass(frozen=True, kw_only=True)
class _Fit:
    """A border that was fitted."""

    at: float
    low: float
    high: float
    passes_below: bool  # more than above
    ratio: float  # twice the logarithm of the likelihood over that of one share everywhere


def _fit(x: Numbers, runs: Numbers, passes: Numbers) -> _Fit | None:
    """Fit one border; None where all runs have one result, or one value."""
    if len(x) < 2 or passes.sum() in {0.0, runs.sum()}:  # noqa: PLR2004
        return None
    constant = float(_log_likelihood(runs, passes, np.full(len(x), passes.sum() / runs.sum())))
    low, high = float(x[0]), float(x[-1])
    found: _Fit | None = None
    for _ in range(LEVELS):
        inside = (x >= low) & (x <= high)
        binned, is_exact = _bin(x, runs, passes, inside)
        ats = _candidates(binned[0], low, high)
        profile, passes_below = _profile(*binned, ats, high - low)
        likely = np.flatnonzero(2.0 * (profile.max() - profile) <= CRITICAL)
        # The ends are the next values that are contradicted: between two values of the runs, no
        # run says more.
        first, last = max(likely[0] - 1, 0), min(likely[-1] + 1, len(ats) - 1)
        middle = likely[profile[likely] > profile.max() - 1e-9]
        at = float((ats[middle[0]] + ats[middle[-1]]) / 2)
        found = _Fit(
            at=at,
            low=float(ats[first]) if likely[0] else float(x[0]),
            high=float(ats[last]) if likely[-1] < len(ats) - 1 else float(x[-1]),
            passes_below=passes_below,
            ratio=2.0 * (float(profile.max()) - constant),
        )
        margin = found.high - found.low
        closer = (max(found.low - margin, float(x[0])), min(found.high + margin, float(x[-1])))
        if is_exact or closer[1] - closer[0] > 0.7 * (high - low):
            break
        low, high = closer
    return found


def _bin(
    x: Numbers, runs: Numbers, passes: Numbers, inside: NDArray[np.bool_]
) -> tuple[tuple[Numbers, Numbers, Numbers], bool]:
    """Join neighboring values; whether those that are looked at closely are all apart."""
    first, last = int(np.argmax(inside)), len(x) - int(np.argmax(inside[::-1]))
    is_exact = last - first <= BINS
    edges = np.unique(
        np.concatenate(
            [
                _edges(0, first, OUTER_BINS),
                np.arange(first, last) if is_exact else _edges(first, last, BINS),
                _edges(last, len(x), OUTER_BINS),
            ]
        )
    )
    joined_runs = np.add.reduceat(runs, edges)
    centers = np.add.reduceat(runs * x, edges) / joined_runs
    return (centers, joined_runs, np.add.reduceat(passes, edges)), is_exact


def _edges(first: int, last: int, count: int) -> NDArray[np.int64]:
    """Return where `count` parts of about equal length begin, at most one for each value."""
    if first >= last:
        return np.zeros(0, dtype=np.int64)
    return np.unique(np.linspace(first, last, min(count, last - first) + 1).astype(np.int64)[:-1])


def _candidates(x: Numbers, low: float, high: float) -> Numbers:
    """Return the places to look at: each value, and some between two of them."""
    values = x[(x >= low) & (x <= high)]
    if len(values) < 2:  # noqa: PLR2004
        return np.linspace(low, high, BINS)
    between = max(1, 2 * BINS // len(values))
    parts = np.linspace(0.0, 1.0, between + 1, endpoint=False)
    places = (values[:-1, None] + np.diff(values)[:, None] * parts[None, :]).ravel()
    return np.append(places, values[-1])


def _profile(
    x: Numbers, runs: Numbers, passes: Numbers, ats: Numbers, span: float
) -> tuple[Numbers, bool]:
    """Return the largest log likelihood for each place, and whether more passes below the best one.

    For a place and a width, the likelihood is concave in the two shares; expectation and
    maximization climbs it.
    """
    widths = np.array(WIDTHS)[None, :, None] * span
    away = x[None, None, :] - ats[:, None, None]
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        smooth = 1.0 / (1.0 + np.exp(-np.clip(away / widths, -500, 500)))
    above = np.where(widths == 0.0, np.where(away > 0, 1.0, np.where(away == 0, 0.5, 0.0)), smooth)
    below = 1.0 - above
    fails = runs - passes
    share = passes.sum() / runs.sum()
    low = np.full(above.shape[:2], share)[..., None]
    high = low.copy()
    tiny = 1e-12
    # A first guess: the shares of what lies on each side.
    low[..., 0] = _ratio((below * passes).sum(-1), (below * runs).sum(-1), otherwise=share)
    high[..., 0] = _ratio((above * passes).sum(-1), (above * runs).sum(-1), otherwise=share)
    for _ in range(STEPS):
        expected = np.clip(low * below + high * above, tiny, 1.0 - tiny)
        good, bad = passes / expected, fails / (1.0 - expected)
        for shares, side in ((low, below), (high, above)):
            up = (shares[..., 0]) * (good * side).sum(-1)
            down = (1.0 - shares[..., 0]) * (bad * side).sum(-1)
            shares[..., 0] = _ratio(up, up + down, otherwise=share)
    expected = low * below + high * above
    likelihoods = _log_likelihood(runs, passes, expected)
    profile = likelihoods.max(axis=1)
    place = int(profile.argmax())
    width = int(likelihoods[place].argmax())
    return profile, bool(low[place, width, 0] > high[place, width, 0])


def _ratio(part: Numbers, whole: Numbers, *, otherwise: float) -> Numbers:
    result = np.full(part.shape, otherwise)
    np.divide(part, whole, out=result, where=whole > 1e-12)  # noqa: PLR2004  nothing is on that side
    return result


def _log_likelihood(runs: Numbers, passes: Numbers, share: Numbers) -> Numbers:
    """Of so many runs that pass, with an expected share; over the last axis."""
    share = np.clip(share, 1e-12, 1.0 - 1e-12)
    result: Numbers = (passes * np.log(share) + (runs - passes) * np.log1p(-share)).sum(-1)
    return result


def _split(x: Numbers, runs: Numbers, passes: Numbers) -> float | None:
    """Find the middle of a zone that differs from what is below and above it; None for none.

    Three shares are compared with two, each for the best places of their borders.
    """
    edges = _edges(0, len(x), 2 * BINS)
    n = np.concatenate([[0.0], np.cumsum(np.add.reduceat(runs, edges))])
    k = np.concatenate([[0.0], np.cumsum(np.add.reduceat(passes, edges))])
    count = len(edges)
    if count < 3:  # noqa: PLR2004
        return None

    def likelihood(first: NDArray[np.int64], last: NDArray[np.int64]) -> Numbers:
        total, good = n[last] - n[first], k[last] - k[first]
        share = np.clip(_ratio(good, total, otherwise=0.5), 1e-12, 1.0 - 1e-12)
        result: Numbers = good * np.log(share) + (total - good) * np.log1p(-share)
        return result

    cuts = np.arange(1, count)
    zero, end = np.zeros_like(cuts), np.full_like(cuts, count)
    one = (likelihood(zero, cuts) + likelihood(cuts, end)).max()
    i, j = np.triu_indices(count - 1, 1)
    i, j = i + 1, j + 1
    start, stop = np.zeros_like(i), np.full_like(i, count)
    two = likelihood(start, i) + likelihood(i, j) + likelihood(j, stop)
    low, middle, high = (
        _ratio(k[last] - k[first], n[last] - n[first], otherwise=0.5)
        for first, last in ((start, i), (i, j), (j, stop))
    )
    is_extreme = ((middle > low) & (middle > high)) | ((middle < low) & (middle < high))
    two = np.where(is_extreme, two, -np.inf)
    best = int(two.argmax())
    if 2.0 * (two[best] - one) < SIGNIFICANT:
        return None
    starts = np.append(edges, len(x))
    inside = slice(int(starts[i[best]]), int(starts[j[best]]))
    return float(np.average(x[inside], weights=runs[inside]))
