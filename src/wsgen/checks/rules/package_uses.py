"""Compare the packages that the files of a package use with those that package.xml declares."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks.rules.dependencies import (
    PACKAGES_OF_CLASSIC,
    UNRELEASED_DEPENDENCY,
    all_distros,
    successor,
)
from wsgen.checks.rules.manifests import GENERATORS
from wsgen.diagnostics import Rule, Severity
from wsgen.launching.package_lookup import UNDECLARED_PACKAGE, is_brought, listed, undeclared
from wsgen.packages.workspace.manifest import BUILD_TAGS, DEPENDENCY_TAGS, RUN_TAGS, TEST_TAGS
from wsgen.packages.workspace.package_uses import CONTROLLER, LAUNCH, PLUGIN, is_for_code
from wsgen.ros.names import cmake_packages, released_packages
from wsgen.text.suggestions import did_you_mean, misspelled_as

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts, RequiredPackage
    from wsgen.packages.workspace.manifest import Dependency, Manifest
    from wsgen.packages.workspace.package_uses import PackageUse


NOT_FOR_RUN_TIME = Rule(
    code="PKG084",
    name="not-for-run-time",
    severity=Severity.WARNING,
    summary="A package that is needed at run time is declared for the build alone.",
    what="Looks for packages that launch files, robots or Python nodes use, and that only "
    "`<build_depend>`, `<buildtool_depend>` or `<build_export_depend>` declares.",
    why="Who installs the package as a binary, or with `rosdep install --dependency-types=exec`, "
    "lacks it.",
    example="<build_depend>xacro</build_depend>",
    instead="<exec_depend>xacro</exec_depend>",
)
UNDECLARED_DEPENDENCY = Rule(
    code="PKG085",
    name="undeclared-dependency",
    severity=Severity.WARNING,
    summary="A robot, a Python node or a file of parameters uses packages that `package.xml` does "
    "not declare.",
    what="Looks for `package://` and `$(find ...)` in robots and worlds that are installed, for "
    "the modules of ROS that Python nodes import, and, where launch files of the package start "
    "Gazebo or controllers, for Gazebo's plugins and the types of controllers. Skips what another "
    "declared package brings.",
    why="`rosdep install` does not install them, so that the robot or the node fails on another "
    "machine.",
    example="from geometry_msgs.msg import Twist",
    instead="<!-- package.xml -->\n<exec_depend>geometry_msgs</exec_depend>",
)
UNDECLARED_BUILD_DEPENDENCY = Rule(
    code="PKG087",
    name="undeclared-build-dependency",
    severity=Severity.WARNING,
    summary="CMakeLists.txt requires packages that `package.xml` does not declare.",
    what="Compares `find_package(NAME REQUIRED)` of packages of ROS and of the workspace with all "
    "dependencies. Skips what another declared package brings.",
    why="`rosdep install` does not install them. Of packages of the workspace, `colcon` does not "
    "know the order, and may build them too late.",
    example="find_package(sensor_msgs REQUIRED)",
    instead="<!-- package.xml -->\n<depend>sensor_msgs</depend>",
)
MISSPELLED_REQUIREMENT = Rule(
    code="PKG088",
    name="misspelled-requirement",
    severity=Severity.ERROR,
    summary="`find_package()` requires a known package with a typing mistake.",
    what="Compares names that neither ROS nor the workspace nor CMake has with those of packages "
    "of ROS and of the workspace.",
    why="CMake does not find it, and the build stops.",
    example="find_package(rclcp REQUIRED)",
    instead="find_package(rclcpp REQUIRED)",
)
UNDECLARED_TEST_DEPENDENCY = Rule(
    code="PKG089",
    name="undeclared-test-dependency",
    severity=Severity.WARNING,
    summary="CMakeLists.txt requires packages for its tests that `package.xml` does not declare.",
    what="Compares `find_package(NAME REQUIRED)` of test tools and linters in `if(BUILD_TESTING)` "
    "with all dependencies. Skips what another declared package brings.",
    why="`colcon build` builds the tests, too. `rosdep install` does not install the packages, and "
    "CMake stops on a machine without them.",
    example="if(BUILD_TESTING)\n  find_package(ament_lint_auto REQUIRED)\nendif()",
    instead="<!-- package.xml -->\n<test_depend>ament_lint_auto</test_depend>",
)

UNUSED_DEPENDENCY = Rule(
    code="PKG086",
    name="unused-dependency",
    severity=Severity.INFO,
    summary="No file of the package mentions a package that `package.xml` declares.",
    what="Looks for the names of message packages and libraries of nodes in all files of a package "
    "that installs more than its manifest.",
    why="`rosdep install` installs it for nothing, and the reader looks for its use in vain. "
    "Nothing fails.",
    example="<depend>std_msgs</depend>  <!-- no file has std_msgs -->",
    instead="Remove the element.",
)

# What starts Gazebo, in launch files.
_SIMULATORS = frozenset(("gazebo_ros", "ros_gz_sim", "ros_ign_gazebo"))
# One of these is enough: a robot often has plugins for several simulators.
_ALTERNATIVES = (
    frozenset(("gazebo_ros2_control", "gz_ros2_control", "ign_ros2_control")),
    frozenset(("gazebo_plugins", "gazebo_ros_pkgs", "ros_gz_sim", "ros_gz", "ros_ign_gazebo")),
)


def declared_by(
    manifests: Mapping[str, Manifest],
    name: str,
    tags: Collection[str],
    distro: str | None,
    further: Collection[str] = RUN_TAGS,
) -> frozenset[str]:
    """What a package declares, and, with other tags, the packages of the workspace among that."""
    found = set(manifests[name].names(tags, distro))
    left = found & manifests.keys()
    seen = {name}
    while left:
        one = left.pop()
        if one not in seen:
            seen.add(one)
            those = manifests[one].names(further, distro)
            found |= those
            left |= those & manifests.keys()
    return frozenset(found)


def check_uses(
    manifest: Manifest,
    uses: Sequence[PackageUse],
    *,
    manifests: Mapping[str, Manifest],
    distro: str | None,
) -> Iterator[Diagnostic]:
    """Report what is used at run time and not declared for it, once, where it is used first.

    Args:
        manifest: of the package.
        uses: what its files use, in the order of the files.
        manifests: of all packages of the workspace, by name; this one included.
        distro: the distribution that the package is for; None where it is not known.
    """
    for_run = declared_by(manifests, manifest.name, RUN_TAGS, distro)
    any_tag = manifest.names(DEPENDENCY_TAGS, distro)
    known = released_packages()
    tested = manifest.test_dependencies
    misplaced = {
        entry.text
        for path, entries in manifest.entries.items()
        if path
        and path not in {(tag,) for tag in DEPENDENCY_TAGS}
        and "depend" in path[-1]  # in <export>, or misspelled
        for entry in entries
    }
    missing: dict[Path, list[PackageUse]] = {}
    first: dict[str, PackageUse] = {}
    users = [
        declared_by(manifests, name, RUN_TAGS, distro)
        for name, one in manifests.items()
        if name != manifest.name
        and manifest.name in one.dependency_names
        and manifest.name in one.names(RUN_TAGS, distro)
    ]
    for use in _needed(uses, for_run, [one for one in users if one & _SIMULATORS]):
        package = use.package
        if (
            package in {manifest.name, *first, *misplaced}
            or package in for_run
            or package in tested  # left out on purpose
            or (package not in known and package not in manifests)
            or is_brought(package, for_run)
            or _needs(package, manifest.name, manifests)
            or _is_misspelled_in(package, any_tag)
        ):
            continue
        if distro is not None and (instead := successor(package, distro)):
            # What needs Gazebo Classic is reported where a launch file starts it.
            if package not in PACKAGES_OF_CLASSIC:
                first[package] = use
                yield _unreleased(use, distro, instead)
            continue
        first[package] = use
        if package in any_tag:
            yield _not_for_run_time(manifest, use)
        else:
            missing.setdefault(use.file, []).append(use)
    for file, those in missing.items():
        yield _undeclared(file, those, distro)


def _unreleased(use: PackageUse, distro: str, instead: str) -> Diagnostic:
    who = "the launch file" if use.kind == LAUNCH else use.file.name
    return UNRELEASED_DEPENDENCY.at(
        use.file,
        use.line,
        use.package,
        message=f"ROS 2 {distro} does not have the package `{use.package}`, which {who} uses; only "
        f"{', '.join(released_packages()[use.package])} have it.",
        hint=f"Use {instead}.",
        severity=Severity.ERROR if use.kind == LAUNCH else None,
    )


def _is_misspelled_in(package: str, declared: Iterable[str]) -> bool:
    """Whether it is declared with a typing mistake, which is reported."""
    known = released_packages()
    return any(one not in known and misspelled_as(one, (package,)) for one in declared)


def _needs(package: str, name: str, manifests: Mapping[str, Manifest]) -> bool:
    """Whether a package of the workspace needs the one with a name, which cannot need it, too."""
    if package not in manifests:
        return False
    tags = DEPENDENCY_TAGS - TEST_TAGS
    return name in declared_by(manifests, package, tags, None, further=tags)


def _needed(
    uses: Sequence[PackageUse], declared: Collection[str], users: Sequence[Collection[str]] = ()
) -> Iterator[PackageUse]:
    """The uses of what is surely needed.

    Who starts Gazebo or the controllers from another package declares there what they load: each
    of the `users` is what a package that depends on this one, and on a simulator, declares.
    """
    started = {use.package for use in uses if use.kind == LAUNCH}
    for use in uses:
        is_plugin, is_controller = use.kind == PLUGIN, use.kind == CONTROLLER
        if is_plugin and (
            not (started & _SIMULATORS or users)
            or any(
                use.package in group and group & {*those}
                for group in _ALTERNATIVES
                for those in (declared, *users)
            )
        ):
            continue
        if is_controller and "controller_manager" not in started:
            continue
        yield use


def may_be_unused(manifest: Manifest, build: BuildFacts, uses: Iterable[PackageUse]) -> set[str]:
    """The packages that are declared and may be used by no file."""
    found = {
        one.name
        for one in manifest.dependencies
        if one.tag in {"depend", "build_depend", "exec_depend"}
        and one.condition is None
        and is_for_code(one.name)
    }
    found -= {use.package for use in uses}
    found -= {one.name for one in build.required_packages}
    has_more = any(
        one.source is not None and one.source.name != "package.xml" for one in build.installed
    )
    return found if has_more or build.targets or build.python_packages else set()


def unused_dependencies(manifest: Manifest, unmentioned: Collection[str]) -> Iterator[Diagnostic]:
    """Report what no file mentions, together."""
    those = [one for one in manifest.dependencies if one.name in unmentioned]
    names = sorted({one.name for one in those})
    if those:
        yield UNUSED_DEPENDENCY.at(
            manifest.file,
            those[0].line,
            names[0],
            message=f"No file of the package mentions {listed(names)}, which package.xml declares.",
            hint="Remove what is not needed: "
            + " ".join(f"<{one.tag}>{one.name}</{one.tag}>" for one in those),
        )


def _undeclared(file: Path, uses: Sequence[PackageUse], distro: str | None) -> Diagnostic:
    is_launch = any(use.kind == LAUNCH for use in uses)
    rule = UNDECLARED_PACKAGE if is_launch else UNDECLARED_DEPENDENCY
    message, hint = undeclared(
        sorted(use.package for use in uses),
        "the launch file uses" if is_launch else f"{file.name} uses",
    )
    later = [
        f"{instead} for {use.package}"
        for use in uses
        if (instead := successor(use.package, distro))
    ]
    if later:
        hint += f"; from {_first_without('ros_ign_gazebo')} on, write {', '.join(sorted(later))}"
    return rule.at(file, min(use.line for use in uses), message=message, hint=hint)


def _first_without(package: str) -> str:
    """The first distribution that no longer has a package."""
    newest = released_packages()[package][-1]
    return all_distros()[all_distros().index(newest) + 1]


def _not_for_run_time(manifest: Manifest, use: PackageUse) -> Diagnostic:
    one = next(one for one in manifest.dependencies if one.name == use.package)
    return NOT_FOR_RUN_TIME.at(
        manifest.file,
        one.line,
        one.name,
        message=f"<{one.tag}> alone declares {one.name}, but {use.file.name} (line {use.line}) "
        "needs it at run time.",
        hint=_for_run_time(one),
    )


def _for_run_time(one: Dependency) -> str:
    if one.tag == "build_depend":
        return f"Write <depend>{one.name}</depend>."
    return f"Add <exec_depend>{one.name}</exec_depend>."


def check_required(
    manifest: Manifest,
    required: Iterable[RequiredPackage],
    *,
    manifests: Mapping[str, Manifest],
    distro: str | None,
) -> Iterator[Diagnostic]:
    """Report what find_package() requires and package.xml does not declare for the build.

    Args:
        manifest: of the package.
        required: what its CMakeLists.txt looks for.
        manifests: of all packages of the workspace, by name.
        distro: the distribution that the package is for; None where it is not known.
    """
    declared = declared_by(manifests, manifest.name, BUILD_TAGS, distro)
    any_tag = manifest.names(DEPENDENCY_TAGS, distro)
    known = released_packages()
    # Libraries that other dependencies may bring, and what a package of messages must declare.
    libraries = {*cmake_packages(), *GENERATORS}
    missing: dict[str, RequiredPackage] = {}
    for one in required:
        if one.required and not one.in_tests:
            yield from _misspelled(one, {*known, *manifests}, {*libraries, *any_tag})
        if (
            one.required
            and not one.in_tests
            and one.name != manifest.name
            and not one.name.startswith("ament_")
            and (one.name in known or one.name in manifests)
            and one.name not in libraries
            and one.name not in declared | any_tag
            and not is_brought(one.name, declared)
            and not _needs(one.name, manifest.name, manifests)
        ):
            missing.setdefault(one.name, one)
    yield from _required_and_undeclared(
        UNDECLARED_BUILD_DEPENDENCY, missing, "depend", "{} requires"
    )


_LINTERS = frozenset(
    f"ament_cmake_{name}"
    for name in (
        *("black", "clang_format", "clang_tidy", "copyright", "cppcheck", "cpplint", "flake8"),
        *("lint_cmake", "mypy", "pep257", "pycodestyle", "pyflakes", "uncrustify", "xmllint"),
    )
)
_RUNNERS = frozenset(("ament_cmake_gmock", "ament_cmake_gtest", "ament_cmake_pytest"))
_OF_TESTS = frozenset(
    (
        *("ament_lint_auto", "ament_lint_common", "launch_testing_ament_cmake", "ros_testing"),
        *("ament_cmake_google_benchmark", *_LINTERS, *_RUNNERS),
    )
)
# What these export to who declares them.
_BROUGHT_TO_TESTS = {
    "ament_lint_common": _LINTERS,
    "ament_cmake_gmock": frozenset(("ament_cmake_gtest",)),
    "ament_cmake_ros": _RUNNERS,
}


def check_tests(
    manifest: Manifest,
    required: Iterable[RequiredPackage],
    *,
    manifests: Mapping[str, Manifest],
    distro: str | None,
) -> Iterator[Diagnostic]:
    """Report what tests require and package.xml does not declare; arguments of `check_required`."""
    declared = declared_by(manifests, manifest.name, DEPENDENCY_TAGS, distro)
    brought = frozenset().union(
        *(those for name, those in _BROUGHT_TO_TESTS.items() if name in declared)
    )
    missing: dict[str, RequiredPackage] = {}
    for one in required:
        if (
            one.required
            and one.in_tests
            and one.name in _OF_TESTS - declared - brought
            and not _is_misspelled_in(one.name, declared)
        ):
            missing.setdefault(one.name, one)
    who = "the tests in {} require"
    yield from _required_and_undeclared(UNDECLARED_TEST_DEPENDENCY, missing, "test_depend", who)


def _required_and_undeclared(
    rule: Rule, missing: Mapping[str, RequiredPackage], tag: str, who: str
) -> Iterator[Diagnostic]:
    """One diagnostic of what package.xml lacks, at the first place that requires it."""
    if not missing:
        return
    first = min(missing.values(), key=lambda one: one.line)
    names = sorted(missing)
    lines = " ".join(f"<{tag}>{name}</{tag}>" for name in names)
    yield rule.at(
        first.file,
        first.line,
        message=f"package.xml does not declare {listed(names)}, which "
        f"{who.format(first.file.name)}.",
        hint=f"Add to package.xml: {lines}",
    )


def _misspelled(
    one: RequiredPackage, packages: Collection[str], others: Collection[str]
) -> Iterator[Diagnostic]:
    """Report a name that is nearly one of `packages`; `others` may be written, too."""
    if one.name in packages or one.name in cmake_packages() or one.name in GENERATORS:
        return
    ros_name = one.name.replace("-", "_")  # CMake may know a released package with hyphens
    if one.name in others and (
        ros_name in packages or misspelled_as(ros_name, released_packages()) is None
    ):
        return  # package.xml names it, too: it may be a package that nobody here has
    declared = [name for name in others if name in packages]
    plural = f"{one.name}s"  # of std_msgs
    meant = (
        plural
        if plural in packages
        else misspelled_as(one.name, declared) or misspelled_as(one.name, packages)
    )
    if meant is not None:
        yield MISSPELLED_REQUIREMENT.at(
            one.file,
            one.line,
            one.name,
            message=f"{one.file.name} requires {one.name}, which is not a package that ROS or the "
            "workspace has.",
            hint=did_you_mean(meant),
        )
