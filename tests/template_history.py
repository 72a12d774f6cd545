"""Keep the states of the templates: what `--regenerate` writes before any test runs."""

import hashlib
import io
import subprocess
import zipfile
from collections.abc import Mapping
from pathlib import Path

from wsgen.templating.history import (
    ARCHIVE,
    FACTS_FILE,
    FILES_FOLDER,
    STATES_FOLDER,
    facts_now,
)
from wsgen.templating.sources import templates_folder
from wsgen.templating.states import FACTS, STATES_FILE

ROOT = Path(__file__).parents[1]
# Not in a package that is made of a template, or of none that can be updated.
LEFT_OUT = ("workspace", "added", "existing")
SUFFIXES = (".j2", ".toml")
LETTERS = 8  # of the checksum of a state
EPOCH = (1980, 1, 1, 0, 0, 0)


def folders_now() -> dict[str, dict[str, bytes]]:
    """Each folder of templates: its files by their paths."""
    folders: dict[str, dict[str, bytes]] = {FACTS: {FACTS_FILE: facts_now().encode()}}
    root = templates_folder()
    for file in sorted(root.rglob("*")):
        name, _, path = file.relative_to(root).as_posix().partition("/")
        if file.suffix in SUFFIXES and name not in LEFT_OUT:
            folders.setdefault(name, {})[path] = file.read_bytes()
    return folders


def listing(files: Mapping[str, bytes]) -> str:
    """The list of a state: a checksum and a path in each line."""
    return "".join(
        f"{hashlib.sha256(data).hexdigest()[:16]} {path}\n" for path, data in sorted(files.items())
    )


def state(name: str, files: Mapping[str, bytes]) -> str:
    return f"{name}-{hashlib.sha256(listing(files).encode()).hexdigest()[:LETTERS]}"


def add_states(archive: bytes, folders: Mapping[str, Mapping[str, bytes]]) -> bytes:
    """The archive with the states of folders; what it has already stays as it is."""
    stream = io.BytesIO(archive)
    with zipfile.ZipFile(stream, "a", zipfile.ZIP_DEFLATED, compresslevel=9) as target:
        for name, files in sorted(folders.items()):
            known = set(target.namelist())
            entries = {
                f"{FILES_FOLDER}{line.split()[0]}": files[line.split(" ", 1)[1]]
                for line in listing(files).splitlines()
            }
            entries[f"{STATES_FOLDER}{state(name, files)}"] = listing(files).encode()
            for entry, data in entries.items():
                if entry not in known:
                    target.writestr(zipfile.ZipInfo(entry, EPOCH), data, zipfile.ZIP_DEFLATED, 9)
    return stream.getvalue()


def keep_states() -> None:
    """Write the archive of the last commit with the states of now, and the list of these.

    The archive of the last commit has no states of templates that were only tried.
    """
    path = ARCHIVE.relative_to(ROOT).as_posix()
    kept = subprocess.run(
        ["git", "-C", ROOT, "show", f"HEAD:{path}"], capture_output=True, check=False
    )
    folders = folders_now()
    ARCHIVE.write_bytes(add_states(kept.stdout if kept.returncode == 0 else b"", folders))
    names = sorted(state(name, files) for name, files in folders.items())
    STATES_FILE.write_text("".join(f"{name}\n" for name in names), encoding="utf-8")
