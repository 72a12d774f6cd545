"""ROS_DISTRO of nodes: the distribution that they were written for, not that of the wheels.

Nodes and launch files choose message types by it: those of the TurtleBot3 publish a Twist on Humble
and a TwistStamped on any other, as the plugins of their robot read them there.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.checks.rules.target import target_of
from wsgen.model.facts import DISTROS
from wsgen.model.target import DISTROS_WITH_CLASSIC, Target

if TYPE_CHECKING:
    from collections.abc import Collection

    from wsgen.packages.workspace.manifest import Manifest
    from wsgen.ros.environment import RosEnvironment

VARIABLE = "ROS_DISTRO"


def distro_of_nodes(  # noqa: PLR0913  all that says it
    manifest: Manifest | None,
    *,
    simulator: str | None,
    installed: str,
    set_by_user: str | None = None,
    recorded: str | None = None,
    workspace: Collection[str] = (),
) -> str:
    """The distribution that nodes see.

    Args:
        manifest: Of the package that is launched; None where it has none.
        simulator: What the launch file starts, a key of `SIMULATORS`.
        installed: The distribution of the ROS that runs; the answer where it is a possible one.
        set_by_user: ROS_DISTRO of the shell.
        recorded: What wsgen.toml says.
        workspace: The names of all packages of the workspace.
    """
    target = target_of(manifest, recorded=recorded, sourced=set_by_user, workspace=workspace)
    if set_by_user or target.distro is not None:
        return set_by_user or target.distros[0]
    possible = [one for one in target.distros if one in DISTROS]
    if simulator == "classic":
        possible = [one for one in possible if one in DISTROS_WITH_CLASSIC] or [
            *DISTROS_WITH_CLASSIC
        ]
    if installed in possible or not possible:
        return installed
    # The newest with long-term support: the one that most people have.
    lasting = [one for one in possible if _is_lasting(one)]
    return (lasting or possible)[-1]


def with_distro(ros: RosEnvironment, distro: str) -> RosEnvironment:
    """That ROS, with another ROS_DISTRO for its processes; a sourced one keeps its own."""
    if ros.is_sourced:
        return ros
    return replace(ros, variables={**ros.variables, VARIABLE: distro})


def _is_lasting(distro: str) -> bool:
    return Target(distro=distro, simulator="gz").fact("support") == "long-term"
