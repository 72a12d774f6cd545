"""An SDF file to robots: the models in it, and the world around them.

`<world>` and `<model>` elements, and what they include, to scopes.

The models that stand in a world.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from wsgen.model.transform import IDENTITY, Pose, compose
from wsgen.model.world import PlacedModel
from wsgen.sdf.assembly import PARTS, checked_name, kind_of
from wsgen.sdf.frames import MODEL_FRAME, Node, Scope, is_level_at_zero, resolve
from wsgen.sdf.includes import Includes, is_ground_plane, is_sun
from wsgen.sdf.reader import check_is_carried, describe_world
from wsgen.sdf.source import line_of, load, parse_text, with_version
from wsgen.sdf.values import first, read_pose, truth, word
from wsgen.xmltree import children

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import Robot
    from wsgen.model.world import World
    from wsgen.sdf.includes import ReadRobot
    from wsgen.sdf.source import Source
    from wsgen.xmltree import Element


DEEPEST = 50  # models in models; public ones have three
MOST_PARTS = 60_000  # links, joints, frames and models of a file with all that it includes

Trail = tuple["Path", ...]  # the files that lead to an element


class Contents:
    """Reads models into scopes, and keeps count of them."""

    def __init__(self, includes: Includes) -> None:
        self.includes = includes
        self.parts = 0

    def world(self, source: Source, element: Element) -> Scope:
        """A world, with the models that stand in it."""
        scope = Scope(element.get("name") or "default", source=source, element=element)
        self._fill(scope, _start(source))
        return scope

    def alone(self, source: Source, element: Element) -> Scope:
        """The place where a single model stands, with the model in it."""
        scope = Scope("", source=source, element=source.root)
        self._add(scope, element, _start(source))
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
        """A link, joint, frame or model that is written in the scope."""
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
        """A model of another file, with the name, the pose and the rest that the include gives."""
        uri = word(include, "uri")
        if is_sun(uri):
            return
        found = self.includes.find(scope.source, include, uri, trail, is_part=not scope.is_world)
        if found is None:
            return
        source, element = found
        node = self._stand(scope, include, uri, source, element)
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
        is_merged = not scope.is_world and include.get("merge") in {"true", "1"}
        inside_trail = trail if source.file is None else (*trail, source.file)
        placement = word(include, "placement_frame") or element.get("placement_frame") or ""
        self._open(node, placement, inside_trail, is_merged=is_merged)
        if is_merged and node.inside is not None:
            del scope.nodes[node.name]
            scope.merged.append(node.inside)

    def _stand(
        self, scope: Scope, include: Element, uri: str, source: Source, element: Element
    ) -> Node | None:
        """An included model in the scope; None, with a diagnostic, if its name does not do."""
        last = uri.rstrip("/").rpartition("/")[2]
        given = word(include, "name") or element.get("name") or last
        name = checked_name(scope, "model", given, include)
        if name is None:
            return None
        node = Node("model", name, scope, source=source, element=element)
        node.uri = uri
        is_placed = first(include, "pose") is not None
        node.pose, node.relative_to = (
            read_pose(scope.source, include) if is_placed else read_pose(source, element)
        )
        scope.nodes[name] = node
        return node

    def _open(
        self, node: Node, placement_frame: str, trail: Trail, *, is_merged: bool = False
    ) -> None:
        """Read what is in a model."""
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
            node.source.error(
                "WLD014",
                f"The model `{node.name}` is in {around.depth} others; wsgen reads {DEEPEST}.",
                at=element,
                hint="Put the models side by side, and place them by relative_to.",
            )
            return
        self._fill(inside, trail)
        canonical = element.get("canonical_link") or ""
        for attribute, name in (
            ("placement_frame", placement_frame),
            ("canonical_link", canonical),
        ):
            if name not in {"", MODEL_FRAME} and inside.lookup(name) is None:
                node.source.error(
                    "WLD016",
                    f"`{attribute}` of the model `{node.name}` names `{name}`, which is not in it.",
                    at=element,
                    hint="Name a frame of this model.",
                )

    def _is_within_bounds(self, source: Source, element: Element) -> bool:
        self.parts += 1
        if self.parts == MOST_PARTS + 1:
            source.error(
                "WLD014",
                f"There are more than {MOST_PARTS} links, joints, frames and models; "
                "wsgen reads no more.",
                at=element,
                hint="Do models include each other, each several times?",
            )
        return self.parts <= MOST_PARTS


def _start(source: Source) -> Trail:
    return () if source.file is None else (source.file.resolve(),)


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
    is_ground: bool = False


class WorldModels(NamedTuple):
    """What stands in a world."""

    placed: tuple[PlacedModel, ...]  # all of them
    models: tuple[SdfModel, ...]  # but for what is nothing but ground
    has_ground: bool  # a plane, level at z = 0
    carry: bool  # something is there that others can stand on


def read_world_models(world: Scope, includes: Includes) -> WorldModels:
    """The models of a world; what else is in it and not part of a simulation is reported."""
    for node in world.nodes.values():
        resolve(node)
    models = []
    has_ground = carry = False
    for node in world.own("model"):
        if _is_own_ground(node):
            has_ground = True
            continue
        model = read_standing(includes, node)
        has_ground |= model.is_ground
        carry |= _carries(node, model)
        if not _is_nothing_but_ground(model):
            models.append(model)
    _report_left_out(world)
    placed = tuple(
        PlacedModel(
            name=node.name, uri=node.uri, pose_in_world=resolve(node), is_static=node.is_static
        )
        for node in world.own("model")
    )
    return WorldModels(placed, tuple(models), has_ground, has_ground or carry)


def read_standing(includes: Includes, node: Node) -> SdfModel:
    """A model of the world, or one that stands alone."""
    if node.inside is None:
        return _read_urdf(includes, node)
    # Most worlds that robots are spawned into hold sun and ground alone, and need none of this.
    from wsgen.sdf.assembly import assemble  # noqa: PLC0415

    pose = resolve(node)
    assembled = assemble(includes, node.inside, pose)
    for scope in node.inside.below():
        if scope.is_static and not node.is_static and scope.element is not None:
            scope.source.warning(
                "WLD048",
                f"The model `{scope.name}` is static, and part of one that is not: Gazebo holds it "
                "still, the simulation lets it move.",
                at=scope.element,
                hint="Make the outer model static, or let the inner one stand beside it.",
            )
    return SdfModel(
        name=node.name,
        robot=assembled.robot,
        pose_in_world=compose(pose, assembled.root_in_model),
        is_static=node.is_static,
        file=node.source.file,
        line=line_of(node.element),
        is_ground=assembled.is_ground,
    )


def _read_urdf(includes: Includes, node: Node) -> SdfModel:
    file = node.source.file
    robot = None if file is None else includes.robot(file)
    is_static = node.is_static or (robot is not None and robot.is_static)
    return SdfModel(
        name=node.name,
        robot=robot and replace(robot, name=node.name, is_static=is_static),
        pose_in_world=resolve(node),
        is_static=is_static,
        file=file,
        line=line_of(node.element),
    )


def _is_own_ground(node: Node) -> bool:
    """Whether it is Gazebo's own ground, where engines have theirs."""
    return is_ground_plane(node.uri or "") and node.is_static and is_level_at_zero(resolve(node))


def _is_nothing_but_ground(model: SdfModel) -> bool:
    return (
        model.is_ground
        and model.robot is not None
        and not any(link.collisions or link.visuals for link in model.robot.links)
    )


def _carries(node: Node, model: SdfModel) -> bool:
    """Whether others can stand on it; a terrain carries even where wsgen cannot read it."""
    if not model.is_static:
        return False
    return next(node.element.iter("heightmap"), None) is not None or (
        model.robot is not None and any(link.collisions for link in model.robot.links)
    )


def _report_left_out(world: Scope) -> None:
    for element in children(world.element, "joint", "population", "actor"):
        world.source.warning(
            "WLD004",
            f"The {element.tag} {element.get('name') or ''} of the world is not simulated.",
            at=element,
            hint="The robots are tried without it.",
        )


__all__ = ["SdfFile", "SdfModel", "read_model", "read_sdf"]


class SdfFile(NamedTuple):
    """What an SDF file holds."""

    world: World | None = None  # None: a single model, or nothing that can be used
    models: tuple[SdfModel, ...] = ()  # but for sun and ground, which are in `world`
    diagnostics: tuple[Diagnostic, ...] = ()


def read_sdf(
    file: Path,
    *,
    find_model: Callable[[str], Path | None],
    read_robot: ReadRobot | None = None,
) -> SdfFile:
    """Read a world or a model file, with the models that it includes.

    All numbers of the robots are finite, also where the diagnostics have errors: what could not be
    read is left out.

    Args:
        file: The file, whatever it is.
        find_model: Gives the folder of the model (or package) that `model://NAME` or an address of
            Fuel stands for, and None where there is none; see `wsgen.sdf.lookup.model_finder`.
        read_robot: Reads a URDF file that is included in a world, as Gazebo has it. Without it such
            a model is left out, with a diagnostic.
    """
    diagnostics: list[Diagnostic] = []
    source = load(file, diagnostics)
    includes = Includes(find_model, diagnostics, read_robot)
    return _finished(diagnostics, None if source is None else _read(source, includes))


def read_model(
    content: str | bytes,
    *,
    file: Path | None,
    find_model: Callable[[str], Path | None],
    pose_in_world: Pose | None = None,
) -> SdfFile:
    """Read the text of a model that is spawned; only one that has no world is taken.

    Args:
        content: SDF; bytes where it is the file itself, for its own encoding to count.
        file: Where the text comes from, for diagnostics and relative paths.
        find_model: As for `read_sdf`.
        pose_in_world: Where it is spawned; None: at the pose that the model gives itself.
    """
    diagnostics: list[Diagnostic] = []
    source = parse_text(content, file, diagnostics)
    includes = Includes(find_model, diagnostics)
    return _finished(
        diagnostics, None if source is None else _read_spawned(source, includes, pose_in_world)
    )


def _finished(diagnostics: list[Diagnostic], found: SdfFile | None) -> SdfFile:
    # A model that is included twice is wrong once.
    return (found or SdfFile())._replace(diagnostics=tuple(dict.fromkeys(diagnostics)))


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
        source.info(
            "WLD042",
            f"It is a {light.tag} that is spawned: there is nothing to try.",
            at=light,
            hint="Nothing needs to be done.",
        )
        return None
    element = _selected(source)
    if element is None:
        return None
    if element.tag == "world":
        source.error(
            "WLD043",
            f"The world `{element.get('name') or ''}` is spawned, and spawners take models.",
            at=element,
            hint="Start the simulator with the world, and spawn a file of <sdf><model>.",
        )
        return None
    return SdfFile(models=_alone(with_version(source), element, includes, pose))


def _selected(source: Source) -> Element | None:
    """The world or model that is read; that there is none, or more, is reported."""
    found = list(children(source.root, "world", "model")) if source.root.tag == "sdf" else []
    if not found:
        source.missing(
            "WLD003",
            "There is neither a <world> nor a <model> here."
            if source.root.tag == "sdf"
            else "There is neither a <world> nor a <model> in an <sdf> here; "
            f"the root element is <{source.root.tag}>.",
            at=source.root,
            name="model" if (source.root, "model") in source.misspelt else "world",
            hint='A world file is <sdf version="1.5"><world name="..."> ... </world></sdf>.',
        )
        return None
    first = next((element for element in found if element.tag == "world"), found[0])
    if len(found) > 1:
        # Gazebo's parser takes the first model and fails; of worlds it reads all.
        report = source.error if first.tag == "model" else source.warning
        report(
            "WLD038",
            f"The file holds {len(found)} worlds and models; "
            f"only the {first.tag} `{first.get('name')}` is read.",
            at=next(element for element in found if element is not first),
            hint="Put several models into one world, or into a file each.",
        )
    return first


def _alone(
    source: Source, element: Element, includes: Includes, pose: Pose | None
) -> tuple[SdfModel, ...]:
    place = Contents(includes).alone(source, element)
    for node in place.own("model"):
        if pose is not None:
            node.pose, node.relative_to = pose, ""
    return tuple(read_standing(includes, node) for node in place.own("model"))


def _read_world(source: Source, element: Element, includes: Includes) -> SdfFile:
    if not element.get("name"):
        source.error(
            "WLD013",
            "The world has no name.",
            at=element,
            hint='Write <world name="NAME">; Gazebo Sim refuses the file without.',
        )
    world_models = read_world_models(Contents(includes).world(source, element), includes)
    world = describe_world(source, element, world_models.placed, has_ground=world_models.has_ground)
    if not world_models.carry:
        if includes.blame_misspelt_ground():
            world = replace(world, has_ground_plane=True)  # what was meant, for the simulation
        check_is_carried(source, element, world)
    return SdfFile(world=world, models=world_models.models)
