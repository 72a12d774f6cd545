"""An SDF world file -> World.

What a trial needs of it: gravity, the physics step, and whether something carries the robot. The
models of the world other than sun and ground plane are listed, and reported as left out.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen import xmltree
from wsgen.diagnostics import Diagnostic, Severity
from wsgen.model.pose import IDENTITY, Pose
from wsgen.model.world import PlacedModel, World

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.xmltree import Element

# What Gazebo starts with when no world is named: both generations ship one with sun and ground.
DEFAULT_WORLD = World(
    name="default",
    models=(PlacedModel(name="ground_plane", is_static=True),),
    has_ground_plane=True,
    lights=("sun",),
)

LONGEST_STEP = 0.02  # s; with longer ones contacts are missed, and no engine is stable

# Their Fuel addresses end in the same words, with capitals and a blank.
GROUND_PLANE = "ground_plane"
SUN = "sun"


def read_world(file: Path) -> tuple[World | None, tuple[Diagnostic, ...]]:
    """Read a world file; None where it cannot be used, with the reason among the diagnostics."""
    try:
        content = file.read_bytes()
    except OSError as error:
        return None, (
            Diagnostic(
                code="WLD001",
                severity=Severity.ERROR,
                message=f"The world file cannot be read: {error.strerror}.",
                file=file,
                hint="Is its folder in an install(DIRECTORY ...) rule of CMakeLists.txt? "
                "Then build again with `wsgen build`.",
            ),
        )
    root = xmltree.parse(content)
    if isinstance(root, xmltree.Malformed):
        return None, (
            Diagnostic(
                code="WLD002",
                severity=Severity.ERROR,
                message=f"The world file is not well-formed XML: {root.message}.",
                file=file,
                line=root.line,
                hint="Close every element that was opened, and quote every attribute.",
            ),
        )
    return _Reader(file).read(root)


class _Reader:
    """One pass over one file; collects what is wrong with it."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.diagnostics: list[Diagnostic] = []

    def report(
        self, code: str, severity: Severity, message: str, element: Element, hint: str
    ) -> None:
        self.diagnostics.append(
            Diagnostic(
                code=code,
                severity=severity,
                message=message,
                file=self.file,
                line=_line(element),
                element=element.getroottree().getpath(element),
                hint=hint,
            )
        )

    def read(self, root: Element) -> tuple[World | None, tuple[Diagnostic, ...]]:
        world = next(xmltree.children(root, "world"), None) if root.tag == "sdf" else None
        if world is None:
            self.report(
                "WLD003",
                Severity.ERROR,
                f"There is no <world> in an <sdf> here; the root element is <{root.tag}>.",
                root,
                'A world file is <sdf version="1.5"><world name="..."> ... </world></sdf>.',
            )
            return None, tuple(self.diagnostics)
        models = [*self._includes(world), *self._models(world)]
        grounds = [model for model in models if model.name == GROUND_PLANE]
        result = World(
            name=world.get("name") or "default",
            file=self.file,
            gravity=self._gravity(world),
            step=self._step(world),
            models=tuple(model for model in models if model.uri is None or not _is_sun(model.uri)),
            has_ground_plane=bool(grounds) or self._has_plane_collision(world),
            lights=self._lights(world, models),
            plugins=tuple(plugin.get("filename", "") for plugin in world.iter("plugin")),
        )
        if not result.has_ground_plane:
            self.report(
                "WLD006",
                Severity.WARNING,
                "The world has no ground plane: whatever is spawned into it falls.",
                world,
                "Add <include><uri>model://ground_plane</uri></include> to the world.",
            )
        return result, tuple(self.diagnostics)

    def _includes(self, world: Element) -> list[PlacedModel]:
        models = []
        for include in xmltree.children(world, "include"):
            uri = xmltree.child_text(include, "uri") or ""
            if _is_sun(uri):
                models.append(PlacedModel(name=SUN, uri=uri, is_static=True))
            elif _is_ground_plane(uri):
                pose = self._pose(include)
                models.append(
                    PlacedModel(name=GROUND_PLANE, uri=uri, pose_in_world=pose, is_static=True)
                )
                self._check_ground(include, pose)
            else:
                self.report(
                    "WLD004",
                    Severity.WARNING,
                    f"The model {uri or '(no uri)'} is not part of the trial: "
                    "only sun and ground plane are.",
                    include,
                    "The robot is tried without it.",
                )
                name = xmltree.child_text(include, "name") or uri.rstrip("/").rpartition("/")[2]
                models.append(PlacedModel(name=name, uri=uri, pose_in_world=self._pose(include)))
        return models

    def _models(self, world: Element) -> list[PlacedModel]:
        models = []
        for element in xmltree.children(world, "model"):
            model = PlacedModel(
                name=element.get("name", ""),
                pose_in_world=self._pose(element),
                is_static=(xmltree.child_text(element, "static") or "").lower() in ("1", "true"),
            )
            models.append(model)
            if any(True for _ in element.iter("plane")):
                self._check_ground(element, model.pose_in_world)
            else:
                self.report(
                    "WLD004",
                    Severity.WARNING,
                    f"The model {model.name} is not part of the trial: "
                    "only sun and ground plane are.",
                    element,
                    "The robot is tried without it.",
                )
        return models

    def _check_ground(self, element: Element, pose: Pose) -> None:
        if (pose.xyz[2], *pose.rpy[:2]) != (0.0, 0.0, 0.0):
            self.report(
                "WLD009",
                Severity.WARNING,
                f"The ground is at z = {pose.xyz[2]:g} m, turned by {pose.rpy[0]:g} and "
                f"{pose.rpy[1]:g} rad; in the trial it is level, at z = 0.",
                element,
                "Put the ground plane at the origin, and spawn the robot above it.",
            )

    def _has_plane_collision(self, world: Element) -> bool:
        return any(
            True
            for model in xmltree.children(world, "model")
            for collision in model.iter("collision")
            for _ in collision.iter("plane")
        )

    def _lights(self, world: Element, models: list[PlacedModel]) -> tuple[str, ...]:
        inline = [light.get("name", "") for light in xmltree.children(world, "light")]
        included = [model.name for model in models if model.uri and _is_sun(model.uri)]
        return (*included, *inline)

    def _gravity(self, world: Element) -> tuple[float, float, float]:
        # Until SDF 1.5 it was part of <physics>.
        places = (world, *xmltree.children(world, "physics"))
        for element in (e for place in places for e in xmltree.children(place, "gravity")):
            numbers = self._numbers(element, 3)
            if numbers:
                return (numbers[0], numbers[1], numbers[2])
        return DEFAULT_WORLD.gravity

    def _step(self, world: Element) -> float:
        for physics in xmltree.children(world, "physics"):
            for element in xmltree.children(physics, "max_step_size"):
                numbers = self._numbers(element, 1)
                if numbers and 0 < numbers[0] <= LONGEST_STEP:
                    return numbers[0]
                if numbers:
                    self.report(
                        "WLD007",
                        Severity.ERROR,
                        f"The physics step of {numbers[0]:g} s is not between 0 and "
                        f"{LONGEST_STEP:g} s.",
                        element,
                        "Gazebo's default is 0.001.",
                    )
        return DEFAULT_WORLD.step

    def _pose(self, element: Element) -> Pose:
        for pose in xmltree.children(element, "pose"):
            numbers = self._numbers(pose, 6)
            if numbers:
                return Pose(
                    (numbers[0], numbers[1], numbers[2]), (numbers[3], numbers[4], numbers[5])
                )
        return IDENTITY

    def _numbers(self, element: Element, count: int) -> list[float]:
        """The finite numbers of an element; empty, with a diagnostic, if they are none."""
        words = (element.text or "").split()
        try:
            numbers = [float(word) for word in words]
        except ValueError:
            numbers = []
        if len(numbers) == count and all(math.isfinite(number) for number in numbers):
            return numbers
        self.report(
            "WLD005",
            Severity.ERROR,
            f"<{element.tag}> needs {count} finite number{'s' if count > 1 else ''}, "
            f"not {' '.join(words) or 'nothing'!r}.",
            element,
            "Separate numbers by blanks, with a point for decimals.",
        )
        return []


def _is_sun(uri: str) -> bool:
    return _last_word(uri) == SUN


def _is_ground_plane(uri: str) -> bool:
    return _last_word(uri) == GROUND_PLANE


def _last_word(uri: str) -> str:
    return uri.rstrip("/").rpartition("/")[2].lower().replace(" ", "_").replace("%20", "_")


def _line(element: Element) -> int | None:
    # lxml's stubs give it the type of a descriptor.
    line = element.sourceline
    return line if isinstance(line, int) else None
