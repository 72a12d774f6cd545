"""The templates of wsgen as they once were: what `wsgen update` renders a package of then with.

A state is a version of one folder of templates, named by a checksum of its files: `arm-3f2a9c01`.
`wsgen.toml` names those that a package was made of. `history.zip` has them all, also those between
releases: of each state the list of its files (`states/arm-3f2a9c01`), and each file once, by its
checksum (`files/…`). `facts` is a folder, too: what templates may ask of targets.

`states.txt` has the states of now, so that `wsgen new` computes none. Both are written by
`.venv/bin/pytest --regenerate tests/templating/test_history.py`.
"""

from __future__ import annotations

import json
import zipfile
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, cast

from wsgen.errors import NotFoundError
from wsgen.model.target import TARGETS, Plugin
from wsgen.templating.states import FACTS

if TYPE_CHECKING:
    from collections.abc import Mapping

    from wsgen.model.target import Target


ARCHIVE = Path(__file__).with_name("history.zip")
STATES_FOLDER, FILES_FOLDER = "states/", "files/"
FACTS_FILE = "targets.json"
# Of a target; besides, templates use its names.
_PROPERTIES = (
    *("ros", "gazebo", "ubuntu", "end_of_life", "has_ended", "cmake_minimum", "sdf_version"),
    *("frame_tag", "programs", "plugins", "ros2_control_hardware"),
)


def facts_now() -> str:
    """What templates may ask of targets: what is kept of them, as JSON."""
    facts = {
        target.name: {name: getattr(target, name) for name in _PROPERTIES} for target in TARGETS
    }
    return json.dumps(facts, indent=1, sort_keys=True, default=dict) + "\n"


def unpack(state: str, folder: Path) -> None:
    """Write the templates of a state, and the facts, into a folder.

    Raises:
        NotFoundError: This wsgen does not have the state.
    """
    with zipfile.ZipFile(ARCHIVE) as archive:
        for one in state.split():
            try:
                listed = archive.read(f"{STATES_FOLDER}{one}").decode()
            except KeyError:
                raise NotFoundError(
                    f"This wsgen does not have the templates `{one}`, of which the package was "
                    "made.",
                    hint="Use the wsgen that made it, or a newer one: pip install --upgrade wsgen",
                ) from None
            for line in listed.splitlines():
                checksum, _, path = line.partition(" ")
                file = folder / one.rpartition("-")[0] / path
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(archive.read(f"{FILES_FOLDER}{checksum}"))


def past_target(target: Target, folder: Path) -> Target:
    """A target with what was known of it when the templates in a folder were those of wsgen."""
    file = folder / FACTS / FACTS_FILE
    if not file.is_file():
        return target
    facts: Mapping[str, dict[str, Any]] = json.loads(file.read_text(encoding="utf-8"))
    known = facts.get(target.name)
    if known is None:
        return target
    plugins = {role: Plugin(*names) for role, names in known.pop("plugins").items()}
    names = {name: getattr(target, name) for name in ("name", "distro", "simulator", "fact")}
    return cast("Target", SimpleNamespace(**names, plugins=plugins, **known))
