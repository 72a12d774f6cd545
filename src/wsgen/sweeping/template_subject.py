"""A template that is rendered for each variant: its parameters are the template's variables."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.diagnostics import has_errors
from wsgen.errors import RequestError
from wsgen.model.package import Maintainer, suggest_package_name
from wsgen.packages.source_shares import INDEX
from wsgen.packages.workspace.layout import find_launch_files
from wsgen.packages.workspace.overlay import overlay_of
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.requests import SelectedPackage, ValidateRequest
from wsgen.pipeline.started import start
from wsgen.sweeping.parameters import Parameter, subject_values, write_value
from wsgen.sweeping.robot_subjects import as_prepared
from wsgen.sweeping.run_variant import Blueprint
from wsgen.sweeping.subject import KeptAnswers, Prepared, Subject, files_below
from wsgen.templating.environment import Environment
from wsgen.templating.render import installed_folders, render_tree
from wsgen.templating.render_apart import render_tree_apart
from wsgen.templating.sources import templates_folder
from wsgen.templating.spec import make_spec
from wsgen.templating.template import load_template
from wsgen.templating.write import write_files

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.package import PackageSpec
    from wsgen.model.sweep import Design, Value
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.started import Started
    from wsgen.sweeping.subject import SubjectRequest
    from wsgen.templating.render import RenderedTree
    from wsgen.templating.spec import Variable


MAINTAINER = Maintainer(name="wsgen", email="wsgen@example.com")
LICENSE = "Apache-2.0"
FILES = ("package.xml", "wsgen.toml")  # at the top of a package, that are read
KINDS = {"string": "text"}  # of variables, where parameters call it otherwise


class TemplateSubject(Subject):
    """A template, rendered for a target.

    The files are laid out as CMake would install them, as `wsgen templates --check` does.

    Raises:
        RequestError: The template does not exist, is not made for the target, does not have a
            variable that is set, or no launch file of it spawns a robot.
        BrokenTemplateError: Its template.toml is invalid.
    """

    kind = "template"

    def __init__(
        self,
        request: SubjectRequest,
        environment: Mapping[str, str],
        folder: Path,
        run: Run,
    ) -> None:
        self._template = load_template(request.template or "")
        self._target = request.target or self._template.targets[0]
        self._set = tuple(request.settings)
        self._environment = environment
        self._run = KeptAnswers(run, folder).run
        self._environment_of_template = Environment(self._template.folder)
        self._package = suggest_package_name(self._template.name)
        self._launch_file: str | None = None  # the name of the one that spawns a robot
        self._spec({})  # refuses what is wrong with the request
        self._request = ValidateRequest(
            launch_file=request.launch_file,
            launch_arguments=request.launch_arguments,
            is_viewed=request.is_drawn,
        )
        variables = self._template.variables.values()
        super().__init__(
            self._template.name,
            f"The template {self._template.name}",
            [_parameter(variable) for variable in variables],
            folder,
            request,
        )
        self._refuse_without_launch_file()

    def _spec(self, values: Mapping[str, Value]) -> PackageSpec:
        written = (f"{name}={write_value(value)}" for name, value in values.items())
        return make_spec(
            self._package,
            template=self._template,
            target=self._target,
            maintainer=MAINTAINER,
            license_name=LICENSE,
            settings=(*self._set, *written),
        )

    def check(self, design: Design) -> Design:
        """As that of every subject; texts are checked too, which become parts of files."""
        checked = super().check(design)
        named = {axis.name: axis.values for axis in checked.axes}
        named |= {one.name: one.choices for one in checked.distributions}
        for name, values in named.items():
            for value in values:
                if isinstance(value, str) and name in self._template.variables:
                    self._spec({name: value})
        return checked

    def _render(
        self, values: Mapping[str, Value], *, is_whole: bool = False
    ) -> tuple[RenderedTree, tuple[Diagnostic, ...]]:
        """The files of the package; unless it is to be whole, those that a simulation reads."""
        spec = self._spec(values)
        if self._template.is_shipped:
            if is_whole:
                return render_tree(spec, self._template)
            return render_tree(
                spec, self._template, environment=self._environment_of_template, wanted=_is_read
            )
        return render_tree_apart(spec, self._template, run=self._run)

    def package(self, values: Mapping[str, Value]) -> tuple[str, Mapping[str, str]] | None:
        """The package that `wsgen new` writes with these values."""
        tree, diagnostics = self._render(subject_values(values), is_whole=True)
        return None if diagnostics else (self._package, tree)

    def _read(self, values: Mapping[str, Value], folder: Path) -> Prepared:
        tree, diagnostics = self._render(values)
        if diagnostics:
            return Prepared(Blueprint(name=self.name, world=None, diagnostics=diagnostics))
        share = folder / "share" / self._package
        share.parent.mkdir()
        write_files({path: text for path, text in tree.items() if _is_read(path)}, share)
        (folder / INDEX).mkdir(parents=True)
        (folder / INDEX / self._package).touch()
        overlay = self._overlay(folder)
        launch_file, started = self._start(share, overlay)
        validation = Validation(
            SelectedPackage(
                name=self._package,
                source=share,
                share=share,
                launch_file=launch_file,
                started=started,
            ),
            overlay,
            self._request,
            None,
            self._run,
        )
        world, robots = validation.read(folder)
        prepared = as_prepared(self.name, validation, world, robots, validation.of_package())
        return prepared._replace(blueprint=_without_folder(prepared.blueprint, share, folder))

    def _overlay(self, prefix: Path) -> Overlay:
        path = self._environment.get("AMENT_PREFIX_PATH", "")
        environment = {
            **self._environment,
            "AMENT_PREFIX_PATH": os.pathsep.join(filter(None, (str(prefix), path))),
        }
        return replace(overlay_of(environment), install=prefix)

    def _start(self, share: Path, overlay: Overlay) -> tuple[Path | None, Started | None]:
        """The launch file that spawns a robot; of several the first."""
        files = find_launch_files(share)
        wanted = self._request.launch_file
        if wanted is not None:
            files = tuple(file for file in files if file.name == wanted)
        # Once it is known, the others need not be evaluated.
        for file in sorted(files, key=lambda one: one.name != self._launch_file):
            started = start(file, self._package, overlay, self._request, self._run)
            if started.has_spawner or not started.is_evaluated:
                self._launch_file = file.name
                return file, started
        return None, None

    def _refuse_without_launch_file(self) -> None:
        """Stop where no launch file spawns a robot."""
        wanted = self._request.launch_file
        prepared = self._prepared({})
        if self._launch_file is None and not has_errors(prepared.blueprint.diagnostics):
            raise RequestError(
                f"The template {self.name} has no launch file "
                f"{'that spawns a robot' if wanted is None else f'{wanted} that spawns a robot'}.",
                hint="Spawn the robot in a launch file of the template."
                if wanted is None
                else "Leave --launch out, or name a launch file that spawns the robot.",
            )

    def _fixed(self) -> Iterable[str]:
        arguments = self._request.launch_arguments.items()
        return (
            self.name,
            self._target.name,
            *self._set,
            *(f"{name}:={value}" for name, value in sorted(arguments)),
        )

    def _own_files(self) -> Iterable[Path]:
        yield from files_below(self._template.folder)
        yield from files_below(templates_folder() / "base")


def _is_read(path: str) -> bool:
    """Whether a file of a package is installed, or read from its source."""
    return path in FILES or bool(installed_folders([path]))


def _parameter(variable: Variable) -> Parameter:
    return Parameter(
        name=variable.name,
        kind=KINDS.get(variable.type, variable.type),
        unit=variable.unit,
        meaning=variable.help,
        default=variable.default,
        minimum=variable.minimum,
        maximum=variable.maximum,
        choices=variable.choices,
    )


def _without_folder(blueprint: Blueprint, share: Path, folder: Path) -> Blueprint:
    """The blueprint whose diagnostics name the files by their paths in the package.

    The scratch folder has another name for each variant, and for each run of the same sweep.
    """

    def named(diagnostics: Iterable[Diagnostic]) -> tuple[Diagnostic, ...]:
        return tuple(
            replace(
                found,
                file=found.file.relative_to(share)
                if found.file is not None and found.file.is_relative_to(share)
                else found.file,
                message=_shortened(found.message, share, folder),
                element=found.element and _shortened(found.element, share, folder),
                hint=found.hint and _shortened(found.hint, share, folder),
            )
            for found in diagnostics
        )

    return replace(
        blueprint,
        prepared=tuple(
            replace(robot, diagnostics=named(robot.diagnostics)) for robot in blueprint.prepared
        ),
        diagnostics=named(blueprint.diagnostics),
    )


def _shortened(text: str, share: Path, folder: Path) -> str:
    return text.replace(f"{share}{os.sep}", "").replace(f"{folder}{os.sep}", "")
