"""The real Gazebo Classic on the PATH, as where it is installed: programs that enter its root."""

from __future__ import annotations

import shutil
from pathlib import Path

from classic.gazebo_classic import ROOT

# It sees the folders of this machine that tests and wsgen write to at their own paths.
ENTER = """#!/bin/sh
exec unshare --mount sh -c '
root=$1; program=$2; shift 2
mount --rbind /dev "$root/dev"
mount -t proc proc "$root/proc"
for folder in {folders}; do
  mkdir -p "$root$folder"
  mount --rbind "$folder" "$root$folder"
done
export PATH=/usr/sbin:/usr/bin:/sbin:/bin GAZEBO_MODEL_DATABASE_URI=
exec chroot "$root" "$program" "$@"
' sh "{root}" "$(basename "$0")" "$@"
"""


def put_on_path(folder: Path, *, more: tuple[Path, ...] = ()) -> Path:
    """Fill a folder as a prefix with `bin/gzserver`, `bin/gz` and Gazebo's models; its `bin`.

    Args:
        folder: That is filled.
        more: Folders that the server sees besides that for temporary files.
    """
    folders = " ".join(str(Path("/", *one.resolve().parts[1:2])) for one in (folder, *more))
    shutil.copytree(ROOT / "usr/share/gazebo-11/models", folder / "share/gazebo-11/models")
    programs = folder / "bin"
    programs.mkdir()
    for name in ("gzserver", "gz"):
        (programs / name).write_text(ENTER.format(root=ROOT, folders=folders), encoding="utf-8")
        (programs / name).chmod(0o755)
    return programs
