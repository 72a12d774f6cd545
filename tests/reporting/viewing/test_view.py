"""Robots that are read again when a file changes; errors keep what was shown."""

from __future__ import annotations

import os
import socket
import threading
import time
from typing import TYPE_CHECKING

import pytest

from reporting.viewing.robots import ARM, PARTS, FakeViewer, write_crane
from wsgen.errors import NotFoundError, RequestError, WsgenError
from wsgen.packages.workspace.layout import open_workspace
from wsgen.pipeline.describe import DescribedScene, describe
from wsgen.pipeline.requests import ValidateRequest
from wsgen.reporting.viewing import view as module
from wsgen.reporting.viewing.view import View, check_viewer, choose_port
from wsgen.text.files import write_file

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path


@pytest.fixture
def crane(tmp_path: Path) -> Path:
    return write_crane(tmp_path / "crane")


def view_of(file: Path) -> View:
    request = ValidateRequest(files=(file,), engines=(), is_viewed=True)
    return View(lambda folder: describe(None, request, folder, environment=os.environ))


@pytest.mark.slow
def test_the_robot_is_shown_as_written_with_all_frames(crane: Path) -> None:
    view, viewer = view_of(crane), FakeViewer()
    view.open()
    view.show(viewer)
    view.close()
    ((robot,),) = viewer.robots
    assert [link.name for link in robot.links] == ["post", "arm", "tip"]
    assert robot.entity == "crane"
    assert robot.low[2] == pytest.approx(0.0)
    assert "6 kg, 3 links, 1 movable joint" in viewer.summary
    assert "swing (revolute)" in viewer.links
    assert "reads-no-collision" not in viewer.diagnostics


@pytest.mark.slow
def test_a_change_of_an_included_file_shows_the_robot_again(
    crane: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "LOOK_EVERY", 0.05)
    monkeypatch.setattr(module, "QUIET_FOR", 0.05)
    view, viewer = view_of(crane), FakeViewer()
    seen: list[tuple[Sequence[str], DescribedScene | WsgenError]] = []
    view.open(viewer)
    with following(view, viewer, seen):
        write_file(crane.parent / "parts.xacro", PARTS.replace("1 0 0 1", "0 0 1 1"))
        wait_for(lambda: len(seen) == 1)
        assert seen[0][0] == [str(crane.parent / "parts.xacro")]
        assert [rgba_of_arm(robots) for robots in viewer.robots] == [(1, 0, 0, 1), (0, 0, 1, 1)]

        write_file(crane, ARM.replace("</robot>", ""))
        wait_for(lambda: len(seen) == 2)
        assert len(viewer.robots) == 2  # what was shown stays
        assert "shown as it was before" in viewer.summary.replace("\\", "")
        assert "xacro-file-fails" in viewer.diagnostics

        crane.unlink()
        wait_for(lambda: len(seen) == 3)
        assert isinstance(seen[2][1], NotFoundError)
        assert "does not exist" in viewer.diagnostics

        write_file(crane, ARM.replace('name="swing"', 'name="turn"'))
        wait_for(lambda: len(seen) == 4)
        ((robot,),) = viewer.robots[2:]
        assert [slider.joint for slider in robot.sliders] == ["turn"]
        assert "shown as it was before" not in viewer.summary
    view.close()


@pytest.mark.slow
def test_a_package_without_launch_file_shows_its_only_robot(crane: Path, tmp_path: Path) -> None:
    workspace = open_workspace(str(tmp_path))
    request = ValidateRequest(packages=("crane",), engines=(), is_viewed=True)
    found = describe(workspace, request, tmp_path, environment=os.environ)
    assert [robot.entity for robot in found.robots] == ["crane"]
    assert {file.name for file in found.files} >= {"crane.urdf.xacro", "parts.xacro"}

    crane.with_name("second.urdf").write_text(
        ARM.replace('name="crane"', 'name="second"').replace("xacro", "other")
    )
    with pytest.raises(RequestError, match="several robots") as caught:
        describe(workspace, request, tmp_path, environment=os.environ)
    assert str(crane) in caught.value.hint


def rgba_of_arm(robots: Sequence[object]) -> object:
    (robot,) = robots
    return robot.links[1].visuals[0].rgba  # type: ignore[attr-defined]


class following:  # noqa: N801  as a function
    """Follow the files in another thread while the block runs."""

    def __init__(
        self,
        view: View,
        viewer: FakeViewer,
        seen: list[tuple[Sequence[str], DescribedScene | WsgenError]],
    ) -> None:
        self._over = threading.Event()
        self._thread = threading.Thread(
            target=lambda: view.follow(
                viewer,
                on_change=lambda changed, found: seen.append((changed, found)),
                is_over=self._over.is_set,
            )
        )

    def __enter__(self) -> None:
        self._thread.start()

    def __exit__(self, *_error: object) -> None:
        self._over.set()
        self._thread.join()


def wait_for(condition: object, seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition():  # type: ignore[operator]
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.02)


@pytest.fixture
def taken() -> Iterator[int]:
    """A port that something else listens on."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server.getsockname()[1]


def test_a_port_that_is_taken_is_refused(taken: int) -> None:
    with pytest.raises(RequestError, match=rf"The port {taken} of 127\.0\.0\.1 is taken"):
        choose_port("127.0.0.1", taken)


def test_without_a_port_the_next_free_one_is_chosen(
    taken: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "DEFAULT_PORT", taken)
    assert taken < choose_port("127.0.0.1", None) < taken + 100


@pytest.mark.parametrize("host", ["192.0.2.1", "no such host.invalid"])
def test_an_address_of_another_machine_is_refused(host: str) -> None:
    with pytest.raises(RequestError, match=f"cannot listen on {host}") as caught:
        choose_port(host, None)
    assert "--host 127.0.0.1" in caught.value.hint


def test_without_the_library_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wsgen.reporting.viewing.LIBRARY", "no_such_library")
    with pytest.raises(NotFoundError) as caught:
        check_viewer()
    assert caught.value.hint == "Install it: pip install 'wsgen[view]'"
    assert caught.value.exit_code == 4
