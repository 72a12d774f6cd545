"""A robot file that is swept: the parameters of a xacro file are its `<xacro:arg>`s."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from wsgen.descriptions.xacro.reader import read_arguments
from wsgen.descriptions.xacro.source import written_elements
from wsgen.pipeline.file_validation import FileValidation
from wsgen.pipeline.prepare import PrepareContext
from wsgen.pipeline.requests import FILE_SUFFIXES, ValidateRequest
from wsgen.sweeping.blueprint import Blueprint
from wsgen.sweeping.kept_answers import KeptAnswers
from wsgen.sweeping.parameters import Parameter, write_value
from wsgen.sweeping.subject import Prepared, RobotText, Subject
from wsgen.text.files import read_whole

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from wsgen.isolation.parent import Run
    from wsgen.model.sweep import Value
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.sweeping.subject import SubjectRequest


ARGUMENT = "xacro:arg"
INCLUDED = frozenset((".xacro", ".urdf", ".yaml", ".yml"))
USED = re.compile(r"\$\(arg\s+([\w.-]+)\s*\)")  # it may be declared nowhere


def _name_of(file: Path) -> str:
    """The name of a file without its endings: of rover.urdf.xacro it is rover."""
    name = file
    while name.suffix in FILE_SUFFIXES:
        name = name.with_suffix("")
    return name.name


class FileSubject(Subject):
    """A URDF, xacro or SDF file; the request has been checked."""

    kind = "file"

    def __init__(
        self, file: Path, request: SubjectRequest, overlay: Overlay, folder: Path, run: Run
    ) -> None:
        self._file = file
        self._overlay = overlay
        self._run = KeptAnswers(run, folder).run
        self._request = ValidateRequest(
            files=(file,),
            launch_arguments=request.launch_arguments,
            is_viewed=request.is_drawn,
        )
        self._reader = self._validation(self._request)
        parameters = [*self._arguments()] if self._reader.kind == "xacro" else []
        super().__init__(_name_of(file), f"The file {file.name}", parameters, folder, request)

    def _validation(self, request: ValidateRequest) -> FileValidation:
        name = _name_of(self._file)
        return FileValidation(self._file, self._overlay, request, None, self._run, name=name)

    def _arguments(self) -> Iterator[Parameter]:
        """The arguments that the file and what it includes declare, in the order of the files."""
        elements = written_elements(self._file, self._reader.share_of)
        written: dict[str, str | None] = {}
        for element in elements:
            if element.tag == ARGUMENT and (name := element.attributes.get("name")):
                written.setdefault(name, element.attributes.get("default"))
        for text in {element.file: element.data for element in elements}.values():
            for name in USED.findall(text.decode("utf-8", "replace")):
                written.setdefault(name, None)
        read = read_arguments(
            self._file,
            self._request.launch_arguments,
            environment=self._overlay.environment,
            run=self._run,
        )
        for name in dict.fromkeys((*written, *read)):
            yield Parameter(name=name, default=read.get(name, written.get(name)))

    def _advice(self, name: str) -> str:  # noqa: ARG002
        if self._reader.kind != "xacro":
            return "Only a xacro file has parameters."
        return 'Declare it in the file: <xacro:arg name="NAME" default="VALUE"/>'

    def _read(self, values: Mapping[str, Value], folder: Path) -> Prepared:
        written = {name: write_value(value) for name, value in values.items()}
        validation = self._validation(
            replace(self._request, launch_arguments={**self._request.launch_arguments, **written})
        )
        context = PrepareContext(
            share_of=validation.share_of,
            folder=folder,
            run=self._run,
            with_colors=self._request.is_drawn,
        )
        world, prepared = validation.read(context)
        blueprint = Blueprint(
            name=self.name,
            world=world,
            prepared=tuple(prepared),
            diagnostics=(*validation.diagnostics, *self._overlay.not_built()),
        )
        texts = tuple(self._texts(validation, blueprint))
        return Prepared(blueprint, texts, partial(self._files, validation))

    def _files(self, validation: FileValidation) -> frozenset[Path]:
        files = {self._file, *validation.sdf_files}
        if validation.kind == "xacro":
            files |= {one.file for one in written_elements(self._file, validation.share_of)}
        return frozenset(files)

    def _texts(self, validation: FileValidation, blueprint: Blueprint) -> Iterator[RobotText]:
        text: str | bytes | None = validation.text
        if validation.kind == "sdf" and blueprint.world is not None:
            text = read_whole(self._file)
        if text is not None and blueprint.prepared:
            decoded = text if isinstance(text, str) else text.decode("utf-8-sig", "replace")
            yield RobotText(blueprint.prepared[0].entity, decoded, self._file)

    def _fixed(self) -> Iterable[str]:
        arguments = self._request.launch_arguments.items()
        return (self.name, *(f"{a}:={b}" for a, b in sorted(arguments)))

    def _own_files(self) -> Iterable[Path]:
        """The file, and where an argument may choose what it includes, those around it."""
        yield self._file
        if self._reader.kind == "xacro":
            folder = self._file.absolute().parent
            yield from (one for one in folder.iterdir() if one.suffix in INCLUDED)
