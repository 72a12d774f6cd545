"""Read an SDF file: its models as robots, and the world around them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.descriptions.rules import UNNAMED_ELEMENT
from wsgen.descriptions.sdf.frames import (
    MODEL_FRAME,
    PARTS,
    UNKNOWN_FRAME,
    UNNAMED,
    Node,
    Scope,
    checked_name,
    is_level_at_zero,
    kind_of,
    resolve_poses,
)
from wsgen.descriptions.sdf.includes import (
    GROUND_PLANE_FRICTION,
    MODEL_LEFT_OUT,
    Includes,
    is_ground_plane,
    is_sun,
)
from wsgen.descriptions.sdf.source import line_of, load, parse_text, with_version
from wsgen.descriptions.sdf.values import first, read_pose, truth, word
from wsgen.descriptions.sdf.worlds import check_ground, describe_world
from wsgen.diagnostics import Measured, Rule, Severity
from wsgen.gazebo.systems import is_of_gz
from wsgen.model.robot import Mesh
from wsgen.model.transform import IDENTITY, Pose, compose
from wsgen.model.world import PlacedModel
from wsgen.text.files import real_path
from wsgen.text.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Callable

    from wsgen.descriptions.sdf.frames import Poses
    from wsgen.descriptions.sdf.includes import ReadRobot
    from wsgen.descriptions.sdf.source import Source
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.devices import Devices
    from wsgen.model.robot import Robot
    from wsgen.model.world import World
    from wsgen.text.xmltree import Element


NO_WORLD = Rule(
    code="WLD003",
    name="no-world",
    severity=Severity.ERROR,
    severity_varies="information from `wsgen check` for a format of Gazebo 1, and for a single "
    "light",
    measured=Measured(classic="loads nothing of it", sim="accepts it"),
    summary="An SDF file has neither a `<world>` nor a `<model>`.",
    why="Gazebo refuses the file: it contains nothing to load.",
    example='<sdf version="1.9">\n</sdf>',
    instead='<sdf version="1.9">\n  <world name="w">\n  </world>\n</sdf>',
)

TOO_MANY_MODELS = Rule(
    code="WLD014",
    name="too-many-models",
    severity=Severity.ERROR,
    summary="Models are nested too deeply or have too many parts.",
    what="Allows 50 levels of nested models, and 60,000 links, joints, frames and models in a file "
    "and its includes.",
    why="Usually models include each other several times by mistake. Simulators cannot load such a "
    "file.",
    example='<model name="a">\n  <include><uri>model://b</uri></include>\n'
    "  <include><uri>model://b</uri></include>\n  ...",
    instead="Move the models to the top level of the world, and place them with `relative_to`.",
)

SEVERAL_MODELS = Rule(
    code="WLD038",
    name="several-models",
    severity=Severity.ERROR,
    severity_varies="a warning in a file with a world, which is then read",
    summary="Only one of the worlds and models of the file is read.",
    why="Gazebo's parser refuses a file with several models outside of a world. wsgen simulates "
    "only the first world of a file.",
    example='<sdf version="1.9">\n  <model name="a">...</model>\n  <model name="b">...</model>\n'
    "</sdf>",
    instead='<sdf version="1.9">\n  <world name="w">\n    <model name="a">...</model>\n'
    '    <model name="b">...</model>\n  </world>\n</sdf>',
)

SPAWNED_LIGHT = Rule(
    code="WLD060",
    name="spawned-light",
    severity=Severity.INFO,
    summary="A launch file spawns only a light or an actor, which is not simulated.",
    why="Gazebo spawns it; wsgen does not simulate lights and actors.",
    example='<sdf version="1.9">\n  <light name="lamp" type="point"/>\n</sdf>',
    instead="No action is needed.",
)

SPAWNED_WORLD = Rule(
    code="WLD043",
    name="spawned-world",
    severity=Severity.ERROR,
    summary="A launch file spawns a world, but spawners only accept models.",
    why="The spawner of Gazebo refuses a file whose root contains a `<world>`.",
    example="arguments=['-file', 'worlds/field.sdf', '-name', 'field']",
    instead="launch_arguments={'gz_args': '-r worlds/field.sdf'}.items()",
)

NESTED_STATIC_MODEL = Rule(
    code="WLD048",
    name="nested-static-model",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A static model is nested in a model that can move.",
    why="Gazebo fixes the inner model, and thus the outer one, to the world; in wsgen's simulation "
    "both move.",
    example='<model name="robot">\n  <model name="base">\n    <static>true</static>',
    instead='<model name="robot">\n  <static>true</static>\n  <model name="base">',
)

DEEPEST = 50  # models in models; public ones have three
MOST_PARTS = 60_000  # links, joints, frames and models of a file with all that it includes

Trail = tuple["Path", ...]  # the files that lead to an element


def _saved_models(world: Element) -> dict[str, Element]:
    """What <state> has of models: Gazebo Classic puts them there; Gazebo Sim does not read it."""
    if any(is_of_gz(one.get("filename") or "") for one in children(world, "plugin")):
        return {}
    return {
        model.get("name") or "": model
        for state in children(world, "state")
        for model in children(state, "model")
    }


class Contents:
    """Reads worlds and models, with the models that they include, into scopes."""

    def __init__(self, includes: Includes) -> None:
        self.includes = includes
        self.parts = 0

    def world(self, source: Source, element: Element) -> Scope:
        """A world, with its models."""
        scope = Scope(element.get("name") or "default", source=source, element=element)
        self._fill(scope, _start(source))
        for name, saved in _saved_models(element).items():
            node = scope.nodes.get(name)
            if node is not None and node.kind == "model" and first(saved, "pose") is not None:
                node.pose, node.relative_to = read_pose(source, saved)
        return scope

    def alone(self, source: Source, element: Element) -> Scope:
        """The place of a single model, with the model in it; `element` may be its include."""
        scope = Scope("", source=source, element=source.root)
        add = self._include if element.tag == "include" else self._add
        add(scope, element, _start(source))
        return scope

    def _fill(self, scope: Scope, trail: Trail) -> None:
        """Put everything that has a frame into the scope."""
        for child in children(scope.element, *PARTS, "include"):
            if not self._is_within_bounds(scope.source, child):
                return
            if child.tag == "include":
                self._include(scope, child, trail)
            elif not (scope.is_world and child.tag in {"link", "joint"}):
                self._add(scope, child, trail)

    def _add(self, scope: Scope, element: Element, trail: Trail) -> None:
        """Add a link, joint, frame or model that is written in the scope."""
        source, kind = scope.source, kind_of(element)
        name = checked_name(scope, kind, element.get("name") or "", element)
        if name is None:
            return
        node = Node(kind, name, scope, source=source, element=element)
        node.pose, node.relative_to = read_pose(source, element)
        scope.nodes[name] = node
        if kind == "model":
            node.is_static = truth(source, element, "static", default=False)
            self._open(node, element.get("placement_frame") or "", trail)

    def _include(self, scope: Scope, include: Element, trail: Trail) -> None:
        """Add a model of another file, with the name, pose and placement that the include gives."""
        uri = word(include, "uri")
        if is_sun(uri):
            return
        found = self.includes.find(scope.source, include, uri, trail, outer=scope.node)
        is_merged = not scope.is_world and include.get("merge") in {"true", "1"}
        if found is None:
            last = uri.rstrip("/").rpartition("/")[2]
            given = word(include, "name")
            scope.left_out |= {""} if is_merged else {given} if given else {last, UNNAMED}
            return
        source, element = found
        node = self._place(scope, include, uri, source, element)
        if node is None:
            return
        static = first(include, "static")
        node.is_static = (
            truth(source, element, "static", default=False)
            if static is None
            else truth(scope.source, include, "static", default=False)
        )
        if element.tag != "model":
            return
        inside_trail = trail if source.file is None else (*trail, source.file)
        placement = word(include, "placement_frame") or element.get("placement_frame") or ""
        self._open(node, placement, inside_trail, is_merged=is_merged)
        if is_merged and node.inside is not None:
            del scope.nodes[node.name]
            scope.merged.append(node.inside)

    def _place(
        self, scope: Scope, include: Element, uri: str, source: Source, element: Element
    ) -> Node | None:
        """An included model in the scope; None, with a diagnostic, if its name is not usable."""
        last = uri.rstrip("/").rpartition("/")[2]
        given = word(include, "name") or element.get("name") or last
        name = checked_name(scope, "model", given, include)
        if name is None:
            return None
        node = Node("model", name, scope, source=source, element=element)
        node.uri, node.include = uri, include
        is_placed = first(include, "pose") is not None
        node.pose, node.relative_to = (
            read_pose(scope.source, include) if is_placed else read_pose(source, element)
        )
        scope.nodes[name] = node
        return node

    def _open(
        self, node: Node, placement_frame: str, trail: Trail, *, is_merged: bool = False
    ) -> None:
        """Read the contents of a model."""
        around, element = node.scope, node.element
        prefix = "" if around.is_world else f"{around.prefix}{node.name}::"
        inside = Scope(node.name, source=node.source, element=element, node=node)
        inside.prefix = around.prefix if is_merged else prefix
        inside.is_static = around.is_static or node.is_static
        inside.self_collide = truth(node.source, element, "self_collide", default=False)
        inside.placement_frame = placement_frame
        inside.depth = around.depth + 1
        node.inside = inside
        if inside.depth > DEEPEST:
            node.source.report(
                TOO_MANY_MODELS,
                f"The model `{node.name}` is nested in {around.depth} others; wsgen reads "
                f"{DEEPEST} levels.",
                at=element,
                hint="Move the models to the same level, and place them with `relative_to`.",
            )
            return
        self._fill(inside, trail)
        canonical = element.get("canonical_link") or ""
        for attribute, name in (
            ("placement_frame", placement_frame),
            ("canonical_link", canonical),
        ):
            if (
                name not in {"", MODEL_FRAME}
                and inside.lookup(name) is None
                and not inside.may_have(name)
            ):
                node.source.report(
                    UNKNOWN_FRAME,
                    f"`{attribute}` of the model `{node.name}` names `{name}`, which is not in the "
                    "model.",
                    at=element,
                    hint="Write the name of a frame of this model.",
                )

    def _is_within_bounds(self, source: Source, element: Element) -> bool:
        self.parts += 1
        if self.parts == MOST_PARTS + 1:
            source.report(
                TOO_MANY_MODELS,
                f"The file has more than {MOST_PARTS} links, joints, frames and models, the most "
                "that wsgen reads.",
                at=element,
                hint="Check whether models include each other several times.",
            )
        return self.parts <= MOST_PARTS


def _start(source: Source) -> Trail:
    return () if source.file is None else (Path(real_path(source.file)),)


class SdfModel(NamedTuple):
    """A model of an SDF file."""

    name: str
    robot: Robot | None  # None: it has no link
    pose_in_world: Pose = IDENTITY  # of the root link's frame; without a world, where it stands
    is_static: bool = False
    file: Path | None = None  # that the model is written in; None: a text from nowhere
    line: int | None = None  # of its element in that file, 1-based
    # A static plane of it is level at z = 0. That is the ground, which an engine has by itself
    # (`World.has_ground_plane`): the robot is without it.
    ground_friction: float | None = None
    devices: Devices | None = None  # if they are wanted; None also of a URDF that is included
    model_pose: Pose | None = None  # in the world, of its own frame; None: that is the root link's


class WorldModels(NamedTuple):
    """The models of a world."""

    placed: tuple[PlacedModel, ...]  # all of them
    models: tuple[SdfModel, ...]  # without those that are only ground
    ground_friction: float | None  # of a level plane at z = 0, if there is one
    carry: bool  # others can stand on one of them


def read_world_models(world: Scope, includes: Includes) -> WorldModels:
    """The models of a world; other parts that are not simulated are reported."""
    poses = resolve_poses(world)
    models = []
    frictions: list[float] = []
    carry = False
    for node in world.own("model"):
        if _is_own_ground(node, poses[node]):
            frictions.append(GROUND_PLANE_FRICTION)
            continue
        before = includes.solids_left_out
        model = _read_node(includes, node, poses)
        if includes.solids_left_out > before and not model.is_static:
            continue  # how it stands without them says nothing
        if model.ground_friction is not None:
            frictions.append(model.ground_friction)
        carry |= _carries(node, model)
        if not _is_only_ground(model):
            models.append(model)
    _report_left_out(world)
    placed = tuple(
        PlacedModel(
            name=node.name, uri=node.uri, pose_in_world=poses[node], is_static=node.is_static
        )
        for node in world.own("model")
    )
    return WorldModels(
        placed, tuple(models), max(frictions, default=None), bool(frictions) or carry
    )


def _read_node(includes: Includes, node: Node, poses: Poses) -> SdfModel:
    """A model of the world, or a single one; `poses` has everything, each in its scope."""
    pose = poses[node]
    if node.inside is None:
        return _read_urdf(includes, node, pose)
    scopes = [scope for scope in node.inside.below() if any(scope.own("link"))]
    if scopes and all(scope.is_static for scope in scopes):  # those around what is static
        node.is_static = node.inside.is_static = True
    scopes = [scope for scope in node.inside.below() if any(scope.own("link"))]
    if scopes and all(scope.is_static for scope in scopes):  # it only wraps what never moves
        node.is_static = node.inside.is_static = True
    # Most worlds that robots are spawned into have only sun and ground, and need none of this.
    from wsgen.descriptions.sdf.assembly import assemble  # noqa: PLC0415

    assembled = assemble(includes, node.inside, pose, poses)
    for scope in node.inside.below():
        if scope.is_static and not node.is_static and scope.element is not None:
            scope.source.report(
                NESTED_STATIC_MODEL,
                f"The static model `{scope.name}` is nested in a movable model: Gazebo fixes it to "
                "the world, but in the simulation it moves.",
                at=scope.element,
                hint="Make the outer model static, or move the inner one out of it.",
            )
    return SdfModel(
        name=node.name,
        robot=assembled.robot,
        pose_in_world=compose(pose, assembled.root_in_model),
        model_pose=pose,
        is_static=node.is_static,
        file=node.source.file,
        line=line_of(node.element),
        ground_friction=assembled.ground_friction,
        devices=assembled.devices,
    )


def _read_urdf(includes: Includes, node: Node, pose: Pose) -> SdfModel:
    file = node.source.file
    robot = None if file is None else includes.robot(file)
    is_static = node.is_static or (robot is not None and robot.is_static)
    return SdfModel(
        name=node.name,
        robot=robot and replace(robot, name=node.name, is_static=is_static),
        pose_in_world=pose,
        is_static=is_static,
        file=file,
        line=line_of(node.element),
    )


def _is_own_ground(node: Node, pose: Pose) -> bool:
    """Whether it is Gazebo's own ground plane, where engines have theirs."""
    return is_ground_plane(node.uri or "") and node.is_static and is_level_at_zero(pose)


def _is_only_ground(model: SdfModel) -> bool:
    return (
        model.ground_friction is not None
        and model.robot is not None
        and not any(link.collisions or link.visuals for link in model.robot.links)
    )


def _carries(node: Node, model: SdfModel) -> bool:
    """Whether others can stand on it; a terrain carries even where wsgen cannot read it."""
    if next(node.element.iter("heightmap"), None) is not None:
        return True
    if not model.is_static or model.robot is None:
        return False
    shapes = (one.geometry for link in model.robot.links for one in link.collisions)
    return any(not isinstance(shape, Mesh) or shape.path is not None for shape in shapes)


NOT_SIMULATED = "not simulated"


def _report_left_out(world: Scope) -> None:
    for element in children(world.element, "joint", "population", "actor"):
        world.source.report(
            MODEL_LEFT_OUT,
            f"The {element.tag} {element.get('name') or ''} of the world is not simulated.",
            at=element,
            hint="No action is needed: Gazebo simulates it, wsgen simulates the robots without it.",
            reason=NOT_SIMULATED,
        )


__all__ = ["SdfFile", "SdfModel", "read_model", "read_sdf"]


class SdfFile(NamedTuple):
    """The content of an SDF file."""

    world: World | None = None  # None: a single model, or nothing that can be used
    models: tuple[SdfModel, ...] = ()  # but for sun and ground, which are in `world`
    diagnostics: tuple[Diagnostic, ...] = ()
    devices: Devices | None = None  # of the world, if they are wanted
    included: frozenset[Path] = frozenset()  # the files of included models

    @property
    def files(self) -> frozenset[Path]:
        """The files that it was read from, those of included models among them."""
        files = [None if self.world is None else self.world.file]
        files += [model.file for model in self.models]
        return frozenset(file for file in files if file is not None)


def read_sdf(
    file: Path,
    *,
    find_model: Callable[[str], Path | None],
    read_robot: ReadRobot | None = None,
    content: str | None = None,
    with_devices: bool = False,
) -> SdfFile:
    """Read a world or a model file, with the models that it includes.

    All numbers of the robots are finite, also where the diagnostics have errors: what could not be
    read is left out.

    Args:
        file: The file, whatever it is.
        find_model: Gives the folder of the model (or package) that `model://NAME` or an address of
            Fuel stands for, and None where there is none; see `lookup.model_finder`.
        read_robot: Reads a URDF file that is included in a world, as Gazebo has it. Without it such
            a model is left out, with a diagnostic.
        content: SDF that is made from the file; None: the file itself is read.
        with_devices: Whether sensors and plugins are wanted, too.
    """
    diagnostics: list[Diagnostic] = []
    source = load(file, diagnostics) if content is None else parse_text(content, file, diagnostics)
    includes = Includes(find_model, diagnostics, read_robot, with_devices=with_devices)
    found = None if source is None else _read(source, includes)
    includes.report_left_to_gazebo()
    return _finished(diagnostics, found, includes)


def read_model(
    content: str | bytes,
    *,
    file: Path | None,
    find_model: Callable[[str], Path | None],
    pose_in_world: Pose | None = None,
    with_devices: bool = False,
) -> SdfFile:
    """Read the text of a model that is spawned; only one that has no world is taken.

    Args:
        content: SDF; bytes where it is the file itself, for its own encoding to count.
        file: Where the text comes from, for diagnostics and relative paths.
        find_model: As for `read_sdf`.
        pose_in_world: Where it is spawned; None: at the pose that the model gives itself.
        with_devices: Whether sensors and plugins are wanted, too.
    """
    diagnostics: list[Diagnostic] = []
    source = parse_text(content, file, diagnostics)
    includes = Includes(find_model, diagnostics, with_devices=with_devices)
    found = None if source is None else _read_spawned(source, includes, pose_in_world)
    includes.report_left_to_gazebo(is_robot=True)
    return _finished(diagnostics, found, includes)


def _finished(diagnostics: list[Diagnostic], found: SdfFile | None, includes: Includes) -> SdfFile:
    # A model that is included twice is reported once.
    return (found or SdfFile())._replace(
        diagnostics=tuple(dict.fromkeys(diagnostics)), included=includes.files
    )


def _read(source: Source, includes: Includes) -> SdfFile | None:
    element = _selected(source)
    if element is None:
        return None
    source = with_version(source)
    if element.tag == "world":
        return _read_world(source, element, includes)
    return SdfFile(models=_alone(source, element, includes, None))


def _read_spawned(source: Source, includes: Includes, pose: Pose | None) -> SdfFile | None:
    light = next(children(source.root, "light", "actor"), None)
    if light is not None and next(children(source.root, "world", "model"), None) is None:
        source.report(
            SPAWNED_LIGHT,
            f"The spawned file contains only a {light.tag}, which wsgen does not simulate.",
            at=light,
            hint="No action is needed.",
        )
        return None
    element = _selected(source)
    if element is None:
        return None
    if element.tag == "world":
        source.report(
            SPAWNED_WORLD,
            f"The world `{element.get('name') or ''}` is spawned, but spawners only accept models.",
            at=element,
            hint="Start the simulator with the world, and spawn a file of <sdf><model>.",
        )
        return None
    return SdfFile(models=_alone(with_version(source), element, includes, pose))


def _selected(source: Source) -> Element | None:
    """The world, model or include that is read; a missing one, or several, are reported."""
    kinds = ("world", "model", "include")
    found = list(children(source.root, *kinds)) if source.root.tag == "sdf" else []
    if not found:
        other = next(children(source.root, "light", "actor"), None)
        others = "" if other is None else f", but one <{other.tag}>"
        source.report_missing(
            NO_WORLD,
            f"The file has neither a <world> nor a <model>{others}."
            if source.root.tag == "sdf"
            else "The file has no <sdf> with a <world> or a <model>; "
            f"its root element is <{source.root.tag}>.",
            at=source.root,
            child="model" if (source.root, "model") in source.misspelled else "world",
            hint='Write <sdf version="1.6"> above the <model>, and </sdf> below it.'
            if source.root.tag == "model"
            else 'Write <sdf version="1.5"><world name="..."> ... </world></sdf>.',
        )
        return None
    first = next((element for element in found if element.tag == "world"), found[0])
    if len(found) > 1:
        # Gazebo's parser takes the first model and fails; of worlds it reads all.
        source.report(
            SEVERAL_MODELS,
            f"The file has {len(found)} worlds and models; "
            f"only the {first.tag} `{first.get('name')}` is read.",
            at=next(element for element in found if element is not first),
            hint="Move all models into one world, or each into a separate file.",
            severity=Severity.ERROR if first.tag == "model" else Severity.WARNING,
        )
    return first


def _alone(
    source: Source, element: Element, includes: Includes, pose: Pose | None
) -> tuple[SdfModel, ...]:
    place = Contents(includes).alone(source, element)
    for node in place.own("model"):
        if pose is not None:
            node.pose, node.relative_to = pose, ""
    poses = resolve_poses(place)
    return tuple(_read_node(includes, node, poses) for node in place.own("model"))


def _read_world(source: Source, element: Element, includes: Includes) -> SdfFile:
    if not element.get("name"):
        source.report(
            UNNAMED_ELEMENT,
            "The world has no name.",
            at=element,
            hint='Write <world name="NAME">; Gazebo Sim refuses the file without a name.',
        )
    world_models = read_world_models(Contents(includes).world(source, element), includes)
    world = describe_world(
        source, element, world_models.placed, ground_friction=world_models.ground_friction
    )
    if not world_models.carry:
        # What is left out may be what robots stand on.
        if includes.blame_misspelled_ground() or includes.left_out or includes.has_left_to_gazebo:
            world = replace(world, has_ground_plane=True)  # what was meant, for the simulation
        check_ground(source, element, world)
    devices = None
    if includes.with_devices:
        from wsgen.descriptions.sdf.devices import read_world_devices  # noqa: PLC0415  live runs alone

        devices = read_world_devices(element)
    return SdfFile(world=world, models=world_models.models, devices=devices)
