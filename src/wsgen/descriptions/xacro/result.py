"""What the child process that expands a xacro file is asked, and what it answers.

It is separate from `expansion`, because the parent does not import xacro, and from `source`, which
packages need that have no xacro file to expand.
"""

from __future__ import annotations

from collections.abc import Mapping  # noqa: TC003  read at run time, as all types of the fields
from dataclasses import field

from wsgen.text.values import dataclass


@dataclass(frozen=True, kw_only=True)
class ExpansionRequest:
    """A file to expand."""

    file: str  # absolute
    arguments: Mapping[str, str]


@dataclass(frozen=True, kw_only=True)
class ExpansionError:
    """Why a file cannot be expanded."""

    message: str
    file: str | None = None  # that has to be changed; it may be an included one
    line: int | None = None  # 1-based
    element: str | None = None
    hint: str | None = None


@dataclass(frozen=True, kw_only=True)
class UnusedArgument:
    """An argument that is given and that no xacro file has."""

    name: str
    message: str
    hint: str


@dataclass(frozen=True, kw_only=True)
class Expansion:
    """What a file expands to."""

    urdf: str
    unused: tuple[UnusedArgument, ...] = ()
    arguments: Mapping[str, str] = field(default_factory=dict)  # that the files have: their values
