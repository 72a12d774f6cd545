"""What of an MJCF is not in the URDF that is made of it: each with its element; runs in a child."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

from wsgen.porting.existing.mjcf import Said
from wsgen.porting.existing.urdf_text import FARTHEST, SHARE
from wsgen.simulation.mujoco_body import library as mujoco
from wsgen.text.suggestions import some_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.model.robot import Joint, Mesh


PERCENT = f"{SHARE:.0%}".replace("%", " %")


class LeftOut:
    """A model of MuJoCo, with what was made of it so far, and what is said about it."""

    def __init__(self, spec: Any, model: Any) -> None:
        self.spec = spec
        self.model = model
        self.said: list[Said] = []
        self.kinds: dict[str, list[Any]] = {
            "body": spec.bodies,
            "joint": spec.joints,
            "geom": spec.geoms,
            "mesh": spec.meshes,
        }
        self.joints: list[Joint] = []
        self.link_names: dict[int, str] = {}
        self.joint_names: dict[int, str] = {}
        self.hulls: dict[int, Mesh] = {}

    def _is_free(self, body: int) -> bool:
        joint = self.model.body_jntadr[body]
        return joint >= 0 and is_of(self.model.jnt_type[joint], mujoco.mjtJoint.mjJNT_FREE)

    def _reference(self, joint: int) -> float:
        """The position of the joint in which the model is written: 0 unless it has a `ref`."""
        if self.model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_BALL:
            return 0.0
        return float(self.model.qpos0[self.model.jnt_qposadr[joint]])

    def _element(self, tag: str, number: int) -> Any:
        return next(one for one in self.kinds[tag] if one.id == number)

    def _called(self, tag: str, number: int) -> str:
        name = self._element(tag, number).name
        return f"`{name}`" if name else "without a name"

    def _say(self, tag: str, number: int, what: str, advice: str) -> None:
        element = self._element(tag, number)
        self.said.append(Said(tag, element.name, line_of(element), what, advice))

    def _say_of_all(self, elements: Sequence[Any], tag: str, what: str, advice: str) -> None:
        """One sentence about elements, at the line of the first; `what` begins with their names."""
        if elements:
            first = elements[0]
            unnamed = sum(not one.name for one in elements)
            names = some_of([f"`{one.name}`" for one in elements if one.name])
            if unnamed:
                names = f"{names or 'some'} ({unnamed} without a name)"
            self.said.append(
                Said(tag, first.name, line_of(first), f"{what.replace('@', names)}", advice)
            )

    def _say_equality(self, number: int, kind: Any) -> None:
        kinds, element = mujoco.mjtEq, self.spec.equalities[number]
        ends = [name for name in (element.name1, element.name2) if name]
        between = " and ".join(f"`{name}`" for name in ends) or "two parts"
        if is_of(kind, kinds.mjEQ_CONNECT, kinds.mjEQ_WELD):
            what = f"closes a loop between {between}: a URDF is a tree, and it stays open"
            advice = (
                "Add a <gazebo><joint> of SDF between the two links, which Gazebo Classic "
                "simulates, or drive both sides with a controller."
            )
        elif kind == kinds.mjEQ_JOINT:
            what = f"couples {between} by more than a factor and an offset"
            advice = "Have a controller move the joint, or write a <mimic> that is near enough."
        else:
            what = f"constrains {between}: a URDF has no such constraint"
            advice = "Have a controller move these joints together."
        tag = mujoco.mjtEq(int(kind)).name.removeprefix("mjEQ_").lower()
        name = f" `{element.name}`" if element.name else ""
        self.said.append(
            Said(
                tag,
                element.name,
                line_of(element),
                f"The equality{name} ({tag}) {what}.",
                advice,
            )
        )

    def _say_about_bodies(self, loose: Sequence[int]) -> None:
        model = self.model
        for what, bodies in (
            ("moves freely beside the robot", [one for one in loose if self._is_free(one)]),
            (
                "is moved by a program (mocap)",
                [one for one in loose if model.body_mocapid[one] >= 0],
            ),
            (
                "is fixed to the world beside the robot",
                [one for one in loose if not self._is_free(one) and model.body_mocapid[one] < 0],
            ),
        ):
            self._say_of_all(
                [self._element("body", one) for one in bodies],
                "body",
                f"What {what} is not part of it: @.",
                "Put it into the world, or make a package of it alone.",
            )
        self._say_of_all(
            list(self.spec.worldbody.geoms),
            "geom",
            "The geoms of the world itself are not part of the robot: @.",
            "Put what the robot stands on into the world.",
        )
        self._say_of_all(
            [
                self._element("body", body)
                for body in self.link_names
                if model.body_gravcomp[body] not in {0, 1}
            ],
            "body",
            "A part of gravity is compensated (gravcomp) at @.",
            "Have a controller do so.",
        )

    def _say_about_joints(self) -> None:
        model = self.model
        of_robot = [(number, self._element("joint", number)) for number in self.joint_names]
        for number, _joint in of_robot:
            if model.jnt_type[number] == mujoco.mjtJoint.mjJNT_BALL:
                name = self.joint_names[number]
                self._say(
                    "joint",
                    number,
                    f"The ball joint {self._called('joint', number)} became three revolute joints "
                    f"({name}_x, {name}_y, {name}_z); each link between them has {PERCENT} of the "
                    "mass.",
                    "Keep away from 90° about y, where two of them have one axis.",
                )
        moving = [
            (number, joint)
            for number, joint in of_robot
            if model.jnt_type[number] != mujoco.mjtJoint.mjJNT_FREE
        ]
        bodies = Counter(int(model.jnt_bodyid[number]) for number, _ in moving)
        limited = {one.name for one in self.joints if one.limit}
        unlimited = {one.name for one in self.joints if one.limit and one.limit.effort >= FARTHEST}
        dofs = {number: int(model.jnt_dofadr[number]) for number, _ in moving}
        for chosen, what, advice in (
            (
                [one for number, one in moving if self._reference(number)],
                "MuJoCo starts with @ at `ref`; a URDF starts with all joints at 0.",
                "Give the controllers these positions at the start.",
            ),
            (
                [self._element("body", body) for body, count in bodies.items() if count > 1],
                (
                    f"Between several joints of a body are links with {PERCENT} of its mass each, "
                    "taken from it: @."
                ),
                "No action is needed: simulators need a mass there.",
            ),
            (
                [one for number, one in moving if model.dof_armature[dofs[number]] > 0],
                "The inertia of rotors (armature) of @ is not in the URDF.",
                "Add it to the inertia of the link along the axis, if the joint oscillates.",
            ),
            (
                [one for number, one in moving if self.joint_names[number] in unlimited],
                f"An effort limit of {FARTHEST:,.0f} was written for @: the MJCF has none.",
                "Write the torque or force of the motor.",
            ),
            (
                [one for number, one in moving if self.joint_names[number] in limited],
                f"A velocity limit of {FARTHEST:,.0f} was written for @: MJCF has none.",
                "Write the speed of the motors.",
            ),
        ):
            tag = "joint" if chosen and chosen[0] in [one for _, one in moving] else "body"
            self._say_of_all(chosen, tag, what, advice)

    def _say_about_the_rest(self, trees: set[int]) -> None:
        model, spec = self.model, self.spec
        kinds: dict[str, list[tuple[Any, str]]] = {}
        for number in range(model.nu):
            kind, gains = self._kind_of_actuator(number)
            kinds.setdefault(kind, []).append((spec.actuators[number], gains))
        for kind, actuators in kinds.items():
            gained = dict.fromkeys(gains for _, gains in actuators if gains)
            self._say_of_all(
                [actuator for actuator, _ in actuators],
                "actuator",
                f"URDF has no actuators; these are {kind}: @"
                + (f" ({some_of(list(gained))})." if gained else "."),
                "Choose a controller with --control that commands the same.",
            )
        used = {
            int(model.geom_matid[geom])
            for geom in range(model.ngeom)
            if int(model.body_rootid[model.geom_bodyid[geom]]) in trees
        }
        textured = [
            one for one in spec.materials if one.id in used and (model.mat_texid[one.id] >= 0).any()
        ]
        for elements, tag, what, advice in (
            (
                spec.tendons,
                "tendon",
                "URDF has no tendons: @.",
                "Command the joints themselves, together.",
            ),
            (
                spec.sensors,
                "sensor",
                "The sensors of the MJCF are not in the URDF: @.",
                "Add those that Gazebo has, with --sensor.",
            ),
            (
                spec.cameras,
                "camera",
                "The cameras of the MJCF are not in the URDF: @.",
                "Add one with --sensor camera:LINK.",
            ),
            (
                spec.keys,
                "key",
                "The poses of keyframes are not in the URDF: @.",
                "Give them to the controllers.",
            ),
            (
                [*spec.excludes, *spec.pairs],
                "contact",
                "Which bodies touch each other (pair, exclude) is not in the URDF: @.",
                "No action is needed: links of a model do not touch each other in Gazebo.",
            ),
            (
                textured,
                "material",
                "The textures of materials are not in the URDF, their colors are: @.",
                "Use a mesh that brings its texture (.dae, .obj with .mtl).",
            ),
            (
                [one for one in spec.meshes if one.id in self.hulls],
                "mesh",
                "MuJoCo collides with the convex hulls of meshes: they are the collisions of @.",
                "No action is needed: what is seen are the meshes.",
            ),
            (
                [*spec.flexes, *spec.skins],
                "",
                "URDF has nothing soft (flex, skin): @.",
                "Leave it out, or use rigid links.",
            ),
        ):
            self._say_of_all(list(elements), tag, what, advice)

    def _kind_of_actuator(self, number: int) -> tuple[str, str]:
        """What an actuator is, and its gains."""
        model = self.model
        gain, bias = model.actuator_gaintype[number], model.actuator_biastype[number]
        factor, terms = model.actuator_gainprm[number][0], model.actuator_biasprm[number]
        if gain == mujoco.mjtGain.mjGAIN_FIXED and bias == mujoco.mjtBias.mjBIAS_NONE:
            return "motors (effort)", ""
        if gain == mujoco.mjtGain.mjGAIN_FIXED and bias == mujoco.mjtBias.mjBIAS_AFFINE:
            if terms[1] == -factor:
                return "position servos", f"kp {factor:g} kv {abs(terms[2]):g}"
            if terms[1] == 0 and terms[2] == -factor:
                return "velocity servos", f"kv {factor:g}"
        return "of another kind", ""


def is_of(value: Any, *kinds: Any) -> bool:
    """Whether a number of the model is one of an enumeration."""
    return any(value == kind for kind in kinds)


def line_of(element: Any) -> int:
    """Its line; 0 if that is not known. MuJoCo's own notice of an element begins with it."""
    word, _, number = element.info.partition(" ")
    digits = number.split(",")[0].strip()
    return int(digits) if word == "line" and digits.isdecimal() else 0
