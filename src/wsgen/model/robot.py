"""A robot as its URDF describes it, and as a simulator gets it. SI units throughout.

The frame of a link is the frame of its parent joint (URDF's convention). `pose_in_link` is seen
from the link frame, `pose_in_parent` from the parent link's frame. What the URDF says of motors,
`<ros2_control>` and the `<transmission>` of ROS 1, is kept as it is written.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping  # noqa: TC003  the file of a live run is decoded by type hints
from dataclasses import field
from enum import Enum
from typing import NamedTuple

from wsgen.model.transform import IDENTITY, Pose, Vector
from wsgen.text.values import dataclass


@dataclass(frozen=True, kw_only=True)
class ControlledPart:
    """A `<joint>`, `<sensor>` or `<gpio>` of a `<ros2_control>` element."""

    kind: str  # the name of the element
    name: str
    commands: tuple[str, ...] = ()  # names of the command interfaces, as written
    states: tuple[str, ...] = ()  # of the state interfaces
    mimic: str = ""  # its attribute of that name
    line: int | None = None  # of the element in the URDF text, 1-based


@dataclass(frozen=True, kw_only=True)
class ControlSystem:
    """A `<ros2_control>` element."""

    name: str
    kind: str  # its attribute `type`
    hardware: str | None  # the class that <plugin> in <hardware> names; None: no such element
    parts: tuple[ControlledPart, ...] = ()
    others: tuple[str, ...] = ()  # names of child elements that ros2_control does not know
    line: int | None = None
    hardware_line: int | None = None  # of <plugin>

    @property
    def joints(self) -> tuple[ControlledPart, ...]:
        """Its joints, in the order of the description."""
        return tuple(part for part in self.parts if part.kind == "joint")


@dataclass(frozen=True, kw_only=True)
class Transmission:
    """A `<transmission>` element beside the links and joints, which only ROS 1 reads."""

    name: str
    joints: tuple[str, ...] = ()  # that it names
    line: int | None = None


# Of a tree in PyBullet: MAX_DEGREE_OF_FREEDOM in its SharedMemoryCommands.h; with more, reading a
# pose raises.
MOST_LINKS = 128


class JointType(str, Enum):
    """URDF's joint types, and SDF's ball."""

    FIXED = "fixed"
    REVOLUTE = "revolute"
    CONTINUOUS = "continuous"
    PRISMATIC = "prismatic"
    PLANAR = "planar"
    FLOATING = "floating"
    BALL = "ball"


@dataclass(frozen=True, kw_only=True)
class Inertial:
    """Mass, center of mass and inertia tensor of a link."""

    mass: float  # kg
    pose_in_link: Pose = IDENTITY  # of the frame at the center of mass in which `inertia` is given
    inertia: tuple[float, float, float, float, float, float]  # kg m²: ixx ixy ixz iyy iyz izz


@dataclass(frozen=True, kw_only=True)
class Box:
    """A box centered on its frame."""

    size: tuple[float, float, float]  # m, edge lengths along x, y, z


@dataclass(frozen=True, kw_only=True)
class Cylinder:
    """A cylinder centered on its frame, its axis along z."""

    radius: float  # m
    length: float  # m


@dataclass(frozen=True, kw_only=True)
class Sphere:
    """A sphere centered on its frame."""

    radius: float  # m


@dataclass(frozen=True, kw_only=True)
class Capsule:
    """A cylinder with two half spheres, centered on its frame, its axis along z."""

    radius: float  # m
    length: float  # m, of the cylinder between the half spheres


class MeshPart(NamedTuple):
    """A group of faces in a mesh file; SDF's <submesh>."""

    name: str
    is_centered: bool = False  # moved so that the middle of the box around it is at the origin


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """A mesh file."""

    uri: str  # as written: package://…, file://…, model://… or a path
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    path: str | None = None  # the file that `uri` stands for, when it was found
    part: MeshPart | None = None  # of the file, which is shown or touched; None: all of it
    # m, unscaled: two corners of the box around its points, when somebody has looked into the file
    bounds: tuple[tuple[float, float, float], tuple[float, float, float]] | None = None
    triangles: int | None = field(default=None, compare=False)  # in the file, likewise


@dataclass(frozen=True, kw_only=True)
class Ellipsoid:
    """An ellipsoid centered on its frame, its axes along x, y, z."""

    radii: tuple[float, float, float]  # m


@dataclass(frozen=True, kw_only=True)
class Cone:
    """A cone with its tip along z, its frame half way between base and tip."""

    radius: float  # m, of the base
    length: float  # m, from base to tip


@dataclass(frozen=True, kw_only=True)
class Extrusion:
    """What outlines in the plane of x and y enclose, from z = 0 up; SDF's <polyline>.

    What is inside of an even number of outlines is outside: one within another is a hole.
    """

    outlines: tuple[tuple[tuple[float, float], ...], ...]  # m, corners; closed from last to first
    height: float  # m
    line: int | None = None  # of the element in the SDF text, 1-based


@dataclass(frozen=True, kw_only=True)
class Heightmap:
    """A surface over the plane of x and y, as high as the pixels of an image are bright.

    It is centered on its frame; the first row of the image is at the highest y.
    """

    uri: str  # as written
    path: str | None = None  # the image that `uri` stands for, when it was found
    size: tuple[float, float, float] = (1.0, 1.0, 1.0)  # m; z is the height of the brightest pixel
    pos: tuple[float, float, float] = (0.0, 0.0, 0.0)  # m, offset; collisions have none in Gazebo
    sampling: int = 1  # steps from one pixel to the next
    line: int | None = None  # of the element in the SDF text, 1-based


Primitive = Box | Cylinder | Sphere | Capsule
# What no engine has: `wsgen.descriptions.meshes.shape_meshes` makes meshes of them.
Triangulated = Ellipsoid | Cone | Extrusion | Heightmap
Geometry = Primitive | Mesh | Triangulated


LITTLE_GRIP = 0.3  # friction coefficient; wheels with less slip


@dataclass(frozen=True, kw_only=True)
class Surface:
    """How a collision touches others; the defaults are Gazebo's."""

    mu1: float = 1.0  # Coulomb friction coefficient, first direction
    mu2: float = 1.0  # second direction
    fdir1: Vector | None = None  # the first direction; None: on level ground, y of the world
    fdir1_in: str | None = None  # the link that it turns with; None: that of the collision
    kp: float | None = None  # N/m, contact stiffness
    kd: float | None = None  # N s/m, contact damping
    min_depth: float | None = None  # m
    max_contacts: int | None = None

    @property
    def grip(self) -> float:
        """The friction coefficient, in the direction in which it is larger."""
        return max(self.mu1, self.mu2)

    @property
    def along_world(self) -> tuple[float, float]:
        """The coefficients along y and x of the world, on level ground; of `fdir1`, `mu1` twice."""
        return self.mu1, self.mu2 if self.fdir1 is None else self.mu1


Rgba = tuple[float, float, float, float]


class Paint(NamedTuple):
    """What of the light a surface gives back, and what it shines by itself."""

    ambient: Rgba
    diffuse: Rgba
    emissive: Rgba = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True, kw_only=True)
class Visual:
    """Something to see."""

    geometry: Geometry
    pose_in_link: Pose = IDENTITY
    rgba: tuple[float, float, float, float] | None = None  # 0 to 1; None: the simulator's default
    paint: Paint | None = None  # as Gazebo Classic has it, where `rgba` alone is not all of it
    texture: str | None = None  # an image file, for a box, or a mesh that has texture points
    laser_retro: float = 0.0  # what lidars on a GPU have as intensity of it
    name: str | None = None


@dataclass(frozen=True, kw_only=True)
class Collision:
    """Something to touch."""

    geometry: Geometry
    pose_in_link: Pose = IDENTITY
    surface: Surface = Surface()
    laser_retro: float = 0.0  # what lidars on the CPU have as intensity of it
    name: str | None = None


@dataclass(frozen=True, kw_only=True)
class Link:
    """A rigid body."""

    name: str
    inertial: Inertial | None = None
    visuals: tuple[Visual, ...] = ()
    collisions: tuple[Collision, ...] = ()
    self_collide: bool = False
    gravity: bool = True
    is_kinematic: bool = False  # it stays where it is, in Gazebo Classic alone
    # The shares of speed and turning that it loses in each step, in Gazebo Classic alone.
    velocity_decay: tuple[float, float] = (0.0, 0.0)
    is_as_meant: bool = True  # if not, a part of it was not understood, which has been reported
    has_error: bool = False  # one is reported; others may follow from it
    line: int | None = None  # of the element in the URDF text, 1-based


@dataclass(frozen=True, kw_only=True)
class JointLimit:
    """Bounds of a joint: rad, rad/s, N m for rotation; m, m/s, N for translation."""

    lower: float = 0.0
    upper: float = 0.0
    effort: float = 0.0  # below 0: without bound, as SDF has it
    velocity: float = 0.0  # likewise
    line: int | None = field(default=None, compare=False)  # of the element, 1-based


STOP = (0.2, 0.0)  # see `Joint.stop`; Gazebo's own


@dataclass(frozen=True, kw_only=True)
class Mimic:
    """This joint's position = multiplier × the other joint's position + offset."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0  # rad or m
    line: int | None = field(default=None, compare=False)  # of the element, 1-based


@dataclass(frozen=True, kw_only=True)
class Joint:
    """How a child link moves against its parent."""

    name: str
    type: JointType
    parent: str  # link name
    child: str  # link name
    pose_in_parent: Pose = IDENTITY  # of the child's frame, at joint position 0
    axis_in_joint: tuple[float, float, float] = (1.0, 0.0, 0.0)  # seen from the child's frame
    limit: JointLimit | None = None
    damping: float = 0.0  # N m s/rad or N s/m
    friction: float = 0.0  # N m or N
    spring_stiffness: float = 0.0  # N m/rad or N/m
    spring_reference: float = 0.0  # rad or m, where the spring is at rest
    # Of its stops in Gazebo Classic, if that is said: what share of the way beyond a limit goes in
    # a step (ERP), and by how much they give way (CFM), m/s per N or rad/s per N m.
    stop: tuple[float, float] | None = None
    mimic: Mimic | None = None
    is_held: bool = False  # Gazebo's plugin for ros2_control keeps it where it is
    kept_by: str = ""  # the element of <gazebo> for which sdformat does not lump it, if it is fixed
    line: int | None = None  # of the element in the URDF text, 1-based

    @property
    def is_movable(self) -> bool:
        """Whether it has a degree of freedom."""
        return self.type is not JointType.FIXED

    @property
    def starts_beyond_limit(self) -> bool:
        """Whether 0, where simulators spawn it, is outside of its limits."""
        has_limits = self.type in {JointType.REVOLUTE, JointType.PRISMATIC}
        limit = self.limit if has_limits else None
        return limit is not None and not limit.lower <= 0 <= limit.upper


class Plugin(NamedTuple):
    """A `<plugin>`, as it is written."""

    filename: str
    values: Mapping[str, tuple[str, ...]]  # child element -> its texts, one for each such child
    name: str = ""  # in Gazebo Sim the class that is loaded
    line: int | None = None  # of the element in the URDF text, 1-based


class Sensor(NamedTuple):
    """A `<sensor>` of SDF, as it is written."""

    name: str
    kind: str = ""  # its attribute `type`
    values: Mapping[str, tuple[str, ...]] = {}  # child element -> its texts
    plugins: tuple[Plugin, ...] = ()
    line: int | None = None


class SdfJoint(NamedTuple):
    """A `<joint>` of SDF inside of a `<gazebo>` element, which Gazebo copies."""

    name: str
    ends: Mapping[str, str]  # "parent" and "child" -> what they name
    line: int | None
    is_ball: bool = False  # a ball joint at the origin of its child


def by_parent(joints: Iterable[Joint]) -> dict[str, list[Joint]]:
    """The joints below each link that has some, in their order."""
    below: dict[str, list[Joint]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint)
    return below


@dataclass(frozen=True, kw_only=True)
class GazeboTag:
    """One `<gazebo>` element, as far as wsgen only records it."""

    reference: str | None  # link or joint; None: the whole robot
    values: Mapping[str, str] = field(default_factory=dict)  # child element -> its text
    plugins: tuple[Plugin, ...] = ()
    sensors: tuple[Sensor, ...] = ()
    joints: tuple[SdfJoint, ...] = ()  # of the robot as a whole
    frames: tuple[str, ...] = ()  # links and frames of SDF that it adds to the robot
    is_open: bool = False  # it includes models, whose links are not known
    line: int | None = None


@dataclass(frozen=True, kw_only=True)
class Robot:
    """A tree of links; `root` is the link without a parent.

    A lumped robot may be several trees: the child of a joint that Gazebo does not create (floating,
    planar) is loose, and `loose` says where it is at the start.
    """

    name: str
    root: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...] = ()
    gazebo: tuple[GazeboTag, ...] = ()
    controls: tuple[ControlSystem, ...] = ()
    transmissions: tuple[Transmission, ...] = ()
    loose: tuple[Joint, ...] = ()  # of a lumped robot: parent and child are links of two trees
    fixed_to_world: bool = False  # the root is a link named `world`
    is_static: bool = False  # <gazebo><static>: nothing of it moves
    # The names of the joints of a lumped robot as Gazebo numbers them; (): as they are in `joints`.
    gazebo_order: tuple[str, ...] = ()

    @property
    def mass(self) -> float:
        """Sum of the masses of all links, kg."""
        return sum(link.inertial.mass for link in self.links if link.inertial)

    @property
    def movable_joints(self) -> tuple[Joint, ...]:
        """The joints with a degree of freedom, in the order of the description."""
        return tuple(joint for joint in self.joints if joint.is_movable)

    @property
    def joints_in_gazebo(self) -> tuple[Joint, ...]:
        """The joints as Gazebo numbers them."""
        places = {name: place for place, name in enumerate(self.gazebo_order)}
        return tuple(sorted(self.joints, key=lambda joint: places.get(joint.name, len(places))))

    def link(self, name: str) -> Link:
        """The link of that name; KeyError where there is none."""
        for link in self.links:
            if link.name == name:
                return link
        raise KeyError(name)

    def least_grip(self, joints: Collection[str]) -> float:
        """The friction coefficient of that wheel of these joints which has the least.

        Of several collisions of a wheel the one with the most counts, as any may be the tire.
        Wheels without collisions are left out; without any other the coefficient is Gazebo's, 1.
        """
        wheels = {joint.child for joint in self.joints if joint.name in joints}
        grips = (
            max(collision.surface.grip for collision in link.collisions)
            for link in self.links
            if link.name in wheels and link.collisions
        )
        return min(grips, default=Surface().grip)


# What `Gazebo/<Name>` stands for: the diffuse colors in the material script `gazebo.material` that
# Gazebo Classic ships. RGBA, 0 to 1.
GAZEBO_COLORS: dict[str, Rgba] = {
    "Gazebo/Grey": (0.7, 0.7, 0.7, 1.0),
    "Gazebo/Gray": (0.7, 0.7, 0.7, 1.0),
    "Gazebo/DarkGrey": (0.175, 0.175, 0.175, 1.0),
    "Gazebo/DarkGray": (0.175, 0.175, 0.175, 1.0),
    "Gazebo/White": (1.0, 1.0, 1.0, 1.0),
    "Gazebo/FlatBlack": (0.1, 0.1, 0.1, 1.0),
    "Gazebo/Black": (0.0, 0.0, 0.0, 1.0),
    "Gazebo/Red": (1.0, 0.0, 0.0, 1.0),
    "Gazebo/RedBright": (0.87, 0.26, 0.07, 1.0),
    "Gazebo/Green": (0.0, 1.0, 0.0, 1.0),
    "Gazebo/Blue": (0.0, 0.0, 1.0, 1.0),
    "Gazebo/SkyBlue": (0.0, 0.0, 1.0, 1.0),
    "Gazebo/Yellow": (1.0, 1.0, 0.0, 1.0),
    "Gazebo/DarkYellow": (0.7, 0.7, 0.0, 1.0),
    "Gazebo/ZincYellow": (0.9725, 0.9529, 0.2078, 1.0),
    "Gazebo/Orange": (1.0, 0.5088, 0.0468, 1.0),
    "Gazebo/Purple": (1.0, 0.0, 1.0, 1.0),
    "Gazebo/Turquoise": (0.0, 1.0, 1.0, 1.0),
    "Gazebo/Indigo": (0.33, 0.0, 0.5, 1.0),
    "Gazebo/Gold": (0.8, 0.6487, 0.1209, 1.0),
    "Gazebo/GreyTransparent": (0.5, 0.5, 0.5, 0.5),
    "Gazebo/BlackTransparent": (0.0, 0.0, 0.0, 0.5),
    "Gazebo/RedTransparent": (1.0, 0.0, 0.0, 0.5),
    "Gazebo/GreenTransparent": (0.0, 1.0, 0.0, 0.5),
    "Gazebo/BlueTransparent": (0.0, 0.0, 1.0, 0.5),
    "Gazebo/YellowTransparent": (1.0, 1.0, 0.0, 0.5),
    "Gazebo/OrangeTransparent": (1.0, 0.44, 0.0, 0.4),
    "Gazebo/TurquoiseGlow": (0.0, 1.0, 1.0, 1.0),
    "Gazebo/RedGlow": (1.0, 0.0, 0.0, 1.0),
    "Gazebo/GreenGlow": (0.0, 1.0, 0.0, 1.0),
    "Gazebo/BlueGlow": (0.0, 0.0, 1.0, 1.0),
    "Gazebo/YellowGlow": (1.0, 1.0, 0.0, 1.0),
    "Gazebo/PurpleGlow": (1.0, 0.0, 1.0, 1.0),
    "Gazebo/WhiteGlow": (1.0, 1.0, 1.0, 1.0),
    # Textures, by the color that they give on the whole.
    "Gazebo/Wood": (0.62, 0.45, 0.28, 1.0),
    "Gazebo/WoodFloor": (0.62, 0.45, 0.28, 1.0),
    "Gazebo/WoodPallet": (0.62, 0.45, 0.28, 1.0),
    "Gazebo/CeilingTiled": (0.85, 0.85, 0.83, 1.0),
    "Gazebo/PaintedWall": (0.85, 0.82, 0.75, 1.0),
    "Gazebo/Bricks": (0.6, 0.35, 0.28, 1.0),
    "Gazebo/Road": (0.3, 0.3, 0.3, 1.0),
    "Gazebo/Residential": (0.5, 0.5, 0.5, 1.0),
    "Gazebo/Grass": (0.3, 0.5, 0.2, 1.0),
    "Gazebo/Pedestrian": (0.7, 0.6, 0.5, 1.0),
}

# Likewise, their ambient colors, where these are others.
GAZEBO_AMBIENTS: dict[str, Rgba] = {
    "Gazebo/Grey": (0.3, 0.3, 0.3, 1.0),
    "Gazebo/Gray": (0.3, 0.3, 0.3, 1.0),
    "Gazebo/SkyBlue": (0.13, 0.44, 0.7, 1.0),
    "Gazebo/Gold": (0.4, 0.2487, 0.0208, 1.0),
}
NEITHER: Rgba = (1.0, 1.0, 1.0, 1.0)  # what Gazebo Classic takes for a color that is not given


def painted(
    name: str, ambient: Rgba | None, diffuse: Rgba | None, emissive: Rgba | None
) -> Paint | None:
    """The paint of a material with that script and these colors; None where `rgba` is all of it."""
    of_script = GAZEBO_COLORS.get(name, NEITHER)
    paint = Paint(
        ambient or GAZEBO_AMBIENTS.get(name, of_script),
        diffuse or of_script,
        emissive or Paint._field_defaults["emissive"],
    )
    return None if paint == Paint(paint.diffuse, paint.diffuse) else paint
