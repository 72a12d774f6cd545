"""Who may open the page, and what it sends; without a browser."""

from __future__ import annotations

import contextlib
import gc
import logging
import os
import socket
from typing import TYPE_CHECKING, Any

import pytest

from wsgen.reporting.viewing.view import choose_port

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.slow  # viser takes half a second to import
viser = pytest.importorskip("viser")
client = pytest.importorskip("websockets.sync.client")

HOST = "127.0.0.1"
SECONDS = 300.0  # wall-clock, on a busy machine
NO_CHARACTER = os.fsdecode(b"\xff")


@pytest.fixture(scope="module")
def page() -> Iterator[Any]:
    from wsgen.reporting.viewing.page import JointPage  # noqa: PLC0415  viser may not be installed

    page = JointPage(host=HOST, port=choose_port(HOST, None), title=f"robot {NO_CHARACTER}")
    yield page
    page.stop()


def open_page(page: Any, origin: str | None = None) -> Any:
    """Connect as the script of the page does; `origin` is the site that it comes from."""
    protocol = f"viser-v{viser.__version__}"
    return client.connect(
        f"ws://{HOST}:{page.port}",
        origin=origin,
        subprotocols=[protocol],
        max_size=None,
        open_timeout=SECONDS,
        ping_interval=None,
    )


@pytest.mark.parametrize("origin", [None, "http://localhost:8080", "http://127.0.0.1:8080"])
def test_names_of_files_may_have_any_bytes(page: Any, origin: str | None) -> None:
    page.report(summary=f"summary {NO_CHARACTER}", diagnostics=f"file {NO_CHARACTER}")
    page.show([], links=f"links {NO_CHARACTER}")
    with open_page(page, origin) as connection:
        received = b""
        while b"links" not in received:
            received += connection.recv(timeout=SECONDS)


def test_what_is_no_message_of_the_page_prints_nothing(
    page: Any, capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    from websockets.exceptions import ConnectionClosed  # noqa: PLC0415  as above

    camera = b"\x82\xa4type\xb3ViewerCameraMessage\xa4wxyz\xa1x"
    unknown = b"\x83\xa4type\xb0GuiUpdateMessage\xa4uuid\xa1x\xa7updates\x07"
    for sent in ("text", b"", b"\xff\xff", b"\x81\xa4type\xa6NoSuch", camera, unknown):
        with contextlib.suppress(TimeoutError, ConnectionClosed), open_page(page) as connection:
            connection.send(sent)
            while True:
                connection.recv(timeout=0.5)
    with open_page(page) as connection:
        connection.recv(timeout=SECONDS)  # the page is still there
    with socket.create_connection((HOST, page.port)) as plain:
        plain.sendall(b"\0" * 300)
        plain.recv(1)
    gc.collect()  # asyncio reports what has failed when that is forgotten
    printed = capfd.readouterr()
    assert (printed.out, printed.err) == ("", "")
    assert [one.message for one in caplog.records if one.levelno >= logging.WARNING] == []


@pytest.mark.parametrize("origin", ["https://example.org", "http://localhost.example.org", "null"])
def test_pages_of_other_sites_are_refused(page: Any, origin: str) -> None:
    from websockets.exceptions import InvalidStatus  # noqa: PLC0415  as above

    with pytest.raises(InvalidStatus, match="403"), open_page(page, origin):
        pass


def test_no_other_address_is_listened_on(page: Any) -> None:
    with socket.create_connection((HOST, page.port), timeout=SECONDS) as connection:
        # A connection that the page has just taken when it stops is closed by nobody, and asyncio
        # warns of it when it is collected: during any other test.
        connection.shutdown(socket.SHUT_WR)
        with contextlib.suppress(ConnectionError):
            while connection.recv(1024):
                pass
    with pytest.raises(OSError, match=r"refused|unreachable|timed out"):
        socket.create_connection(("127.0.0.2", page.port), timeout=5)


def test_the_page_of_a_run_goes_along_with_the_robots() -> None:
    from reporting.viewing.test_live_run import WALL  # noqa: PLC0415
    from reporting.viewing.test_play import BOX  # noqa: PLC0415
    from wsgen.model.transform import Pose  # noqa: PLC0415
    from wsgen.reporting.viewing.drawing import draw_simulated  # noqa: PLC0415
    from wsgen.reporting.viewing.simulation_page import RunPage  # noqa: PLC0415

    page = RunPage(host=HOST, port=choose_port(HOST, None), title="run")
    try:
        wall = draw_simulated(WALL, Pose((5.0, 0.0, 0.5)), {}, entity="wall", is_static_model=True)
        box = draw_simulated(BOX, Pose((1.0, 1.0, 0.1)), {}, entity="box", is_static_model=False)
        page.show([wall], links="")
        node = page._robots[0]
        assert page._server.initial_camera.look_at == pytest.approx([5.0, 0.0, 0.5])
        page.show([box, wall], links="")
        assert page._robots[1] is node  # it has not been sent again
        assert page._server.initial_camera.look_at == pytest.approx([1.0, 1.0, 0.1])

        page.put({"box": {"base": Pose((1.0, 1.0, 0.1))}})
        assert page._origin.position == pytest.approx([0.0, 0.0, 0.0])
        page.put({"box": {"base": Pose((3.0, 0.0, 2.1))}})
        assert page._origin.position == pytest.approx([-2.0, 1.0, 0.0])
        page._follow.value = False
        page.put({"box": {"base": Pose((4.0, 0.0, 2.1))}})
        assert page._origin.position == pytest.approx([-2.0, 1.0, 0.0])
        assert page._moved() == pytest.approx([1.0, 0.0, 2.0])  # the button looks there

        page.show([], links="")
        page.put({})
        page.finish("**The run has ended**.")
        assert page._time.content == "**The run has ended**."
        assert page._run.disabled
        assert page._reset.disabled
    finally:
        page.stop()


def test_inputs_may_be_used_before_there_is_a_robot() -> None:
    from reporting.viewing.test_play import BOX  # noqa: PLC0415  as above
    from wsgen.model.transform import Pose  # noqa: PLC0415
    from wsgen.reporting.viewing.drawing import draw_simulated  # noqa: PLC0415
    from wsgen.reporting.viewing.simulation_page import RunPage  # noqa: PLC0415

    page: Any = RunPage(host=HOST, port=choose_port(HOST, None), title="run")
    try:
        page._grid_box.value = False
        page._show_grid()  # what a click calls
        page._look_from_here()
        box = draw_simulated(BOX, Pose(), {}, entity="box", is_static_model=False)
        page.show([box], links="")
        assert not page._grid.visible
        page._grid_box.value = True
        page._show_grid()
        assert page._grid.visible
    finally:
        page.stop()
