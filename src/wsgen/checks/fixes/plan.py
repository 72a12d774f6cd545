"""From diagnostics to new texts of files, and to the disk; which rules have a safe fix, where."""

from __future__ import annotations

import ast
import os
import re
import warnings
from typing import TYPE_CHECKING

from wsgen.checks.fixes import build_files, launch_files, manifests, robots, source
from wsgen.checks.fixes.manifests import DEPENDENCY
from wsgen.checks.fixes.source import apply, overlap, read_source
from wsgen.packages.workspace.layout import (
    INSTALL_LAYOUT,
    find_packages,
    read_package,
    workspace_around,
)
from wsgen.packages.workspace.manifest import way_between
from wsgen.text.files import write_file
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from wsgen.checks.fixes.source import Edit, SourceText
    from wsgen.diagnostics import Diagnostic

    Fixer = Callable[[Diagnostic, SourceText], Sequence[Edit]]


# Name of the rule -> its fix.
FIXERS: Mapping[str, Fixer] = {
    # package.xml and wsgen.toml
    "missing-build-type": manifests.add_build_type,
    "invalid-manifest": manifests.fix_version,
    "invalid-settings": manifests.fix_settings_key,
    "unknown-rule-allowed": manifests.fix_allowed_rule,
    "unused-allowance": source.remove_allowance,
    "unnamed-package": manifests.add_name,
    "missing-build-file": manifests.fix_build_type,
    "unknown-build-type": source.fix_word,
    "not-a-rosdep-key": manifests.write_dependency,
    **dict.fromkeys(
        (
            "undeclared-package",
            "undeclared-dependency",
            "undeclared-build-dependency",
            "undeclared-test-dependency",
            "missing-buildtool-dependency",
            "missing-interface-dependency",
            "missing-interface-group",
        ),
        manifests.add_dependencies,
    ),
    "not-for-run-time": manifests.write_dependency,
    "misspelled-dependency": manifests.rename_dependency,
    "duplicate-dependency": manifests.remove_dependency,
    "build-type-as-dependency": manifests.remove_build_type_as_dependency,
    "old-manifest-format": manifests.write_format_3,
    # CMakeLists.txt, setup.py, setup.cfg
    "missing-installed-path": build_files.fix_installed_path,
    "repeated-ament-package": build_files.remove_repeated_ament_package,
    "missing-ament-package": build_files.add_ament_package,
    "old-cmake-minimum": build_files.fix_cmake_minimum,
    "deprecated-cmake-minimum": build_files.fix_cmake_minimum,
    "missing-cmake-minimum": build_files.add_cmake_minimum,
    "missing-project": build_files.add_project,
    "different-names": build_files.fix_project_name,
    "unknown-language": build_files.fix_language,
    "unknown-command": build_files.fix_command_name,
    "missing-destination": build_files.add_destination,
    "misspelled-keyword": build_files.fix_keyword,
    "unknown-setup-option": build_files.fix_setup_option,
    "broken-console-script": build_files.fix_script_folder,
    "command-after-ament-package": build_files.move_ament_package,
    "registered-after-ament-package": build_files.move_ament_package,
    "contents-installed": build_files.remove_last_slashes,
    "repeated-folder": build_files.shorten_destination,
    "wrong-destination": build_files.fix_destination,
    "folder-not-installed": build_files.install_folder,
    "broken-shebang": build_files.fix_shebang,
    "program-not-installed": build_files.install_program,
    "wrong-kind-of-path": build_files.fix_kind_of_path,
    "missing-marker": build_files.add_data_file,
    # URDF, xacro, SDF
    "malformed-xml": robots.fix_xml,
    "xacro-fails": robots.fix_xml,
    "xacro-file-fails": robots.fix_xml,
    "unnamed-robot": robots.fix_robot_name,
    "unknown-urdf-version": robots.fix_urdf_version,
    "no-sdf-version": robots.fix_sdf_version,
    "unknown-link": robots.fix_link,
    "unknown-joint-type": robots.rename_value("type"),
    "unnormalized-axis": robots.fix_axis,
    "swapped-limits": robots.fix_limits,
    "not-a-number": robots.fix_number,
    "gazebo-not-a-number": robots.fix_number,
    "gazebo-not-a-boolean": robots.fix_boolean,
    "color-out-of-range": robots.fix_color,
    "duplicate-material": robots.remove_repeated_material,
    "unknown-gazebo-material": robots.rename_value(),
    "unknown-reference": robots.rename_value("reference"),
    "misspelled-element": robots.fix_element_name,
    "misspelled-attribute": robots.fix_attribute_name,
    "unprefixed-xacro": robots.add_prefix,
    "unknown-plugin-part": source.fix_word,
    "frame-without-link": source.fix_word,
    "unknown-controller-joint": source.fix_word,
    "unknown-system": robots.fix_attribute,
    "unknown-controlled-joint": robots.fix_joint,
    "unknown-transmission-joint": robots.fix_joint,
    "unknown-interface": robots.fix_interface,
    "unknown-hardware": robots.fix_inner_text("plugin"),
    "not-in-real-time": robots.fix_inner_text("real_time_update_rate"),
    "missing-system-plugin": robots.add_system_plugins,
    "missing-sensor-system": robots.add_system_plugins,
    # launch files
    "no-clock-bridge": launch_files.add_clock,
    "invalid-bridge-entry": source.fix_word,
    "unknown-controller-type": source.fix_word,
    "unpublished-frame": source.fix_word,
    "spawned-in-ground": launch_files.raise_spawned,
    "glued-command": launch_files.add_blank_after_xacro,
    "glued-arguments": launch_files.add_blank_after_option,
    "ros-1-launch-file": launch_files.fix_ros_1_markup,
    "wall-clock-beside-simulator": launch_files.use_time_of_simulator,
    "no-factory-plugin": launch_files.add_factory_plugin,
    "other-world-name": launch_files.fix_world_name,
    "unknown-controller": launch_files.fix_text(),
    "wrong-bridge-direction": launch_files.fix_bridge_direction,
    "description-not-yaml": launch_files.keep_description_as_text,
    "description-as-yaml": launch_files.keep_description_as_text,
    "old-keyword": launch_files.rename_old_keywords,
    "invalid-keyword": launch_files.fix_keyword,
    "undefined-name": launch_files.add_import,
    "executable-not-found": launch_files.fix_text("executable"),
    "unused-include-argument": launch_files.fix_text(),
    "unused-xacro-argument": launch_files.fix_xacro_argument,
}


def _manifest_around(diagnostic: Diagnostic) -> Path | None:
    """package.xml of the package in which the file of a diagnostic is."""
    folders = diagnostic.file.absolute().parents if diagnostic.file else ()
    return next((one / "package.xml" for one in folders if (one / "package.xml").is_file()), None)


# Rules whose fix is in another file than the one that they name.
ELSEWHERE: Mapping[str, Callable[[Diagnostic], Path | None]] = {
    name: _manifest_around
    for name, fixer in FIXERS.items()
    if fixer in {manifests.add_dependencies, manifests.fix_build_type}
}


def file_to_fix(diagnostic: Diagnostic) -> Path | None:
    """The file that the fix of a diagnostic changes."""
    find = ELSEWHERE.get(diagnostic.name)
    return find(diagnostic) if find else diagnostic.file


def has_fix(diagnostic: Diagnostic) -> bool:
    """Whether there may be a fix; the text decides."""
    return diagnostic.name in FIXERS


MANIFEST = "package.xml"


@dataclass(frozen=True, kw_only=True)
class FileFix:
    """What the fixes make of a file."""

    file: Path  # links are resolved: the file that is written
    before: str  # its text, with its line ends
    after: str
    data: bytes  # its new content
    fixed: tuple[Diagnostic, ...]  # what is then gone


@dataclass(frozen=True, kw_only=True)
class FixPlan:
    """The fixes of all files, and what has no fix although its rule has one."""

    files: tuple[FileFix, ...]
    refused: tuple[tuple[Diagnostic, str], ...]  # with the reason

    @property
    def fixed(self) -> tuple[Diagnostic, ...]:
        """What the fixes remove."""
        return tuple(found for one in self.files for found in one.fixed)


def plan_fixes(diagnostics: Iterable[Diagnostic], roots: Sequence[Path]) -> FixPlan:
    """Compute the fixes in files below `roots`; nothing is written.

    Of two fixes that touch the same place, the first is made: check again for the second.
    """
    by_file: dict[Path, list[Diagnostic]] = {}
    refused: list[tuple[Diagnostic, str]] = []
    checked = [root.resolve() for root in roots]
    for found in dict.fromkeys(diagnostics):
        file = file_to_fix(found) if found.name in FIXERS else None
        if file is None:
            continue
        file = file.resolve()
        reason = _reason_to_refuse(file, checked)
        if reason is None:
            by_file.setdefault(file, []).append(found)
        else:
            refused.append((found, reason))
    files = []
    dependencies = _Dependencies()
    for file, those in by_file.items():
        fix, rest = _fix_file(file, those, dependencies)
        files += [fix] if fix else []
        refused += rest
    return FixPlan(files=tuple(files), refused=tuple(refused))


def _reason_to_refuse(file: Path, roots: Sequence[Path]) -> str | None:
    """Why a file must not be changed."""
    if not any(file == root or root in file.parents for root in roots):
        return "the file is outside of what is checked"
    if any((folder / INSTALL_LAYOUT).exists() for folder in file.parents):
        return "the file is in an install space: fix its source"
    if not file.is_file():
        return "the file does not exist"
    if not os.access(file, os.W_OK):
        return "the file is read-only"
    return None


class _Dependencies:
    """Which packages of the workspaces need which others; colcon builds no circle of them."""

    def __init__(self) -> None:
        self._of: dict[Path, dict[str, set[str]]] = {}  # by the folder of the workspace

    def add(self, file: Path, edits: Iterable[Edit]) -> str | None:
        """Add those that edits of a package.xml declare; why not, if they close a circle."""
        added = {
            name
            for edit in edits
            for _, name in DEPENDENCY.findall(edit.text)
            if file.name == MANIFEST
        }
        package = read_package(file.parent) if added else None
        if package is None:
            return None
        needed = self._around(file.parent)
        for name in sorted(added):
            way = way_between(name, package.name, lambda one: needed.get(one, ()))
            if way is not None:
                circle = " → ".join((package.name, *way))
                return f"colcon refuses packages that need each other: {circle}"
        needed.setdefault(package.name, set()).update(added)
        return None

    def _around(self, folder: Path) -> dict[str, set[str]]:
        workspace = workspace_around(folder)
        if workspace is None:
            return {}
        if workspace.root not in self._of:
            self._of[workspace.root] = {
                package.name: {one.name for one in package.manifest.dependencies}
                for package in find_packages(workspace)
                if package.manifest is not None
            }
        return self._of[workspace.root]


def _fix_file(
    file: Path, diagnostics: Sequence[Diagnostic], dependencies: _Dependencies
) -> tuple[FileFix | None, list[tuple[Diagnostic, str]]]:
    source = read_source(file)
    refused: list[tuple[Diagnostic, str]] = []
    if source is None:
        return None, [(found, "the file is not UTF-8, or too large") for found in diagnostics]
    edits: list[Edit] = []
    fixed: list[Diagnostic] = []
    was_whole = is_whole(source, source.text)
    for found in diagnostics:
        own = [*FIXERS[found.name](found, source)]
        if own and set(own) <= set(edits):  # one cause, reported twice
            fixed.append(found)
            continue
        if not own:
            refused.append((found, "the text does not show what is meant"))
        elif overlap(own, edits):
            refused.append((found, "another fix touches the same place"))
        elif was_whole and not is_whole(source, apply(source.text, [*edits, *own])):
            refused.append((found, "the fix would break the file"))
        elif (circle := dependencies.add(file, own)) is not None:
            refused.append((found, circle))
        else:
            edits += own
            fixed.append(found)
    after = apply(source.text, edits)
    if after == source.text:
        return None, refused
    fix = FileFix(
        file=file,
        before=source.text,
        after=after,
        data=source.encoded(after),
        fixed=tuple(fixed),
    )
    return fix, refused


def is_whole(source: SourceText, text: str) -> bool:
    """Whether a text can be parsed, if it is Python or XML."""
    suffix = source.file.suffix
    if suffix == ".py":
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                ast.parse(text)
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            return False
    elif text.lstrip("\ufeff \t\r\n").startswith("<"):
        from wsgen.text.xmlsyntax import find_mistake  # noqa: PLC0415  most files need it, CMake does not

        return find_mistake(text.encode()) is None
    return True


def write_fixes(plan: FixPlan) -> Iterator[Path]:
    """Write the files, each whole or not at all; those that are written.

    Raises:
        NotReadableError: A file cannot be written; it is unchanged, and those after it are.
    """
    for one in plan.files:
        write_file(one.file, one.data)
        yield one.file


def unified_diff(fix: FileFix, name: str) -> list[str]:
    """The lines of what a fix changes, as `diff -u` and `git diff` print them."""
    from difflib import unified_diff as compare  # noqa: PLC0415  only --diff needs it

    lines = []
    before, after = (re.findall(r"[^\n]*\n|[^\n]+", text) for text in (fix.before, fix.after))
    for line in compare(before, after, f"a/{name}", f"b/{name}"):
        lines.append(line.removesuffix("\n"))
        if line[:1] in {" ", "-", "+"} and not line.endswith("\n"):
            lines.append("\\ No newline at end of file")
    return lines
