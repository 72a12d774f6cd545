"""Live runs need Linux; the other modules cannot even be imported elsewhere."""

from __future__ import annotations

from wsgen.errors import NotFoundError
from wsgen.isolation import system


def require_linux(what: str, instead: str) -> None:
    """Refuse what runs nodes where their processes could not be ended for certain.

    Args:
        what: Its name, with which the message begins.
        instead: What can be done elsewhere, a sentence.

    Raises:
        NotFoundError: This is not Linux.
    """
    if not system.has_guards():
        raise NotFoundError(
            f"{what} needs Linux: processes are ended with all that they have started by what "
            "Linux alone has.",
            hint=f"{instead} On Windows use the Windows Subsystem for Linux.",
        )
