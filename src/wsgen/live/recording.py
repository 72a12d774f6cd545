"""Record a live run: its topics as MCAP while it goes on, a video of its robots afterwards."""

from __future__ import annotations

import contextlib
import json
import os
import select
import signal
import subprocess
from importlib.util import find_spec
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import NotFoundError, RequestError, SessionDiedError
from wsgen.isolation import parent
from wsgen.rendering.drawing import require_encoder, why_no_video
from wsgen.ros.environment.processes import module_command
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from pathlib import Path


MODULE = "wsgen.live.nodes.recorder"
READY = b"\n"  # what it writes when it records
READ = 1 << 16  # bytes at once
SECONDS_TO_START = 120.0  # wall-clock, on a busy machine
SECONDS_TO_FINISH = 60.0  # wall-clock, for the index at the end of a file that is interrupted


@dataclass(frozen=True, kw_only=True)
class Recordings:
    """The files that are made of a live run."""

    mcap: Path | None = None
    video: Path | None = None

    @property
    def files(self) -> tuple[Path, ...]:
        """All of them."""
        return tuple(file for file in (self.mcap, self.video) if file is not None)


class Recorded(NamedTuple):
    """A file that a live run has left, or would have left if a message had come."""

    file: Path
    seconds: float  # simulated, where something was
    messages: int | None = None  # None: of a video. 0: no file was written
    lost: Mapping[str, int] = MappingProxyType({})  # messages that it lacks, by topic


def choose_recordings(files: Sequence[Path]) -> Recordings:
    """What the files are for, by their endings; cheap, and asked before the run.

    Raises:
        RequestError: A file cannot be written, or nobody knows its ending, or two are of one kind.
        NotFoundError: A library for it is not installed.
    """
    mcap = [file for file in files if file.suffix.lower() == ".mcap"]
    videos = [file for file in files if file not in mcap]
    for one in (mcap, videos):
        if len(one) > 1:
            raise RequestError(
                f"{one[0]} and {one[1]} would be the same recording twice.",
                hint="Name one .mcap file for the topics, and one .gif or .mp4 file for a video.",
            )
    for file in videos:
        require_encoder(file)
        problem = why_no_video(file)
        if file.suffix.lower() not in {".gif", ".mp4"}:
            problem = f"`{file.name}` is neither an .mcap, nor a .gif, nor an .mp4 file"
        if problem is not None:
            raise RequestError(
                f"The run cannot be recorded: {problem}.",
                hint="Name an .mcap file for the topics, or a .gif or .mp4 file for a video, in a "
                "folder that exists.",
            )
    for file in mcap:
        if not file.parent.is_dir() or not os.access(file.parent, os.W_OK) or file.is_dir():
            raise RequestError(
                f"{file} cannot be written: its folder does not exist or is not writable.",
                hint="Name a file in a folder of yours.",
            )
        if find_spec("mcap") is None:
            raise NotFoundError(
                "Recording topics needs the Python package mcap, which is not installed.",
                hint="pip install 'wsgen[ros]'",
            )
    return Recordings(
        mcap=mcap[0] if mcap else None,
        video=videos[0] if videos else None,
    )


@contextlib.contextmanager
def recording_topics(  # noqa: PLR0913  a request
    file: Path | None,
    python: Path,
    environment: Mapping[str, str],
    *,
    use_sim_time: bool,
    live_folder: Path | None = None,
    recorded: Callable[[Recorded], None] = lambda _recorded: None,
) -> Iterator[None]:
    """Record all topics while the context is open; the file is complete when it closes.

    The recorder finishes its file also when this process is killed.

    Args:
        file: Is written; nothing is done without one.
        python: The interpreter of nodes.
        environment: All variables of nodes.
        use_sim_time: Messages get the time of /clock, not that of this machine.
        live_folder: Of the simulator that is asked for its time until there is a /clock.
        recorded: Is called when the file is complete, or was not written for want of messages.

    Raises:
        NotReadableError: The process cannot be started.
        SessionDiedError: It does not record, or has not finished its file.
    """
    if file is None:
        yield
        return
    heard, reported = os.pipe()
    with os.fdopen(heard, "rb", buffering=0) as hears:
        try:
            words = [
                str(file.absolute()),
                "--parent",
                str(os.getpid()),
                "--report-to",
                str(reported),
            ]
            words += ["--use-sim-time"] if use_sim_time else []
            words += ["--live-folder", str(live_folder)] if live_folder is not None else []
            recorder = _start(words, python, environment, reported)
        finally:
            os.close(reported)
        try:
            if not select.select([hears], [], [], SECONDS_TO_START)[0]:
                recorder.kill()
                raise _failed(file, f"it did not start within {SECONDS_TO_START:.0f} s")
            if (said := hears.read(READ)) == READY:
                yield
        finally:
            interrupt = _end(recorder)
        if said != READY or recorder.returncode != 0:
            why = (said + (hears.read(READ) or b"")).decode(errors="replace").strip()
            raise _failed(file, why or f"its process ended with {recorder.returncode}")
        with contextlib.suppress(ValueError):  # it said nothing
            seconds, messages, lost = json.loads(hears.read(READ) or b"")
            recorded(Recorded(file, seconds, messages, lost))
        if interrupt is not None:
            raise interrupt


def _start(
    words: list[str], python: Path, environment: Mapping[str, str], reported: int
) -> subprocess.Popen[bytes]:
    try:
        return subprocess.Popen(
            module_command(python, MODULE, *words),
            stdin=subprocess.DEVNULL,
            env={**environment, "PYTHONUNBUFFERED": "1"},
            start_new_session=True,  # Ctrl-C ends the launch, and that ends the recording
            pass_fds=[reported],
        )
    except OSError as error:
        raise parent.not_started(error) from error


def _end(recorder: subprocess.Popen[bytes]) -> BaseException | None:
    """Have it write what waits, however long that takes; gives the interrupt that ends that."""
    # While its interpreter starts, SIGINT would leave a traceback.
    recorder.send_signal(signal.SIGTERM)
    try:
        recorder.wait()
    except (KeyboardInterrupt, SystemExit) as interrupt:  # what handlers of signals raise
        recorder.send_signal(signal.SIGTERM)
        try:
            recorder.wait(SECONDS_TO_FINISH)
        except subprocess.TimeoutExpired:
            recorder.kill()
            recorder.wait()
        return interrupt
    return None


def _failed(file: Path, why: str) -> SessionDiedError:
    return SessionDiedError(
        f"The topics are not recorded in {file}: {why}.",
        hint="Check the space on the disk. A file whose name ends with .part holds what was "
        "recorded until then; `mcap recover` reads it.",
    )
