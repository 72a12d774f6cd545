"""Open a page in the user's browser, where there is one."""

from __future__ import annotations

from wsgen.cli.terminal import echo


def announce(host: str, port: int, *, opens: bool, quiet: bool) -> None:
    """Print the address of a page; open it in a browser if `opens` and somebody would see it."""
    url = url_of(host, port)
    echo(url)
    is_seen = opens and _has_desktop() and _open(url)
    if not quiet:
        what = "" if is_seen else "Open this address in a browser. "
        echo(f"{what}Press Ctrl-C to end.", err=True)


def url_of(host: str, port: int) -> str:
    """The address of a page that is served on this machine."""
    name = {"0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(host)  # noqa: S104  an address to open
    return f"http://{name or (f'[{host}]' if ':' in host else host)}:{port}"


def _has_desktop() -> bool:
    """Whether a browser would have a window: not in CI, and not on a machine without a display."""
    import os
    import sys

    if os.environ.get("CI"):
        return False
    if sys.platform.startswith("linux"):
        return bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))
    return True


def _open(url: str) -> bool:
    import webbrowser

    try:
        return webbrowser.open(url)
    except webbrowser.Error:
        return False
