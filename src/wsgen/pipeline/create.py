"""Create a package: from what `wsgen new` asks for to the written files."""

from __future__ import annotations

import os
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import RequestError, WouldOverwriteError
from wsgen.model.target import end_of_life_note
from wsgen.packages.workspace.layout import (
    Workspace,
    check_workspace_path,
    current_folder,
    find_packages,
    find_workspace,
    spawned_entities,
)
from wsgen.ros.names import is_released
from wsgen.templating.render import render_package
from wsgen.templating.spec import make_maintainer, make_spec
from wsgen.templating.template import load_template
from wsgen.templating.write import (
    IGNORE_FILE,
    adding_files,
    refuse_existing,
    refuse_files,
    write_package,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from wsgen.model.package import Maintainer, PackageSpec
    from wsgen.model.target import Target
    from wsgen.templating.render import RenderedTree
    from wsgen.templating.template import Template
    from wsgen.templating.write import PackageTree


DEFAULT_WORKSPACE = "ws_gazebo"


class CreatedPackage(NamedTuple):
    """A package that is written, or would be; with what its author should know about it."""

    workspace: Workspace
    folder: Path
    files: tuple[str, ...]  # in the folder of the package
    workspace_files: tuple[str, ...]  # in that of the workspace
    is_written: bool
    placeholder_email: str | None = None  # of the maintainer; git knows no usable one
    kept_file: Path | None = None  # the .gitignore of the workspace, where it exists already
    end_of_life: str | None = None  # a sentence, if the target has no updates any more
    # Top of the repository around the workspace; services look for the workflow only there.
    repository: Path | None = None
    is_of_ros: bool = False  # ROS has released a package of this name


def create(  # noqa: PLR0913  the words of the request, all by keyword
    name: str,
    *,
    target: Target,
    template_name: str,
    license_name: str,
    workspace_folder: str | None,
    settings: Sequence[str],
    description: str | None,
    maintainer_name: str | None,
    maintainer_email: str | None,
    workflow_service: str | None,
    is_dry_run: bool,
    announce: Callable[[Workspace], None],
) -> CreatedPackage:
    """Write a package, and the workspace around it if it does not exist.

    `template_name` may be the folder of a template, `settings` are KEY=VALUE for its variables.
    None stands for a default. `announce` is called with the workspace before anything is written.

    Raises:
        RequestError: The name, template, license, a setting or the workspace cannot be used.
        WouldOverwriteError: The package or a file of the workspace exists; nothing is written.
        NotReadableError: The disk does not take the files; nothing is left of them.
        BrokenTemplateError: The template cannot be rendered.
    """
    planned = plan_new(
        name,
        target=target,
        template=load_template(template_name),
        license_name=license_name,
        workspace_folder=workspace_folder,
        settings=settings,
        description=description,
        maintainer_name=maintainer_name,
        maintainer_email=maintainer_email,
        workflow_service=workflow_service,
    )
    tree = _render(planned.spec, planned.template)
    return write_new(planned, tree, is_dry_run=is_dry_run, announce=announce)


class NewPackage(NamedTuple):
    """A package that can be written: nothing has its name."""

    spec: PackageSpec
    template: Template
    workspace: Workspace
    workflow: RenderedTree  # in the folder of the workspace
    has_placeholder: bool  # in place of an address of the maintainer

    @property
    def folder(self) -> Path:
        """Where it will be."""
        return self.workspace.source / self.spec.name


def plan_new(  # noqa: PLR0913  the words of the request, all by keyword
    name: str,
    *,
    target: Target,
    template: Template,
    license_name: str,
    workspace_folder: str | None,
    settings: Sequence[str],
    description: str | None,
    maintainer_name: str | None,
    maintainer_email: str | None,
    workflow_service: str | None,
) -> NewPackage:
    """Check what a package is to be, and its place; for the arguments and errors see `create`."""
    maintainer, has_placeholder = _choose_maintainer(maintainer_name, maintainer_email)
    spec = make_spec(
        name,
        template=template,
        target=target,
        maintainer=maintainer,
        license_name=license_name,
        settings=settings,
        description=description,
    )
    workspace = _choose_place(workspace_folder, spec.name)
    spec = replace(spec, taken_entities=spawned_entities(workspace))
    workflow = _workflow_files(workflow_service, target)
    refuse_files(workflow, workspace.root)
    return NewPackage(spec, template, workspace, workflow, has_placeholder)


def write_new(
    planned: NewPackage,
    tree: PackageTree,
    *,
    is_dry_run: bool,
    announce: Callable[[Workspace], None],
) -> CreatedPackage:
    """Write a package that was planned; for the errors see `create`."""
    spec, workspace, workflow = planned.spec, planned.workspace, planned.workflow
    ignored, kept = _ignore_files(workspace)
    announce(workspace)
    if not is_dry_run:
        with adding_files(workflow, workspace.root, where_missing=ignored):
            write_package(tree, planned.folder)
    return CreatedPackage(
        workspace=workspace,
        folder=planned.folder,
        files=tuple(tree),
        workspace_files=(*ignored, *workflow),
        is_written=not is_dry_run,
        placeholder_email=spec.maintainer.email if planned.has_placeholder else None,
        kept_file=kept,
        end_of_life=end_of_life_note(spec.target, time.strftime("%Y-%m-%d")),
        repository=_repository_around(workspace.root) if workflow else None,
        is_of_ros=is_released(spec.name),
    )


def choose_workspace(given: str | None) -> Workspace:
    """The given folder, else the workspace around the current one, else ./ws_gazebo.

    Raises:
        RequestError: The given folder is the source folder of another workspace, or is among its
            packages.
    """
    if given is None:
        here = current_folder()
        return find_workspace(here) or Workspace(root=here / DEFAULT_WORKSPACE)
    root = Path(given).expanduser().absolute()
    around = find_workspace(root)
    if around is not None and (root == around.source or around.source in root.parents):
        raise RequestError(
            f"{root} is inside the workspace {around.root}.",
            hint=f"Use that workspace: -w {around.root}",
        )
    return Workspace(root=root)


def _choose_place(given: str | None, name: str) -> Workspace:
    """The workspace, if a package of this name can be written into it."""
    workspace = choose_workspace(given)
    check_workspace_path(workspace.root)
    refuse_existing(workspace.source / name)
    for package in find_packages(workspace):
        if package.name == name:
            raise WouldOverwriteError(
                f"The workspace has a package {name} in {package.path}; nothing was written.",
                hint="Choose another name: colcon refuses two packages with the same name.",
            )
    return workspace


def _choose_maintainer(name: str | None, email: str | None) -> tuple[Maintainer, bool]:
    """The maintainer, completed by git; and whether the address is a placeholder."""
    if name is not None and email is not None:
        return make_maintainer(name, email), False
    # Only here: it starts git, for which it loads `subprocess`.
    from wsgen.templating.spec import UNKNOWN_DOMAIN, find_maintainer  # noqa: PLC0415

    maintainer = find_maintainer(name, email)
    return maintainer, email is None and maintainer.email.endswith(f"@{UNKNOWN_DOMAIN}")


def _workflow_files(service: str | None, target: Target) -> RenderedTree:
    """The workflow for a service, if one is wanted."""
    if service is None:
        return {}
    from wsgen.templating.render import render_workflow  # noqa: PLC0415  rarely wanted

    return render_workflow(service, target)


def _ignore_files(workspace: Workspace) -> tuple[RenderedTree, Path | None]:
    """What git is to ignore in a new workspace; or the file that already says it."""
    if os.path.lexists(workspace.source):
        return {}, None
    existing = [workspace.root / name for name in IGNORE_FILE]
    existing = [path for path in existing if os.path.lexists(path)]
    return ({}, existing[0]) if existing else (dict(IGNORE_FILE), None)


def _render(spec: PackageSpec, template: Template) -> RenderedTree:
    """The files of the package; a template of the user is rendered in a child process."""
    if template.is_shipped:
        return render_package(spec, template)
    from wsgen.pipeline.own_templates import made_of_own  # noqa: PLC0415  starts git
    from wsgen.templating.render_apart import render_package_apart  # noqa: PLC0415  starts a child

    return render_package_apart(spec, template, {"made_of": made_of_own(template)})


def _repository_around(root: Path) -> Path | None:
    """The top of the repository that a workspace lies in, if it is not the workspace itself."""
    top = next((folder for folder in (root, *root.parents) if (folder / ".git").exists()), root)
    return None if top == root else top
