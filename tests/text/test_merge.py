"""The merge of three texts: by example, by properties, and compared with git's."""

import shutil
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from wsgen.text.merge import OURS, THEIRS, is_same, merge

BASE = b"one\ntwo\nthree\nfour\nfive\n"
CASES = {
    "both": (b"ONE\ntwo\nthree\nfour\nfive\n", b"one\ntwo\nthree\nfour\nFIVE\n"),
    "same": (b"one\n2\nthree\nfour\nfive\n", b"one\n2\nthree\nfour\nfive\n"),
    "added": (b"one\ntwo\nthree\nfour\nfive\nsix\n", b"zero\none\ntwo\nthree\nfour\nfive\n"),
    "removed": (b"one\nthree\nfour\nfive\n", b"one\ntwo\nthree\nfour\n"),
    "conflict": (b"one\ntwo\nmine\nfour\nfive\n", b"one\ntwo\nits\nfour\nfive\n"),
    "shared ends": (b"one\na\nmine\nz\nfive\n", b"one\na\nits\nz\nfive\n"),
    "emptied": (b"", b"one\ntwo\n3\nfour\nfive\n"),
    "no end": (b"one\ntwo\nthree\nfour\nfive", b"1\ntwo\nthree\nfour\nfive\n"),
    "no end, added": (b"one\ntwo\nthree\nfour\nfive\nsix", b"1\ntwo\nthree\nfour\nfive\n"),
}


@pytest.mark.oracle
@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("prefer", ["", OURS, THEIRS])
def test_it_is_what_git_makes(case: str, prefer: str, tmp_path: Path) -> None:
    ours, theirs = CASES[case]
    for name, text in (("base", BASE), ("ours", ours), ("theirs", theirs)):
        (tmp_path / name).write_bytes(text)
    labels = ("-L", "yours", "-L", "base", "-L", "now")
    words = ("git", "merge-file", "-p", *labels, *([f"--{prefer}"] if prefer else []))
    said = subprocess.run(
        [*words, "ours", "base", "theirs"], cwd=tmp_path, capture_output=True, check=False
    )
    merged = merge(BASE, ours, theirs, label="now", prefer=prefer)
    assert merged.data == said.stdout
    assert merged.conflicts == said.returncode


def test_line_ends_are_those_of_the_user() -> None:
    ours = BASE.replace(b"\n", b"\r\n").replace(b"two", b"zwei")
    theirs = BASE.replace(b"four", b"4\n4a")
    expected = ours.replace(b"four", b"4\r\n4a")
    assert merge(BASE, ours, theirs, label="now") == (expected, 0)
    assert is_same(BASE, BASE.replace(b"\n", b"\r\n"))
    assert not is_same(BASE, ours)


def test_mixed_line_ends_stay_where_they_are() -> None:
    ours = b"one\r\ntwo\nthree\r\nfour\nfive\n"
    merged = merge(BASE, ours, BASE.replace(b"five", b"5"), label="now")
    assert merged == (b"one\r\ntwo\nthree\r\nfour\n5\n", 0)


def test_a_last_line_without_an_end_stays_without() -> None:
    ours = BASE.removesuffix(b"\n")
    assert merge(BASE, ours, BASE.replace(b"one", b"1"), label="now").data.endswith(b"\nfive")
    assert merge(BASE, ours, BASE + b"six\n", label="now").data.endswith(b"\nfive\nsix")


def test_other_encodings_go_through() -> None:
    ours = BASE.replace(b"two", "zwölf".encode("latin-1"))
    merged = merge(BASE, ours, BASE.replace(b"five", b"5"), label="now")
    assert merged == (ours.replace(b"five", b"5"), 0)


LINES = st.lists(st.sampled_from([b"a", b"b", b"c", b"d", b"", b"</link>"]), max_size=12)
TEXTS = LINES.map(lambda lines: b"".join(line + b"\n" for line in lines))


def lines_of(text: bytes) -> Counter[bytes]:
    return Counter(text.replace(b"\r\n", b"\n").removesuffix(b"\n").split(b"\n") if text else [])


@given(TEXTS, TEXTS, TEXTS, st.booleans(), st.sampled_from([b"\n", b"\r\n"]))
def test_no_line_is_lost(
    base: bytes, ours: bytes, theirs: bytes, is_open: bool, end: bytes
) -> None:
    if is_open:
        ours = ours.removesuffix(b"\n")
    merged = merge(base, ours.replace(b"\n", end), theirs, label="now")
    assert not (lines_of(ours) - lines_of(base)) - lines_of(merged.data)
    assert not (lines_of(theirs) - lines_of(base)) - lines_of(merged.data)
    kept = merge(base, ours.replace(b"\n", end), theirs, label="now", prefer=OURS)
    assert kept.conflicts == 0
    assert not (lines_of(ours) - lines_of(base)) - lines_of(kept.data)


@given(TEXTS, TEXTS)
def test_what_one_side_has_changed_is_taken(base: bytes, other: bytes) -> None:
    assert merge(base, base, other, label="now") == (other, 0)
    assert merge(base, other, base, label="now") == (other, 0)
    assert merge(base, other, other, label="now") == (other, 0)
