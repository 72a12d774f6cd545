"""A package that `wsgen new` wrote, built, and what `wsgen validate` says of it."""

import json
import subprocess
from pathlib import Path
from typing import Any

from forks import run_wsgen

PACKAGE = "gazebo_test"
SHARE = Path("install", PACKAGE, "share", PACKAGE)


def wsgen(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    run = run_wsgen(arguments, cwd=folder)
    assert "Traceback" not in run.stderr, run.stderr
    return run


def validate(workspace: Path, *arguments: str) -> tuple[int, dict[str, Any], str]:
    run = wsgen(workspace, "validate", "--format", "json", *arguments)
    document = json.loads(run.stdout) if run.stdout else {}
    return run.returncode, document, run.stderr


def errors(document: dict[str, Any]) -> list[dict[str, Any]]:
    return [
        found
        for package in document["packages"]
        for found in package["diagnostics"]
        if found["severity"] == "error"
    ]
