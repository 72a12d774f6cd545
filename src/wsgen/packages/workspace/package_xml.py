"""Check a package.xml with catkin_pkg, as colcon and CMake do; hints say how to fix it.

The build type, by which colcon chooses how to build the package, is checked apart.
"""

from __future__ import annotations

import os
import re
from typing import TYPE_CHECKING

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.packages.workspace.manifest import DEFAULT_BUILD_TYPE, DEPENDENCY_TAGS, read_manifest
from wsgen.text.suggestions import did_you_mean, misspelled_as, nearest, suggest
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Sequence
    from pathlib import Path

    from wsgen.packages.workspace.layout import PackageFolder
    from wsgen.packages.workspace.manifest import Entry, Manifest


EXAMPLES = {
    "name": "<name>my_package</name>",
    "version": "<version>0.0.0</version>",
    "description": "<description>What the package is for.</description>",
    "maintainer": '<maintainer email="you@example.com">Your Name</maintainer>',
    "license": "<license>Apache-2.0</license>",
}

# The elements of format 3, below <package>.
TAGS = (
    *("name", "version", "description", "maintainer", "license", "url", "author", "export"),
    *("build_depend", "build_export_depend", "buildtool_depend", "buildtool_export_depend"),
    *("exec_depend", "depend", "doc_depend", "test_depend", "conflict", "replace"),
    *("group_depend", "member_of_group"),
)

# The first that matches counts; the groups of the pattern go into the hint.
HINTS = (
    (r"Only one <(\w+)>", "Keep one <{0}>."),
    (r'more than one "(\w+)"', "Keep one <{0}>."),
    (r'version "(.*)" does not follow', "Write three numbers: <version>1.0.0</version>"),
    (
        r'name "(.*)" does not follow',
        "Write lower-case letters, digits and _, a letter first, and the same name in project().",
    ),
    (r'nvalid email "(.*)" for', 'Write an address: email="you@example.com"'),
    (r"must have an (email) address", 'Write an address: email="you@example.com"'),
    (r"package with the same (name) as this", "Remove the package's dependency on itself."),
    (r"replace <(\w+)> tags with <\w+>", "Rename the tags."),
    (r"following tags: (.+)", "Remove or rename {0}: this format has no such elements."),
    (r"must not contain the following children: (.+)", "Remove {0}: a plain text is expected."),
    (r"redundant with: (.+)", "Remove one of the two dependencies."),
    (r'"format" attribute|invalid literal for int', 'Write: <package format="3">'),
    (r'The "(\w+)" tag must have the attribute "(\w+)"', 'Write: <{0} {1}="...">'),
)
MISSING = lazy_pattern(
    r'(?:exactly one "|at least one "?|Package |The )'
    r'(name|version|description|maintainer|license)(?:"| tag must| must not be empty|$)'
)
OTHERWISE = "REP-149 describes the format of package.xml."


def hint_for(problem: str, text: str) -> str:
    """Say what to write.

    Args:
        problem: one of catkin_pkg's sentences.
        text: the package.xml.
    """
    missing = MISSING.search(problem)
    if missing:
        element = missing[1]
        if len(re.findall(rf"<{element}[\s>]", text)) > 1 and "exactly one" in problem:
            return f"Keep one <{element}>."
        return f"Add: {EXAMPLES[element]}"
    unknown = re.search(r"following tags: (.+?)\.?$", problem)
    for tag in unknown[1].split(", ") if unknown else ():
        near = nearest(tag, TAGS)
        if near is not None:
            return did_you_mean(near)
    for pattern, hint in HINTS:
        match = re.search(pattern, problem)
        if match:
            return hint.format(*(group or "" for group in match.groups()))
    return OTHERWISE


REFUSED_MANIFEST = Rule(
    code="PKG005",
    name="invalid-manifest",
    severity=Severity.ERROR,
    summary="`catkin_pkg` refuses package.xml.",
    what="Reads package.xml with catkin_pkg, as colcon and ament_cmake do.",
    why="`colcon` then takes the package for one of plain CMake or Python, in another "
    "environment and with other arguments, or skips it; the only warning is in its log.",
    example="""<package format="3">
  <name>my_robot</name>
  <version>1</version>""",
    instead="""<package format="3">
  <name>my_robot</name>
  <version>1.0.0</version>""",
)
QUESTIONABLE_MANIFEST = Rule(
    code="PKG006",
    name="questionable-manifest",
    severity=Severity.WARNING,
    summary="`catkin_pkg` warns about package.xml.",
    why="The package builds, but its manifest does not follow REP 149. Tools that release or "
    "document packages may refuse it.",
    example="<name>MyRobot</name>",
    instead="<name>my_robot</name>",
)

ELEMENTS = ("maintainer", "author", "description", "license", "version", "name", "format")


_NAME = lazy_pattern(r"[a-z][a-z0-9_-]*")
_VERSION = lazy_pattern(r"(?:(?:0|[1-9][0-9]*)\.){2}(?:0|[1-9][0-9]*)")
_WORD = r"[-a-zA-Z0-9_%+]+"
_ADDRESS = lazy_pattern(rf"{_WORD}(?:\.{_WORD})*@[a-zA-Z0-9-]+(?:\.[a-zA-Z0-9-]+)*\.[a-zA-Z]{{2,}}")
FORMAT = 3  # the newest
# The attributes that elements may have: in format 2 and 3, and in format 3 alone.
_OF_PEOPLE = {"maintainer": ("email",), "author": ("email",), "url": ("type",)}
_OF_FORMAT_3: dict[str, tuple[str, ...]] = {
    "license": ("file",),
    "group_depend": ("condition",),
    "member_of_group": ("condition",),
    **dict.fromkeys(DEPENDENCY_TAGS, ("condition",)),
}
_OF_FORMAT_2 = frozenset(TAGS) - {"group_depend", "member_of_group"}
_WITH_CHILDREN = ("export", "description")
_INCLUDED = ("build_depend", "build_export_depend", "exec_depend")  # in <depend>


def is_plain(manifest: Manifest) -> bool:
    """Whether catkin_pkg surely accepts the manifest without a warning: most are of this kind.

    It follows catkin_pkg's `parse_package_string` and `Package.validate`.
    """
    entries = manifest.entries
    counts = {path[0]: len(found) for path, found in entries.items() if len(path) == 1}
    tags = {2: _OF_FORMAT_2, FORMAT: frozenset(TAGS)}.get(manifest.format or 0, frozenset())
    return (
        counts.keys() <= tags
        and all(counts.get(tag) == 1 for tag in ("name", "version", "description"))
        and counts.get("export", 1) == 1
        and {"maintainer", "license"} <= counts.keys()
        and not entries[()][0].attributes.keys() - {"format"}
        and all(len(path) < 2 or path[0] in _WITH_CHILDREN for path in entries)  # noqa: PLR2004  below a child of <package>
        and ("export", "metapackage") not in entries
        and all(
            _is_plain_entry(path[0], entry, manifest)
            for path, found in entries.items()
            if len(path) == 1
            for entry in found
        )
        and not _is_redundant(manifest)
    )


def _is_plain_entry(tag: str, entry: Entry, manifest: Manifest) -> bool:
    known = _OF_PEOPLE.get(tag) or (_OF_FORMAT_3.get(tag, ()) if manifest.format == FORMAT else ())
    address = entry.attributes.get("email")
    if entry.attributes.keys() - known or (address is None and tag == "maintainer"):
        return False
    if address is not None and not _ADDRESS.fullmatch(address):
        return False
    pattern = {"name": _NAME, "version": _VERSION}.get(tag)
    if pattern is not None:
        return pattern.fullmatch(entry.text) is not None
    if tag in DEPENDENCY_TAGS and entry.text == manifest.name:
        return False
    return bool(entry.text) or tag in {"export", "maintainer", "author", "url"}


def _is_redundant(manifest: Manifest) -> bool:
    """Whether a dependency is declared for everything and for one purpose."""
    if {entry.text for entry in manifest.entries.get(("group_depend",), ())}:
        return True  # not looked at
    general = {(one.name, one.condition) for one in manifest.dependencies if one.tag == "depend"}
    return any(
        (one.name, one.condition) in general
        for one in manifest.dependencies
        if one.tag in _INCLUDED
    )


def check_package_xml(file: Path, known: Manifest | None = None) -> tuple[Diagnostic, ...]:
    """List what catkin_pkg refuses (errors) and what it warns about (warnings).

    `known` is what the file says, where it has been read.
    """
    manifest = known or read_manifest(file)
    if isinstance(manifest, Diagnostic):
        return (manifest,)
    if is_plain(manifest):
        return ()
    from catkin_pkg.package import InvalidPackage, parse_package_string  # noqa: PLC0415  25 ms that only questionable manifests pay

    text = file.read_text(encoding="utf-8", errors="replace")
    warnings: list[str] = []
    refusal = ""
    try:
        # As bytes: a text must not carry an encoding declaration.
        parse_package_string(file.read_bytes(), filename=str(file), warnings=warnings)
    except InvalidPackage as error:
        refusal = error.msg
    except (AssertionError, ValueError, UnicodeError) as error:
        refusal = f"catkin_pkg cannot read it ({error})"
    return (
        *(_refused(file, text, line) for line in _split_refusal(refusal)),
        *(_questionable(file, text, line) for line in warnings),
    )


def refusals_of(file: Path, known: Manifest | None = None) -> tuple[Diagnostic, ...]:
    """What catkin_pkg refuses, for which colcon takes the package for one of another kind."""
    found = check_package_xml(file, known)
    return tuple(one for one in found if one.code == REFUSED_MANIFEST.code)


def _split_refusal(message: str) -> Iterator[str]:
    """Yield the problems of a message that may name several, a line each."""
    for line in message.splitlines():
        problem = line.strip().removeprefix("- ")
        if problem and problem != "Error(s):":
            yield problem


def _refused(file: Path, text: str, problem: str) -> Diagnostic:
    return REFUSED_MANIFEST.at(
        file,
        _find_line(text, problem),
        message=f"catkin_pkg refuses package.xml: {_finish(problem)}",
        hint=hint_for(problem, text),
    )


def _questionable(file: Path, text: str, problem: str) -> Diagnostic:
    return QUESTIONABLE_MANIFEST.at(
        file,
        _find_line(text, problem),
        message=f"catkin_pkg warns about package.xml: {_finish(problem)}",
        hint="Correct it as REP-149 describes the format; the package builds all the same.",
    )


def _finish(sentence: str) -> str:
    return sentence if sentence.endswith((".", "!", "?")) else f"{sentence}."


def _find_line(text: str, problem: str) -> int | None:
    """Guess the line meant: that of a tag, of a quoted value, or of the element that is named."""
    words = re.findall(r"\w+", problem)
    quoted = [first or second for first, second in re.findall(r"\"([^\"]+)\"|'([^']+)'", problem)]
    named = {word.lower().rstrip("s") for word in words}
    unknown = re.search(r"following tags: (.+?)\.?$", problem)
    needles = (
        *(f"<{tag}" for tag in (unknown[1].split(", ") if unknown else ())),
        *(f"<{word}" for word in words if word.endswith("_depend")),
        *(f"<{word}" for word in quoted),
        *(word for word in quoted if word not in ELEMENTS),
        *(f"<{element}" for element in ELEMENTS if element in named),
        "<package",  # where something is missing
    )
    lines = text.splitlines()
    for needle in needles:
        for number, line in enumerate(lines, start=1):
            if needle in line and not line.startswith("<?xml"):
                return number
    return None


DUPLICATE_NAME = Rule(
    code="PKG007",
    name="duplicate-package",
    severity=Severity.ERROR,
    summary="Two packages of the workspace have the same name.",
    why="`colcon` builds nothing then.",
    example="""src/my_robot/package.xml    <name>my_robot</name>
src/my_robot_2/package.xml  <name>my_robot</name>""",
    instead="""src/my_robot/package.xml    <name>my_robot</name>
src/my_robot_2/package.xml  <name>my_robot_2</name>""",
)


def duplicate_name(root: Path, name: str, folders: Sequence[str]) -> Diagnostic:
    """Report packages of a workspace that have the same name."""
    return DUPLICATE_NAME.at(
        root / folders[-1] / "package.xml",
        element=name,
        message=f"{len(folders)} packages are named {name}: {', '.join(folders)}.",
        hint="Rename one (package.xml and project()), or put an empty file COLCON_IGNORE into "
        "the folder of the one that colcon should not build.",
    )


def duplicate_names(root: Path, packages: Iterable[PackageFolder]) -> Iterator[Diagnostic]:
    """Report the names that several packages of a workspace have."""
    folders: dict[str, list[str]] = {}
    for one in packages:
        folders.setdefault(one.name, []).append(os.path.relpath(one.path, root))
    for name, paths in folders.items():
        if len(paths) > 1:
            yield duplicate_name(root, name, sorted(paths))


UNKNOWN_BUILD_TYPE = Rule(
    code="PKG008",
    name="unknown-build-type",
    severity=Severity.ERROR,
    summary="`colcon` does not know the build type of a package.",
    what="`wsgen build` asks colcon; `wsgen check` looks for a typing mistake in `ament_cmake`, "
    "`ament_python`, `cmake` or `catkin`, as extensions of colcon may add others.",
    why="`colcon` skips the package, and its message does not name it.",
    example="<build_type>ament_cmke</build_type>",
    instead="<build_type>ament_cmake</build_type>",
)
MISSING_BUILD_TYPE = Rule(
    code="PKG009",
    name="missing-build-type",
    severity=Severity.ERROR,
    summary="The package.xml of an ament package has no build type.",
    what="Looks at packages whose CMakeLists.txt calls ament_package(), and at those with setup.py "
    "and without CMakeLists.txt.",
    why="`colcon` then takes the package for one of ROS 1 (catkin). It builds it, but the setup "
    "files do not bring it into the environment of ROS 2.",
    example="<export/>",
    instead="""<export>
  <build_type>ament_cmake</build_type>
</export>""",
)

BUILD_TYPES = ("ament_cmake", "ament_python", "cmake", "catkin")  # of colcon-ros
PLACE = ("export", "build_type")


def check_build_type(
    manifest: Manifest, *, calls_ament_package: bool, is_python: bool
) -> Iterator[Diagnostic]:
    """Report a build type that is missing, or surely misspelled.

    Args:
        manifest: of the package.
        calls_ament_package: whether its CMakeLists.txt surely calls ament_package().
        is_python: whether it has setup.py and no CMakeLists.txt.
    """
    if manifest.line_of(*PLACE) is None:
        if calls_ament_package or is_python:
            yield missing_build_type(
                manifest, "ament_cmake" if calls_ament_package else "ament_python"
            )
        return
    if manifest.build_type not in BUILD_TYPES and misspelled_as(manifest.build_type, BUILD_TYPES):
        yield unknown_build_type(manifest, BUILD_TYPES)


def missing_build_type(manifest: Manifest, build_type: str) -> Diagnostic:
    """Say which one to add."""
    has_export = manifest.line_of("export") is not None
    return MISSING_BUILD_TYPE.at(
        manifest.file,
        manifest.line_of("export"),
        manifest.name,
        message=f"package.xml of {manifest.name} has no build type, so colcon takes it for a "
        f"{DEFAULT_BUILD_TYPE} package of ROS 1, and ROS 2 will not find it.",
        hint=f"{'Add below <export>: ' if has_export else 'Add: <export>'}"
        f"<build_type>{build_type}</build_type>{'' if has_export else '</export>'}",
    )


def unknown_build_type(manifest: Manifest, known: Collection[str]) -> Diagnostic:
    """Suggest one of those that are known."""
    return UNKNOWN_BUILD_TYPE.at(
        manifest.file,
        manifest.line_of(*PLACE),
        manifest.name,
        message=f"colcon does not build {manifest.name}: it does not know the build type "
        f"{manifest.build_type}.",
        hint=suggest(manifest.build_type, known),
    )
