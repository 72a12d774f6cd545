"""Simulators and spawners are seen in command lines."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from kind_workspaces import copy_workspace

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.slow
def test_command_lines(tmp_path: Path) -> None:
    workspace = copy_workspace("shell_command", tmp_path)
    assert workspace.wsgen("build").code == 0
    for launch_file in ("classic.launch.py", "fortress.launch.py"):
        answer = workspace.wsgen(
            "validate", "shell_cart", "--launch", launch_file, "--format", "json"
        )
        assert answer.code == 0, answer.errors
        (package,) = answer.document["packages"]
        assert package["world"]["name"] == "lane"
        (robot,) = package["robots"]
        assert robot["entity"] == "cart"
        assert robot["rest"]
        assert not package["diagnostics"]
