"""Check what colcon builds a package from: package.xml and build files, against what files use."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.rules.dependencies import check_circles, check_dependencies
from wsgen.checks.rules.manifests import check_manifest, generated_interfaces
from wsgen.checks.rules.package_uses import (
    check_required,
    check_tests,
    check_uses,
    may_be_unused,
    unused_dependencies,
)
from wsgen.checks.rules.simulators import misplaced_spawners
from wsgen.launching.simulators import simulator_kinds
from wsgen.packages.build_files.cmake_checks import check_for_distro
from wsgen.packages.build_files.python_sources import check_python_syntax
from wsgen.packages.source_shares import INDEX
from wsgen.packages.workspace.package_uses import (
    LAUNCH,
    PackageUse,
    find_files,
    installed_places,
    read_uses,
    unmentioned,
)
from wsgen.packages.workspace.package_xml import check_build_type, check_package_xml
from wsgen.pipeline.check_nodes import check_nodes
from wsgen.text.files import real_path

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts
    from wsgen.model.plan import LaunchPlan
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.packages.workspace.manifest import Manifest


def check_package_manifest(
    package: PackageFolder,
    *,
    build: BuildFacts | None,
    plans: Iterable[LaunchPlan],
    packages: Mapping[str, PackageFolder],
    distro: str | None,
) -> Iterator[Diagnostic]:
    """Report what is wrong with package.xml, and what it does not declare.

    Args:
        package: that is checked; nothing is reported where its package.xml cannot be read.
        build: what its build files say; None of a package in an install space.
        plans: of its launch files.
        packages: of the workspace, by name.
        distro: the distribution that the package is for; None where it is not known.
    """
    manifest = package.manifest
    if manifest is None:
        return
    folder = package.path
    if build is not None:
        destinations = {one.destination for one in build.installed}
        yield from check_build_type(
            manifest,
            calls_ament_package=f"{INDEX}/{package.name}" in destinations
            and (folder / "CMakeLists.txt").is_file(),
            is_python=(folder / "setup.py").is_file() and not (folder / "CMakeLists.txt").is_file(),
        )
        interfaces = generated_interfaces(package.name, build)
        yield from check_manifest(manifest, folder, interfaces=interfaces)
    if manifest.build_type == "catkin":
        return  # of ROS 1, or without build type: that is reported
    manifests = {
        name: one.manifest for name, one in packages.items() if one.manifest is not None
    } | {package.name: manifest}
    yield from check_circles(manifest, manifests)
    plans = tuple(plans)
    looked_up = [use for plan in plans for use in _looked_up(plan, folder)]
    yield from check_dependencies(
        manifest,
        workspace=manifests.keys(),
        distro=distro,
        launched={use.package for use in looked_up},
    )
    misplaced = {
        (real_path(one.file), one.package)
        for plan in plans
        for one in misplaced_spawners(plan, simulator_kinds(plan))
        if one.file is not None
    }
    uses = tuple(
        use
        for use in (
            *_in_order(folder, manifests, build),
            *looked_up,
        )
        if (real_path(use.file), use.package) not in misplaced  # to be replaced
    )
    yield from check_uses(manifest, uses, manifests=manifests, distro=distro)
    if build is not None:
        yield from check_required(
            manifest, build.required_packages, manifests=manifests, distro=distro
        )
        yield from check_tests(
            manifest, build.required_packages, manifests=manifests, distro=distro
        )
        candidates = may_be_unused(manifest, build, uses)
        if candidates:
            yield from unused_dependencies(manifest, unmentioned(folder, candidates))


def _in_order(
    folder: Path, manifests: Mapping[str, Manifest], build: BuildFacts | None
) -> Iterable[PackageUse]:
    """What files use, those of launch files first."""
    uses = read_uses(
        find_files(folder), workspace=manifests.keys(), installed=installed_places(build)
    )
    return sorted(uses, key=lambda use: use.kind != LAUNCH)


def _looked_up(plan: LaunchPlan, folder: Path) -> Iterator[PackageUse]:
    """The packages that a launch file of this package looks up when it is evaluated."""
    inside = Path(real_path(folder))
    for lookup in plan.lookups:
        file = Path(real_path(lookup.file))
        if file.is_relative_to(inside):
            yield PackageUse(lookup.package, file, lookup.line, LAUNCH)


def check_sources(  # noqa: PLR0913  what files say
    package: PackageFolder,
    *,
    build: BuildFacts | None,
    problems: Iterable[Diagnostic],
    plans: Iterable[LaunchPlan],
    packages: Mapping[str, PackageFolder],
    distro: str | None,
) -> Iterator[Diagnostic]:
    """Report what is wrong with package.xml and the build files, and what they do not declare.

    Args:
        package: that is checked.
        build: what its build files say; None of a package in an install space.
        problems: what is wrong in the build files by themselves.
        plans: of its launch files.
        packages: of the workspace, by name.
        distro: the distribution that the package is for; None where it is not known.
    """
    if package.diagnostics:
        yield from package.diagnostics
        return
    yield from check_package_xml(package.path / "package.xml", package.manifest)
    yield from problems
    if build is not None:
        yield from check_for_distro(build.dated_calls, distro)
        if package.build_type != "catkin":  # whose programs may be of Python 2
            yield from check_python_syntax(build, distro)
            yield from check_nodes(build, packages)
    yield from check_package_manifest(
        package, build=build, plans=plans, packages=packages, distro=distro
    )
