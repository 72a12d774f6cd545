"""A baseline: what was there before, which stays silent until it is gone.

Lines are not compared, so that other changes of a file do not make old diagnostics new.
"""

from __future__ import annotations

import json
import os
from collections import Counter
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.text.files import read_regular_text
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic

    # Code, file relative to the folder of the baseline, element, message.
    Key = tuple[str, str, str, str]


VERSION = 1
SIZE_LIMIT = 2**26  # bytes
LINES = lazy_pattern(r"\b(lines?) \d+")
FIELDS = ("code", "file", "element", "message")


def render_baseline(diagnostics: Iterable[Diagnostic], folder: Path) -> str:
    """The text of a baseline that is written into a folder."""
    counted = Counter(_key(found, folder) for found in diagnostics)
    document = {
        "version": VERSION,
        "diagnostics": [
            {**dict(zip(FIELDS, key, strict=True)), "count": counted[key]}
            for key in sorted(counted)
        ],
    }
    return json.dumps(document, indent=2, ensure_ascii=False) + "\n"


def load_baseline(file: Path) -> Counter[Key]:
    """Read the baseline in a file.

    Raises:
        NotFoundError: it does not exist.
        NotReadableError: it cannot be read.
        RequestError: it is no baseline.
    """
    try:
        text = read_regular_text(file, SIZE_LIMIT)
    except FileNotFoundError as error:
        raise NotFoundError(
            f"The baseline {file} does not exist.",
            hint=f"Write it first: wsgen check --write-baseline {file}",
        ) from error
    except OSError as error:
        raise NotReadableError(
            f"The baseline {file} cannot be read: {error.strerror}.", hint="Give another file."
        ) from error
    return read_baseline(text, file)


def read_baseline(text: str, file: Path) -> Counter[Key]:
    """How often each diagnostic was there.

    Raises:
        RequestError: The text is no baseline.
    """
    try:
        document = json.loads(text)
        counted: Counter[Key] = Counter()
        for one in {VERSION: document["diagnostics"]}[document["version"]]:
            code, name, element, message = (str(one[field]) for field in FIELDS)
            counted[code, name, element, message] += int(one["count"])
    except (ValueError, KeyError, TypeError) as error:
        raise RequestError(
            f"{file} is not a baseline of this version of wsgen.",
            hint=f"Write it again: wsgen check --write-baseline {file}",
        ) from error
    return counted


def divide_known(
    diagnostics: Iterable[Diagnostic], baseline: Counter[Key], folder: Path
) -> tuple[tuple[Diagnostic, ...], tuple[Diagnostic, ...]]:
    """Those that are new, and those that are in the baseline of a folder."""
    left = Counter(baseline)
    new, known = [], []
    for found in diagnostics:
        key = _key(found, folder)
        if left[key] > 0:
            left[key] -= 1
            known.append(found)
        else:
            new.append(found)
    return tuple(new), tuple(known)


def without_lines(message: str) -> str:
    """A message without the lines that it names: other changes of the file move them."""
    return LINES.sub(r"\1 0", message)


def _key(found: Diagnostic, folder: Path) -> Key:
    base = os.path.realpath(folder)
    file = os.path.relpath(os.path.realpath(found.file), base) if found.file else ""
    # Messages may have paths, which differ from machine to machine.
    message = without_lines(found.message)
    message = message.replace(f"{base}{os.sep}", "").replace(f"{folder}{os.sep}", "")
    # A file cannot have the halves of characters that stand for other bytes of a name.
    name, element, message = (
        text.encode(errors="replace").decode()
        for text in (file.replace(os.sep, "/"), found.element or "", message)
    )
    return found.code, name, element, message
