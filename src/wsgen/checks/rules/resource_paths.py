"""The rule about the search path by which a simulator finds the meshes of packages.

Source: gazebosim/gz-sim, src/Util.cc; gazebosim/gazebo-classic, gazebo/common/SystemPaths.cc; the
launch files of gazebo_ros and ros_gz_sim, which read the exports of package.xml.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Rule, Severity
from wsgen.model.target import CLASSIC, SIM, SIMULATORS
from wsgen.text.suggestions import some_of
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.world import Spawn


NO_RESOURCE_PATH = Rule(
    code="LCH090",
    name="no-resource-path",
    severity=Severity.WARNING,
    summary="Gazebo does not find the meshes of a robot: its search path lacks their package.",
    what="For `package://` and `model://` meshes of spawned robots in packages of the workspace, "
    "searches the folders of the simulator's variable as the launch file, environment hooks and "
    "the shell set it, and those of `<gazebo_ros gazebo_model_path=...>` in package.xml where the "
    "launch file of `ros_gz_sim` or `gazebo_ros` reads it.",
    why="RViz finds the meshes by their package. Gazebo looks for `model://PACKAGE` in its own "
    "search path: the robot is invisible there, and links with collision meshes fall through the "
    "ground.",
    example='<mesh filename="package://my_robot/meshes/base.stl"/>',
    instead="<!-- package.xml of my_robot -->\n<export>\n"
    '  <gazebo_ros gazebo_model_path="${prefix}/.."/>\n</export>',
)

VARIABLES = {
    SIM: ("GZ_SIM_RESOURCE_PATH", "IGN_GAZEBO_RESOURCE_PATH", "GZ_FILE_PATH", "SDF_PATH"),
    CLASSIC: ("GAZEBO_MODEL_PATH",),
}
_MESH = lazy_pattern(
    r"(?:<mesh\b[^>]*?\bfilename\s*=\s*[\"']|<uri>\s*)(?:package|model)://([\w-]+)/"
)
_LAUNCH_FILE = {SIM: "gz_sim.launch.py of ros_gz_sim", CLASSIC: "gazebo.launch.py of gazebo_ros"}


class SearchPath(NamedTuple):
    """Where a simulator looks for `model://`."""

    folders: tuple[str, ...]
    reads_exports: bool  # of package.xml; their folders are among these
    has_exports: bool = False  # whether there are any
    set_in_vain: str = ""  # a variable that only the other simulator reads


def mesh_packages(text: str) -> list[str]:
    """The packages, or models, that the meshes of a description are looked up in."""
    return list(dict.fromkeys(_MESH.findall(text)))


def no_resource_path(
    spawns: Iterable[Spawn], kind: str, path: SearchPath, is_missing: Callable[[str], bool]
) -> Iterator[Diagnostic]:
    """Report robots with meshes that their simulator does not find.

    Args:
        spawns: The robots.
        kind: The simulator that is started.
        path: Where it looks.
        is_missing: Whether a package is of the workspace and in none of these folders.
    """
    for spawn in spawns:
        packages = [one for one in mesh_packages(spawn.description) if is_missing(one)]
        if packages:
            yield NO_RESOURCE_PATH.at(
                spawn.process.file if spawn.process else None,
                spawn.process.line if spawn.process else None,
                spawn.entity,
                message=f"{SIMULATORS[kind]} does not find the meshes of "
                f"{some_of([f'package://{one}' for one in packages])}, so that `{spawn.entity}` is "
                f"invisible there: {_why(kind, path)}.",
                hint=_what_to_do(kind, path, packages[0]),
            )
            return


def _why(kind: str, path: SearchPath) -> str:
    variable = VARIABLES[kind][0]
    if path.has_exports and not path.reads_exports:
        return (
            f"only the launch file of {_LAUNCH_FILE[kind].rpartition(' ')[2]}, which is not used "
            "here, reads <gazebo_ros> in package.xml"
        )
    if path.set_in_vain:
        return f"it reads {variable}, not {path.set_in_vain}"
    if path.folders:
        return f"no folder of {variable} has the package"
    return f"nothing adds the folder of the package to {variable}"


def _what_to_do(kind: str, path: SearchPath, package: str) -> str:
    if path.reads_exports:
        return (
            'Add <gazebo_ros gazebo_model_path="${prefix}/.."/> to <export> in '
            f"package.xml of {package}."
        )
    return (
        f"Add AppendEnvironmentVariable('{VARIABLES[kind][0]}', "
        f"os.path.join(get_package_prefix('{package}'), 'share')) to the launch file, before it "
        "starts Gazebo."
    )
