"""The page of `wsgen validate --html` in a real browser: what is seen, and what it answers to.

The page is that of `page_workspace.py`, made once.
"""

from __future__ import annotations

import importlib.util
import json
import subprocess
import sys
import time
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from PIL import Image, ImageChops

from chromium import Chromium, Page, needs_chromium, open_chromium
from reporting.page_workspace import write_workspace, wsgen

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

needs_plotly = pytest.mark.skipif(
    importlib.util.find_spec("plotly") is None, reason="plotly is missing"
)
pytestmark = [pytest.mark.slow, needs_chromium, needs_plotly]

# plotly.js reads pixels of its 3D views; the browser would rather have been told before.
KNOWN = "warning: Canvas2D: Multiple readback operations"
LEVELS = ("wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice")


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("page")
    names = write_workspace(root)
    options = ("--engine", "all", "-j", "2", "--html", "report.html", "--json", "report.json")
    run = wsgen(root, "validate", *options, *names)
    assert run.returncode == 1, run.stderr
    assert "Traceback" not in run.stderr
    return root


@pytest.fixture(scope="module")
def chromium() -> Iterator[Chromium]:
    with open_chromium() as browser:
        yield browser


@pytest.fixture
def page(workspace: Path, chromium: Chromium) -> Iterator[Page]:
    """The page, just opened; after the test the console must not have an error."""
    page = chromium.open((workspace / "report.html").as_uri())
    yield page
    assert [line for line in page.console if not line.startswith(KNOWN)] == []
    assert {url.partition(":")[0] for url in page.requests} <= {"file", "data", "blob"}
    page.close()


def see_plots(page: Page, number: int) -> None:
    """Scroll to the plots of a robot and wait until they are drawn."""
    motion = f"document.querySelectorAll('.motion')[{number}]"
    page.evaluate(f"{motion}.scrollIntoView({{behavior: 'instant'}})")
    page.wait_for(
        f"[...{motion}.querySelectorAll('figure:not([hidden]) .plot')]"
        ".every((plot) => plot.dataset.drawn)"
    )


def open_everything(page: Page) -> None:
    page.evaluate(
        "document.querySelectorAll('details').forEach((one) => { one.open = true; });"
        "document.querySelectorAll('.package').forEach("
        "(one) => { one.style.contentVisibility = 'visible'; })"
    )


def test_it_starts_no_library_before_a_plot_is_seen(page: Page, workspace: Path) -> None:
    assert page.evaluate("window.Plotly === undefined")
    assert (workspace / "report.html").stat().st_size < 3_000_000
    see_plots(page, 0)
    assert page.evaluate("window.Plotly !== undefined")


def test_every_package_has_its_result(page: Page, workspace: Path) -> None:
    document = json.loads((workspace / "report.json").read_text())
    rows = page.evaluate(
        "[...document.querySelectorAll('#overview ~ .scroll tbody tr')]"
        ".map((row) => row.cells[1].textContent.trim())"
    )
    expected = ["passed" if package["passed"] else "failed" for package in document["packages"]]
    assert rows == expected == ["passed", "failed", "failed", "passed", "passed", "failed"]
    assert not any(package["picture"] for package in document["packages"])  # none was asked for
    assert page.evaluate("document.querySelectorAll('.package').length") == len(rows)
    assert "messages: spawns no robot" in page.evaluate("document.body.innerText")


def test_hostile_texts_are_texts(page: Page) -> None:
    text = page.evaluate("document.body.textContent")
    assert "</script><script>alert(1)</script>" in text
    assert "caf\ufffd <b>.urdf" in text
    assert page.evaluate("document.querySelectorAll('img[src=x], b').length") == 0
    assert page.evaluate("document.scripts.length") == page.evaluate(
        "document.querySelectorAll('script[id^=data-]').length + 2"
    )


def test_it_is_accessible(page: Page) -> None:
    """By the rules of WCAG 2.2 AA that axe-core checks: contrast, names, roles, headings, …"""
    spec = importlib.util.find_spec("axe_playwright_python")
    if spec is None or spec.origin is None:
        pytest.skip("axe-core is missing")
    page.evaluate(Path(spec.origin).with_name("axe.min.js").read_text() + ";0")
    # Another one of the same kind takes as long.
    page.evaluate(
        "document.querySelectorAll('#package-1, #package-4, #package-5')"
        ".forEach((one) => one.remove())"
    )
    open_everything(page)
    see_plots(page, 0)
    assert _violations(page, *LEVELS) == []
    page.prefer(is_dark=True)
    assert _violations(page, "cat.color") == []
    page.click(".rule")  # the documentation of a rule
    assert page.evaluate("document.querySelectorAll(':popover-open').length") == 1
    assert _violations(page, *LEVELS) == []


def _violations(page: Page, *tags: str) -> list[Any]:
    """What axe-core reports; plots are each one image to it."""
    found: list[Any] = page.evaluate(
        "axe.run({include: document, exclude: [['.plot > *']]}, {runOnly: "
        + json.dumps(tags)
        + "})"
        ".then((found) => found.violations.map("
        "(one) => [one.id, one.nodes.map((node) => node.html.slice(0, 200))]))"
    )
    return found


def test_whatever_can_be_used_has_a_name(page: Page) -> None:
    open_everything(page)
    nodes = page.accessible()
    usable = {"button", "link", "checkbox", "combobox", "region", "table", "image", "heading"}
    roles = {role for role, _ in nodes}
    assert {"main", "banner", "contentinfo", "region", "button", "image"} <= roles
    assert [role for role, name in nodes if role in usable - {"table"} and not name.strip()] == []


def test_nothing_is_wider_than_the_window(page: Page) -> None:
    open_everything(page)
    see_plots(page, 0)
    for width in (1280, 400, 320):
        page.resize(width, 800)
        page.wait_for("document.documentElement.scrollWidth <= window.innerWidth")
        wide = page.evaluate(
            "[...document.querySelectorAll('body, main *')].filter("
            "(one) => !one.closest('.scroll, .plot, pre')"
            f" && one.getBoundingClientRect().right > {width + 1}).map((one) => one.outerHTML)"
        )
        assert wide == []
        # Nor is a column of a table cut: a table that does not fit is a list.
        page.wait_for(
            "[...document.querySelectorAll('.scroll')]"
            ".every((one) => one.scrollWidth <= one.clientWidth)"
        )
        stacked = page.evaluate(
            "document.querySelectorAll('.scroll:not(details *) .stacked').length"
        )
        assert (stacked > 0) == (width < 1280)


def test_a_table_is_sorted_by_keyboard(page: Page) -> None:
    selector = "#overview ~ .scroll th:nth-child(4)"
    page.evaluate(f"document.querySelector('{selector} button').focus()")
    orders = []
    for _ in range(2):
        page.press("Enter")
        cells = "[...document.querySelectorAll('#overview ~ .scroll td:nth-child(4)')]"
        values = page.evaluate(f"{cells}.map((cell) => cell.dataset.value)")
        orders.append((page.evaluate(f"document.querySelector('{selector}').ariaSort"), values))
    (up, rising), (down, falling) = orders
    assert (up, down) == ("ascending", "descending")
    numbers = [float(value) for value in rising if value]
    assert numbers == sorted(numbers)
    assert [float(value) for value in falling if value] == numbers[::-1]


def test_only_what_failed_is_shown(page: Page) -> None:
    page.click("#only-failed")
    shown = "[...document.querySelectorAll('#overview ~ .scroll tbody tr')]"
    assert page.evaluate(f"{shown}.filter((row) => row.checkVisibility()).length") == 3


def test_plots_of_all_engines_and_behaviors(page: Page) -> None:
    see_plots(page, 0)
    names = "document.querySelector('.speed .plot').data.map((one) => one.name)"
    assert page.evaluate(names) == ["PyBullet", "MuJoCo", "DART"]
    highest = "Math.max(...document.querySelector('.speed .plot').data[0].y)"
    standing = page.evaluate(highest)
    page.evaluate(
        "(() => { const select = document.querySelector('select'); select.value = 1;"
        "select.dispatchEvent(new Event('change')); })()"
    )
    page.wait_for("document.querySelector('.path .plot').dataset.drawn")
    assert page.evaluate(highest) == pytest.approx(0.5, abs=0.05)  # it drives at 0.5 m/s
    assert standing < 0.4
    traces = page.evaluate(
        "document.querySelector('.path .plot').data.map(({name, x, y}) => ({name, x, y}))"
    )
    area, path, start, end = traces[:4]
    way = path["x"]
    assert way[-1] - way[0] == pytest.approx(1.0, abs=0.1)
    assert (start["name"], start["x"]) == ("start", way[:1])
    assert (end["name"], end["x"]) == ("end", way[-1:])
    assert area["name"] == "has to end here"
    assert min(area["x"]) < way[-1] < max(area["x"])


def test_a_3d_view_is_turned(page: Page, tmp_path: Path) -> None:
    page.click(".turn")
    page.wait_for("Boolean(document.querySelector('.scene').layout)")
    page.wait_for("document.querySelector('.status').hidden")
    camera = "JSON.stringify(document.querySelector('.scene').layout.scene.camera.eye)"
    pictures, eyes = [], []
    box = page.evaluate(
        "(() => { const box = document.querySelector('.frame').getBoundingClientRect();"
        "return [box.x, box.y, box.width, box.height]; })()"
    )
    middle = (box[0] + box[2] / 2, box[1] + box[3] / 2)
    steps: list[Callable[[], None]] = [
        lambda: None,
        lambda: page.drag(middle, (middle[0] + 150, middle[1])),
        lambda: page.click("[data-side=top]"),
        lambda: page.click("[data-turn='1']"),
    ]
    for number, step in enumerate(steps):
        step()
        time.sleep(1.0)  # a frame without a graphics card
        file = tmp_path / f"{number}.png"
        page.screenshot(file)
        with Image.open(file) as image:
            x, y, width, height = map(int, box)
            pictures.append(image.convert("RGB").crop((x, y, x + width, y + height)))
        eyes.append(page.evaluate(camera))
    assert len(set(eyes)) == len(steps)
    for before, after in pairwise(pictures):
        assert ImageChops.difference(before, after).getbbox() is not None
    # It is in the color of the rover, not empty.
    colors = pictures[0].getcolors(1 << 24) or []
    orange = sum(count for count, (r, g, b) in colors if r > 150 and 60 < g < 160 and b < 80)
    assert orange > 2000
    page.click(".turn")  # the picture again
    assert page.evaluate("document.querySelector('.scene').hidden")


def test_dark_is_dark(page: Page, tmp_path: Path) -> None:
    brightness = []
    for is_dark in (False, True):
        page.prefer(is_dark=is_dark)
        page.screenshot(tmp_path / "page.png")
        with Image.open(tmp_path / "page.png") as image:
            brightness.append(image.convert("L").resize((1, 1)).getpixel((0, 0)))
    light, dark = brightness
    assert light > 180
    assert dark < 70


def test_what_is_printed_has_the_rules(page: Page) -> None:
    hidden = "document.querySelector('.popover').checkVisibility()"
    assert not page.evaluate(hidden)
    page.prefer(is_dark=False, media="print")
    assert page.evaluate(hidden)


def test_an_interrupted_run_writes_a_whole_page_or_none(tmp_path: Path, chromium: Chromium) -> None:
    (tmp_path / "r.urdf").write_text(
        '<robot name="r"><link name="a"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" '
        'ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial><collision><geometry><sphere '
        'radius="0.1"/></geometry></collision></link></robot>'
    )
    (tmp_path / "endless.xacro").write_text(
        '<robot name="e" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        '<link name="${sum(range(10**12))}"/></robot>'
    )
    command = ("-m", "wsgen", "validate", "-v", "r.urdf", "endless.xacro", "--html", "r.html")
    with subprocess.Popen(
        [sys.executable, *command], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        while "endless expand" not in process.stderr.readline():
            pass
        process.send_signal(2)
        process.communicate()
    assert process.returncode == 130
    page = chromium.open((tmp_path / "r.html").as_uri())
    assert "Interrupted." in page.evaluate("document.body.innerText")
    assert page.evaluate("document.querySelectorAll('.package').length") == 1
    assert page.evaluate("document.querySelector('footer') !== null")
    assert page.console == []
    assert sorted(file.name for file in tmp_path.iterdir()) == ["endless.xacro", "r.html", "r.urdf"]
