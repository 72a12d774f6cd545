"""`wsgen validate` of a package whose launch file names a world with more than a ground."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from cli.packages import PACKAGE, SHARE, errors, validate

if TYPE_CHECKING:
    from pathlib import Path


pytestmark = pytest.mark.slow

GROUND = "<include><uri>model://ground_plane</uri></include>"
BALL = (
    '<model name="ball"><pose>3 0 0.1 0 0 0</pose><link name="l">'
    "<inertial><mass>1</mass><inertia><ixx>0.004</ixx><iyy>0.004</iyy><izz>0.004</izz></inertia>"
    '</inertial><collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry>'
    "</collision></link></model>"
)


def block(name: str, pose: str, size: str) -> str:
    """A static box."""
    geometry = f"<geometry><box><size>{size}</size></box></geometry>"
    return (
        f'<model name="{name}"><static>true</static><pose>{pose}</pose><link name="l">'
        f'<collision name="c">{geometry}</collision><visual name="v">{geometry}</visual>'
        "</link></model>"
    )


def validate_in(
    built: Path, folder: Path, content: str, *options: str
) -> tuple[int, dict[str, Any]]:
    """What is said of the package in a world of that content."""
    file = folder / "test.world"
    file.write_text(f'<sdf version="1.6"><world name="test">{content}</world></sdf>')
    code, document, stderr = validate(built, "--arg", f"world:={file}", *options)
    assert document, stderr
    return code, document


def found(document: dict[str, Any]) -> list[tuple[str, str]]:
    (package,) = document["packages"]
    return [(one["code"], one["severity"]) for one in package["diagnostics"]]


@pytest.mark.parametrize("engine", ["bullet", "dart"])
def test_the_robot_stands_on_a_platform_of_the_world(
    built: Path, tmp_path: Path, engine: str
) -> None:
    platform = block("platform", "0 0 1 0 0 0", "4 4 2")
    code, document = validate_in(
        built, tmp_path, GROUND + platform, "--arg", "z:=2.3", "--engine", engine
    )
    (package,) = document["packages"]
    (robot,) = package["robots"]  # the platform is none
    assert (code, package["diagnostics"]) == (0, [])
    assert robot["rest"]["xyz"] == pytest.approx([0, 0, 2.25], abs=0.003)
    assert package["world"]["models"] == ["ground_plane", "platform"]


def test_a_world_without_ground_plane_can_carry_the_robot(built: Path, tmp_path: Path) -> None:
    code, document = validate_in(built, tmp_path, block("floor", "0 0 -0.5 0 0 0", "9 9 1"))
    assert (code, found(document)) == (0, [])


def test_spawned_into_a_wall(built: Path, tmp_path: Path) -> None:
    wall = block("wall", "0.5 0 1 0 0 0", "0.4 4 2")
    code, document = validate_in(built, tmp_path, GROUND + wall)
    assert code == 1
    assert errors(document)[0]["code"] == "SPN063"
    assert errors(document)[0]["element"] == "simple_robot"
    assert "`simple_robot` overlaps the model `wall`" in errors(document)[0]["message"]


def test_what_lies_about_is_no_fault_of_the_robot(built: Path, tmp_path: Path) -> None:
    high = BALL.replace("3 0 0.1", "3 0 2")
    code, document = validate_in(built, tmp_path, GROUND + high)
    assert code == 0
    assert found(document) == [("SPN054", "warning")]
    assert document["packages"][0]["diagnostics"][0]["element"] == "ball"


def test_a_ball_that_falls_out_of_the_world_is_a_warning(built: Path, tmp_path: Path) -> None:
    floor = block("floor", "0 0 -0.5 0 0 0", "2 2 1")
    code, document = validate_in(built, tmp_path, floor + BALL)
    assert (code, found(document)) == (0, [("SPN056", "warning")])


def test_a_robot_cannot_have_the_name_of_a_model(built: Path, tmp_path: Path) -> None:
    taken = BALL.replace('"ball"', '"simple_robot"')
    code, document = validate_in(built, tmp_path, GROUND + taken)
    assert (code, found(document)) == (1, [("SPN049", "error")])
    assert "the world has a model of that name" in errors(document)[0]["message"]
    assert [robot["mass"] for robot in document["packages"][0]["robots"]] == [1.0]


def test_models_that_the_launch_file_makes_known(built: Path, tmp_path: Path) -> None:
    models = tmp_path / "models"
    (models / "crate").mkdir(parents=True)
    (models / "crate" / "model.sdf").write_text(
        f'<sdf version="1.6">{block("crate", "0 0 0.5 0 0 0", "2 2 1")}</sdf>'
    )
    launch = built / SHARE / "launch" / "gazebo_model.launch.py"
    aside = launch.with_name("with_models.launch.py")
    aside.write_text(
        launch.read_text()
        .replace("IncludeLaunchDescription\n", "IncludeLaunchDescription, SetEnvironmentVariable\n")
        .replace(
            "LaunchDescription([",
            f"LaunchDescription([SetEnvironmentVariable('GAZEBO_MODEL_PATH', '{models}'), ",
        )
    )
    try:
        crate = "<include><uri>model://crate</uri></include>"
        options = ("--launch", aside.name, "--arg", "z:=1.3")
        code, document = validate_in(built, tmp_path, GROUND + crate, *options, PACKAGE)
    finally:
        aside.unlink()
    assert code == 0, found(document)
    (robot,) = document["packages"][0]["robots"]
    assert robot["rest"]["xyz"][2] == pytest.approx(1.25, abs=0.003)


def test_a_broken_world_is_reported_and_the_package_fails(built: Path, tmp_path: Path) -> None:
    broken = 2 * block("wall", "3 0 1 0 0 0", "1 4 2")
    code, document = validate_in(built, tmp_path, GROUND + broken)
    assert code == 1
    assert errors(document)[0]["code"] == "WLD015"
    assert errors(document)[0]["file"].endswith("test.world")


def test_a_spawned_sdf_model(built: Path, tmp_path: Path) -> None:
    launch = built / SHARE / "launch" / "gazebo_model.launch.py"
    aside = launch.with_name("sdf.launch.py")
    model = tmp_path / "ball.sdf"
    # The pose of the spawner counts, not that of the model.
    model.write_text(f'<?xml version="1.0"?>\n<!-- a ball -->\n<sdf version="1.6">{BALL}</sdf>')
    aside.write_text(
        launch.read_text().replace("'-topic', 'robot_description'", f"'-file', '{model}'")
    )
    try:
        options = ("--launch", aside.name, "--arg", "y:=1", PACKAGE)
        code, document = validate_in(built, tmp_path, GROUND, *options)
    finally:
        aside.unlink()
    (robot,) = document["packages"][0]["robots"]
    assert (code, found(document)) == (0, [])
    assert (robot["entity"], robot["spawn_pose"]["xyz"]) == ("simple_robot", [0.0, 1.0, 0.3])
    assert robot["rest"]["xyz"] == pytest.approx([0, 1, 0.1], abs=0.002)


def test_a_picture_of_the_whole_world_where_it_holds_more(built: Path, tmp_path: Path) -> None:
    wall = block("wall", "3 0 1 0 0 0", "0.4 4 2")
    pictures = tmp_path / "pictures"
    _, document = validate_in(built, tmp_path, GROUND + wall, "--picture", str(pictures))
    package = document["packages"][0]
    assert package["picture"] == str(pictures / "gazebo_test.png")
    assert package["world_picture"] == str(pictures / "gazebo_test-world.png")
    _, alone = validate_in(built, tmp_path, GROUND, "--picture", str(pictures))
    assert alone["packages"][0]["world_picture"] is None


def test_a_robot_may_lean_on_a_slope(built: Path, tmp_path: Path) -> None:
    slope = block("slope", "0 0 1 0 0.35 0", "6 6 0.2")
    crate = tmp_path / "crate.sdf"
    inertia = "<ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz>"
    crate.write_text(
        '<sdf version="1.6"><model name="crate"><link name="l"><inertial><mass>1</mass><inertia>'
        f'{inertia}</inertia></inertial><collision name="c"><geometry><box><size>0.3 0.3 0.1</size>'
        "</box></geometry></collision></link></model></sdf>"
    )
    launch = built / SHARE / "launch" / "gazebo_model.launch.py"
    aside = launch.with_name("crate.launch.py")
    text = launch.read_text()
    aside.write_text(text.replace("'-topic', 'robot_description'", f"'-file', '{crate}'"))
    try:
        options = ("--launch", aside.name, "--arg", "z:=1.25", PACKAGE)
        code, document = validate_in(built, tmp_path, GROUND + slope, *options)
    finally:
        aside.unlink()
    assert (code, found(document)) == (0, [("SPN059", "warning")])


def test_what_is_broken_in_a_world_takes_nothing_else_away(built: Path, tmp_path: Path) -> None:
    broken = (
        '<model name="bad"><static>true</static><pose>9 0 0 0 0 0</pose><link name="l">'
        '<collision name="c"><geometry><mesh><uri>none.stl</uri></mesh></geometry></collision>'
        "</link></model>"
    )
    platform = block("platform", "0 0 1 0 0 0", "4 4 2")
    code, document = validate_in(built, tmp_path, GROUND + broken + platform, "--arg", "z:=2.3")
    assert (code, found(document)) == (1, [("ROB060", "error")])
    assert document["packages"][0]["robots"][0]["rest"]["xyz"][2] == pytest.approx(2.25, abs=0.003)


def test_what_is_spawned_cannot_be_called_as_the_ground(built: Path, tmp_path: Path) -> None:
    launch = built / SHARE / "launch" / "gazebo_model.launch.py"
    aside = launch.with_name("ground.launch.py")
    aside.write_text(launch.read_text().replace("'simple_robot'", "'ground_plane'"))
    try:
        code, document = validate_in(built, tmp_path, GROUND, "--launch", aside.name, PACKAGE)
    finally:
        aside.unlink()
    assert (code, found(document)) == (1, [("SPN049", "error")])


def test_a_spawned_model_without_links_is_no_robot(built: Path, tmp_path: Path) -> None:
    launch = built / SHARE / "launch" / "gazebo_model.launch.py"
    aside = launch.with_name("nothing.launch.py")
    model = '<sdf version="1.6"><model name="m"><static>true</static></model></sdf>'
    (tmp_path / "nothing.sdf").write_text(model)
    text = launch.read_text()
    given = f"'-file', '{tmp_path}/nothing.sdf'"
    aside.write_text(text.replace("'-topic', 'robot_description'", given))
    try:
        code, document = validate_in(built, tmp_path, GROUND, "--launch", aside.name, PACKAGE)
    finally:
        aside.unlink()
    assert (code, found(document)) == (1, [("SPN003", "error")])
