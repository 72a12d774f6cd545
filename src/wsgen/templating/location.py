"""Where the templates lie."""

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
