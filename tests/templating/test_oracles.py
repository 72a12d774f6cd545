"""What other programs say of each golden."""

import ast
import io
import math
import os
import re
import shutil
import subprocess
import sys
import tokenize
import warnings
from collections.abc import Callable
from functools import cache
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

from gazebo_oracle import IGN, ign_sdf
from golden_support import CASES, GOLDENS, PACKAGE, golden_package
from wsgen.model.facts import RELEASED_FOR, RELEASED_FOR_ALL
from wsgen.model.package import MAXIMUM_LENGTH
from wsgen.model.target import Target

pytestmark = pytest.mark.oracle

LENGTH, RADIUS, MASS = 0.5, 0.4, 1.0  # of the golden's cylinder, in m and kg
IXX = MASS * (3 * RADIUS**2 + LENGTH**2) / 12
IZZ = MASS * RADIUS**2 / 2

# The rules of package_format3.xsd: the order of the elements, and what their texts look like.
MANIFEST_ORDER = re.compile(
    r"name version description (maintainer )+(license )+(url )*(author )*"
    r"((build|build_export|buildtool|buildtool_export|exec|doc|test)_depend |depend |conflict "
    r"|replace )*(group_depend )*(member_of_group )*(export )?"
)
MANIFEST_TEXTS = {
    "name": r"[a-z](_?[a-z0-9]+)*",
    "version": r"(0|[1-9][0-9]*)(\.(0|[1-9][0-9]*)){2}",
    "maintainer": r".*\S.*",
    "license": r".*\S.*",
}
MANIFEST_EMAIL = (
    r"[-a-zA-Z0-9_%+]+(\.[-a-zA-Z0-9_%+]+)*@[-a-zA-Z0-9%]+(\.[-a-zA-Z0-9%]+)*\.[a-zA-Z]{2,}"
)

# Import, file or plugin that a package uses -> the package that it needs for it; the longest first.
PLUGIN_PACKAGES = {
    "libgazebo_ros2_control": "gazebo_ros2_control",
    "gz_ros2_control": "gz_ros2_control",
    "libgazebo_ros_": "gazebo_plugins",
}
NEWEST_SDF = (1, 9)  # that the parser of Debian's package reads, Fortress's

# The two models that Gazebo Classic brings, as far as a parser wants to see them.
CLASSIC_MODELS = {
    "sun": '<light type="directional" name="sun"><direction>0 0 -1</direction></light>',
    "ground_plane": '<model name="ground_plane"><static>true</static><link name="link"/></model>',
}
# What Gazebo has said, by what it was asked.
ANSWERS: dict[tuple[object, ...], str] = {}


@pytest.fixture(params=sorted(CASES))
def case(request: pytest.FixtureRequest) -> str:
    """The name of a golden."""
    name: str = request.param
    return name


@pytest.fixture
def package(case: str) -> Path:
    """The package of a golden."""
    return golden_package(case)


@pytest.fixture
def target(case: str) -> Target:
    """What the golden is made for."""
    return CASES[case][1]


def cases_of(template: str) -> list[str]:
    """The goldens of one template."""
    return sorted(case for case, (name, _) in CASES.items() if name == template)


@pytest.fixture(scope="module")
def expanded(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Golden -> its robot as xacro expands it in an install space."""

    @cache
    def expand(case: str) -> Path:
        folder = tmp_path_factory.mktemp(case)
        share = folder / "install" / "share"
        shutil.copytree(golden_package(case), share / PACKAGE)
        index = share / "ament_index" / "resource_index" / "packages"
        index.mkdir(parents=True)
        (index / PACKAGE).touch()
        file = folder / "robot.urdf"
        subprocess.run(
            [
                *(sys.executable, "-c", "import xacro; xacro.main()"),
                *(share / PACKAGE / "model" / "robot.xacro", "-o", file),
            ],
            env=os.environ | {"AMENT_PREFIX_PATH": str(folder / "install")},
            check=True,
        )
        return file

    return expand


@pytest.fixture
def urdf(case: str, expanded: Callable[[str], Path]) -> Path:
    """The robot of a golden."""
    return expanded(case)


@pytest.fixture(params=cases_of("simple"))
def cylinder(request: pytest.FixtureRequest, expanded: Callable[[str], Path]) -> Path:
    """The robot of the template `simple`."""
    return expanded(request.param)


@pytest.fixture(params=cases_of("diff_drive"))
def vehicle(request: pytest.FixtureRequest, expanded: Callable[[str], Path]) -> Path:
    """The robot of the template `diff_drive`."""
    return expanded(request.param)


def ask(name: str, *arguments: str | Path, folder: Path, **environment: str) -> str:
    """What a program prints; the test is skipped where it is not installed."""
    program = shutil.which(name)
    if program is None:
        pytest.skip(f"{name} is not installed")
    answer = run(program, *arguments, folder=folder, **environment)
    if "is not a" in answer.stderr and "command" in answer.stderr:
        pytest.skip(f"{name} has no command {arguments[0]}")
    assert answer.returncode == 0, answer.stdout + answer.stderr
    return answer.stdout


def ask_gazebo(option: str, file: Path, **environment: str) -> str:
    """What `ign sdf` prints; the test is skipped where it is not installed.

    Targets differ so little that many files are the same but for the folder they are in: it is
    asked once about them.
    """
    if IGN is None:
        pytest.skip("ign is not installed")
    text = file.read_text(encoding="utf-8").replace(str(file.parent), "")
    asked = (option, text, *environment.items())
    if asked not in ANSWERS:
        answer = run(*ign_sdf(option, file), folder=file.parent, **environment)
        assert answer.returncode == 0, answer.stdout + answer.stderr
        ANSWERS[asked] = answer.stdout
    return ANSWERS[asked]


def run(*command: str | Path, folder: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        command,
        cwd=folder,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )


def test_catkin_pkg_has_nothing_to_say(package: Path) -> None:
    catkin = pytest.importorskip("catkin_pkg.package")
    said: list[str] = []
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        parsed = catkin.parse_package(package, warnings=said)
        parsed.validate(warnings=said)
    assert said == []
    assert parsed.name == PACKAGE


def test_everything_that_is_needed_is_released(package: Path, target: Target) -> None:
    root = ET.parse(package / "package.xml").getroot()
    for element in root:
        if element.tag.endswith("depend"):
            name = element.text or ""
            assert name in RELEASED_FOR_ALL or target.distro in RELEASED_FOR[name], name


def test_classic_needs_what_the_tutorial_needs() -> None:
    root = ET.parse(golden_package("simple-iron-classic") / "package.xml").getroot()
    assert {element.text for element in root.iter("exec_depend")} >= {
        "joint_state_publisher",
        "robot_state_publisher",
        "gazebo_ros",
        "xacro",
    }


def test_package_format3(package: Path) -> None:
    root = ET.parse(package / "package.xml").getroot()
    assert (root.tag, root.attrib) == ("package", {"format": "3"})
    tags = "".join(f"{element.tag} " for element in root)
    assert MANIFEST_ORDER.fullmatch(tags), tags
    for tag, pattern in MANIFEST_TEXTS.items():
        for element in root.iter(tag):
            assert re.fullmatch(pattern, element.text or ""), tag
    for element in root.iter("maintainer"):
        assert re.fullmatch(MANIFEST_EMAIL, element.attrib["email"])
    assert root.findtext("description")
    assert root.findtext("export/build_type") == "ament_cmake"


def test_dependencies_are_what_the_files_use(case: str, package: Path) -> None:
    root = ET.parse(package / "package.xml").getroot()
    needed = {element.text for element in root.iter("exec_depend")}
    launch = "".join(file.read_text() for file in sorted((package / "launch").iterdir()))
    nodes = "".join(file.read_text() for file in sorted(package.glob("scripts/*.py")))
    used = set(re.findall(r"^(?:from|import) (\w+)", launch + nodes, re.MULTILINE))
    used |= set(re.findall(r"package='(\w+)'", launch)) - {PACKAGE}
    used |= set(re.findall(r"FindPackageShare\('(\w+)'\)", launch)) - {PACKAGE}
    used |= {"ros2launch", "xacro"}  # without ros2launch nobody starts the file
    for library in re.findall(r'filename="([^"]+)"', (package / "model/robot.gazebo").read_text()):
        used |= {name for start, name in PLUGIN_PACKAGES.items() if library.startswith(start)}
    if (package / "config" / "controllers.yaml").exists():
        used |= {"ros2_controllers"}
    if case in {"simple-humble-classic", "simple-iron-classic"}:
        used |= {"joint_state_publisher"}  # as the tutorial has it
    assert needed == used


def test_plugins_are_those_of_the_target(package: Path, target: Target) -> None:
    known = {tuple(plugin) for plugin in target.plugins.values()}
    files = (package / "model" / "robot.gazebo", package / "model" / "empty_world.world")
    for file in files:
        for plugin in re.findall(r'<plugin filename="([^"]+)" name="([^"]+)"', file.read_text()):
            assert plugin in known, (file, plugin)
    robot = (package / "model" / "robot.xacro").read_text()
    for hardware in re.findall(r"<plugin>(.*)</plugin>", robot):
        assert hardware == target.ros2_control_hardware


def test_the_bridge_carries_what_the_robot_publishes_and_takes(package: Path) -> None:
    """Each Gazebo topic that a plugin or a sensor is given is bridged once, and no other."""
    bridge = package / "config" / "bridge.yaml"
    if not bridge.exists():
        pytest.skip("Gazebo Classic has no bridge")
    bridged = re.findall(r"gz_topic_name: (\S+)", bridge.read_text())
    robot = (package / "model" / "robot.gazebo").read_text()
    given = re.findall(r"<(?:\w+_)?topic>(.*)</(?:\w+_)?topic>", robot)
    assert sorted(bridged) == sorted(["/clock", *given])


@pytest.mark.slow
def test_launch_files_in_the_style_of_ament() -> None:
    """The settings of ament_flake8; in one process, as it takes longer to start than to look."""
    pytest.importorskip("flake8")
    command = [
        *(sys.executable, "-m", "flake8", "--isolated", "--max-line-length", "99"),
        *("--import-order-style", "google"),
        *(
            "--extend-ignore",
            "B902,C816,D100,D101,D102,D103,D104,D105,D106,D107,D203,D212,D404,I202",
        ),
        str(GOLDENS),
    ]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (answer.returncode, answer.stdout, answer.stderr) == (0, "", "")


@pytest.mark.slow
@pytest.mark.parametrize("linter", ["ament_flake8", "ament_pep257"])
def test_the_linters_of_ament_find_nothing(linter: str, tmp_path: Path) -> None:
    """As `colcon test` runs them where ROS is; in one process, with all files of each template."""
    pytest.importorskip(linter)
    files = sorted(GOLDENS.glob("*-*/ws_gazebo/src/*/*/*.py"))
    assert {file.parent.name for file in files} == {"launch", "scripts", "test"}
    command = [sys.executable, "-m", f"{linter}.main"]
    answer = subprocess.run(
        [*command, *files], capture_output=True, text=True, check=False, cwd=tmp_path
    )
    assert "No problems found" in answer.stdout, answer.stdout + answer.stderr
    assert answer.returncode == 0
    wrong = tmp_path / "wrong.py"
    wrong.write_text('"""say nothing"""\nimport os\nx=1\n')
    assert subprocess.run([*command, wrong], capture_output=True, check=False).returncode == 1


def test_launch_files_have_single_quotes(package: Path) -> None:
    """As flake8-quotes, which newer versions of ament_flake8 bring."""
    for file in (*package.glob("launch/*.py"), *package.glob("test/*.py")):
        for token in tokenize.generate_tokens(io.StringIO(file.read_text()).readline):
            if token.type == tokenize.STRING and not token.string.startswith('"""'):
                assert token.string.startswith("'"), (file, token.start)


def test_launch_files_of_long_names_fit_into_the_line(package: Path) -> None:
    """Of the longest name that wsgen accepts."""
    longest = "r" * MAXIMUM_LENGTH
    for file in (package / "launch").glob("*.py"):
        text = file.read_text().replace(PACKAGE, longest)
        ast.parse(text)
        assert max(map(len, text.splitlines())) <= 99


@pytest.fixture(scope="module")
def classic_models(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the models that Gazebo Classic brings."""
    models = tmp_path_factory.mktemp("models")
    for name, content in CLASSIC_MODELS.items():
        folder = models / name
        folder.mkdir()
        (folder / "model.config").write_text(
            f"<model><name>{name}</name><sdf version='1.5'>model.sdf</sdf></model>"
        )
        (folder / "model.sdf").write_text(f"<sdf version='1.5'>{content}</sdf>")
    return models


@pytest.mark.slow
def test_world_is_valid_for_gazebo(
    case: str, package: Path, target: Target, classic_models: Path
) -> None:
    if tuple(map(int, target.sdf_version.split("."))) > NEWEST_SDF:
        pytest.skip(f"the parser here does not read SDFormat {target.sdf_version}")
    models = str(classic_models)
    wanted = ["physics", "user_commands", "scene_broadcaster"]
    if case.startswith(("diff_drive", "wanderer")):
        wanted += ["sensors", "imu"]
    if target.simulator == "classic":
        wanted = []
    for world in sorted(package.glob("model/*.world")):
        assert "Valid." in ask_gazebo("-k", world, SDF_PATH=models)
        read = ET.fromstring(ask_gazebo("-p", world, SDF_PATH=models))
        has_boxes = world.name == "boxes.world"
        assert len(list(read.iter("model"))) == (10 if has_boxes else 1)
        assert "ground_plane" in {element.get("name") for element in read.iter("model")}
        assert {element.get("name") for element in read.iter("light")} == {"sun"}
        plugins = {(one.get("filename"), one.get("name")) for one in read.iter("plugin")}
        assert plugins == {tuple(target.plugins[role]) for role in wanted}


@pytest.mark.slow
def test_urdfdom_and_gazebo_read_the_robot(urdf: Path) -> None:
    assert "Successfully Parsed XML" in ask("check_urdf", urdf, folder=urdf.parent)
    assert "Valid." in ask_gazebo("-k", urdf)
    model = ET.fromstring(ask_gazebo("-p", urdf))
    assert len(list(model.iter("model"))) == 1


@pytest.mark.slow
def test_no_comment_of_the_robot_has_a_colon_and_a_blank(urdf: Path) -> None:
    """gazebo_ros2_control passes the robot on as a parameter override, which that breaks."""
    for comment in re.findall(r"<!--.*?-->", urdf.read_text(), re.DOTALL):
        assert not re.search(r":\s", comment), comment


@pytest.mark.slow
def test_gazebo_reads_what_drives_the_vehicle(vehicle: Path) -> None:
    model = ET.fromstring(ask_gazebo("-p", vehicle)).find("model")
    assert model is not None
    assert [link.get("name") for link in model.findall("link")] == [
        *("base_footprint", "left_wheel", "right_wheel")
    ]
    sensors = {one.get("name"): one.get("type") for one in model.iter("sensor")}
    assert sensors.keys() == {"imu", "lidar"}
    assert sensors["lidar"] in {"ray", "gpu_lidar"}
    friction = {
        str(one.get("name")): one.findtext("surface/friction/ode/mu")
        for one in model.iter("collision")
    }
    (caster,) = (mu for name, mu in friction.items() if "caster" in name)
    assert caster == "0"
    assert friction["left_wheel_collision"] == friction["right_wheel_collision"] == "1"
    drive = next(one for one in model.iter("plugin") if one.find("left_joint") is not None)
    wheel = next(link for link in model.findall("link") if link.get("name") == "left_wheel")
    radius = float(wheel.findtext("collision/geometry/cylinder/radius") or "nan")
    (diameter,) = [
        factor * float(drive.findtext(name) or "nan")
        for name, factor in (("wheel_radius", 2.0), ("wheel_diameter", 1.0))
        if drive.find(name) is not None
    ]
    assert diameter == pytest.approx(2 * radius)


def test_urdfdom_reads_the_cylinder(cylinder: Path) -> None:
    said = ask("check_urdf", cylinder, folder=cylinder.parent)
    assert "robot name is: simple_robot" in said
    assert "root Link: dummy has 1 child(ren)" in said


@pytest.mark.slow
def test_gazebo_reads_the_cylinder(cylinder: Path) -> None:
    model = ET.fromstring(ask_gazebo("-p", cylinder))
    (link,) = model.iter("link")
    assert link.get("name") == "dummy"
    assert float(link.findtext("inertial/mass") or "nan") == MASS
    inertia = [
        float(link.findtext(f"inertial/inertia/i{axes}") or "nan") for axes in ("xx", "yy", "zz")
    ]
    assert inertia == pytest.approx([IXX, IXX, IZZ])
    friction = link.find("collision/surface/friction/ode")
    assert friction is not None
    assert [friction.findtext("mu"), friction.findtext("mu2")] == ["0.2", "0.2"]
    script = link.findtext("visual/material/script/name") or ""
    color = link.findtext("visual/material/diffuse") or ""
    assert "Gazebo/Green" in script or color.split()[:3] == ["0", "1", "0"]


def test_mujoco_compiles_the_cylinder(cylinder: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    # MuJoCo welds the root of a URDF to the world and would merge everything into it.
    text = cylinder.read_text().replace(
        '<robot name="simple_robot">',
        '<robot name="simple_robot"><mujoco><compiler fusestatic="false"/></mujoco>',
    )
    model = mujoco.MjModel.from_xml_string(text)
    assert model.body("base_link").mass == pytest.approx([MASS])
    assert sorted(model.body("base_link").inertia) == pytest.approx(sorted([IXX, IXX, IZZ]))
    assert math.isclose(model.body_mass.sum(), MASS)
