"""Every code that wsgen gives a finding, with its name. A code is never used for something else.

The name reads after "allow": `allow = ["massless-root"]` in a package's `wsgen.toml` silences a
warning. `docs/rules.md` is written from this list.

What a package has on purpose is not told again.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.suggestions import did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path


class Rule(NamedTuple):
    """A kind of finding."""

    code: str
    name: str
    summary: str  # what is the case when it is found


# fmt: off
RULES = (
    # package.xml and what belongs to the package as a whole
    Rule("PKG001", "malformed-manifest", "package.xml is not well-formed XML."),
    Rule("PKG002", "unreadable-manifest", "package.xml cannot be read."),
    Rule("PKG003", "foreign-manifest", "package.xml is of something else than ROS."),
    Rule("PKG004", "unnamed-package", "package.xml gives the package no name."),
    Rule("PKG005", "invalid-manifest", "catkin_pkg refuses package.xml."),
    Rule("PKG006", "questionable-manifest", "catkin_pkg warns about package.xml."),
    Rule("PKG007", "duplicate-package", "Two packages of the workspace have one name."),
    Rule("PKG008", "unknown-build-type", "colcon has no such build type."),
    Rule("PKG009", "missing-build-type", "An ament package gives no build type."),
    Rule("PKG010", "missing-manifest", "There is no package.xml where one is needed."),
    Rule("PKG050", "uninstalled-launch-file", "The launch file is not installed."),
    Rule("PKG051", "no-launch-file", "The package has no launch file."),
    Rule("PKG052", "changed-since-build", "A file was changed and not built since."),
    Rule("PKG053", "not-built", "A package that spawns a robot is not installed."),
    Rule("PKG054", "several-launch-files", "It is not clear which launch file is meant."),
    Rule("PKG060", "invalid-settings", "wsgen.toml cannot be used."),
    Rule("PKG061", "unknown-rule-allowed", "wsgen.toml allows a rule that does not exist."),
    # the build
    Rule("BLD001", "tests-left-out", "Lint tests need a package that is not on this machine."),
    Rule("BLD002", "ament-cmake-not-found", "CMake does not find ament_cmake."),
    Rule("BLD003", "missing-installed-path", "install() names a path that does not exist."),
    Rule("BLD004", "wrong-python", "CMake took a Python without the modules of the build."),
    Rule("BLD005", "unsupported-empy", "empy 4 is installed; colcon and ament need empy 3."),
    Rule("BLD006", "missing-compiler", "project() asks for a compiler that is not there."),
    Rule("BLD007", "missing-cmake", "There is no cmake."),
    Rule("BLD008", "missing-dependency", "find_package() asks for a package that is not there."),
    Rule("BLD009", "repeated-ament-package", "ament_package() is called more than once."),
    Rule("BLD010", "missing-ament-package", "ament_package() is missing."),
    Rule("BLD011", "cmake-syntax", "CMake cannot read a line of CMakeLists.txt."),
    Rule("BLD012", "old-cmake-minimum", "cmake_minimum_required() is too old for this CMake."),
    Rule("BLD013", "old-cmake", "CMake is older than the package asks for."),
    Rule("BLD014", "missing-build-program", "There is neither make nor ninja."),
    Rule("BLD015", "unexplained-cmake-error", "CMake stopped; wsgen does not know the reason."),
    Rule("BLD016", "unexplained-failure", "The build failed; wsgen does not know the reason."),
    Rule("BLD017", "other-install-layout", "The install space was made with another layout."),
    Rule("BLD018", "other-build-tool", "The build folder is of another tool than colcon."),
    Rule("BLD019", "unbuilt-dependency", "A package was not built, as one that it needs failed."),
    Rule("BLD020", "colcon-failure", "colcon itself failed."),
    Rule("BLD021", "missing-cmake-file", "The package has no CMakeLists.txt."),
    Rule("BLD023", "passed-over", "colcon did not build a package that was asked for."),
    Rule("BLD024", "stale-files", "Installed files are left that nothing installs any more."),
    Rule("BLD025", "moved-workspace", "The workspace was built in another place."),
    Rule("BLD026", "moved-package", "The package was built from another folder."),
    Rule("BLD027", "unknown-command", "CMake knows no command of this name."),
    Rule("BLD028", "missing-destination", "install() does not say where to."),
    Rule("BLD029", "different-names", "package.xml and project() give different names."),
    Rule("BLD030", "deprecated-cmake-minimum", "cmake_minimum_required() will soon be too old."),
    # the launch file
    Rule("LCH001", "launch-syntax", "The launch file is not Python."),
    Rule("LCH002", "launch-import", "The launch file imports something that is not there."),
    Rule("LCH003", "no-launch-function", "generate_launch_description is missing."),
    Rule("LCH004", "launch-raises", "The launch file raises an exception."),
    Rule("LCH005", "file-not-installed", "The launch file reads a file that is not installed."),
    Rule("LCH006", "argument-without-value", "A launch argument has neither default nor value."),
    Rule("LCH007", "package-not-found", "A package that is looked up is not there."),
    Rule("LCH008", "xacro-fails", "xacro cannot expand the model."),
    Rule("LCH009", "undefined-configuration", "A launch configuration is used before it is set."),
    Rule("LCH010", "refused-by-launch", "launch would refuse what the file gives it."),
    Rule("LCH011", "interactive-input", "The launch file waits for somebody to type."),
    Rule("LCH012", "launch-takes-too-long", "Evaluating the launch file does not end."),
    Rule("LCH013", "launch-dies", "Evaluating the launch file ended the process."),
    Rule("LCH014", "launch-exits", "The launch file calls exit()."),
    Rule("LCH015", "description-not-yaml", "A robot description read as YAML is none."),
    Rule("LCH016", "description-as-yaml", "A robot description is read as YAML by luck."),
    Rule("LCH017", "unsupported-launch-api", "wsgen does not know something of the launch API."),
    Rule("LCH018", "launch-not-readable", "The launch file cannot be read."),
    Rule("LCH019", "parameter-file-missing", "A file of parameters does not exist."),
    Rule("LCH020", "variable-not-set", "An environment variable that is read is not set."),
    Rule("LCH021", "executable-not-found", "A program that is looked up is not on PATH."),
    Rule("LCH022", "old-keyword", "A keyword argument was renamed after ROS 2 Foxy."),
    Rule("LCH023", "launch-markup", "The launch file is not well-formed XML or YAML."),
    Rule("LCH024", "launch-needs-unknown", "The launch file needs a value that only ROS knows."),
    Rule("LCH025", "launch-forks", "The launch file forks."),
    Rule("LCH030", "undefined-name", "The launch file uses a name that it does not define."),
    Rule("LCH031", "wrong-keyword", "A keyword argument is misspelt or does not exist."),
    Rule("LCH032", "launch-encoding", "The launch file is not in UTF-8."),
    Rule("LCH033", "unused-argument", "Nobody uses a launch argument that is given."),
    Rule("LCH034", "unused-include-argument", "An included launch file ignores an argument."),
    Rule("LCH035", "unused-xacro-argument", "The xacro file ignores an argument that is given."),
    # the robot description
    Rule("ROB001", "malformed-description", "The URDF is not well-formed XML."),
    Rule("ROB002", "oversized-description", "The URDF is huge or declares entities."),
    Rule("ROB003", "not-a-robot", "The root element is not <robot>."),
    Rule("ROB004", "unnamed-robot", "The robot has no name."),
    Rule("ROB005", "no-link", "The robot has no link."),
    Rule("ROB006", "unnamed-part", "A link, joint or material has no name."),
    Rule("ROB007", "duplicate-link", "Two links have one name."),
    Rule("ROB008", "duplicate-joint", "Two joints have one name."),
    Rule("ROB009", "several-roots", "More than one link has no parent."),
    Rule("ROB010", "link-cycle", "The links go in a circle."),
    Rule("ROB011", "two-parents", "A link is the child of two joints."),
    Rule("ROB012", "self-joint", "A joint joins a link to itself."),
    Rule("ROB013", "unknown-link", "A joint names a link that does not exist."),
    Rule("ROB014", "incomplete-joint", "A joint has no parent or child, or mimics nothing."),
    Rule("ROB015", "unknown-joint-type", "A joint is of no known type."),
    Rule("ROB016", "not-a-number", "A number is missing or is none."),
    Rule("ROB017", "unexpanded-xacro", "Something of xacro is left in the URDF."),
    Rule("ROB018", "zero-axis", "The axis of a joint has no direction."),
    Rule("ROB019", "long-axis", "The axis of a joint is not of length 1."),
    Rule("ROB020", "missing-limit", "A joint that needs <limit> has none."),
    Rule("ROB021", "incomplete-inertial", "<inertial> lacks mass or inertia."),
    Rule("ROB022", "negative-mass", "A mass is negative."),
    Rule("ROB023", "swapped-limits", "The lower limit of a joint is above the upper one."),
    Rule("ROB024", "no-shape", "A geometry has no known shape."),
    Rule("ROB025", "undefined-material", "A material is used and not defined."),
    Rule("ROB026", "two-colored-material", "A material is defined with two colors."),
    Rule("ROB027", "color-out-of-range", "A color is not between 0 and 1."),
    Rule("ROB028", "zero-size", "A size or scale is not greater than 0."),
    Rule("ROB029", "unnamed-mesh", "A mesh has no file name."),
    Rule("ROB030", "unknown-reference", "A <gazebo> element is about no link or joint."),
    Rule("ROB031", "gazebo-not-a-number", "A number in a <gazebo> element is none: Gazebo ends."),
    Rule("ROB032", "unknown-gazebo-material", "Gazebo has no material of this name."),
    Rule("ROB033", "misplaced-gazebo-element", "An element of <gazebo> is where it does nothing."),
    Rule("ROB034", "one-name-for-link-and-joint", "A link and a joint have one name."),
    Rule("ROB035", "unknown-mimicked-joint", "A joint mimics one that does not exist."),
    Rule("ROB036", "mimic-cycle", "A joint mimics itself."),
    Rule("ROB037", "impossible-inertia", "No body has the inertia of a link, or it has none."),
    Rule("ROB038", "misspelt-element", "An element is nearly called as one that Gazebo reads."),
    Rule("ROB040", "dropped-link", "Gazebo leaves a link out, with all that hangs on it."),
    Rule("ROB041", "two-zero-masses", "Two links of mass 0 are fixed together."),
    Rule("ROB042", "impossible-sum", "Links fixed together have an impossible inertia."),
    Rule("ROB043", "name-kept-by-sdf", "A name is one that SDF keeps for itself."),
    Rule("ROB045", "gazebo-not-a-truth-value", "A flag of <gazebo> is neither true nor false."),
    Rule("ROB046", "gazebo-value-without-effect", "Gazebo gives a value to no collision."),
    Rule("ROB047", "unknown-urdf-version", "The version of the URDF is not 1.0."),
    Rule("ROB048", "implausible-size", "The robot is absurdly large or small."),
    Rule("ROB049", "implausible-mass", "The robot or a part has an absurd mass."),
    Rule("ROB050", "implausible-inertia", "An inertia does not suit the link's mass and shape."),
    Rule("ROB051", "massless-root", "The root link has no mass; Gazebo calls the robot's body so."),
    Rule("ROB052", "ros-1-plugin", "A plugin exists in no ROS 2 release."),
    Rule("ROB053", "nothing-to-touch", "No link has a <collision>."),
    Rule("ROB054", "nothing-to-see", "A link can be touched and not be seen."),
    Rule("ROB055", "loose-joint", "Gazebo has no joints of this type: a part falls off."),
    Rule("ROB056", "number-beyond-engines", "A number is too large for any physics engine."),
    Rule("ROB057", "not-utf-8", "The file is not in UTF-8."),
    Rule("ROB058", "sdf-not-simulated", "SDF in a <gazebo> element is not part of the simulation."),
    Rule("ROB059", "repeated-material", "A material is defined twice for the whole robot."),
    Rule("ROB060", "missing-collision-mesh", "The mesh of a collision is not there."),
    Rule("ROB061", "missing-visual-mesh", "The mesh of a visual is not there."),
    Rule("ROB062", "broken-collision-mesh", "The mesh of a collision cannot be used."),
    Rule("ROB063", "broken-visual-mesh", "The mesh of a visual cannot be used; it is left out."),
    Rule("ROB064", "heavy-mesh", "A mesh has so many triangles that it is slow to load."),
    Rule("ROB065", "enormous-mesh", "A mesh is too large to be tried."),
    Rule("ROB066", "implausible-mesh-size", "A mesh is absurdly large or small."),
    Rule("ROB067", "inconsistent-mesh", "A mesh is not what it says it is; Gazebo reads it."),
    Rule("ROB068", "mesh-format-not-read-by-all", "Some Gazebo does not read the mesh's format."),
    Rule("ROB070", "starts-outside-limits", "A joint is spawned outside of its limits."),
    Rule("ROB071", "xacro-file-fails", "xacro cannot expand the file."),
    Rule("ROB072", "unreadable-robot-file", "The robot description cannot be read."),
    # the world
    Rule("ROB073", "missing-texture", "A texture of a mesh is not there."),
    Rule("ROB074", "unusable-texture", "A texture of a mesh is broken or too large."),
    Rule("ROB075", "missing-material-library", "The .mtl file of an OBJ cannot be read."),
    Rule("ROB076", "missing-effect", "A COLLADA material names an effect that is not there."),
    Rule("ROB077", "misspelt-attribute", "An attribute is nearly called as one that Gazebo reads."),
    Rule("ROB078", "unknown-end-of-sdf-joint", "A joint of SDF in <gazebo> names no link."),
    Rule("ROB079", "lumped-end-of-sdf-joint", "A joint of SDF in <gazebo> names a lumped link."),
    Rule("ROB080", "dropped-by-old-sdformat", "Older versions drop what a massless link carries."),
    Rule("WLD001", "unreadable-world", "The world file cannot be read."),
    Rule("WLD002", "malformed-world", "The world file is not well-formed XML."),
    Rule("WLD003", "no-world", "The file holds no <world>."),
    Rule("WLD004", "model-left-out", "A model of the world is not part of the simulation."),
    Rule("WLD005", "world-not-a-number", "A number in the world file is none."),
    Rule("WLD006", "no-ground", "The world has no ground plane."),
    Rule("WLD007", "impossible-step", "The physics step is not positive, or too long."),
    Rule("WLD008", "own-world-of-simulator", "The world is one that the simulator brings along."),
    Rule("WLD010", "oversized-world", "The SDF file is huge."),
    Rule("WLD011", "no-sdf-version", "<sdf> says no version, or one that is none."),
    Rule("WLD012", "unknown-sdf-version", "The version of SDF is newer or older than wsgen knows."),
    Rule("WLD013", "unnamed-sdf-element", "A world, model, link, joint or shape has no name."),
    Rule("WLD014", "endless-models", "Models are nested too deep, or are too many."),
    Rule("WLD015", "duplicate-sdf-name", "Two things in one world, model or link have one name."),
    Rule("WLD016", "unknown-frame", "A frame is named that does not exist."),
    Rule("WLD017", "frame-cycle", "A frame is placed relative to itself."),
    Rule("WLD018", "reserved-name", "A name is reserved by SDF, or has :: in it."),
    Rule("WLD019", "include-cycle", "A model includes itself."),
    Rule("WLD020", "frame-ignored", "A shape or inertia is in another frame than its link."),
    Rule("WLD021", "unknown-joint-end", "The parent or child of a joint is missing or no link."),
    Rule("WLD022", "joint-to-itself", "A joint of a model joins a link to itself."),
    Rule("WLD023", "unknown-sdf-joint-type", "A joint of a model is of no type that SDF has."),
    Rule("WLD024", "joint-left-out", "A joint is of a type that no engine of wsgen has."),
    Rule("WLD025", "closed-chain", "A joint closes a chain; the simulation leaves it out."),
    Rule("WLD026", "axis-without-direction", "The axis of a joint of a model has no direction."),
    Rule("WLD027", "exchanged-limits", "The lower limit of a joint is above its upper one."),
    Rule("WLD028", "unknown-leader", "A joint of a model mimics no other joint."),
    Rule("WLD029", "model-without-link", "A model that is not static has no link."),
    Rule("WLD030", "shapeless", "A visual or collision of a model has no known shape."),
    Rule("WLD031", "shape-left-out", "A shape is left out: no engine of wsgen has it."),
    Rule("WLD032", "missing-model-collision-mesh", "The mesh of a model's collision is not there."),
    Rule("WLD033", "missing-model-visual-mesh", "The mesh of a visual of a model is not there."),
    Rule("WLD034", "impossible-size", "A size or scale in a model is not positive, or absurd."),
    Rule("WLD035", "default-inertia", "A link of a model has no <inertial>: Gazebo gives it 1 kg."),
    Rule("WLD036", "negative-model-mass", "The mass of a link of a model is negative."),
    Rule("WLD037", "impossible-model-inertia", "No body has the inertia of a link of a model."),
    Rule("WLD038", "several-models", "The file holds several worlds or models; one is read."),
    Rule("WLD039", "joint-called-as-link", "A joint of a model has the name of a link or frame."),
    Rule("WLD040", "inertia-of-mesh", "An inertia is to be computed from a mesh."),
    Rule("WLD041", "massless-model-link", "A link that can move has mass 0."),
    Rule("WLD042", "nothing-to-try", "The file holds no model to try."),
    Rule("WLD043", "spawned-world", "A world is spawned; spawners take models."),
    Rule("WLD044", "shared-part-name", "Two parts of a link have one name; Gazebo loads them."),
    Rule("WLD045", "no-downward-gravity", "Nothing is pulled down in this world."),
    Rule("WLD046", "declared-entities", "The file declares entities of XML and uses them."),
    Rule("WLD047", "world-not-utf-8", "The file is no text in UTF-8."),
    Rule("WLD048", "nested-static-model", "A static model is part of one that moves."),
    Rule("WLD050", "missing-heightmap", "The image of a heightmap is not there."),
    Rule("WLD051", "unusable-heightmap", "The image of a heightmap is broken or enormous."),
    Rule("WLD053", "reduced-heightmap", "The simulation uses fewer pixels of a heightmap."),
    Rule("WLD054", "heightmap-offset", "The <pos> of a heightmap does not move its collision."),
    Rule("WLD055", "heightmap-not-drawn", "A heightmap has not 2^n + 1 pixels a side."),
    Rule("WLD056", "moving-heightmap", "A model with a heightmap is not static."),
    Rule("WLD057", "impossible-solid", "A polyline encloses nothing, or a shape cannot be made."),
    Rule("WLD058", "misspelt-sdf-element", "An element is nearly called as one of SDF."),
    Rule("WLD059", "misspelt-sdf-attribute", "An attribute is nearly called as one of SDF."),
    # spawn and simulation
    Rule("SPN001", "no-simulator", "The launch file starts no simulator."),
    Rule("SPN002", "ros-1-spawner", "The spawner is that of ROS 1."),
    Rule("SPN003", "no-robot", "The launch file spawns no robot."),
    Rule("SPN004", "wrong-spawner-option", "The spawner would refuse its options."),
    Rule("SPN005", "wrong-spawn-pose", "A number of the spawn pose is none."),
    Rule("SPN006", "database-model", "The model is one of Gazebo's own."),
    Rule("SPN007", "no-description-source", "The spawner does not say which robot."),
    Rule("SPN008", "unpublished-description", "Nobody publishes the topic that the spawner reads."),
    Rule("SPN009", "publisher-without-description", "robot_state_publisher gets no description."),
    Rule("SPN010", "missing-spawn-parameter", "The spawner reads a parameter it is not given."),
    Rule("SPN011", "description-is-no-text", "The robot description is no URDF text."),
    Rule("SPN012", "unreadable-description", "The file to spawn cannot be read."),
    Rule("SPN031", "engine-died", "The physics engine crashed, hung or ran out of memory."),
    Rule("SPN032", "engine-refused", "The physics engine does not take the robot."),
    Rule("SPN033", "engine-complained", "The physics engine printed a complaint."),
    Rule("SPN034", "no-picture", "A picture that was asked for could not be made."),
    Rule("SPN035", "too-many-models", "The scene holds more models than a simulation can take."),
    Rule("SPN049", "spawned-twice", "Two robots are spawned under one name."),
    Rule("SPN050", "mass-differs", "The engine simulates another mass than the description gives."),
    Rule("SPN051", "joints-differ", "The engine moves another number of joints."),
    Rule("SPN052", "state-not-finite", "The simulation exploded."),
    Rule("SPN053", "born-inside-the-ground", "The robot is spawned in the ground."),
    Rule("SPN054", "spawned-high", "The robot is spawned more than a meter above the ground."),
    Rule("SPN055", "stuck-in-the-ground", "At the end the robot is in the ground."),
    Rule("SPN056", "falls-without-end", "The robot falls through the ground."),
    Rule("SPN057", "thrown-into-the-air", "The robot is shot up."),
    Rule("SPN058", "keeps-moving", "The robot does not come to rest."),
    Rule("SPN059", "tips-over", "The robot tips over."),
    Rule("SPN060", "joints-give-way", "Nobody drives its joints, and gravity moves them."),
    Rule("SPN061", "gains-energy", "The robot's energy grows from nowhere."),
    Rule("SPN062", "joint-beyond-limit", "At the end a joint is beyond its limit."),
    Rule("SPN063", "robots-in-each-other", "Two robots are spawned inside each other."),
    Rule("SPN064", "links-in-each-other", "Links that may collide start inside each other."),
    Rule("SPN065", "engines-disagree", "Two engines do not agree on the robot."),
    Rule("SPN066", "rests-on-hull", "A mesh rests on its convex hull, where it has no triangle."),
    Rule("SPN070", "no-video", "A video that was asked for could not be made."),
    Rule("SPN071", "coarse-video", "The video has a lower resolution or frame rate."),
    Rule("SPN080", "unclear-behavior-robot", "It is not clear which robot a behavior is for."),
    Rule("SPN081", "no-diff-drive", "A behavior drives a robot without a diff drive plugin."),
    Rule("SPN082", "unusable-diff-drive", "The diff drive plugin would not work."),
    Rule("SPN083", "unknown-behavior-joint", "A behavior moves a joint that takes no commands."),
    Rule("SPN084", "command-beyond-limit", "A behavior sends a joint beyond its limits."),
    Rule("SPN085", "moves-otherwise", "The robot does not get where a behavior says."),
    Rule("SPN086", "turns-otherwise", "The robot does not turn as a behavior says."),
    Rule("SPN087", "joint-not-reached", "A joint is not where a behavior sends it."),
    Rule("SPN088", "behavior-explodes", "The simulation explodes while a behavior is tried."),
    Rule("SPN089", "engine-changed", "PyBullet cannot simulate the robot; DART does."),
    Rule("SPN090", "cut-short", "The simulation ended because another robot exploded."),
    # templates of the user
    Rule("TPL001", "unreadable-template", "template.toml is missing or no TOML."),
    Rule("TPL002", "invalid-template", "template.toml says something that means nothing."),
    Rule("TPL003", "missing-template-source", "A source is missing or outside of its folder."),
    Rule("TPL004", "failing-template", "A source cannot be rendered."),
    Rule("TPL005", "impossible-package-path", "A path cannot be in a package, or one is missing."),
    Rule("TPL006", "malformed-rendered-file", "A rendered file is not what its ending says."),
)
# fmt: on


def without_allowed(
    diagnostics: Iterable[Diagnostic], allow: Sequence[str]
) -> tuple[Diagnostic, ...]:
    """The findings without those whose rule is allowed by name or code; errors always stay."""
    codes = {rule.code for rule in RULES if rule.name in allow or rule.code in allow}
    return tuple(
        found
        for found in diagnostics
        if found.severity is Severity.ERROR or found.code not in codes
    )


def unknown_rule_allowed(allow: Iterable[str], file: Path) -> Iterator[Diagnostic]:
    """A package allows a rule that does not exist.

    ## What it does
    Compares the names in `allow` of `wsgen.toml` with the catalogue.

    ## Why is this bad?
    A misspelt name allows nothing.

    ## Use instead
    The name in the catalogue.
    """
    names = [rule.name for rule in RULES]
    codes = {rule.code for rule in RULES}
    for name in allow:
        if name not in names and name not in codes:
            near = nearest(name, names)
            yield Diagnostic(
                code="PKG061",
                severity=Severity.WARNING,
                message=f"There is no rule {name!r} to allow.",
                file=file,
                element="validate.allow",
                hint=did_you_mean(near) if near else "docs/rules.md lists the names.",
            )
