"""Make a PackageSpec from a request: check its names, answers, license and maintainer."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.model.package import Maintainer, PackageSpec, check_package_name, suggest_package_name
from wsgen.templating.sources import templates_folder
from wsgen.templating.text import check_description, check_maintainer_email, check_maintainer_name
from wsgen.templating.variables import resolve_answers

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.model.target import Target
    from wsgen.templating.template import Template


_FOLDER = "base/licenses"
_ENDING = ".txt.j2"


def license_names() -> list[str]:
    """List the SPDX identifiers of the licenses that come with wsgen, sorted."""
    files = (templates_folder() / _FOLDER).glob(f"*{_ENDING}")
    return sorted(file.name.removesuffix(_ENDING) for file in files)


def find_license(name: str) -> str:
    """Return the SPDX identifier in its own spelling; case does not matter in `name`.

    Raises:
        RequestError: wsgen does not have the text of this license.
    """
    known = license_names()
    for license_name in known:
        if license_name.lower() == name.lower():
            return license_name
    raise RequestError(
        f"wsgen does not have the text of the license {name!r}.",
        hint=f"Use --license {' or '.join(known)}; for another one change the file LICENSE and the"
        " <license> of package.xml afterwards.",
    )


def make_maintainer(name: str, email: str) -> Maintainer:
    """Check name and address.

    Raises:
        RequestError: one of them is not valid in package.xml.
    """
    return Maintainer(name=check_maintainer_name(name), email=check_maintainer_email(email))


def make_spec(  # noqa: PLR0913  the words of the request, all by keyword
    name: str,
    *,
    template: Template,
    target: Target,
    maintainer: Maintainer,
    license_name: str,
    settings: Iterable[str] = (),
    description: str | None = None,
) -> PackageSpec:
    """Check the request and fill in what it leaves out.

    Raises:
        RequestError: for the first mistake, with a valid value.
    """
    _check_target(template, target)
    answers = resolve_answers(template.variables, settings, template.name)
    dependencies = template.dependencies(target, answers)
    _check_name(name, dependencies)
    return PackageSpec(
        name=name,
        license=find_license(license_name),
        answers=answers,
        description=check_description(template.description if description is None else description),
        maintainer=maintainer,
        template=template.name,
        target=target,
        dependencies=dependencies,
    )


def _check_target(template: Template, target: Target) -> None:
    if target not in template.targets:
        same = (one for one in template.targets if one.distro == target.distro)
        nearest = next(same, template.targets[-1])
        raise RequestError(
            f"Template {template.name!r} is not made for {target.ros} with {target.gazebo}.",
            hint=f"Use --distro {nearest.distro} --sim {nearest.simulator}; it is made for"
            f" {', '.join(one.name for one in template.targets)}.",
        )


def _check_name(name: str, dependencies: Mapping[str, tuple[str, ...]]) -> None:
    broken = check_package_name(name)
    if broken is not None:
        suggestion = suggest_package_name(name)
    elif any(name in needed for needed in dependencies.values()):
        broken = "is the name of a package that the new one depends on"
        suggestion = f"{name}_robot"
    else:
        return
    shown = name if len(name) <= 40 else f"{name[:40]}..."  # noqa: PLR2004  enough to know it
    raise RequestError(
        f"The package name {shown!r} {broken}.", hint=f"Use for example {suggestion}"
    )
