"""The page in a real browser: a slider moves a link, layers, a change of a file, a simulation."""

from __future__ import annotations

import io
import json
import math
import os
import threading
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from chromium import needs_chromium, open_chromium
from reporting.viewing.robots import ARM, write_crane
from wsgen.pipeline.describe import describe
from wsgen.pipeline.requests import ValidateRequest
from wsgen.reporting.viewing import view as module
from wsgen.reporting.viewing.view import View, choose_port

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from chromium import Chromium, Page

pytestmark = [pytest.mark.slow, needs_chromium]
pytest.importorskip("viser")

WIDTH, HEIGHT = 680, 280  # small: each pixel is drawn by a processor
CANVAS = 280  # pixels; to the right of them is the panel
LEAST_PIXELS = 150
SECONDS = 300.0  # without a graphics card, on a busy machine


@pytest.fixture(scope="module")
def chromium() -> Iterator[Chromium]:
    with open_chromium() as browser:
        yield browser


@contextmanager
def showing(file: Path) -> Iterator[tuple[View, Any]]:
    """The robot of a file on a page."""
    from wsgen.reporting.viewing.page import JointPage  # noqa: PLC0415  it may not be installed

    request = ValidateRequest(files=(file,), engines=(), is_viewed=True)
    view = View(lambda folder: describe(None, request, folder, environment=os.environ))
    view.open()
    page = JointPage(host="127.0.0.1", port=choose_port("127.0.0.1", None), title="crane")
    try:
        view.show(page)
        yield view, page
    finally:
        page.stop()
        view.close()


def open_page(chromium: Chromium, port: int, element: str) -> Page:
    """Open the page and wait for an element of the panel."""
    url = f"http://127.0.0.1:{port}"
    tab = chromium.open(url, width=WIDTH, height=HEIGHT, draws_seldom=True)
    tab.wait_for(f"!!document.querySelector({json.dumps(element)})", SECONDS)
    # The notice that no graphics card draws is in front of the scene.
    tab.evaluate("document.querySelectorAll('.mantine-Notification-root').forEach(n => n.remove())")
    return tab


def wait_for(condition: Callable[[], Any]) -> Any:
    end = time.monotonic() + SECONDS
    while not (value := condition()):
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.1)
    return value


def pixels(tab: Page, folder: Path) -> np.ndarray[Any, np.dtype[np.int64]]:
    """The part of a screenshot with the scene: height by width by red, green and blue."""
    file = folder / "shot.png"
    tab.screenshot(file)
    image = Image.open(io.BytesIO(file.read_bytes())).convert("RGB")
    return np.asarray(image, dtype=np.int64)[:, :CANVAS]


def middle(tab: Page, folder: Path, color: str) -> tuple[float, float] | None:
    """Where what has this color is in the scene: row and column; None where nothing has it."""
    red, green, blue = pixels(tab, folder).transpose(2, 0, 1)
    is_it = {
        "red": (red > 90) & (red > 3 * green) & (red > 3 * blue),
        "blue": (blue > 90) & (blue > 3 * red) & (blue > 2 * green),
        "orange": (red - blue > 60) & (green > 0.4 * red) & (green < 0.85 * red),
    }[color]
    if is_it.sum() < LEAST_PIXELS:
        return None
    rows, columns = np.nonzero(is_it)
    return float(rows.mean()), float(columns.mean())


def press_on_slider(tab: Page, key: str, times: int) -> None:
    tab.evaluate("document.querySelector('[role=slider]').focus()")
    for _ in range(times):
        tab.press(key)


def click(tab: Page, selector: str, text: str) -> None:
    """Click with the mouse on what says this; on what a label stands for."""
    script = f"""(() => {{
        let one = [...document.querySelectorAll({json.dumps(selector)})]
            .find(one => one.textContent.trim() === {json.dumps(text)});
        if (one && one.htmlFor) one = document.getElementById(one.htmlFor);
        if (!one) return null;
        one.scrollIntoView({{block: "center", behavior: "instant"}});
        const box = one.getBoundingClientRect();
        return box.width ? [box.x + box.width / 2, box.y + box.height / 2] : null;
    }})()"""
    x, y = tab.wait_for(script)
    tab.drag((x, y), (x, y))


def orientation_of_arm(page: Any) -> list[float]:
    """What the server has sent for the link."""
    values: list[float] = page._robots[0]._frames[1].wxyz.tolist()
    return values


def test_a_slider_moves_a_link(chromium: Chromium, tmp_path: Path) -> None:
    with showing(write_crane(tmp_path / "crane")) as (_, page):
        tab = open_page(chromium, page.port, "[role=slider]")
        before = wait_for(lambda: middle(tab, tmp_path, "red"))
        assert orientation_of_arm(page) == pytest.approx([1, 0, 0, 0])
        assert tab.evaluate("document.body.textContent").count("swing, °") == 1

        press_on_slider(tab, "Home", 1)  # to its lower limit
        wait_for(lambda: orientation_of_arm(page)[3] < -0.5)
        assert orientation_of_arm(page) == pytest.approx([math.cos(1), 0, 0, -math.sin(1)])
        press_on_slider(tab, "ArrowRight", 2)
        # The limit of 2 rad is at 114.6 degrees on the slider, rounded outwards.
        wait_for(lambda: page.positions()["crane", "swing"] == pytest.approx(math.radians(-114.4)))
        half = math.radians(-114.4 / 2)
        wait_for(
            lambda: (
                orientation_of_arm(page) == pytest.approx([math.cos(half), 0, 0, math.sin(half)])
            )
        )

        # The arm was on one side of the post, and is on the other one.
        columns = wait_for(lambda: _other_side(before, middle(tab, tmp_path, "red")))
        assert columns

        click(tab, "button", "Zero")
        wait_for(lambda: orientation_of_arm(page) == pytest.approx([1, 0, 0, 0]))
        unexpected = [line for line in tab.console if "THREE.Clock" not in line]
        assert unexpected == []
        strangers = [
            url for url in tab.requests if not url.startswith(("http://127", "blob:", "data:"))
        ]
        assert strangers == []  # it works without a network
        tab.close()


def _other_side(before: tuple[float, float], now: tuple[float, float] | None) -> bool:
    return now is not None and abs(now[1] - before[1]) > 40


def test_layers_and_changes_of_files_are_shown(
    chromium: Chromium, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "LOOK_EVERY", 0.05)
    file = write_crane(tmp_path / "crane")
    over = threading.Event()
    with showing(file) as (view, page):
        tab = open_page(chromium, page.port, "[role=slider]")
        follower = threading.Thread(
            target=lambda: view.follow(page, on_change=lambda *_: None, is_over=over.is_set)
        )
        follower.start()
        try:
            wait_for(lambda: middle(tab, tmp_path, "red"))
            assert middle(tab, tmp_path, "orange") is None
            press_on_slider(tab, "ArrowRight", 3)
            position = pytest.approx(math.radians(0.3))
            wait_for(lambda: page.positions()["crane", "swing"] == position)
            click(tab, "[role=tab]", "Layers")
            click(tab, "label", "Collisions")
            wait_for(lambda: middle(tab, tmp_path, "orange"))
            click(tab, "label", "Collisions")

            parts = file.parent / "parts.xacro"
            parts.write_text(parts.read_text().replace("1 0 0 1", "0 0 1 1"))
            wait_for(lambda: middle(tab, tmp_path, "blue"))
            assert page.positions()["crane", "swing"] == position

            file.write_text(ARM.replace("</link>", "", 1))
            tab.wait_for("document.body.textContent.includes('shown as it was before')", SECONDS)
            click(tab, "[role=tab]", "Diagnostics")
            tab.wait_for("document.body.textContent.includes('xacro-file-fails')")
            wait_for(lambda: middle(tab, tmp_path, "blue"))  # a page draws seldom here
        finally:
            over.set()
            follower.join()
        tab.close()


def test_a_simulation_is_paused_stepped_and_pushed(chromium: Chromium, tmp_path: Path) -> None:
    from reporting.viewing.test_play import BOX, FOUND  # noqa: PLC0415
    from wsgen.model.transform import Pose  # noqa: PLC0415
    from wsgen.reporting.viewing.play import Player  # noqa: PLC0415
    from wsgen.reporting.viewing.simulation_page import SimulationPage  # noqa: PLC0415
    from wsgen.simulation.scene import Scene, SpawnedRobot  # noqa: PLC0415
    from wsgen.simulation.session import Session  # noqa: PLC0415

    assert FOUND.world is not None
    robots = (SpawnedRobot(entity="box", robot=BOX, pose_in_world=Pose((0.0, 0.0, 0.5))),)
    scene = Scene(world=FOUND.world, robots=robots)
    page = SimulationPage(host="127.0.0.1", port=choose_port("127.0.0.1", None), title="box")
    over = threading.Event()
    sessions: list[Session] = []

    def start() -> Session:
        sessions.append(Session(scene, remembered=0))
        return sessions[-1]

    try:
        player = Player(FOUND, start, page)
        runner = threading.Thread(target=lambda: player.run(is_over=over.is_set))
        runner.start()
        try:
            (session,) = sessions
            tab = open_page(chromium, page.port, "button")
            tab.wait_for("document.body.textContent.includes('× real time')", SECONDS)
            click(tab, "button", "Pause")
            tab.wait_for("document.body.textContent.includes(', paused')")
            before = session.seconds
            assert before > 0
            click(tab, "button", "Step")
            wait_for(lambda: session.seconds == pytest.approx(before + 0.01, abs=0.005))
            x = session.states["box"].pose_in_world.xyz[0]
            assert page._push is not None
            page._push._force.value = 50.0
            click(tab, "button", "Push")
            click(tab, "button", "Run")
            wait_for(lambda: session.states["box"].pose_in_world.xyz[0] > x + 0.001)
            click(tab, "button", "Pause")
            tab.wait_for("document.body.textContent.includes(', paused')")
            click(tab, "button", "Reset")
            wait_for(lambda: session.seconds < before)
            tab.close()
        finally:
            over.set()
            runner.join()
            player.close()
    finally:
        page.stop()
