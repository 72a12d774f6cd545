"""What is not installed is reported once, with what follows from it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from cart_package import check_cart
from wsgen.pipeline.reported import Filters, filter_outcome

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = pytest.mark.slow
INSTALL = "launch urdf worlds config"
ALL = Filters()


def report(
    folder: Path, changes: dict[str, tuple[str, str]], filters: Filters = ALL
) -> list[tuple[str, str, str]]:
    """Names, severities and messages of the errors and warnings."""
    _, outcome = check_cart(folder, changes)
    return [
        (one.name, one.severity.value, one.message)
        for one in filter_outcome(outcome, filters).diagnostics
        if one.severity.value != "info"
    ]


def test_a_folder_of_robots(tmp_path: Path) -> None:
    [(name, severity, message)] = report(
        tmp_path, {"CMakeLists.txt": (INSTALL, "launch worlds config")}
    )
    assert (name, severity) == ("folder-not-installed", "error")
    assert message.startswith("cart does not install its folder urdf. In cart.launch.py (line ")


def test_a_folder_of_launch_files(tmp_path: Path) -> None:
    [(name, severity, _)] = report(tmp_path, {"CMakeLists.txt": (INSTALL, "urdf worlds config")})
    assert (name, severity) == ("folder-not-installed", "error")


def test_who_ignores_the_cause_sees_what_follows(tmp_path: Path) -> None:
    changes = {"CMakeLists.txt": (INSTALL, "launch worlds config")}
    [(name, severity, _)] = report(tmp_path, changes, Filters(ignore=["folder-not-installed"]))
    assert (name, severity) == ("file-not-installed", "error")


def test_a_folder_of_launch_files_that_the_readme_starts_by_path(tmp_path: Path) -> None:
    (tmp_path / "src/cart").mkdir(parents=True)
    (tmp_path / "src/cart/README.md").write_text("    ros2 launch ./launch/cart.launch.py\n")
    [(name, severity, _)] = report(tmp_path, {"CMakeLists.txt": (INSTALL, "urdf worlds config")})
    assert (name, severity) == ("folder-not-installed", "warning")


def test_a_spawner_of_another_simulator_is_no_dependency(tmp_path: Path) -> None:
    create = "package='ros_gz_sim', executable='create'"
    [(name, severity, _)] = report(
        tmp_path,
        {
            "launch/cart.launch.py": (
                create,
                "package='gazebo_ros', executable='spawn_entity.py'",
            )
        },
    )
    assert (name, severity) == ("spawner-of-other-simulator", "error")


def test_a_program_that_install_looks_for_in_another_folder(tmp_path: Path) -> None:
    """The node that cannot be started is no second mistake, nor is what the misspelling hides."""
    launch = "launch/cart.launch.py"
    changes = {
        "CMakeLists.txt": (
            "ament_package()",
            "install(PROGRAMS drive.py DESTINATION lib/cart)\nament_package()",
        ),
        launch: (
            "    return LaunchDescription([",
            "    return LaunchDescription([\n        Node(package='cart', executable='drive.py'),",
        ),
    }
    (tmp_path / "src/cart/scripts").mkdir(parents=True)
    (tmp_path / "src/cart/scripts/drive.py").write_text("#!/usr/bin/env python3\nprint()\n")
    assert [name for name, _, _ in report(tmp_path, changes)] == ["missing-installed-path"]


def test_a_package_whose_name_is_misspelled(tmp_path: Path) -> None:
    assert [
        name
        for name, _, _ in report(
            tmp_path, {"package.xml": ("<name>cart</name>", "<name>crat</name>")}
        )
    ] == ["different-names"]


def test_a_misspelled_element_of_the_manifest(tmp_path: Path) -> None:
    wrong = ("<exec_depend>xacro</exec_depend>", "<exec_depends>xacro</exec_depends>")
    [(name, _, _)] = report(tmp_path, {"package.xml": wrong})
    assert name == "invalid-manifest"


def test_a_simulator_that_is_not_added(tmp_path: Path) -> None:
    include = """        IncludeLaunchDescription(
            PythonLaunchDescriptionSource(gazebo),
            launch_arguments={'gz_args': ['-r ', world]}.items())"""
    begin = "    return LaunchDescription([\n"
    where = "os.path.join(get_package_share_directory('ros_gz_sim'), 'launch', 'gz_sim.launch.py')"
    created = f"    simulator ={include[7:]}\n".replace("(gazebo)", f"({where})")
    wrong = (f"{begin}{include},\n", f"{created}{begin}")
    found = report(tmp_path, {"launch/cart.launch.py": wrong})
    assert ("no-simulator", "error") in [(name, severity) for name, severity, _ in found]


def test_a_world_that_gazebo_is_not_given(tmp_path: Path) -> None:
    """That the empty world lacks a system for a sensor is no second mistake."""
    launch = "launch/cart.launch.py"
    for number, (right, wrong, name) in enumerate(
        (
            ("['-r ', world]", "['-r', world]", "glued-arguments"),
            ("'gz_args'", "'gz_arg'", "unused-include-argument"),
        )
    ):
        found = report(tmp_path / str(number), {launch: (right, wrong)})
        assert [(one, severity) for one, severity, _ in found] == [(name, "error")]


def test_a_spawner_of_controllers_that_humble_has_not(tmp_path: Path) -> None:
    found = report(tmp_path, {"launch/cart.launch.py": ("='spawner'", "='spawner.py'")})
    assert [name for name, _, _ in found] == ["executable-not-found"]


def test_a_path_that_lacks_a_slash(tmp_path: Path) -> None:
    wrong = ("os.path.join(share, 'worlds', 'office.sdf')", "share + 'worlds/office.sdf'")
    [(name, _, message)] = report(tmp_path, {"launch/cart.launch.py": wrong})
    assert name == "missing-world"
    assert message.endswith("'/' is missing after the share folder of cart.")
