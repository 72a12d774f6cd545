"""Texts that are nearly XML: read, with a warning, as far as Gazebo's own parser reads them."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

import pytest

from gazebo_oracle import IGN, ign_sdf
from wsgen.descriptions.sdf.models import read_sdf
from wsgen.diagnostics import Severity

if TYPE_CHECKING:
    from pathlib import Path


SDF = (
    '<sdf version="1.9"><!--{comment}--><model name="{name}"><link name="l"><inertial/>'
    "{element}<pose>{pose}</pose></link></model></sdf>"
)
DECLARED = '<?xml version="1.0" encoding="{}"?>\n'
DOCTYPE = '<!DOCTYPE sdf [<!ENTITY a "1">]>\n'


def text(
    comment: str = "",
    name: str = "m",
    element: str = "",
    pose: str = "0 0 1 0 0 0",
) -> str:
    return SDF.format(comment=comment, name=name, element=element, pose=pose)


CASES = {
    "plain": (text().encode(), None),
    "mark": (b"\xef\xbb\xbf" + text(comment="é").encode(), None),
    "end_of_c": (text().encode() + b"\0", None),
    "latin_1": (text(comment="é").encode("latin-1"), "ROB057"),
    "latin_1_declared": (
        (DECLARED.format("ISO-8859-1") + text(name="é")).encode("latin-1"),
        "ROB057",
    ),
    "utf_8_declared_otherwise": ((DECLARED.format("ISO-8859-1") + text(name="é")).encode(), None),
    "unknown_encoding": ((DECLARED.format("klingon") + text()).encode(), None),
    "ampersand": (text(name="a&amp;b").replace("&amp;", "&").encode(), "ROB001"),
    "dashes": (text(comment=" <a/> -- b\n ").encode(), "ROB001"),
    "prefix": (text(element='<gz:x gz:y="1"/>').encode(), "ROB001"),
    "default_namespace": (text().replace("<sdf", '<sdf xmlns="http://x"').encode(), None),
    "entity_unused": ((DOCTYPE + text()).encode(), None),
}
REFUSED = {
    "utf_16": (text().encode("utf-16"), "ROB057"),
    "utf_32": (text().encode("utf-32"), "ROB057"),
    "rubbish_behind": (text().encode() + b"rubbish", "ROB001"),
    "declaration_not_closed": (b"<?xml " + text().encode().replace(b"?", b""), "ROB001"),
    "not_closed": (text().encode()[:-3], "ROB001"),
    "open_comment": (text().encode() + b"<!--" * 100_000, "ROB001"),
    "deep": (text(element="<a>" * 400 + "</a>" * 400).encode(), "ROB001"),
    "entity_used": ((DOCTYPE + text(pose="&a; 0 0 0 0 0")).encode(), "WLD046"),
}


@pytest.mark.parametrize("case", CASES)
def test_what_gazebo_reads(tmp_path: Path, case: str) -> None:
    content, code = CASES[case]
    file = tmp_path / "m.sdf"
    file.write_bytes(content)
    found = read_sdf(file, find_model=lambda _: None)
    assert [(one.code, one.severity) for one in found.diagnostics] == (
        [] if code is None else [(code, Severity.WARNING)]
    )
    assert all(one.line is not None and one.hint for one in found.diagnostics)
    assert [one.pose_in_world.xyz for one in found.models] == [(0, 0, 1)]


@pytest.mark.parametrize("case", REFUSED)
def test_what_gazebo_refuses(tmp_path: Path, case: str) -> None:
    content, code = REFUSED[case]
    file = tmp_path / "m.sdf"
    file.write_bytes(content)
    found = read_sdf(file, find_model=lambda _: None)
    assert [(one.code, one.severity) for one in found.diagnostics] == [(code, Severity.ERROR)]
    assert all(one.line is not None and one.hint for one in found.diagnostics)
    assert found.models == ()


@pytest.mark.slow
@pytest.mark.oracle
@pytest.mark.skipif(IGN is None, reason="ign (Debian: ignition-tools, libsdformat12) is missing")
@pytest.mark.parametrize("case", [*CASES, *REFUSED])
def test_gazebo_agrees(tmp_path: Path, case: str) -> None:
    file = tmp_path / "m.sdf"
    file.write_bytes((CASES | REFUSED)[case][0])
    answer = subprocess.run(ign_sdf("-k", file), capture_output=True, timeout=600, check=False)
    assert (b"Valid." in answer.stdout) == (case in CASES)


def test_lines_are_those_of_the_file(tmp_path: Path) -> None:
    file = tmp_path / "m.sdf"
    file.write_text(
        f"{DECLARED.format('utf-8')}<!-- a -- b\n\n-->" + text(pose="1").replace("<pose", "\n<pose")
    )
    found = read_sdf(file, find_model=lambda _: None)
    assert [(one.code, one.line) for one in found.diagnostics] == [("ROB001", 2), ("ROB016", 5)]
