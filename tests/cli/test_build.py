"""`wsgen build`: what it prints of the programs' own words."""

import json
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cli.packages import wsgen

pytestmark = pytest.mark.slow

PACKAGE_XML = """\
<package format="3">
  <name>demo</name>
  <version>0.0.0</version>
  <description>A robot for tests.</description>
  <maintainer email="somebody@example.com">Somebody</maintainer>
  <license>Apache-2.0</license>
  <export><build_type>ament_cmake</build_type></export>
</package>
"""
CMAKE = """\
cmake_minimum_required(VERSION 3.20)
project(demo LANGUAGES NONE)
find_package(ament_cmake REQUIRED)
ament_package()
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    folder = tmp_path / "src" / "demo"
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(PACKAGE_XML)
    (folder / "CMakeLists.txt").write_text(CMAKE)
    return folder


def build(package: Path, *options: str) -> tuple[int, str]:
    """The exit code and what was printed."""
    run = subprocess.run(
        [sys.executable, "-m", "wsgen", "build", *options],
        cwd=package,
        capture_output=True,
        text=True,
        check=False,
    )
    assert "Next:" not in run.stdout
    assert "[BLD" not in run.stderr  # diagnostics are the result
    return run.returncode, run.stdout + run.stderr


def test_where_it_builds_is_said_before(package: Path, tmp_path: Path) -> None:
    note = f"note: The current folder is in the workspace {tmp_path}, which is used.\n"
    assert note in build(package)[1]
    assert "note:" not in build(tmp_path)[1]
    (tmp_path / "ws" / "src").mkdir(parents=True)
    (tmp_path / "ws" / "src" / "notes.txt").touch()
    code, output = build(tmp_path / "ws")
    assert (code, f"{tmp_path / 'ws'} has no package." in output) == (4, True)


def test_the_next_step(package: Path) -> None:
    assert build(package)[1].endswith("\nNext: wsgen validate\n")
    assert build(package, "demo")[1].endswith("\nNext: wsgen validate demo\n")
    assert "Next:" not in build(package, "-q")[1]
    (package / "CMakeLists.txt").write_text(CMAKE + "message(FATAL_ERROR no)\n")
    assert "Next:" not in build(package)[1]


def test_json(package: Path) -> None:
    old = CMAKE.replace("VERSION 3.20", "VERSION 3.8") + "message(WARNING strange)\n"
    (package / "CMakeLists.txt").write_text(old)
    run = wsgen(package, "build", "--format", "json")
    document = json.loads(run.stdout)
    assert run.returncode == 0
    assert (document["version"], document["passed"]) == (1, True)
    assert [(one["package"], one["state"]) for one in document["packages"]] == [("demo", "built")]
    assert Path(document["log"], "demo", "stdout_stderr.log").is_file()
    (note,) = document["diagnostics"]
    assert (note["code"], note["severity"], note["line"]) == ("BLD030", "info", 1)
    assert note["file"] == str(package / "CMakeLists.txt")
    assert "strange" in run.stderr  # no diagnostic says it
    assert "BLD030" not in run.stderr
    assert "Next:" not in run.stderr


def test_json_of_a_failure(package: Path) -> None:
    (package / "CMakeLists.txt").write_text(CMAKE + "message(FATAL_ERROR strange)\n")
    run = wsgen(package.parents[1], "build", "--format", "json", "-q")
    document = json.loads(run.stdout)
    assert (run.returncode, document["passed"], run.stderr) == (1, False, "")
    assert document["packages"][0]["state"] == "failed"
    assert [found["code"] for found in document["diagnostics"]] == ["BLD015"]


def test_json_is_empty_where_there_is_no_result(tmp_path: Path) -> None:
    run = wsgen(tmp_path, "build", "--format", "json")
    assert (run.returncode, run.stdout) == (4, "")


def test_a_traceback_that_is_explained_is_for_verbose(package: Path) -> None:
    (package / "package.xml").write_text(PACKAGE_XML.replace("<license>Apache-2.0</license>", ""))
    code, printed = build(package)
    assert code == 1
    assert "Traceback" not in printed
    assert "try: Add: <license>Apache-2.0</license>" in printed
    assert "Traceback" in build(package, "-v")[1]


def test_the_build_goes_on_after_a_failure(package: Path) -> None:
    (package / "CMakeLists.txt").write_text("message(FATAL_ERROR no)\n")
    for name in ("zlast", "zmore"):
        shutil.copytree(package, package.with_name(name))
        manifest = PACKAGE_XML.replace("<name>demo", f"<name>{name}")
        (package.with_name(name) / "package.xml").write_text(manifest)
        (package.with_name(name) / "CMakeLists.txt").write_text(CMAKE.replace("demo", name))
    code, words = build(package, "--", "--executor", "sequential")
    assert code == 1
    assert "2 built, 1 failed  " in words
    assert words.endswith("\nNext: fix the errors, or validate what is built: wsgen validate\n")


def test_what_is_left_out_is_reported_in_a_line_each(package: Path) -> None:
    shutil.copytree(package, package.with_name("zlast"))
    for name in ("demo", "zlast"):
        folder = package.with_name(name)
        (folder / "package.xml").write_text(PACKAGE_XML.replace("<name>demo", f"<name>{name}"))
        asks = "find_package(rclcpp REQUIRED)\nnone_rclcpp_do()\n"
        cmake = CMAKE.replace("demo", name).replace("ament_package", f"{asks}ament_package")
        (folder / "CMakeLists.txt").write_text(cmake)
    words = build(package)[1]
    first, second, hint, *_ = words.splitlines()
    assert first.startswith("info[BLD032] not-compiled: demo is built without")
    assert second.startswith("    and: zlast is built without")
    assert hint.startswith("   try: Source a ROS")


def test_the_output_of_an_unknown_failure_is_printed_once(package: Path) -> None:
    (package / "CMakeLists.txt").write_text(CMAKE + "message(FATAL_ERROR\n  strange)\n")
    for options in ((), ("-v",)):
        code, printed = build(package, *options)
        assert code == 1
        assert printed.count("CMake Error at CMakeLists.txt:5") == 1
    assert "CMake Error at" not in build(package, "-q")[1]


def test_warnings_of_a_good_build_are_printed(package: Path) -> None:
    (package / "CMakeLists.txt").write_text(CMAKE + "message(WARNING strange)\n")
    code, printed = build(package)
    assert code == 0
    assert "strange" in printed


def test_a_workspace_that_cannot_be_written(package: Path) -> None:
    (package.parents[1] / "build").touch()
    code, printed = build(package)
    assert code == 4
    assert "cannot write" in printed


def test_a_small_disk_is_reported_in_one_line(package: Path) -> None:
    """The real thing: a file system of 200 kB, too small for what CMake makes of a package."""
    root = package.parents[1]
    small = root / "small"
    small.mkdir()
    script = f"""
        mount -t tmpfs -o size=200k tmpfs '{small}' && cp -r '{root}/src' '{small}' || exit 99
        cd '{small}' && {shlex.quote(sys.executable)} -m wsgen build
    """
    try:
        run = subprocess.run(
            ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", script],
            capture_output=True,
            text=True,
            check=False,
        )
    except OSError:
        pytest.skip("there is no unshare")
    if run.returncode == 99 or "unshare:" in run.stderr:
        pytest.skip("this machine lets nobody mount")
    assert run.returncode == 4, run.stderr
    assert run.stderr.count("the disk is full") == 1
    assert f"({small})" in run.stderr
    assert "Traceback" not in run.stderr
    assert len(run.stderr.splitlines()) <= 3
