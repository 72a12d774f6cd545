"""The text of an SDF file to elements, as forgiving as Gazebo's own parser is."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.files import save_as_utf8, wide_encoding
from wsgen.xmltree import Malformed, parse, parse_as_tinyxml

if TYPE_CHECKING:
    from wsgen.xmltree import Element

MARK = "\ufeff"  # of the order of bytes
DECLARATION = ("<?xml", "?>")
ENTITY = r"&(?!(?:lt|gt|amp|quot|apos|#\w+);)\w"
COMMENT = ("<!--", "-->")
AHEAD = {"<?": "?>", "<!--": "-->", "<!": ">"}  # what may be before the root element, and its end


class Slip(NamedTuple):
    """What is wrong with a document."""

    code: str
    message: str
    line: int  # 1-based
    hint: str


class Document(NamedTuple):
    """What a text holds."""

    root: Element | None  # None: nothing that can be read
    slips: tuple[Slip, ...] = ()  # errors where there is no root, else warnings


def is_sdf(text: str) -> bool:
    """Whether the root element of a text is <sdf>; all else may be a URDF, or nothing."""
    place = 0
    while True:
        while place < len(text) and (text[place].isspace() or text[place] == MARK):
            place += 1
        end = next((end for start, end in AHEAD.items() if text.startswith(start, place)), None)
        if end is None:
            return text.startswith("<sdf", place) and not text[place + 4 : place + 5].isalnum()
        found = text.find(end, place)
        if found < 0:
            return False
        place = found + len(end)


def read_document(content: str | bytes) -> Document:
    """The elements of a text; bytes are read as UTF-8, whatever they declare, as Gazebo does."""
    text, slips = _decoded(content) if isinstance(content, bytes) else (content, ())
    if text is None:
        return Document(None, slips)
    text = _without_declaration(text.removeprefix(MARK))
    if "<!ENTITY" in text and (used := re.search(ENTITY, text)):
        slip = Slip(
            "WLD046",
            "The file declares entities and uses them; Gazebo's parser knows none.",
            text.count("\n", 0, used.start()) + 1,
            "Write the values out.",
        )
        return Document(None, (slip,))
    root = parse(text)
    if not isinstance(root, Malformed):
        _forget_namespace(root)
        return Document(root, slips)
    lenient = parse_as_tinyxml(_without_comments(text))
    if lenient is not None:
        slip = Slip(
            "WLD002",
            f"Not well-formed XML: {root.message}. Gazebo's parser does not mind; others do.",
            root.line,
            "Write &amp; for &, no -- in comments, and declare prefixes with xmlns:PREFIX.",
        )
        return Document(lenient, (*slips, slip))
    is_deep = root.message.startswith("Excessive depth")
    slip = Slip(
        "WLD002",
        "Elements are nested more than 256 deep."
        if is_deep
        else f"The SDF is not well-formed XML: {root.message}.",
        root.line,
        root.hint,
    )
    return Document(None, (*slips, slip))


def _forget_namespace(root: Element) -> None:
    """Gazebo's parser knows none: an element is called what is written."""
    if root.prefix is None and "}" in str(root.tag):
        for element in root.iter():
            if isinstance(element.tag, str) and element.prefix is None:
                element.tag = element.tag.rpartition("}")[2]


def _decoded(data: bytes) -> tuple[str | None, tuple[Slip, ...]]:
    data = data.rstrip(b"\0")  # where a text of C ends
    wide = wide_encoding(data)
    if wide:
        message = f"The file is in {wide}: Gazebo reads UTF-8 alone."
        return None, (Slip("WLD047", message, 1, save_as_utf8(wide)),)
    if b"\0" in data:
        message = "The file is not a text: it has null bytes."
        return None, (Slip("WLD047", message, 1, "Name a text file in UTF-8."),)
    try:
        return data.decode("utf-8"), ()
    except UnicodeDecodeError as error:
        slip = Slip(
            "WLD047",
            "The file is not in UTF-8, which it is read as.",
            data.count(b"\n", 0, error.start) + 1,
            save_as_utf8("ISO-8859-1"),
        )
    return data.decode("utf-8", "replace"), (slip,)


def _without_declaration(text: str) -> str:
    """The text without <?xml …?>, which Gazebo's parser does not look into, nor what is before."""
    start = text.find(DECLARATION[0])
    end = text.find(DECLARATION[1], start)
    if start < 0 or end < 0 or text[:start].strip():
        return text
    return "\n" * text.count("\n", 0, end) + text[end + len(DECLARATION[1]) :]


def _without_comments(text: str) -> str:
    """The text with its line breaks, and nothing else of what is commented out."""
    parts, start = [], 0
    while (begin := text.find(COMMENT[0], start)) >= 0:
        end = text.find(COMMENT[1], begin + len(COMMENT[0]))
        if end < 0:
            break
        parts += [text[start:begin], "\n" * text.count("\n", begin, end)]
        start = end + len(COMMENT[1])
    return "".join((*parts, text[start:]))
