"""Port package.xml: the dependencies on Gazebo Classic, and what the target does not have."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.manifests import add_export, declare, text_of, top_of
from wsgen.checks.fixes.source import Edit, children, read_tags
from wsgen.checks.rules.dependencies import FOR_GAZEBO_SIM
from wsgen.launching.package_lookup import is_brought
from wsgen.packages.workspace.manifest import RUN_TAGS, holds
from wsgen.porting.ported import FilePort, Unported
from wsgen.ros.names import released_packages, rosdep_keys
from wsgen.text.files import read_regular

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

    from wsgen.checks.fixes.source import SourceText, Tag
    from wsgen.model.target import Target


# Package -> what later distributions have instead; empty where Gazebo Sim does the work itself.
SUCCESSORS = {
    **FOR_GAZEBO_SIM,
    "gazebo": "ros_gz_sim",
    "gazebo9": "ros_gz_sim",
    "gazebo11": "ros_gz_sim",
    **dict.fromkeys(
        ("effort_controllers", "position_controllers", "velocity_controllers"),
        "forward_command_controller",
    ),
    "gazebo_ros2_control_demos": "gz_ros2_control_demos",
    "ign_ros2_control_demos": "gz_ros2_control_demos",
    "joint_state_controller": "joint_state_broadcaster",
    "mppic": "nav2_mppi_controller",
    "nav2_gazebo_spawner": "ros_gz_sim",
    "nav2_recoveries": "nav2_behaviors",
    "ros_ign_gazebo_demos": "ros_gz_sim_demos",
    "smac_planner": "nav2_smac_planner",
    "velodyne_gazebo_plugins": "",
    "velodyne_simulator": "velodyne_description",
}
# Keys of rosdep for Gazebo Classic, which the Ubuntu of later distributions lacks.
_KEYS = ("gazebo", "gazebo9", "gazebo11")
MESSAGES = "gazebo_msgs"  # of the services of Classic; some packages compile against it
_CODE = (".py", ".cpp", ".cc", ".cxx", ".c", ".hpp", ".hh", ".hxx", ".h")
_CODE_LIMIT = 2**20  # bytes
SEARCHED = '<gazebo_ros gazebo_model_path="${prefix}/.."/>'


class Declared(NamedTuple):
    """A dependency as it is written, and what it becomes."""

    tag: Tag
    name: str
    becomes: str  # the same name: it stays; empty: it goes


def code_with(folder: Path, pattern: bytes, ported: Collection[Path] = ()) -> Path | None:
    """The first source file of nodes or plugins, in the order of names, that has a pattern.

    Files that are `ported` have it no longer.
    """
    for file in sorted(folder.rglob("*")):
        if file.suffix not in _CODE or file.name.endswith(".launch.py") or file in ported:
            continue
        try:
            data = read_regular(file, _CODE_LIMIT)
        except (OSError, ValueError):
            continue
        if re.search(pattern, data):
            return file
    return None


def naming(package: str) -> bytes:
    """The pattern of the name of a package."""
    return rf"\b{package}\b".encode()


def port_manifest(  # noqa: PLR0913  three have defaults
    source: SourceText,
    target: Target,
    needs: frozenset[str],
    *,
    workspace: Collection[str] = (),
    has_models: bool = False,
    ported: Collection[Path] = (),
) -> FilePort:
    """Declare what a package needs in the place of what it needed for Gazebo Classic.

    Args:
        source: The text of package.xml.
        target: The distribution, with Gazebo Sim.
        needs: The packages that its other files need now.
        workspace: The names of all packages of the workspace.
        has_models: `package://` or `model://` addresses name files of this package, so that Gazebo
            must find its folder.
        ported: Programs that call services of Gazebo Classic no longer.
    """
    root, top = top_of(source)
    if root is None or root.end is None:
        return FilePort()
    user = (
        code_with(source.file.parent, naming(MESSAGES), ported) if MESSAGES in source.text else None
    )
    declared = [
        Declared(tag, name, _successor(name, target, workspace, calls_classic=user is not None))
        for tag in top
        if tag.name.endswith("depend") and tag.end is not None and (name := text_of(source, tag))
        if "condition" not in tag.attributes
        or holds(tag.attributes["condition"].text, target.distro)
    ]
    edits, gone = rename_dependencies(source, declared)
    kept = {one.becomes for one in declared if one.tag.name in RUN_TAGS}
    own = next((text_of(source, tag) for tag in top if tag.name == "name"), "")
    missing = sorted(
        name for name in needs if name not in {*kept, own} and not is_brought(name, kept)
    )
    edits += declare(source, [("exec_depend", name) for name in missing], gone=gone)
    if has_models:
        edits += search_models(source, top)
    return FilePort(
        edits=tuple(edits), unported=tuple(_unported(source, declared, target, workspace, user))
    )


def _successor(
    name: str, target: Target, workspace: Collection[str], *, calls_classic: bool
) -> str:
    """What a dependency becomes: the same where it stays."""
    released = released_packages()
    if name in workspace or name not in SUCCESSORS:
        return name
    instead = SUCCESSORS[name]
    if name == MESSAGES:
        return name if calls_classic else ""
    is_of_gazebo = name in FOR_GAZEBO_SIM or name in _KEYS
    if not is_of_gazebo and target.distro in released.get(name, ()):
        return name
    return instead if not instead or target.distro in released.get(instead, ()) else name


def rename_dependencies(
    source: SourceText, declared: list[Declared]
) -> tuple[list[Edit], list[Tag]]:
    """Write the new names, each once with a tag; return the elements that go, too."""
    edits: list[Edit] = []
    gone: list[Tag] = []
    whole = {one.becomes for one in declared if one.tag.name == "depend"}
    changed = {one.becomes for one in declared if one.becomes != one.name}
    # What was written under the new name before comes first.
    seen = {(one.tag.name, one.name) for one in declared if one.becomes == one.name}
    for one in declared:
        key = (one.tag.name, one.becomes)
        is_covered = (
            one.becomes in changed & whole
            and one.tag.name not in {"depend", "doc_depend"}
            and not one.tag.name.startswith("buildtool")
        )
        if one.tag.end is not None and (
            is_covered or (one.becomes != one.name and (not one.becomes or key in seen))
        ):
            start, end = source.whole_lines(one.tag.start.start, one.tag.end.end)
            edits.append(Edit(start=start, end=end, text=""))
            gone.append(one.tag)
            continue
        if one.becomes != one.name:
            start = source.text.index(one.name, one.tag.start.end)
            edits.append(Edit(start=start, end=start + len(one.name), text=one.becomes))
        seen.add(key)
    return edits, gone


def search_models(source: SourceText, top: list[Tag]) -> list[Edit]:
    """Have Gazebo look for models in the folder that the package is installed into."""
    tags = read_tags(source.text)
    for export in top:
        if export.name != "export":
            continue
        for one in children(tags, export):
            path = one.attributes.get("gazebo_model_path")
            folders = path.text.split(":") if path is not None else []
            if one.name == "gazebo_ros" and any(
                folder.rstrip("/").endswith("}/..") for folder in folders
            ):
                return []
    return add_export(source, SEARCHED)


def _unported(
    source: SourceText,
    declared: list[Declared],
    target: Target,
    workspace: Collection[str],
    user: Path | None,
) -> Iterator[Unported]:
    """What stays and is not released for the target, and what is for Gazebo Classic alone."""
    released, keys = released_packages(), rosdep_keys()
    seen = set[str]()
    for one in declared:
        if one.becomes != one.name or one.name in {*seen, *workspace}:
            continue
        seen.add(one.name)
        line = source.line_at(one.tag.start.start)
        distros = released.get(one.name)
        if one.name == MESSAGES:
            yield Unported(
                source.file,
                line,
                f"The messages of `{one.name}` are for services of Gazebo Classic, which "
                f"{user.name if user else 'the code'} calls.",
                f"Use those of `{SUCCESSORS[MESSAGES]}`, through a bridge.",
            )
        elif distros is not None and target.distro not in distros and one.name not in keys:
            instead = SUCCESSORS.get(one.name)
            yield Unported(
                source.file,
                line,
                f"The dependency `{one.name}` is not released for ROS 2 {target.distro}.",
                f"Replace it by `{instead}`."
                if instead
                else "Clone it into the workspace, or replace it.",
            )
