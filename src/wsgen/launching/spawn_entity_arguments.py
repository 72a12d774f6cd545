"""The arguments of `spawn_entity.py`, read by the module that it reads them with.

`argparse` takes a value in the word of a short option, as in `-z 0.5` or `-z0.5`, and the beginning
of a long one, as in `-ent`.
"""

from __future__ import annotations

from argparse import SUPPRESS, ArgumentParser
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence


class RefusedError(Exception):
    """What `argparse` says of arguments that it does not accept."""


class _Parser(ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise RefusedError(message)


_SECONDS = frozenset(("timeout", "spawn_service_timeout"))
NUMBERS = _SECONDS | frozenset("xyzRPY")


def parse(
    words: Sequence[str], with_value: Iterable[str], flags: Iterable[str]
) -> tuple[dict[str, str], list[str]]:
    """The values of the options, those of flags "true", and the words that are no option.

    Raises:
        RefusedError: An option has no value, or a wrong one, or is the beginning of several.
    """
    parser = _Parser(argument_default=SUPPRESS, add_help=False)
    for name in with_value:
        kind: dict[str, Any] = {"type": float} if name in _SECONDS else {}
        parser.add_argument(f"-{name}", dest=name, **kind)
    for name in flags:
        parser.add_argument(f"-{name}", dest=name, action="store_const", const="true")
    parser.add_argument("-h", "--help", action="store_const", const="true")
    values, rest = parser.parse_known_args(words)
    return {name: str(value) for name, value in vars(values).items()}, rest
