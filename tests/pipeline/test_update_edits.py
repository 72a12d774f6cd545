"""Random changes of a user, between past templates: no line is lost, whatever was done."""

import shutil
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from forks import run_wsgen
from golden_support import read_tree
from past_packages import NOW, VERSIONS, archive_with_past, new_package
from wsgen.pipeline.merged_files import BESIDE
from wsgen.pipeline.update import UpdateRequest, plan_update, write_update

CASES = [
    (version, template, distro)
    for version, made in VERSIONS.items()
    for template in ("simple", "diff_drive", "arm", "wanderer")
    for distro in ("iron", "jazzy")
    if version != NOW and f"{template}-" in made
]
MARK = b"# by the user "


class Edit(NamedTuple):
    """A change of one file; the numbers choose file and line, modulo how many there are."""

    kind: str
    file: int
    line: int


EDITS = st.lists(
    st.builds(
        Edit,
        st.sampled_from(
            ["insert", "append", "delete", "repeat", "windows", "open", "remove", "add"]
        ),
        st.integers(0, 100),
        st.integers(0, 500),
    ),
    max_size=8,
)


@pytest.fixture(scope="module")
def scratch(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("past")
    with archive_with_past(folder):
        yield folder


def apply(edits: list[Edit], package: Path) -> None:
    names = sorted(name for name in read_tree(package) if name != "wsgen.toml")
    for number, (kind, file, line) in enumerate(edits):
        path = package / names[file % len(names)]
        mark = MARK + str(number).encode()
        if kind == "add":
            path = package / ["test/test_robot.py", "config/mine.yaml"][file % 2]
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(mark + b"\n")
        elif kind == "remove":
            path.unlink(missing_ok=True)
        elif path.exists():
            lines = path.read_bytes().split(b"\n")
            at = line % len(lines)
            edited = {
                "insert": [*lines[:at], mark, *lines[at:]],
                "append": [*lines[:at], lines[at] + mark, *lines[at + 1 :]],
                "delete": [*lines[:at], *lines[at + 3 :]],
                "repeat": [*lines[: at + 4], *lines[at:]],
                "windows": [one.rstrip(b"\r") + b"\r" for one in lines[:-1]] + lines[-1:],
                "open": lines[:-1] if not lines[-1] else lines,
            }
            path.write_bytes(b"\n".join(edited[kind]))


def lines_of(data: bytes) -> Counter[bytes]:
    return Counter(line.rstrip(b"\r") for line in data.split(b"\n"))


def bytes_in(package: Path) -> dict[str, bytes]:
    return {name: (package / name).read_bytes() for name in read_tree(package)}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("version", "template", "distro"),
    [
        pytest.param(*case, marks=[] if case in {CASES[-1], CASES[2]} else pytest.mark.thorough)
        for case in CASES
    ],
)
@settings(max_examples=10)
@given(edits=EDITS)
def test_no_line_is_lost(
    version: str,
    template: str,
    distro: str,
    edits: list[Edit],
    scratch: Path,
) -> None:
    made = scratch / f"{version}-{template}-{distro}"
    arguments = ("-t", template, "--distro", distro)
    if not made.exists():
        new_package(made, *arguments, version=version, scratch=scratch)
        new_package(scratch / f"now-{made.name}", *arguments, scratch=scratch)
    base = bytes_in(made / "src" / "my_robot")
    theirs = bytes_in(scratch / f"now-{made.name}" / "src" / "my_robot")
    package = scratch / "edited" / "my_robot"
    shutil.rmtree(package, ignore_errors=True)
    shutil.copytree(made / "src" / "my_robot", package)
    apply(edits, package)
    ours = bytes_in(package)
    write_update(plan_update(package, UpdateRequest()))
    after = bytes_in(package)
    for name, data in ours.items():
        lost = lines_of(data) - lines_of(base.get(name, b"")) - lines_of(after.get(name, b""))
        assert not lost, name
        if data == base.get(name):
            assert after.get(name) == theirs.get(name), name
    assert not after.keys() & (base.keys() - ours.keys())
    beside = {name.removesuffix(BESIDE) for name in after if name.endswith(BESIDE)}
    assert beside <= ours.keys() - base.keys()
    assert not plan_update(package, UpdateRequest()).writes


@pytest.mark.slow
@pytest.mark.parametrize(
    ("template", "distro"),
    [
        ("wanderer", "jazzy"),
        pytest.param("arm", "iron", marks=pytest.mark.thorough),
        pytest.param("diff_drive", "jazzy", marks=pytest.mark.thorough),
    ],
)
def test_what_is_merged_builds_and_is_what_it_was(
    template: str, distro: str, tmp_path: Path, scratch: Path
) -> None:
    version = "2026-11-23"
    arguments = ("-t", template, "--distro", distro)
    package = new_package(tmp_path, *arguments, version=version, scratch=scratch)
    for name in ("CMakeLists.txt", "launch/gazebo_model.launch.py"):
        file = package / name
        file.write_bytes(file.read_bytes().replace(b"\n", b"\r\n") + b"# mine\r\n")
    plan = plan_update(package, UpdateRequest(distro="rolling"))
    assert not plan.conflicts
    write_update(plan)
    for words in (["build", "-q"], ["validate", "-q"]):
        done = run_wsgen(words, cwd=tmp_path)
        assert done.returncode == 0, done.stdout + done.stderr
