"""A package that failed to build, and how its diagnostics are made."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.workspace.cmake_output import CMakeError, read_errors

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

LAST_LINES = 5  # of the output of a failure that nobody knows


def last_words(output: str) -> str:
    """Put the end of an output on one line; of a traceback only what it comes to."""
    lines = [line.strip() for line in output.splitlines() if line.strip()]
    return " / ".join(
        lines[-1:] if "Traceback (most recent call" in output else lines[-LAST_LINES:]
    )


@dataclass(frozen=True)
class Failure:
    """A package that failed."""

    package: str
    folder: Path  # with package.xml and CMakeLists.txt
    build_folder: Path  # in which CMake keeps what it has found out
    output: str  # what its programs wrote to standard error
    siblings: Collection[str]  # names of all packages of the workspace
    distro: str  # of the ROS that is sourced; empty without one
    log: Path | None  # the folder with everything that was printed

    @property
    def cmake_file(self) -> Path:
        """The file in which CMake begins."""
        return self.folder / "CMakeLists.txt"

    @cached_property
    def errors(self) -> tuple[CMakeError, ...]:
        """CMake's errors in the output."""
        return read_errors(self.output)

    def diagnose(
        self,
        code: str,
        message: str,
        *,
        hint: str,
        error: CMakeError | None = None,
        line: int | None = None,
    ) -> Diagnostic:
        """Make a diagnostic of the error's call, a line of CMakeLists.txt, or the package."""
        file: Path | None = self.cmake_file if line is not None else None
        if error is not None:
            file, line = error.locate(self.folder)
        return Diagnostic(
            code=code,
            severity=Severity.ERROR,
            message=f"{self.package}: {message}",
            file=file or self.folder,
            line=line,
            element=self.package,
            hint=hint,
        )

    @property
    def forget(self) -> str:
        """What to do where CMake has remembered something wrong."""
        return f"Then remove {self.build_folder}, where CMake remembers, and build again."

    @property
    def where_to_look(self) -> str:
        """Where everything is that was printed."""
        if self.log is None:
            return "Build again with --verbose to see everything that is printed."
        return f"Everything that was printed: {self.log / self.package / 'stdout_stderr.log'}"
