"""The class of an interface by its name (ros2/rosidl_runtime_py, utilities.py)."""

from __future__ import annotations

import importlib
from typing import Any

KINDS = ("msg", "srv", "action")
OF_FEEDBACK = "_FeedbackMessage"  # on the topic `_action/feedback`; the package does not export it


def get_interface(identifier: str) -> Any:
    """The class of `package/msg/Name`; a message where the kind is left out.

    Raises:
        ValueError: It is no name of an interface.
        ModuleNotFoundError: The package is not there.
        AttributeError: The package has no such interface.
    """
    parts = identifier.split("/")
    if len(parts) == 2:  # noqa: PLR2004  package/Name
        parts.insert(1, "msg")
    if len(parts) < 3 or not all(parts):  # noqa: PLR2004
        raise ValueError(f"The passed type '{identifier}' is invalid")
    module, name = importlib.import_module(".".join(parts[:-1])), parts[-1]
    if parts[-2] == "action" and name.endswith(OF_FEEDBACK) and not hasattr(module, name):
        return getattr(module, name.removesuffix(OF_FEEDBACK)).Impl.FeedbackMessage
    return getattr(module, name)


def get_message(identifier: str) -> Any:
    """The class of a message; what `get_interface` raises, and ValueError for another kind."""
    return _of_kind(identifier, "msg", "message")


def get_service(identifier: str) -> Any:
    """The class of a service."""
    return _of_kind(identifier, "srv", "service")


def get_action(identifier: str) -> Any:
    """The class of an action."""
    return _of_kind(identifier, "action", "action")


def is_message(interface: Any) -> bool:
    """Whether it is the class of a message."""
    return hasattr(interface, "get_fields_and_field_types")


def is_service(interface: Any) -> bool:
    """Whether it is the class of a service."""
    return hasattr(interface, "Request") and hasattr(interface, "Response")


def is_action(interface: Any) -> bool:
    """Whether it is the class of an action."""
    return all(hasattr(interface, name) for name in ("Goal", "Result", "Feedback"))


def _of_kind(identifier: str, kind: str, word: str) -> Any:
    parts = identifier.split("/")
    if len(parts) == 2:  # noqa: PLR2004
        parts.insert(1, kind)
    found = get_interface("/".join(parts))
    if kind not in parts[1:-1]:
        raise ValueError(f"Expected the full name of a {word}, got '{identifier}'")
    return found
