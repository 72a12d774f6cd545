"""Check a template: render it for every target, parse the files and simulate the robot.

The files are laid out as CMake would install them, without building, so that the launch file, the
robot and the world go through the stages of `wsgen validate`.
"""

from __future__ import annotations

import os
import shutil
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Rule, Severity
from wsgen.isolation.fork_server import ForkServer
from wsgen.isolation.parent import make_scratch
from wsgen.model.package import Maintainer
from wsgen.packages.source_shares import INDEX
from wsgen.packages.workspace.layout import find_launch_files
from wsgen.packages.workspace.overlay import Overlay
from wsgen.packages.workspace.package_xml import check_package_xml
from wsgen.packages.workspace.settings import read_settings
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.requests import SelectedPackage, ValidateRequest
from wsgen.pipeline.started import start
from wsgen.simulation.run import default_engine
from wsgen.templating.render import installed_folders
from wsgen.templating.render_apart import render_tree_apart
from wsgen.templating.spec import make_spec, show
from wsgen.templating.write import write_package
from wsgen.text import tomlfile
from wsgen.text.suggestions import some_of
from wsgen.text.xmltree import Malformed, parse

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.model.target import Target
    from wsgen.templating.template import Template


XML = {".config", ".dae", ".gazebo", ".sdf", ".urdf", ".world", ".xacro", ".xml"}


MALFORMED_RENDERED_FILE = Rule(
    code="TPL006",
    name="malformed-rendered-file",
    severity=Severity.ERROR,
    summary="A rendered file is not well-formed.",
    what="Parses the XML, Python and TOML files of the package that the template renders.",
    why="Every package from this template has the same error.",
    example='<link name="{{ name }}_base">',
    instead='<link name="{{ name }}_base"/>',
)


def check_written_files(package: Path) -> Iterator[Diagnostic]:
    """Report files of a package's folder that are not well-formed."""
    yield from check_package_xml(package / "package.xml")
    yield from read_settings(package)[1]
    for file in sorted(path for path in package.rglob("*") if path.is_file()):
        if file.suffix in XML and file.name != "package.xml":
            root = parse(file.read_bytes())
            if isinstance(root, Malformed):
                yield _malformed(file, "well-formed XML", root.message, root.line)
        elif file.suffix == ".py":
            try:
                compile(file.read_bytes(), file.name, "exec", dont_inherit=True)
            except SyntaxError as error:
                yield _malformed(file, "valid Python", error.msg, error.lineno)
            except ValueError as error:  # a NUL in it
                yield _malformed(file, "valid Python", str(error), None)
        elif file.suffix == ".toml":
            try:
                tomlfile.load(file)
            except ValueError as error:
                yield _malformed(file, "valid TOML", str(error), None)


def _malformed(file: Path, form: str, why: str, line: int | None) -> Diagnostic:
    return MALFORMED_RENDERED_FILE.at(
        file,
        line,
        message=f"{file.name} is not {form}: {why}.",
        hint="Fix the template; run `wsgen new -t FOLDER` to see the rendered file.",
    )


PACKAGE = "some_robot"
MAINTAINER = Maintainer(name="Somebody", email="somebody@example.com")
NAMED = 3  # at most so many cases are named in a message


class Case(NamedTuple):
    """One rendering of a template."""

    target: Target
    settings: tuple[str, ...]  # as after --set; none: the defaults

    @property
    def name(self) -> str:
        """As a message names it."""
        return " --set ".join((self.target.name, *self.settings))


def check_template(template: Template) -> tuple[Diagnostic, ...]:
    """Report what is wrong with the packages of a template, each diagnostic once.

    Files are named by their paths in the package, except those of the template itself.
    """
    cases = tuple(_cases(template))
    with make_scratch() as folder, ForkServer() as fork_server:
        found = {
            case: _check_case(case, template, folder / str(number), fork_server.run)
            for number, case in enumerate(cases)
        }
    return _gather(found)


def _cases(template: Template) -> Iterator[Case]:
    """Every target, with the defaults and with each other value of a boolean or a choice."""
    settings: list[tuple[str, ...]] = [()]
    for variable in template.variables.values():
        values = {"boolean": (True, False), "choice": variable.choices}.get(variable.type, ())
        settings += [
            (f"{variable.name}={show(value)}",) for value in values if value != variable.default
        ]
    for target in template.targets:
        yield from (Case(target, one) for one in settings)


def _check_case(case: Case, template: Template, folder: Path, run: Run) -> tuple[Diagnostic, ...]:
    spec = make_spec(
        PACKAGE,
        template=template,
        target=case.target,
        maintainer=MAINTAINER,
        license_name="MIT",
        settings=case.settings,
    )
    tree, diagnostics = render_tree_apart(spec, template, run=run)
    if diagnostics:
        return diagnostics
    source = folder / "src" / PACKAGE
    write_package(tree, source)
    found = list(check_written_files(source))
    if not found and not case.settings:
        overlay = _install(source, folder / "install", installed_folders(tree))
        found += _simulate(source, overlay, run)
    return tuple(_relative(one, folder) for one in found)


def _install(source: Path, prefix: Path, folders: Iterable[str]) -> Overlay:
    """Copy what CMake would install; nothing is built."""
    share = prefix / "share" / PACKAGE
    for name in folders:
        shutil.copytree(source / name, share / name)
    shutil.copy2(source / "package.xml", share / "package.xml")
    (prefix / INDEX).mkdir(parents=True)
    (prefix / INDEX / PACKAGE).touch()
    environment = {**os.environ, "AMENT_PREFIX_PATH": str(prefix)}
    return Overlay(install=prefix, environment=environment, prefixes=(prefix,))


def _simulate(source: Path, overlay: Overlay, run: Run) -> Iterator[Diagnostic]:
    """The diagnostics of `wsgen validate`, for every launch file that spawns a robot."""
    share = overlay.prefixes[0] / "share" / PACKAGE
    request = ValidateRequest(engines=(default_engine(),))
    for file in find_launch_files(share):
        started = start(file, PACKAGE, overlay, request, run)
        selected = SelectedPackage(
            name=PACKAGE,
            source=source,
            share=share,
            launch_file=file,
            started=started,
        )
        if started.has_spawner or not started.is_evaluated:
            yield from Validation(selected, overlay, request, None, run).run().diagnostics


def _relative(found: Diagnostic, folder: Path) -> Diagnostic:
    """The diagnostic without the temporary folders of the check."""
    file = found.file
    for root in (folder / "src" / PACKAGE, folder / "install" / "share" / PACKAGE):
        if file is not None and file.is_relative_to(root):
            file = file.relative_to(root)
    return replace(found, file=file, message=found.message.replace(f"{folder}{os.sep}", ""))


def _gather(found: dict[Case, tuple[Diagnostic, ...]]) -> tuple[Diagnostic, ...]:
    """Each diagnostic once, with the cases it is about unless it is about all."""
    cases: dict[Diagnostic, list[str]] = {}
    for case, diagnostics in found.items():
        for one in dict.fromkeys(diagnostics):
            cases.setdefault(one, []).append(case.name)
    return tuple(
        one if len(names) == len(found) else replace(one, message=f"{one.message} ({_list(names)})")
        for one, names in cases.items()
    )


def _list(names: list[str]) -> str:
    return f"for {some_of(names, NAMED)}"
