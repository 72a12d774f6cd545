"""Read the requests of services from command lines: the YAML of `ros2`, the text format of `gz`.

Of YAML it is a mapping in braces; of the text format of Protocol Buffers `name: value` and
`name { ... }`, with commas or without.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

SPAWNING_REQUESTS = {"SpawnEntity": "xml", "EntityFactory": "sdf"}  # type -> field for a text
ROBOT = lazy_pattern(r"<(?:robot|sdf)\b")
_TOKEN = lazy_pattern(
    r"""(?P<space>[\s,;]+)
    |(?P<brace>[{}\[\]])
    |"(?P<double>(?:[^"\\]|\\.)*)"
    |'(?P<single>(?:[^'\\]|\\.|'')*)'
    |(?P<colon>:)
    |(?P<plain>[^\s,;{}\[\]"'][^,;{}\[\]\n]*?(?=:(?:[\s"'{]|$)|[\s,;{}\[\]]|$))""",
    re.DOTALL | re.VERBOSE,
)
_ESCAPES = {"n": "\n", "t": "\t", "r": "\r", "0": "\0"}
_ESCAPE = lazy_pattern(r"\\(.)", re.DOTALL)


def read_request(text: str) -> dict[str, Any] | None:
    """The fields of a request, texts or such mappings; None where the text is no request."""
    tokens: list[tuple[str, str]] = []
    place = 0
    text = text.strip()
    while place < len(text):
        found = _TOKEN.match(text, place)
        if found is None or found.lastgroup is None:
            return None
        place = found.end()
        if found.lastgroup != "space":
            tokens.append((found.lastgroup, found[found.lastgroup]))
    if tokens[:1] == [("brace", "{")]:
        if tokens.pop() != ("brace", "}"):
            return None
        tokens.pop(0)
    try:
        fields = _fields(tokens)
    except ValueError:
        return None
    return None if tokens else fields  # the tokens of all fields are taken


def requested_texts(words: Iterable[str]) -> Iterator[str]:
    """The robots in the requests that are words of a command line."""
    for word in words:
        if ROBOT.search(word):
            # Where the words are for a shell, there are quotes around the request.
            fields = read_request(word) or read_request(word.strip("'")) or {}
            yield from (fields[name] for name in SPAWNING_REQUESTS.values() if name in fields)


def _fields(tokens: list[tuple[str, str]]) -> dict[str, Any]:
    """Take `name: value` from the tokens, up to the end or to a closing brace.

    Raises:
        ValueError: The tokens are no fields.
    """
    fields: dict[str, Any] = {}
    while tokens and tokens[0] != ("brace", "}"):
        if len(tokens) < 3 or tokens[0][0] == "brace":  # noqa: PLR2004  name, colon or brace, value
            raise ValueError
        name = tokens.pop(0)[1]
        if tokens[0][0] == "colon":
            tokens.pop(0)
        elif tokens[0] != ("brace", "{"):
            raise ValueError
        kind, value = tokens.pop(0)
        if (kind, value) == ("brace", "{"):
            fields[name] = _fields(tokens)
            if not tokens:
                raise ValueError
            tokens.pop(0)
        elif kind in {"double", "single", "plain"}:
            fields[name] = value if kind == "plain" else _unescaped(kind, value)
        else:
            raise ValueError
    return fields


def _unescaped(kind: str, text: str) -> str:
    if kind == "single":
        text = text.replace("''", "'")
    return _ESCAPE.sub(lambda found: _ESCAPES.get(found[1], found[1]), text)
