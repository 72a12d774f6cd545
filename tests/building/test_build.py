"""Builds with the toolchain of the wheels, through the function behind `wsgen build`."""

import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from building.building import (
    CMAKE,
    COLCON,
    LINTED,
    PACKAGE_XML,
    SHELL_PROGRAMS,
    build_here,
    cache_entry,
    link_programs,
    outside,
    plain_colcon,
    read_tree,
    write_package,
)
from wsgen.diagnostics import Severity
from wsgen.errors import NotFoundError, RequestError
from wsgen.events import Event, OutputLine, StepEnded, StepProgressed, StepStarted

pytestmark = pytest.mark.slow


def test_a_package_is_installed_and_its_events_tell(tmp_path: Path) -> None:
    write_package(tmp_path)
    events: list[Event] = []
    result = build_here(tmp_path, events=events)
    assert result.succeeded
    assert result.diagnostics == ()
    assert [(package.name, package.outcome) for package in result.packages] == [("demo", "built")]
    assert result.packages[0].error_output == ()  # not a warning
    assert result.log_folder == (tmp_path / "log" / "latest_build").resolve()
    share = tmp_path / "install" / "demo" / "share" / "demo"
    assert (share / "model" / "robot.xacro").is_file()
    assert (share / "launch" / "demo.launch.py").is_file()

    steps = [event for event in events if not isinstance(event, OutputLine)]
    assert [type(event) for event in steps] == [
        StepStarted,
        StepStarted,
        *[StepProgressed] * 3,
        StepEnded,
        StepEnded,
    ]
    progress = [event.detail for event in steps if isinstance(event, StepProgressed)]
    assert progress == ["cmake", "build", "install"]
    assert [event.step for event in steps if isinstance(event, StepEnded)] == [
        ("build", "demo"),
        ("build",),
    ]
    printed = [event.text for event in events if isinstance(event, OutputLine)]
    assert any(line.startswith("-- Installing:") for line in printed)


def test_nothing_is_printed_and_nothing_changed_here(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    write_package(tmp_path)
    before = (dict(os.environ), Path.cwd(), signal.getsignal(signal.SIGINT))
    build_here(tmp_path)
    assert capfd.readouterr() == ("", "")
    assert (dict(os.environ), Path.cwd(), signal.getsignal(signal.SIGINT)) == before


def test_the_second_build_configures_nothing_whoever_built_first(tmp_path: Path) -> None:
    write_package(tmp_path)
    build_here(tmp_path)
    printed = [build_and_list(tmp_path), plain_log(tmp_path), build_and_list(tmp_path)]
    assert not any("Configuring done" in text for text in printed)


def build_and_list(root: Path) -> str:
    events: list[Event] = []
    assert build_here(root, events=events).succeeded
    return "\n".join(event.text for event in events if isinstance(event, OutputLine))


def plain_log(root: Path) -> str:
    return plain_colcon(root, outside(), "--event-handlers", "console_direct+")


def test_the_install_space_is_byte_for_byte_that_of_plain_colcon(tmp_path: Path) -> None:
    write_package(tmp_path)
    # colcon writes the name of its interpreter down, and a Python may have several.
    plain_colcon(tmp_path, outside(), program=(sys.executable, COLCON))
    plain = read_tree(tmp_path / "install")
    for folder in ("build", "install", "log"):
        shutil.rmtree(tmp_path / folder)
    build_here(tmp_path)
    assert read_tree(tmp_path / "install") == plain


def test_two_builds_at_once_in_one_process(tmp_path: Path) -> None:
    roots = [tmp_path / "one", tmp_path / "two"]
    succeeded: list[bool] = []
    threads = []
    for root in roots:
        write_package(root)
        thread = threading.Thread(target=lambda r=root: succeeded.append(build_here(r).succeeded))
        threads.append(thread)
        thread.start()
    for thread in threads:
        thread.join()
    assert succeeded == [True, True]


def test_a_package_brings_what_it_depends_on(tmp_path: Path) -> None:
    depends = PACKAGE_XML.replace("<export>", "<depend>base</depend>\n  <export>")
    write_package(tmp_path, "arm", package_xml=depends)
    write_package(tmp_path, "base")
    write_package(tmp_path, "unrelated")
    result = build_here(tmp_path, "arm")
    assert [package.name for package in result.packages] == ["base", "arm"]


@pytest.mark.parametrize("sign", [";", "$", ":", "\n", '"', "[", "?", "`"])
def test_folders_that_cmake_or_colcon_cannot_write_down(sign: str, tmp_path: Path) -> None:
    root = tmp_path / f"my{sign}ws"
    write_package(root)
    with pytest.raises(RequestError, match="do not support"):
        build_here(root)
    assert [entry.name for entry in root.iterdir()] == ["src"]


def test_a_copy_of_a_workspace_is_not_built_in_the_original(tmp_path: Path) -> None:
    write_package(tmp_path / "ws")
    assert build_here(tmp_path / "ws").succeeded
    copy = Path(shutil.copytree(tmp_path / "ws", tmp_path / "the copy"))
    built = (tmp_path / "ws" / "build" / "demo" / "CMakeCache.txt").read_text()
    result = build_here(copy)
    assert result.succeeded
    (diagnostic,) = result.diagnostics
    assert (diagnostic.code, diagnostic.severity) == ("BLD025", Severity.WARNING)
    assert f"{tmp_path}/ws/build/demo" in diagnostic.message
    assert cache_entry(copy, "CMAKE_CACHEFILE_DIR") == str(copy / "build" / "demo")
    assert (tmp_path / "ws" / "build" / "demo" / "CMakeCache.txt").read_text() == built
    assert f"rm -rf '{copy}/build' '{copy}/install' '{copy}/log'" in (diagnostic.hint or "")
    assert build_here(copy, colcon_arguments=("--build-base", "build2")).succeeded
    link = tmp_path / "link"
    link.symlink_to(tmp_path / "ws")
    assert build_here(link).succeeded  # the same place by another name


def test_a_package_that_was_moved_in_the_workspace(tmp_path: Path) -> None:
    package = write_package(tmp_path)
    assert build_here(tmp_path).succeeded
    (tmp_path / "src" / "robots").mkdir()
    moved = package.rename(tmp_path / "src" / "robots" / "demo")
    result = build_here(tmp_path)
    assert result.succeeded
    (diagnostic,) = result.diagnostics
    assert (diagnostic.code, diagnostic.file) == ("BLD026", moved)
    assert cache_entry(tmp_path, "CMAKE_HOME_DIRECTORY") == str(moved)
    assert build_here(tmp_path).diagnostics == ()


def test_folders_with_spaces_and_letters_of_all_kinds(tmp_path: Path) -> None:
    root = tmp_path / "my wörkspace"
    write_package(root)
    assert build_here(root).succeeded


def test_a_machine_without_make_and_cmake(tmp_path: Path) -> None:
    write_package(tmp_path)
    path = link_programs(tmp_path / "programs", *SHELL_PROGRAMS)
    assert build_here(tmp_path, environment={**outside(), "PATH": str(path)}).succeeded
    assert cache_entry(tmp_path, "CMAKE_GENERATOR") == "Ninja"
    # A build folder keeps its generator; the other one's user can go on with it.
    plain_colcon(tmp_path, outside())


def test_missing_linters_do_not_stop_the_build(tmp_path: Path) -> None:
    package = write_package(tmp_path, cmake=LINTED)
    result = build_here(tmp_path, colcon_arguments=("--cmake-args", "-DMINE=1"))
    assert result.succeeded
    (note,) = result.diagnostics
    assert (note.code, note.severity) == ("BLD001", Severity.INFO)
    assert (note.file, note.line) == (package / "CMakeLists.txt", 9)
    assert "ament_lint_auto" in note.message
    assert cache_entry(tmp_path, "MINE") == "1"


def test_missing_linters_are_reported_once(tmp_path: Path) -> None:
    for name in ("demo", "other", "third"):
        write_package(tmp_path, name, cmake=LINTED)
    (note,) = build_here(tmp_path).diagnostics
    assert (note.code, note.element) == ("BLD001", None)
    assert note.message.startswith("demo, other, third are built without tests")
    assert note.message.count("ament_lint_auto") == 1


def test_who_asks_for_tests_gets_them(tmp_path: Path) -> None:
    write_package(tmp_path, cmake=LINTED)
    result = build_here(tmp_path, colcon_arguments=("--cmake-args", "-DBUILD_TESTING=ON"))
    assert result.succeeded  # the linters are left out
    assert cache_entry(tmp_path, "BUILD_TESTING") == "ON"


def test_a_deprecated_minimum_is_reported_once(tmp_path: Path) -> None:
    """As `ros2 pkg create` of Humble to Jazzy writes it."""
    old = CMAKE.replace("VERSION 3.20", "VERSION 3.8") + 'message(WARNING "mine")\n'
    folders = [write_package(tmp_path, name, cmake=old) for name in ("one", "two")]
    result = build_here(tmp_path)
    assert result.succeeded
    (note,) = result.diagnostics
    assert (note.code, note.severity, note.line) == ("BLD030", Severity.INFO, 1)
    assert note.file in {folder / "CMakeLists.txt" for folder in folders}
    assert {"one", "two"} <= set(note.message.replace(",", "").rstrip(".").split())
    assert "VERSION 3.8...3.31" in (note.hint or "")
    printed = "\n".join(result.unexplained_output)
    assert printed.count("mine") == 2
    assert "Deprecation" not in printed
    assert "<max>" not in printed


def test_the_version_in_the_hint_is_not_deprecated(tmp_path: Path) -> None:
    write_package(tmp_path, cmake=CMAKE.replace("VERSION 3.20", "VERSION 3.8...3.31"))
    assert build_here(tmp_path).diagnostics == ()


def test_a_workspace_with_a_python_package(tmp_path: Path) -> None:
    write_package(tmp_path)
    package = tmp_path / "src" / "scripts"
    package.mkdir()
    (package / "package.xml").write_text(
        PACKAGE_XML.replace(">demo<", ">scripts<").replace("ament_cmake", "ament_python")
    )
    (package / "setup.py").write_text(
        "from setuptools import setup\nsetup(name='scripts', version='0.0.0', packages=[])\n"
    )
    (package / "setup.cfg").write_text("[install]\ninstall_scripts=$base/lib/scripts\n")
    result = build_here(tmp_path)
    names = sorted(package.name for package in result.packages if package.outcome == "built")
    assert names == ["demo", "scripts"]


@pytest.mark.parametrize(
    ("name", "hint"),
    [("demmo", "Did you mean `demo`?"), ("something", "Known: demo."), (".", "not by folder")],
)
def test_an_unknown_package(tmp_path: Path, name: str, hint: str) -> None:
    write_package(tmp_path)
    with pytest.raises(RequestError) as raised:
        build_here(tmp_path, name)
    assert hint in raised.value.hint
    assert not (tmp_path / "build").exists()


def test_an_ignored_package(tmp_path: Path) -> None:
    write_package(tmp_path)
    marker = write_package(tmp_path, "old") / "COLCON_IGNORE"
    marker.touch()
    with pytest.raises(RequestError) as raised:
        build_here(tmp_path, "old")
    assert str(marker) in raised.value.message


def test_nothing_to_build(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    with pytest.raises(NotFoundError, match="wsgen new"):
        build_here(tmp_path)
    (tmp_path / "src" / "arm" / "launch").mkdir(parents=True)
    with pytest.raises(NotFoundError, match=r"src/arm has no package\.xml"):
        build_here(tmp_path)
    (write_package(tmp_path) / "COLCON_IGNORE").touch()
    with pytest.raises(NotFoundError, match="COLCON_IGNORE"):
        build_here(tmp_path)


@pytest.mark.parametrize("arguments", [("--no-such-option",), ("--executor", "none")])
def test_arguments_that_colcon_refuses(tmp_path: Path, arguments: tuple[str, ...]) -> None:
    write_package(tmp_path)
    with pytest.raises(RequestError, match=r"colcon refuses the arguments"):
        build_here(tmp_path, colcon_arguments=arguments)


def test_a_name_that_only_colcon_could_know(tmp_path: Path) -> None:
    write_package(tmp_path)
    (tmp_path / "src" / "plain").mkdir()
    (tmp_path / "src" / "plain" / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.20)\nproject(library LANGUAGES NONE)\n"
    )
    assert build_here(tmp_path, "library").succeeded
    with pytest.raises(RequestError, match="nowhere"):
        build_here(tmp_path, "nowhere")


# A CMakeLists.txt that works for a minute, silently or not, and leaves its process id in a file.
SLEEP = 'execute_process(COMMAND sh -c "echo $$ > {pid_file}; exec sleep 600")\n'
TICK = (
    'execute_process(COMMAND sh -c "echo $$ > {pid_file}; '
    'for i in $(seq 6000); do echo $i; sleep 0.1; done")\n'
)

BUILD_SCRIPT = """
import os
from pathlib import Path
from wsgen.building.run import build
from wsgen.packages.workspace.layout import Workspace
try:
    build(Workspace(root=Path({root!r})), environment=os.environ)
except KeyboardInterrupt:
    raise SystemExit(130)
"""


@pytest.mark.parametrize(
    ("work", "number", "returncode"),
    [
        (SLEEP, signal.SIGINT, 130),
        (SLEEP, signal.SIGKILL, -signal.SIGKILL),
        (TICK, signal.SIGKILL, -signal.SIGKILL),
    ],
)
def test_who_ends_wsgen_ends_the_build(
    work: str, number: signal.Signals, returncode: int, tmp_path: Path
) -> None:
    """Only the process of wsgen gets the signal, as from a supervisor."""
    pid_file = tmp_path / "pid"
    work = work.format(pid_file=pid_file)
    write_package(tmp_path, cmake=CMAKE.replace("ament_package()", f"{work}ament_package()"))
    script = BUILD_SCRIPT.format(root=str(tmp_path))
    with subprocess.Popen([sys.executable, "-c", script]) as process:
        wait_for(lambda: pid_file.exists() and bool(pid_file.read_text().strip()))
        process.send_signal(number)
        assert process.wait(300) == returncode
    worker = int(pid_file.read_text())
    wait_for(lambda: not is_alive(worker))


def wait_for(condition: Callable[[], bool], seconds: float = 300.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.02)


def is_alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().split(")")[1].split()[0] != "Z"
    except OSError:
        return False
