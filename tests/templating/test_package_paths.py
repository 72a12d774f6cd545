import pytest

from templating.broken_templates import HEAD, load, spec_for, write_template
from wsgen.templating.render import PathError, check_path, fill_in, find_collision


@pytest.mark.parametrize(
    "path",
    [
        "package.xml",
        "launch/a.launch.py",
        ".github/workflows/ci.yml",
        "meshes/größe.stl",
        "a b/c.txt",
        "src/build/x",
        "console.txt",
        "a" * 255,
    ],
)
def test_good_path(path: str) -> None:
    assert check_path(path) is None


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("", "no path below"),
        ("/etc/passwd", "no path below"),
        ("../evil", "no path below"),
        ("a/../../evil", "no path below"),
        ("a//b", "no path below"),
        ("a/./b", "no path below"),
        ("a/", "no path below"),
        ("a\0b", "does not print"),
        ("a\nb", "does not print"),
        ("a\udcffb", "does not print"),
        ("a\u202eb", "does not print"),
        ("a\\b", "no name on Windows"),
        ("c:/x", "no name on Windows"),
        ("a?", "no name on Windows"),
        ("a. ", "no name on Windows"),
        ("a.", "no name on Windows"),
        (" a", "no name on Windows"),
        ("launch/con", "a device on Windows"),
        ("NUL.txt", "a device on Windows"),
        ("com1.launch.py", "a device on Windows"),
        ("build/x", "colcon or git makes"),
        ("Install/x", "colcon or git makes"),
        ("log", "colcon or git makes"),
        (".git/hooks/pre-commit", "colcon or git makes"),
        ("COLCON_IGNORE", "colcon passes the package over"),
        ("launch/ament_ignore", "colcon passes the package over"),
        ("ä" * 128, "too long"),
        ("a/" * 200 + "a", "too long"),
    ],
)
def test_path_that_no_package_can_have(path: str, words: str) -> None:
    assert words in (check_path(path) or "")


@pytest.mark.parametrize(
    ("paths", "collision"),
    [
        (["a", "b", "ac"], None),
        (["README.md", "readme.md"], ("README.md", "readme.md")),
        (["caf\u00e9", "cafe\u0301"], ("caf\u00e9", "cafe\u0301")),
        (["stra\u00dfe", "STRASSE"], ("stra\u00dfe", "STRASSE")),
        (["model", "model/robot.xacro"], ("model", "model/robot.xacro")),
        (["a/b/c", "A/B"], ("A/B", "a/b/c")),
        (["a/b", "A/c"], None),
    ],
)
def test_collisions(paths: list[str], collision: tuple[str, str] | None) -> None:
    assert find_collision(paths) == collision


VARIABLES = (
    '[variables.sensor]\nhelp = "x"\ntype = "string"\ndefault = "lidar"\n'
    '[variables.mass]\nhelp = "x"\ntype = "number"\nunit = "kg"\n'
    "default = 1\nminimum = 0\nmaximum = 2\n"
)


@pytest.mark.parametrize(
    ("pattern", "path"),
    [
        ("hooks/{{ package.name }}.sh.in", "hooks/some_robot.sh.in"),
        ("{{package.name}}/{{ package.name }}.txt", "some_robot/some_robot.txt"),
        ("config/{{ package.target.distro }}.yaml", "config/iron.yaml"),
        ("config/{{ package.target.simulator }}.yaml", "config/classic.yaml"),
        ("config/{{ package.answers.sensor }}.yaml", "config/lidar.yaml"),
    ],
)
def test_names_in_paths(tmp_path_factory: pytest.TempPathFactory, pattern: str, path: str) -> None:
    template = load(write_template(tmp_path_factory.mktemp("t"), HEAD + VARIABLES))
    assert fill_in(pattern, spec_for(template)) == path


@pytest.mark.parametrize(
    ("pattern", "words"),
    [
        ("{{ name }}.txt", "{{ name }} is no name that a path may have in it: package.name"),
        ("{{ package.license }}.txt", "is no name that a path may have"),
        ("{{ package.answers.mass }}.txt", "is no name that a path may have"),
        ("{{ package.name | upper }}.txt", "no logic"),
        ("{% if true %}a{% endif %}", "no logic"),
        ("{{ package.__class__ }}", "is no name that a path may have"),
        ("{a}", "no logic"),
    ],
)
def test_logic_in_paths(tmp_path_factory: pytest.TempPathFactory, pattern: str, words: str) -> None:
    template = load(write_template(tmp_path_factory.mktemp("t"), HEAD + VARIABLES))
    with pytest.raises(PathError) as caught:
        fill_in(pattern, spec_for(template))
    assert words in str(caught.value)


@pytest.mark.parametrize("answer", ["..", "../../evil", "a/../../b", "con", "."])
def test_an_answer_does_not_lead_out_of_the_package(
    tmp_path_factory: pytest.TempPathFactory, answer: str
) -> None:
    template = load(write_template(tmp_path_factory.mktemp("t"), HEAD + VARIABLES))
    with pytest.raises(PathError):
        fill_in("{{ package.answers.sensor }}/x", spec_for(template, f"sensor={answer}"))
