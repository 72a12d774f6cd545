"""Rules about descriptions of robots that hold for URDF and for SDF."""

from __future__ import annotations

from wsgen.diagnostics import Rule, Severity

MALFORMED_XML = Rule(
    code="ROB001",
    name="malformed-xml",
    severity=Severity.ERROR,
    summary="A URDF or SDF file is not well-formed XML.",
    why="",
    example="",
    instead="",
)

OVERSIZED_FILE = Rule(
    code="ROB002",
    name="oversized-file",
    severity=Severity.ERROR,
    summary="A URDF or SDF file is too large.",
    why="",
    example="",
    instead="",
)

NO_LINK = Rule(
    code="ROB005",
    name="no-link",
    severity=Severity.ERROR,
    summary="A robot or a model that can move has no link.",
    why="",
    example="",
    instead="",
)

UNNAMED_ELEMENT = Rule(
    code="ROB006",
    name="unnamed-element",
    severity=Severity.ERROR,
    summary="A link, joint, material, model or shape has no name.",
    why="",
    example="",
    instead="",
)

SELF_JOINT = Rule(
    code="ROB012",
    name="self-joint",
    severity=Severity.ERROR,
    summary="A joint connects a link to itself.",
    why="",
    example="",
    instead="",
)

UNKNOWN_LINK = Rule(
    code="ROB013",
    name="unknown-link",
    severity=Severity.ERROR,
    summary="A joint names a link that does not exist.",
    why="",
    example="",
    instead="",
)

UNKNOWN_JOINT_TYPE = Rule(
    code="ROB015",
    name="unknown-joint-type",
    severity=Severity.ERROR,
    summary="A joint has an unknown type.",
    why="",
    example="",
    instead="",
)

NOT_A_NUMBER = Rule(
    code="ROB016",
    name="not-a-number",
    severity=Severity.ERROR,
    summary="A number is missing or is not a number.",
    why="",
    example="",
    instead="",
)

ZERO_AXIS = Rule(
    code="ROB018",
    name="zero-axis",
    severity=Severity.ERROR,
    summary="The axis of a joint has length 0.",
    why="",
    example="",
    instead="",
)

NEGATIVE_MASS = Rule(
    code="ROB022",
    name="negative-mass",
    severity=Severity.ERROR,
    summary="A mass is negative.",
    why="",
    example="",
    instead="",
)

SWAPPED_LIMITS = Rule(
    code="ROB023",
    name="swapped-limits",
    severity=Severity.ERROR,
    summary="The lower limit of a joint is above the upper limit.",
    why="",
    example="",
    instead="",
)

NO_SHAPE = Rule(
    code="ROB024",
    name="no-shape",
    severity=Severity.ERROR,
    summary="A <geometry> has no known shape.",
    why="",
    example="",
    instead="",
)

ZERO_SIZE = Rule(
    code="ROB028",
    name="zero-size",
    severity=Severity.ERROR,
    summary="A size or scale is not greater than 0.",
    why="",
    example="",
    instead="",
)

ONE_NAME_FOR_LINK_AND_JOINT = Rule(
    code="ROB034",
    name="one-name-for-link-and-joint",
    severity=Severity.WARNING,
    summary="A link and a joint have the same name.",
    why="",
    example="",
    instead="",
)

UNKNOWN_MIMICKED_JOINT = Rule(
    code="ROB035",
    name="unknown-mimicked-joint",
    severity=Severity.ERROR,
    summary="A joint mimics a joint that does not exist.",
    why="",
    example="",
    instead="",
)

IMPOSSIBLE_INERTIA = Rule(
    code="ROB037",
    name="impossible-inertia",
    severity=Severity.ERROR,
    summary="No body can have the inertia of a link.",
    why="",
    example="",
    instead="",
)

MISSPELLED_ELEMENT = Rule(
    code="ROB038",
    name="misspelled-element",
    severity=Severity.WARNING,
    summary="The name of an element is nearly that of one that Gazebo reads.",
    why="",
    example="",
    instead="",
)

RESERVED_NAME = Rule(
    code="ROB043",
    name="reserved-name",
    severity=Severity.ERROR,
    summary="A name is reserved by SDF.",
    why="",
    example="",
    instead="",
)

NOT_UTF_8 = Rule(
    code="ROB057",
    name="not-utf-8",
    severity=Severity.ERROR,
    summary="A URDF or SDF file is not encoded in UTF-8.",
    why="",
    example="",
    instead="",
)

MISSING_COLLISION_MESH = Rule(
    code="ROB060",
    name="missing-collision-mesh",
    severity=Severity.ERROR,
    summary="The mesh file of a <collision> does not exist.",
    why="",
    example="",
    instead="",
)

MISSING_VISUAL_MESH = Rule(
    code="ROB061",
    name="missing-visual-mesh",
    severity=Severity.WARNING,
    summary="The mesh file of a <visual> does not exist.",
    why="",
    example="",
    instead="",
)

UNREADABLE_DESCRIPTION = Rule(
    code="ROB072",
    name="unreadable-description",
    severity=Severity.ERROR,
    summary="A URDF, xacro or SDF file cannot be read.",
    why="",
    example="",
    instead="",
)

MISSPELLED_ATTRIBUTE = Rule(
    code="ROB077",
    name="misspelled-attribute",
    severity=Severity.WARNING,
    summary="The name of an attribute is nearly that of one that Gazebo reads.",
    why="",
    example="",
    instead="",
)
