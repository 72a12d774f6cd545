"""Updates of packages that their users have changed: of past templates, and by other answers."""

import os
import shutil
import stat
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from golden_support import EXAMPLES, read_tree
from past_packages import NOW, VERSIONS, archive_with_past, as_of, new_package
from wsgen.errors import NotFoundError, NotReadableError, RequestError
from wsgen.pipeline.merged_files import BESIDE, CONFLICT, KEPT, MERGED, MOVED, REMOVED
from wsgen.pipeline.update import (
    UpdatePlan,
    UpdateRequest,
    plan_update,
    refuse_unsaved,
    write_update,
)
from wsgen.templating.template import load_template
from wsgen.text.merge import OURS, THEIRS

OLD = "2026-11-22"
JAZZY = ("-t", "diff_drive", "--distro", "jazzy")


@pytest.fixture(scope="module")
def scratch(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("past")
    with archive_with_past(folder):
        yield folder


@pytest.fixture
def package(tmp_path: Path, scratch: Path) -> Path:
    """One of a past template."""
    return copied(OLD, JAZZY, tmp_path, scratch)


def copied(version: str, arguments: tuple[str, ...], folder: Path, scratch: Path) -> Path:
    """A package, made once."""
    name = "-".join((version or "now", *arguments)).replace("/", "_")
    made = scratch / name / "src" / "my_robot"
    if not made.exists():
        new_package(scratch / name, *arguments, version=version, scratch=scratch)
    package = folder / "src" / "my_robot"
    shutil.copytree(made, package, symlinks=True)
    return package


def updated(package: Path, request: UpdateRequest | None = None) -> UpdatePlan:
    plan = plan_update(package, request or UpdateRequest())
    write_update(plan)
    assert not [name for name in names_in(package) if name.startswith(".")]
    return plan


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def notes(plan: UpdatePlan, kind: str) -> dict[str, str]:
    return {change.path: change.note for change in plan.changes if change.kind == kind}


@pytest.mark.slow
@pytest.mark.parametrize("template", ["simple", "diff_drive", "arm", "wanderer"])
@pytest.mark.parametrize("version", [one for one in VERSIONS if one != NOW])
@pytest.mark.parametrize("target", [("iron", "classic"), ("jazzy", "gz")])
def test_an_untouched_package_becomes_what_new_writes(
    version: str, template: str, target: tuple[str, str], tmp_path: Path, scratch: Path
) -> None:
    if template not in VERSIONS[version]:
        pytest.skip("there was none yet")
    arguments = ("-t", template, "--distro", target[0], "--sim", target[1])
    package = copied(version, arguments, tmp_path, scratch)
    plan = updated(package)
    assert not plan.conflicts
    assert read_tree(package) == read_tree(copied(NOW, arguments, tmp_path / "now", scratch))
    assert plan_update(package, UpdateRequest()).changes == ()


@pytest.mark.parametrize(
    ("settings", "request_"),
    [
        (("--set", "wheel_radius=0.1"), UpdateRequest(settings=("wheel_radius=0.1",))),
        (("--distro", "iron"), UpdateRequest(distro="iron", simulator="classic")),
        (("--distro", "rolling"), UpdateRequest(distro="rolling")),
    ],
)
def test_another_answer_makes_the_difference_of_the_answers(
    settings: tuple[str, ...], request_: UpdateRequest, tmp_path: Path, scratch: Path
) -> None:
    package = copied(NOW, JAZZY, tmp_path, scratch)
    updated(package, request_)
    wanted = copied(NOW, (*JAZZY, *settings), tmp_path / "wanted", scratch)
    assert read_tree(package) == read_tree(wanted)
    updated(package, UpdateRequest(("wheel_radius=0.08",), "jazzy", "gz"))
    assert read_tree(package) == read_tree(copied(NOW, JAZZY, tmp_path / "back", scratch))


def test_a_robot_that_has_the_name_of_its_package_keeps_it(tmp_path: Path, scratch: Path) -> None:
    first = copied(NOW, ("-t", "simple"), tmp_path, scratch)
    workspace = first.parents[1]
    first.rename(first.with_name("other"))
    manifest = first.with_name("other") / "package.xml"
    manifest.write_text(manifest.read_text().replace("my_robot", "other"))
    package = new_package(workspace, "-t", "simple", scratch=scratch)
    launch_file = package / "launch" / "gazebo_model.launch.py"
    assert "'-entity', 'my_robot'" in launch_file.read_text()
    updated(package, UpdateRequest(distro="jazzy"))
    assert "'-name', 'my_robot'" in launch_file.read_text()


def test_lines_of_the_user_and_of_the_template_are_merged(package: Path) -> None:
    manifest = package / "package.xml"
    text = manifest.read_text()
    manifest.write_text(text.replace("<version>0.0.0", "<version>1.2.3"))
    (package / "notes.txt").write_bytes(b"mine\xff\n")
    plan = updated(package)
    assert notes(plan, MERGED).keys() == {"package.xml"}
    merged = manifest.read_text()
    assert "<version>1.2.3" in merged
    assert "ament_cmake_pytest" in merged
    assert "ament_cmake_pytest" not in text
    assert (package / "notes.txt").read_bytes() == b"mine\xff\n"


def test_conflicts_are_marked_and_listed_or_decided(package: Path, tmp_path: Path) -> None:
    file = package / "README.md"
    lines = file.read_text().splitlines(keepends=True)
    file.write_text("".join(f"my {line}" for line in lines))
    for prefer in (OURS, THEIRS):
        other = shutil.copytree(package, tmp_path / prefer)
        plan = updated(other, UpdateRequest(prefer=prefer))
        assert not plan.conflicts
        assert "<<<<<<<" not in (other / "README.md").read_text()
        assert ("my " in (other / "README.md").read_text()) == (prefer == OURS)
    plan = updated(package)
    assert notes(plan, CONFLICT).keys() == {"README.md"}
    merged = file.read_text()
    assert "<<<<<<< yours\nmy #" in merged
    assert ">>>>>>> template diff_drive (wsgen" in merged
    assert all(f"my {line}" in merged for line in lines)
    assert "state" in (package / "wsgen.toml").read_text()


def test_what_the_user_deleted_does_not_come_back(package: Path) -> None:
    (package / "README.md").unlink()
    shutil.rmtree(package / "model")
    plan = updated(package)
    assert notes(plan, KEPT).keys() >= {"README.md", "model/robot.gazebo"}
    assert not (package / "README.md").exists()
    assert not (package / "model").exists()


def test_a_file_that_the_user_moved_is_merged_where_it_is(package: Path) -> None:
    (package / "urdf").mkdir()
    (package / "launch" / "gazebo_model.launch.py").rename(package / "launch" / "my.launch.py")
    (package / "model" / "robot.gazebo").rename(package / "urdf" / "my.gazebo")
    before = (package / "urdf" / "my.gazebo").read_text()
    updated(package)
    assert not (package / "model" / "robot.gazebo").exists()
    assert (package / "urdf" / "my.gazebo").read_text() != before
    assert not (package / "launch" / "gazebo_model.launch.py").exists()


def test_a_file_of_the_user_that_the_template_has_now_stays(package: Path) -> None:
    test = package / "test" / "test_robot.py"
    assert not test.exists()
    test.parent.mkdir()
    test.write_text("mine\n")
    plan = updated(package, UpdateRequest(prefer=THEIRS))
    assert test.read_text() == "mine\n"
    beside = test.with_name(f"test_robot.py{BESIDE}")
    assert "def test_" in beside.read_text()
    assert "test/test_robot.py is yours" in notes(plan, CONFLICT)[f"test/test_robot.py{BESIDE}"]


def test_the_user_decides_by_ours_for_a_file_that_both_have(package: Path) -> None:
    (package / "test").mkdir()
    (package / "test" / "test_robot.py").write_text("mine\n")
    plan = updated(package, UpdateRequest(prefer=OURS))
    assert not plan.conflicts
    assert names_in(package / "test") == ["test_robot.py"]


def test_files_that_the_template_has_no_more_go_unless_changed(
    tmp_path: Path, scratch: Path
) -> None:
    package = copied(NOW, JAZZY, tmp_path, scratch)
    hook = package / "hooks" / "my_robot.sh.in"
    hook.write_text(hook.read_text() + "# mine\n")
    plan = updated(package, UpdateRequest(distro="iron", simulator="classic"))
    assert notes(plan, KEPT).keys() == {"hooks/my_robot.sh.in"}
    assert notes(plan, REMOVED).keys() == {"hooks/my_robot.dsv.in", "config/bridge.yaml"}
    assert hook.read_text().endswith("# mine\n")
    assert names_in(package / "hooks") == ["my_robot.sh.in"]


def test_a_file_that_the_template_moved_takes_the_lines_of_the_user_along(
    tmp_path: Path, scratch: Path
) -> None:
    template = tmp_path / "pendulum"
    package, _ = of_own_template(template, tmp_path)
    world = package / "model" / "robot.xacro"
    world.write_text(world.read_text().replace("<robot", "<!-- mine -->\n<robot"))
    manifest = template / "template.toml"
    manifest.write_text(manifest.read_text().replace('"model/robot.xacro"', '"urdf/arm.xacro"'))
    commit(template)
    plan = updated(package)
    assert notes(plan, MOVED) == {"urdf/arm.xacro": "was model/robot.xacro"}
    assert not world.exists()
    assert "<!-- mine -->" in (package / "urdf" / "arm.xacro").read_text()


def test_line_ends_modes_encodings_and_links_stay(package: Path, tmp_path: Path) -> None:
    readme, world = package / "README.md", package / "model" / "empty_world.world"
    readme.write_bytes(readme.read_bytes().replace(b"\n", b"\r\n"))
    readme.chmod(0o600)
    launch_file = package / "launch" / "gazebo_model.launch.py"
    launch_file.write_bytes(launch_file.read_bytes() + "# größer\n".encode("latin-1"))
    launch_file.chmod(0o755)
    shared = tmp_path / "shared.world"
    shared.write_text("shared")
    world.unlink()
    world.symlink_to(shared)
    updated(package)
    assert readme.read_bytes().count(b"\n") == readme.read_bytes().count(b"\r\n")
    assert b"without ROS" in readme.read_bytes()
    assert stat.S_IMODE(readme.stat().st_mode) == 0o600
    assert launch_file.read_bytes().endswith("# größer\n".encode("latin-1"))
    assert stat.S_IMODE(launch_file.stat().st_mode) == 0o755
    assert world.is_symlink()
    assert shared.read_text() == "shared"


def test_nothing_is_written_through_links_and_over_folders(package: Path, tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    (package / "model").rename(outside)
    (package / "model").symlink_to(outside)
    (package / "README.md").unlink()
    (package / "README.md").mkdir()
    before = read_tree(outside)
    plan = updated(package)
    assert read_tree(outside) == before
    assert (package / "README.md").is_dir()
    assert "behind the link model" in notes(plan, KEPT)["model/robot.gazebo"]
    assert "README.md is a folder" in notes(plan, CONFLICT)[f"README.md{BESIDE}"]


def test_what_is_no_text_is_not_merged(package: Path) -> None:
    (package / "README.md").write_bytes(b"PK\0\1")
    plan = updated(package)
    assert (package / "README.md").read_bytes() == b"PK\0\1"
    assert f"README.md{BESIDE}" in notes(plan, CONFLICT)


def test_a_program_is_executable(tmp_path: Path, scratch: Path) -> None:
    package = copied("2026-11-23", ("-t", "wanderer"), tmp_path, scratch)
    node = package / "scripts" / "wanderer.py"
    before = node.read_bytes()
    updated(package)
    assert node.read_bytes() != before
    assert os.access(node, os.X_OK)


def test_the_record_is_written_between_the_comments_of_the_user(
    tmp_path: Path, scratch: Path
) -> None:
    package = copied(NOW, JAZZY, tmp_path, scratch)
    file = package / "wsgen.toml"
    text = file.read_text()
    text = text.replace("wheel_radius = 0.08", "wheel_radius   = 0.08 # measured\n# by me")
    text = text.replace("[target]", "# mine\n[target] # x")
    file.write_text(text.replace('distro = "jazzy"', "distro = 'jazzy'  # LTS"))
    updated(package, UpdateRequest(("wheel_radius=0.1",), distro="rolling"))
    text = text.replace("= 0.08", "= 0.1").replace('distro = "jazzy"', 'distro = "rolling"  # LTS')
    assert file.read_text() == text


def test_a_record_with_windows_line_ends(tmp_path: Path, scratch: Path) -> None:
    package = copied(OLD, JAZZY, tmp_path, scratch)
    file = package / "wsgen.toml"
    file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n"))
    updated(package, UpdateRequest(("wheel_radius=0.1",)))
    assert file.read_bytes().count(b"\n") == file.read_bytes().count(b"\r\n")
    assert b"wheel_radius = 0.1\r\n" in file.read_bytes()


WRONG = {
    "no file": (None, NotFoundError, "wsgen did not create this package"),
    "no TOML": (("schema = 1", "schema = "), NotReadableError, "is not TOML: .*line 2"),
    "no state": (("state =", "status ="), RequestError, "has no `state`"),
    "from": (
        ('template = "diff_drive"\nstate =', 'template = "existing"\n#'),
        RequestError,
        "that existed",
    ),
    "state": (("base-", "base-0"), NotFoundError, "does not have the templates `base-0"),
    "no target": (
        ('distro = "', 'distribution = "'),
        NotReadableError,
        r"no text `distro` in \[target",
    ),
    "distro": (('"jazzy"', '"foxy"'), RequestError, r"wsgen.toml:\d+: .*foxy"),
    "template": (('"diff_drive"', '"tricycle"'), RequestError, r"wsgen.toml:4: .*'tricycle'"),
    "answer": (
        ("wheel_mass = 0.5", "wheel_mass = 50.0"),
        RequestError,
        r"wsgen.toml:\d+: `wheel_mass`",
    ),
    "kind": (
        ("wheel_mass = 0.5", "wheel_mass = [1]"),
        RequestError,
        r"wsgen.toml:\d+: `wheel_mass`",
    ),
    "variable": (
        ("wheel_mass =", "wheel_weight ="),
        RequestError,
        r"wsgen.toml:\d+: .*`wheel_weight`",
    ),
    "inline": (
        ("[target]\n", "target = {}\n[more]\n"),
        NotReadableError,
        r"no text `distro` in \[target",
    ),
    "dotted": (
        ('template = "diff_drive"\n', 'template = "diff_drive"\nanswers.wheel_mass = 0.5\n'),
        NotReadableError,
        "not TOML",
    ),
    "quoted": (
        ('simulator = "gz"', 'simulator = """gz"""'),
        RequestError,
        "`simulator` does not stand alone on",
    ),
    "license": (
        ('license = "Apache-2.0"', 'license = "GPL"'),
        RequestError,
        r"wsgen.toml:\d+: .*'GPL'",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_record_is_refused_by_file_and_line(
    case: str, tmp_path: Path, scratch: Path
) -> None:
    package = copied(NOW, JAZZY, tmp_path, scratch)
    file = package / "wsgen.toml"
    edit, kind, words = WRONG[case]
    if edit is None:
        file.unlink()
    else:
        assert edit[0] in file.read_text()
        file.write_text(file.read_text().replace(*edit, 1))
    before = read_tree(package)
    with pytest.raises(kind, match=words) as raised:
        plan_update(package, UpdateRequest(("wheel_radius=0.1",)))
    assert raised.value.hint
    if case == "no state":
        assert "-t diff_drive --distro jazzy --sim gz --set body_length=0.4" in raised.value.hint
    assert read_tree(package) == before


@pytest.mark.parametrize(
    "request_",
    [
        UpdateRequest(("wheel_radius=9",)),
        UpdateRequest(("wheel=9",)),
        UpdateRequest(distro="foxy"),
        UpdateRequest(distro="jazzy", simulator="classic"),
        UpdateRequest(template="/tmp"),
    ],
)
def test_a_wrong_request_is_refused(request_: UpdateRequest, tmp_path: Path, scratch: Path) -> None:
    package = copied(NOW, JAZZY, tmp_path, scratch)
    with pytest.raises(RequestError) as raised:
        plan_update(package, request_)
    assert "wsgen.toml:" not in raised.value.message


def test_a_failure_while_writing_leaves_everything_as_it_was(
    package: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = plan_update(package, UpdateRequest())
    before = read_tree(package)
    renamed = Path.rename
    calls: list[Path] = []

    def rename(self: Path, target: Path) -> Path:
        calls.append(self)
        if len(calls) == 8:
            raise OSError(28, "No space left on device", str(target))
        return renamed(self, target)

    monkeypatch.setattr(Path, "rename", rename)
    with pytest.raises(NotReadableError, match="disk is full"):
        write_update(plan)
    monkeypatch.undo()
    assert read_tree(package) == before
    assert names_in(package) == sorted({path.split("/")[0] for path in before})


def commit(folder: Path) -> None:
    words = ("git", "-C", str(folder), "-c", "user.name=A", "-c", "user.email=a@b.cd")
    subprocess.run(["git", "-C", str(folder), "init", "-q"], check=True)
    subprocess.run([*words, "add", "-A"], check=True)
    subprocess.run([*words, "commit", "-q", "-m", "x"], check=True)


def of_own_template(template: Path, folder: Path) -> tuple[Path, Path]:
    """A package of a template of the user, which git has."""
    shutil.copytree(EXAMPLES / "templates" / "pendulum", template)
    commit(template)
    return new_package(folder / "ws", "-t", str(template), scratch=folder), template


@pytest.mark.slow
def test_a_template_of_the_user_is_that_of_its_commit(tmp_path: Path) -> None:
    package, template = of_own_template(tmp_path / "repository" / "pendulum", tmp_path)
    assert "commit = " in (package / "wsgen.toml").read_text()
    assert not plan_update(package, UpdateRequest()).changes
    source = next(template.glob("*.xacro.j2"))
    source.write_text(source.read_text().replace("<link", "<!-- new -->\n<link", 1))
    xacro = package / "model" / "robot.xacro"
    xacro.write_text(xacro.read_text() + "<!-- mine -->\n")
    commit(template)
    plan = updated(package)
    assert {change.path for change in plan.changes} == {"model/robot.xacro", "wsgen.toml"}
    text = xacro.read_text()
    assert "<!-- new -->" in text
    assert text.endswith("<!-- mine -->\n")

    moved = template.rename(tmp_path / "repository" / "other")
    with pytest.raises(NotFoundError, match="is not in"):
        plan_update(package, UpdateRequest())
    assert not updated(package, UpdateRequest(template=str(moved))).conflicts


@pytest.mark.slow
def test_a_template_that_git_did_not_have_says_what_is_missing(tmp_path: Path) -> None:
    template = tmp_path / "pendulum"
    package, _ = of_own_template(template, tmp_path)
    file = package / "wsgen.toml"
    line = next(one for one in file.read_text().splitlines() if one.startswith("commit"))
    file.write_text(file.read_text().replace(line, f'commit = "{"0" * 40}"'))
    with pytest.raises(NotFoundError, match="does not have the template at commit 000000000000"):
        plan_update(package, UpdateRequest())
    file.write_text(file.read_text().replace(f'commit = "{"0" * 40}"\n', ""))
    with pytest.raises(RequestError, match="no `commit`"):
        plan_update(package, UpdateRequest())


def test_it_works_without_git(package: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")
    refuse_unsaved(package)
    assert updated(package).writes


def test_versions_are_as_they_are_kept(scratch: Path) -> None:
    with as_of(OLD, scratch):
        assert load_template("arm").shipped == ("arm", "base")
