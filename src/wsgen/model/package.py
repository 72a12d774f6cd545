"""What a package is to be: everything that its files are made from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.target import Target

# What a variable of a template is set to: a number, an integer, a boolean or a text.
Answer = float | str


@dataclass(frozen=True, kw_only=True)
class Maintainer:
    """Who answers for a package."""

    name: str  # one line
    email: str  # of the form that package_common.xsd asks for


@dataclass(frozen=True, kw_only=True)
class PackageSpec:
    """A package before it is written."""

    name: str  # after REP-144
    description: str  # may have several lines
    maintainer: Maintainer
    license: str  # SPDX identifier
    template: str  # its name
    target: Target
    answers: Mapping[str, Answer]  # the template's variables
    # Element of package.xml, for example "exec_depend" -> packages; both in the order of the file.
    dependencies: Mapping[str, tuple[str, ...]]
    # Names in the simulator that robots of other packages of the workspace have.
    taken_entities: frozenset[str] = frozenset()
