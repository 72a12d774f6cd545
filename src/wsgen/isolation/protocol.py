"""What callers need of whoever starts child processes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.isolation.outcome import Answered, Died, Limits


class Run(Protocol):
    """`wsgen.isolation.parent.run`, or the method of that name of a nursery."""

    def __call__(
        self,
        task: str,
        *arguments: object,
        limits: Limits = ...,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> Answered | Died:
        """Call `module:function` with the arguments in a child process."""
