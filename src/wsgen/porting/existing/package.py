"""Make a package of a robot that exists: from what `wsgen new --from` names to the files."""

from __future__ import annotations

import itertools
import math
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.source import SourceText, apply
from wsgen.checks.rules.entities import lowest_point
from wsgen.descriptions.meshes.lookup import find_meshes
from wsgen.descriptions.urdf.lumping import WORLD
from wsgen.descriptions.urdf.reader import read_urdf
from wsgen.descriptions.xacro.reader import expand_file
from wsgen.diagnostics import Severity, has_errors
from wsgen.errors import NotReadableError, RequestError
from wsgen.gazebo.systems import plugin_of
from wsgen.isolation.parent import make_scratch, run
from wsgen.model.kinematics import link_poses
from wsgen.model.robot import Mesh
from wsgen.model.target import SIM
from wsgen.model.transform import IDENTITY, compose, rotation_of_rpy
from wsgen.packages.source_shares import serve_sources
from wsgen.packages.workspace.overlay import overlay_of
from wsgen.pipeline.create import write_new
from wsgen.pipeline.prepare import PrepareContext, prepare_robot, share_on_model_path
from wsgen.porting.existing.catkin import (
    BUILD_FILE,
    MANIFEST,
    find_package,
    is_installed,
    port_build_file,
    port_files,
    port_manifest,
    siblings_of,
)
from wsgen.porting.existing.comparison import Renamed, compare, compare_with
from wsgen.porting.existing.controllers_of_ros1 import FoundControllers, find_controllers
from wsgen.porting.existing.extensions import (
    CONTROLLERS,
    DIFF_DRIVE,
    Extensions,
    Wanted,
    extend,
)
from wsgen.porting.existing.fixes import (
    Fix,
    fix,
    fixable,
    heavy_collisions,
    without_missing,
)
from wsgen.porting.existing.inertias import box_of, misplaced
from wsgen.porting.existing.kept_xacro import FOLDER, KeptFiles, NotKeptError, keep_files
from wsgen.porting.existing.launch_port import Source as CatkinSource
from wsgen.porting.existing.made_meshes import MadeMeshes
from wsgen.porting.existing.reading import KINDS, read_robot, refuse
from wsgen.porting.existing.resources import (
    CONFIG,
    find_references,
    place_files,
    rewrite,
    usable,
)
from wsgen.porting.existing.sources import open_source
from wsgen.porting.models import bridge_rows, port_model
from wsgen.porting.ported import FilePort, joined
from wsgen.porting.porter import MODEL, NAMESPACE
from wsgen.templating.render import render_package, render_tree
from wsgen.templating.spec import license_names
from wsgen.text.files import read_regular_text
from wsgen.text.markup import without_comments

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Geometry, Robot
    from wsgen.packages.workspace.layout import Workspace
    from wsgen.pipeline.create import CreatedPackage, NewPackage
    from wsgen.pipeline.prepare import PreparedRobot
    from wsgen.porting.existing.comparison import ComparedRow
    from wsgen.porting.existing.reading import Read
    from wsgen.porting.ported import Unported
    from wsgen.templating.template import Template
    from wsgen.templating.write import PackageTree


TEMPLATE = "existing"
MAIN, EXTENSIONS = "model/robot.xacro", "model/robot.gazebo"
WORLD_FILE, BRIDGE_FILE = "model/empty_world.world", "config/bridge.yaml"
RVIZ_FILE = "config/robot.rviz"
CONTROLLERS_FILE = "config/controllers.yaml"
_NOT_NEEDED = ("model/inertia.xacro",)  # of the files of other templates
_CLEARANCE = 0.005  # m, under the robot when it is spawned
_LICENSE = re.compile(r"<license[^>]*>([^<]+)</license>")
_LICENSE_FILES = ("LICENSE", "LICENSE.txt", "LICENSE.md", "COPYING", "license.txt", "license.md")
_EXPRESSION = re.compile(r"\$(?=[({])")


class ExistingRequest(NamedTuple):
    """What is to become a package, and how."""

    source: str  # as given
    arguments: Mapping[str, str] = {}  # of a xacro file
    copy_outside: bool = False  # also files that are not of the source
    keeps_license: bool = True  # that of the source, if it names one
    wanted: Wanted = Wanted()
    is_bolted: bool = False  # to the ground, by its root link
    fixes: bool = False  # what simulators refuse or change


class ExistingRobot(NamedTuple):
    """A robot that has become a package."""

    created: CreatedPackage
    source: str  # the file that it was read from
    kind: str  # of that: urdf, xacro, sdf, mjcf
    rows: tuple[ComparedRow, ...]
    notes: tuple[str, ...]  # sentences: what was done, and what its author should know
    unported: tuple[Unported, ...]
    diagnostics: tuple[Diagnostic, ...]  # what simulators make of it
    fixes: tuple[str, ...] = ()  # sentences: what was fixed
    fixable: tuple[str, ...] = ()  # names of rules that fixes may have something for

    @property
    def is_same(self) -> bool:
        """Whether the robot of the package is that of the source, but for what was fixed."""
        return all(row.is_same or row.is_fixed for row in self.rows)

    @property
    def passed(self) -> bool:
        """Whether it is, and simulators take all of it."""
        return self.is_same and not has_errors(self.diagnostics)


def create_existing(
    planned: NewPackage,
    request: ExistingRequest,
    *,
    environment: Mapping[str, str],
    is_dry_run: bool,
    announce: Callable[[Workspace], None],
) -> ExistingRobot:
    """Write a package with a robot that exists.

    Raises:
        RequestError: The source is no robot, or names files outside of it.
        NotFoundError: The source or a mesh does not exist.
        NotReadableError: The robot cannot be read; or the disk does not take the files.
        WouldOverwriteError: The package exists; nothing is written.
    """
    with make_scratch() as scratch:
        read = read_robot(
            open_source(request.source, scratch, environment),
            request.arguments,
            copy_outside=request.copy_outside,
            fixes=request.fixes,
            environment=environment,
            scratch=scratch,
        )
        source = read.source
        making = _Making(planned, request, read, environment, scratch)
        tree = making.make(read.missing)
        created = write_new(planned, tree, is_dry_run=is_dry_run, announce=announce)
        return ExistingRobot(
            created,
            source.shown,
            source.kind,
            tuple(making.rows),
            tuple(making.notes),
            tuple(making.unported),
            tuple(making.diagnostics),
            tuple(dict.fromkeys(one.sentence for one in making.fixes)),
            () if request.fixes else tuple(fixable(making.diagnostics)),
        )


class _Making:
    """A package while it is made."""

    def __init__(
        self,
        planned: NewPackage,
        request: ExistingRequest,
        read: Read,
        environment: Mapping[str, str],
        scratch: Path,
    ) -> None:
        self.spec, self.folder = planned.spec, planned.folder
        self.template = _without(planned.template, _NOT_NEEDED)
        self.request = request._replace(arguments=read.arguments)
        self.source, self.description = read.source, read.description
        self.environment, self.scratch = environment, scratch
        self.resources = place_files(read.description.meshes, read.source)
        self.rows: list[ComparedRow] = []
        self.notes = [*read.notes]
        self.unported = list(read.description.notes)
        self.diagnostics: list[Diagnostic] = []
        self.extensions = Extensions()
        self.ported = FilePort()  # of the plugins for Gazebo Classic
        self.root = ""  # the link that is bolted
        self.fixes = [Fix(sentence, (), ()) for sentence in read.fixes]
        self.renamed = Renamed()
        self.manifest = find_package(read.source.file, read.source.packages.values())
        self.controllers = FoundControllers()
        self.limited: tuple[str, ...] = ()  # joints that a plugin drove otherwise than they say

    def make(self, missing: Sequence[str] = ()) -> PackageTree:
        """The files of the package; what is compared and reported comes with them.

        `missing` are meshes that do not exist, whose shapes are left out.
        """
        alone = self.folder / self._alone("").main
        file = alone if self.source.kind == "xacro" else self.source.file
        before = self._written()
        written = self._port(before, file)
        if written != before:
            self._note_limits(before, written)
        if self.request.fixes:
            written = self._fix(written, missing)
        robot, found = self._read(written)
        if robot is None:
            refuse(found, self.source, can_fix=not self.request.fixes and bool(fixable(found)))
        assert robot is not None  # noqa: S101  else it was refused
        laid = self.scratch / "package" / self.spec.name
        self._extend(robot, written, laid)
        texts, text = self._choose_texts(written)
        files: dict[str, str | bytes | Path] = {**self.resources.files, **texts.more, **texts.files}
        prepared = self._prepare(text, laid)
        self._compare(self._located(_without_link(prepared.written, self.root), laid), written)
        self.unported += dict.fromkeys(self.ported.unported)
        if not self.request.fixes:
            self._offer(prepared)
        self._note_files()
        license_text = self._take_license()
        if license_text is not None:
            files["LICENSE"] = license_text
        catkin = self._catkin(texts)
        if catkin is not None:
            ported = port_files(catkin)
            files = {**ported.files, **files}
            needs = [(kind, one) for kind, names in self.spec.dependencies.items() for one in names]
            needs += [("exec_depend", one) for one in ported.packages]
            manifest = port_manifest(catkin, needs, self.spec.license)
            self.unported += (*ported.notes, *manifest.notes)
            systems = self.extensions.systems | ported.systems
            self.extensions = self.extensions._replace(systems=systems)
            launch = [path for path in ported.files if path.endswith(".launch.py")]
            if launch:
                self.notes.append(f"Ported the launch files of ROS 1: {', '.join(launch)}.")
        installed = [path for path in files if "/" not in path or is_installed(path)]
        added = {"robot": self._facts(texts, prepared), "files": installed}
        rendered = render_package(self.spec, self.template, added)
        if catkin is not None:
            built = port_build_file(catkin, files, rendered[BUILD_FILE])
            rendered |= {MANIFEST: manifest.text, BUILD_FILE: built}
        return dict(sorted({**rendered, **files}.items()))

    def _written(self) -> str:
        """The URDF with the names that its files have in the package."""
        folders = (*self.source.roots, *self.source.packages.values())
        references = find_references(self.description.text, folders)
        return rewrite(self.description.text, references, self._new_name)

    def _port(self, text: str, file: Path) -> str:
        """The text with what Gazebo Sim has in place of plugins and sensors for Gazebo Classic."""
        target = self.spec.target
        if target.simulator != SIM or "<gazebo" not in text:
            return text
        port = port_model(SourceText(file, text), target)
        self.ported = joined((self.ported, port))
        return apply(text, port.edits)

    def _note_limits(self, before: str, after: str) -> None:
        """Remember the joints whose limits become those that Gazebo Classic's drive has."""
        old, new = (
            {one.name: one.limit for one in robot.joints} if robot is not None else {}
            for robot in (self._read(before)[0], self._read(after)[0])
        )
        self.limited = tuple(name for name, limit in old.items() if new.get(name) != limit)
        if self.limited:
            self.notes.append(
                f"Set <limit> of {', '.join(self.limited)} to what the drive of Gazebo Classic "
                "turned the wheels with."
            )

    def _fix(self, written: str, missing: Sequence[str]) -> str:
        """The text without what simulators refuse or change."""
        laid = self.scratch / "package" / self.spec.name
        _lay_out(self.resources.files, laid)
        file = laid / FOLDER / "robot.urdf"
        text, fixes = without_missing(written, missing)
        self.fixes += fixes
        for name in self.description.taken:
            sentence = f"Took {self.resources.names[name]} for `{name}`, which does not exist."
            self.fixes.append(Fix(sentence, (), ()))

        def diagnose(now: str) -> tuple[Robot | None, Sequence[Diagnostic]]:
            _lay_out({f"{FOLDER}/{file.name}": now}, laid)
            prepared, found = self._prepared(now, file, laid)
            return None if prepared is None else prepared.readable or prepared.written, found

        # SDF has no limits where none are written: equal ones hold a joint, such as that of an IMU.
        are_meant = self.source.kind == "sdf"
        fixed = fix(text, file, diagnose, self._meshes(laid), are_ranges_meant=are_meant)
        self.fixes += fixed.fixes
        self.renamed = Renamed(fixed.links, fixed.joints)
        self.notes += fixed.refused
        return fixed.text

    def _offer(self, prepared: PreparedRobot) -> None:
        """Note what `--fix` would do that no rule of a check tells."""
        laid = self.scratch / "package" / self.spec.name
        robot = prepared.readable or prepared.written
        self.notes += [
            f"By its meshes, the inertia of `{one.link}` is that {one.where}: --fix moves it to the"
            " center of mass."
            for one in misplaced(robot, self._meshes(laid).measure)
        ]
        self.notes += [
            f"The collision mesh `{uri.rpartition('/')[2]}` has {mesh.triangles:,} triangles: --fix"
            " takes convex parts of it."
            for uri, mesh in heavy_collisions(robot).items()
        ]

    def _meshes(self, laid: Path) -> MadeMeshes:
        """What measures and makes meshes; new ones become files of the package."""

        def add(place: str, content: bytes) -> None:
            files = {**self.resources.files, place: content}
            self.resources = self.resources._replace(files=files)
            _lay_out({place: content}, laid)

        return MadeMeshes(self.spec.name, lambda: self.resources.files, self.scratch, add)

    def _compare(self, package: Robot, written: str) -> None:
        """Compare the robots; what was fixed may differ."""
        source, renamed = self._with_meshes(self.description.text), self.renamed
        reference, of_reference = self.description.reference, Renamed()
        if source is None:
            self.notes.append(
                "The source cannot be read without its fixes: the robots are compared after them."
            )
            source, renamed = self._with_meshes(written), Renamed()
            of_reference = self.renamed
        assert source is not None  # noqa: S101  else it was refused
        touched = {name for one in self.fixes for name in one.names} | {*self.limited}
        self.rows = [
            row._replace(is_fixed=not row.is_same and touched.issuperset(row.differing))
            for row in compare(source, package, renamed)
        ]
        if reference is not None:  # the package may have other masses by fixes
            self.rows.insert(0, compare_with(reference, source, of_reference))
        *others, poses = self.rows
        if not poses.is_same and any(row.is_fixed for row in others):  # of links behind joints
            self.rows = [*others, poses._replace(is_fixed=True)]

    def _extend(self, robot: Robot, written: str, laid: Path) -> None:
        """Choose what the simulator needs beside the robot."""
        wanted, target, name = self.request.wanted, self.spec.target, self.spec.name
        if self.request.is_bolted:
            self.root = self._bolted(robot)
        lumped = robot
        if wanted.control == DIFF_DRIVE:
            prepared = self._prepare(self._expand(self._alone(written)), laid)
            robot, lumped = prepared.readable or robot, prepared.lumped
        if wanted.control in CONTROLLERS:
            self.controllers = self._known_controllers(robot)
            self.unported += self.controllers.notes
        extensions = extend(robot, lumped, wanted, target, name, self.controllers.controllers)
        rows = []
        if target.simulator == SIM:
            rows = bridge_rows(self._written(), target)
        own = [
            one._replace(
                gz_topic=one.gz_topic.replace(MODEL, name).replace(NAMESPACE, ""),
                ros_topic=one.ros_topic.replace(MODEL, name).replace(NAMESPACE, ""),
            )
            for one in rows
        ]
        self.extensions = extensions._replace(
            bridge=tuple(dict.fromkeys((*own, *extensions.bridge))),
            systems=extensions.systems | self.ported.systems,
            packages=extensions.packages | self.ported.packages,
        )
        needed = dict(self.spec.dependencies)
        known = {one for names in needed.values() for one in names}
        more = self.extensions.packages - known
        needed["exec_depend"] = tuple(sorted((*needed.get("exec_depend", ()), *more)))
        self.spec = replace(self.spec, dependencies=needed)
        if self.extensions.is_empty:
            self.template = _without(self.template, (EXTENSIONS,))

    def _known_controllers(self, robot: Robot) -> FoundControllers:
        """The controllers that the package of ROS 1, or those beside it, have for the robot."""
        if self.manifest is None or self.manifest.file is None:
            return FoundControllers()
        folder = self.manifest.file.parent
        siblings = siblings_of(folder).values()
        return find_controllers(folder, siblings, robot, self.request.wanted.control)

    def _bolted(self, robot: Robot) -> str:
        if robot.root == WORLD:
            self.notes.append(
                "The root link is `world`: the robot was fixed to the ground already."
            )
            return ""
        if any(link.name == WORLD for link in robot.links):
            raise RequestError(
                "--bolted: the robot has a link `world` already.",
                hint="Omit --bolted: a root link of that name is fixed to the ground.",
            )
        return robot.root

    def _new_name(self, name: str) -> str | None:
        place = self.resources.names.get(name)
        if place is None:
            return None
        if place.startswith(f"{CONFIG}/"):
            return f"$(find {self.spec.name})/{place}"
        return f"package://{self.spec.name}/{place}"

    def _choose_texts(self, written: str) -> tuple[KeptFiles, str]:
        """The files of the robot, and what they expand to: its own if they can be kept."""
        if self.source.kind == "xacro":
            try:
                return self._keep()
            except NotKeptError as reason:
                name = self.source.file.name
                self.notes.append(f"Wrote what {name} expands to, without its macros: {reason}.")
        texts = self._alone(written)
        try:
            return texts, self._expand(texts)
        except NotKeptError as reason:
            raise NotReadableError(
                f"{self.source.shown}: {reason}.",
                hint=f"wsgen check {self.source.file} says more about the file.",
            ) from None

    def _keep(self) -> tuple[KeptFiles, str]:
        """The files of xacro, and what they expand to, which must be the robot."""
        if self.fixes:
            raise NotKeptError("its robot was fixed")
        kept = keep_files(self.source, self.resources, self.spec.name)
        expanded = self._expand(kept)
        here = f"$(find {self.spec.name})"
        wanted = self._written().replace(here, str(self.scratch / "package" / self.spec.name))
        if not _inside(expanded).startswith(_inside(wanted)):
            raise NotKeptError("with the names of the package they become another robot")
        self.ported = FilePort()
        origins = {place: file for file, place in kept.places.items()}
        ported = {path: self._port(text, origins[path]) for path, text in kept.files.items()}
        if ported != kept.files:
            kept = kept._replace(files=ported)
            expanded = self._expand(kept)
        count = len(kept.files)
        files = "file" if count == 1 else f"files ({count})"
        self.notes.append(f"Kept the xacro {files} with the macros.")
        return kept, expanded

    def _alone(self, written: str) -> KeptFiles:
        """The robot as one URDF; xacro, which includes it, finds no expressions in it."""
        own = f"$(find {self.spec.name})/{CONFIG}/"
        escaped = _EXPRESSION.sub("$$", written.replace(own, "\0")).replace("\0", own)
        name = self.source.file.name.removesuffix(".xml").removesuffix(".xacro")
        name = name.removesuffix(".sdf")
        main = f"{FOLDER}/{usable(name.removesuffix('.urdf'))}.urdf"
        return KeptFiles(main, {main: escaped}, {})

    def _expand(self, texts: KeptFiles) -> str:
        """What the package's robot expands to, as far as it is there; it is laid out for that."""
        laid = self.scratch / "package" / self.spec.name
        shutil.rmtree(laid.parent, ignore_errors=True)
        _lay_out({**self.resources.files, **texts.more, **texts.files}, laid)
        model, _ = render_tree(
            self.spec,
            self.template,
            wanted=lambda path: path in {MAIN, EXTENSIONS},
            added={"robot": self._facts_of_model(texts)},
        )
        _lay_out(model, laid)
        place = self.scratch / "of_package"
        shutil.rmtree(place, ignore_errors=True)
        served = serve_sources({self.spec.name: laid}, place, self.environment)
        text, found = expand_file(laid / MAIN, {}, environment=served)
        if text is None:
            raise NotKeptError(f"xacro fails in the package: {found[-1].message.rstrip('.')}")
        return text

    def _read(self, text: str) -> tuple[Robot | None, tuple[Diagnostic, ...]]:
        return read_urdf(text, file=self.source.file)

    def _with_meshes(self, text: str) -> Robot | None:
        """The robot of a text with the names of the source, its meshes with their paths."""
        robot, _ = self._read(text)
        if robot is None:
            return None
        paths: dict[str, str] = {}
        for name, content in self.description.meshes.items():
            if isinstance(content, bytes):
                path = self.scratch / f"mesh-{len(paths)}{Path(name).suffix}"
                path.write_bytes(content)
            else:
                path = content
            paths[name] = paths[self._new_name(name) or name] = str(path)
        return _with_paths(robot, paths)

    def _located(self, robot: Robot, laid: Path) -> Robot:
        """The robot of the package, its meshes with their paths."""
        return find_meshes(robot, share_of=self._share_of(laid), folder=laid / "model")[0]

    def _share_of(self, laid: Path) -> Callable[[str], Path | None]:
        overlay = overlay_of(self.environment)
        on_path = share_on_model_path(self.environment)
        return lambda name: laid if name == self.spec.name else overlay.share(name) or on_path(name)

    def _prepare(self, text: str, laid: Path) -> PreparedRobot:
        """The robot as the simulator has it, with what wsgen reports of it."""
        prepared, found = self._prepared(text, laid / MAIN, laid)
        if prepared is None:
            refuse(found, self.source)
        assert prepared is not None  # noqa: S101  else there is an error
        self.diagnostics = [
            replace(one, file=self._final(one.file, laid))
            for one in found
            if one.severity is not Severity.INFO
        ]
        return prepared

    def _prepared(
        self, text: str, file: Path, laid: Path
    ) -> tuple[PreparedRobot | None, tuple[Diagnostic, ...]]:
        meshes = self.scratch / "meshes"
        meshes.mkdir(exist_ok=True)
        context = PrepareContext(share_of=self._share_of(laid), folder=meshes, run=run)
        target = self.spec.target
        return prepare_robot(
            text, file=file, context=context, simulator=target.simulator, distro=target.distro
        )

    def _final(self, file: Path | None, laid: Path) -> Path | None:
        """Where a file will be that is laid out now."""
        if file is None or not file.is_relative_to(laid):
            return file
        return self.folder / file.relative_to(laid)

    def _facts(self, texts: KeptFiles, prepared: PreparedRobot) -> Mapping[str, object]:
        """What the sources of the template may name as `robot`."""
        robot = prepared.written
        height = 0.0 if robot.fixed_to_world else _CLEARANCE - _lowest(prepared.lumped)
        places = [pose.xyz for pose in link_poses(robot, IDENTITY).values()]
        extent = max((abs(value) for xyz in places for value in xyz), default=0.0)
        drive = self.extensions.drive
        distance = 0.9  # m, in the time of the behavior
        return {
            **self._facts_of_model(texts),
            "name": self.description.name,
            "root": robot.root,
            "bridge": self.extensions.bridge,
            "systems": [_loaded(one) for one in sorted(self.extensions.systems)],
            "driven": [
                round(distance * part(drive.ahead), 3) + 0.0 for part in (math.cos, math.sin)
            ]
            if drive
            else [],
            "height": f"{height:.4f}".rstrip("0").ljust(3, "0"),
            "distance": max(1.0, round(2.5 * extent, 1)),
            "source": self.source.file.name,
            "is_kept": bool(texts.places),  # with its macros
            "answers": self._answers(),
            "kind": KINDS[self.source.kind],
            "mass": f"{robot.mass:.4g}",
            "joints": len(robot.joints),
            "movable": len(robot.movable_joints),
            "links": len(robot.links),
            "meshes": sum(path.startswith("meshes/") for path in self.resources.files),
            "rows": self.rows,
            "notes": [*self.notes, *dict.fromkeys(one.sentence for one in self.fixes)],
            "unported": self.unported,
        }

    def _answers(self) -> Mapping[str, object]:
        """What was asked for besides the variables of the template, but for what is not given."""
        request = self.request
        given: dict[str, object] = {
            "from": request.source,
            "arguments": [f"{name}:={value}" for name, value in request.arguments.items()],
            "wheels": [*request.wanted.wheels],
            "sensors": [*request.wanted.sensors],
            "fix": request.fixes,
            "bolted": request.is_bolted,
            "copy_outside": request.copy_outside,
        }
        return {name: value for name, value in given.items() if value}

    def _facts_of_model(self, texts: KeptFiles) -> Mapping[str, object]:
        robot, _ = self._read(self.description.text)
        return {
            "file": texts.main,
            "arguments": self.request.arguments,
            "extensions": self.extensions,
            "bolted": self.root,
            "root": self.root or (robot.root if robot else ""),
        }

    def _catkin(self, texts: KeptFiles) -> CatkinSource | None:
        """The package of ROS 1 that the robot is of, if it is."""
        manifest = self.manifest
        if manifest is None or manifest.file is None:
            return None
        folder = manifest.file.parent
        places = {**texts.places, self.source.file: texts.main}
        for name, content in self.description.meshes.items():
            if isinstance(content, Path):
                places[content] = self.resources.names[name]
        places |= dict.fromkeys(self.controllers.files, CONTROLLERS_FILE)
        return CatkinSource(
            folder,
            manifest.name,
            self.spec.name,
            self.spec.target,
            siblings=siblings_of(folder),
            controllers=self.controllers.names,
            controllers_file=CONTROLLERS_FILE,
            systems=self.extensions.systems,
            default_world=WORLD_FILE,
            bridge=BRIDGE_FILE if self.spec.target.simulator == SIM else None,
            moved={
                path.relative_to(folder).as_posix(): place
                for path, place in places.items()
                if path.is_relative_to(folder)
            },
            robot=self.source.file.relative_to(folder).as_posix(),
            model=MAIN,
            entity=self.spec.name,
            rviz=RVIZ_FILE,
        )

    def _note_files(self) -> None:
        renamed = {
            Path(name).name: place
            for name, place in self.resources.names.items()
            if Path(name).name != Path(place).name and name not in self.description.taken
        }
        for name, place in renamed.items():
            self.notes.append(f"Renamed the file `{name}` to {place}.")
        outside = [
            path
            for path in self.resources.files.values()
            if isinstance(path, Path) and not self.source.owns(path)
        ]
        if outside:
            self.notes.append(
                f"Copied {len(outside)} files from outside of the source, such as {outside[0]}:"
                " look at their license."
            )
        lost = self.resources.lost
        if lost:
            more = f" and {len(lost) - 1} more" if len(lost) > 1 else ""
            self.notes.append(f"Meshes name files that were not found: {lost[0]}{more}.")

    def _take_license(self) -> str | None:
        """Take the license of the source; its text, unless it is one that wsgen has."""
        if not self.request.keeps_license:
            return None
        root = self.source.roots[-1]
        found = None
        for folder in dict.fromkeys((*self.source.packages.values(), *self.source.roots)):
            manifest = folder / "package.xml"
            if self.source.file.is_relative_to(folder) and manifest.is_file():
                found = _LICENSE.search(read_regular_text(manifest, errors="replace"))
                root = folder
        text = next(
            (
                read_regular_text(root / name, errors="replace")
                for name in _LICENSE_FILES
                if (root / name).is_file()
            ),
            None,
        )
        name = found[1].strip() if found is not None else ""
        if not name or name.upper() == "TODO":
            self.notes.append(
                "The source does not name a license: package.xml says"
                f" {self.spec.license}, which is for you to grant or to change."
            )
            return text
        known = next((one for one in license_names() if one.lower() == name.lower()), None)
        self.spec = replace(self.spec, license=known or name)
        if known is not None and text is None:
            return None
        self.template = _without(self.template, ("LICENSE",))
        if text is None:
            self.notes.append(
                f"The license of the source is `{name}`, without its text: put it into LICENSE."
            )
        return text or (
            f"The robot in this package came with the license `{name}`.\n"
            "Its source did not have the text of the license: put it here.\n"
        )


def _loaded(system: str) -> str:
    """The element that has a world load a system."""
    element = plugin_of(system)
    if system != "Sensors":
        return element
    return f"{element[:-2]}>\n      <render_engine>ogre2</render_engine>\n    </plugin>"


def _without(template: Template, paths: tuple[str, ...]) -> Template:
    """A template that makes some files less."""
    return template._replace(
        parts=tuple(
            part._replace(
                files={path: one for path, one in part.files.items() if path not in paths}
            )
            for part in template.parts
        )
    )


def _with_paths(robot: Robot, paths: Mapping[str, str]) -> Robot:
    """A robot whose meshes have the paths of their files, by the names of these."""

    def located(geometry: Geometry) -> Geometry:
        if isinstance(geometry, Mesh):
            return replace(geometry, path=paths.get(geometry.uri))
        return geometry

    links = (
        replace(
            link,
            visuals=tuple(replace(one, geometry=located(one.geometry)) for one in link.visuals),
            collisions=tuple(
                replace(one, geometry=located(one.geometry)) for one in link.collisions
            ),
        )
        for link in robot.links
    )
    return replace(robot, links=tuple(links))


def _without_link(robot: Robot, bolted: str) -> Robot:
    """A robot without the link `world` that it was bolted to, if it was."""
    if not bolted:
        return robot
    return replace(
        robot,
        root=bolted,
        links=tuple(one for one in robot.links if one.name != WORLD),
        joints=tuple(one for one in robot.joints if one.parent != WORLD),
    )


def _lowest(robot: Robot) -> float:
    """A height that nothing of the robot is below with all joints at zero, its root at 0; m."""
    exact = lowest_point(robot, IDENTITY)
    if exact is not None:
        return exact
    poses = link_poses(robot, IDENTITY)
    heights = [0.0]
    for link in robot.links:
        for collision in link.collisions:
            pose = compose(poses[link.name], collision.pose_in_link)
            down = rotation_of_rpy(pose.rpy)[2]
            heights += [
                pose.z + sum(a * b for a, b in zip(down, corner, strict=True))
                for corner in itertools.product(*box_of(collision.geometry))
            ]
    return min(heights)


def _lay_out(tree: PackageTree, folder: Path) -> None:
    """Write texts into a folder, with links to the files that are copied later."""
    for name, content in tree.items():
        place = folder / name
        place.parent.mkdir(parents=True, exist_ok=True)
        place.unlink(missing_ok=True)
        if isinstance(content, Path):
            try:
                place.symlink_to(content)
            except OSError:  # Windows lets only administrators make links
                shutil.copyfile(content, place)
        else:
            place.write_bytes(content.encode() if isinstance(content, str) else content)


def _inside(text: str) -> str:
    """What is in <robot>, however it is written."""
    text = without_comments(text)
    inside = text[text.find(">", text.find("<robot")) + 1 : text.rfind("</robot")]
    return " ".join(inside.split())
