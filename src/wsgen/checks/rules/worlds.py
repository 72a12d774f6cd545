"""The rules about the world of a simulator: whether it is there, runs, and is seen.

What holds for any SDF file is checked where it is read, in `wsgen.descriptions.sdf`.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.checks.rules.robot_files import WITHOUT_COLOR_NAMES
from wsgen.checks.rules.systems import (
    missing_default_systems,
    missing_sensor_systems,
    needs_of,
    place_of,
    systems_of_world,
    systems_within,
)
from wsgen.descriptions.sdf.includes import FUEL_MODEL, is_ground_plane, is_sun
from wsgen.descriptions.sdf.lookup import EMPTY_WORLDS, gazebo_worlds, world_names
from wsgen.descriptions.sdf.source import line_of, path_of
from wsgen.diagnostics import Rule, Severity
from wsgen.gazebo.systems import is_of_classic, is_of_gz, remark_on
from wsgen.launching.explain_missing import (
    absolute_part,
    first_missing,
    first_missing_path,
    glued_package,
    where_written,
)
from wsgen.launching.known_packages import find_in_package, in_python, package_of
from wsgen.model.facts import DISTROS
from wsgen.model.target import Target
from wsgen.text.suggestions import MOST_LISTED, advice, some_of
from wsgen.text.xmltree import child_text, children

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.plan import LaunchPlan
    from wsgen.packages.workspace.overlay import Overlay
    from wsgen.text.xmltree import Element


PLUGIN_OF_OTHER_SIMULATOR = Rule(
    code="WLD064",
    name="plugin-of-other-simulator",
    severity=Severity.WARNING,
    summary="A plugin of a world does not belong to the simulator that loads the world.",
    what="Compares the plugins of a world with the simulator that a launch file starts with it, or "
    "that package.xml depends on.",
    why="The simulator cannot load the library: it prints an error and continues without the "
    "plugin.",
    example="<!-- loaded by Gazebo Sim -->\n"
    '<plugin name="gazebo_ros_state" filename="libgazebo_ros_state.so"/>',
    instead='<plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>',
)
UNKNOWN_SYSTEM = Rule(
    code="WLD065",
    name="unknown-system",
    severity=Severity.WARNING,
    summary="A `<plugin>` names a library or class that Gazebo Sim does not have.",
    what="Compares the names with those of the systems of Gazebo from Fortress to Jetty. Libraries "
    "with very different names are assumed to be user-defined.",
    why="Gazebo prints that it failed to load the system, and continues without it.",
    example='<plugin filename="gz-sim-imu-system" name="gz::sim::systems::IMU"/>',
    instead='<plugin filename="gz-sim-imu-system" name="gz::sim::systems::Imu"/>',
)
MODEL_OF_CLASSIC = Rule(
    code="WLD067",
    name="model-of-classic",
    severity=Severity.WARNING,
    summary="A world for Gazebo Sim includes the sun or the ground plane of Gazebo Classic.",
    what="Looks for `model://sun` and `model://ground_plane` that are not in a folder of the "
    "package.",
    why="Gazebo Sim does not install these models: it prints that it cannot find the model, and up "
    "to Gazebo Harmonic it does not load the world.",
    example="<include>\n  <uri>model://ground_plane</uri>\n</include>",
    instead='<model name="ground_plane">\n'
    "  <static>true</static>\n"
    '  <link name="link">\n'
    '    <collision name="collision">\n'
    "      <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>\n"
    "    </collision>\n"
    '    <visual name="visual">\n'
    "      <geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>\n"
    "    </visual>\n"
    "  </link>\n"
    "</model>",
)
NO_LIGHT = Rule(
    code="WLD068",
    name="no-light",
    severity=Severity.INFO,
    summary="A world does not have a light.",
    what="Looks for `<light>` and for included models, which may be lights.",
    why="Robots and models are hardly visible in the window, and camera images are dark.",
    example='<world name="w">\n  <gravity>0 0 -9.8</gravity>\n</world>',
    instead='<world name="w">\n'
    '  <light name="sun" type="directional">\n'
    "    <pose>0 0 10 0 0 0</pose>\n"
    "    <direction>-0.5 0.1 -0.9</direction>\n"
    "  </light>\n"
    "</world>",
)
MATERIAL_SCRIPT = Rule(
    code="WLD069",
    name="material-script",
    severity=Severity.INFO,
    summary="A world for Gazebo Sim uses an Ogre material script.",
    what="Looks for `<script>` in materials without a color or `<pbr>`. The names `Gazebo/NAME` "
    "are reported only for Humble and Iron: later releases know them as colors.",
    why="Gazebo Sim does not read Ogre material scripts, and draws the visual in white or gray.",
    example="<material>\n  <script><name>Gazebo/Red</name></script>\n</material>",
    instead="<material>\n  <ambient>1 0 0 1</ambient>\n  <diffuse>1 0 0 1</diffuse>\n</material>",
)
UNUSUAL_RATE = Rule(
    code="WLD070",
    name="not-in-real-time",
    severity=Severity.INFO,
    summary="Gazebo Classic runs a world faster or slower than its real-time factor says.",
    what="Compares the product of `<max_step_size>` and `<real_time_update_rate>` with "
    "`<real_time_factor>`.",
    why="Gazebo Classic ignores `<real_time_factor>`: it simulates as many steps per second as the "
    "update rate says, so that a shorter step slows the simulation down.",
    example="<max_step_size>0.01</max_step_size>\n"
    "<real_time_update_rate>1000</real_time_update_rate>",
    instead="<max_step_size>0.001</max_step_size>\n"
    "<real_time_update_rate>1000</real_time_update_rate>",
)
NEWER_SDF = Rule(
    code="WLD071",
    name="newer-sdf",
    severity=Severity.WARNING,
    summary="The SDF version of a world is newer than Gazebo of the target distribution supports.",
    why="Gazebo prints that it cannot convert the file, and reads it as the newest version that it "
    "knows; newer elements are ignored.",
    example='<!-- for Gazebo Fortress, which reads SDF up to 1.9 -->\n<sdf version="1.12">',
    instead='<sdf version="1.9">',
)

# What another Gazebo than the usual one reads that is released for the distribution: Harmonic.
_NEWEST_BESIDE = {"humble-gz": "1.11"}
CLOSE = 0.02  # of two rates, relative: steps are written with few digits
FASTEST = 1e6  # times real time; what is written as more is no rate


def check_world(  # noqa: PLR0913  facts
    root: Element,
    file: Path,
    *,
    simulator: str | None,
    distro: str | None,
    is_spawned_into: bool,
    has_model: Callable[[str], bool],
) -> Iterator[Diagnostic]:
    """Check the worlds of an SDF file for the simulator that loads them.

    Args:
        root: The `<sdf>` element.
        file: What the diagnostics name.
        simulator: "classic", "gz", or None where that is not known.
        distro: The distribution that the package is for, if that is known.
        is_spawned_into: Whether a launch file of the package spawns a robot into the world: what
            it lacks for that is reported there.
        has_model: Whether the model of an address is on this machine.
    """
    for world in children(root, "world"):
        kind = simulator or simulator_of(world)
        yield from system_names(world, file)
        if kind == "gz":
            if not is_spawned_into:
                yield from missing_systems(world, file, distro)
            yield from plugins_of_other_simulator(world, file, kind)
            yield from models_of_classic(world, file, has_model)
            yield from no_light(world, file)
            yield from material_scripts(world, file, distro)
            if distro in DISTROS:
                yield from newer_sdf(root, file, Target(distro=distro, simulator=kind))
        elif kind == "classic":
            yield from plugins_of_other_simulator(world, file, kind)
            yield from not_in_real_time(world, file)
            yield from newer_sdf(root, file, Target(distro="humble", simulator=kind))
        yield from models_from_network(world, file, has_model)


def simulator_of(world: Element) -> str | None:
    """The simulator that a world is written for, where its plugins show it."""
    plugins = [(one.get("filename") or "", one.get("name") or "") for one in world.iter("plugin")]
    is_gz = any(is_of_gz(*one) for one in plugins)
    is_classic = any(is_of_classic(filename) for filename, _ in plugins)
    if is_gz == is_classic:
        return None
    return "gz" if is_gz else "classic"


def missing_systems(world: Element, file: Path, distro: str | None) -> Iterator[Diagnostic]:
    """Report what a world lacks by itself, whatever is spawned into it."""
    systems = systems_of_world(world, distro, is_lenient=True)
    yield from missing_default_systems(world, file, systems, is_spawned_into=False)
    yield from missing_sensor_systems(
        place_of(world, file),
        systems,
        systems_within(world),
        needs_of(world, distro),
        is_spawned_into=False,
    )


def plugins_of_other_simulator(world: Element, file: Path, simulator: str) -> Iterator[Diagnostic]:
    """Report, in one diagnostic, plugins of Gazebo Classic in a world for Gazebo Sim or reverse."""
    others = []
    for plugin in world.iter("plugin"):
        filename, name = plugin.get("filename") or "", plugin.get("name") or ""
        is_in_window = any(one.tag == "gui" for one in plugin.iterancestors())
        is_other = is_of_classic(filename) if simulator == "gz" else is_of_gz(filename, name)
        if is_other and not is_in_window:
            others.append(plugin)
    if others:
        this, other = "Gazebo Sim", "Gazebo Classic"
        if simulator == "classic":
            this, other = other, this
        names = list(dict.fromkeys(f"`{one.get('filename')}`" for one in others))
        are = "is a plugin" if len(names) == 1 else "are plugins"
        yield PLUGIN_OF_OTHER_SIMULATOR.at(
            file,
            line_of(others[0]),
            path_of(others[0]),
            message=f"{some_of(names)} {are} for {other}, but {this} loads this world.",
            hint=f"Remove {'it' if len(names) == 1 else 'them'}, or use plugins of {this}.",
        )


def system_names(world: Element, file: Path) -> Iterator[Diagnostic]:
    """Report plugins that are meant to be systems of Gazebo Sim, by names that it does not have."""
    for plugin in world.iter("plugin"):
        remark = remark_on(plugin.get("filename") or "", plugin.get("name") or "")
        if remark is not None:
            attribute = "filename" if remark.is_filename else "name"
            yield UNKNOWN_SYSTEM.at(
                file,
                line_of(plugin),
                path_of(plugin),
                message=remark.message,
                hint=f'Write {attribute}="{remark.meant}".',
            )


def models_from_network(
    world: Element, file: Path, has_model: Callable[[str], bool]
) -> Iterator[Diagnostic]:
    """Report, in one diagnostic, the models that Gazebo downloads."""
    includes = [
        (include, uri)
        for include in world.iter("include")
        if (uri := child_text(include, "uri") or "").startswith(("http://", "https://"))
        and not has_model(uri)
    ]
    if includes:
        names = list(dict.fromkeys(uri.rstrip("/").rpartition("/")[2] for _, uri in includes))
        first, _ = includes[0]
        yield FUEL_MODEL.at(
            file,
            line_of(first),
            path_of(first),
            message=f"Gazebo downloads models of this world: {some_of(names)}.",
            hint="Download them once with `gz fuel download -u URI`, or copy their folders into "
            "the package and include model://NAME.",
        )


def models_of_classic(
    world: Element, file: Path, has_model: Callable[[str], bool]
) -> Iterator[Diagnostic]:
    """Report the sun and the ground plane that only Gazebo Classic has."""
    for include in children(world, "include"):
        uri = child_text(include, "uri") or ""
        what = "sun" if is_sun(uri) else "ground plane" if is_ground_plane(uri) else None
        if what is not None and uri.startswith("model://") and not has_model(uri):
            inline = (
                'a `<light type="directional">`' if what == "sun" else "a static model with a plane"
            )
            yield MODEL_OF_CLASSIC.at(
                file,
                line_of(include),
                path_of(include),
                message=f"Gazebo Sim does not have `{uri}`: only Gazebo Classic installs that "
                f"{what}.",
                hint=f"Replace the include by {inline}.",
            )


def no_light(world: Element, file: Path) -> Iterator[Diagnostic]:
    """Report a world without light."""
    has_light = next(world.iter("light"), None) is not None
    if not has_light and next(world.iter("include"), None) is None:
        yield NO_LIGHT.at(
            file,
            line_of(world),
            path_of(world),
            message="The world does not have a light.",
            hint='Add <light name="sun" type="directional"><pose>0 0 10 0 0 0</pose>'
            "<direction>-0.5 0.1 -0.9</direction></light>",
        )


def material_scripts(world: Element, file: Path, distro: str | None) -> Iterator[Diagnostic]:
    """Report, in one diagnostic, the materials that are Ogre scripts and nothing else."""
    scripts = []
    for material in world.iter("material"):
        script = next(children(material, "script"), None)
        if (
            script is None
            or next(children(material, "ambient", "diffuse", "pbr"), None) is not None
        ):
            continue
        name = child_text(script, "name") or ""
        if distro in WITHOUT_COLOR_NAMES or not name.startswith("Gazebo/"):
            scripts.append((material, name))
    if scripts:
        names = list(dict.fromkeys(name for _, name in scripts if name))
        first, _ = scripts[0]
        yield MATERIAL_SCRIPT.at(
            file,
            line_of(first),
            path_of(first),
            message="Gazebo Sim does not read the scripts of materials in this world"
            f"{': ' if names else ''}{some_of(names)}.",
            hint="Add <ambient> and <diffuse> to each <material>.",
        )


def not_in_real_time(world: Element, file: Path) -> Iterator[Diagnostic]:
    """Report a step and an update rate whose product is not the real-time factor."""
    for physics in children(world, "physics"):
        step, rate = (_number(physics, tag) for tag in ("max_step_size", "real_time_update_rate"))
        factor = _number(physics, "real_time_factor")
        step, rate = 0.001 if step is None else step, 1000.0 if rate is None else rate
        factor = 1.0 if factor is None else factor
        speed = step * rate
        if not (0 < speed < FASTEST and 0 < factor < FASTEST):
            continue  # as fast as it can, or no numbers
        if abs(speed / factor - 1) > CLOSE:
            yield UNUSUAL_RATE.at(
                file,
                line_of(physics),
                path_of(physics),
                message=f"{rate:g} steps of {step:g} s per second are {speed:g} times real time, "
                f"not {factor:g} times.",
                hint=f"Write <real_time_update_rate>{factor / step:g}</real_time_update_rate>.",
            )


def newer_sdf(root: Element, file: Path, target: Target) -> Iterator[Diagnostic]:
    """Report an SDF version that the Gazebo of the target does not know."""
    newest = _NEWEST_BESIDE.get(target.name, target.sdf_version)
    written = _version(root.get("version"))
    if written > _version(newest):
        yield NEWER_SDF.at(
            file,
            line_of(root),
            path_of(root),
            message=f"{target.gazebo} reads SDF up to {target.sdf_version}, but this file is SDF "
            f"{root.get('version')}.",
            hint=f'Write <sdf version="{target.sdf_version}">.',
        )


def _version(text: str | None) -> tuple[int, ...]:
    words = (text or "").strip().split(".")
    return tuple(map(int, words)) if all(word.isdecimal() for word in words) else ()


def _number(parent: Element, tag: str) -> float | None:
    try:
        return float(child_text(parent, tag) or "")
    except ValueError:
        return None


MISSING_WORLD = Rule(
    code="WLD001",
    name="missing-world",
    severity=Severity.ERROR,
    summary="The world file that the launch file names does not exist.",
    why="The simulator stops, or starts without the world.",
    example="# launch file\nworld = os.path.join(share, 'worlds', 'office.world')\n\n"
    "# CMakeLists.txt\ninstall(DIRECTORY launch DESTINATION share/${PROJECT_NAME})",
    instead="# CMakeLists.txt\ninstall(DIRECTORY launch worlds DESTINATION share/${PROJECT_NAME})",
)


def missing_world(plan: LaunchPlan, file: Path, overlay: Overlay) -> Diagnostic:
    """Report the path of a world that does not exist, at the line that writes it."""
    absolute = absolute_part(str(file), plan.evaluated_files)
    if absolute is not None:
        return MISSING_WORLD.at(
            Path(absolute.file),
            absolute.line,
            absolute.text,
            message=f"The world file '{file}' does not exist: {absolute.message}",
            hint=absolute.hint,
        )
    glued = glued_package(str(file))
    if glued is not None:
        return MISSING_WORLD.at(
            *_where(plan, str(file), str(file).rpartition(glued)[2]),
            message=f"The world file '{file}' does not exist: '/' is missing after the share "
            f"folder of {glued}.",
            hint=f"Write os.path.join(get_package_share_directory('{glued}'), ...).",
        )
    missing, beside = first_missing(str(file))
    worlds = [name for name in beside if name.endswith((".sdf", ".world"))]
    otherwise = (
        "Add its folder to an install(DIRECTORY ...) rule of CMakeLists.txt, then run "
        "`wsgen build`."
    )
    if missing == file.name:  # its folder is installed
        named = f": {', '.join(sorted(worlds)[:MOST_LISTED])}" if worlds else ""
        otherwise = f"Create and install it, or use an existing world{named}."
    # What is validated does not use the packages that are tried here: no look_up().
    place = find_in_package(str(file), overlay.share)
    return MISSING_WORLD.at(
        *_where(plan, str(file), missing),
        missing,
        message=f"The world file '{file}' does not exist.",
        hint=f"Look it up in the share folder of its package: {in_python(place)}."
        if place
        else advice(
            missing,
            beside,
            otherwise
            if package_of(str(file))
            else "Check the path. A file that a package installs is found on every machine: "
            "get_package_share_directory('PACKAGE').",
        ),
    )


def is_folder_reported(file: Path, diagnostics: Iterable[Diagnostic]) -> bool:
    """Whether an error is about another file in the folder whose lack makes this one missing."""
    missing = first_missing_path(file)
    return missing != file and any(
        found.severity is Severity.ERROR and Path(found.element or "").is_relative_to(missing)
        for found in diagnostics
    )


UNKNOWN_WORLD = Rule(
    code="WLD008",
    name="unknown-world",
    severity=Severity.WARNING,
    summary="The world file is not found here; Gazebo may install it.",
    why="The simulation uses an empty world with a ground plane instead. If Gazebo has no world of "
    "this name either, it stops.",
    example="launch_arguments={'gz_args': 'my_wrold.sdf'}.items()",
    instead="launch_arguments={'gz_args': os.path.join(share, 'worlds', 'my_world.sdf')}.items()",
)


def unknown_world(plan: LaunchPlan, name: str, environment: Mapping[str, str]) -> Diagnostic:
    """Report the name of a world that is not found; Gazebo may have it."""
    return UNKNOWN_WORLD.at(
        *_where(plan, name),
        name,
        message=f"The world file {name} is not found here. Gazebo finds it if it is installed with "
        "Gazebo; the simulation uses a ground plane instead.",
        hint=advice(
            name,
            [*gazebo_worlds(), *world_names(environment)],
            "Use the path of a world file that the package installs.",
        ),
    )


WORLD_NOT_HERE = Rule(
    code="WLD061",
    name="world-not-here",
    severity=Severity.INFO,
    summary="The world belongs to Gazebo, or to a ROS package that is not installed here.",
    why="The simulation of wsgen has only a ground plane: the models of the world are missing.",
    example="launch_arguments={'gz_args': 'shapes.sdf'}.items()",
    instead="launch_arguments={'gz_args': os.path.join(share, 'worlds', 'shapes.sdf')}.items()",
)


def world_not_here(plan: LaunchPlan, name: str) -> Iterator[Diagnostic]:
    """Report a world that only Gazebo or another package has, unless that is empty."""
    if Path(name).name not in EMPTY_WORLDS:
        yield WORLD_NOT_HERE.at(
            *_where(plan, name),
            name,
            message=f"The world {name} is not installed here: the simulation uses a ground plane "
            "instead.",
            hint="No action is needed for Gazebo. To simulate the world here, install the package "
            "that has it.",
        )


def _where(plan: LaunchPlan, *texts: str) -> tuple[Path, int | None]:
    """The launch file and the line that write the first of the texts that one of them writes."""
    found = (where_written(text, plan.evaluated_files) for text in texts)
    written, line = next(filter(None, found), (plan.launch_file, None))
    return Path(written), line
