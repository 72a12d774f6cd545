"""Check the build type of a package.xml, by which colcon chooses how to build the package."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.packages.workspace.manifest import DEFAULT_BUILD_TYPE
from wsgen.text.suggestions import misspelled_as, suggest

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from wsgen.diagnostics import Diagnostic
    from wsgen.packages.workspace.manifest import Manifest


UNKNOWN_BUILD_TYPE = Rule(
    code="PKG008",
    name="unknown-build-type",
    severity=Severity.ERROR,
    summary="`colcon` does not know the build type of a package.",
    what="`wsgen build` asks colcon; `wsgen check` looks for a typing mistake in `ament_cmake`, "
    "`ament_python`, `cmake` or `catkin`, as extensions of colcon may add others.",
    why="`colcon` skips the package, and its message does not name it.",
    example="<build_type>ament_cmke</build_type>",
    instead="<build_type>ament_cmake</build_type>",
)
MISSING_BUILD_TYPE = Rule(
    code="PKG009",
    name="missing-build-type",
    severity=Severity.ERROR,
    summary="The package.xml of an ament package has no build type.",
    what="Looks at packages whose CMakeLists.txt calls ament_package(), and at those with setup.py "
    "and without CMakeLists.txt.",
    why="`colcon` then takes the package for one of ROS 1 (catkin). It builds it, but the setup "
    "files do not bring it into the environment of ROS 2.",
    example="<export/>",
    instead="""<export>
  <build_type>ament_cmake</build_type>
</export>""",
)

BUILD_TYPES = ("ament_cmake", "ament_python", "cmake", "catkin")  # of colcon-ros
PLACE = ("export", "build_type")


def check_build_type(
    manifest: Manifest, *, calls_ament_package: bool, is_python: bool
) -> Iterator[Diagnostic]:
    """Report a build type that is missing, or surely misspelled.

    Args:
        manifest: of the package.
        calls_ament_package: whether its CMakeLists.txt surely calls ament_package().
        is_python: whether it has setup.py and no CMakeLists.txt.
    """
    if manifest.line_of(*PLACE) is None:
        if calls_ament_package or is_python:
            yield missing_build_type(
                manifest, "ament_cmake" if calls_ament_package else "ament_python"
            )
        return
    if manifest.build_type not in BUILD_TYPES and misspelled_as(manifest.build_type, BUILD_TYPES):
        yield unknown_build_type(manifest, BUILD_TYPES)


def missing_build_type(manifest: Manifest, build_type: str) -> Diagnostic:
    """Say which one to add."""
    has_export = manifest.line_of("export") is not None
    return MISSING_BUILD_TYPE.at(
        manifest.file,
        manifest.line_of("export"),
        manifest.name,
        message=f"package.xml of {manifest.name} has no build type, so colcon takes it for a "
        f"{DEFAULT_BUILD_TYPE} package of ROS 1, and ROS 2 will not find it.",
        hint=f"{'Add below <export>: ' if has_export else 'Add: <export>'}"
        f"<build_type>{build_type}</build_type>{'' if has_export else '</export>'}",
    )


def unknown_build_type(manifest: Manifest, known: Collection[str]) -> Diagnostic:
    """Suggest one of those that are known."""
    return UNKNOWN_BUILD_TYPE.at(
        manifest.file,
        manifest.line_of(*PLACE),
        manifest.name,
        message=f"colcon does not build {manifest.name}: it does not know the build type "
        f"{manifest.build_type}.",
        hint=suggest(manifest.build_type, known),
    )
