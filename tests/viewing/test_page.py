"""Who may open the page, and what it sends; without a browser."""

from __future__ import annotations

import os
import socket
from typing import TYPE_CHECKING, Any

import pytest

from wsgen.viewing.view import choose_port

if TYPE_CHECKING:
    from collections.abc import Iterator

pytestmark = pytest.mark.slow  # viser takes half a second to import
viser = pytest.importorskip("viser")
client = pytest.importorskip("websockets.sync.client")

HOST = "127.0.0.1"
NO_CHARACTER = os.fsdecode(b"\xff")


@pytest.fixture(scope="module")
def page() -> Iterator[Any]:
    from wsgen.viewing.page import JointPage  # noqa: PLC0415  viser may not be installed

    page = JointPage(host=HOST, port=choose_port(HOST, None), title=f"robot {NO_CHARACTER}")
    yield page
    page.stop()


def open_page(page: Any, origin: str | None = None) -> Any:
    """Connect as the script of the page does; `origin` is the site that it comes from."""
    protocol = f"viser-v{viser.__version__}"
    return client.connect(
        f"ws://{HOST}:{page.port}", origin=origin, subprotocols=[protocol], max_size=None
    )


@pytest.mark.parametrize("origin", [None, "http://localhost:8080", "http://127.0.0.1:8080"])
def test_names_of_files_may_have_any_bytes(page: Any, origin: str | None) -> None:
    page.report(summary=f"summary {NO_CHARACTER}", diagnostics=f"file {NO_CHARACTER}")
    page.show([], links=f"links {NO_CHARACTER}")
    with open_page(page, origin) as connection:
        received = b""
        while b"links" not in received:
            received += connection.recv(timeout=20)


@pytest.mark.parametrize("origin", ["https://example.org", "http://localhost.example.org", "null"])
def test_pages_of_other_sites_are_refused(page: Any, origin: str) -> None:
    from websockets.exceptions import InvalidStatus  # noqa: PLC0415  as above

    with pytest.raises(InvalidStatus, match="403"), open_page(page, origin):
        pass


def test_no_other_address_is_listened_on(page: Any) -> None:
    with socket.create_connection((HOST, page.port), timeout=5):
        pass
    with pytest.raises(OSError, match=r"refused|unreachable|timed out"):
        socket.create_connection(("127.0.0.2", page.port), timeout=5)
