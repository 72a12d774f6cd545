"""What `wsgen doctor` found, for programs; docs/doctor.md lists the keys."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wsgen.workspace.examination import Examination
    from wsgen.workspace.machine import Finding


def render_examination(examination: Examination) -> str:
    """One JSON document."""
    target = examination.target
    document = {
        "version": 1,
        "passed": examination.passed,
        "target": {
            "distro": target.distro,
            "simulator": target.simulator,
            "ubuntu": target.ubuntu,
            "end_of_life": target.end_of_life,
        },
        "notes": list(examination.notes),
        "wsgen": [_finding(found) for found in examination.own],
        "ros": [_finding(found) for found in examination.ros],
        "apt": examination.apt,
    }
    return json.dumps(document, indent=2) + "\n"


def _finding(found: Finding) -> dict[str, object]:
    return {
        "name": found.name,
        "met": found.is_met,
        "needed": found.is_needed,
        "text": found.text,
        "mend": found.mend or None,
    }
