"""Where the sources of templates lie, and which names they go by.

A source of a template that comes with wsgen is called `wsgen:TEMPLATE/PATH`, from everywhere: in
`template.toml`, in {% extends %} and in {% include %}. A source of the template at hand is called
by its path below the template's folder; there is no name for what lies outside of it.

Where the templates lie.
"""

from __future__ import annotations

from pathlib import Path

from wsgen.errors import NotFoundError

_PACKAGE = Path(__file__).parent.parent


def templates_folder() -> Path:
    """The templates of the installed wheel, or those of the checkout that is installed editable.

    Raises:
        NotFoundError: neither is there.
    """
    for folder in (_PACKAGE / "_templates", _PACKAGE.parent.parent / "templates"):
        if folder.is_dir():
            return folder
    raise NotFoundError(
        f"The templates of wsgen are missing from its installation in {_PACKAGE}.",
        hint="Install wsgen again.",
    )


SHIPPED = "wsgen:"
ENDING = ".j2"
MAXIMUM_BYTES = 2**20  # of a source: more is no template


class SourceError(Exception):
    """A name that no source goes by; the message is the end of a sentence that begins with it."""


def read_source(name: str, folder: Path) -> tuple[str, Path]:
    """The text of a source and its file; `folder` is that of the template at hand.

    Raises:
        SourceError: there is none of this name, or it cannot be read.
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
    """The file of a source, which is a file and nothing else, and in its folder.

    Raises:
        SourceError: there is none of this name.
    """
    is_shipped = name.startswith(SHIPPED)
    root = templates_folder() if is_shipped else folder
    parts = name.removeprefix(SHIPPED).split("/")
    if any(part in {"", ".", ".."} or not part.isprintable() or "\\" in part for part in parts):
        raise SourceError("is no path below the template's folder, written with single slashes")
    if not name.endswith(ENDING):
        raise SourceError(f"does not end in {ENDING}")
    file = root.joinpath(*parts)
    # Ours are not looked at: the folder may be linked together in any way by who installed it.
    if not is_shipped and not _lies_in(file, root):
        raise SourceError("leads out of the template's folder by a link")
    if not file.is_file():
        raise SourceError("is no file" if file.exists() else "does not exist")
    return file


def _lies_in(file: Path, folder: Path) -> bool:
    try:
        return file.resolve().is_relative_to(folder.resolve())
    except (OSError, RuntimeError):  # links in a circle
        return False
