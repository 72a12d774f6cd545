"""What is swept: the parameters that it has, and the blueprint for each of their values."""

from __future__ import annotations

import os
import pickle
import re
import shutil
import tempfile
import threading
import weakref
from abc import ABC, abstractmethod
from collections import OrderedDict
from dataclasses import field, replace
from hashlib import sha256
from importlib import metadata
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple

from wsgen import __version__
from wsgen.descriptions.meshes import inspection, shape_meshes
from wsgen.errors import RequestError
from wsgen.isolation.result import DEFAULT_LIMITS, Answered, Died, Limits
from wsgen.model.engines import ENGINES
from wsgen.model.robot import Mesh
from wsgen.packages.source_shares import BUILD_FOLDERS
from wsgen.sweeping.parameters import OWN_NAMES, check_design, subject_values, write_value
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from wsgen.isolation.parent import Run
    from wsgen.model.sweep import Design, Value
    from wsgen.model.target import Target
    from wsgen.packages.workspace.layout import Workspace
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.sweeping.parameters import Parameter
    from wsgen.sweeping.run_variant import Blueprint


@dataclass(frozen=True, kw_only=True)
class SubjectRequest:
    """What is swept: one of a package, a file and a template; and what stays the same."""

    package: str | None = None
    file: Path | None = None  # a URDF, a xacro file, or SDF
    template: str | None = None  # its name, or the folder of one of the user
    workspace: Workspace | None = None  # of the package, or of packages that the file names
    launch_file: str | None = None  # a file name as `ros2 launch` takes it; None: the only one
    launch_arguments: Mapping[str, str] = field(default_factory=dict)  # also those of xacro
    settings: Sequence[str] = ()  # NAME=VALUE for variables of the template
    target: Target | None = None  # of the template; None: the first that it is made for
    kept: int = 64  # blueprints that are held for values that come again
    is_drawn: bool = False  # it matters what meshes look like
    has_behaviors: bool = True  # the robot shows what wsgen.toml asks of it


class RobotText(NamedTuple):
    """The text of a robot as it is spawned."""

    entity: str  # name that it is spawned under
    text: str  # URDF, expanded, or SDF
    file: Path | None  # that it comes from


class Prepared(NamedTuple):
    """A blueprint, and what it was made of."""

    blueprint: Blueprint
    texts: tuple[RobotText, ...] = ()
    files: Callable[[], frozenset[Path]] = frozenset  # that were read


class Subject(ABC):
    """What is swept. Threads may share it; its files are those of when it was opened."""

    kind: str  # "package", "file" or "template"

    def __init__(
        self,
        name: str,
        title: str,
        parameters: Sequence[Parameter],
        folder: Path,
        request: SubjectRequest,
    ) -> None:
        self.name = name  # of the package, file or template
        self.title = title  # to begin a sentence: "The launch file x.launch.py of rover"
        self.parameters = tuple(parameters)  # without wsgen's own
        self.folder = folder  # scratch, until the subject is closed
        self._kept = request.kept
        # What gives a parameter one value, by its name: as a user writes it.
        self._given = {
            **{name: f"--arg {name}:={value}" for name, value in request.launch_arguments.items()},
            **{word.partition("=")[0].strip(): f"--set {word}" for word in request.settings},
        }
        self._has_behaviors = request.has_behaviors
        self._lock = threading.Lock()
        self._slots: OrderedDict[tuple[tuple[str, str, str], ...], _Slot] = OrderedDict()

    @property
    def left_out(self) -> tuple[str, ...]:
        """The names of behaviors that a sweep leaves out: their launch files would have to run."""
        return ()

    @property
    def own_names(self) -> tuple[str, ...]:
        """The names of its parameters, without those of wsgen."""
        return tuple(one.name for one in self.parameters)

    def check(self, design: Design) -> Design:
        """The design with values of the types of the parameters; see `check_design`.

        Raises:
            RequestError: A name is unknown, a value is not allowed, or an option gives a parameter
                that varies one value.
            NotFoundError: The sampler needs scipy, which is not installed.
        """
        known = {*self.own_names, *OWN_NAMES}
        unknown = next((name for name in design.names if name not in known), None)
        others = "" if unknown is None else self._advice(unknown)
        checked = check_design(design, self.parameters, subject=self.title, others=others)
        for name in subject_values(dict.fromkeys(design.names, 0)):
            if name in self._given:
                raise RequestError(
                    f"{name} varies, so that {self._given[name]} has no effect.",
                    hint=f"Remove {self._given[name]}, or have {name} not vary: leave it out of "
                    "--over, --random and [sweep] in wsgen.toml.",
                )
        return checked

    def prepare(self, values: Mapping[str, Value]) -> Blueprint:
        """What `wsgen validate` would simulate with these values; those of wsgen's own are ignored.

        What is wrong with the robot is in the diagnostics of the blueprint; nothing is raised for
        it. The files of the blueprint are there as long as it is referenced, and the subject open.
        """
        return self._prepared(values).blueprint

    def texts(self, values: Mapping[str, Value]) -> tuple[RobotText, ...]:
        """The robots that these values spawn, as texts; none where they cannot be expanded."""
        return self._prepared(values).texts

    def package(self, values: Mapping[str, Value]) -> tuple[str, Mapping[str, str]] | None:  # noqa: ARG002
        """The name and the files (path with slashes -> text) of the package of a template.

        None where the subject is no template, or where it cannot be rendered.
        """
        return None

    def digest(
        self,
        engine: str,
        some: Iterable[Mapping[str, Value]] = (),
        environment: Mapping[str, str] = MappingProxyType({}),
    ) -> str:
        """A hash over all that a result depends on beside what varies.

        That is the content of the files that are read, by default and with each of `some` values,
        the environment variables that they ask for, what stays the same of launch arguments and
        answers, and the versions of wsgen and of the engine.
        """
        found = sha256()
        for part in (__version__, engine, engine_version(engine), self.kind, *self._fixed()):
            found.update(f"{len(part)}:{part}".encode())
        files = {*self._own_files()}
        first: Mapping[str, Value] = {}
        for values in (first, *some):
            prepared = self._prepared(values)
            files |= {*prepared.files(), *mesh_files(prepared.blueprint.prepared)}
        asked: set[bytes] = set()
        for file in sorted(files):
            if not file.is_relative_to(self.folder) and (content := _content(file)) is not None:
                # Not where the folder lies: it may be moved.
                name = "/".join(file.parts[-2:])
                found.update(f"{name}:{sha256(content).hexdigest()}".encode())
                asked.update(_ASKED.findall(content))
        for name in sorted(map(os.fsdecode, asked)):
            if name in environment:
                found.update(os.fsencode(f"{name}={environment[name]}"))
        return found.hexdigest()

    def _prepared(self, values: Mapping[str, Value]) -> Prepared:
        own = subject_values(values)
        key = tuple(
            sorted((name, type(value).__name__, write_value(value)) for name, value in own.items())
        )
        with self._lock:
            slot = self._slots.setdefault(key, _Slot())
            self._slots.move_to_end(key)
            while len(self._slots) > self._kept:
                self._slots.popitem(last=False)
        with slot.lock:  # of several threads that want the same, one prepares it
            if slot.prepared is None:
                slot.prepared = self._make(own)
            return slot.prepared

    def _make(self, values: Mapping[str, Value]) -> Prepared:
        folder = Path(tempfile.mkdtemp(prefix="variant-", dir=self.folder))
        try:
            prepared = self._read(values, folder)
            if not self._has_behaviors:
                blueprint = replace(prepared.blueprint, behavior_plan=None)
                prepared = prepared._replace(blueprint=blueprint)
        except BaseException:
            shutil.rmtree(folder, ignore_errors=True)
            raise
        end = weakref.finalize(prepared.blueprint, shutil.rmtree, folder, ignore_errors=True)
        end.atexit = False  # the scratch folder around it is removed
        return prepared

    @abstractmethod
    def _read(self, values: Mapping[str, Value], folder: Path) -> Prepared:
        """Make a blueprint; `folder` is for its files."""

    @abstractmethod
    def _fixed(self) -> Iterable[str]:
        """What stays the same of the request, for the digest."""

    @abstractmethod
    def _own_files(self) -> Iterable[Path]:
        """The files of the subject that may be read, whatever the values are."""

    def _advice(self, name: str) -> str:  # noqa: ARG002
        """What to do about a name that is unknown."""
        return ""


class _Slot:
    """A place for a blueprint that is being prepared."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self.prepared: Prepared | None = None


def engine_version(engine: str) -> str:
    """The version of an engine's library; empty where it is not installed by pip."""
    found = (
        one.version for name in ENGINES[engine].wheels for one in metadata.distributions(name=name)
    )
    return next(found, "")


def mesh_files(prepared: Iterable[PreparedRobot]) -> Iterator[Path]:
    """The mesh files of robots that engines read."""
    for robot in prepared:
        for link in robot.lumped.links:
            for collision in link.collisions:
                mesh = collision.geometry
                if isinstance(mesh, Mesh) and mesh.path is not None:
                    yield Path(mesh.path)


# How files of xacro and launch files ask for an environment variable by its name.
_ASKED = re.compile(
    rb"""(?:\$\((?:opt)?env\s+|(?:environ(?:\.get\(|\[)|getenv\(|EnvironmentVariable\()"""
    rb"""\s*(?:name\s*=\s*)?\[?['"])([A-Za-z_]\w*)"""
)
# Folders that no result depends on, and files that only people read.
NOT_READ = BUILD_FOLDERS | {"test", "tests"}
TEXTS = frozenset((".md", ".rst", ".pyc"))


def files_below(folder: Path) -> Iterator[Path]:
    """The files of a package's folder that a result may depend on."""
    for path in sorted(folder.iterdir()):
        if path.name.startswith(".") or path.name in NOT_READ:
            continue
        if path.is_dir():
            yield from files_below(path)
        elif path.suffix not in TEXTS:
            yield path


def _content(file: Path) -> bytes | None:
    try:
        return file.read_bytes() if file.is_file() else None
    except OSError:
        return None


TASKS = (inspection.TASK, shape_meshes.TASK)  # take a list and a folder, and answer one by one
MOST = 10_000  # answers that are kept; the files of others are the variant's own


class KeptAnswers:
    """Runs tasks, and answers what was asked before about the same mesh or shape.

    What a child writes for kept answers goes into `folder`, which must be there as long as the
    robots are used. Threads may share it.
    """

    def __init__(self, run: Run, folder: Path) -> None:
        self._run = run
        self._folder = folder
        self._lock = threading.Lock()
        self._kept: dict[tuple[str, bytes], Any] = {}

    @property
    def is_full(self) -> bool:
        """Whether files of further meshes are the variant's own, and are removed with it."""
        return len(self._kept) > MOST

    def run(
        self,
        task: str,
        *arguments: object,
        limits: Limits = DEFAULT_LIMITS,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> Answered | Died:
        """Call a task in a child, or answer what it has answered before; see `parent.run`."""
        if task not in TASKS or self.is_full:
            return self._run(
                task, *arguments, limits=limits, environment=environment, folder=folder
            )
        asked: list[object] = list(arguments[0])  # type: ignore[call-overload]
        keys = [(task, pickle.dumps(one)) for one in asked]
        with self._lock:
            new = [place for place, key in enumerate(keys) if key not in self._kept]
        if new:
            outcome = self._run(
                task,
                [asked[place] for place in new],
                Path(tempfile.mkdtemp(prefix="meshes-", dir=self._folder)),
                limits=limits,
                environment=environment,
                folder=folder,
            )
            if isinstance(outcome, Died):  # its step is the place of what it died of
                is_place = outcome.step.isdecimal()
                return replace(outcome, step=str(new[int(outcome.step)])) if is_place else outcome
            with self._lock:
                for place, answer in zip(new, outcome.value, strict=True):
                    self._kept.setdefault(keys[place], answer)
        return Answered(value=[self._kept[key] for key in keys], output="")
