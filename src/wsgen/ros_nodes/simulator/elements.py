"""Values in the elements of plugins, as `sdf::Element::Get` reads them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.ros_nodes.simulator.host import CannotWorkError

if TYPE_CHECKING:
    from wsgen.model.devices import Element

TRUE, FALSE = ("true", "1"), ("false", "0")


def number(element: Element, path: str, default: float) -> float:
    """The number at a path; `default` where it is not written.

    Raises:
        CannotWorkError: It is no number.
    """
    text = element.get(path)
    return default if not text else _number(text, path)


def numbers(element: Element, path: str) -> list[float]:
    """The numbers of all elements at a path.

    Raises:
        CannotWorkError: One of them is no number.
    """
    return [_number(found.text, path) for found in element.find_all(path)]


def vector(element: Element, path: str, default: tuple[float, ...]) -> tuple[float, ...]:
    """Numbers with blanks between them, as many as `default` has.

    Raises:
        CannotWorkError: They are others.
    """
    text = element.get(path)
    if not text:
        return default
    found = tuple(_number(word, path) for word in text.split())
    if len(found) != len(default):
        raise CannotWorkError(
            f"its <{path}> is `{text[:60]}`. Write {len(default)} numbers with blanks between them."
        )
    return found


def boolean(element: Element, path: str, *, default: bool) -> bool:
    """The truth value at a path.

    Raises:
        CannotWorkError: It is none.
    """
    text = element.get(path).lower()
    if text in TRUE:
        return True
    if text and text not in FALSE:
        raise CannotWorkError(f"its <{path}> is `{text[:60]}`. Write true or false.")
    return False if text else default


def _number(text: str, path: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise CannotWorkError(f"its <{path}> is `{text[:60]}`. Write a number.")
    return value
