"""Fixes in CMakeLists.txt, setup.py and setup.cfg, from what a build reports."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from checks.fixes.crafted import fixed
from wsgen.packages.build_files.cmake_checks import word_names

if TYPE_CHECKING:
    from pathlib import Path


HEAD = "cmake_minimum_required(VERSION 3.8)\nproject(r)\nfind_package(ament_cmake REQUIRED)\n"
DOES_NOT_EXIST = "install() names the folder {}, which does not exist."


@pytest.mark.parametrize(
    ("before", "line", "message", "hint", "after"),
    [
        (
            "install(DIRECTORY lanch urdf DESTINATION share/r)",
            1,
            DOES_NOT_EXIST.format("lanch"),
            "Did you mean `launch`? Create it, or remove it from install().",
            "install(DIRECTORY launch urdf DESTINATION share/r)",
        ),
        (
            "install(DIRECTORY\n  lanch/  # here\n  DESTINATION share/r)",
            2,
            DOES_NOT_EXIST.format("lanch/"),
            "Did you mean `launch`? Create it, or remove it from install().",
            "install(DIRECTORY\n  launch/  # here\n  DESTINATION share/r)",
        ),
        (
            "install(DIRECTORY urdf meshes DESTINATION share/r)",
            1,
            DOES_NOT_EXIST.format("meshes"),
            "Create it, or remove it from install().",
            "install(DIRECTORY urdf DESTINATION share/r)",
        ),
        (
            "install(\n  DIRECTORY\n    urdf\n    meshes\n  DESTINATION share/r\n)\n",
            4,
            DOES_NOT_EXIST.format("meshes"),
            "",
            "install(\n  DIRECTORY\n    urdf\n  DESTINATION share/r\n)\n",
        ),
        (
            "# a\ninstall(DIRECTORY meshes DESTINATION share/r)\n# b\n",
            2,
            DOES_NOT_EXIST.format("meshes"),
            "",
            "# a\n# b\n",
        ),
        (
            "install(DIRECTORY lanch launch DESTINATION share/r)",
            1,
            DOES_NOT_EXIST.format("lanch"),
            "Did you mean `launch`? Create it, or remove it from install().",
            "install(DIRECTORY launch DESTINATION share/r)",
        ),
        ("install(DIRECTORY ${dirs} DESTINATION s)", 1, DOES_NOT_EXIST.format("a"), "", None),
        (
            "install(DIRECTORY a PATTERN a EXCLUDE)",
            1,
            DOES_NOT_EXIST.format("a"),
            "",
            None,
        ),
    ],
)
def test_missing_installed_path(  # noqa: PLR0917
    tmp_path: Path, before: str, line: int, message: str, hint: str, after: str | None
) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text(before)
    assert fixed(file, "missing-installed-path", line, message, hint) == after


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (f"{HEAD}ament_package()\n# a\nament_package()\n", f"{HEAD}# a\nament_package()\n"),
        (f"{HEAD}if(A)\nament_package()\nendif()\nament_package()\n", None),
        (f"{HEAD}ament_package(CONFIG_EXTRAS a)\nament_package()\n", None),
    ],
)
def test_repeated_ament_package(tmp_path: Path, before: str, after: str | None) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text(before)
    assert fixed(file, "repeated-ament-package", 4) == after


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (HEAD, f"{HEAD}ament_package()\n"),
        (f"{HEAD}# ament_package()", f"{HEAD}# ament_package()\nament_package()\n"),
        (
            "project(r)\r\n",
            "project(r)\r\nfind_package(ament_cmake REQUIRED)\r\nament_package()\r\n",
        ),
        (f"{HEAD}ament_auto_package()\n", None),
        ("", None),
    ],
)
def test_missing_ament_package(tmp_path: Path, before: str, after: str | None) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_bytes(before.encode())
    assert fixed(file, "missing-ament-package", 3) == after


@pytest.mark.parametrize("name", ["old-cmake-minimum", "deprecated-cmake-minimum"])
@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("VERSION 2.8.3", "VERSION 3.8...3.31"),
        ("VERSION 3.8 FATAL_ERROR", "VERSION 3.8...3.31 FATAL_ERROR"),
        ("VERSION 3.16.3", "VERSION 3.16...3.31"),
        ("\n  VERSION 3.5 # old\n", "\n  VERSION 3.8...3.31 # old\n"),
        ("VERSION 3.5...3.9", "VERSION 3.8...3.31"),
        ("VERSION ${oldest}", None),
        ("VERSION 4.0", None),
    ],
)
def test_cmake_minimum(tmp_path: Path, name: str, before: str, after: str | None) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text(f"CMAKE_MINIMUM_REQUIRED({before})\nproject(r)\n")
    wanted = after and f"CMAKE_MINIMUM_REQUIRED({after})\nproject(r)\n"
    assert fixed(file, name, 1) == wanted


def test_what_comes_first(tmp_path: Path) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text("# A robot\nament_package()\n")
    hint = "Add as its first line: project(r)"
    assert fixed(file, "missing-project", 1, "", hint) == (
        "project(r)\n# A robot\nament_package()\n"
    )
    assert fixed(file, "missing-project", 1, "", hint) is None
    assert fixed(file, "missing-cmake-minimum", 1) == (
        "cmake_minimum_required(VERSION 3.8...3.31)\nproject(r)\n# A robot\nament_package()\n"
    )
    assert fixed(file, "missing-cmake-minimum", 1) is None
    file.write_text("cmake_minimum_required(VERSION 3.8)  # as ROS\n")
    assert fixed(file, "missing-project", 1, "", hint) == (
        "cmake_minimum_required(VERSION 3.8)\nproject(r)  # as ROS\n"
    )


@pytest.mark.parametrize(
    ("name", "before", "message", "hint", "after"),
    [
        (
            "different-names",
            "project( robots  LANGUAGES CXX)",
            "",
            "Write project(robot) here, or <name>robots</name> in package.xml",
            "project( robot  LANGUAGES CXX)",
        ),
        ("different-names", "project(${name})", "", "Write project(robot) here", None),
        ("unknown-language", "project(r CPP C)", "", "", "project(r CXX C)"),
        ("unknown-language", "project(CPP LANGUAGES C++)", "", "", "project(CPP LANGUAGES CXX)"),
        ("unknown-language", "project(r RUST)", "", "", None),
        (
            "unknown-command",
            "Ament_Pakage()",
            "CMake does not know the command Ament_Pakage().",
            "Did you mean `ament_package()`?",
            "ament_package()",
        ),
        (
            "unknown-command",
            "add_node(a)",
            "CMake does not know the command add_node().",
            "Did you mean `add_executable()`?",
            None,
        ),
        (
            "missing-destination",
            "install(DIRECTORY launch urdf)",
            "",
            "",
            "install(DIRECTORY launch urdf DESTINATION share/${PROJECT_NAME})",
        ),
        (
            "missing-destination",
            "install(PROGRAMS\n  a.py  # runs\n)",
            "",
            "",
            "install(PROGRAMS\n  a.py\n  DESTINATION lib/${PROJECT_NAME}  # runs\n)",
        ),
        ("missing-destination", "install(FILES a RENAME b)", "", "", None),
        ("missing-destination", "install(EXPORT a)", "", "", None),
    ],
)
def test_commands(  # noqa: PLR0917
    tmp_path: Path, name: str, before: str, message: str, hint: str, after: str | None
) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text(before)
    line = 1 if after is None or "\n" not in before else 2
    assert fixed(file, name, line, message, hint) == after


def test_a_project_that_is_called_as_its_folder_keeps_its_name(tmp_path: Path) -> None:
    """The mistake is in package.xml then."""
    file = tmp_path / "robots" / "CMakeLists.txt"
    file.parent.mkdir()
    file.write_text("project(robots)")
    found = word_names("robots", "robot", file, 1, 3)
    assert (found.hint or "").startswith("Write <name>robots</name> in package.xml")
    assert fixed(file, found.name, 1, found.message, found.hint or "") is None


def test_an_option_of_setup(tmp_path: Path) -> None:
    file = tmp_path / "setup.py"
    file.write_text("setup(\n    data_file=[],  # data\n)\n")
    message = "r: setuptools does not know the argument data_file of setup(), and ignores it."
    hint = "Did you mean `data_files`?"
    text = "setup(\n    data_files=[],  # data\n)\n"
    assert fixed(file, "unknown-setup-option", 2, message, hint) == text
    assert fixed(file, "unknown-setup-option", 2, message, hint) is None


def test_dashes_in_setup_cfg(tmp_path: Path) -> None:
    file = tmp_path / "setup.cfg"
    file.write_text("[develop]\nscript-dir=$base/lib/r\n[install]\ninstall-scripts = $base/lib/r\n")
    message = "A later setuptools will not know script-dir, install-scripts in setup.cfg of r."
    assert fixed(file, "unknown-setup-option", 2, message, "") == (
        "[develop]\nscript_dir=$base/lib/r\n[install]\ninstall_scripts = $base/lib/r\n"
    )


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (
            "[develop]\nscript_dir=$base/lib/r\n",
            "[develop]\nscript_dir=$base/lib/r\n[install]\ninstall_scripts=$base/lib/r\n",
        ),
        (
            "[metadata]\nname = r",
            (
                "[metadata]\nname = r\n[develop]\nscript_dir=$base/lib/r\n"
                "[install]\ninstall_scripts=$base/lib/r\n"
            ),
        ),
        (
            "[develop]\nscript-dir=$base/lib/q\n[install]\noptimize = 1\n",
            (
                "[develop]\nscript-dir=$base/lib/r\n[install]\ninstall_scripts=$base/lib/r\n"
                "optimize = 1\n"
            ),
        ),
    ],
)
def test_the_folder_of_scripts(tmp_path: Path, before: str, after: str) -> None:
    file = tmp_path / "setup.cfg"
    file.write_text(before)
    place = "$base/lib/r"
    hint = (
        f"Write in setup.cfg: [install] install_scripts={place}, and [develop] script_dir={place}."
    )
    assert fixed(file, "broken-console-script", 1, "", hint) == after
    assert fixed(file, "broken-console-script", 1, "", hint) is None


@pytest.mark.parametrize(
    ("before", "after"),
    [
        (
            "install(DIRECTORY urdf DESTINATION share/${PROJECT_NAME})\nament_package()\n",
            "install(DIRECTORY urdf meshes DESTINATION share/${PROJECT_NAME})\nament_package()\n",
        ),
        (
            "install(\n  DIRECTORY\n    launch\n    urdf\n  DESTINATION share/r\n)\n",
            "install(\n  DIRECTORY\n    launch\n    urdf\n    meshes\n  DESTINATION share/r\n)\n",
        ),
        (
            "install(DIRECTORY urdf/ DESTINATION share/r)\n# end\nament_package()\n",
            (
                "install(DIRECTORY urdf/ DESTINATION share/r)\n# end\n"
                "install(DIRECTORY meshes DESTINATION share/${PROJECT_NAME})\nament_package()\n"
            ),
        ),
        (
            "if(A)\ninstall(DIRECTORY urdf DESTINATION share/r)\nendif()\nament_package()\n",
            (
                "if(A)\ninstall(DIRECTORY urdf DESTINATION share/r)\nendif()\n"
                "install(DIRECTORY meshes DESTINATION share/${PROJECT_NAME})\nament_package()\n"
            ),
        ),
        ("install(DIRECTORY include DESTINATION include)\n", None),
        ("if(A)\nament_package()\nendif()\n", None),
    ],
)
def test_a_folder_that_is_not_installed(tmp_path: Path, before: str, after: str | None) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text(before)
    message = "r does not install its folder meshes."
    assert fixed(file, "folder-not-installed", 1, message) == after


def test_a_program_that_is_not_installed(tmp_path: Path) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text("add_executable(n n.cpp)\nament_package()\n")
    install = "install(TARGETS n DESTINATION lib/${PROJECT_NAME})"
    assert fixed(file, "program-not-installed", 1, "", f"Add: {install}") == (
        f"add_executable(n n.cpp)\n{install}\nament_package()\n"
    )


@pytest.mark.parametrize(
    ("before", "kind", "after"),
    [
        (
            "install(FILES launch DESTINATION s)",
            "DIRECTORY",
            "install(DIRECTORY launch DESTINATION s)",
        ),
        ("install(DIRECTORY a.yaml DESTINATION s)", "FILES", "install(FILES a.yaml DESTINATION s)"),
        ("install(FILES launch a.py DESTINATION s)", "DIRECTORY", None),
    ],
)
def test_the_kind_of_a_path(tmp_path: Path, before: str, kind: str, after: str | None) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text(before)
    hint = f"Write: install({kind} launch DESTINATION ...)"
    assert fixed(file, "wrong-kind-of-path", 1, "", hint) == after


@pytest.mark.parametrize(
    ("before", "message", "after"),
    [
        ("import rclpy\n", "no interpreter", "#!/usr/bin/env python3\nimport rclpy\n"),
        ("#!/usr/bin/python\na\n", "`python`", "#!/usr/bin/env python3\na\n"),
        ("#!/bin/a\r\nb\r\n", "n.py has line endings of Windows (CRLF), so", "#!/bin/a\nb\n"),
    ],
)
def test_the_first_line_of_a_program(tmp_path: Path, before: str, message: str, after: str) -> None:
    file = tmp_path / "n.py"
    file.write_bytes(before.encode())
    hint = "Write as its first line: #!/usr/bin/env python3"
    assert fixed(file, "broken-shebang", 1, message, hint) == after


MARKER = "('share/ament_index/resource_index/packages', ['resource/r'])"


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ("[('a', ['b'])]", f"[{MARKER}, ('a', ['b'])]"),
        ("[\n    ('a', ['b']),\n]", f"[\n    {MARKER},\n    ('a', ['b']),\n]"),
        ("[]", f"[{MARKER}]"),
        ("files", None),
    ],
)
def test_the_marker_of_a_package(tmp_path: Path, before: str, after: str | None) -> None:
    file = tmp_path / "setup.py"
    file.write_text(f"setup(data_files={before})\n")
    hint = f"Create the empty file resource/r, and add to data_files: {MARKER}"
    assert fixed(file, "missing-marker", 1, "", hint) is None
    (tmp_path / "resource").mkdir()
    (tmp_path / "resource" / "r").touch()
    wanted = after and f"setup(data_files={after})\n"
    assert fixed(file, "missing-marker", 1, "", hint) == wanted


def test_no_marker_where_setup_names_another_package(tmp_path: Path) -> None:
    (tmp_path / "resource").mkdir()
    (tmp_path / "resource" / "r").touch()
    file = tmp_path / "setup.py"
    hint = f"Add to data_files: {MARKER}"
    file.write_text("package_name = 's'\nsetup(name=package_name, data_files=[])\n")
    assert fixed(file, "missing-marker", 1, "", hint) is None
    file.write_text("package_name = 'r'\nsetup(name=package_name, data_files=[])\n")
    assert fixed(file, "missing-marker", 1, "", hint) is not None
