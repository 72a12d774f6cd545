"""Modules that cannot be imported, because the system lacks a library."""

import sys
from pathlib import Path

import pytest
import yaml._yaml

from wsgen.isolation import parent
from wsgen.isolation.result import Died, MissingLibrary, find_missing_library

GLIBC = "cannot open shared object file: No such file or directory"


@pytest.mark.parametrize(
    ("error", "name", "command"),
    [
        (f"libGL.so.1: {GLIBC}", "libGL.so.1", "sudo apt install libgl1"),
        (f"libstdc++.so.6: {GLIBC}", "libstdc++.so.6", "sudo apt install libstdc++6"),
        (f"libfoo-2.0.so.0: {GLIBC}", "libfoo-2.0.so.0", "apt-file search libfoo-2.0.so.0"),
        (
            "DLL load failed while importing pybullet: The specified module could not be found.",
            "the Visual C++ runtime",
            "winget install Microsoft.VCRedist.2015+.x64",
        ),
        (
            "dlopen(/v/x.so, 0x0002): Library not loaded: @rpath/libomp.dylib\n  Referenced from: ",
            "libomp.dylib",
            "",
        ),
    ],
)
def test_the_library_and_what_brings_it(error: str, name: str, command: str) -> None:
    assert find_missing_library(f"failed (ImportError: {error})") == MissingLibrary(name, command)


@pytest.mark.parametrize("error", ["No module named 'av'", "x.so: undefined symbol: f", ""])
def test_other_errors(error: str) -> None:
    assert find_missing_library(error) is None


@pytest.fixture
def unloadable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """The name of a compiled module that needs a library that no system has."""
    if not sys.platform.startswith("linux"):
        pytest.skip("other systems link in other ways")
    compiled = Path(yaml._yaml.__file__)
    content = compiled.read_bytes()
    assert b"libc.so.6\0" in content
    target = tmp_path / ("unloadable" + compiled.name.removeprefix("_yaml"))
    target.write_bytes(content.replace(b"libc.so.6\0", b"libQ.so.6\0"))
    monkeypatch.syspath_prepend(tmp_path)
    return "unloadable"


@pytest.mark.slow
def test_what_the_linker_says(unloadable: str) -> None:
    death = parent.run("wsgen.isolation.child:import_modules", [unloadable])
    assert isinstance(death, Died)
    assert find_missing_library(death.reason) == MissingLibrary(
        "libQ.so.6", "apt-file search libQ.so.6"
    )
    assert death.hint("Something else.") == "Install libQ.so.6: apt-file search libQ.so.6"
