"""Which rules have a safe fix, and in which file it is made."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.checks.fixes import build_files, cmake_source, launch_files, manifests, meant, robots

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from wsgen.checks.fixes.source import Edit, SourceText
    from wsgen.diagnostics import Diagnostic

    # The edits in a text that remove the reason of a diagnostic; none where that is not certain.
    Fixer = Callable[[Diagnostic, SourceText], Sequence[Edit]]


# Name of the rule -> its fix.
FIXERS: Mapping[str, Fixer] = {
    # package.xml and wsgen.toml
    "missing-build-type": manifests.add_build_type,
    "invalid-manifest": manifests.fix_version,
    "invalid-settings": manifests.fix_settings_key,
    "unknown-rule-allowed": manifests.fix_allowed_rule,
    "unused-allowance": meant.remove_allowance,
    "unnamed-package": manifests.add_name,
    "missing-build-file": manifests.fix_build_type,
    "unknown-build-type": meant.fix_word,
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
    "contents-installed": cmake_source.remove_last_slashes,
    "repeated-folder": cmake_source.shorten_destination,
    "wrong-destination": cmake_source.fix_destination,
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
    "unknown-plugin-part": meant.fix_word,
    "frame-without-link": meant.fix_word,
    "unknown-controller-joint": meant.fix_word,
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
    "invalid-bridge-entry": meant.fix_word,
    "unknown-controller-type": meant.fix_word,
    "unpublished-frame": meant.fix_word,
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
