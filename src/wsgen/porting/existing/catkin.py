"""A package of catkin becomes one of ament_cmake: its manifest, build file and other files.

What ROS 2 has under another name is renamed; what it does not have is left out and listed. Code in
C++ and Python for ROS 1 is listed, and left to its author. Sources: REP 127, 140 and 149; catkin's
and ament_cmake's documentation; ros2/rosidl, rosidl_adapter.
"""

from __future__ import annotations

import itertools
import re
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.checks.fixes.manifests import add_export, declare, text_of, top_of
from wsgen.checks.fixes.source import Edit, SourceText, apply, children, read_tags
from wsgen.checks.rules.dependencies import OF_ROS_1, rosdep_key
from wsgen.launching.package_lookup import is_brought
from wsgen.model.target import SIM
from wsgen.packages.build_files.cmake_text import parse
from wsgen.packages.workspace.manifest import (
    BUILD_TAGS,
    DEFAULT_BUILD_TYPE,
    RUN_TAGS,
    Manifest,
    holds,
    read_manifest,
)
from wsgen.porting.existing.launch_of_ros1 import port_launch_file
from wsgen.porting.existing.launch_port import ENDINGS, is_of_ros_1, ported_name
from wsgen.porting.existing.other_robots import find_other_robots
from wsgen.porting.existing.parameters_of_ros1 import files_in
from wsgen.porting.existing.programs_of_ros1 import written_for_ros_1
from wsgen.porting.existing.resources import with_own_names
from wsgen.porting.manifests import SEARCHED, SUCCESSORS, Declared, rename_dependencies
from wsgen.porting.models import port_model
from wsgen.porting.ported import FilePort, Unported, joined
from wsgen.porting.worlds import model_names, port_world
from wsgen.ros import ros1
from wsgen.ros.names import released_packages, rosdep_keys
from wsgen.text.markup import read_text

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator

    from wsgen.checks.fixes.source import Tag
    from wsgen.packages.build_files.cmake_text import Call
    from wsgen.porting.existing.launch_port import Source

# Packages of ROS 1 whose work nothing has to do in ROS 2, or another one of those below does.
_WITHOUT_LOSS = frozenset(("catkin", "message_generation", "message_runtime", "roslaunch"))
_GENERATORS = ("rosidl_default_generators", "rosidl_default_runtime")
_EXPORTS = frozenset(("architecture_independent", "build_type", "deprecated", "gazebo_ros"))
# Suffixes of files that name others.
_NAMING = frozenset(
    (
        *(".config", ".gazebo", ".sdf", ".srdf", ".trans", ".urdf", ".world", ".xacro", ".xml"),
        *(".yaml", ".yml"),
    )
)
_SDF = (".sdf", ".world")
_ABSOLUTE = re.compile(r"<uri>\s*(?:file://)?(/[^<>\s]+)\s*</uri>")
_OF_ROBOTS = (".gazebo", ".urdf", ".xacro")
_KINDS = {"add_message_files": "msg", "add_service_files": "srv", "add_action_files": "action"}
# Commands of CMake that make something, which the new build file does not -> what they make.
_MAKES = {
    "add_executable": "compiles the program",
    "add_library": "compiles the library",
    "cuda_add_executable": "compiles the program",
    "cuda_add_library": "compiles the library",
    "add_custom_target": "makes the target",
    "add_custom_command": "runs a command",
    "add_subdirectory": "builds the folder",
    "catkin_python_setup": "installs the modules of setup.py",
    "configure_file": "writes a file from",
    "execute_process": "runs a command",
    "generate_dynamic_reconfigure_options": "makes parameters for dynamic_reconfigure from",
    "qt4_wrap_ui": "makes code from",
    "qt5_wrap_ui": "makes code from",
}
_TESTS = ("catkin_add_gtest", "catkin_add_nosetests", "add_rostest", "add_rostest_gtest")
# Folders of a package that hold what is compiled or started, or nothing that is installed.
NOT_INSTALLED = frozenset(
    (
        *("action", "bin", "build", "cfg", "cmake", "debian", "devel", "doc", "docs", "include"),
        *("install", "log", "msg", "nodes", "scripts", "src", "srv", "test", "tests"),
    )
)
_LEFT_AT_TOP = re.compile(
    r"(?i)(?:package\.xml|CMakeLists\.txt|setup\.(?:py|cfg)|mainpage\.dox|rosdoc\.yaml|\..*"
    r"|(?:README|CHANGELOG|CONTRIBUTING|LICENSE|COPYING|TODO)\b.*|export\.log|.*\.(?:md|rst|png|jpg|gif))"
)
_FIELD = re.compile(r"(?P<type>[\w/]+(?:\[\d*\])?)(?P<gap>\s+)(?P<name>\w+)(?P<rest>\s*(?:=.*)?)$")
_CLASS = re.compile(
    r"(?m)^(?P<before>[ ]*(?:- )?Class: )(?P<quote>[\"']?)(?P<package>\w+)/(?P<name>[\w ]+?)"
    r"(?P=quote)[ ]*$"
)
_PROPERTY = re.compile(rf"(?m)^([ ]*(?:- )?)({'|'.join(ros1.RVIZ_PROPERTIES)}):(?=\s)")


MANIFEST, BUILD_FILE = "package.xml", "CMakeLists.txt"
_MOST_SIBLINGS = 100
_NO_PROGRAMS = frozenset(("build", "cfg", "devel", "install", "log", "setup.py", "test", "tests"))


class PortedText(NamedTuple):
    """What becomes of a file."""

    text: str
    packages: frozenset[str] = frozenset()  # that it needs
    notes: tuple[Unported, ...] = ()
    systems: frozenset[str] = frozenset()  # of Gazebo Sim, that its world must load


def find_package(file: Path, packages: Iterable[Path]) -> Manifest | None:
    """The package of catkin that a file is of; None where it is of another kind."""
    around = [one for one in packages if file.is_relative_to(one) and (one / MANIFEST).is_file()]
    folder = max(around, key=lambda one: len(one.parts), default=None)
    manifest = read_manifest(folder / MANIFEST) if folder is not None else None
    if not isinstance(manifest, Manifest) or "catkin" not in manifest.dependency_names:
        return None
    return manifest if manifest.build_type == DEFAULT_BUILD_TYPE else None


def siblings_of(folder: Path) -> dict[str, Path]:
    """The packages of catkin in the folders beside one: their launch files may be included."""
    found: dict[str, Path] = {}
    for manifest in itertools.islice(sorted(folder.parent.glob(f"*/{MANIFEST}")), _MOST_SIBLINGS):
        package = find_package(manifest, [manifest.parent]) if manifest.parent != folder else None
        if package is not None:
            found[package.name] = manifest.parent
    return found


class PortedPackage(NamedTuple):
    """What becomes of the files of a package, but for its manifest and build file."""

    files: dict[str, str | Path]  # by path in the package: texts, and files that stay as they are
    packages: frozenset[str]  # of ROS, that the launch files need
    notes: tuple[Unported, ...]
    systems: frozenset[str] = frozenset()  # of Gazebo Sim, that the world must load


def port_files(source: Source) -> PortedPackage:
    """Port the launch files and what they name, configurations of RViz, messages and programs.

    Code that is compiled, and programs for ROS 1, are left out.
    """
    files: dict[str, str | Path] = {}
    changed = dict[str, str]()
    paths = files_in(source.folder)
    source = source._replace(systems=source.systems | _systems_of_models(source, paths))
    others = find_other_robots(source, filter(is_installed, paths))
    packages, systems, used, notes = set[str](), set[str](), set[str](), [*others.notes]
    for path in paths:
        file = source.folder / path
        if path in source.moved or path in others.paths:
            continue
        text = read_text(file) if path.endswith((".rviz", *ENDINGS)) else None
        if not is_installed(path):
            if path.split("/")[0] not in _NO_PROGRAMS and _is_program(file):
                notes += _add_program(path, source, files)
        elif text is not None and path.endswith(".rviz"):
            ported = port_rviz(file, text, source)
            files[path] = ported.text
            notes += ported.notes
        elif text is not None and is_of_ros_1(text):
            launch = port_launch_file(file, text, source)
            notes += launch.notes
            if launch.text is not None:
                files[ported_name(path)] = launch.text
            changed |= launch.files
            used |= launch.used
            packages |= launch.packages
        else:
            files[path] = _renamed(file, source)
            if path.endswith(_SDF) and source.target.simulator == SIM:
                port = _add_sdf(path, source, files, paths)
                notes += port.unported
                packages |= port.packages
            if path.endswith(_OF_ROBOTS) and source.target.simulator == SIM:
                model = _port_model(file, files[path], source)
                files[path] = model.text or files[path]
                notes += model.notes
                packages |= model.packages
                systems |= model.systems
    calls = _calls(source)
    interfaces, _, lost = _interfaces(source, calls)
    notes += [*lost, *_not_built(source.folder / BUILD_FILE, calls)]
    files |= {path: source.folder / path for path in used} | changed | interfaces
    return PortedPackage(files, frozenset(packages), tuple(notes), frozenset(systems))


def _port_model(file: Path, written: str | Path, source: Source) -> PortedText:
    """What launch files start of the robot besides: with plugins of Gazebo Sim, too."""
    text = written if isinstance(written, str) else read_text(file) or ""
    if "<gazebo" not in text:
        return PortedText("")
    port = port_model(SourceText(file, text), source.target)
    return PortedText(apply(text, port.edits), port.packages, port.unported, port.systems)


def _systems_of_models(source: Source, paths: Iterable[str]) -> frozenset[str]:
    """The systems of Gazebo Sim that models and robots of a package need, which its worlds load."""
    if source.target.simulator != SIM:
        return frozenset()
    files = [source.folder / path for path in paths if path.endswith((*_SDF, *_OF_ROBOTS))]
    texts = [SourceText(file, read_text(file) or "") for file in files]
    return joined(port_model(text, source.target) for text in texts).systems


def _add_sdf(
    path: str, source: Source, files: dict[str, str | Path], paths: Collection[str]
) -> FilePort:
    """Port a world or model for Gazebo Classic, which is among the files as it is."""
    before = files[path]
    text = before if isinstance(before, str) else read_text(before) or ""
    file = source.folder / path
    lost = next((one for one in _ABSOLUTE.findall(text) if not Path(one).exists()), None)
    starters = (read_text(source.folder / one) or "" for one in paths if one.endswith(ENDINGS))
    if lost is not None and not any(file.name in one for one in starters):
        del files[path]
        what = f"{path} names {lost}, which does not exist, and no launch file starts it."
        return FilePort(unported=(Unported(file, 1, what, "Put what it needs into a package."),))
    models = {*model_names(source.folder), source.name}
    inside = port_model(SourceText(file, text), source.target)
    world = port_world(SourceText(file, text), source.target, source.systems, models=models)
    port = joined((world, inside))
    if port.edits:
        files[path] = apply(text, port.edits)
    return port


def _add_program(path: str, source: Source, files: dict[str, str | Path]) -> Iterator[Unported]:
    """Add a program to the files, or list why it is none of ROS 2."""
    file = source.folder / path
    reason = written_for_ros_1(source.folder, file.name)
    if reason is None:
        files[path] = file
    else:
        advice = "Write it for ROS 2, then install it among the PROGRAMS of CMakeLists.txt."
        yield Unported(file, 1, f"The program {reason}.", advice)


def _renamed(file: Path, source: Source) -> str | Path:
    """A file with the new name of the package, where it names its own files."""
    text = read_text(file) if file.suffix in _NAMING and source.old != source.name else None
    if text is not None and file.suffix == ".xacro":
        text = with_own_names(text, {**source.siblings, source.old: source.folder})
    own = rf"(?<=package://){source.old}(?=/)|(?<=model://){source.old}(?=/)"
    own += rf"|(?<=\$\(find ){source.old}(?=\))"
    renamed = re.sub(own, source.name, text) if text is not None else None
    return file if renamed is None or renamed == text else renamed


def is_installed(path: str) -> bool:
    """Whether a file of a package is installed as it is: launch files, robots and the like."""
    folder, separator, _ = path.partition("/")
    return folder not in NOT_INSTALLED if separator else not _LEFT_AT_TOP.fullmatch(path)


def port_rviz(file: Path, text: str, source: Source) -> PortedText:
    """Write a configuration of rviz as one of rviz2."""
    notes = list[Unported]()

    def rename(found: re.Match[str]) -> str:
        package, name = found["package"], found["name"]
        if (
            package == "rviz"
            and (renamed := ros1.RVIZ_RENAMED.get(name, name)) in ros1.RVIZ_CLASSES
        ):
            quote = found["quote"]
            return f"{found['before']}{quote}{ros1.RVIZ_CLASSES[renamed]}/{renamed}{quote}"
        is_released = source.target.distro in released_packages().get(
            ros1.RVIZ_PLUGINS.get(package, package), ()
        )
        if not is_released and package not in {"rviz_default_plugins", "rviz_common", source.old}:
            notes.append(
                Unported(
                    file,
                    text.count("\n", 0, found.start()) + 1,
                    f"RViz shows `{package}/{name}`, which {source.target.ros} does not have.",
                    "Remove it, or choose another one.",
                )
            )
        return found[0]

    renamed = _CLASS.sub(rename, text)
    if renamed != text:
        renamed = _PROPERTY.sub(lambda one: f"{one[1]}{ros1.RVIZ_PROPERTIES[one[2]]}:", renamed)
    return PortedText(renamed, notes=tuple(notes))


# package.xml


def port_manifest(
    source: Source, needs: Collection[tuple[str, str]] = (), license_name: str | None = None
) -> PortedText:
    """Write package.xml of catkin in format 3, for ament_cmake.

    Args:
        source: the package, and what it becomes.
        needs: what its files need now: elements and the names of packages.
        license_name: in place of the license that it names, with the file LICENSE; None: that
            one stays.
    """
    text = read_text(source.folder / MANIFEST) or ""
    before = SourceText(source.folder / MANIFEST, text)
    root, top = top_of(before)
    if root is None or root.end is None:
        return PortedText(text)
    edits, notes = [_format(root)], list[Unported]()
    name = next((tag for tag in top if tag.name == "name" and tag.end), None)
    if name is not None:
        edits.append(_content(name, source.name))
    if license_name is not None:
        for tag in [tag for tag in top if tag.name == "license" and tag.end][:1]:
            edits.append(_content(tag, escape(license_name)))
            if "file" not in tag.attributes:
                place = tag.start.start + len("<license")
                edits.append(Edit(start=place, end=place, text=' file="LICENSE"'))
    renamed, dropped = _dependencies(before, top, source)
    notes += dropped
    exports, lost = _exports(before, top)
    notes += lost
    after = SourceText(before.file, apply(text, [*edits, *renamed, *exports]))
    after = SourceText(before.file, _declared(after, source, needs))
    added = () if "<gazebo_ros" in after.text else add_export(after, SEARCHED)
    return PortedText(apply(after.text, added), notes=tuple(notes))


def _dependencies(
    text: SourceText, top: list[Tag], source: Source
) -> tuple[list[Edit], list[Unported]]:
    """Write the dependencies with their names and elements in ROS 2."""
    declared, notes = list[Declared](), list[Unported]()
    edits: list[tuple[Tag, Edit]] = []
    for tag in top:
        name = text_of(text, tag)
        if not tag.name.endswith("depend") or tag.end is None or not name:
            continue
        condition = tag.attributes.get("condition")
        is_of_ros_1 = condition is not None and holds(condition.text, source.target.distro) is False
        becomes = "" if is_of_ros_1 else successor(name, source) or ""
        declared.append(Declared(tag, name, becomes))
        if not becomes and not is_of_ros_1 and name not in _WITHOUT_LOSS:
            notes.append(_dropped(text, tag, name, source))
        elif tag.name == "run_depend":
            starts = (tag.start.start + len("<"), tag.end.start + len("</"))
            ends = (Edit(start=one, end=one + len(tag.name), text="exec_depend") for one in starts)
            edits += [(tag, end) for end in ends]
    renamed, gone = rename_dependencies(text, declared)
    return [*renamed, *(edit for tag, edit in edits if tag not in gone)], notes


def _content(tag: Tag, text: str) -> Edit:
    """Write something else between the tags of an element."""
    inside = tag.content()
    return Edit(start=inside.start, end=inside.end, text=text)


def _format(root: Tag) -> Edit:
    written = root.attributes.get("format")
    if written is not None:
        return Edit(start=written.value.start, end=written.value.end, text="3")
    place = root.start.start + len("<package")
    return Edit(start=place, end=place, text=' format="3"')


def successor(name: str, source: Source) -> str | None:
    """What a package is called in the target; None where it has none."""
    distro = source.target.distro
    released = released_packages()
    if name == "catkin":
        return "ament_cmake"
    if name in {"message_generation", "message_runtime"}:
        return None  # the interfaces declare what they need
    if name == source.old or name in source.siblings or distro in released.get(name, ()):
        return name
    instead = (*OF_ROS_1.get(name, ()), SUCCESSORS.get(name, ""))
    found = next((one for one in instead if distro in released.get(one, ())), None)
    if found is not None:
        return found
    if name in rosdep_keys() and not name.startswith("python-"):
        return name
    return rosdep_key(name)


def _dropped(text: SourceText, tag: Tag, name: str, source: Source) -> Unported:
    return Unported(
        text.file,
        text.line_at(tag.start.start),
        f"The dependency `{name}` is not released for {source.target.ros}.",
        ros1.INSTEAD.get(
            name, "Port it into the same workspace and declare it again, or go without."
        ),
    )


def _exports(text: SourceText, top: list[Tag]) -> tuple[list[Edit], list[Unported]]:
    """Remove what ROS 1 alone reads of <export>."""
    edits, notes = list[Edit](), list[Unported]()
    tags = read_tags(text.text)
    for export in top:
        if export.name != "export":
            continue
        for one in children(tags, export):
            if one.name in _EXPORTS:
                continue
            end = (one.end or one.start).end
            start, end = text.whole_lines(one.start.start, end)
            edits.append(Edit(start=start, end=end, text=""))
            if one.name not in {"metapackage", "rosdoc", "rosindex"}:
                notes.append(
                    Unported(
                        text.file,
                        text.line_at(one.start.start),
                        f"<{one.name}> in <export> is read by ROS 1 alone.",
                        "Export plugins by pluginlib_export_plugin_description_file() in "
                        "CMakeLists.txt.",
                    )
                )
    return edits, notes


def _declared(text: SourceText, source: Source, needs: Collection[tuple[str, str]]) -> str:
    """Declare what is needed now, and the build type."""
    _, top = top_of(text)
    by_use = [
        {text_of(text, tag) for tag in top if tag.name in tags}
        for tags in (RUN_TAGS, BUILD_TAGS, {"buildtool_depend"})
    ]
    running, building, tools = by_use
    interfaces, of_interfaces, _ = _interfaces(source, _calls(source))
    missing = [("buildtool_depend", "ament_cmake")] if "ament_cmake" not in tools else []
    if interfaces:
        missing += [("buildtool_depend", _GENERATORS[0]), ("exec_depend", _GENERATORS[1])]
        missing += [("member_of_group", "rosidl_interface_packages")]
    for name in of_interfaces:
        if name not in running | building:
            missing.append(("depend", name))
        elif name not in building:
            missing.append(("build_depend", name))
    for tag, name in sorted({*needs}):
        is_there = name in {*running, source.name, *of_interfaces} or is_brought(name, running)
        if tag != "exec_depend" or not is_there:
            missing.append((tag, name))
    written = {(tag.name, text_of(text, tag)) for tag in top}
    missing = [one for one in missing if one not in written]
    after = SourceText(text.file, apply(text.text, declare(text, missing)))
    if "<build_type>" in after.text:
        return after.text
    return apply(after.text, add_export(after, "<build_type>ament_cmake</build_type>"))


# Messages


def port_interface(file: Path, text: str) -> PortedText:
    """Write a message, service or action as ROS 2 reads it."""
    lines, notes = list[str](), list[Unported]()
    packages = set[str]()
    for number, line in enumerate(text.splitlines(), 1):
        code, mark, comment = line.partition("#")
        found = _FIELD.match(code.rstrip())
        if found is None or (found["type"] == "string" and "=" in code):
            lines.append(line)
            continue
        kind, _, array = found["type"].partition("[")
        kind = ros1.FIELD_TYPES.get(kind, kind)
        name = found["name"]
        is_constant = "=" in found["rest"]
        right = (
            name.upper() if is_constant else re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()
        )
        right = re.sub(r"__+", "_", right).strip("_")
        if right != name:
            notes.append(
                Unported(
                    file,
                    number,
                    f"ROS 2 does not take `{name}` as a name; it is `{right}` now.",
                    "Write the new name in the code.",
                )
            )
        packages.add(kind.partition("/")[0] if "/" in kind else "")
        array = f"[{array}" if array else ""
        rest = f"{kind}{array}{found['gap']}{right}{found['rest']}"
        lines.append(f"{rest}{code[len(code.rstrip()) :]}{mark}{comment}".rstrip())
    return PortedText("\n".join(lines) + "\n", frozenset(packages - {""}), tuple(notes))


# CMakeLists.txt


def _calls(source: Source) -> tuple[Call, ...]:
    text = read_text(source.folder / BUILD_FILE)
    return parse(text)[0] if text is not None else ()


def port_build_file(source: Source, paths: Collection[str], base: str) -> str:
    """Write CMakeLists.txt of catkin for ament_cmake.

    Args:
        source: the package, and what it becomes.
        paths: the files that the package has now.
        base: one that installs its folders, and calls ament_package() at the end.
    """
    interfaces, needed, _ = _interfaces(source, _calls(source))
    kept = {path for path in paths if is_installed(path)}
    others = sorted({*paths} - kept - interfaces.keys())
    programs = [path for path in others if _is_program(source.folder / path)]
    at_top = sorted(path for path in kept if "/" not in path)
    blocks = list[str]()
    found = "find_package(ament_cmake REQUIRED)"
    if interfaces:
        words = [f'"{name}"' for name in interfaces]
        words += [f"DEPENDENCIES {' '.join(needed)}"] if needed else []
        blocks.append(_call("rosidl_generate_interfaces", "${PROJECT_NAME}", words))
        tools = (_GENERATORS[0], *needed)
        packages = "\n".join((found, *(f"find_package({name} REQUIRED)" for name in tools)))
        base = re.sub(r"(?m)^#.*compiler.*\n(project\(\S+) LANGUAGES NONE\)", r"\1)", base)
        base = base.replace(found, packages, 1)
    for kind, installed, place in (("FILES", at_top, "share"), ("PROGRAMS", programs, "lib")):
        if installed:
            words = [" ".join((kind, *map(_quoted, installed)))]
            words.append(f"DESTINATION {place}/${{PROJECT_NAME}}")
            blocks.append(_call("install", "", words))
    ends = ("if(BUILD_TESTING)", "ament_package()")
    end = next((base.index(one) for one in ends if one in base), len(base))
    return "".join((base[:end], *(f"{block}\n\n" for block in blocks), base[end:]))


def _call(command: str, first: str, words: Iterable[str]) -> str:
    return "\n".join((f"{command}({first}", *(f"  {word}" for word in words), ")"))


def _quoted(path: str) -> str:
    return f'"{path}"' if re.search(r"[\s;()#\"$]", path) else path


def _is_program(file: Path) -> bool:
    text = read_text(file) if file.suffix in {"", ".py", ".sh", ".bash"} else None
    return text is not None and text.startswith("#!")


def _not_built(file: Path, calls: Iterable[Call]) -> Iterator[Unported]:
    """What catkin builds, and the new build file does not."""
    for call in calls:
        words = call.arguments
        if call.command in _MAKES and not {"ALIAS", "IMPORTED", "INTERFACE"} & {*words}:
            subject = f" `{words[0]}`" if words else ""
            yield Unported(
                file,
                call.line,
                f"`{call.command}` {_MAKES[call.command]}{subject}: that is left out.",
                "Port the code to ROS 2, then build it here by ament_cmake.",
            )
        elif call.command in _TESTS:
            yield Unported(
                file,
                call.line,
                f"`{call.command}` adds a test of ROS 1, which is left out.",
                "Write it for ament_cmake_gtest, ament_cmake_pytest or launch_testing.",
            )


def _interfaces(
    source: Source, calls: Iterable[Call]
) -> tuple[dict[str, str], list[str], list[Unported]]:
    """Messages, services and actions: texts by path, packages that they need, what is lost."""
    found, notes = dict[str, str](), list[Unported]()
    needed = set[str]()
    file = source.folder / BUILD_FILE
    for call in calls:
        words = list(call.arguments)
        if call.command == "generate_messages" and "DEPENDENCIES" in words:
            needed.update(words[words.index("DEPENDENCIES") + 1 :])
        if call.command not in _KINDS:
            continue
        kind = _KINDS[call.command]
        folder = words[words.index("DIRECTORY") + 1] if "DIRECTORY" in words[:-1] else kind
        names = words[words.index("FILES") + 1 :] if "FILES" in words else []
        names = [one for one in names if one.endswith(f".{kind}")] or sorted(
            path.name for path in (source.folder / folder).glob(f"*.{kind}")
        )
        for name in names:
            text = read_text(source.folder / folder / name)
            if text is None or not re.fullmatch(rf"[A-Z][A-Za-z0-9]*\.{kind}", name):
                notes.append(
                    Unported(
                        file,
                        call.line,
                        f"`{folder}/{name}` is not an interface of ROS 2, and is left out.",
                        "Give it a name of letters and digits that begins with a capital, and add "
                        "it to rosidl_generate_interfaces().",
                    )
                )
                continue
            ported = port_interface(source.folder / folder / name, text)
            found[f"{folder}/{name}"] = ported.text
            needed |= ported.packages
            notes += ported.notes
    needed -= {"actionlib_msgs", "", source.old}
    known = {one for one in needed if (successor(one, source)) == one}
    notes += [
        Unported(
            file, 1, f"The messages need `{one}`, which {source.target.ros} lacks.", "Port it, too."
        )
        for one in sorted(needed - known)
    ]
    return found, sorted(known), notes
