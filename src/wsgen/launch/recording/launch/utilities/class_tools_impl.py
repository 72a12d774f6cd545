"""Questions about classes."""

from __future__ import annotations

import inspect
from typing import Any


def isclassinstance(obj: Any) -> bool:
    """Whether it is an instance and no class."""
    return not inspect.isclass(obj)


def is_a(obj: Any, entity_type: type) -> bool:
    """Whether it is an instance of the type."""
    return isinstance(obj, entity_type)


def is_a_subclass(obj: Any, entity_type: type) -> bool:
    """Whether it is an instance or a subclass of the type."""
    return isinstance(obj, entity_type) or (inspect.isclass(obj) and issubclass(obj, entity_type))
