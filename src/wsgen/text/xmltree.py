"""XML documents with line numbers, read without trusting them.

The one place that imports lxml. Entities are not resolved, nothing is fetched, and a document
that is large beyond reason is refused, so that no file of a user can make wsgen read another one
or grow without end.
"""

from __future__ import annotations

import threading
from functools import cache
from typing import TYPE_CHECKING

from lxml import etree

from wsgen.text.values import dataclass, lazy_pattern
from wsgen.text.xmlsyntax import NAMESPACES, find_excess, find_mistake

if TYPE_CHECKING:
    from collections.abc import Iterator


Element = etree._Element  # noqa: SLF001  lxml has no public name for the type

BYTE_ORDER_MARK = b"\xef\xbb\xbf"

# Of libxml2's errors.
HARMLESS = frozenset(
    (
        etree.ErrorTypes.NS_ERR_UNDEFINED_NAMESPACE,
        etree.ErrorTypes.NS_ERR_QNAME,
        etree.ErrorTypes.ERR_ENTITYREF_SEMICOL_MISSING,
        etree.ErrorTypes.ERR_UNDECLARED_ENTITY,
        etree.ErrorTypes.WAR_UNDECLARED_ENTITY,
        etree.ErrorTypes.ERR_MISPLACED_CDATA_END,
    )
)


@dataclass(frozen=True, kw_only=True)
class Malformed:
    """Why a document is not well-formed XML."""

    message: str
    line: int  # 1-based
    hint: str = "Close every element and quote every attribute; & is written &amp;."


def parse(content: str | bytes) -> Element | Malformed:
    """The root element of a document, or what keeps it from being one.

    A text may carry an encoding declaration: it is read as the text it is.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    encoding = "utf-8" if isinstance(content, str) else None
    mistake = find_excess(data)
    if mistake is None:
        try:
            return etree.fromstring(data, _parser_of(encoding, threading.get_ident()))
        except etree.XMLSyntaxError as error:
            mistake = find_mistake(data, encoding)
            if mistake is None and error.msg.startswith("Namespace prefix "):
                prefix = error.msg.split()[2]
                return Malformed(
                    message=f"nothing declares the prefix `{prefix}:`",
                    line=error.lineno or 1,
                    hint=f'Add xmlns:{prefix}="{NAMESPACES.get(prefix, prefix)}" to the root '
                    "element.",
                )
            if mistake is None:
                return Malformed(message=error.msg or "not well-formed", line=error.lineno or 1)
    return Malformed(message=mistake.message, line=mistake.line, hint=mistake.hint)


def parse_as_tinyxml(text: str) -> Element | None:
    """The root element of a document without comments that is only nearly well-formed.

    It may have what tinyxml2, the parser of Gazebo and of robot_state_publisher, accepts: bare
    ampersands, entities and prefixes that are not declared. None where it has anything else.
    """
    data = text.encode("utf-8")
    if find_excess(data) is not None:
        return None
    parser = _parser("utf-8", recover=True)
    try:
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError:
        return None
    errors = [error for error in parser.error_log if error.type not in HARMLESS]
    is_harmless = all(
        "EntityRef" in error.message for error in errors
    )  # others have no name either
    return root if is_harmless else None


QUOTED = lazy_pattern(rb"""=\s*("[^"]*"|'[^']*')""")


def parse_numbers(content: bytes) -> Element | Malformed:
    """The root element of a file whose texts are long lists of numbers.

    It is read as tinyxml2 reads it: byte for byte, whatever encoding it declares, without what
    follows the root element. Texts may have any length; a document type, whose entities could grow
    without end, is refused.
    """
    if b"<!DOCTYPE" in content:
        return Malformed(message="it declares a document type", line=1)
    parser = _parser("iso-8859-1", recover=True, large=True)
    try:
        root = etree.fromstring(content.removeprefix(BYTE_ORDER_MARK), parser)
    except etree.XMLSyntaxError as error:
        return Malformed(message=error.msg or "not well-formed", line=error.lineno or 1)
    for noted in parser.error_log:
        if noted.type == etree.ErrorTypes.ERR_DOCUMENT_END:
            break
        if noted.type == etree.ErrorTypes.ERR_LT_IN_ATTRIBUTE:  # tinyxml2 takes it
            quoted = QUOTED.sub(lambda found: found[0].replace(b"<", b"&lt;"), content)
            if quoted != content:
                return parse_numbers(quoted)
        if noted.type not in HARMLESS:
            return Malformed(message=noted.message, line=noted.line or 1)
    return Malformed(message="the document is empty", line=1) if root is None else root


@cache
def _parser_of(encoding: str | None, _thread: int) -> etree.XMLParser:
    """A parser of a thread, for all its documents.

    A new one takes as long as a small document. Its elements hold it and it holds them, so that
    both would stay until the garbage collector looks for them.
    """
    return _parser(encoding)


def _parser(encoding: str | None, *, recover: bool = False, large: bool = False) -> etree.XMLParser:
    return etree.XMLParser(
        encoding=encoding,
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=large,
        remove_comments=True,
        remove_pis=True,
        recover=recover,
    )


def children(element: Element, *tags: str) -> Iterator[Element]:
    """The child elements with one of these names, in document order."""
    for child in element:
        if isinstance(child.tag, str) and child.tag in tags:
            yield child


def gz_attribute(element: Element, name: str) -> str | None:
    """The value of `gz:NAME` or `ignition:NAME`, with its namespace declared or not, if there."""
    for key, value in element.attrib.items():
        if str(key).endswith((f"}}{name}", f":{name}")):
            return str(value)
    return None


def child_text(element: Element, tag: str) -> str | None:
    """The stripped text of the first child of that name; None where there is no such child."""
    for child in children(element, tag):
        return (child.text or "").strip()
    return None


def child_texts(element: Element) -> dict[str, tuple[str, ...]]:
    """The stripped texts of all child elements by their names, each in document order."""
    texts: dict[str, tuple[str, ...]] = {}
    for child in element:
        if isinstance(child.tag, str):
            texts[child.tag] = (*texts.get(child.tag, ()), (child.text or "").strip())
    return texts
