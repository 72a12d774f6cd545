"""Explain why a compiled module is not imported: the system lacks a library that it is linked to.

A wheel holds all its libraries but those that each Linux with a desktop has. A container, a fresh
Debian or a computer in a robot has no desktop.
"""

from __future__ import annotations

from typing import NamedTuple

from wsgen.text.values import lazy_pattern

# Debian's and Ubuntu's package of each library that the wheels for Linux may leave to the system.
DEBIAN_PACKAGES = {
    "libEGL.so.1": "libegl1",
    "libGL.so.1": "libgl1",
    "libGLU.so.1": "libglu1-mesa",
    "libGLX.so.0": "libglx0",
    "libICE.so.6": "libice6",
    "libOpenGL.so.0": "libopengl0",
    "libSM.so.6": "libsm6",
    "libX11.so.6": "libx11-6",
    "libXext.so.6": "libxext6",
    "libXrender.so.1": "libxrender1",
    "libatomic.so.1": "libatomic1",
    "libexpat.so.1": "libexpat1",
    "libgcc_s.so.1": "libgcc-s1",
    "libglib-2.0.so.0": "libglib2.0-0",
    "libgobject-2.0.so.0": "libglib2.0-0",
    "libgomp.so.1": "libgomp1",
    "libgthread-2.0.so.0": "libglib2.0-0",
    "libstdc++.so.6": "libstdc++6",
    "libxcb.so.1": "libxcb1",
    "libz.so.1": "zlib1g",
}
ON_LINUX = lazy_pattern(r"([\w.+-]+\.so[\w.]*): cannot open shared object file")  # of glibc
ON_MACOS = lazy_pattern(r"Library not loaded: (?:\S*/)?(\S+)")
# It names the module, and not what is missing: nearly always the runtime of Microsoft's compiler.
ON_WINDOWS = "DLL load failed while importing"
WINDOWS_RUNTIME = "the Visual C++ runtime"


class MissingLibrary(NamedTuple):
    """A library of the system that a compiled module needs."""

    name: str  # of its file; for people where the message does not have it
    command: str  # that installs it, or finds what to install; empty if none is known

    @property
    def advice(self) -> str:
        """What to do: the command, or to install it in some other way."""
        return self.command or f"Install {self.name}"


def find_missing_library(error: str) -> MissingLibrary | None:
    """Find the library that the text of an ImportError is about; None if it is about another."""
    if ON_WINDOWS in error:
        return MissingLibrary(WINDOWS_RUNTIME, "winget install Microsoft.VCRedist.2015+.x64")
    on_linux = ON_LINUX.search(error)
    if on_linux is not None:
        name = on_linux[1]
        package = DEBIAN_PACKAGES.get(name)
        return MissingLibrary(
            name, f"sudo apt install {package}" if package else f"apt-file search {name}"
        )
    on_macos = ON_MACOS.search(error)
    return None if on_macos is None else MissingLibrary(on_macos[1], "")
