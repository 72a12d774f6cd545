"""`dataclass` of wsgen does what that of the standard library does."""

from __future__ import annotations

import copy
import dataclasses
import pickle
import re
from dataclasses import FrozenInstanceError, field, replace
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    from wsgen.text.values import dataclass

from wsgen.text.values import lazy_pattern


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


def test_frozen_fields_can_be_neither_set_nor_deleted() -> None:
    joint: Any = Joint(name="a")
    with pytest.raises(FrozenInstanceError, match="cannot change 'name' of a Joint"):
        joint.name = "b"
    with pytest.raises(FrozenInstanceError, match="cannot change 'name' of a Joint"):
        del joint.name


@dataclass
class Watch:
    name: str
    seen: list[int] = field(default_factory=list)
    first: int = field(init=False)
    counts: dict[str, int] = field(init=False, default_factory=dict)
    limit: float = field(default=2.0, kw_only=True)

    def __post_init__(self) -> None:
        self.first = len(self.name)


@dataclass
class Longer(Watch):
    more: int = 1


def test_fields_are_filled_in_the_order_of_the_standard_library() -> None:
    made: Any = Watch
    watch, other = Watch("abc", limit=3.0), Longer("a", [1], 5)
    assert (watch.seen, watch.first, watch.counts, watch.limit) == ([], 3, {}, 3.0)
    assert (other.seen, other.first, other.limit, other.more) == ([1], 1, 2.0, 5)
    assert watch.seen is not Watch("d").seen
    assert Watch("d").counts is not watch.counts
    for wrong in (made, lambda: made("a", [], 3.0), lambda: made("a", first=1)):
        with pytest.raises(TypeError, match=r"Watch\.__init__\(\)"):
            wrong()


class Undecorated(Fixed):
    """Has the `__init__` of its base."""


def test_a_class_without_decorator_has_that_of_its_base() -> None:
    assert Undecorated(name="a").name == "a"
    assert Fixed(name="b", limit=2.0).limit == 2.0
    assert copy.copy(Undecorated(name="a")).name == "a"
    assert pickle.loads(pickle.dumps(Joint(name="a"))) == Joint(name="a")  # noqa: S301  its own


def test_lazy_patterns() -> None:
    pattern = lazy_pattern(r"(?P<first>a+)b", re.IGNORECASE)
    found = pattern.fullmatch("AAb")
    assert found is not None
    assert found["first"] == "AA"
    assert pattern.sub("c", "ab ab") == "c c"
    assert (pattern.pattern, pattern.groups) == (r"(?P<first>a+)b", 1)
    assert lazy_pattern(rb"\w").findall(b"ab") == [b"a", b"b"]
    wrong = lazy_pattern("(")
    with pytest.raises(re.error, match="unterminated"):
        wrong.search("a")
    with pytest.raises(AttributeError):
        _ = lazy_pattern("a").__wrapped__  # type: ignore[attr-defined]
