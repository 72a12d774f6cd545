"""Find the sources of templates by their names.

A source of a template that comes with wsgen is named `wsgen:TEMPLATE/PATH`, from everywhere: in
`template.toml`, in {% extends %} and in {% include %}. A source of the current template is named by
its path below the template's folder. Sources outside of these folders have no name.
"""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError

if TYPE_CHECKING:
    from collections.abc import Iterator


_PACKAGE = Path(__file__).parent.parent
_past: Path | None = None


@contextmanager
def templates_of(past: Path | None) -> Iterator[None]:
    """Have the templates in a folder be those of wsgen inside; None: those of now."""
    global _past  # noqa: PLW0603  sources name each other by `wsgen:` alone
    before, _past = _past, past
    try:
        yield
    finally:
        _past = before


def is_past() -> bool:
    """Whether the templates are not those of now."""
    return _past is not None


def templates_folder() -> Path:
    """Find the templates of the installed wheel, or of the checkout of an editable install.

    Raises:
        NotFoundError: neither exists.
    """
    if _past is not None:
        return _past
    for folder in (_PACKAGE / "_templates", _PACKAGE.parent.parent / "templates"):
        if folder.is_dir():
            return folder
    raise NotFoundError(
        f"The templates of wsgen are missing from its installation in {_PACKAGE}.",
        hint="Install wsgen again.",
    )


SHIPPED = "wsgen:"
ENDING = ".j2"
MAXIMUM_BYTES = 2**20  # of a source


class SourceError(Exception):
    """No source has the name; the message continues a sentence that begins with the name."""


def read_source(name: str, folder: Path) -> tuple[str, Path]:
    """Read a source, and return its text and file; `folder` is that of the current template.

    Raises:
        SourceError: it does not exist, or cannot be read.
    """
    file = find_source(name, folder)
    try:
        if file.stat().st_size > MAXIMUM_BYTES:
            raise SourceError(f"is larger than {MAXIMUM_BYTES} bytes")
        return file.read_text(encoding="utf-8"), file
    except OSError as error:
        raise SourceError(f"cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise SourceError(f"is not UTF-8 (byte {error.start})") from error


def find_source(name: str, folder: Path) -> Path:
    """Find the file of a source, which must be a regular file in its folder.

    Raises:
        SourceError: it does not exist.
    """
    is_shipped = name.startswith(SHIPPED)
    root = templates_folder() if is_shipped else folder
    parts = name.removeprefix(SHIPPED).split("/")
    if any(part in {"", ".", ".."} or not part.isprintable() or "\\" in part for part in parts):
        raise SourceError("is not a path below the template's folder with single slashes")
    if not name.endswith(ENDING):
        raise SourceError(f"does not end in {ENDING}")
    file = root.joinpath(*parts)
    # Not for those of wsgen: an installation may link its folders in any way.
    if not is_shipped and not _lies_in(file, root):
        raise SourceError("leads out of the template's folder by a link")
    if not file.is_file():
        raise SourceError("is not a file" if file.exists() else "does not exist")
    return file


def _lies_in(file: Path, folder: Path) -> bool:
    try:
        return file.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):  # links in a circle
        return False
