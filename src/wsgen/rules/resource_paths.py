"""The rule about the search path by which a simulator finds the meshes of packages."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.suggestions import some_of
from wsgen.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.world import Spawn


NO_RESOURCE_PATH = Rule(
    code="LCH090",
    name="no-resource-path",
    severity=Severity.WARNING,
    summary="Nothing tells the simulator where the packages are whose meshes a robot uses.",
    what="Looks, where a spawned robot has meshes of `package://`, for the search path of the "
    "simulator: in the environment that the launch file sets, in `<gazebo_ros "
    "gazebo_model_path=...>` of package.xml, and in environment hooks.",
    why="RViz finds the meshes by the package. The simulator looks for `model://PACKAGE` in its "
    "own search path: the robot is invisible there, or falls through the ground.",
    example='<mesh filename="package://my_robot/meshes/base.stl"/>',
    instead="<!-- package.xml of my_robot -->\n<export>\n"
    '  <gazebo_ros gazebo_model_path="${prefix}/.."/>\n</export>',
)

VARIABLES = {
    "gz": ("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GZ_FILE_PATH", "SDF_PATH"),
    "classic": ("GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH", "SDF_PATH"),
}
# What a package writes that sets one, in package.xml, a hook or a launch file.
SETTING = lazy_pattern(rb"gazebo_model_path|RESOURCE_PATH|GAZEBO_MODEL_PATH|GZ_FILE_PATH|SDF_PATH")
_MESH = lazy_pattern(r"<mesh\b[^>]*?\bfilename\s*=\s*[\"']package://([\w-]+)/")


def no_resource_path(
    spawns: Iterable[Spawn],
    kinds: Collection[str],
    environment: Mapping[str, str],
    sets_path: Callable[[], bool],
) -> Iterator[Diagnostic]:
    """Report robots with meshes that their simulator does not find.

    Args:
        spawns: The robots.
        kinds: The simulators that are started.
        environment: That of the launch, with what the launch file sets.
        sets_path: Whether a package of the workspace sets a search path.
    """
    if len(kinds) != 1 or any(environment.get(name) for kind in kinds for name in VARIABLES[kind]):
        return
    (kind,) = kinds
    for spawn in spawns:
        packages = list(dict.fromkeys(_MESH.findall(spawn.description)))
        if packages and not sets_path():
            yield NO_RESOURCE_PATH.at(
                spawn.process.file if spawn.process else None,
                spawn.process.line if spawn.process else None,
                spawn.entity,
                message=f"The robot uses meshes of {some_of(packages)}, and nothing in the "
                f"workspace sets {VARIABLES[kind][0]}: the simulator does not find them.",
                hint='Add <gazebo_ros gazebo_model_path="${prefix}/.."/> to <export> in '
                f"package.xml of {packages[0]}.",
            )
            return
