"""Names and namespaces of nodes."""

from __future__ import annotations

import re

from wsgen.launch.record import RECORD


class InvalidNameError(ValueError):
    """A name that ROS does not allow."""


def join_namespaces(base: str | None, namespace: str | None) -> str | None:
    """A namespace seen from another one; an absolute one stays as it is, None means none."""
    if namespace is None:
        joined = base
    elif base is None or namespace.startswith("/"):
        joined = namespace
    elif namespace:
        joined = f"{base.rstrip('/')}/{namespace}"
    else:
        joined = base
    if joined is None:
        return None
    joined = "/" + joined.lstrip("/")
    return joined.rstrip("/") or "/"


def validate_name(name: str) -> None:
    """Refuse what is no name of a node."""
    if RECORD.is_unknown(name):
        return
    if re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", name, re.ASCII) is None:
        raise InvalidNameError(
            f"Invalid node name: '{name}' must consist of letters, digits and underscores, and "
            "not start with a digit"
        )


def validate_namespace(namespace: str) -> None:
    """Refuse what is no absolute namespace."""
    if RECORD.is_unknown(namespace):
        return
    pattern = r"/|(/[A-Za-z_][A-Za-z0-9_]*)+"
    if re.fullmatch(pattern, namespace, re.ASCII) is None:
        raise InvalidNameError(
            f"Invalid namespace: the parts of '{namespace}' must consist of letters, digits and "
            "underscores, and not start with a digit"
        )
