"""STL files that are texts: what Gazebo reads of them, and what is said where it stops.

How many triangles it reads was measured with the STLLoader of ignition-common 4.5.1.
"""

from __future__ import annotations

import pytest

from wsgen.descriptions.meshes.content import BrokenMeshError
from wsgen.descriptions.meshes.stl import read_stl

FACET = """\
facet normal 0 0 1
  outer loop
    vertex 0 0 0
    vertex 1 0 0
    vertex 0 1 0
  endloop
endfacet
"""
TWO = f"solid part\n{FACET}{FACET}endsolid part\n"


@pytest.mark.parametrize(
    "text",
    [
        TWO,
        TWO.replace("\n", "\r\n"),
        TWO.replace("  ", "\t"),
        TWO.upper(),
        TWO.replace("1 0 0", "1.0e+00 0 0"),
        TWO.replace("solid part", "solid"),
        TWO.removesuffix("endsolid part\n"),
        TWO.rstrip("\n"),
        TWO.replace("facet normal 0 0 1", "facet"),
        TWO.replace("outer loop", "hello"),
        "\n\n" + TWO.replace("part\n", "part\n\n# made by hand\n! so\n$ too\n", 1) + "\n\n",
        TWO.replace("endfacet\n", "endfacet\ncolor 1 0 0\n"),
        TWO.replace("solid part", f"solid {'x' * 249}", 1),
        f"{TWO[:11]}{' ' * 300}{TWO[11:]}",
        f"solid a\n{FACET}endsolid a\nsolid b\n{FACET}endsolid b\n",
    ],
)
def test_what_gazebo_reads(text: str) -> None:
    assert len(read_stl(text.encode()).corners) == 2


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        (TWO.replace("\n", "\n\n"), 3, "facet normal 0 0 1"),
        (TWO.replace("vertex 1", "\n    vertex 1", 1), 2, "facet normal 0 0 1"),
        (TWO.replace("outer loop", "\n  outer loop"), 2, "facet normal 0 0 1"),
        (TWO.replace("\n  outer loop", " outer loop"), 2, "facet normal 0 0 1 outer loop"),
        (TWO.replace("\n    vertex", " vertex"), 2, "facet normal 0 0 1"),
        (f"solid part\ncreator somebody\n{FACET}{FACET}", 2, "creator somebody"),
        (f"{FACET}; a comment of another kind\n{FACET}".join(("solid\n", "")), 9, "; a comment"),
        (f"solid part\n{FACET}end solid\n{FACET}", 9, "end solid"),
        (TWO.replace("solid part", f"solid {'x' * 250}", 1), 1, "solid xxx"),
        (f"solid part\n{FACET}# {'y' * 300}\n{FACET}", 9, "# yyy"),
        (TWO.replace("\n", " "), 1, "solid part facet"),
    ],
)
def test_what_gazebo_does_not_read(text: str, line: int, words: str) -> None:
    with pytest.raises(BrokenMeshError, match=rf"from line {line} on \('{words}"):
        read_stl(text.encode())


def test_the_line_ends_of_old_macintoshes() -> None:
    with pytest.raises(BrokenMeshError, match="old Macintosh"):
        read_stl(TWO.replace("\n", "\r").encode())
