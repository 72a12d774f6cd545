"""Programs of wsgen start in folders of users, whose files are none of their modules."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

from wsgen.ros.environment.processes import hand_over, handed_over, module_command

if TYPE_CHECKING:
    from pathlib import Path

PROGRAM = """
import sys, given
print(__name__, sys.argv[0].endswith("__main__.py"), sys.argv[1:], __spec__.name)
print(sys.path[0])
"""


@pytest.mark.parametrize("safe", ["", "1"])
def test_files_of_the_working_folder_are_not_imported(tmp_path: Path, safe: str) -> None:
    folder, here = tmp_path / "path", tmp_path / "here"
    (folder / "program").mkdir(parents=True)
    (folder / "program" / "__init__.py").write_text("import sys; print(sys.argv[0])")
    (folder / "program" / "__main__.py").write_text(PROGRAM)
    (folder / "given.py").touch()
    here.mkdir()
    for name in ("runpy", "given", "program", "json"):
        (here / f"{name}.py").write_text("raise SystemExit('executed')")
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONSAFEPATH": safe}
    done = subprocess.run(
        module_command(sys.executable, "program", "-m", "a b"),
        cwd=here,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"-m\n__main__ True ['-m', 'a b'] program.__main__\n{folder}\n"


def test_a_text_of_any_size_is_handed_over() -> None:
    text = "ä" * 200_000
    program = (
        "import sys; from wsgen.ros.environment.processes import handed_over;"
        "print(len(handed_over(sys.argv[1])))"
    )
    number = hand_over(text)
    done = subprocess.run(
        [sys.executable, "-c", program, number],
        close_fds=False,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.stdout, done.stderr) == ("200000\n", "")
    assert handed_over(number) == text
