"""What varies, by the command line and by `[sweep]` in wsgen.toml."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.sweeping.words import make_axis, make_design, read_axis, read_distribution

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from wsgen.model.sweep import Axis, Design, Distribution
    from wsgen.packages.workspace.sweep_settings import SweepSettings


def make_design_with(  # noqa: PLR0913  the options
    settings: SweepSettings,
    *,
    over: Sequence[Axis],
    random: Sequence[Distribution],
    samples: int | None,
    sampler: str | None,
    seed: int | None,
) -> Design:
    """The design of the options, and of the settings where no option takes their place.

    A parameter of the command line takes the place of one with its name, in whichever table.

    Raises:
        RequestError: A text of the settings cannot be read, or the options do not go together.
    """
    given = {axis.name: axis for axis in over}
    drawn = {one.name: one for one in random}
    named = {*given, *drawn}
    axes = [*_axes(settings, named), *given.values()]
    distributions = [*_distributions(settings, named), *drawn.values()]
    has_random = bool(distributions)
    return make_design(
        axes,
        distributions,
        # Settings about samples are idle where an option takes the place of what is random.
        samples=samples if samples is not None or not has_random else settings.samples,
        sampler=sampler if sampler is not None or not has_random else settings.sampler,
        seed=seed if seed is not None or not has_random else settings.seed,
    )


def _axes(settings: SweepSettings, named: set[str]) -> Iterable[Axis]:
    for name, values in settings.over.items():
        if name in named:
            continue
        place = _place(settings, name)
        if isinstance(values, str):
            yield read_axis(name, values, option=f"{place} over:")
        else:
            yield make_axis(name, values, f"{place} over: {name}")


def _distributions(settings: SweepSettings, named: set[str]) -> Iterable[Distribution]:
    for name, text in settings.random.items():
        if name not in named:
            yield read_distribution(name, text, option=f"{_place(settings, name)} random:")


def _place(settings: SweepSettings, name: str) -> str:
    """Where a parameter is written."""
    line = settings.lines.get(name)
    return f"{settings.file or 'wsgen.toml'}{f':{line}' if line else ''}"
