"""`dataclass` of wsgen does what that of the standard library does."""

from __future__ import annotations

import dataclasses
from dataclasses import FrozenInstanceError, field, replace
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    from wsgen.values import dataclass


@dataclass(frozen=True, kw_only=True)
class Joint:
    name: str
    limit: float = 1.0
    line: int | None = field(default=None, compare=False)
    parts: tuple[Joint, ...] = ()


@dataclass(frozen=True)
class Fixed(Joint):
    pass


@dataclass
class Counter:
    count: int = 0

    def __repr__(self) -> str:
        return "a counter"


def test_what_is_compared() -> None:
    joint = Joint(name="a", line=3)
    assert joint == Joint(name="a", line=4)
    assert joint != Joint(name="a", limit=2.0)
    assert joint != Fixed(name="a")
    foreign: Any = "a"
    assert joint != foreign
    assert {joint, Joint(name="a")} == {joint}


def test_how_it_is_shown() -> None:
    nested = Joint(name="a", parts=(Joint(name="b"),))
    inner = "Joint(name='b', limit=1.0, line=None, parts=())"
    assert repr(nested) == f"Joint(name='a', limit=1.0, line=None, parts=({inner},))"
    assert repr(Counter()) == "a counter"


def test_the_rest_is_the_standard_library_s() -> None:
    joint = Joint(name="a")
    assert dataclasses.is_dataclass(joint)
    assert replace(joint, limit=2.0).limit == 2.0
    with pytest.raises(FrozenInstanceError):
        joint.limit = 3.0  # type: ignore[misc]
    foreign: Any = Joint
    with pytest.raises(TypeError):
        foreign("a")


def test_what_may_change_has_no_hash() -> None:
    counter = Counter()
    counter.count += 1
    assert counter == Counter(1)
    with pytest.raises(TypeError):
        hash(counter)
