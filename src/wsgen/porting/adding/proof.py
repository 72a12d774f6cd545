"""Whether as much is reported about a package as before something was added to it."""

from __future__ import annotations

import os
from collections import Counter
from typing import TYPE_CHECKING

from wsgen.diagnostics import Severity
from wsgen.pipeline.check import CheckRequest, check

if TYPE_CHECKING:
    from wsgen.diagnostics import Diagnostic
    from wsgen.porting.adding.addition import Addition


class Reported:
    """What `wsgen check` reports about a package, before and after.

    Attributes:
        more: What it reports now and did not before.
    """

    def __init__(self, addition: Addition) -> None:
        self._request = CheckRequest(paths=[addition.folder], distro=addition.target.distro)
        self._before = Counter(map(_key, self._diagnostics()))
        self.more: list[Diagnostic] = []

    def is_as_before(self) -> bool:
        """Whether nothing more is reported now; lines may be others."""
        known = Counter(self._before)
        for one in self._diagnostics():
            if known[_key(one)] > 0:
                known[_key(one)] -= 1
            else:
                self.more.append(one)
        return not self.more

    def _diagnostics(self) -> list[Diagnostic]:
        found = check(self._request, environment=os.environ).diagnostics
        return [one for one in found if one.severity is not Severity.INFO]


def _key(found: Diagnostic) -> tuple[str, str | None, str | None]:
    return found.code, None if found.file is None else found.file.name, found.element
