"""Packages as `wsgen new` wrote them with past templates: some states of them.

`past_templates.zip` has them as `history.zip` has the states of later commits.
"""

import shutil
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from golden_support import MAINTAINER
from wsgen.cli import run
from wsgen.templating import history, sources, states
from wsgen.templating.sources import templates_folder

ARCHIVE = Path(__file__).with_name("past_templates.zip")
NOW = ""
# Date of the commit -> the states of the folders.
VERSIONS = {
    "2026-11-22": "arm-27e608e2 base-6a024c22 diff_drive-2c48d980 simple-ddbd575b",
    "2026-11-23": "arm-574ec4b6 base-9556d102 diff_drive-23e2bed2 simple-ddbd575b "
    "wanderer-5c04465d",
    "2026-11-26": "arm-5eae0731 base-9de13616 diff_drive-84d562c5 simple-ddbd575b "
    "wanderer-6a27ad91",
    NOW: "",
}


@contextmanager
def archive_with_past(scratch: Path) -> Iterator[None]:
    """Have the archive of states hold those of the past, too."""
    merged = scratch / "merged.zip"
    shutil.copyfile(history.ARCHIVE, merged)
    with zipfile.ZipFile(ARCHIVE) as past, zipfile.ZipFile(merged, "a") as target:
        for name in set(past.namelist()) - set(target.namelist()):
            target.writestr(name, past.read(name))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(history, "ARCHIVE", merged)
        yield


@contextmanager
def as_of(version: str, scratch: Path) -> Iterator[None]:
    """Have the templates of a version be those of wsgen, now."""
    if version == NOW:
        yield
        return
    root = scratch / f"wsgen-{version}"
    if not root.exists():
        history.unpack(VERSIONS[version], root / "_templates")
        (root / "states.txt").write_text("".join(f"{one}\n" for one in VERSIONS[version].split()))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sources, "_PACKAGE", root)
        patch.setattr(states, "STATES_FILE", root / "states.txt")
        patch.setenv("XDG_CACHE_HOME", str(root / "cache"))
        yield


def new_package(workspace: Path, *arguments: str, version: str = NOW, scratch: Path) -> Path:
    """Write the package my_robot with the templates of a version; returns its folder."""
    with as_of(version, scratch):
        words = ["new", "my_robot", "-w", str(workspace), "-q", *MAINTAINER, *arguments]
        assert run(words) == 0
        package = workspace / "src" / "my_robot"
        if version != NOW:  # they did not write it yet
            file = package / "wsgen.toml"
            before = "\n\n[target]"
            made = f'\nstate = "{VERSIONS[version]}"'
            file.write_text(file.read_text().replace(before, made + before))
    assert templates_folder().name == "templates"
    return package
