"""An archive of files and folders, for machines that share no disk with this one.

Below the folder where it is unpacked, everything is at the path that it has on this machine: of
`/home/me/ws/src` in `/scratch`, at `/scratch/home/me/ws/src`. Links stay links. What they lead to
is in the archive, too.
"""

from __future__ import annotations

import os
import pickle
import stat
import zlib
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import NotReadableError, RequestError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator


MOST_BYTES = 2**30  # of all files
MOST_FILES = 200_000
PART_BYTES = 4 * 2**20  # of files in a part, before it is compressed
LARGEST_FILE = 32 * 2**20  # bytes; a child of wsgen may write twice as much
FOLDER, FILE, LINK, PIPE = "folder", "file", "link", "pipe"
# Links to what is in these lead there on every machine.
OF_SYSTEM = ("/dev/", "/proc/", "/sys/")
MEMORY = "/dev/shm/"  # noqa: S108  has files as any other folder


class Entry(NamedTuple):
    """A file or folder, at its absolute path without links in front of its name."""

    path: str
    kind: str
    mode: int = 0o755
    content: bytes = b""  # of a link, what it says; of a file, appended to what is there


class Archive:
    """What is added, to be written as parts.

    Attributes:
        left_out: Real paths of what cannot be sent: large files, sockets, what may not be read.
    """

    def __init__(self) -> None:
        self.left_out: list[str] = []
        self._entries: dict[str, Entry] = {}  # without the content of files
        self._size = 0  # bytes
        self._sizes: dict[str, int] = {}  # of what was asked for
        self._added = ""  # what is being added
        self._targets: list[str] = []  # of links, to be added
        self._followed: set[str] = set()  # links with such a target

    def __contains__(self, path: str | Path) -> bool:
        """Whether there is something at a path, which may go through links."""
        return self._place(path) in self._entries

    def add(self, path: str | Path, *, skipped: Collection[str] = ()) -> None:
        """Add a file, or a folder with all that is in it but folders of these names.

        Raises:
            RequestError: It is too much to be sent.
        """
        waiting = [str(path)]
        while waiting:
            before, self._added = self._size, waiting.pop()
            self._add(self._added, skipped)
            self._sizes[self._added] = self._size - before
            waiting += self._targets
            self._targets.clear()

    def add_folder(self, path: str | Path) -> None:
        """Add a folder, if there is one, without what is in it; and what leads there."""
        self._add_way(os.path.join(os.path.abspath(path), "."))  # noqa: PTH100, PTH118

    def _place(self, path: str | Path) -> str:
        folder, name = os.path.split(os.path.abspath(path))  # noqa: PTH100  of many
        return os.path.join(os.path.realpath(folder), name)  # noqa: PTH118

    def _add(self, path: str, skipped: Collection[str]) -> None:
        place = self._place(path)
        # The links that the path goes through are in the archive as well.
        self._add_way(os.path.abspath(path))  # noqa: PTH100
        self._add_way(place)
        if not self._add_one(place):
            return
        for folder, names, files in os.walk(place):
            names[:] = sorted(name for name in names if name not in skipped)
            for name in (*names, *files):
                self._add_one(f"{folder.rstrip('/')}/{name}")

    def _add_way(self, path: str) -> None:
        """Add the folders above a path, and where one is a link, what it leads through."""
        current = "/"
        for name in path.split("/")[1:-1]:
            place = os.path.join(current, name)  # noqa: PTH118
            if os.path.islink(place):  # noqa: PTH114
                self._add_link(place, with_target=False)
                current = os.path.realpath(place)
                self._add_way(f"{current}/.")
            else:
                current = place
            if os.path.isdir(current):  # noqa: PTH112
                self._entries.setdefault(current, Entry(current, FOLDER))

    def _add_one(self, place: str) -> bool:
        """Add what is at a place; whether it is a folder, whose content is to be added."""
        known = self._entries.get(place)
        if known is not None and known.kind not in {FOLDER, LINK}:
            return False
        try:
            found = os.lstat(place)
        except OSError:
            return False
        mode = stat.S_IMODE(found.st_mode)
        if stat.S_ISLNK(found.st_mode):
            self._add_link(place)
        elif stat.S_ISDIR(found.st_mode):
            self._entries[place] = Entry(place, FOLDER)
            if not os.access(place, os.R_OK | os.X_OK):
                self.left_out.append(place)
            return True
        elif stat.S_ISREG(found.st_mode):
            if found.st_size > LARGEST_FILE or not os.access(place, os.R_OK):
                self.left_out.append(place)
            else:
                self._count(found.st_size)
                self._entries[place] = Entry(place, FILE, mode)
        elif stat.S_ISFIFO(found.st_mode):
            self._entries[place] = Entry(place, PIPE, mode)
        else:
            self.left_out.append(place)
        return False

    def _add_link(self, place: str, *, with_target: bool = True) -> None:
        target = os.path.realpath(place)
        is_of_system = _is_of_system(target)
        if with_target and not is_of_system and place not in self._followed:
            self._followed.add(place)
            self._targets.append(target)
        if place in self._entries:
            return
        self._entries[place] = Entry(place, LINK, content=os.fsencode(os.readlink(place)))  # noqa: PTH115
        if not is_of_system:
            said = _led_to(place)
            self._add_way(said)
            if os.path.islink(said):  # noqa: PTH114
                self._add_link(self._place(said), with_target=False)

    def _count(self, size: int) -> None:
        self._size += size
        if self._size > MOST_BYTES or len(self._entries) > MOST_FILES:
            sizes = {**self._sizes, self._added: self._size - sum(self._sizes.values())}
            largest = max(sizes, key=lambda path: sizes[path])
            raise RequestError(
                f"What is to be sent to the workers has more than {MOST_BYTES >> 20} MiB or "
                f"{MOST_FILES} files; most is in {largest}.",
                hint="Name the packages that are to be checked, move recordings and data out of "
                "them, or leave out --scheduler.",
            )

    def write(self, folder: Path, header: bytes) -> tuple[Path, ...]:
        """Write the parts, the first of them with a header, as files into a folder.

        Raises:
            NotReadableError: A file cannot be read any more.
        """
        files = []
        for number, part in enumerate((header, *self._parts())):
            files.append(folder / f"{number:05}.part")
            files[-1].write_bytes(zlib.compress(part, 1))
        return tuple(files)

    def _parts(self) -> Iterator[bytes]:
        part: list[Entry] = []
        size = 0
        for entry in self._pieces():
            part.append(entry)
            size += len(entry.content)
            if size >= PART_BYTES:
                yield pickle.dumps([tuple(one) for one in part])
                part, size = [], 0
        yield pickle.dumps([tuple(one) for one in part])

    def _pieces(self) -> Iterator[Entry]:
        """The entries by path, folders and links first; large files in pieces."""
        files = []
        # A link to a folder comes before what is written through it; the shorter path first.
        for entry in sorted(self._entries.values()):
            if entry.kind == FILE:
                files.append(entry)
            else:
                yield entry
        for entry in files:
            try:
                content = Path(entry.path).read_bytes()
            except OSError as error:
                raise NotReadableError(
                    f"Cannot read {entry.path}: {error.strerror}.",
                    hint="Check that it is still there, and try again.",
                ) from error
            for start in range(0, max(1, len(content)), PART_BYTES):
                yield entry._replace(content=content[start : start + PART_BYTES])


def _is_of_system(path: str) -> bool:
    return f"{path}/".startswith(OF_SYSTEM) and not path.startswith(MEMORY)


def _led_to(link: str) -> str:
    """What a link says, as an absolute path."""
    said = os.path.join(os.path.dirname(link), os.readlink(link))  # noqa: PTH115, PTH118, PTH120
    return os.path.normpath(said)


def read_header(part: Path) -> bytes:
    """The header of an archive, of its first part."""
    return zlib.decompress(part.read_bytes())


def unpack(parts: Iterable[Path], folder: Path, *, as_if_in: Path | None = None) -> None:
    """Unpack all parts into a folder that does not exist.

    Its links are right when it is renamed to `as_if_in`.

    Raises:
        OSError: The disk refuses them.
    """
    folder.mkdir(parents=True)
    root, final = str(folder), str(as_if_in or folder)
    for part in list(parts)[1:]:
        for path, kind, mode, content in pickle.loads(zlib.decompress(part.read_bytes())):  # noqa: S301  wsgen wrote it
            place = f"{root}{path}"
            if kind == FOLDER:
                os.makedirs(place, exist_ok=True)  # noqa: PTH103  of many
            elif kind == LINK:
                _make_link(place, path, os.fsdecode(content), final)
            elif kind == PIPE:
                os.mkfifo(place, mode)
            else:
                with open(place, "ab") as stream:  # noqa: PTH123
                    stream.write(content)
                os.chmod(place, mode | stat.S_IWUSR)  # noqa: PTH101


def _make_link(place: str, path: str, said: str, root: str) -> None:
    """Make a link that leads to the same as on the other machine, below the folder."""
    parent = os.path.dirname(path)  # noqa: PTH120
    meant = os.path.normpath(os.path.join(parent, said))  # noqa: PTH118
    steps = 0
    for name in said.split("/"):
        steps += {"": 0, ".": 0, "..": -1}.get(name, 1)
        if steps < -parent.count("/"):  # it ends at the root there, and would leave the folder here
            said = meant
    if said.startswith("/") and not _is_of_system(said):
        said = f"{root}{said}"
    with suppress(FileExistsError):
        os.symlink(said, place)  # noqa: PTH211


def at(folder: str | Path, path: str | Path) -> Path:
    """Where what has an absolute path is, if the archive is unpacked in a folder."""
    return Path(f"{folder}{path}")


def named_as_there(text: str, folder: str | Path) -> str:
    """A text with the paths of the other machine in place of those below the folder."""
    return text.replace(f"{folder}/", "/").replace(str(folder), "/")
