"""What a package.xml says about its package, with facts alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from wsgen.checks.rules.manifests import (
    Interfaces,
    check_interfaces,
    check_manifest,
    generated_interfaces,
    unfinished,
)
from wsgen.model.build_facts import BuildFacts, InstalledFile, RequiredPackage
from wsgen.packages.workspace.manifest import Dependency, Entry, Manifest

FILE = Path("src/demo/package.xml")
FOLDER = Path("src/demo")
BUILDTOOL = Dependency(tag="buildtool_depend", name="ament_cmake", line=8)
CMAKE = Path("src/demo/CMakeLists.txt")


def manifest(
    *dependencies: Dependency, build_type: str = "ament_cmake", **entries: Entry
) -> Manifest:
    root = {(): (Entry("", 2, {"format": "3"}),)}
    build = {("export", "build_type"): (Entry(build_type, 20, {}),)}
    return Manifest(
        name="demo",
        build_type=build_type,
        dependencies=dependencies,
        file=FILE,
        entries=root | build | {(tag,): (entry,) for tag, entry in entries.items()},
    )


def codes(
    checked: Manifest, folder: Path = FOLDER, interfaces: Interfaces | None = None
) -> list[str]:
    return [found.code for found in check_manifest(checked, folder, interfaces=interfaces)]


def test_a_sound_manifest() -> None:
    assert codes(manifest(BUILDTOOL)) == []
    assert codes(manifest(build_type="ament_python")) == []
    auto = Dependency(tag="buildtool_depend", name="ament_cmake_auto", line=8)
    assert codes(manifest(auto)) == []


def test_placeholders_are_one_diagnostic() -> None:
    (found,) = unfinished(
        manifest(
            description=Entry("TODO: Package description", 5, {}),
            maintainer=Entry("Me", 6, {"email": "me@todo.todo"}),
            license=Entry("TODO: License declaration", 7, {}),
        )
    )
    assert (found.code, found.line, found.element) == ("PKG076", 5, "description")
    assert found.message.startswith("<description>, <maintainer> and <license> of package.xml have")


def test_one_placeholder() -> None:
    (found,) = unfinished(manifest(license=Entry("TODO", 7, {})))
    assert found.message == "<license> of package.xml has only a placeholder."
    assert not [*unfinished(manifest(license=Entry("Apache-2.0", 7, {})))]


@pytest.mark.parametrize(
    ("folder", "expected"),
    [
        ("demo", []),
        ("arm", ["PKG077"]),
        ("demo_package", []),
        ("dem", []),
    ],
)
def test_the_folder(folder: str, expected: list[str]) -> None:
    assert codes(manifest(BUILDTOOL), Path("src", folder)) == expected


def test_a_repository_may_have_another_name(tmp_path: Path) -> None:
    (tmp_path / ".git").mkdir()
    assert codes(manifest(BUILDTOOL), tmp_path) == []


def test_no_buildtool() -> None:
    (found,) = check_manifest(manifest(), FOLDER)
    assert (found.code, found.line) == ("PKG078", 20)
    assert "<buildtool_depend>ament_cmake</buildtool_depend>" in (found.hint or "")


def test_a_dependency_inside_of_export() -> None:
    one = manifest(BUILDTOOL)
    entries = {**one.entries, ("export", "exec_depend"): (Entry("xacro", 9, {}),)}
    wrong = Manifest(
        name="demo",
        build_type="ament_cmake",
        dependencies=one.dependencies,
        file=FILE,
        entries=entries,
    )
    (found,) = check_manifest(wrong, FOLDER)
    assert (found.code, found.line, found.hint) == (
        "PKG109",
        9,
        "Move it out of <export>, above it.",
    )


def test_a_python_package_of_the_wrong_build_type_needs_no_buildtool(tmp_path: Path) -> None:
    folder = tmp_path / "demo_package"
    folder.mkdir()
    folder.joinpath("setup.py").touch()
    assert codes(manifest(), folder) == []


def test_format_1() -> None:
    old = manifest(BUILDTOOL)
    old = Manifest(
        name="demo",
        build_type="ament_cmake",
        dependencies=old.dependencies,
        file=FILE,
        entries={**old.entries, (): (Entry("", 2, {}),)},
    )
    assert codes(old) == ["PKG082"]


def test_a_package_of_ros_1() -> None:
    catkin = Dependency(tag="buildtool_depend", name="catkin", line=8)
    assert codes(manifest(catkin, build_type="catkin"), Path("src/other")) == ["PKG081"]


INTERFACES = Interfaces(CMAKE, 12)
GENERATORS = Dependency(tag="buildtool_depend", name="rosidl_default_generators", line=9)
RUNTIME = Dependency(tag="exec_depend", name="rosidl_default_runtime", line=10)
MEMBER = Entry("rosidl_interface_packages", 11, {})


def test_a_package_with_messages() -> None:
    sound = manifest(BUILDTOOL, GENERATORS, RUNTIME, member_of_group=MEMBER)
    assert [*check_interfaces(sound, INTERFACES)] == []


def test_messages_without_group() -> None:
    (found,) = check_interfaces(manifest(BUILDTOOL, GENERATORS, RUNTIME), INTERFACES)
    assert (found.code, found.severity.value) == ("PKG079", "error")
    assert "(CMakeLists.txt, line 12)" in found.message


def test_messages_without_dependencies() -> None:
    found = [*check_interfaces(manifest(BUILDTOOL, member_of_group=MEMBER), INTERFACES)]
    assert [one.code for one in found] == ["PKG080", "PKG080"]
    assert "<buildtool_depend>rosidl_default_generators<" in (found[0].hint or "")
    assert "<exec_depend>rosidl_default_runtime<" in (found[1].hint or "")


def test_messages_are_known_by_what_is_installed(tmp_path: Path) -> None:
    source = tmp_path / "Reach.msg"
    source.write_text("")
    required = RequiredPackage(
        name="rosidl_default_generators", file=CMAKE, line=5, required=True, in_tests=False
    )
    message = InstalledFile(
        source=source, destination="share/demo/msg/Reach.msg", file=CMAKE, line=12
    )
    facts = BuildFacts(build_file=CMAKE, installed=(message,), required_packages=(required,))
    assert generated_interfaces("demo", facts) == INTERFACES
    assert generated_interfaces("demo", BuildFacts(build_file=CMAKE, installed=(message,))) is None
    without = BuildFacts(build_file=CMAKE, required_packages=(required,))
    assert generated_interfaces("demo", without) is None


@pytest.mark.parametrize("option", ["SKIP_GROUP_MEMBERSHIP_CHECK", "SKIP_INSTALL"])
def test_messages_that_need_no_group(option: str, tmp_path: Path) -> None:
    file = tmp_path / "CMakeLists.txt"
    file.write_text(f"rosidl_generate_interfaces(demo msg/Reach.msg {option})")
    message = InstalledFile(source=file, destination="share/demo/msg/Reach.msg", file=file, line=1)
    required = RequiredPackage(
        name="rosidl_default_generators", file=file, line=1, required=True, in_tests=False
    )
    facts = BuildFacts(build_file=file, installed=(message,), required_packages=(required,))
    assert generated_interfaces("demo", facts) is None


def test_the_group_is_in_the_wrong_place() -> None:
    wrong = manifest(BUILDTOOL, GENERATORS, RUNTIME)
    wrong = Manifest(
        name="demo",
        build_type="ament_cmake",
        dependencies=wrong.dependencies,
        file=FILE,
        entries={**wrong.entries, ("export", "member_of_group"): (MEMBER,)},
    )
    (found,) = check_interfaces(wrong, INTERFACES)
    assert (found.hint or "").startswith("Move <member_of_group>")
