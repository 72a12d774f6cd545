"""Put together what `[sweep]` of `wsgen.toml` and the command line say."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.sweeping.words import (
    make_axis,
    make_design,
    read_axes,
    read_axis,
    read_distribution,
    read_distributions,
)
from wsgen.workspace.settings import read_settings
from wsgen.workspace.sweep_settings import TABLE, SweepSettings

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from wsgen.model.sweep import Axis, Design, Distribution


def read_sweep_settings(package: Path) -> SweepSettings:
    """The `[sweep]` table of the package in a folder; without defaults where it has none.

    Raises:
        RequestError: The table has a mistake, or the file cannot be read.
    """
    settings, found = read_settings(package)
    mistakes = [one for one in found if (one.element or TABLE).partition(".")[0] == TABLE]
    if settings.sweep is not None and not mistakes:
        return settings.sweep
    if mistakes and (settings.sweep is not None or mistakes[0].element is None):
        first = mistakes[0]
        line = "" if first.line is None else f":{first.line}"
        raise RequestError(f"{first.file}{line}: {first.message}", hint=first.hint or "")
    return SweepSettings()


def merge_design(  # noqa: PLR0913  what the command line has
    settings: SweepSettings,
    over: Sequence[str],
    random: Sequence[str],
    *,
    samples: int | None = None,
    sampler: str | None = None,
    seed: int | None = None,
) -> Design:
    """The design of the options of a command line, and of the settings for what they leave out.

    A name that an option gives takes the place of that in the settings, with its values; others
    come after those of the settings.

    Raises:
        RequestError: A word cannot be read, or an option has no effect.
    """
    given_axes = {axis.name: axis for axis in read_axes(over)}
    given_random = {one.name: one for one in read_distributions(random)}
    axes: dict[str, Axis] = {}
    distributions: dict[str, Distribution] = {}
    for name in settings.over:
        if name not in given_random:
            axes[name] = given_axes.get(name) or _axis(settings, name)
    for name, text in settings.random.items():
        if name not in given_axes:
            distributions[name] = given_random.get(name) or read_distribution(
                name, text, option=_place(settings, name, "random")
            )
    distributions |= given_random
    defaults = settings if distributions else SweepSettings()  # else they have no effect
    return make_design(
        tuple({**axes, **given_axes}.values()),
        tuple(distributions.values()),
        samples=defaults.samples if samples is None else samples,
        sampler=defaults.sampler if sampler is None else sampler,
        seed=defaults.seed if seed is None else seed,
    )


def _axis(settings: SweepSettings, name: str) -> Axis:
    values = settings.over[name]
    place = _place(settings, name, "over")
    if isinstance(values, str):
        return read_axis(name, values, option=place)
    return make_axis(name, values, f"{place} {name}")


def _place(settings: SweepSettings, name: str, key: str) -> str:
    """Where a name stands, to begin a message with, in place of the option."""
    line = settings.lines.get(name)
    where = settings.file if line is None else f"{settings.file}:{line}"
    return f"{where}: `{key}`"
