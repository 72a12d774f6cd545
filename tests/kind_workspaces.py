"""Copies of the workspaces below `tests/workspaces`, and what wsgen makes of them."""

from __future__ import annotations

import json
import os
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from forks import run_wsgen

WORKSPACES = Path(__file__).parent / "workspaces"
LIMIT = 300.0  # seconds for one command, also on a busy machine


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What a command printed, and its exit code."""

    code: int
    output: str
    errors: str

    @property
    def document(self) -> dict[str, Any]:
        """The JSON on standard output."""
        document: dict[str, Any] = json.loads(self.output)
        return document


@dataclass(frozen=True, kw_only=True)
class KindOfWorkspace:
    """A copy of one of the workspaces, in a folder of the test."""

    root: Path

    def wsgen(
        self, *arguments: str, given: str | None = None, folder: Path | None = None
    ) -> Answer:
        """Run wsgen in the workspace, or in a folder of it; `given` is its standard input."""
        environment = {
            name: value
            for name, value in os.environ.items()
            if not name.startswith(("AMENT_", "COLCON_", "ROS_"))
        }
        done = run_wsgen(
            arguments, cwd=folder or self.root, env=environment, input=given, timeout=LIMIT
        )
        assert "Traceback" not in done.stderr, done.stderr
        return Answer(code=done.returncode, output=done.stdout, errors=done.stderr)


def copy_workspace(kind: str, folder: Path) -> KindOfWorkspace:
    """Copy a workspace of `tests/workspaces` into a folder that does not exist or is empty."""
    root = folder / kind
    shutil.copytree(WORKSPACES / kind, root, symlinks=True)
    return KindOfWorkspace(root=root)
