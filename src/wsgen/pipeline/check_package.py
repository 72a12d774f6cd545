"""Check one package, or one file without a package: what its files say, each and together."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.rules import launch_files
from wsgen.checks.rules.consequences import without_explained
from wsgen.checks.rules.manifests import target_of
from wsgen.descriptions.xacro.reader import without_call
from wsgen.diagnostics import has_errors
from wsgen.isolation.parent import make_part
from wsgen.packages.workspace.layout import LAUNCH_FILES, find_launch_files
from wsgen.packages.workspace.robot_files import find_descriptions
from wsgen.packages.workspace.settings import read_settings
from wsgen.pipeline.candidates import (
    Candidate,
    LaunchFile,
    simulation_of,
    with_commands,
    with_descriptions,
)
from wsgen.pipeline.check_launched import (
    check_addresses,
    check_heights,
    check_launched,
    check_texts,
    check_worlds,
    loaded_worlds,
    may_publish_joint_states,
)
from wsgen.pipeline.check_severities import (
    is_included,
    of_file_alone,
    of_launch,
    without_absent_packages,
    without_simulation,
)
from wsgen.pipeline.check_sources import check_controlled, check_sources, check_topics
from wsgen.pipeline.clock import Clock
from wsgen.pipeline.file_validation import UNUSABLE_FILE, FileValidation, read
from wsgen.pipeline.gazebo_models import KnownWorlds
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.prepare import PrepareContext
from wsgen.pipeline.requests import SelectedPackage, ValidateRequest
from wsgen.pipeline.started import Started, as_sourced, start
from wsgen.text.files import real_path
from wsgen.text.markup import without_comments
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.events import Listener
    from wsgen.isolation.parent import Run
    from wsgen.model.robot import Robot
    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.pipeline.installed_as_built import InstalledAsBuilt
    from wsgen.pipeline.prepare import PreparedRobot


OF_TESTS = frozenset({"test", "tests"})  # folders; their launch files are for launch_testing
OF_LINK = lazy_pattern(rb"<link\b[^>]*?\sname\s*=\s*[\"']([^\"']+)")
OF_GAZEBO = lazy_pattern(
    r"(?i)gazebo|\bgz\b|\bros_(?:gz|ign)_|\b(?:gz|ign)_sim\b|\bign_ros2_control"
)
NOTHING = ValidateRequest()  # launch files and xacro are given no arguments


def _without_comments(file: Path) -> str:
    """The text of a file; comments of XML are not in it: MoveIt's wizard names Gazebo in one."""
    text = read(file).decode("utf-8", "replace")
    return text if file.suffix == ".py" else without_comments(text)


class DescribedRobot(NamedTuple):
    """A robot that a launch file spawns, or that a file of the package describes."""

    written: Robot
    file: Path | None
    launch_file: Path | None  # None: the file is read by itself


class PackageCheck:
    """Reads the files of a package, each once, and checks them."""

    def __init__(  # noqa: PLR0913, PLR0917  what the checks need
        self,
        package: PackageFolder,
        installed: InstalledAsBuilt,
        distro: str | None,
        listener: Listener | None,
        run: Run,
        scratch: Path,
    ) -> None:
        """`scratch` is a folder for files that engines read."""
        installed = installed.of(package)
        self.package = package
        self.scratch = scratch
        self.installed = installed
        self.run_task = run
        self.listener = listener
        self.clock = Clock(package.name, listener)
        self.settings, self.diagnostics_of_settings = read_settings(package.path)
        target = target_of(
            package.manifest,
            given=distro,
            recorded=self.settings.distro,
            sourced=installed.overlay.environment.get("ROS_DISTRO"),
            workspace=installed.sources.keys(),
        )
        self.distro = target.distro
        self.overlay = as_sourced(installed.overlay, target)
        self.robots: list[DescribedRobot] = []
        self.simulators: list[str] = []
        self.may_publish = may_publish_joint_states(installed.sources.values())
        self.descriptions: tuple[Path, ...] = ()  # robots, models and worlds of the package
        self.read: set[str] = set()  # real paths of robots and worlds

    def run(self) -> tuple[Diagnostic, ...]:
        """Run all checks."""
        with (
            self.clock.step("check", self.package.path.name) as step,
            make_part(self.scratch) as folder,
        ):
            unique: dict[Diagnostic, Diagnostic] = {}
            for one in self.installed.named(without_simulation(self._run(folder))):
                unique.setdefault(without_call(one), one)
            packages = (self.package, *self.installed.sources.values()) if unique else ()
            declared = {
                name
                for package in packages
                if package.manifest
                for name in package.manifest.dependency_names
            }
            here = {package.name for package in packages}
            known = without_absent_packages(unique.values(), declared, here)
            found = tuple(without_explained(known))
            step.succeeded = not has_errors(found)
        return found

    def _run(self, folder: Path) -> Iterator[Diagnostic]:
        yield from self.diagnostics_of_settings
        candidates = () if self.package.diagnostics else self.evaluate()
        yield from check_sources(
            self.package,
            build=self.installed.facts.get(self.package.name),
            problems=self.installed.problems.get(self.package.name, ()),
            plans=[one.started.plan for one in candidates],
            packages=self.installed.sources,
            distro=self.distro,
        )
        if self.package.diagnostics:
            return
        yield from self._check_launched(candidates, folder)
        self.descriptions = tuple(
            file
            for file in find_descriptions(self.package.path)
            if OF_TESTS.isdisjoint(file.relative_to(self.package.path).parts)
        )
        yield from self._check_files(folder)
        yield from check_worlds(
            self.descriptions,
            loaded_worlds((one.started for one in candidates), self.overlay.environment),
            self.overlay.environment,
            simulator=self.simulators[0] if len(set(self.simulators)) == 1 else None,
            distro=self.distro,
            spawned_into=self.read,
        )
        yield from check_texts(
            self.package,
            [one.written for one in self.robots],
            [one.started.plan for one in candidates],
        )
        yield from check_topics(
            self.package,
            [one.started for one in candidates],
            self.installed.facts,
            self.installed.sources,
        )
        yield from check_controlled(
            ((one.written, one.file) for one in self.robots),
            [one.started.plan for one in candidates],
            self.overlay.share,
        )

    def evaluate(self, wanted: Collection[str] | None = None) -> list[Candidate]:
        """The launch files of the package, evaluated with their defaults.

        Args:
            wanted: The real paths of those that are needed; None: all.
        """
        share = self.overlay.share(self.package.name)
        folder = share or self.package.path
        files = [
            file
            for file in find_launch_files(folder)
            if OF_TESTS.isdisjoint(file.relative_to(folder).parts)
            and (wanted is None or real_path(file) in wanted)
            # In packages of ROS 1 this is an ending of its own launch files.
            and not (self.package.build_type == "catkin" and file.name.endswith(".launch.xml"))
        ]

        def evaluate(launch_file: LaunchFile, arguments: Mapping[str, str]) -> Started:
            request = replace(NOTHING, launch_arguments=arguments)
            name = self.package.name
            return start(launch_file.file, name, self.overlay, request, self.run_task)

        launch_files = [LaunchFile(self.package.name, file) for file in files]
        found = [Candidate(launch_file, evaluate(launch_file, {})) for launch_file in launch_files]
        return list(with_descriptions(with_commands(found, evaluate), self.overlay))

    def _check_launched(
        self, candidates: Sequence[Candidate], folder: Path
    ) -> Iterator[Diagnostic]:
        """What the launch files do, and once each the robots and worlds that they start."""
        known = set()
        worlds = KnownWorlds(folder, (one.started for one in candidates))
        for one in candidates:
            started = one.started
            yield from of_launch(
                one,
                candidates,
                self.package.path,
                is_included_elsewhere=partial(self._is_named_elsewhere, one.file),
            )
            yield from check_launched(
                started,
                self.overlay.environment,
                [other.started.plan for other in candidates if other is not one],
                is_included=is_included(one, candidates),
                is_known=self.installed.is_known,
                distro=self.distro,
                is_installed=self._is_installed,
                may_publish=self.may_publish,
            )
            yield from check_addresses(started, self.overlay.share)
            same = simulation_of(one)
            may_spawn = started.has_spawner or (
                # Where it is included, it may be given another world.
                started.lacks_world and not is_included(one, candidates)
            )
            if not started.is_evaluated or not may_spawn or same in known:
                continue
            known.add(same)
            selected = SelectedPackage(
                name=self.package.name,
                source=self.package.path,
                share=self.overlay.share(self.package.name),
                launch_file=one.file,
                started=started,
            )
            validation = Validation(
                selected, self.overlay, NOTHING, None, self.run_task, worlds=worlds
            )
            world, scene = validation.read(folder)
            yield from (one for one in validation.diagnostics if one not in started.diagnostics)
            yield from check_heights(started, world, scene, validation.diagnostics)
            files = {spawn.entity: spawn.description_file for spawn in started.spawns}
            self._note(scene, files, one.file)
            if validation.simulator_kind is not None:
                self.simulators.append(validation.simulator_kind)
            self.read |= {
                real_path(file)
                for file in (
                    *(spawn.description_file for spawn in started.spawns),
                    world.file if world else None,
                )
                if file is not None
            }

    def _is_named_elsewhere(self, file: Path, *arguments: str) -> bool:
        """Whether a launch file of another package of the workspaces names one of this package.

        With names of launch arguments: whether it has these, too, in any package. What it starts
        may depend on what happens: on the exit code of a process, or on its output.
        """
        names = [name.encode() for name in (file.name, self.package.name, *arguments)]
        return any(
            all(name in read(other) for name in names)
            for package in self.installed.sources.values()
            if arguments or package.name != self.package.name
            for other in find_launch_files(package.path)
            if other.name != file.name or package.name != self.package.name
        )

    def _is_for_gazebo(self) -> bool:
        """Whether a manifest, launch file or robot of the workspaces names Gazebo."""
        return any(
            OF_GAZEBO.search(_without_comments(file))
            for package in self.installed.sources.values()
            for file in (
                package.path / "package.xml",
                *find_launch_files(package.path),
                *find_descriptions(package.path),
            )
        )

    def _may_be_spawned(self, robots: Sequence[PreparedRobot]) -> bool:
        """Whether Gazebo may be given a robot of a file that no launch file here spawns.

        It is not where nothing is about Gazebo, or where the robot is there as SDF, too, with all
        its links: that is for Gazebo, and the URDF for robot_state_publisher.
        """
        if not self._is_for_gazebo():
            return False
        links = {link.name.encode() for robot in robots for link in robot.written.links}
        return not any(
            links <= {*OF_LINK.findall(read(file))}
            for package in self.installed.sources.values()
            for file in find_descriptions(package.path)
            if file.suffix == ".sdf"
        )

    def _is_installed(self, package: str) -> bool:
        """Whether a package is on this machine or in the workspace."""
        return self.overlay.share(package) is not None

    def _note(
        self,
        scene: Iterable[PreparedRobot],
        files: Mapping[str, Path | None],
        launch_file: Path | None,
    ) -> None:
        self.robots += [
            DescribedRobot(one.written, files.get(one.entity), launch_file)
            for one in scene
            if not one.is_static_model
        ]

    def _check_files(self, folder: Path) -> Iterator[Diagnostic]:
        """The robots and worlds of the package that no launch file starts."""
        for file in self.descriptions:
            if real_path(file) in self.read:
                continue
            validation = FileValidation(
                file, self.overlay, NOTHING, None, self.run_task, name=file.name
            )
            context = PrepareContext(share_of=validation.share_of, folder=folder, run=self.run_task)
            _, prepared = validation.read(context)
            yield from of_file_alone(
                validation.diagnostics,
                partial(self._may_be_spawned, prepared),
                validation.text,
            )
            self._note(prepared, dict.fromkeys((one.entity for one in prepared), file), None)


class FileCheck:
    """Checks a file that belongs to no package."""

    def __init__(
        self,
        file: Path,
        installed: InstalledAsBuilt,
        listener: Listener | None,
        run: Run,
        scratch: Path,
    ) -> None:
        """`scratch` is a folder for files that engines read."""
        self.file = file
        self.scratch = scratch
        self.installed = installed
        self.run_task = run
        self.clock = Clock(file.name, listener)

    def run(self) -> tuple[Diagnostic, ...]:
        """Read and check it."""
        with self.clock.step("check", self.file.name) as step, make_part(self.scratch) as folder:
            found = tuple(without_absent_packages(without_simulation(self._run(folder)), ()))
            step.succeeded = not has_errors(found)
        return found

    def _check_launch_file(self, overlay: Overlay, folder: Path) -> Iterator[Diagnostic]:
        started = start(self.file, None, overlay, NOTHING, self.run_task)
        yield from of_launch(Candidate(LaunchFile("", self.file), started), ())
        yield from check_launched(started, overlay.environment)
        if started.is_evaluated and started.may_spawn:
            selected = SelectedPackage(
                name=self.file.stem, source=None, share=None, launch_file=self.file, started=started
            )
            validation = Validation(selected, overlay, NOTHING, None, self.run_task)
            validation.read(folder)
            yield from (one for one in validation.diagnostics if one not in started.diagnostics)

    def _run(self, folder: Path) -> tuple[Diagnostic, ...]:
        overlay = self.installed.overlay
        if self.file.name.endswith(LAUNCH_FILES):
            return tuple(self._check_launch_file(overlay, folder))
        if self.file.suffix == ".launch":
            of_ros_1 = tuple(launch_files.ros_1_launch_files([self.file]))
            if of_ros_1:
                return of_ros_1
            if b"<launch" in read(self.file):
                return (
                    UNUSABLE_FILE.at(
                        self.file,
                        message=f"The XML launch file {self.file.name} does not end in `.xml`.",
                        hint=f"Rename it, so that `ros2 launch` lists it: {self.file.name}.xml",
                    ),
                )
        validation = FileValidation(
            self.file, overlay, NOTHING, None, self.run_task, name=self.file.name
        )
        context = PrepareContext(share_of=validation.share_of, folder=folder, run=self.run_task)
        validation.read(context)
        return (
            *of_file_alone(validation.diagnostics),
            *check_worlds([self.file], {}, overlay.environment, simulator=None, distro=None),
        )
