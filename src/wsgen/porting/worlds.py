"""Worlds for Gazebo Classic, as Gazebo Sim starts them.

What is in their models is in `models`. Source: gazebosim/gazebo-classic, gazebo/physics/World.cc,
and the models `sun` and `ground_plane`; gazebosim/gz-sim, src/SimulationRunner.cc.
"""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.fixes.source import SourceText, apply
from wsgen.descriptions.sdf.lookup import gazebo_models
from wsgen.gazebo.plain_models import PLAIN_MESHES, PLAIN_MODELS
from wsgen.gazebo.plugins import OF_CLASSIC, TRUE, stem
from wsgen.gazebo.successors import (
    ACTOR,
    FUEL,
    IN_PLACE_OF_WORLDS,
    MESHES_OF_ACTORS,
    OF_ANY_WORLD,
    OF_SERVICES,
    OF_WORLDS,
    ON_FUEL,
)
from wsgen.gazebo.systems import (
    CONTROL,
    DEFAULT_SYSTEMS,
    SPAWNING,
    is_of_gz,
    loaded_class,
    plugin_of,
)
from wsgen.model.transform import (
    Pose,
    angle_between,
    compose,
    invert,
    rotate,
    rotation_of_rpy,
)
from wsgen.porting.models import colors
from wsgen.porting.porter import Porter, number, written
from wsgen.porting.xml_edits import Block
from wsgen.text.suggestions import some_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from wsgen.gazebo.plain_models import Shape
    from wsgen.model.target import Target
    from wsgen.porting.ported import FilePort
    from wsgen.porting.xml_edits import Node

_STEP = 0.001  # seconds, of either simulator
_TOLD_APART = 1e-9
_MOVED = 1e-3  # m and rad, by which links may have sunk or swayed while a world was saved
_TURNS = 1e3  # rad, more than a joint with a stop turns
_PLANE = Block("geometry", [Block("plane", [Block("normal", "0 0 1"), Block("size", "100 100")])])
_GRIP = Block("friction", [Block("ode", [Block("mu", "100"), Block("mu2", "50")])])
_PAINT = Block("material", colors("Gazebo/Grey"))
_AXES, _FRAMES = "xyz", ("frame", "relative_to")
_MODEL = re.compile(r"model://([^/]+)/?(.*)", re.DOTALL)
# What only Gazebo Classic has in a world: what it does, and what to do.
_ONLY_CLASSIC = {
    "road": ("draws a road", "Use a mesh, or a plane with a texture."),
    "population": ("places many models", "Write an <include> with its <pose> for each of them."),
    "audio": ("plays sounds", "Remove the sounds of the models, too."),
}
# The world that Gazebo Classic starts if it is given none (worlds/empty.world).
_EMPTY = """<?xml version="1.0"?>
<sdf version="{version}">
  <world name="{name}">
    <include>
      <uri>model://sun</uri>
    </include>

    <include>
      <uri>model://ground_plane</uri>
    </include>
  </world>
</sdf>
"""


def new_world(name: str, target: Target, systems: Collection[str]) -> str:
    """The text of a world with what the default one of Gazebo Classic has: sun and ground."""
    text = _EMPTY.format(version=target.sdf_version, name=name)
    port = port_world(SourceText(Path(f"{name}.sdf"), text), target, frozenset(systems))
    return apply(text, port.edits)


def port_world(
    source: SourceText,
    target: Target,
    systems: frozenset[str],
    *,
    models: Collection[str] = (),
    are_called: bool = True,
) -> FilePort:
    """Port the worlds of a file, but for what is in their models.

    Args:
        source: The text of an SDF file.
        target: The distribution, with Gazebo Sim.
        systems: The classes of the systems that the worlds must load beside the usual ones.
        models: The names of the models and packages of the workspace, which `model://` finds.
        are_called: Whether a program may call the services of Gazebo Classic, or read its topics.
    """
    port = Porter(source, target)
    for node in port.nodes:
        if node.name == "world":
            _port_world(port, node, systems, are_called=are_called)
        elif node.name == "actor":
            _port_actor(port, node)
        elif node.name == "uri" and not node.is_in("script", "state"):
            _port_address(port, node, models)
    return port.finish()


def _port_world(port: Porter, world: Node, systems: Collection[str], *, are_called: bool) -> None:
    needed = {*systems}
    for plugin in world.children("plugin"):
        needed |= _port_plugin(port, plugin, are_called=are_called)
    load_systems(port, world, needed)
    for include in world.children("include"):
        name = include.value("uri").strip("/").removeprefix("model://")
        if name == "sun":
            port.editor.replace(include, [_sun(include)])
        elif name == "ground_plane":
            port.editor.replace(include, [_ground(include)])
    for gui in world.children("gui"):
        _port_gui(port, gui)
    for physics in world.children("physics"):
        _port_physics(port, physics)
    for state in world.children("state"):
        _port_state(port, world, state)
    for node in world.children(*_ONLY_CLASSIC):
        if node.name == "audio" and all(one.name != "audio_source" for one in port.nodes):
            port.editor.remove(node)  # each world that Gazebo Classic saves has it
            continue
        what, advice = _ONLY_CLASSIC[node.name]
        port.editor.comment_out(node)
        port.leave(
            node, f"Gazebo Sim does not have <{node.name}>, which {what}.", advice, is_note=True
        )


def load_systems(port: Porter, world: Node, needed: Collection[str]) -> None:
    """Have a world load systems: all that worlds have by default, where it loads none.

    One that loads some, and lacks what robots need, must have that which spawns them.
    """
    names = ((one.get("filename"), one.get("name")) for one in world.children("plugin"))
    loaded = {loaded_class(file, name) or loaded_class(file, "") for file, name in names} - {None}
    usual = DEFAULT_SYSTEMS if not loaded else (SPAWNING,) if needed else ()
    wanted = (*usual, *sorted({*needed} - {*usual}))
    blocks = [_system(one) for one in wanted if one not in loaded]
    if not blocks:
        return
    own = [one for one in world.children("plugin") if is_of_gz(one.get("filename"))]
    if own:
        port.editor.add_behind(own[-1], *blocks)
    else:
        port.editor.prepend(world, *blocks)


def _system(name: str) -> Block:
    attributes = plugin_of(name).removeprefix("<plugin ").removesuffix("/>")
    content = [Block("render_engine", "ogre2")] if name == "Sensors" else []
    return Block("plugin", content, attributes)


def _port_plugin(port: Porter, plugin: Node, *, are_called: bool) -> set[str]:
    """Port a plugin of a world, and return the systems that take its place."""
    filename = plugin.get("filename")
    name = stem(filename)
    if not filename or is_of_gz(filename, plugin.get("name")) or filename in CONTROL:
        return set()
    if name in OF_ANY_WORLD:
        port.editor.remove(plugin)
        return set()
    _leave_plugin(port, plugin, name, "world", OF_WORLDS)
    if name in OF_SERVICES and not are_called:
        port.unported[-1] = port.unported[-1]._replace(is_note=True)
    return {IN_PLACE_OF_WORLDS[name]} if name in IN_PLACE_OF_WORLDS else set()


def _leave_plugin(
    port: Porter, plugin: Node, name: str, holder: str, known: Mapping[str, tuple[str, str]]
) -> None:
    """Remove a plugin of Gazebo Classic; one that is somebody's own stays as a comment."""
    filename = plugin.get("filename")
    if name in known or name in OF_CLASSIC or not plugin.written:
        port.editor.remove(plugin)
    else:
        port.editor.comment_out(plugin)
    what, advice = known.get(name, ("", ""))
    port.leave(
        plugin,
        f"The plugin `{filename}` of the {holder} is for Gazebo Classic"
        + (f", where it {what}." if what else ", and Gazebo Sim cannot load it."),
        advice or "Write a system of gz-sim that does its work, or use one that Gazebo has.",
    )


def _placed(include: Node, *names: str) -> list[Block]:
    """What an <include> says of a model."""
    return [Block(name, include.value(name)) for name in names if include.value(name)]


def _sun(include: Node) -> Block:
    name = include.value("name") or "sun"
    place = include.value("pose") or "0 0 10 0 0 0"
    fading = {"range": "1000", "constant": "0.9", "linear": "0.01", "quadratic": "0.001"}
    content = [
        Block("cast_shadows", "true"),
        Block("pose", place),
        Block("diffuse", "0.8 0.8 0.8 1"),
        Block("specular", "0.2 0.2 0.2 1"),
        Block("attenuation", [Block(*one) for one in fading.items()]),
        Block("direction", "-0.5 0.1 -0.9"),
    ]
    return Block("light", content, f'name="{name}" type="directional"')


def _ground(include: Node) -> Block:
    collision = Block("collision", [_PLANE, Block("surface", [_GRIP])], 'name="collision"')
    visual = Block("visual", [Block("cast_shadows", "false"), _PLANE, _PAINT], 'name="visual"')
    name = include.value("name") or "ground_plane"
    content = [
        Block("static", "true"),
        *_placed(include, "pose"),
        Block("link", [collision, visual], 'name="link"'),
    ]
    return Block("model", content, f'name="{name}"')


def _port_gui(port: Porter, gui: Node) -> None:
    """Remove the view and the plugins of Gazebo Classic's window."""
    gone: list[Node] = []
    for node in gui.children("camera", "plugin"):
        if node.name == "camera":
            port.editor.remove(node)
            port.leave(
                node,
                "Gazebo Sim does not read the view of the window from <camera>.",
                "Set the view in the window, and save its configuration.",
                is_note=True,
            )
        elif node.get("filename").startswith("lib") and not is_of_gz(node.get("filename")):
            _leave_plugin(port, node, stem(node.get("filename")), "window", {})
        else:
            continue
        gone.append(node)
    if gone and gone == gui.written:
        port.editor.remove(gui)


def _port_physics(port: Porter, physics: Node) -> None:
    """Say how fast time passes as Gazebo Sim reads it: Classic multiplies two other numbers."""
    rate = physics.find("real_time_update_rate")
    step = number(physics.value("max_step_size") or str(_STEP))
    often = None if rate is None else number(rate.text)
    if rate is None or step is None or often is None:
        return
    factor = physics.find("real_time_factor")
    text = written(max(often, 0.0) * step)
    if factor is None:
        port.editor.rename(rate, "real_time_factor")
        port.editor.set_text(rate, text)
        return
    before = number(factor.text)
    if before is None or abs(before - float(text)) > _TOLD_APART:
        port.editor.set_text(factor, text)
    port.editor.remove(rate)


def _port_state(port: Porter, world: Node, state: Node) -> None:
    """Write the poses of a saved state into the models, as Gazebo Classic moves them there."""
    for kind in ("model", "light"):
        placed = {one.get("name"): one for one in world.children(kind)}
        placed |= {one.value("name"): one for one in world.children("include") if kind == "model"}
        for saved in state.children(kind):
            model, pose = placed.get(saved.get("name")), saved.value("pose")
            if model is None or not pose or _same(model.value("pose"), pose):
                continue
            before = model.find("pose")
            if before is None:
                port.editor.append(model, Block("pose", pose))
            elif not any(map(before.get, _FRAMES)):
                port.editor.set_text(before, pose)
            else:
                what = f"The saved <state> has `{model.get('name')}` at `{pose}`."
                port.leave(before, what, "Write it for the frame that the <pose> names.")
    port.editor.remove(state)
    models = {one.get("name"): one for one in world.children("model")}
    included = [one.value("name") for one in world.children("include")]
    # What a launch file had spawned is not in the world.
    is_any = not all(included)
    bent = []
    for saved in state.children("model"):
        name, model = saved.get("name"), models.get(saved.get("name"))
        if model is None:
            has_joints = len([*saved.children("link")]) > 1
            bent += [name] if has_joints and (is_any or name in included) else []
        else:
            bent += [name] if not _place_links(port, saved, model) else []
    if bent:
        port.leave(
            state,
            f"The <state> is gone, which had moved joints of {some_of(bent)}: Gazebo Sim does not "
            "read it. The poses of models and lights are written into them.",
            "Set the positions of the joints where models need them.",
        )


def _place_links(port: Porter, saved: Node, model: Node) -> bool:
    """Have the links of a model be where they were saved; False if its joints have moved them."""
    moved = [*_moved_links(saved, model)]
    if any(model.children("joint")) or any(link is None or not place for link, place in moved):
        return not moved or model.value("static") in TRUE
    for link, place in moved:
        before = link.find("pose") if link is not None else None
        text = f"{_numbers(place.xyz)} {_numbers(place.rpy)}" if place is not None else ""
        if before is not None:
            port.editor.set_text(before, text)
        elif link is not None:
            port.editor.append(link, Block("pose", text))
    return True


def _moved_links(saved: Node, model: Node) -> Iterator[tuple[Node | None, Pose | None]]:
    """The links that were not saved where a model has them, and where; None: nobody knows."""
    own = {one.get("name"): one for one in model.children("link")}
    spinning = {one.value("child") for one in model.children("joint") if _is_endless(one)}
    base = _pose(saved.value("pose"))
    for one in saved.children("link"):
        link = own.get(one.get("name"))
        place = link.find("pose") if link is not None else None
        if one.get("name") in spinning:
            continue
        found, meant = _pose(one.value("pose")), _pose("" if place is None else place.text)
        is_framed = place is not None and any(map(place.get, _FRAMES))
        if link is None or is_framed or base is None or found is None or meant is None:
            yield link, None
            continue
        there = compose(invert(base), found)
        if math.dist(there.xyz, meant.xyz) > _MOVED or angle_between(there, meant) > _MOVED:
            yield link, there


def _is_endless(joint: Node) -> bool:
    """Whether a joint turns round and round, as those of wheels do."""
    least = number(joint.value("axis/limit/lower") or "-inf")
    return joint.get("type") in ("revolute", "continuous") and (least is None or least < -_TURNS)


def _pose(text: str) -> Pose | None:
    """A pose of six numbers, or none; None: it is another text."""
    values = _vector(text or "0 0 0 0 0 0")
    if len(values) != len(_AXES) * 2:
        return None
    return Pose(xyz=(values[0], values[1], values[2]), rpy=(values[3], values[4], values[5]))


def _same(one: str, other: str) -> bool:
    def numbers(text: str) -> list[float | None]:
        return [number(word) for word in (text or "0 0 0 0 0 0").split()]

    first, second = numbers(one), numbers(other)
    return len(first) == len(second) and all(
        left is not None and right is not None and abs(left - right) <= _TOLD_APART
        for left, right in zip(first, second, strict=True)
    )


def _port_actor(port: Porter, actor: Node) -> None:
    for plugin in actor.children("plugin"):
        if not is_of_gz(plugin.get("filename"), plugin.get("name")):
            name = stem(plugin.get("filename"))
            _leave_plugin(port, plugin, name, f"actor `{actor.get('name')}`", {})
    for holder in actor.children("skin", "animation"):
        file = holder.find("filename")
        if file is None or "/" in file.text or (port.source.file.parent / file.text).exists():
            continue
        if file.text in MESHES_OF_ACTORS:
            port.editor.set_text(file, f"{ACTOR}{file.text}")
        else:
            port.leave(
                file,
                f"The mesh `{file.text}` of the actor is one that Gazebo Classic ships.",
                "Copy it into the package, and name it by model://.",
            )


def _port_address(port: Porter, uri: Node, models: Collection[str]) -> None:
    """Have Gazebo Sim find what Gazebo Classic has or downloads."""
    found = _MODEL.fullmatch(uri.text)
    shipped = uri.text.removeprefix("file://media/models/")
    if shipped in MESHES_OF_ACTORS:
        port.editor.set_text(uri, f"{ACTOR}{shipped}")
    elif uri.text.startswith("file://media/"):
        port.leave_once(
            uri,
            f"`{uri.text}` is a file that Gazebo Classic ships.",
            "Copy it into the package, and name it by model://.",
        )
    if found is None or found[1] in models or _is_inline(uri):
        return
    name, rest = found[1], found[2]
    if name in ON_FUEL:
        address = f"{FUEL}{ON_FUEL[name]}"
        port.editor.set_text(uri, f"{address}/tip/files/{rest}" if rest else address)
    elif (name in PLAIN_MODELS and not rest and _put_plain_model(port, uri, name)) or (
        f"{name}/{rest}" in PLAIN_MESHES and _put_plain_shape(port, uri, f"{name}/{rest}")
    ):
        port.leave_once(
            uri,
            f"Gazebo Classic downloads the model `{name}` from its database; a plain shape of its "
            "size is in its place.",
            "Copy it from github.com/osrf/gazebo_models into the package if its looks matter.",
            is_note=True,
        )
    elif name in gazebo_models():
        port.leave_once(
            uri,
            f"Gazebo Classic downloads the model `{name}` from its database; Gazebo Sim does not.",
            "Copy it from github.com/osrf/gazebo_models into the package, or include one of Fuel.",
        )


def _put_plain_model(port: Porter, uri: Node, name: str) -> bool:
    """Write a model with a plain shape in the place of an <include> of a world."""
    include = uri.holder
    holder = include.holder if include is not None else None
    if include is None or include.name != "include" or holder is None or holder.name != "world":
        return False
    shape, above, inertia = PLAIN_MODELS[name]
    place = [] if not any(shape.center) else [Block("pose", f"{_numbers(shape.center)} 0 0 0")]
    form = Block("geometry", [_form(shape)])
    parts = [
        Block("collision", [*place, form], 'name="collision"'),
        Block("visual", [*place, form, _PAINT], 'name="visual"'),
    ]
    if inertia is not None:
        moments = zip(("ixx", "iyy", "izz"), inertia[1:], strict=True)
        content = [Block("mass", written(inertia[0])), *place]
        content.append(Block("inertia", [Block(tag, written(one)) for tag, one in moments]))
        parts.insert(0, Block("inertial", content))
    if above:
        parts.insert(0, Block("pose", f"0 0 {written(above)} 0 0 0"))
    static = include.value("static") or ("true" if inertia is None else "")
    content = [Block("static", static)] if static else []
    content += [*_placed(include, "pose"), Block("link", parts, 'name="link"')]
    own = include.value("name") or name
    port.editor.replace(include, [Block("model", content, f'name="{own}"')])
    return True


def _put_plain_shape(port: Porter, uri: Node, mesh: str) -> bool:
    """Write a plain shape in the place of a mesh."""
    node = uri.holder
    around = next((one for one in uri.ancestors() if one.name in ("collision", "visual")), None)
    if node is None or node.name != "mesh" or around is None:
        return False
    scale = _vector(node.value("scale") or "1 1 1")
    pose = around.find("pose")
    place = _vector(pose.text if pose is not None and pose.text else "0 0 0 0 0 0")
    shape = PLAIN_MESHES[mesh]
    is_round = shape.kind == "cylinder"
    if len(scale) != len(_AXES) or len(place) != len(_AXES) * 2:
        return False
    if (is_round and scale[0] != scale[1]) or any(pose.get(one) for one in _FRAMES if pose):
        return False
    sizes = [
        abs(size * factor)
        for size, factor in zip(shape.sizes, scale[1:] if is_round else scale, strict=True)
    ]
    port.editor.replace(node, [_form(shape._replace(sizes=tuple(sizes)))])
    if any(shape.center):
        x, y, z = (one * factor for one, factor in zip(shape.center, scale, strict=True))
        moved = rotate(rotation_of_rpy((place[3], place[4], place[5])), (x, y, z))
        xyz = [one + by for one, by in zip(place, moved, strict=False)]
        text = f"{_numbers(xyz)} {_numbers(place[3:])}"
        if pose is None:
            port.editor.prepend(around, Block("pose", text))
        else:
            port.editor.set_text(pose, text)
    return True


def _vector(text: str) -> list[float]:
    """The numbers of a text; none where one is not plain."""
    found = [number(one) for one in text.split()]
    return [] if None in found else [one for one in found if one is not None]


def _numbers(values: Iterable[float]) -> str:
    return " ".join(written(round(one, 6)) for one in values)


def _form(shape: Shape) -> Block:
    if shape.kind == "box":
        return Block("box", [Block("size", _numbers(shape.sizes))])
    radius, length = map(written, shape.sizes)
    return Block("cylinder", [Block("radius", radius), Block("length", length)])


def _is_inline(uri: Node) -> bool:
    """Whether the element around it is written anew."""
    include = uri.holder
    return (
        include is not None
        and include.name == "include"
        and include.holder is not None
        and include.holder.name == "world"
        and uri.text.strip("/") in {"model://sun", "model://ground_plane"}
    )


def model_names(folder: Path) -> Iterator[str]:
    """The names of the models below a folder: those of the folders with a `model.config`."""
    return (file.parent.name for file in folder.rglob("model.config"))
