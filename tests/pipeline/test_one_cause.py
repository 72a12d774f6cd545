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
