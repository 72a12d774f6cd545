"""XML documents with line numbers, read without trusting them.

The one place that imports lxml. Entities are not resolved, nothing is fetched, and a document
that is large beyond reason is refused, so that no file of a user can make wsgen read another one
or grow without end.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from lxml import etree

if TYPE_CHECKING:
    from collections.abc import Iterator

Element = etree._Element  # noqa: SLF001  lxml has no public name for the type


@dataclass(frozen=True, kw_only=True)
class Malformed:
    """Why a document is not well-formed XML."""

    message: str
    line: int  # 1-based


def parse(content: str | bytes) -> Element | Malformed:
    """The root element of a document, or what keeps it from being one.

    A text may carry an encoding declaration: it is read as the text it is.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    parser = etree.XMLParser(
        encoding="utf-8" if isinstance(content, str) else None,
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
    )
    if not data.strip():
        return Malformed(message="the document is empty", line=1)
    try:
        return etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        return Malformed(message=error.msg or "not well-formed", line=error.lineno or 1)


def children(element: Element, *tags: str) -> Iterator[Element]:
    """The child elements with one of these names, in document order."""
    for child in element:
        if isinstance(child.tag, str) and child.tag in tags:
            yield child


def child_text(element: Element, tag: str) -> str | None:
    """The stripped text of the first child of that name; None where there is no such child."""
    for child in children(element, tag):
        return (child.text or "").strip()
    return None
