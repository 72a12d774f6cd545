"""What is swept, and the blueprints that its values give."""

from __future__ import annotations

import gc
import os
import pickle
import shutil
import threading
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, cast

import pytest

import public_robots
from kind_workspaces import WORKSPACES
from wsgen.diagnostics import Severity
from wsgen.errors import NotFoundError, RequestError
from wsgen.model.robot import Mesh
from wsgen.model.sweep import Design, Variant
from wsgen.model.target import choose_target
from wsgen.packages.workspace.layout import Workspace
from wsgen.pipeline.create import create
from wsgen.pipeline.requests import ValidateRequest
from wsgen.pipeline.validate import validate
from wsgen.sweeping.robot_subjects import open_subject
from wsgen.sweeping.run_variant import run_variant
from wsgen.sweeping.subject import SubjectRequest
from wsgen.sweeping.words import make_design, read_axes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from wsgen.model.outcome import PackageOutcome
    from wsgen.sweeping.run_variant import Blueprint
    from wsgen.sweeping.subject import Subject


REPORTED = (Severity.ERROR, Severity.WARNING)
XACRO = """\
<robot name="tower" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:arg name="height" default="0.5"/>
  <xacro:include filename="part.xacro"/>
  <link name="base">
    <inertial>
      <mass value="$(arg mass)"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
    </inertial>
    <visual><geometry><box size="0.2 0.2 $(arg height)"/></geometry></visual>
    <collision><geometry><box size="0.2 0.2 $(arg height)"/></geometry></collision>
  </link>
</robot>
"""
PART = """\
<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="mass" default="2"/></robot>
"""


@contextmanager
def opened(**fields: object) -> Iterator[Subject]:
    request = SubjectRequest(**fields)  # type: ignore[arg-type]
    with open_subject(request, environment=os.environ) as subject:
        yield subject


@pytest.fixture
def tower(tmp_path: Path) -> Path:
    (tmp_path / "part.xacro").write_text(PART)
    file = tmp_path / "tower.urdf.xacro"
    file.write_text(XACRO)
    return file


def mass_of(blueprint: Blueprint) -> float:
    return sum(robot.lumped.mass for robot in blueprint.prepared)


def codes_of(blueprint: Blueprint) -> set[str]:
    return {found.code for found in blueprint.diagnostics if found.severity in REPORTED}


def grid(*words: str) -> Design:
    return make_design(read_axes(words), ())


def validated(workspace: Workspace | None, package: str | None, file: Path | None) -> object:
    request = ValidateRequest(packages=(package,) if package else (), files=(file,) if file else ())
    (outcome,) = validate(workspace, request, environment=os.environ).packages
    return outcome


def as_validated(subject: Subject, outcome: object) -> None:
    """Compare the run of a blueprint with what `wsgen validate` says."""
    found: PackageOutcome = outcome  # type: ignore[assignment]
    blueprint = subject.prepare({})
    row = run_variant(blueprint, Variant(number=0, values={}), 3.0, "bullet")
    codes = {one.code for one in found.diagnostics if one.severity in REPORTED}
    assert (row.passed, set(row.codes)) == (found.passed, codes)
    robots = [one for one in blueprint.prepared if not one.is_static_model]
    assert [one.entity for one in robots] == [one.entity for one in found.robots]
    for robot, simulated in zip(robots, found.robots, strict=True):
        assert simulated.description is not None
        assert robot.written.links == simulated.description.links
        assert robot.written.joints == simulated.description.joints
        assert robot.on_the_ground or robot.spawn_pose == simulated.spawn_pose
    assert blueprint.name


# Files


@pytest.mark.slow
def test_a_xacro_file_has_its_arguments_and_those_of_what_it_includes(tower: Path) -> None:
    with opened(file=tower) as subject:
        assert subject.own_names == ("height", "mass")
        assert {one.name: one.default for one in subject.parameters} == {
            "height": "0.5",
            "mass": "2",
        }
        assert mass_of(subject.prepare({})) == 2.0
        assert mass_of(subject.prepare({"mass": 3.5})) == 3.5
        (text,) = subject.texts({"mass": 4, "world.slope": 0.1})
        assert (text.entity, '<mass value="4"/>' in text.text) == ("tower", True)


@pytest.mark.slow
def test_arguments_stay_where_they_do_not_vary(tower: Path) -> None:
    with opened(file=tower, launch_arguments={"mass": "7"}) as subject:
        assert mass_of(subject.prepare({"height": 0.3})) == 7.0
        assert mass_of(subject.prepare({"mass": 1})) == 1.0


@pytest.mark.slow
def test_a_required_argument_is_a_parameter(tower: Path) -> None:
    tower.write_text(XACRO.replace('<xacro:arg name="height" default="0.5"/>', ""))
    with opened(file=tower) as subject:
        assert subject.own_names == ("mass", "height")
        assert "ROB071" in codes_of(subject.prepare({}))
        assert mass_of(subject.prepare({"height": 1})) == 2.0


@pytest.mark.slow
def test_a_variant_that_does_not_expand_says_why(tower: Path) -> None:
    with opened(file=tower) as subject:
        broken = subject.prepare({"mass": "heavy"})
        assert any(one.severity is Severity.ERROR for one in broken.diagnostics)
        assert not broken.prepared or not broken.prepared[0].can_run
        tower.write_text("<robot")
        assert codes_of(subject.prepare({"mass": 1.25}))


@pytest.mark.slow
def test_an_unknown_argument_is_refused(tower: Path) -> None:
    with opened(file=tower) as subject:
        with pytest.raises(RequestError, match=r"The file tower\.urdf\.xacro has no") as caught:
            subject.check(grid("hight=1,2"))
        assert "Did you mean `height`?" in caught.value.hint
        assert "<xacro:arg" in caught.value.hint
        assert subject.check(grid("height=1,2", "world.slope=0,1")).names == (
            "height",
            "world.slope",
        )


def test_a_urdf_has_no_parameters_of_its_own(tmp_path: Path) -> None:
    file = tmp_path / "tower.urdf"
    file.write_text(XACRO.replace("$(arg mass)", "2").replace("$(arg height)", "1"))
    file.write_text(
        "\n".join(line for line in file.read_text().splitlines() if "xacro" not in line)
    )
    file.write_text(f'<robot name="tower">{file.read_text()}')
    with opened(file=file) as subject:
        assert subject.own_names == ()
        assert mass_of(subject.prepare({})) == 2.0
        assert subject.prepare({}) is subject.prepare({"world.slope": 0.3})
        with pytest.raises(RequestError, match="Only a xacro file has parameters"):
            subject.check(grid("mass=1,2"))


def test_requests_that_name_nothing_or_too_much(tower: Path) -> None:
    for fields in ({}, {"file": tower, "template": "simple"}):
        with pytest.raises(RequestError, match="one package, one file or one template"):
            opened(**fields).__enter__()
    with pytest.raises(RequestError, match="--set has no effect"):
        opened(file=tower, settings=("a=1",)).__enter__()
    with pytest.raises(RequestError, match="Remove --launch"):
        opened(file=tower, launch_file="x.launch.py").__enter__()
    with pytest.raises(NotFoundError, match="does not exist"):
        opened(file=tower.with_name("none.urdf")).__enter__()
    with pytest.raises(RequestError, match="does not exist"):
        opened(package="nobody_knows_it").__enter__()


# What is kept


@pytest.mark.slow
def test_blueprints_are_kept_by_their_values(tower: Path) -> None:
    with opened(file=tower, kept=2) as subject:
        first = subject.prepare({"mass": 1})
        assert subject.prepare({"mass": 1, "push.force": 3.0}) is first
        assert subject.prepare({"mass": "1"}) is not first  # a text is no number
        subject.prepare({"mass": 2})
        again = subject.prepare({"mass": 1})
        assert again is not first
        assert again.prepared == first.prepared


@pytest.mark.slow
def test_files_are_there_as_long_as_the_blueprint(tmp_path: Path) -> None:
    file = tmp_path / "cone.sdf"
    cone = "<geometry><cone><radius>0.1</radius><length>0.2</length></cone></geometry>"
    file.write_text(
        f'<sdf version="1.11"><model name="cone"><link name="base"><collision name="c">{cone}'
        "</collision></link></model></sdf>"
    )
    with opened(file=file, kept=1) as subject:
        blueprint = subject.prepare({})
        assert all(path.is_file() for path in meshes_of(blueprint))
        folders = [*subject.folder.glob("variant-*")]
        assert len(folders) == 1
        subject._slots.clear()
        assert folders[0].is_dir()
        del blueprint
        gc.collect()
        assert not folders[0].exists()
        assert subject.texts({})[0].text == file.read_text()


def meshes_of(blueprint: Blueprint) -> list[Path]:
    found = [
        Path(collision.geometry.path)
        for robot in blueprint.prepared
        for link in robot.lumped.links
        for collision in link.collisions
        if isinstance(collision.geometry, Mesh) and collision.geometry.path
    ]
    assert found
    return found


@pytest.mark.slow
def test_meshes_are_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = public_robots.find_robot("pybullet", "kuka_iiwa/model.urdf")
    if file is None:
        pytest.skip("PyBullet's robots are not installed")
    text = file.read_text().replace('<mass value="0.0"/>', '<mass value="5.0"/>')
    text = text.replace('ixx="0"', 'ixx="1"').replace('iyy="0"', 'iyy="1"')
    text = text.replace('izz="0"', 'izz="1"')
    copy = tmp_path / "kuka_iiwa"
    shutil.copytree(file.parent, copy)
    changed = text.replace('<mass value="2.7"/>', '<mass value="$(arg mass)"/>')
    assert changed != text
    start = changed.index(">", changed.index("<robot ")) + 1
    argument = '<xacro:arg name="mass" default="2.7"/>'
    (copy / "model.urdf.xacro").write_text(changed[:start] + argument + changed[start:])
    with opened(file=copy / "model.urdf.xacro") as subject:
        asked: list[str] = []
        run = subject._run  # type: ignore[attr-defined]
        inner = run.__self__._run

        def count(task: str, *arguments: object, **keywords: object) -> object:
            asked.append(task)
            return inner(task, *arguments, **keywords)

        monkeypatch.setattr(run.__self__, "_run", count)
        one, other = (subject.prepare({"mass": mass}) for mass in (10.0, 20.0))
        assert mass_of(other) - mass_of(one) == pytest.approx(10.0)
        assert asked.count("wsgen.descriptions.meshes.worker:inspect") == 1
        assert meshes_of(one) == meshes_of(other)
        assert all(path.is_file() for path in meshes_of(one))


@pytest.mark.slow
def test_threads_share_a_subject(tower: Path) -> None:
    with opened(file=tower) as subject:
        found: dict[int, list[Blueprint]] = {}

        def prepare(mass: int) -> None:
            found.setdefault(mass, []).append(subject.prepare({"mass": mass}))

        threads = [
            threading.Thread(target=prepare, args=(mass,)) for mass in (1, 2, 3, 1, 2, 3, 1, 2, 3)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    assert {mass: mass_of(one[0]) for mass, one in found.items()} == {1: 1.0, 2: 2.0, 3: 3.0}
    assert all(one is same[0] for same in found.values() for one in same)
    assert [len(same) for same in found.values()] == [3, 3, 3]


def test_a_blueprint_can_be_pickled(tower: Path) -> None:
    with opened(file=tower) as subject:
        blueprint = subject.prepare({"mass": 3})
        assert pickle.loads(pickle.dumps(blueprint)) == blueprint  # noqa: S301  it is ours


# The digest


@pytest.mark.slow
def test_the_digest_is_of_all_files_and_of_what_stays(tower: Path, tmp_path: Path) -> None:
    def digest(engine: str = "bullet", **fields: object) -> str:
        with opened(file=tower, **fields) as subject:
            return subject.digest(engine, environment=environment)

    environment = {"SIZE": "1", "COLOR": "red", "OTHER": "x"}
    first = digest()
    assert digest() == first
    assert digest(launch_arguments={"mass": "9"}) != first
    assert digest("mujoco") != first
    (tmp_path / "unrelated.txt").write_text("x")
    assert digest() == first
    (tmp_path / "part.xacro").write_text(f"{PART}<!-- another -->")
    assert digest() != first
    (tmp_path / "part.xacro").write_text(f"{PART}<!-- $(env SIZE) $(optenv COLOR blue) -->")
    first = digest()
    environment["OTHER"] = "y"
    assert digest() == first
    for name in ("SIZE", "COLOR"):
        environment[name] += "2"
        assert digest() != first
        first = digest()


# Templates


@pytest.mark.slow
def test_a_template_has_its_variables() -> None:
    with opened(template="diff_drive") as subject:
        parameters = {one.name: one for one in subject.parameters}
        assert parameters["wheel_radius"].default == 0.08
        assert (parameters["wheel_radius"].minimum, parameters["wheel_radius"].unit) == (0.02, "m")
        with pytest.raises(RequestError, match=r"wheel_radius: 0.3 is not allowed"):
            subject.check(grid("wheel_radius=0.1,0.3"))
        with pytest.raises(RequestError, match="Did you mean `wheel_mass`"):
            subject.check(grid("wheel_mas=1,2"))
        light, heavy = (subject.prepare({"body_mass": mass}) for mass in (3.0, 30.0))
        assert mass_of(heavy) - mass_of(light) == pytest.approx(27.0)
        assert not codes_of(light)
        assert light.behavior_plan is not None
        assert light.behavior_plan.seconds > 1.0
        name, files = subject.package({"body_mass": 3.0}) or ("", {})
        assert name == "diff_drive"
        assert "body_mass = 3.0" in files["wsgen.toml"]
        assert files.keys() >= {"CMakeLists.txt", "package.xml", "README.md", "test/test_robot.py"}
        # No scratch folder is named: a row would differ each time.
        named = [one for one in light.diagnostics if str(subject.folder) in str(one)]
        assert not named


@pytest.mark.slow
def test_answers_of_a_template_stay_where_they_do_not_vary() -> None:
    with opened(template="simple", settings=("mass=4",)) as subject:
        assert mass_of(subject.prepare({"length": 0.5})) == 4.0
        assert mass_of(subject.prepare({"mass": 2.0})) == 2.0
        first = subject.digest("bullet")
        with pytest.raises(RequestError, match="mass varies, so that --set mass=4 has no effect"):
            subject.check(grid("mass=1,2"))
        assert subject.check(grid("length=1,2")).names == ("length",)
    with opened(template="simple") as subject:
        assert subject.digest("bullet") != first
    with pytest.raises(RequestError, match="mass"):
        opened(template="simple", settings=("mass=-4",)).__enter__()
    with pytest.raises(RequestError, match=r"no launch file missing\.launch\.py"):
        opened(template="simple", launch_file="missing.launch.py").__enter__()


@pytest.mark.slow
@pytest.mark.parametrize("template", ["simple", "diff_drive", "arm"])
def test_a_template_is_simulated_as_its_package(template: str, tmp_path: Path) -> None:
    target = choose_target("jazzy", "gz")
    package = template
    create(
        package,
        target=target,
        template_name=template,
        license_name="MIT",
        workspace_folder=str(tmp_path / "ws"),
        settings=(),
        description=None,
        maintainer_name="Ada",
        maintainer_email="ada@example.com",
        workflow_service=None,
        is_dry_run=False,
        announce=lambda _workspace: None,
    )
    workspace = Workspace(root=tmp_path / "ws")
    with opened(template=template, target=target) as subject:
        as_validated(subject, validated(workspace, package, None))
    with opened(package=package, workspace=workspace) as subject:
        as_validated(subject, validated(workspace, package, None))


# Packages


@pytest.mark.slow
@pytest.mark.parametrize(
    ("workspace", "package"),
    [
        ("robot_in_world", "seesaw_world"),
        ("never_built", "trolley_bringup"),
        ("asks_input", "choosy_arm"),
        ("missing_helpers", "rover_bringup"),
        ("database_world", "waiter_gazebo"),
        ("xacro_at_build", "crane_description"),
    ],
)
def test_a_package_is_simulated_as_it_is_validated(workspace: str, package: str) -> None:
    place = Workspace(root=WORKSPACES / workspace)
    with opened(package=package, workspace=place) as subject:
        as_validated(subject, validated(place, package, None))


@pytest.mark.slow
def test_a_published_robot_is_simulated_as_it_is_validated() -> None:
    file = public_robots.find_robot("pybullet", "a1/a1.urdf")
    if file is None:
        pytest.skip("PyBullet's robots are not installed")
    with opened(file=file) as subject:
        as_validated(subject, validated(None, None, file))


@pytest.mark.slow
def test_launch_arguments_vary(tmp_path: Path) -> None:
    shutil.copytree(WORKSPACES / "spawn_by_include", tmp_path / "ws")
    place = Workspace(root=tmp_path / "ws")
    with opened(package="crane_bringup", workspace=place) as subject:
        assert "x" in subject.own_names
        robots = [subject.prepare({"x": x}).prepared[-1] for x in (0.5, -2.0)]
        assert [robot.spawn_pose.xyz[0] for robot in robots] == [0.5, -2.0]
        assert robots[0].lumped is robots[1].lumped  # the same text is read once
        with pytest.raises(RequestError, match="DeclareLaunchArgument"):
            subject.check(grid("xx_nothing=1,2"))
        first = subject.digest("bullet")
    with opened(package="crane_bringup", workspace=place) as subject:
        assert subject.digest("bullet") == first
    (launch,) = (tmp_path / "ws/src/crane_bringup/launch").iterdir()
    launch.write_text(f"{launch.read_text()}\n# changed\n")
    with opened(package="crane_bringup", workspace=place) as subject:
        assert subject.digest("bullet") != first
    with pytest.raises(RequestError, match="No launch file of crane_description spawns a robot"):
        opened(package="crane_description", workspace=place).__enter__()


@pytest.mark.slow
def test_an_argument_that_only_the_source_has(tmp_path: Path) -> None:
    name, index = "cart", "share/ament_index/resource_index/packages"
    launch = """from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch_ros.actions import Node
def generate_launch_description():
    return LaunchDescription([
        {}Node(package='gazebo_ros', executable='spawn_entity.py', arguments=['-entity', 'cart',
             '-file', '{}']),
    ])
"""
    robot = tmp_path / "cart.urdf"
    robot.write_text(PART)
    source, share = tmp_path / "ws/src/cart", tmp_path / "ws/install/cart/share/cart"
    for folder, declared in (
        (source, "DeclareLaunchArgument('mass', default_value='1'),\n        "),
        (share, ""),
    ):
        (folder / "launch").mkdir(parents=True)
        (folder / "launch" / "cart.launch.py").write_text(launch.format(declared, robot))
        (folder / "package.xml").write_text(
            f"<package format='3'><name>{name}</name><version>0.0.1</version></package>"
        )
    marker = tmp_path / "ws/install/cart" / index / name
    marker.parent.mkdir(parents=True)
    marker.touch()
    prefix = tmp_path / "ws/install/cart"
    (tmp_path / "ws/install/setup.sh").write_text(f"export AMENT_PREFIX_PATH={prefix}\n")
    (tmp_path / "ws/install/COLCON_IGNORE").touch()
    with opened(package=name, workspace=Workspace(root=tmp_path / "ws")) as subject:
        with pytest.raises(RequestError) as caught:
            subject.check(grid("mass=1,2"))
        assert "Its source has the argument `mass`: run `wsgen build`." in (caught.value.hint or "")
        with pytest.raises(RequestError) as caught:
            subject.check(grid("size=1,2"))
        assert "DeclareLaunchArgument" in (caught.value.hint or "")


def test_what_a_sweep_leaves_out_is_named() -> None:
    from wsgen.sweeping.sweep import _left_out  # noqa: PLC0415

    class WithRuns:
        left_out = ("wanders", "stops")

    assert _left_out(cast("Subject", WithRuns())) == (
        "A sweep runs no nodes and leaves out `wanders`, `stops`; `wsgen validate` runs them."
    )
