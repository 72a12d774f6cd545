"""Check the dependencies of a package.xml against what ROS distributions and rosdep have."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.packages.workspace.manifest import TEST_TAGS, way_between
from wsgen.ros.names import cmake_packages, released_packages, rosdep_keys
from wsgen.text.suggestions import did_you_mean, misspelled_as, some_of
from wsgen.text.tables import read_table

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.packages.workspace.manifest import Dependency, Manifest


MISSPELLED_DEPENDENCY = Rule(
    code="PKG068",
    name="misspelled-dependency",
    severity=Severity.WARNING,
    summary="A dependency in `package.xml` is a misspelled name.",
    what="Compares the dependencies with the packages of the workspace, the packages that are "
    "released for ROS 2 and the keys of rosdep.",
    why="`rosdep install` stops at a name that it does not know, and does not install the package "
    "that was meant.",
    example="<exec_depend>robot_state_publiser</exec_depend>",
    instead="<exec_depend>robot_state_publisher</exec_depend>",
)
CIRCULAR_DEPENDENCY = Rule(
    code="PKG090",
    name="circular-dependency",
    severity=Severity.ERROR,
    summary="Packages of the workspace depend on each other in a cycle.",
    what="Follows the dependencies in `package.xml` from package to package of the workspace, "
    "including test dependencies; each cycle is reported once.",
    why="No package of a cycle can be built first, so that colcon builds nothing: `Unable to "
    "order packages topologically`.",
    example="<exec_depend>my_robot</exec_depend>  <!-- in package.xml of my_robot_description -->\n"
    "<depend>my_robot_description</depend>  <!-- in that of my_robot -->",
    instead="<depend>my_robot_description</depend>  <!-- in package.xml of my_robot -->",
)
UNKNOWN_DEPENDENCY = Rule(
    code="PKG069",
    name="unknown-dependency",
    severity=Severity.INFO,
    summary="A dependency is neither released for ROS 2, nor a rosdep key, nor in the workspace.",
    what="Looks for the name in the workspace, in all distributions from Foxy to Rolling, and in "
    "the keys of rosdep.",
    why="`rosdep install` reports the name and stops, unless the package is cloned into the "
    "workspace first.",
    example="<depend>behaviortree_ros2</depend>",
    instead="<depend>behaviortree_ros2</depend>  <!-- cloned into src: see robot.repos -->",
)
UNRELEASED_DEPENDENCY = Rule(
    code="PKG070",
    name="unreleased-dependency",
    severity=Severity.WARNING,
    severity_varies="an error for packages of Gazebo Classic, which later distributions lack, and "
    "for what launch files use",
    summary="A dependency is not released for the ROS distribution that the package is for.",
    what="Takes the distribution from `--distro`, `wsgen.toml` or `ROS_DISTRO`. Skips packages "
    "that are in the workspace.",
    why="`rosdep install` cannot install it. The packages of Gazebo Classic, such as "
    "`gazebo_ros`, ended with Iron.",
    example="<exec_depend>gazebo_ros</exec_depend>  <!-- on Jazzy -->",
    instead="<exec_depend>ros_gz_sim</exec_depend>",
)
ROS1_DEPENDENCY = Rule(
    code="PKG071",
    name="ros1-dependency",
    severity=Severity.WARNING,
    summary="A package for ROS 2 depends on a package of ROS 1.",
    what="Looks for packages of ROS 1 that have another name in ROS 2, or no successor. Skips "
    "dependencies with a condition that ROS 2 does not meet, and packages of catkin.",
    why="No distribution of ROS 2 has the package: `rosdep install` stops.",
    example="<depend>roscpp</depend>",
    instead="<depend>rclcpp</depend>",
)
NOT_A_ROSDEP_KEY = Rule(
    code="PKG072",
    name="not-a-rosdep-key",
    severity=Severity.WARNING,
    summary="A dependency has the name of a Python module or a library, which has another name "
    "in rosdep.",
    why="`rosdep install` knows system dependencies only by its keys, and stops at another name. "
    "Keys that begin with `python-` are of Python 2, which no system of ROS 2 has.",
    example="<exec_depend>numpy</exec_depend>",
    instead="<exec_depend>python3-numpy</exec_depend>",
)
BUILD_TYPE_AS_DEPENDENCY = Rule(
    code="PKG073",
    name="build-type-as-dependency",
    severity=Severity.WARNING,
    summary="A dependency names the build type `ament_python`, which is not a package.",
    why="`rosdep install` stops at `ament_python`. `<build_type>` alone selects it.",
    example="<buildtool_depend>ament_python</buildtool_depend>",
    instead="<export>\n  <build_type>ament_python</build_type>\n</export>",
)
CONFLICTING_DEPENDENCIES = Rule(
    code="PKG074",
    name="conflicting-dependencies",
    severity=Severity.WARNING,
    summary="No ROS distribution has all dependencies of the package.",
    what="Looks for a package of Gazebo Classic or Ignition beside one that only other "
    "distributions have, both without a condition.",
    why="`rosdep install` fails on every distribution.",
    example="<exec_depend>gazebo_ros</exec_depend>\n<exec_depend>gz_sim_vendor</exec_depend>",
    instead="<exec_depend>ros_gz_sim</exec_depend>\n<exec_depend>gz_sim_vendor</exec_depend>",
)
DUPLICATE_DEPENDENCY = Rule(
    code="PKG075",
    name="duplicate-dependency",
    severity=Severity.INFO,
    summary="A dependency is declared twice.",
    what="Compares elements of one name and without a condition. catkin_pkg refuses a `<depend>` "
    "beside a `<build_depend>` or an `<exec_depend>` of the same package: invalid-manifest.",
    why="One of them has no effect, and is easily overlooked when the other one is changed.",
    example="<exec_depend>xacro</exec_depend>\n<exec_depend>rviz2</exec_depend>\n"
    "<exec_depend>xacro</exec_depend>",
    instead="<exec_depend>xacro</exec_depend>\n<exec_depend>rviz2</exec_depend>",
)

# Package of ROS 1 -> what ROS 2 has instead; the first one for a package of Python.
OF_ROS_1 = read_table(__file__, "of-ros-1.txt")
# What Python modules, PyPI and CMake call what rosdep calls otherwise.
KEYS = {
    "boost": "boost",
    "cv2": "python3-opencv",
    "eigen3": "eigen",
    "opencv": "libopencv-dev",
    "opencv-python": "python3-opencv",
    "opencv_python": "python3-opencv",
    "pcl": "libpcl-all-dev",
    "pil": "python3-pil",
    "pillow": "python3-pil",
    "pip": "python3-pip",
    "pykdl": "python3-pykdl",
    "pyserial": "python3-serial",
    "pyyaml": "python3-yaml",
    "qt5": "qtbase5-dev",
    "rclpy_action": "rclpy",
    "rclpy_lifecycle": "rclpy",
    "scikit-learn": "python3-sklearn",
    "yaml_cpp": "yaml-cpp",
}
# Package of Gazebo Classic -> what does its work in Gazebo Sim.
FOR_GAZEBO_SIM = {
    "gazebo_dev": "gz_sim_vendor",
    "gazebo_ros": "ros_gz_sim",
    "gazebo_ros_pkgs": "ros_gz",
    "gazebo_plugins": "ros_gz_sim",
    "gazebo_ros2_control": "gz_ros2_control",
    "gazebo_msgs": "ros_gz_interfaces",
    "ign_ros2_control": "gz_ros2_control",
    "ros_ign": "ros_gz",
    "ros_ign_bridge": "ros_gz_bridge",
    "ros_ign_image": "ros_gz_image",
    "ros_ign_interfaces": "ros_gz_interfaces",
    "ros_ign_gazebo": "ros_gz_sim",
}
# Without which what a package starts or builds is not there; others bring only messages.
PACKAGES_OF_CLASSIC = frozenset(
    ("gazebo_dev", "gazebo_ros", "gazebo_ros_pkgs", "gazebo_plugins", "gazebo_ros2_control")
)
SHORTEST = 5  # characters of a name in which a typing mistake can be recognized


def check_dependencies(
    manifest: Manifest,
    *,
    workspace: Collection[str],
    distro: str | None,
    launched: Collection[str] = (),
) -> Iterator[Diagnostic]:
    """Check each dependency that counts in ROS 2.

    Args:
        manifest: of a package that is not of ROS 1.
        workspace: the names of all packages of the workspace.
        distro: the distribution that the package is for; None where it is not known.
        launched: the packages that its launch files look up when they are evaluated.
    """
    counting = [
        one
        for one in manifest.dependencies
        if one.holds(distro) is not False and one.name not in workspace
    ]
    unreported = [one for one in counting if not is_known(one.name)]
    reported: set[str] = set()
    for one in unreported:
        if one.name not in reported:
            reported.add(one.name)
            yield _unknown(manifest, one, workspace)
    if distro is not None and distro in all_distros():
        yield from _unreleased(manifest, counting, distro, launched)
    else:
        yield from _conflicting(manifest, counting)
    yield from duplicate_dependencies(manifest)


def successor(name: str, distro: str | None) -> str | None:
    """What a distribution has in the place of a package of Gazebo that is not released for it.

    Without a distribution what some have. None where the package is there, or nothing replaces it.
    """
    released = released_packages()
    instead = FOR_GAZEBO_SIM.get(name)
    if instead is None or distro in released.get(name, ()):
        return None
    return instead if distro is None or distro in released.get(instead, ()) else None


def is_known(name: str) -> bool:
    """Whether a distribution of ROS 2 has released the package, or rosdep or CMake knows it."""
    return name in released_packages() or (
        (name in rosdep_keys() or name in cmake_packages()) and not _is_of_python_2(name)
    )


def _is_of_python_2(name: str) -> bool:
    rest = name.removeprefix("python-")
    return rest != name and not name.endswith("-pip") and f"python3-{rest}" in rosdep_keys()


@cache
def all_distros() -> tuple[str, ...]:
    """The distributions whose packages are known, oldest first."""
    return max(released_packages().values(), key=len)


def rosdep_key(name: str) -> str | None:
    """The key of rosdep that somebody may have meant by the name of a module or a library."""
    keys = rosdep_keys()
    lower = name.lower()
    if lower in KEYS:
        return KEYS[lower]
    bare = lower.removeprefix("python3-").removeprefix("python-").replace("_", "-")
    guesses = (f"python3-{bare}", f"python3-{bare}-pip", f"python-{bare}-pip")
    return next((guess for guess in guesses if guess in keys and guess != name), None)


def _unknown(manifest: Manifest, one: Dependency, workspace: Collection[str]) -> Diagnostic:
    element = f"<{one.tag}>{one.name}</{one.tag}>"
    if one.name == "ament_python":
        return BUILD_TYPE_AS_DEPENDENCY.at(
            manifest.file,
            one.line,
            one.name,
            message="`ament_python` is a build type, not a package that can be installed.",
            hint=f"Remove {element}.",
        )
    if one.name in OF_ROS_1:
        successors = OF_ROS_1[one.name]
        return ROS1_DEPENDENCY.at(
            manifest.file,
            one.line,
            one.name,
            message=f"The dependency `{one.name}` is a package of ROS 1.",
            hint=f"Write {' or '.join(f'<{one.tag}>{name}</{one.tag}>' for name in successors)}."
            if successors
            else f"Remove {element}: ROS 2 has no package that replaces it.",
        )
    key = rosdep_key(one.name)
    if key is not None:
        return NOT_A_ROSDEP_KEY.at(
            manifest.file,
            one.line,
            one.name,
            message=f"rosdep has no key `{one.name}`."
            if not _is_of_python_2(one.name)
            else f"The rosdep key `{one.name}` is of Python 2.",
            hint=f"Write <{one.tag}>{key}</{one.tag}>.",
        )
    meant = _meant(one.name, {*workspace} - {manifest.name})
    if meant is not None:
        return MISSPELLED_DEPENDENCY.at(
            manifest.file,
            one.line,
            one.name,
            message=f"Neither ROS 2, nor rosdep, nor this workspace has a package `{one.name}`.",
            hint=f"{did_you_mean(meant)} Write <{one.tag}>{meant}</{one.tag}>.",
        )
    is_of_system = one.name.startswith(("python3-", "python-", "lib")) or one.name.endswith("-dev")
    return UNKNOWN_DEPENDENCY.at(
        manifest.file,
        one.line,
        one.name,
        message=f"rosdep has no key `{one.name}`."
        if is_of_system
        else f"Neither ROS 2, nor rosdep, nor this workspace has a package `{one.name}`.",
        hint=f"Remove {element}, and say in the README how to install it."
        if is_of_system
        else f"Clone {one.name} into the workspace, or check the name.",
    )


def _meant(name: str, workspace: Iterable[str]) -> str | None:
    """The known name that differs by a typing mistake."""
    if len(name) < SHORTEST:
        return None
    return misspelled_as(name, workspace) or misspelled_as(
        name, (*released_packages(), *rosdep_keys())
    )


def _unreleased(
    manifest: Manifest, counting: Iterable[Dependency], distro: str, launched: Collection[str]
) -> Iterator[Diagnostic]:
    released = released_packages()
    reported: set[str] = set()
    for one in counting:
        distros = released.get(one.name)
        if distros is None or distro in distros or one.name in reported | rosdep_keys():
            continue
        reported.add(one.name)
        instead = FOR_GAZEBO_SIM.get(one.name)
        fits = instead is not None and distro in released.get(instead, ())
        yield UNRELEASED_DEPENDENCY.at(
            manifest.file,
            one.line,
            one.name,
            message=f"The dependency `{one.name}` is not released for ROS 2 {distro}, only for "
            f"{some_of(distros)}.",
            hint=f"Write <{one.tag}>{instead}</{one.tag}>, and use it in the launch files."
            if fits
            else f"Clone {one.name} into the workspace, or replace it.",
            severity=Severity.ERROR
            if one.name in (PACKAGES_OF_CLASSIC if one.tag not in TEST_TAGS else ())
            or (fits and one.name in launched)
            else None,
        )


def common_distros(names: Iterable[str]) -> tuple[str, ...]:
    """The distributions that have all of these packages, oldest first; others do not count."""
    released = released_packages()
    keys = rosdep_keys()
    common = set(all_distros())
    for name in names:
        if name in released and name not in keys:
            common &= {*released[name]}
    return tuple(distro for distro in all_distros() if distro in common)


def _conflicting(manifest: Manifest, counting: Iterable[Dependency]) -> Iterator[Diagnostic]:
    needed = [one for one in counting if one.condition is None and one.tag not in TEST_TAGS]
    if common_distros(one.name for one in needed):
        return
    released = released_packages()
    # The first dependency that no distribution of those before it has.
    for place, one in enumerate(needed):
        if common_distros(other.name for other in needed[: place + 1]):
            continue
        other = next(
            (
                other
                for other in needed[:place]
                if {other.name, one.name} & FOR_GAZEBO_SIM.keys()
                and not common_distros((other.name, one.name))
            ),
            None,
        )
        if other is None:
            return
        yield CONFLICTING_DEPENDENCIES.at(
            manifest.file,
            one.line,
            one.name,
            message=f"No ROS distribution has both `{other.name}` "
            f"({some_of(released[other.name])}) and `{one.name}` ({some_of(released[one.name])}).",
            hint=_how_to_resolve(one, other),
        )
        return


def _how_to_resolve(one: Dependency, other: Dependency) -> str:
    for wrong in (other, one):
        instead = FOR_GAZEBO_SIM.get(wrong.name)
        right = one if wrong is other else other
        if instead is not None and common_distros((instead, right.name)):
            return f"Write <{wrong.tag}>{instead}</{wrong.tag}> for {wrong.name}."
    return 'Replace one of them, or add a condition, such as condition="$ROS_DISTRO == humble".'


def duplicate_dependencies(manifest: Manifest) -> Iterator[Diagnostic]:
    """Report what is declared twice without a condition."""
    first: dict[tuple[str, str], Dependency] = {}
    for one in manifest.dependencies:
        if one.condition is not None:
            continue
        other = first.setdefault((one.tag, one.name), one)
        if other is not one:
            yield DUPLICATE_DEPENDENCY.at(
                manifest.file,
                one.line,
                one.name,
                message=f"<{one.tag}>{one.name}</{one.tag}> is also in line {other.line}.",
                hint=f"Remove line {one.line}."
                if one.line != other.line
                else "Remove one of the two elements.",
            )


def check_circles(manifest: Manifest, manifests: Mapping[str, Manifest]) -> Iterator[Diagnostic]:
    """Report a circle of dependencies that the package is in.

    It is reported of the package of the circle whose name is the first; `manifests` are those of
    the workspace, by name.
    """
    for dependency in _ordered(manifest):
        way = way_between(
            dependency.name,
            manifest.name,
            lambda name: (
                {one.name for one in _ordered(manifests[name])} if name in manifests else ()
            ),
        )
        # What depends on itself alone is reported when its package.xml is read.
        if way is None or len(way) == 1 or min(way) != manifest.name:
            continue
        circle = " → ".join((manifest.name, *way))
        yield CIRCULAR_DEPENDENCY.at(
            manifest.file,
            dependency.line,
            dependency.name,
            message=f"Packages depend on each other: {circle}. colcon does not build the "
            f"workspace.",
            hint="Remove one of these dependencies from package.xml, or move what the packages "
            "share into another package.",
        )
        return


def _ordered(manifest: Manifest) -> tuple[Dependency, ...]:
    """The dependencies by which colcon orders packages."""
    return tuple(
        one for one in manifest.dependencies if one.tag != "doc_depend" and one.condition is None
    )
