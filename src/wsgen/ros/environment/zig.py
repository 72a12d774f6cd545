"""PyPI's ziglang: a compiler of C and C++ for machines that have none, and where nobody is root."""

from __future__ import annotations

import shutil
import time
from typing import TYPE_CHECKING

from wsgen.events import StepEnded, StepProgressed, StepStarted, post
from wsgen.ros.environment.cache import being_made, cache_folder
from wsgen.ros.environment.compiler import Compiler
from wsgen.ros.environment.wheels import download, site_packages, unpack

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from wsgen.events import Listener

VERSION = "0.13.0"
# What the wheels of ROS are built for; the libraries of this machine are at least as new.
TARGET = ("-target", "x86_64-linux-gnu.2.28")


def make_zig(environment: Mapping[str, str], listener: Listener) -> Compiler:
    """Return the compiler, which is downloaded into the user's cache unless it is there.

    Raises:
        NotFoundError: it cannot be downloaded.
        NotReadableError: the cache cannot be used.
    """
    folder = cache_folder(environment) / f"ziglang-{VERSION}"
    if not folder.exists():
        _bring(folder, environment, listener)
    program = str(site_packages(folder) / "ziglang" / "zig")
    return Compiler(c=(program, "cc", *TARGET), cxx=(program, "c++", *TARGET))


def _bring(target: Path, environment: Mapping[str, str], listener: Listener) -> None:
    step = ("ros", "ziglang")
    started = time.monotonic()
    succeeded = False
    post(
        listener,
        StepStarted(step=step, detail="a compiler, because this machine has none", takes_long=True),
    )

    def progress(detail: str) -> None:
        post(listener, StepProgressed(step=step, detail=detail))

    try:
        with being_made(target, listener, step) as folder:
            if folder is not None:
                wheels = folder / "wheels"
                found = download(
                    [f"ziglang=={VERSION}"],
                    wheels,
                    environment=environment,
                    listener=listener,
                    step=step,
                )
                unpack(found, folder, change=lambda _, content: content, progress=progress)
                shutil.rmtree(wheels)
                (site_packages(folder) / "ziglang" / "zig").chmod(0o755)
        succeeded = True
    finally:
        seconds = time.monotonic() - started
        post(listener, StepEnded(step=step, succeeded=succeeded, seconds=seconds))
