"""What `wsgen check` makes of packages that are not on this machine."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.description_rules import MISSING_COLLISION_MESH, MISSING_VISUAL_MESH
from wsgen.diagnostics import Severity
from wsgen.launch.explain_missing import PACKAGE_NOT_FOUND
from wsgen.ros_names import released_packages
from wsgen.xacro.reader import XACRO_FILE_FAILS

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from wsgen.diagnostics import Diagnostic

_OF_PACKAGES = frozenset(
    rule.code
    for rule in (MISSING_COLLISION_MESH, MISSING_VISUAL_MESH, PACKAGE_NOT_FOUND, XACRO_FILE_FAILS)
)
_ABSENT = re.compile(
    r"package ['`]([^'`]+)['`](?: is not found|, which was not found| is needed, and the package)"
)


def without_absent_packages(
    diagnostics: Iterable[Diagnostic], declared: Collection[str]
) -> Iterator[Diagnostic]:
    """Take what a package that is not on this machine would have for what it is: unknown.

    `package.xml` declares the packages of `declared`: the user has them where the package runs.
    Neither is a package that is released an error of the user. Of an include that is not found,
    only one diagnostic is left.
    """
    found = list(diagnostics)
    looked_up = {(one.file, one.line) for one in found if one.code == PACKAGE_NOT_FOUND.code}
    for one in found:
        absent = _ABSENT.search(one.message) if one.code in _OF_PACKAGES else None
        if absent is None:
            yield one
        elif one.code == XACRO_FILE_FAILS.code and (one.file, one.line) in looked_up:
            continue
        elif absent[1] in declared or absent[1] in released_packages():
            yield replace(one, severity=Severity.INFO)
        elif one.code == MISSING_COLLISION_MESH.code and not _is_in_own_package(one):
            yield replace(one, severity=Severity.WARNING)  # it may be in another workspace
        else:
            yield one


def _is_in_own_package(missing: Diagnostic) -> bool:
    """Whether the mesh is in the robot's package: the address leaves out the name of that."""
    return (missing.hint or "").startswith("Write package://")
