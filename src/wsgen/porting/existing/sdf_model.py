"""A model of SDF as a URDF: what Gazebo reads beside it is copied into `<gazebo>` elements.

In SDF, links have frames of their own; in a URDF, that of a link is at the joint above it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from wsgen.descriptions.sdf.assembly import CLOSED_CHAIN, JOINT_LEFT_OUT, is_cross
from wsgen.descriptions.sdf.includes import MODEL_LEFT_OUT
from wsgen.descriptions.sdf.joints import TWO_AXES
from wsgen.descriptions.sdf.lookup import file_of_model, is_folder, model_finder
from wsgen.descriptions.sdf.models import read_model
from wsgen.descriptions.sdf.source import SIZE_LIMIT, line_of, read_document
from wsgen.descriptions.sdf.values import word
from wsgen.diagnostics import Severity
from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.isolation.parent import make_scratch
from wsgen.model.robot import GAZEBO_COLORS, Joint, JointType, Link
from wsgen.model.transform import IDENTITY, Pose
from wsgen.porting.existing.urdf_text import as_note, describe, free, pose_text
from wsgen.porting.ported import Unported
from wsgen.simulation.urdf_writer import quoted
from wsgen.text.files import read_whole
from wsgen.text.suggestions import some_of
from wsgen.text.xmlsyntax import NAMESPACES

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.descriptions.sdf.models import SdfModel
    from wsgen.diagnostics import Diagnostic
    from wsgen.model.devices import Devices, Element
    from wsgen.model.robot import Robot
    from wsgen.porting.existing.description import Description
    from wsgen.text import xmltree


ADVICE = {
    CLOSED_CHAIN.code: "Add a <gazebo><joint> of SDF between the two links, which Gazebo Classic "
    "simulates, or drive both sides with a controller.",
    JOINT_LEFT_OUT.code: "Write the joint as one that URDF has: revolute, continuous or prismatic.",
}
# Elements of SDF that no reader of wsgen takes up, and what they are.
LEFT_OUT = {
    "light": "lights",
    "projector": "projectors",
    "particle_emitter": "particle emitters",
    "audio_source": "sources of sound",
    "audio_sink": "sinks of sound",
    "battery": "batteries",
    "pbr": "materials with textures (pbr)",
    "gearbox_ratio": "ratios of gears",
    "thread_pitch": "pitches of screws",
}


def read_sdf_model(file: Path, *, environment: Mapping[str, str] | None = None) -> Description:
    """The robot of a model as a URDF.

    Args:
        file: An SDF file with one model, or the folder of a model, with its model.config.
        environment: Where Gazebo looks for models that it includes.

    Raises:
        NotFoundError: The folder has no model, or a model that is included is not there.
        NotReadableError: The file cannot be read, or no robot is in it.
        RequestError: It is a world.
    """
    if is_folder(file):
        found = file_of_model(file)
        if found is None:
            raise NotFoundError(
                f"{file} has no model.config that names a file, and no model.sdf.",
                hint="Give the SDF file itself.",
            )
        file = found
    file = file.absolute()
    root = _root_of(file)
    read = read_model(
        read_whole(file, SIZE_LIMIT),
        file=file,
        find_model=model_finder(file, environment or {}),
        with_devices=True,
    )
    for one in read.diagnostics:
        if one.code == MODEL_LEFT_OUT.code and one.severity is Severity.ERROR:
            raise NotFoundError(_placed(one, file), hint=one.hint or "")
    model = next(iter(read.models), None)
    if model is None or model.robot is None or model.devices is None:
        raise _refusal(file, root, read.diagnostics)
    port = _Port(file, root, model, model.robot, model.devices)
    return port.describe(read.diagnostics)._replace(included=tuple(sorted(read.included)))


def _root_of(file: Path) -> xmltree.Element | None:
    try:
        return read_document(read_whole(file, SIZE_LIMIT)).root
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise NotReadableError(
            f"{file} cannot be read: {reason}.", hint="Give an SDF file, or the folder of a model."
        ) from None


def _refusal(
    file: Path, root: xmltree.Element | None, found: Sequence[Diagnostic]
) -> NotReadableError | RequestError:
    if root is not None and root.find("world") is not None:
        return RequestError(
            f"{file} is a world: a package is made of one model.",
            hint="Give the file of the model, or its folder.",
        )
    first = next((one for one in found if one.severity is Severity.ERROR), None)
    if first is None:
        return NotReadableError(
            f"{file} has no model with links.", hint="Give the file of a robot."
        )
    return NotReadableError(_placed(first, file), hint=first.hint or "")


def _placed(found: Diagnostic, file: Path) -> str:
    return f"{found.file or file}:{found.line or 1}: {found.message}"


def _with_prefix(name: str) -> tuple[str, dict[str, str]]:
    """The name of an element or attribute as it is written, and the prefix that it needs."""
    uri, is_declared, local = name.removeprefix("{").rpartition("}")
    if is_declared:
        known = {address: prefix for prefix, address in NAMESPACES.items()}
        prefix = known.get(uri, "ignition" if "ignition" in uri else "of")
        return f"{prefix}:{local}", {prefix: uri}
    prefix, has_prefix, _ = name.partition(":")
    return name, {prefix: NAMESPACES.get(prefix, prefix)} if has_prefix else {}


class _Port:
    def __init__(
        self,
        file: Path,
        root: xmltree.Element | None,
        model: SdfModel,
        robot: Robot,
        devices: Devices,
    ) -> None:
        self.file = file
        self.root = root
        self.model = model
        self.devices = devices
        taken: set[str] = set()
        self.names: dict[str, str] = {}  # of links and joints, in the URDF by those in the model
        for name in (
            *(link.name for link in robot.links),
            *(joint.name for joint in (*robot.joints, *robot.loose)),
        ):
            plain = name.replace("::", "_").replace(" (", "_").rstrip(")")
            self.names[name] = free(plain, taken)
            taken.add(self.names[name])
        self.robot = self._renamed(robot)

    def describe(self, found: Sequence[Diagnostic]) -> Description:
        """The robot as a URDF."""
        robot = self._with_frames(self.robot)
        notes = [
            *(self._note(one) for one in found if one.severity is not Severity.INFO),
            *self._notes(),
        ]
        with make_scratch() as scratch:
            return describe(
                robot,
                file=self.file,
                notes=sorted(notes, key=lambda one: one.line),
                scratch=scratch,
                crosses=[new for name, new in self.names.items() if is_cross(name)],
                extensions=self._extensions(),
            )

    def _renamed(self, robot: Robot) -> Robot:
        def joint(one: Joint) -> Joint:
            mimic = one.mimic and replace(one.mimic, joint=self.names[one.mimic.joint])
            name, parent, child = (self.names[name] for name in (one.name, one.parent, one.child))
            return replace(one, name=name, parent=parent, child=child, mimic=mimic)

        return replace(
            robot,
            root=self.names[robot.root],
            links=tuple(replace(link, name=self.names[link.name]) for link in robot.links),
            joints=tuple(map(joint, robot.joints)),
            loose=tuple(replace(joint(one), type=JointType.FIXED) for one in robot.loose),
        )

    def _with_frames(self, robot: Robot) -> Robot:
        """The robot with a link for each `<frame>`."""
        taken = set(self.names.values())
        links, joints = [], []
        for name, carried in self.devices.frames.items():
            if name in self.names:
                continue
            new = self.names[name] = free(name.replace("::", "_"), taken)
            fixed = free(f"{new}_fixed", {*taken, new})
            taken |= {new, fixed}
            links.append(Link(name=new))
            joints.append(
                Joint(
                    name=fixed,
                    type=JointType.FIXED,
                    parent=self.names[carried.link],
                    child=new,
                    pose_in_parent=carried.pose_in_link,
                )
            )
        return replace(robot, links=(*robot.links, *links), joints=(*robot.joints, *joints))

    # ---- what Gazebo reads --------------------------------------------------------------------

    def _extensions(self) -> Iterator[str]:
        joints = {joint.name for joint in self.robot.joints}
        for sensor in self.devices.sensors:
            carrier = self.names.get(sensor.frame, sensor.frame)
            # That of a joint stays seen from it; that of a link is seen from the joint above.
            pose = None if carrier in joints else sensor.pose_in_link
            reference = carrier if carrier in joints else self.names[sensor.link]
            yield f"  <gazebo reference={quoted(reference)}>"
            yield from self._element(sensor.element, "    ", pose)
            yield "  </gazebo>"
        for link in self.robot.links:
            own = []
            if link.is_kinematic:
                own.append("    <kinematic>true</kinematic>")
            if any(link.velocity_decay):
                linear, angular = link.velocity_decay
                own.append(
                    f"    <velocity_decay><linear>{linear!r}</linear><angular>{angular!r}</angular>"
                    "</velocity_decay>"
                )
            if own:
                yield f"  <gazebo reference={quoted(link.name)}>"
                yield from (*own, "  </gazebo>")
        for plugin in self.devices.plugins:
            yield "  <gazebo>"
            yield from self._element(plugin, "    ", None)
            yield "  </gazebo>"

    def _element(self, element: Element, indent: str, pose: Pose | None) -> Iterator[str]:
        """An element as it is written, with the names of the URDF; a pose replaces its own."""
        tag, declared = _with_prefix(element.tag)
        attributes = ""
        for name, value in element.attributes.items():
            written, more = _with_prefix(name)
            attributes += f" {written}={quoted(value)}"
            declared |= more
        attributes += "".join(f" xmlns:{one}={quoted(uri)}" for one, uri in declared.items())
        text = quoted(self.names.get(element.text, element.text))[1:-1]
        inner = [one for one in element.children if pose is None or one.tag != "pose"]
        if not inner and pose is None:
            yield f"{indent}<{tag}{attributes}>{text}</{tag}>"
            return
        yield f"{indent}<{tag}{attributes}>"
        if pose is not None and pose != IDENTITY:
            yield f"{indent}  <pose>{pose_text(pose)}</pose>"
        for one in inner:
            yield from self._element(one, f"{indent}  ", None)
        yield f"{indent}</{tag}>"

    # ---- what is said -------------------------------------------------------------------------

    def _note(self, found: Diagnostic) -> Unported:
        """What the reader reports; it speaks of a simulation."""
        note = as_note(found, self.file)
        what = note.what.replace("is not simulated", "is not in the URDF")
        what = what.replace("the engines of wsgen do not support", "URDF does not have")
        return note._replace(what=what, advice=ADVICE.get(found.code, note.advice))

    def _notes(self) -> Iterator[Unported]:
        yield from self._notes_of_joints()
        place, model = self.model.pose_in_world, self.model.model_pose or IDENTITY
        if place != model and not self.robot.fixed_to_world:
            yield self._said(
                self.model.line,
                f"The origin of the robot is that of its root link `{self.robot.root}`, not that "
                "of the model.",
                f"Spawn it at z = {place.z:g} where the model was spawned at 0.",
            )
        elements = [] if self.root is None else list(self.root.iter())
        yield from self._notes_of_elements(elements)

    def _notes_of_joints(self) -> Iterator[Unported]:
        for joint in self.robot.joints:
            if joint.type is JointType.BALL:
                yield self._said(
                    joint.line,
                    f"The ball joint `{joint.name}` became three revolute joints "
                    f"({joint.name}_x, {joint.name}_y, {joint.name}_z).",
                    "Keep away from 90° about y, where two of them have one axis.",
                )
        for joint in self.robot.loose:
            yield self._said(
                joint.line,
                f"No joint holds the link `{joint.child}`. A URDF is one tree: a fixed joint does.",
                "Write the joint that is meant, or make a package of it alone.",
            )

    def _notes_of_elements(self, elements: Sequence[xmltree.Element]) -> Iterator[Unported]:
        for element in elements:
            kind = element.get("type") or ""
            if element.tag == "joint" and kind in TWO_AXES:
                yield self._said(
                    line_of(element),
                    f"The {kind} joint `{element.get('name')}` became two revolute joints.",
                    "Give a controller both of them.",
                )
        for tag, what in LEFT_OUT.items():
            found = [one for one in elements if one.tag == tag]
            if found:
                owners = [self._owner(one) for one in found]
                yield self._said(
                    line_of(found[0]),
                    f"URDF has no {what}: {some_of(list(dict.fromkeys(owners)))}.",
                    "Add them to the model in the simulator, or leave them out.",
                )
        scripts = [word(one, "name") for one in elements if one.tag == "script"]
        textures = [one for one in dict.fromkeys(scripts) if one and one not in GAZEBO_COLORS]
        if textures:
            first = next(one for one in elements if word(one, "name") == textures[0])
            yield self._said(
                line_of(first),
                f"The materials of scripts are not in the URDF: {some_of(textures)}.",
                "Use a mesh that brings its texture, or a color.",
            )

    @staticmethod
    def _owner(element: xmltree.Element) -> str:
        place: xmltree.Element | None = element
        while place is not None and not place.get("name"):
            place = place.getparent()
        return f"`{'' if place is None else place.get('name')}`"

    def _said(self, line: int | None, what: str, advice: str) -> Unported:
        return Unported(file=self.file, line=line or 1, what=what, advice=advice)
