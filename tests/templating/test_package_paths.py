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
        ("", "not a path below"),
        ("/etc/passwd", "not a path below"),
        ("../evil", "not a path below"),
        ("a/../../evil", "not a path below"),
        ("a//b", "not a path below"),
        ("a/./b", "not a path below"),
        ("a/", "not a path below"),
        ("a\0b", "does not print"),
        ("a\nb", "does not print"),
        ("a\udcffb", "does not print"),
        ("a\u202eb", "does not print"),
        ("a\\b", "not a valid name on Windows"),
        ("c:/x", "not a valid name on Windows"),
        ("a?", "not a valid name on Windows"),
        ("a. ", "not a valid name on Windows"),
        ("a.", "not a valid name on Windows"),
        (" a", "not a valid name on Windows"),
        ("launch/con", "a device on Windows"),
        ("NUL.txt", "a device on Windows"),
        ("com1.launch.py", "a device on Windows"),
        ("build/x", "colcon or git creates"),
        ("Install/x", "colcon or git creates"),
        ("log", "colcon or git creates"),
        (".git/hooks/pre-commit", "colcon or git creates"),
        ("COLCON_IGNORE", "colcon ignores a package"),
        ("launch/ament_ignore", "colcon ignores a package"),
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
        ("{{ name }}.txt", "{{ name }} is not allowed in a path; these are: package.name"),
        ("{{ package.license }}.txt", "is not allowed in a path"),
        ("{{ package.answers.mass }}.txt", "is not allowed in a path"),
        ("{{ package.name | upper }}.txt", "other braces"),
        ("{% if true %}a{% endif %}", "other braces"),
        ("{{ package.__class__ }}", "is not allowed in a path"),
        ("{a}", "other braces"),
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
