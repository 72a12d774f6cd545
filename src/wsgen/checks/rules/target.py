"""The ROS distribution that a package is for, as far as it is known."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks.rules.dependencies import all_distros, common_distros
from wsgen.packages.workspace.manifest import TEST_TAGS
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection

    from wsgen.packages.workspace.manifest import Manifest


@dataclass(frozen=True, kw_only=True)
class Target:
    """The distributions that a package may be for."""

    distros: tuple[str, ...]  # oldest first; all that are known, if nothing says it
    source: str  # what says it: "--distro", "wsgen.toml", "ROS_DISTRO", "package.xml" or ""

    @property
    def distro(self) -> str | None:
        """The distribution; None where several are possible."""
        return self.distros[0] if len(self.distros) == 1 else None


def target_of(
    manifest: Manifest | None,
    *,
    given: str | None = None,
    recorded: str | None = None,
    sourced: str | None = None,
    workspace: Collection[str] = (),
) -> Target:
    """What says the distribution: in this order, and what the dependencies leave otherwise.

    Args:
        manifest: of the package; None where it has none.
        given: the option of the command.
        recorded: what wsgen.toml says.
        sourced: ROS_DISTRO.
        workspace: the names of all packages of the workspace.
    """
    for distro, source in (
        (given, "--distro"),
        (recorded, "wsgen.toml"),
        (sourced, "ROS_DISTRO"),
    ):
        if distro:
            return Target(distros=(distro,), source=source)
    possible = common_distros(
        one.name
        for one in (manifest.dependencies if manifest else ())
        if one.condition is None and one.tag not in TEST_TAGS and one.name not in workspace
    )
    if not possible or possible == all_distros():
        return Target(distros=all_distros(), source="")
    return Target(distros=possible, source="package.xml")
