"""The order of the keys of a `std::unordered_map<std::string, ...>` of libstdc++ on 64 bits.

Controllers that go through one publish in this order: it is the same on each machine.

Source: gcc-mirror/gcc, libstdc++-v3: libsupc++/hash_bytes.cc (`_Hash_bytes`), src/c++11/
hashtable_c++0x.cc (`_M_need_rehash`), include/bits/hashtable.h (`_M_insert_bucket_begin`,
`_M_rehash_aux`).
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

SIZES = (13, 29, 59, 127, 257, 541, 1109, 2357, 5087)  # numbers of buckets, as the map grows
SEED, FACTOR = 0xC70F6907, 0xC6A4A7935BD1E995
BITS = (1 << 64) - 1
WORD = 8  # bytes


def unordered(names: Iterable[str]) -> list[str]:
    """The keys of a map that these, all different, were put into one after the other."""
    size = 1
    order: list[str] = []
    for name in names:
        if size < SIZES[-1] and len(order) >= (size if size > 1 else 0):
            size = next(one for one in SIZES if one > size)
            before, order = order, []
            for one in before:
                _put(order, one, size)
        _put(order, name, size)
    return order


def _put(order: list[str], name: str, size: int) -> None:
    """Put a key before the others of its bucket, or before all where it is the first of it."""
    bucket = _hash(name.encode()) % size
    same = (place for place, one in enumerate(order) if _hash(one.encode()) % size == bucket)
    order.insert(next(same, 0), name)


@cache
def _hash(text: bytes) -> int:
    whole = len(text) - len(text) % WORD
    found = SEED ^ (len(text) * FACTOR & BITS)
    for start in range(0, whole, WORD):
        word = int.from_bytes(text[start : start + WORD], "little") * FACTOR & BITS
        found = (found ^ (_mix(word) * FACTOR & BITS)) * FACTOR & BITS
    if whole < len(text):
        found = (found ^ int.from_bytes(text[whole:], "little")) * FACTOR & BITS
    return _mix(_mix(found) * FACTOR & BITS)


def _mix(value: int) -> int:
    return value ^ value >> 47
