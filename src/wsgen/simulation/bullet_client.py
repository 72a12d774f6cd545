"""PyBullet's functions, bound to one world; no other module imports PyBullet."""

from __future__ import annotations

import weakref
from functools import partial
from typing import TYPE_CHECKING, Any

import pybullet

if TYPE_CHECKING:
    from collections.abc import Callable


error: type[Exception] = pybullet.error


class Client:
    """A world in PyBullet without a window.

    An attribute is PyBullet's function of that name for this world, or its constant.
    """

    def __init__(self) -> None:
        self.number: int = pybullet.connect(pybullet.DIRECT)
        # A world that has been drawn holds 100 MB.
        self._disconnect = weakref.finalize(self, pybullet.disconnect, physicsClientId=self.number)
        self._disconnect.atexit = False

    def __getattr__(self, name: str) -> Any:
        found = getattr(pybullet, name)
        if callable(found):
            found = partial(found, physicsClientId=self.number)
        setattr(self, name, found)  # the next time it is there at once
        return found

    @staticmethod
    def calculate(name: str) -> Callable[..., Any]:
        """A function of PyBullet that has nothing to do with a world."""
        function: Callable[..., Any] = getattr(pybullet, name)
        return function

    def close(self) -> None:
        """Give the world back, now instead of with the last reference; may be called again."""
        self._disconnect()
