"""Check what colcon builds a package from: package.xml and build files, against what files use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.packages.build_files.cmake_checks import check_for_distro
from wsgen.packages.build_files.python_sources import check_python_syntax
from wsgen.packages.workspace.package_xml import check_package_xml
from wsgen.pipeline.check_manifest import check_package_manifest
from wsgen.pipeline.check_nodes import check_nodes

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.build_facts import BuildFacts
    from wsgen.model.plan import LaunchPlan
    from wsgen.packages.workspace.layout import PackageFolder


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
