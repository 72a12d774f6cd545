"""Mistakes in XML, and documents that are larger than any that people write."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.text import markup, xmlsyntax, xmltree
from wsgen.text.xmlsyntax import DEEPEST, MOST_ATTRIBUTES, find_excess, find_mistake


def with_attributes(number: int) -> bytes:
    return b"<a>\n<b " + b" ".join(b"a%d='1>'" % one for one in range(number)) + b"/></a>"


def nested(number: int) -> str:
    return "<a>" * number + "</a>" * number


def test_the_number_of_attributes_is_limited() -> None:
    assert find_excess(with_attributes(MOST_ATTRIBUTES)) is None
    excess = find_excess(with_attributes(MOST_ATTRIBUTES + 1))
    assert excess is not None
    assert (excess.message, excess.line) == ("an element has more than 1000 attributes", 2)
    assert isinstance(xmltree.parse(with_attributes(2000)), xmltree.Malformed)
    assert xmltree.parse_as_tinyxml(with_attributes(2000).decode()) is None


@pytest.mark.parametrize(
    "text",
    [
        b"a=b " * 5000,
        b"'='" * 5000,
        b"<![CDATA[" + b"=" * 5000 + b"]]>",
        b"<!--" + b"a=b " * 5000 + b"-->",
    ],
)
def test_a_long_text_has_no_attributes(text: bytes) -> None:
    assert find_excess(b"<a>" + text.replace(b"%s", b"a=b " * 5000) + b"</a>") is None


def test_one_limit_of_depth_for_all_parsers() -> None:
    assert find_mistake(nested(DEEPEST).encode()) is None
    assert not isinstance(xmltree.parse(nested(DEEPEST)), xmltree.Malformed)
    assert find_excess(nested(DEEPEST + 1).encode()) is None
    for mistake in (
        find_mistake(nested(DEEPEST + 1).encode()),
        find_excess(nested(DEEPEST + 1).encode(), with_depth=True),
        xmltree.parse(nested(DEEPEST + 1)),
    ):
        assert isinstance(mistake, (xmlsyntax.Mistake, xmltree.Malformed))
        assert mistake.message == "elements are nested more than 256 deep"
    assert len(markup.elements(Path("a.xacro"), nested(20_000))) == DEEPEST


def test_the_number_of_tags_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(xmlsyntax, "MOST_TAGS", 10)
    monkeypatch.setattr(markup, "MOST_ELEMENTS", 3)
    found = xmltree.parse("<a>" + "<b/>" * 9 + "</a>")
    assert isinstance(found, xmltree.Malformed)
    assert found.message == "it has more than 10 tags"
    assert len(markup.elements(Path("a.xacro"), "<a>" + "<b/>" * 9 + "</a>")) == 3


@pytest.mark.parametrize("encoding", ["utf-7", "utf-16", "rot13", "cp037", "x" * 5000])
def test_an_encoding_that_is_not_read(encoding: str) -> None:
    mistake = find_mistake(f'<?xml version="1.0" encoding="{encoding}"?><a/>'.encode())
    assert mistake is not None
    assert mistake.message == f"XML parsers do not read the encoding `{encoding[:40]}`"
    assert mistake.line == 1
