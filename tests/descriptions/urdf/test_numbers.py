"""Numbers as C++ reads them; the answers are those of std::stod and std::stoi of glibc."""

from __future__ import annotations

import math

import pytest

from wsgen.descriptions.urdf.values import leading_float, leading_integer, parse_number


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("0.2f", 0.2),
        ("0.2 0.3", 0.2),
        ("1,5", 1.0),
        ("\t-.5", -0.5),
        ("+1.", 1.0),
        ("1e", 1.0),
        ("1e5x", 1e5),
        ("0x10", 16.0),
        ("-0x1.8p1", -3.0),
        ("0xg", 0.0),
        ("0", 0.0),
        ("0e-400", 0.0),
        ("0x0p-5000", 0.0),
        ("inf", math.inf),
        ("-INFINITY", -math.inf),
        ("infinite", math.inf),
    ],
)
def test_leading_float(text: str, number: float) -> None:
    assert leading_float(text) == number


@pytest.mark.parametrize("text", ["nan", "NaN(x)", "-nan"])
def test_leading_not_a_number(text: str) -> None:
    found = leading_float(text)
    assert found is not None
    assert math.isnan(found)


@pytest.mark.parametrize(
    "text", ["", " ", "low", ".", "-", "e5", "1e400", "-1e400", "1e-310", "0x1p5000", "٣", "₂"]
)
def test_where_stod_throws(text: str) -> None:
    assert leading_float(text) is None


@pytest.mark.parametrize(
    ("text", "number"),
    [("3", 3), ("3.7", 3), (" -2", -2), ("1e3", 1), ("0x10", 0), ("2147483647", 2**31 - 1)],
)
def test_leading_integer(text: str, number: int) -> None:
    assert leading_integer(text) == number


@pytest.mark.parametrize("text", ["", "x", "inf", "2147483648", "-2147483649", "9" * 5000, ".5"])
def test_where_stoi_throws(text: str) -> None:
    assert leading_integer(text) is None


@pytest.mark.parametrize(
    ("text", "answer"),
    [
        ("1.", 1.0),
        ("1e-400", 0.0),
        ("9" * 400, "is too large"),
        ("1_0", "is not a number"),
        ("0x10", "is not a number"),
        ("1,5", "has a comma"),
        ("-inf", "is not finite"),
    ],
)
def test_parse_number(text: str, answer: float | str) -> None:
    assert parse_number(text) == answer
