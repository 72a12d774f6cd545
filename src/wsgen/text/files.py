"""Files of a user: refuse to read what is not a regular file, and write files atomically.

Reading a device may never end, and opening a named pipe waits for a writer.
"""

from __future__ import annotations

import _thread
import codecs
import errno
import math
import os
import stat
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

from wsgen.errors import NotReadableError

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator
    from typing import TypeVar

    State = tuple[int, ...]
    Made = TypeVar("Made")

KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a named pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
# Longer marks first: that of UTF-32 begins with that of UTF-16.
MARKS = {
    codecs.BOM_UTF32_LE: "UTF-32",
    codecs.BOM_UTF32_BE: "UTF-32",
    codecs.BOM_UTF16_LE: "UTF-16",
    codecs.BOM_UTF16_BE: "UTF-16",
}

UNFINISHED_PREFIX = ".wsgen-file-"
OPEN_FILES = "/proc/self/fd"  # on Linux
# /dev/stdout may lead to a regular file that others write to; /dev/shm is a folder as any other.
STREAMS = ("/dev/std", "/dev/fd/", "/proc/")

FULL = frozenset({errno.ENOSPC, errno.EDQUOT})
FULL_BELOW = 16384  # bytes that may be free after a program removed its unfinished file


class _Memory:
    """What files held and where paths led, see `remembering`."""

    def __init__(self) -> None:
        self.contents: dict[str, tuple[State, bytes]] = {}  # the oldest first
        self.lock = _thread.allocate_lock()  # of the contents and their size
        self.size = 0  # bytes of the contents
        self.real: dict[str, str] = {}
        self.made: dict[tuple[object, str], tuple[tuple[State | None, ...], Any]] = {}

    def keep(self, path: str, state: State, content: bytes) -> None:
        """Remember the content of a file, if it is small."""
        if len(content) > MOST_REMEMBERED // 4:
            return
        with self.lock:
            _, before = self.contents.pop(path, (state, b""))
            self.contents[path] = state, content
            self.size += len(content) - len(before)
            while self.size > MOST_REMEMBERED or len(self.contents) > MOST_CONTENTS:
                _, oldest = self.contents.pop(next(iter(self.contents)))
                self.size -= len(oldest)


# The texts of a package are read several times, but those of one package after the other: more
# would only grow with the number of packages.
MOST_REMEMBERED = 2**19  # bytes
MOST_CONTENTS = 200  # files
MOST_PATHS = 1_000
_memory: _Memory | None = None


@contextmanager
def remembering() -> Iterator[None]:
    """Remember what is read inside, as long as the files stay as they are.

    Meanwhile, links are taken to lead where they have led. Threads share what is remembered.
    """
    global _memory  # noqa: PLW0603  who reads files is everywhere
    before, _memory = _memory, _memory or _Memory()
    try:
        yield
    finally:
        _memory = before


def forget_remembered() -> None:
    """Remember nothing any more, in a process that was forked from one that did."""
    global _memory  # noqa: PLW0603  same
    _memory = None


def remembered(make: Callable[[Path], Made], path: Path, *files: Path) -> Made:
    """What a function makes of a path; once where that is remembered, while the files are the same.

    The function returns what nobody changes.
    """
    memory = _memory
    if memory is None:
        return make(path)
    key, states = (make, str(path)), tuple(map(_state_of, files))
    known = memory.made.get(key)
    if known is None or known[0] != states:
        if len(memory.made) >= MOST_PATHS:
            memory.made.clear()
        known = memory.made[key] = (states, make(path))
    made: Made = known[1]
    return made


def _state_of(path: str | Path) -> State | None:
    try:
        return _state(os.stat(path))  # noqa: PTH116  may be a str
    except (OSError, ValueError):
        return None


def _state(found: os.stat_result) -> State:
    """What differs between two states of a file."""
    return (
        found.st_dev,
        found.st_ino,
        found.st_size,
        found.st_mtime_ns,
        found.st_ctime_ns,
    )


def real_path(path: str | Path) -> str:
    """The path without links, as `os.path.realpath` returns it."""
    memory, text = _memory, os.fspath(path)
    if memory is None:
        return os.path.realpath(text)
    real = memory.real.get(text)
    if real is None:
        if len(memory.real) >= MOST_PATHS:
            memory.real.clear()
        real = memory.real[text] = _find_real_path(text)
    return real


def _find_real_path(path: str) -> str:
    folder, name = os.path.split(path)
    if os.name != "posix" or name in {"", ".", ".."} or not folder.startswith("/"):
        return os.path.realpath(path)
    inside = os.path.join(real_path(folder), name)  # noqa: PTH118  of many
    return os.path.realpath(inside) if os.path.islink(inside) else inside  # noqa: PTH114


def list_files(
    folder: Path, endings: tuple[str, ...], *, markers: Collection[str] = ()
) -> list[Path]:
    """The files below a folder whose names end like this, by path; not those of linked folders.

    A folder in it that has one of the `markers`, files or folders, is left out.
    """
    found: list[Path] = []
    for place, folders, names in os.walk(folder):
        if markers and place != str(folder) and not set(markers).isdisjoint((*folders, *names)):
            folders.clear()
            continue
        found += [
            file
            for name in names
            if os.path.normcase(name).endswith(endings) and (file := Path(place, name)).is_file()
        ]
    return sorted(found)


def irregular_kind(path: str | Path) -> str | None:
    """Say what is at a path instead of a regular file; None for a regular file or nothing.

    Links are followed, and named.
    """
    try:
        mode = os.stat(path).st_mode  # noqa: PTH116  may be a str
    except (OSError, ValueError):  # ValueError: a null byte in the name
        return _dead_link(path)
    return _irregular_kind(path, mode)


def _irregular_kind(path: str | Path, mode: int) -> str | None:
    kind = KINDS.get(stat.S_IFMT(mode))
    if kind is None or not os.path.islink(path):  # noqa: PTH114
        return kind
    return f"a link to {kind} ({os.path.realpath(path)})"


def _dead_link(path: str | Path) -> str | None:
    try:
        return f"a link to {os.readlink(path)}, which does not exist"  # noqa: PTH115
    except (OSError, ValueError):
        return None


def after_scheme(path: str) -> str:
    """Return the path that follows `file://`: on Windows it has a slash before its drive."""
    return path[1:] if os.name == "nt" and path[:1] == "/" and path[2:3] == ":" else path


def refuse_irregular(path: str | Path) -> None:
    """Raise OSError for anything that is not a regular file; `strerror` says what it is."""
    kind = irregular_kind(path)
    if kind is not None:
        raise OSError(errno.EINVAL, f"it is {kind}", str(path))


def read_regular(path: Path, limit: int) -> bytes:
    """Read a regular file, at most one byte more than `limit`.

    Raises:
        OSError: It is not a regular file, or cannot be read.
        ValueError: A file cannot have this name.
    """
    memory = _memory
    if memory is None:
        refuse_irregular(path)
        with path.open("rb") as stream:
            return stream.read(limit + 1)
    text = str(path)
    try:
        found = os.stat(text)  # noqa: PTH116  of many
    except (OSError, ValueError):
        refuse_irregular(path)
        raise
    state, known = _state(found), memory.contents.get(text)
    if known is not None and known[0] == state:
        return known[1][: limit + 1]
    if _irregular_kind(text, found.st_mode) is not None:
        refuse_irregular(path)
    with open(text, "rb") as stream:  # noqa: PTH123
        content = stream.read(limit + 1)
    if len(content) <= limit:
        memory.keep(text, state, content)
    return content


LARGEST_TEXT = 2**26  # bytes; logs of large builds have less


def read_whole(path: Path, limit: int = LARGEST_TEXT) -> bytes:
    """Read a regular file.

    Raises:
        OSError: It is not a regular file, is larger than `limit` bytes, or cannot be read.
        ValueError: A file cannot have this name.
    """
    data = read_regular(path, limit)
    if len(data) > limit:
        raise OSError(errno.EFBIG, "it is too large", str(path))
    return data


def read_regular_text(path: Path, limit: int = LARGEST_TEXT, *, errors: str = "strict") -> str:
    """Read a regular file in UTF-8; `errors` is that of `bytes.decode`.

    Raises:
        OSError: It is not a regular file, is larger than `limit` bytes, or cannot be read.
        ValueError: It is not UTF-8, or a file cannot have this name.
    """
    return read_whole(path, limit).decode("utf-8", errors).replace("\r\n", "\n")


def bytes_or_empty(path: Path, limit: int) -> bytes:
    """Read a byte more than the limit at most, as `read_regular`; none if it cannot be read."""
    try:
        return read_regular(path, limit)
    except (OSError, ValueError):  # a name with a null byte
        return b""


def read_or_empty(path: Path) -> str:
    """Read the text; empty if the file cannot be read."""
    try:
        return read_regular_text(path, errors="replace")
    except OSError:
        return ""


def wide_encoding(data: bytes) -> str | None:
    """Detect UTF-16 or UTF-32; None for other encodings."""
    marked = next((name for mark, name in MARKS.items() if data.startswith(mark)), None)
    # XML begins with `<`, which UTF-16 without a mark writes with a null byte beside it.
    return marked or ("UTF-16" if data[:2] in {b"<\0", b"\0<"} else None)


def save_as_utf8(encoding: str) -> str:
    """Return the hint to convert a text from another encoding to UTF-8."""
    return (
        "Save it as UTF-8: choose that encoding in the editor, or run "
        f"`iconv -f {encoding} -t UTF-8 FILE > NEW`."
    )


def write_file(file: Path, content: str | bytes) -> None:
    """Write text, as UTF-8, or bytes atomically: a reader sees the old file or the new one.

    The content goes into a hidden file next to it, which then replaces it by one rename. A link
    stays a link, and an existing file keeps its mode. Devices, named pipes and writable files in a
    read-only folder are written directly.

    Raises:
        NotReadableError: it cannot be written; the old file is unchanged.
    """
    data = content.encode() if isinstance(content, str) else content
    try:
        if str(file.absolute()).startswith(STREAMS) or (file.exists() and not file.is_file()):
            file.write_bytes(data)
        else:
            try:
                _replace(Path(os.path.realpath(file)), data)
            except PermissionError:  # of the folder; the file itself may be writable
                if not file.is_file():
                    raise
                file.write_bytes(data)
    except OSError as error:
        raise explain_write_error(error, file) from error


def append_text(file: Path, text: str) -> None:
    """Append text, as UTF-8, to a file, which is made if it does not exist.

    Raises:
        NotReadableError: it cannot be written.
    """
    try:
        with file.open("a", encoding="utf-8") as stream:
            stream.write(text)
    except OSError as error:
        raise explain_write_error(error, file) from error


def _replace(file: Path, data: bytes) -> None:
    with replace_file(file) as stream:
        stream.write(data)


@contextmanager
def replace_file(file: Path) -> Iterator[BinaryIO]:
    """Open a hidden file next to `file`, which replaces it by one rename at the end of the block.

    If the block raises, the old file is unchanged and the new one is removed. Where the file system
    has files without a name, this one gets its name at the end: a process that is killed leaves
    nothing.

    Raises:
        OSError: it cannot be written.
    """
    unfinished = file.with_name(f"{UNFINISHED_PREFIX}{os.getpid()}-{os.urandom(4).hex()}")
    # Not `tempfile`, whose files only the user may read: this one gets the mode of any new file.
    descriptor = _open_without_name(file.parent)
    is_named = descriptor is None
    if descriptor is None:
        descriptor = os.open(unfinished, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
    try:
        with os.fdopen(descriptor, "wb") as stream:
            yield stream
            stream.flush()
            os.fsync(descriptor)  # some disks report only now that they are full
            if not is_named:
                # With a folder, which an absolute path does not need, Python follows the link.
                os.link(f"{OPEN_FILES}/{descriptor}", unfinished, src_dir_fd=descriptor)
        with suppress(OSError):  # the file is new, or the file system has no modes
            unfinished.chmod(stat.S_IMODE(file.stat().st_mode))
        unfinished.replace(file)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise


def _open_without_name(folder: Path) -> int | None:
    """Open a new file of a folder that has no name yet; None where that is impossible."""
    if not hasattr(os, "O_TMPFILE") or not Path(OPEN_FILES).is_dir():
        return None
    try:
        return os.open(folder, os.O_WRONLY | os.O_TMPFILE, 0o666)
    except OSError:  # the other way says what is wrong with the folder
        return None


def explain_write_error(
    error: OSError, path: Path, *, what: str = "", instead: str = ""
) -> NotReadableError:
    """Explain why `path` cannot be written, and what to do.

    `what` names what is written if it is not a file that could be written elsewhere; `instead` says
    how to have it elsewhere all the same.
    """
    number = error.errno or 0
    place = mount_point(path)
    reasons = {
        errno.ENOSPC: (f"the disk is full ({place})", f"Free some space on {place}"),
        errno.EDQUOT: (
            f"the disk quota is used up ({place})",
            f"Delete some of your files on {place}",
        ),
        errno.EROFS: (f"the file system is read-only ({place})", ""),
        errno.EFBIG: ("the file is larger than the limit", "Raise the limit (ulimit -f)"),
        errno.ENOENT: ("the folder does not exist", "Create the folder"),
    }
    reason, remedy = reasons.get(number, ((error.strerror or str(error)).lower(), ""))
    other = instead if what else "choose a folder that exists and that you may write to"
    hint = ", or ".join(filter(None, (remedy, other))) or f"Check who may write to {path}"
    return NotReadableError(
        f"Cannot write {what or path}: {reason}.", hint=f"{hint[0].upper()}{hint[1:]}."
    )


def explain_disk_error(error: OSError) -> NotReadableError | None:
    """Explain that a disk is full or read-only, as it may be behind standard output; else None."""
    if error.errno in {*FULL, errno.EROFS} and isinstance(error.filename, str):
        return explain_write_error(error, Path(error.filename))
    if error.errno in FULL:
        return NotReadableError(
            f"Cannot write the output or a temporary file: {error.strerror}.",
            hint="Free some space, or use a folder on another disk: TMPDIR=DIR wsgen ...",
        )
    if "No usable temporary directory" in str(error):  # raised by Python if all are full
        return NotReadableError(
            "No temporary folder is usable: each is full or not writable.",
            hint="Free some space in /tmp, or use another folder: TMPDIR=DIR wsgen ...",
        )
    return None


def mount_point(path: Path) -> Path:
    """Return the folder at which the file system of a path is mounted."""
    real = Path(os.path.realpath(path))
    return next(folder for folder in (real, *real.parents) if os.path.ismount(folder))


def find_full_disk(output: str, *folders: Path) -> OSError | None:
    """Find the message of a full disk in the output of a program that wrote below the folders.

    Returns:
        The error, with the folder with the least space as its file name; None if none was printed.
    """
    for number in sorted(FULL):
        if os.strerror(number) in output:  # as Python and C programs print it
            return OSError(number, os.strerror(number), str(min(folders, key=_free_bytes)))
    return None


def full_folder(*folders: Path) -> OSError | None:
    """Find a folder on a full disk, for programs that do not report it."""
    for folder in folders:
        if _free_bytes(folder) < FULL_BELOW:
            return OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(folder))
    return None


def _free_bytes(folder: Path) -> float:
    """Return the free bytes for this user; infinite if unknown or on a read-only file system."""
    if not hasattr(os, "statvfs"):  # on Windows
        return math.inf
    try:
        system = os.statvfs(folder)
    except OSError:
        return math.inf
    if system.f_flag & os.ST_RDONLY:
        return math.inf
    if system.f_files and not system.f_favail:
        return 0  # not even an empty file fits
    return system.f_bavail * system.f_frsize
