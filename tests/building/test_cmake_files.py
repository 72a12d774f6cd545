"""CMakeLists.txt as text, and what CMake prints."""

from pathlib import Path

import pytest

from wsgen.building.failure import fold_details, read_errors, split_deprecations
from wsgen.packages.build_files.cmake_text import read_calls

TEXT = """\
# find_package(commented REQUIRED)
Find_Package(ament_cmake
  REQUIRED)  # with a comment
#[[ install(DIRECTORY
  launch) ]]
message("a # that is no comment (nor a bracket")
if(NOT (A AND B))
install(
  DIRECTORY launch
    "my model"
  DESTINATION share/${PROJECT_NAME})
"""


def test_calls(tmp_path: Path) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text(TEXT)
    calls = read_calls(file)
    assert [(call.command, call.line) for call in calls if call.command != "message"] == [
        ("find_package", 2),
        ("if", 7),
        ("install", 8),
    ]
    install = calls[-1]
    assert install.arguments[:3] == ("DIRECTORY", "launch", "my model")
    assert install.argument_lines[:3] == (9, 9, 10)


def test_no_file(tmp_path: Path) -> None:
    assert read_calls(tmp_path / "CMakeLists.txt") == ()


PRINTED = """\
CMake Warning at CMakeLists.txt:1 (message):
  not this one

CMake Error at {folder}/cmake/more.cmake:3 (message):
  The first
  error.

  Its second paragraph.
Call Stack (most recent call first):
  /opt/ros/share/x.cmake:9 (include)
  CMakeLists.txt:5 (go)


-- Configuring incomplete, errors occurred!
CMake Error: Something  without a place.
"""


def test_errors(tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text("\n\n\n\ngo()\n")
    first, second = read_errors(PRINTED.format(folder="/elsewhere"))
    assert first.message == "The first error. Its second paragraph."
    assert first.command == "message"
    assert first.locate(tmp_path) == (tmp_path / "CMakeLists.txt", 5)
    assert second.message == "Something without a place."
    assert second.locate(tmp_path) == (None, None)


def test_the_innermost_place_in_the_package_counts(tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text("\n\n\n\ngo()\n")
    (tmp_path / "cmake").mkdir()
    more = tmp_path / "cmake" / "more.cmake"
    more.write_text("\n\n  MESSAGE(FATAL_ERROR error)\n")
    first, _ = read_errors(PRINTED.format(folder=tmp_path))
    assert first.locate(tmp_path) == (more, 3)


def test_a_file_of_another_project_with_the_same_name_is_not_the_place(tmp_path: Path) -> None:
    """CMake names the files of a project that a package downloads as seen from that project."""
    (tmp_path / "CMakeLists.txt").write_text("\n\n\n\nstop()\n")
    first, _ = read_errors(PRINTED.format(folder="/elsewhere"))
    assert first.locate(tmp_path) == (None, None)


TEXT_OF_DEPRECATION = """\
  Compatibility with CMake < 3.10 will be removed from a future version of
  CMake.

  Update the VERSION argument <min> value.  Or, use the <min>...<max> syntax
  to tell CMake that the project requires at least <min>.
"""


@pytest.mark.parametrize(
    ("heading", "ending"),
    [
        ("CMake Deprecation Warning at CMakeLists.txt:1 (cmake_minimum_required):", "\n\n"),
        (
            "CMake Warning (deprecated) at CMakeLists.txt:1 (cmake_minimum_required):",
            (
                "This warning is for project developers.  Use -Wno-author or -Wno-deprecated\n"
                "to suppress it.\n\n"
            ),
        ),
    ],
)
def test_deprecated_minimum_versions(heading: str, ending: str) -> None:
    other = "CMake Deprecation Warning at CMakeLists.txt:7 (cmake_policy):\n  The OLD behavior"
    text = f"before\n{heading}\n{TEXT_OF_DEPRECATION}{ending}{other}\nafter"
    lines, places = split_deprecations(text.splitlines())
    assert places == (("CMakeLists.txt", 1),)
    assert "\n".join(lines) == f"before\n{other}\nafter"


def test_an_error_about_a_whole_file_is_read() -> None:
    text = "CMake Error in CMakeLists.txt:\n  No cmake_minimum_required command is present.\n\n"
    (error,) = read_errors(text)
    assert (error.message, error.frames) == ("No cmake_minimum_required command is present.", ())


BARE = "CMake Error: {}\n"
PLACED = "CMake Error at CMakeLists.txt:{} (configure_file):\n  It failed.\n\n\n"
WHOLE = "CMake Error in CMakeLists.txt:\n  Also wrong.\n\n"


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        # Each command keeps the first error that its own code prints.
        (
            BARE.format("No a.")
            + BARE.format("So no b.")
            + PLACED.format(3)
            + BARE.format("No c.")
            + PLACED.format(4),
            ["It failed. (No a.)", "It failed. (No c.)"],
        ),
        (PLACED.format(3) + BARE.format("It is not set."), ["It failed."]),
        # What is wrong with the whole file is no detail of a command, and has none.
        (PLACED.format(3) + WHOLE, ["It failed.", "Also wrong."]),
        (PLACED.format(3) + BARE.format("It is not set.") + WHOLE, ["It failed.", "Also wrong."]),
        # Without a command to blame, every error counts.
        (BARE.format("No a.") + BARE.format("No b.") + WHOLE, ["No a.", "No b.", "Also wrong."]),
    ],
)
def test_errors_around_that_of_a_command(text: str, messages: list[str]) -> None:
    assert [error.message for error in fold_details(read_errors(text))] == messages
