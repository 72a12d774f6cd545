"""Where in the xacro files a finding about the expanded robot belongs.

xacro keeps no line numbers: what is found in the expanded text is looked up by element and name in
the file that was expanded and in those that it includes. A name that xacro puts together is found
by its pattern, `${prefix}base_link` for one.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.description.markup import elements, read_text

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.description.markup import Written
    from wsgen.diagnostics import Diagnostic

ShareOf = Callable[[str], Path | None]  # package name -> its installed share folder

FIND = re.compile(r"\$\(find\s+([\w-]+)\s*\)")
COMPUTED = re.compile(r"\$\{[^}]*\}|\$\([^)]*\)")  # by xacro
NAMED = re.compile(r"(\w+)\[@(\w+)='([^']*)'\]")  # link[@name='base_link']
MOST_FILES = 100  # a description in more files than this is included in circles


def place_in_source(
    diagnostics: Iterable[Diagnostic], *, text: str, file: Path | None, share_of: ShareOf
) -> tuple[Diagnostic, ...]:
    """Give findings about `text`, which `file` expanded to, the places in what a person edits.

    A file that holds the text itself keeps the lines. Where an element is not found by its name,
    or several could be meant, the finding names the file alone.
    """
    found = tuple(diagnostics)
    if not found or file is None:
        return tuple(replace(finding, line=None) for finding in found)
    if read_text(file) == text:
        return found
    written = _written(file, share_of)
    return tuple(_placed(finding, written) for finding in found)


def _placed(finding: Diagnostic, written: list[Written]) -> Diagnostic:
    for tag, attribute, value in NAMED.findall(finding.element or ""):
        element = _most_like(
            value, attribute, [element for element in written if element.tag == tag]
        )
        if element is not None:
            return replace(finding, file=element.file, line=element.line)
    return replace(finding, line=None)


def _most_like(value: str, attribute: str, candidates: list[Written]) -> Written | None:
    """The element whose name is the value, or can become it with the fewest letters computed."""
    likeness: dict[int, list[Written]] = {}
    for element in candidates:
        name = element.attributes.get(attribute, "")
        if name == value:
            return element
        literal = COMPUTED.split(name)
        letters = sum(map(len, literal))
        if letters and re.fullmatch(".*".join(map(re.escape, literal)), value, re.DOTALL):
            likeness.setdefault(letters, []).append(element)
    best = likeness[max(likeness)] if likeness else []
    return best[0] if len(best) == 1 else None


def _written(main: Path, share_of: ShareOf) -> list[Written]:
    """The elements of the file and of what it includes, as far as the addresses are known."""
    written: list[Written] = []
    waiting = [main]
    seen: set[Path] = set()
    while waiting and len(seen) < MOST_FILES:
        file = waiting.pop(0)
        text = None if file in seen else read_text(file)
        seen.add(file)
        if text is None:
            continue
        here = elements(file, text)
        written += here
        addresses = [
            element.attributes.get("filename", "")
            for element in here
            if element.tag == "xacro:include"
        ]
        waiting += filter(None, (_included(uri, file, share_of) for uri in addresses))
    return written


def _included(uri: str, by: Path, share_of: ShareOf) -> Path | None:
    package = FIND.match(uri)
    if package is not None:
        share = share_of(package.group(1))
        uri = uri[package.end() :].lstrip("/")
        return None if share is None or "$" in uri else share / uri
    return None if "$" in uri else by.parent / uri
