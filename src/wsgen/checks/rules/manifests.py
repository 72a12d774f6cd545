"""Check what a package.xml says about its package, apart from the names of dependencies."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules.dependencies import all_distros, common_distros
from wsgen.diagnostics import Rule, Severity
from wsgen.packages.workspace.manifest import (
    BUILD_TAGS,
    DEPENDENCY_TAGS,
    EXPORT_TAGS,
    RUN_TAGS,
    TEST_TAGS,
)
from wsgen.text.markup import read_text
from wsgen.text.values import dataclass, lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts
    from wsgen.packages.workspace.manifest import Manifest


UNFINISHED_MANIFEST = Rule(
    code="PKG076",
    name="unfinished-manifest",
    severity=Severity.INFO,
    summary="`package.xml` still has the placeholders that `ros2 pkg create` writes.",
    what="Looks for TODO in the license, the description and the address of the maintainer.",
    why="Without a license, other people may not use the package. Nothing fails.",
    example="<license>TODO: License declaration</license>",
    instead="<license>Apache-2.0</license>",
)
DIFFERENT_FOLDER_NAME = Rule(
    code="PKG077",
    name="different-folder-name",
    severity=Severity.INFO,
    summary="The folder of a package does not have the name of the package.",
    what="Compares the name in `package.xml` with that of the folder, unless one contains the "
    "other or the folder is a repository.",
    why="`colcon`, `ros2 launch` and `$(find ...)` use the name in `package.xml`; the name of "
    "the folder misleads the reader. Nothing fails.",
    example="src/arm_simulation/package.xml: <name>my_robot</name>",
    instead="src/my_robot/package.xml: <name>my_robot</name>",
)
MISSING_BUILDTOOL = Rule(
    code="PKG078",
    name="missing-buildtool-dependency",
    severity=Severity.WARNING,
    summary="`package.xml` of an ament_cmake package does not declare `ament_cmake`.",
    what="Accepts every package whose name begins with `ament_cmake`.",
    why="`rosdep install` does not install ament_cmake, so that the build fails where ROS is not "
    "installed completely, such as in a CI container.",
    example="<export>\n  <build_type>ament_cmake</build_type>\n</export>",
    instead="<buildtool_depend>ament_cmake</buildtool_depend>\n<export>\n"
    "  <build_type>ament_cmake</build_type>\n</export>",
)
MISSING_INTERFACE_GROUP = Rule(
    code="PKG079",
    name="missing-interface-group",
    severity=Severity.ERROR,
    summary="A package with messages is not a member of the group `rosidl_interface_packages`.",
    what="Looks at packages whose CMakeLists.txt gives .msg, .srv or .action files to "
    "rosidl_generate_interfaces().",
    why="`rosidl_generate_interfaces()` requires it, and stops the build.",
    example="<buildtool_depend>rosidl_default_generators</buildtool_depend>",
    instead="<buildtool_depend>rosidl_default_generators</buildtool_depend>\n"
    "<member_of_group>rosidl_interface_packages</member_of_group>",
)
MISSING_INTERFACE_DEPENDENCY = Rule(
    code="PKG080",
    name="missing-interface-dependency",
    severity=Severity.WARNING,
    summary="A package with messages does not declare the packages that generate and load them.",
    what="Looks for `rosidl_default_generators` to build with, and `rosidl_default_runtime` to run "
    "with.",
    why="`rosdep install` does not install them. Where ROS is installed completely, nothing fails.",
    example="<member_of_group>rosidl_interface_packages</member_of_group>",
    instead="<buildtool_depend>rosidl_default_generators</buildtool_depend>\n"
    "<exec_depend>rosidl_default_runtime</exec_depend>\n"
    "<member_of_group>rosidl_interface_packages</member_of_group>",
)
ROS1_PACKAGE = Rule(
    code="PKG081",
    name="ros1-package",
    severity=Severity.WARNING,
    summary="The package is for ROS 1: it is built with catkin.",
    why="ROS 2 does not find the package, and cannot run its nodes and launch files.",
    example="<buildtool_depend>catkin</buildtool_depend>",
    instead="<buildtool_depend>ament_cmake</buildtool_depend>\n<export>\n"
    "  <build_type>ament_cmake</build_type>\n</export>",
)
OLD_FORMAT = Rule(
    code="PKG082",
    name="old-manifest-format",
    severity=Severity.INFO,
    summary="`package.xml` of a ROS 2 package has format 1.",
    why="Format 1 does not have `<depend>`, `<exec_depend>`, conditions and groups. Nothing fails.",
    example="<package>\n  <run_depend>xacro</run_depend>\n</package>",
    instead='<package format="3">\n  <exec_depend>xacro</exec_depend>\n</package>',
)

DEPENDENCY_IN_EXPORT = Rule(
    code="PKG109",
    name="dependency-in-export",
    severity=Severity.WARNING,
    summary="A dependency is inside `<export>`, where `rosdep` and `colcon` do not read it.",
    why="`rosdep` does not install the package, and `colcon` does not build it first.",
    example="<export>\n  <build_type>ament_cmake</build_type>\n"
    "  <exec_depend>xacro</exec_depend>\n</export>",
    instead="<exec_depend>xacro</exec_depend>\n<export>\n"
    "  <build_type>ament_cmake</build_type>\n</export>",
)

GROUP = "rosidl_interface_packages"
GENERATORS = (
    "rosidl_default_generators",
    "rosidl_generator_py",
    "rosidl_cmake",
    "rosidl_core_generators",
)
RUNTIMES = ("rosidl_default_runtime", "rosidl_core_runtime")
_TODO = lazy_pattern(r"\btodo\b", re.IGNORECASE)
# Options of rosidl_generate_interfaces() with which it does not ask for the group.
_WITHOUT_GROUP = lazy_pattern(r"\bSKIP_(?:GROUP_MEMBERSHIP_CHECK|INSTALL)\b")
_INTERFACE = lazy_pattern(r"(?:msg|srv|action)/[^/]+\.(?:msg|srv|action)$")


class Interfaces(NamedTuple):
    """Where a package generates its messages."""

    file: Path
    line: int  # 1-based


def generated_interfaces(name: str, facts: BuildFacts) -> Interfaces | None:
    """The call that surely generates messages; None where there is none.

    It is seen from what is installed: rosidl_generate_interfaces() installs the files of messages.
    """
    if not any(one.name in GENERATORS for one in facts.required_packages):
        return None
    for path, one in facts.shared(name).items():
        if _INTERFACE.match(path) and one.source is not None and one.source.is_file():
            text = read_text(one.file) or ""
            return None if _WITHOUT_GROUP.search(text) else Interfaces(one.file, one.line)
    return None


def check_manifest(
    manifest: Manifest, folder: Path, *, interfaces: Interfaces | None = None
) -> Iterator[Diagnostic]:
    """Check a package.xml.

    Args:
        manifest: of the package.
        folder: where it lies.
        interfaces: the messages that the package generates.
    """
    if manifest.build_type == "catkin":
        if manifest.line_of("export", "build_type") or "catkin" in manifest.names(BUILD_TAGS):
            yield _ros_1(manifest)
        return
    yield from unfinished(manifest)
    for tag in sorted(DEPENDENCY_TAGS):
        for entry in manifest.entries.get(("export", tag), ()):
            yield DEPENDENCY_IN_EXPORT.at(
                manifest.file,
                entry.line,
                entry.text,
                message=f"<{tag}>{entry.text}</{tag}> is inside <export>, where it does not "
                "declare a dependency.",
                hint="Move it out of <export>, above it.",
            )
    if is_other_name(folder, manifest.name):
        yield DIFFERENT_FOLDER_NAME.at(
            manifest.file,
            manifest.line_of("name"),
            manifest.name,
            message=f"The package is named {manifest.name}, but its folder is named {folder.name}.",
            hint=f"Rename the folder to {manifest.name}.",
        )
    if manifest.format == 1:
        yield OLD_FORMAT.at(
            manifest.file,
            manifest.line_of(),
            "package",
            message="package.xml has format 1, which is that of ROS 1.",
            hint='Write <package format="3">, and <exec_depend> for <run_depend>.',
        )
    if (
        manifest.build_type == "ament_cmake"
        and not any(name.startswith("ament_cmake") for name in manifest.names(BUILD_TAGS))
        # With setup.py alone, the build type is what is wrong.
        and (folder.joinpath("CMakeLists.txt").exists() or not folder.joinpath("setup.py").exists())
    ):
        yield MISSING_BUILDTOOL.at(
            manifest.file,
            manifest.line_of("export", "build_type"),
            "ament_cmake",
            message="The build type is ament_cmake, but package.xml does not declare that it "
            "builds with ament_cmake.",
            hint="Add <buildtool_depend>ament_cmake</buildtool_depend> to package.xml.",
        )
    if interfaces is not None:
        yield from check_interfaces(manifest, interfaces)


def is_other_name(folder: Path, name: str) -> bool:
    """Whether the name of a folder leads one to expect another package."""
    word, other = (text.lower().replace("-", "_") for text in (folder.name.strip(), name))
    return not (word in other or other in word or (folder / ".git").exists())


def _ros_1(manifest: Manifest) -> Diagnostic:
    return ROS1_PACKAGE.at(
        manifest.file,
        manifest.line_of("export", "build_type") or manifest.line_of("buildtool_depend"),
        manifest.name,
        message=f"{manifest.name} is a package of ROS 1: its build type is catkin.",
        hint='Port it to ROS 2: docs.ros.org has a guide, "Migrating from ROS 1 to ROS 2".',
    )


_UNFINISHED = {
    "<description>": "what the package does",
    "<maintainer>": "your name and address",
    "<license>": "a license, such as <license>Apache-2.0</license>",
}


def unfinished(manifest: Manifest) -> Iterator[Diagnostic]:
    """Report the placeholders together, at the first of them."""
    found = [
        (entry.line, tag)
        for tag in ("description", "maintainer", "license")
        for entry in manifest.entries.get((tag,), ())
        if _TODO.match(entry.text) or "@todo." in entry.attributes.get("email", "")
    ]
    if found:
        tags = [f"<{tag}>" for _, tag in found]
        listed = " and ".join(filter(None, [", ".join(tags[:-1]), tags[-1]]))
        yield UNFINISHED_MANIFEST.at(
            manifest.file,
            min(line for line, _ in found),
            found[0][1],
            message=f"{listed} of package.xml {'has' if len(tags) == 1 else 'have'} only a "
            "placeholder.",
            hint=f"Write {', and '.join(_UNFINISHED[tag] for tag in dict.fromkeys(tags))}.",
        )


def check_interfaces(manifest: Manifest, interfaces: Interfaces) -> Iterator[Diagnostic]:
    """Check that a package with messages declares what rosidl needs."""
    groups = {entry.text for entry in manifest.entries.get(("member_of_group",), ())}
    if GROUP not in groups:
        yield MISSING_INTERFACE_GROUP.at(
            manifest.file,
            manifest.line_of("export") or manifest.line_of(),
            GROUP,
            message=f"{manifest.name} generates messages ({interfaces.file.name}, line "
            f"{interfaces.line}), but package.xml does not say so, and the build stops.",
            hint=f"Move <member_of_group>{GROUP}</member_of_group> out of <export>, above it."
            if ("export", "member_of_group") in manifest.entries
            else f"Add <member_of_group>{GROUP}</member_of_group> to package.xml, above <export>.",
        )
    for names, tags, tag in (
        (GENERATORS, BUILD_TAGS, "buildtool_depend"),
        (RUNTIMES, RUN_TAGS | EXPORT_TAGS, "exec_depend"),
    ):
        if not manifest.names(tags).intersection(names):
            yield MISSING_INTERFACE_DEPENDENCY.at(
                manifest.file,
                manifest.line_of("member_of_group") or manifest.line_of("export"),
                names[0],
                message=f"{manifest.name} generates messages, but package.xml does not declare "
                f"{names[0]}.",
                hint=f"Add <{tag}>{names[0]}</{tag}> to package.xml.",
            )


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
