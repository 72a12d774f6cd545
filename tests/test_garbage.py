"""What is read is freed at once: without the garbage collector, memory stays flat."""

import subprocess
import sys
from pathlib import Path

import pytest

MANIFEST = """<package format="3">
  <name>robot</name>
  <exec_depend>xacro</exec_depend>
</package>"""
# In a process of its own: threads of pytest and what other tests have left make garbage, too.
PROGRAM = """
import gc, sys
from pathlib import Path
from wsgen.text import xmltree
from wsgen.text.markup import elements
from wsgen.packages.workspace.manifest import read_manifest

gc.disable()
file = Path(sys.argv[1])
{reader}  # what is prepared at first use
gc.collect()
{reader}
print(gc.collect())
"""


@pytest.mark.parametrize(
    "reader",
    [
        "xmltree.parse(file.read_bytes())",
        "elements(file, file.read_text())",
        "read_manifest(file)",
    ],
)
def test_nothing_is_left_for_the_collector(tmp_path: Path, reader: str) -> None:
    file = tmp_path / "package.xml"
    file.write_text(MANIFEST)
    program = [sys.executable, "-c", PROGRAM.format(reader=reader), str(file)]
    done = subprocess.run(program, capture_output=True, text=True, check=True)
    assert int(done.stdout) == 0
