"""A real browser for tests: Debian's headless Chromium, over its DevTools protocol.

The protocol goes through two pipes, so that it takes no library, no port and no driver. Tests that
use it are skipped with a reason where no Chromium is installed:

    with open_chromium() as chromium:
        page = chromium.open(file.as_uri(), width=400, is_dark=True)
        assert page.evaluate("document.title") == "…"
        page.screenshot(tmp_path / "page.png")
        assert page.console == []
"""

from __future__ import annotations

import base64
import contextlib
import json
import os
import select
import shutil
import signal
import tempfile
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import pytest

from own_network import entering

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path


PROGRAMS = ("chromium", "chromium-browser", "google-chrome")
LONGEST = 300.0  # s, wall-clock, for one answer on a busy machine
OPTIONS = (
    "--headless=new",
    "--remote-debugging-pipe",
    "--no-sandbox",  # tests may run as root
    "--no-first-run",
    "--disable-extensions",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-dev-shm-usage",
    "--disable-sync",
    "--mute-audio",
    "--hide-scrollbars",
    "--force-device-scale-factor=1",
    # 3D without a graphics card.
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
# Pages that draw anew whatever changes take a core for each window without a graphics card.
FEW_FRAMES = """
{
  const draw = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (call) => setTimeout(() => draw(call), 150);
  window.cancelAnimationFrame = clearTimeout.bind(window);
}
"""


def find_chromium() -> str | None:
    """The program; None where it is not installed."""
    return next(filter(None, map(shutil.which, PROGRAMS)), None)


needs_chromium = pytest.mark.skipif(
    find_chromium() is None, reason="no Chromium: apt install chromium"
)


class ChromiumError(Exception):
    """The browser died, did not answer, or a script of the test raised an exception."""


@dataclass
class Chromium:
    """A browser that runs."""

    pid: int
    to_browser: int  # file descriptors
    from_browser: int
    _received: bytes = b""
    _number: int = 0
    _pages: dict[str, Page] = field(default_factory=dict)  # by session

    def open(  # the ways in which people look at a page
        self,
        url: str = "about:blank",
        *,
        width: int = 1280,
        height: int = 900,
        is_dark: bool = False,
        media: str = "",
        draws_seldom: bool = False,
    ) -> Page:
        """Open a page in a window of this size (CSS pixels) and wait until it is loaded.

        `media` is "print" for what would be printed. What `draws_seldom` gets few frames a second.
        """
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        page = Page(self, session, target)
        self._pages[session] = page
        for domain in ("Page", "Runtime", "Log", "Network"):
            page.call(f"{domain}.enable")
        page.resize(width, height)
        page.prefer(is_dark=is_dark, media=media)
        if draws_seldom:
            page.call("Page.addScriptToEvaluateOnNewDocument", source=FEW_FRAMES)
        if url != "about:blank":
            page.go(url)
        return page

    def call(self, method: str, session: str | None = None, /, **parameters: Any) -> dict[str, Any]:
        """One command of the protocol; gives its result."""
        self._number += 1
        message: dict[str, Any] = {"id": self._number, "method": method, "params": parameters}
        if session is not None:
            message["sessionId"] = session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.to_browser, data) :]
        until = time.monotonic() + LONGEST
        while True:
            answer = self.receive(until, method)
            if answer.get("id") == message["id"]:
                if "error" in answer:
                    raise ChromiumError(f"{method}: {answer['error']['message']}")
                result: dict[str, Any] = answer["result"]
                return result

    def receive(self, until: float, waits_for: str) -> dict[str, Any]:
        """The next message; events of pages are kept in their pages."""
        while b"\0" not in self._received:
            seconds = until - time.monotonic()
            ready, _, _ = select.select([self.from_browser], [], [], max(0.0, seconds))
            if not ready:
                raise ChromiumError(f"No answer within {LONGEST:g} s: {waits_for}")
            some = os.read(self.from_browser, 1 << 20)
            if not some:
                raise ChromiumError(f"The browser ended: {waits_for}")
            self._received += some
        first, _, self._received = self._received.partition(b"\0")
        message: dict[str, Any] = json.loads(first)
        page = self._pages.get(message.get("sessionId", ""))
        if page is not None and "method" in message:
            page.take(message["method"], message["params"])
        return message


class Page:
    """A tab."""

    def __init__(self, chromium: Chromium, session: str, target: str) -> None:
        self.chromium = chromium
        self.console: list[str] = []  # errors, warnings and exceptions, as the console shows them
        self.requests: list[str] = []  # URLs; of `data:` the first characters
        self._session = session
        self._target = target
        self._loaded = 0

    def take(self, method: str, event: dict[str, Any]) -> None:
        """Keep what an event says."""
        if method == "Page.loadEventFired":
            self._loaded += 1
        elif method == "Network.requestWillBeSent":
            self.requests.append(event["request"]["url"][:100])
        elif method == "Runtime.exceptionThrown":
            details = event["exceptionDetails"]
            thrown = details.get("exception", {}).get("description", "")
            self.console.append(f"exception: {details['text']} {thrown}".rstrip())
        elif method == "Log.entryAdded" and event["entry"]["level"] in {"error", "warning"}:
            self.console.append(f"{event['entry']['level']}: {event['entry']['text']}")
        elif method == "Runtime.consoleAPICalled" and event["type"] in {"error", "warning"}:
            texts = [str(one.get("value", one.get("description"))) for one in event["args"]]
            self.console.append(f"{event['type']}: {' '.join(texts)}")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """One command of the protocol for this page."""
        return self.chromium.call(method, self._session, **parameters)

    def go(self, url: str) -> None:
        """Open another URL and wait until it is loaded."""
        before = self._loaded
        answer = self.call("Page.navigate", url=url)
        if answer.get("errorText"):
            raise ChromiumError(f"{url}: {answer['errorText']}")
        until = time.monotonic() + LONGEST
        while self._loaded == before:
            self.chromium.receive(until, f"load {url}")

    def resize(self, width: int, height: int) -> None:
        """Change the size of the window, CSS pixels."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )

    def prefer(self, *, is_dark: bool, media: str = "") -> None:
        """Change what the user prefers: light or dark; look at it as when it is printed."""
        scheme = {"name": "prefers-color-scheme", "value": "dark" if is_dark else "light"}
        self.call("Emulation.setEmulatedMedia", media=media, features=[scheme])

    def evaluate(self, script: str) -> Any:
        """The value of a JavaScript expression; promises are awaited.

        Raises:
            ChromiumError: It throws.
        """
        answer = self.call(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            thrown = details.get("exception", {}).get("description", "")
            raise ChromiumError(f"{details['text']} {thrown}")
        return answer["result"].get("value")

    def wait_for(self, script: str, seconds: float = LONGEST) -> Any:
        """Wait until an expression is true, and give its value."""
        until = time.monotonic() + seconds
        while not (value := self.evaluate(script)):
            if time.monotonic() > until:
                raise ChromiumError(f"Not true within {seconds:g} s: {script}")
            time.sleep(0.05)
        return value

    def press(self, key: str, *, code: int = 0, text: str = "") -> None:
        """Press a key, as `Tab` or `Enter`, on what has the focus."""
        codes = {"Tab": 9, "Enter": 13, "Escape": 27, " ": 32, "ArrowLeft": 37, "ArrowRight": 39}
        texts = {"Enter": "\r", " ": " "}
        parameters = {"key": key, "windowsVirtualKeyCode": codes.get(key, code)}
        text = text or texts.get(key, "")
        down = {"type": "keyDown", "text": text} if text else {"type": "rawKeyDown"}
        self.call("Input.dispatchKeyEvent", **down, **parameters)
        self.call("Input.dispatchKeyEvent", type="keyUp", **parameters)

    def drag(self, start: tuple[float, float], end: tuple[float, float]) -> None:
        """Drag the mouse from one point of the window to another one, CSS pixels."""
        (x, y), (to_x, to_y) = start, end
        middle = ((x + to_x) / 2, (y + to_y) / 2)
        self._mouse("mouseMoved", start, button="none")
        self._mouse("mousePressed", start)
        for point in (middle, end):
            self._mouse("mouseMoved", point)
        self._mouse("mouseReleased", end)

    def click(self, selector: str) -> None:
        """Click the middle of the first element that a CSS selector finds."""
        point = self.evaluate(
            f"(() => {{ const one = document.querySelector({json.dumps(selector)});"
            "one.scrollIntoView({block: 'center', behavior: 'instant'});"
            "const box = one.getBoundingClientRect();"
            "return [box.x + box.width / 2, box.y + box.height / 2]; })()"
        )
        self._mouse("mousePressed", tuple(point))
        self._mouse("mouseReleased", tuple(point))

    def _mouse(self, kind: str, point: tuple[float, float], *, button: str = "left") -> None:
        x, y = point
        buttons = 1 if button == "left" and kind != "mouseReleased" else 0
        self.call(
            "Input.dispatchMouseEvent",
            type=kind,
            x=x,
            y=y,
            button=button,
            buttons=buttons,
            clickCount=1 if kind != "mouseMoved" else 0,
        )

    def screenshot(self, file: Path, *, is_whole: bool = False) -> None:
        """Write a PNG of the window, or of the whole page."""
        picture = self.call("Page.captureScreenshot", captureBeyondViewport=is_whole)["data"]
        if is_whole:
            size = self.call("Page.getLayoutMetrics")["cssContentSize"]
            picture = self.call(
                "Page.captureScreenshot", captureBeyondViewport=True, clip={**size, "scale": 1}
            )["data"]
        file.write_bytes(base64.b64decode(picture))

    def accessible(self) -> list[tuple[str, str]]:
        """What a screen reader finds: role and name of each node, in order."""
        self.call("Accessibility.enable")
        nodes = self.call("Accessibility.getFullAXTree")["nodes"]
        return [
            (node["role"]["value"], node.get("name", {}).get("value", ""))
            for node in nodes
            if not node.get("ignored") and "role" in node
        ]

    def close(self) -> None:
        """Close the tab."""
        self.chromium.call("Target.closeTarget", targetId=self._target)


@contextlib.contextmanager
def open_chromium(*options: str) -> Iterator[Chromium]:
    """A browser with a profile of its own; all of its processes end with the block."""
    program = find_chromium()
    if program is None:
        pytest.skip("no Chromium: apt install chromium")
    with tempfile.TemporaryDirectory(prefix="chromium-", ignore_cleanup_errors=True) as profile:
        theirs_in, to_browser = os.pipe()
        from_browser, theirs_out = os.pipe()
        # The numbers 3 and 4 are those of the protocol; none of ours may be in their way.
        ends = [_above(end, 10) for end in (theirs_in, theirs_out)]
        null = os.open(os.devnull, os.O_RDWR)
        actions: list[Any] = [
            (os.POSIX_SPAWN_DUP2, null, 0),
            (os.POSIX_SPAWN_DUP2, null, 1),
            (os.POSIX_SPAWN_DUP2, null, 2),
            (os.POSIX_SPAWN_DUP2, ends[0], 3),
            (os.POSIX_SPAWN_DUP2, ends[1], 4),
        ]
        words = (f"--user-data-dir={profile}", *OPTIONS, *options, "about:blank")
        arguments = entering([program, *words])
        environment = {**os.environ, "HOME": profile, "DBUS_SESSION_BUS_ADDRESS": "disabled:"}
        pid = os.posix_spawn(
            arguments[0], arguments, environment, file_actions=actions, setpgroup=0
        )
        for end in (*ends, null):
            os.close(end)
        chromium = Chromium(pid, to_browser, from_browser)
        try:
            chromium.call("Browser.getVersion")
            yield chromium
        finally:
            _end(chromium)


def _above(descriptor: int, number: int) -> int:
    import fcntl  # noqa: PLC0415  not on Windows

    copy = fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, number)
    os.close(descriptor)
    return copy


def _end(chromium: Chromium) -> None:
    with contextlib.suppress(ChromiumError, OSError):
        chromium.call("Browser.close")
    os.close(chromium.to_browser)
    os.close(chromium.from_browser)
    if not _within(5.0, lambda: os.waitpid(chromium.pid, os.WNOHANG)[0] != 0):
        with contextlib.suppress(ProcessLookupError):
            os.killpg(chromium.pid, signal.SIGKILL)
        os.waitpid(chromium.pid, 0)


def _within(seconds: float, is_so: Callable[[], bool]) -> bool:
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        if is_so():
            return True
        time.sleep(0.02)
    return False
