"""Rules about descriptions of robots that hold for URDF and for SDF."""

from __future__ import annotations

from wsgen.diagnostics import Measured, Rule, Severity

MALFORMED_XML = Rule(
    code="ROB001",
    name="malformed-xml",
    severity=Severity.ERROR,
    severity_varies="a warning where Gazebo's parser still reads the file",
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A URDF or SDF file is not well-formed XML.",
    why="Gazebo does not read such a file. A few errors, such as a bare `&` or `--` in a comment, "
    "only stop stricter programs: xacro, robot_state_publisher and editors.",
    example='<robot name="r">\n  <link name="base_link">\n</robot>',
    instead='<robot name="r">\n  <link name="base_link"/>\n</robot>',
)

OVERSIZED_FILE = Rule(
    code="ROB002",
    name="oversized-file",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A URDF or SDF file is too large, or declares entities.",
    why="`wsgen` reads every file within bounded time and memory. The largest public URDF has 4 % "
    "of the limit: a larger file is nearly always a mistake. Gazebo's parser does not support "
    "entities.",
    example='<!DOCTYPE robot [<!ENTITY radius "0.1">]>',
    instead=(
        'Write the values, or use `<xacro:property name="radius" value="0.1"/>` in a xacro file.'
    ),
)

NO_LINK = Rule(
    code="ROB005",
    name="no-link",
    severity=Severity.ERROR,
    severity_varies="information from `wsgen check` in a file for Webots",
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A robot or a movable model has no link.",
    why="Gazebo refuses a robot without links. A link `world` in a URDF does not count: it only "
    "fixes the robot to the world.",
    example='<robot name="r"/>',
    instead='<robot name="r">\n  <link name="base_link"/>\n</robot>',
)

UNNAMED_ELEMENT = Rule(
    code="ROB006",
    name="unnamed-element",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A link, joint, material, model or shape has no name.",
    why="Joints, transforms and plugins refer to parts by name. Gazebo's parser refuses a part "
    "without a name, or drops the elements that follow it.",
    example="<link/>",
    instead='<link name="base_link"/>',
)

SELF_JOINT = Rule(
    code="ROB012",
    name="self-joint",
    severity=Severity.ERROR,
    measured=Measured(classic="crashes", sim="crashes"),
    summary="A joint connects a link to itself.",
    why="Gazebo's parser crashes: parent and child must be different links.",
    example='<joint name="arm_joint" type="fixed">\n'
    '  <parent link="arm"/>\n'
    '  <child link="arm"/>\n'
    "</joint>",
    instead='<joint name="arm_joint" type="fixed">\n'
    '  <parent link="base_link"/>\n'
    '  <child link="arm"/>\n'
    "</joint>",
)

UNKNOWN_LINK = Rule(
    code="ROB013",
    name="unknown-link",
    severity=Severity.ERROR,
    severity_varies="information from `wsgen check` in a xacro file that no other file includes",
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A joint names a link that does not exist.",
    why="Gazebo refuses the robot. Usually the name is misspelled, or lacks the prefix of a xacro "
    "macro.",
    example='<link name="base_link"/>\n'
    '<link name="arm"/>\n'
    '<joint name="arm_joint" type="fixed">\n'
    '  <parent link="base"/>\n'
    '  <child link="arm"/>\n'
    "</joint>",
    instead='<link name="base_link"/>\n'
    '<link name="arm"/>\n'
    '<joint name="arm_joint" type="fixed">\n'
    '  <parent link="base_link"/>\n'
    '  <child link="arm"/>\n'
    "</joint>",
)

UNKNOWN_JOINT_TYPE = Rule(
    code="ROB015",
    name="unknown-joint-type",
    severity=Severity.ERROR,
    measured=Measured(classic="refuses it", sim="refuses it"),
    summary="A joint has an unknown type.",
    why="Gazebo refuses the robot. `floating` and `planar` exist in URDF only; `ball`, "
    "`universal` and `screw` in SDF only.",
    example='<joint name="arm_joint" type="rotating">',
    instead='<joint name="arm_joint" type="revolute">',
)

NOT_A_NUMBER = Rule(
    code="ROB016",
    name="not-a-number",
    severity=Severity.ERROR,
    severity_varies="a warning in the color of a URDF, which Gazebo ignores",
    measured=Measured(classic="loads nothing of it", sim="refuses it"),
    summary="A number is missing or is not a number.",
    what="Numbers must be finite, have a decimal point, be separated by blanks, and have the count "
    "that the attribute or element requires.",
    why="Gazebo refuses the robot or ignores the element. Other programs silently read 0, so that "
    "the same file gives different robots.",
    example='<origin xyz="0,1 0 0"/>',
    instead='<origin xyz="0.1 0 0"/>',
)

ZERO_AXIS = Rule(
    code="ROB018",
    name="zero-axis",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates another robot", sim="refuses it"),
    summary="The axis of a joint has length 0.",
    why="Gazebo refuses the robot: the joint has no direction of motion.",
    example='<axis xyz="0 0 0"/>',
    instead='<axis xyz="0 0 1"/>',
)

NEGATIVE_MASS = Rule(
    code="ROB022",
    name="negative-mass",
    severity=Severity.ERROR,
    measured=Measured(classic="simulates another robot", sim="refuses it"),
    summary="A mass is negative.",
    why="Gazebo drops the link or refuses the robot.",
    example='<mass value="-1"/>',
    instead='<mass value="1"/>',
)

SWAPPED_LIMITS = Rule(
    code="ROB023",
    name="swapped-limits",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="The lower limit of a joint is above the upper limit.",
    why="Gazebo and wsgen swap such limits; other programs treat the joint as one without limits.",
    example='<limit lower="1" upper="-1" effort="10" velocity="1"/>',
    instead='<limit lower="-1" upper="1" effort="10" velocity="1"/>',
)

NO_SHAPE = Rule(
    code="ROB024",
    name="no-shape",
    severity=Severity.ERROR,
    severity_varies="a warning in SDF, where Gazebo ignores the shape",
    measured=Measured(classic="simulates what is left", sim="accepts it"),
    summary="A `<geometry>` does not have a known shape.",
    why="Gazebo's URDF parser stops reading the link there and silently drops its remaining "
    "elements.",
    example='<geometry>\n  <cube size="1 1 1"/>\n</geometry>',
    instead='<geometry>\n  <box size="1 1 1"/>\n</geometry>',
)

ZERO_SIZE = Rule(
    code="ROB028",
    name="zero-size",
    severity=Severity.ERROR,
    severity_varies="a warning in Gazebo Classic, which simulates the robot, for a `<visual>` of a "
    "URDF, for the `<size>` of a plane, and for a flat box, which most builds of Gazebo accept",
    measured=Measured(classic="simulates what is left", sim="accepts it"),
    summary="A size or scale is not greater than 0.",
    what="Checks lengths, radii and scales of shapes and meshes. A negative scale mirrors a mesh.",
    why="The physics engine of Gazebo Sim terminates the program on a collision of size 0; in "
    "Gazebo Classic it does not collide. A visual of size 0 is invisible.",
    example='<cylinder radius="0" length="0.1"/>',
    instead='<cylinder radius="0.05" length="0.1"/>',
)
MIRRORED_MESH = Rule(
    code="ROB151",
    name="mirrored-collision-mesh",
    severity=Severity.ERROR,
    severity_varies="a warning in Gazebo Classic, which simulates it",
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="The scale of a collision mesh is negative: the mesh is mirrored.",
    why="The physics engine of Gazebo Sim terminates the program on a mirrored mesh. A visual may "
    "be mirrored.",
    example='<collision>\n  <geometry>\n    <mesh filename="package://my_robot/meshes/hand.stl" '
    'scale="1 -1 1"/>\n  </geometry>\n</collision>',
    instead="<collision>\n  <geometry>\n    <mesh "
    'filename="package://my_robot/meshes/hand_mirrored.stl"/>\n  </geometry>\n</collision>',
)
MIRROR_IT = (
    "Mirror the mesh in its file, for example in Blender, and write a positive scale: Gazebo Sim's "
    "physics engine terminates on a mirrored one."
)
MAKE_IT_THICK = (  # a flat box
    "Make it 1 mm thick: Gazebo builds with assertions, such as Debian's, terminate on a flat box."
)

ONE_NAME_FOR_LINK_AND_JOINT = Rule(
    code="ROB034",
    name="one-name-for-link-and-joint",
    severity=Severity.WARNING,
    severity_varies="an error in Gazebo Sim, which refuses the robot",
    measured=Measured(classic="simulates it", sim="refuses it"),
    summary="A link and a joint have the same name.",
    why="Links, joints and frames share one namespace since SDF 1.7: Gazebo Sim refuses the "
    "robot. Gazebo Classic loads it.",
    example='<link name="arm"/>\n<joint name="arm" type="revolute">',
    instead='<link name="arm"/>\n<joint name="arm_joint" type="revolute">',
)

UNKNOWN_MIMICKED_JOINT = Rule(
    code="ROB035",
    name="unknown-mimicked-joint",
    severity=Severity.ERROR,
    severity_varies="a warning in a URDF, where the joint moves independently",
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="A joint mimics a joint that does not exist.",
    why="The joint is not driven: it swings freely instead of following another joint.",
    example='<joint name="right_finger_joint" type="prismatic">\n  …\n'
    '  <mimic joint="finger_joint"/>\n'
    "</joint>",
    instead='<joint name="right_finger_joint" type="prismatic">\n  …\n'
    '  <mimic joint="left_finger_joint"/>\n'
    "</joint>",
)

IMPOSSIBLE_INERTIA = Rule(
    code="ROB037",
    name="impossible-inertia",
    severity=Severity.ERROR,
    severity_varies="a warning where Gazebo still loads the robot: in Gazebo Classic, or where the "
    "link of a URDF is lumped into another one, or its inertia is zero",
    measured=Measured(classic="simulates it", sim="refuses it"),
    summary="The inertia of a link is physically impossible.",
    what="The principal moments must be positive, and none may be larger than the sum of the "
    "other two.",
    why="Gazebo Sim refuses the robot; in physics engines it spins or explodes. Gazebo Classic "
    "takes 1 kg m² about each axis where the moments are not positive. For links that are "
    "fixed together, only the sum matters.",
    example='<inertia ixx="1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>',
    instead='<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>',
)

MISSPELLED_ELEMENT = Rule(
    code="ROB038",
    name="misspelled-element",
    severity=Severity.WARNING,
    severity_varies="an error where Gazebo then refuses the robot",
    measured=Measured(classic="simulates what is left", sim="accepts it"),
    summary="The name of an element is misspelled.",
    why=("Gazebo silently ignores unknown elements: a mass, a shape or a limit is then missing."),
    example='<inertail>\n  <mass value="1"/>\n'
    '  <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>\n</inertail>',
    instead='<inertial>\n  <mass value="1"/>\n'
    '  <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>\n</inertial>',
)

RESERVED_NAME = Rule(
    code="ROB043",
    name="reserved-name",
    severity=Severity.ERROR,
    severity_varies="a warning in Gazebo Classic, which loads the robot",
    measured=Measured(classic="simulates it", sim="refuses it"),
    summary="A name is reserved by SDF.",
    why="SDF reserves `world` and names that begin and end with two underscores; Gazebo Sim "
    "refuses robots that use them. A link `world` is allowed as the root of a URDF, which it "
    "fixes to the world.",
    example='<link name="__base__"/>',
    instead='<link name="base_link"/>',
)

NOT_UTF_8 = Rule(
    code="ROB057",
    name="not-utf-8",
    severity=Severity.ERROR,
    severity_varies="a warning where only a few characters are wrong",
    summary="A URDF or SDF file is not encoded in UTF-8.",
    why="Gazebo and robot_state_publisher read UTF-8 only, whatever the XML declaration says. "
    "Files in UTF-16 or with null bytes cannot be read; in others, letters such as ä are wrong.",
    example="A robot.urdf that an editor saved as ISO-8859-1 or UTF-16.",
    instead="iconv -f ISO-8859-1 -t UTF-8 robot.urdf > robot_utf8.urdf",
)

MISSING_COLLISION_MESH = Rule(
    code="ROB060",
    name="missing-collision-mesh",
    severity=Severity.ERROR,
    severity_varies="a warning from `wsgen check` where the mesh belongs to a model, which may be "
    "elsewhere; information where the mesh is on the network",
    measured=Measured(classic="simulates what is left", sim="accepts it"),
    summary="The mesh file of a `<collision>` does not exist.",
    why="Without its mesh the link does not collide: Gazebo prints an error and continues. A file "
    "in the source folder must also be installed.",
    example="<collision>\n"
    "  <geometry>\n"
    '    <mesh filename="package://my_robot/mesh/arm.stl"/>\n'
    "  </geometry>\n"
    "</collision>",
    instead="<collision>\n"
    "  <geometry>\n"
    '    <mesh filename="package://my_robot/meshes/arm.stl"/>\n'
    "  </geometry>\n"
    "</collision>",
)

MISSING_VISUAL_MESH = Rule(
    code="ROB061",
    name="missing-visual-mesh",
    severity=Severity.WARNING,
    measured=Measured(classic="simulates it", sim="accepts it"),
    summary="The mesh file of a `<visual>` does not exist.",
    why="The link is invisible: Gazebo prints an error and continues. A file in the source folder "
    "must also be installed.",
    example="<visual>\n"
    "  <geometry>\n"
    '    <mesh filename="package://my_robot/mesh/arm.dae"/>\n'
    "  </geometry>\n"
    "</visual>",
    instead="<visual>\n"
    "  <geometry>\n"
    '    <mesh filename="package://my_robot/meshes/arm.dae"/>\n'
    "  </geometry>\n"
    "</visual>",
)

UNREADABLE_DESCRIPTION = Rule(
    code="ROB072",
    name="unreadable-description",
    severity=Severity.ERROR,
    summary="A URDF, xacro or SDF file cannot be read.",
    why="The file does not exist, is not a regular file, or its permissions do not allow "
    "reading it. It cannot be checked or spawned.",
    example="chmod 000 robot.urdf\nwsgen validate robot.urdf",
    instead="chmod 644 robot.urdf\nwsgen validate robot.urdf",
)

MISSPELLED_ATTRIBUTE = Rule(
    code="ROB077",
    name="misspelled-attribute",
    severity=Severity.WARNING,
    severity_varies="an error where Gazebo then refuses the robot",
    measured=Measured(classic="loads nothing of it", sim="refuses it"),
    summary="The name of an attribute is misspelled.",
    why=("Gazebo silently ignores unknown attributes, and uses the default value instead."),
    example='<origin xzy="0 0 1"/>',
    instead='<origin xyz="0 0 1"/>',
)
