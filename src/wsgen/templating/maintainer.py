"""Find the maintainer of a new package that the request does not name."""

from __future__ import annotations

import getpass
import re
import subprocess
from typing import TYPE_CHECKING

from wsgen.errors import RequestError
from wsgen.templating.spec import make_maintainer
from wsgen.templating.text import check_maintainer_email, check_maintainer_name

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from wsgen.model.package import Maintainer


# What `ros2 pkg create` writes for an unknown address.
UNKNOWN_DOMAIN = "todo.todo"
GIT_TIMEOUT = 5.0  # s; git answers in milliseconds unless its files lie on a dead network disk


def find_maintainer(name: str | None, email: str | None) -> Maintainer:
    """Return the given name and address, or else those of git, or else of the login.

    Values of git that package.xml cannot hold are ignored.

    Raises:
        RequestError: a given name or address is not valid in package.xml.
    """
    known = _ask_git()
    login = _login()
    if name is None:
        name = _usable(known.get("user.name"), check_maintainer_name) or login
    if email is None:
        email = _usable(known.get("user.email"), check_maintainer_email)
    return make_maintainer(name, email or f"{login}@{UNKNOWN_DOMAIN}")


def _usable(text: str | None, check: Callable[[str], str]) -> str | None:
    try:
        return None if text is None else check(text)
    except RequestError:
        return None


def _ask_git() -> Mapping[str, str]:
    """Read user.name and user.email with git itself, which knows its includes and scopes."""
    command = ("git", "config", "--null", "--get-regexp", r"^user\.(name|email)$")
    try:
        answer = subprocess.run(  # noqa: PLW1510  1 means that nothing is set
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=GIT_TIMEOUT
        )
    except (OSError, subprocess.SubprocessError):
        return {}
    records = answer.stdout.decode("utf-8", "replace").split("\0")
    # A key, a line end, the value; of several values the last one counts.
    return dict(record.split("\n", 1) for record in records if "\n" in record)


def _login() -> str:
    """Return the login's name, without characters that are invalid before the @ of an address."""
    try:
        name = getpass.getuser()
    except (ImportError, KeyError, OSError):  # a container that runs under a number
        name = ""
    return re.sub(r"[^A-Za-z0-9_-]", "", name) or "user"
