"""Why a package failed to build, from what its programs wrote to standard error.

One function for each known cause, tried in order; it yields what it recognizes. The first that
recognizes something has the word, for one cause often makes several messages.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.workspace import cmake_causes, machine_causes, package_causes
from wsgen.workspace.failure import last_words

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.workspace.failure import Failure

CMAKE_ERROR = "BLD015"
UNEXPLAINED_FAILURE = "BLD016"


def explain(failure: Failure) -> tuple[Diagnostic, ...]:
    """Say why the package failed, and what to do."""
    for cause in CAUSES:
        found = tuple(cause(failure))
        if found:
            return found
    return (_unexplained(failure),)


def _any_cmake_error(failure: Failure) -> Iterator[Diagnostic]:
    for error in failure.errors:
        is_named = error.command and error.command not in {"message", error.message.split("(")[0]}
        what = f"{error.command}(): {error.message}" if is_named else error.message
        yield failure.diagnose(
            CMAKE_ERROR, f"CMake: {what}", error=error, hint=failure.where_to_look
        )


def _unexplained(failure: Failure) -> Diagnostic:
    words = last_words(failure.output)
    return failure.diagnose(
        UNEXPLAINED_FAILURE,
        f"the build failed{': ' if words else ' without a word.'}{words}",
        hint=failure.where_to_look,
    )


CAUSES = (
    package_causes.refused_manifest,
    *machine_causes.CAUSES,
    *cmake_causes.CAUSES,
    *package_causes.CAUSES,
    _any_cmake_error,
)
