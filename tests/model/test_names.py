import itertools
import keyword
import re

import pytest

from wsgen.model.package import MAXIMUM_LENGTH, check_package_name, suggest_package_name

# name -> (words of the rule that it breaks, the name that is suggested)
BROKEN = {
    "": ("empty", "my_robot"),
    ".": ("only the lower-case", "my_robot"),
    "..": ("only the lower-case", "my_robot"),
    "../evil": ("path", "evil"),
    "/etc/passwd": ("path", "passwd"),
    "src/robot/": ("path", "robot"),
    "C:\\robot": ("path", "robot"),
    "GazeboTest": ("lower-case", "gazebo_test"),
    "my-robot": ("lower-case", "my_robot"),
    "my robot": ("lower-case", "my_robot"),
    "robot\n": ("lower-case", "robot"),
    "röböt": ("lower-case", "robot"),
    "机器人": ("lower-case", "my_robot"),
    "١٢": ("lower-case", "my_robot"),
    "🤖": ("lower-case", "my_robot"),
    "ab\0c": ("lower-case", "ab_c"),
    "\udcff": ("lower-case", "my_robot"),
    "$(reboot)": ("lower-case", "reboot"),
    "3d": ("start with a letter", "robot_3d"),
    "_hidden": ("start with a letter", "hidden"),
    "a": ("at least 2 characters", "a_robot"),
    "my__robot": ("two underscores", "my_robot"),
    "robot_": ("end with an underscore", "robot"),
    "a" * 300: ("longer than 64", "a" * 64),
    "test": ("CMake", "test_robot"),
    "all": ("CMake", "all_robot"),
    "install": ("CMake", "install_robot"),
    "uninstall": ("CMake", "uninstall_robot"),
    "class": ("Python", "class_robot"),
    "import": ("Python", "import_robot"),
    "none": ("Python", "none_robot"),
    "None": ("lower-case", "none_robot"),
    "namespace": ("C++", "namespace_robot"),
    "build": ("colcon", "build_robot"),
    "con": ("Windows", "con_robot"),
    "lpt1": ("Windows", "lpt1_robot"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_broken_name(name: str) -> None:
    words, suggestion = BROKEN[name]
    assert words in (check_package_name(name) or "")
    assert suggest_package_name(name) == suggestion
    assert check_package_name(suggestion) is None


@pytest.mark.parametrize(
    "name", ["gazebo_test", "ab", "r2d2", "a1", "my_robot_description", "x" * MAXIMUM_LENGTH]
)
def test_good_name_is_kept(name: str) -> None:
    assert check_package_name(name) is None
    assert suggest_package_name(name) == name


def test_no_keyword_of_python_is_a_name() -> None:
    assert all(check_package_name(word) for word in keyword.kwlist)


def test_what_is_allowed_agrees_with_the_schema() -> None:
    """package_format3.xsd's pattern allows one thing more: a single letter."""
    for letters in itertools.product("a1_B-", repeat=4):
        name = "".join(letters)
        pattern = re.fullmatch(r"[a-z](_?[a-z0-9]+)*", name)
        assert (check_package_name(name) is None) == bool(pattern), name
