"""Regular expressions mean what they mean in CMake, and end."""

from __future__ import annotations

import shutil
import subprocess
from typing import TYPE_CHECKING

import pytest

from packages.build_files.test_cmake import BOTH, read, shared
from wsgen.packages.build_files.cmake_values import compiled_regex, search_regex

if TYPE_CHECKING:
    from pathlib import Path

# Pattern, text, whether CMake finds it; None: not known, or CMake refuses the pattern.
SEARCHES = [
    ("^lib(foo|bar)+$", "libfoobar", None),  # a repeated group is not evaluated
    ("^lib(foo|bar)?$", "libfo", False),
    (r"\.dae$", "a.dae", True),
    (r"\.dae$", "a_dae", False),
    (r"\d+", "12", False),  # the letter d: CMake has no classes
    (r"\d+", "ddd", True),
    ("a{2}", "aa", False),  # braces stand for themselves
    ("a{2}", "a{2}", True),
    ("[]x]", "]", True),
    ("[^]x]", "]", False),
    ("[a-]", "-", True),
    (r"[\d]", "\\", True),  # a backslash in brackets, too
    ("a|", "b", True),
    ("x(a|b|c)?y", "xcy", True),
    ("x(a|b|c)?y", "xaby", False),
    ("(ab*|c)d", "abbcabd", True),
    ("a$", "a\n", False),
    ("a.b", "a\nb", True),
    ("^$", "", True),
    ("a*?", "a", None),
    ("(a*)+", "a", None),
    ("(?:a)", "a", None),
    ("(a", "a", None),
    ("a)", "a", None),
    ("[a", "a", None),
    ("[b-a]", "a", None),
    ("*a", "a", None),
]


@pytest.mark.parametrize(("pattern", "text", "expected"), SEARCHES)
def test_search(pattern: str, text: str, expected: bool | None) -> None:
    assert search_regex(pattern, text) is expected
    assert (compiled_regex(pattern) is None) is (expected is None)


@pytest.mark.skipif(shutil.which("cmake") is None, reason="CMake is not installed")
def test_cmake_says_the_same(tmp_path: Path) -> None:
    lines = []
    for pattern, text, expected in SEARCHES:
        if expected is not None:
            call = f"if([==[{text}]==] MATCHES [==[{pattern}]==])"
            lines.append(f"{call}\nmessage(yes)\nelse()\nmessage(no)\nendif()")
    (tmp_path / "a.cmake").write_text("\n".join(lines))
    run = subprocess.run(
        ["cmake", "-P", tmp_path / "a.cmake"], check=False, stderr=subprocess.PIPE, text=True
    )
    assert run.stderr.splitlines() == [
        "yes" if one[2] else "no" for one in SEARCHES if one[2] is not None
    ]


def test_patterns_that_backtrack_without_end() -> None:
    assert search_regex("(a+)+$", "a" * 50_000 + "!") is None
    assert search_regex("(a|aa)+$", "a" * 50_000 + "!") is None
    assert search_regex("a+$", "a" * 50_000 + "!") is None
    assert search_regex("^a", "a" * 50_000 + "!") is True


def test_a_pattern_may_be_larger_than_anybody_writes() -> None:
    assert search_regex("(" * 240 + "a" + ")" * 240, "a") is not False
    assert search_regex("a" * 5_000, "a") is None


@pytest.mark.parametrize(
    "text",
    [
        'set(long "{a}!")\nif(long MATCHES "(a+)+$")\nendif()',
        'set(all "{a}!" b)\nlist(FILTER all EXCLUDE REGEX "(a+)+$")',
        'install(DIRECTORY urdf DESTINATION share/bot REGEX "/(.*.*)*.*.*!$" EXCLUDE)',
    ],
)
def test_no_pattern_of_a_package_hangs_the_check(tmp_path: Path, text: str) -> None:
    text = text.replace("{a}", "a" * 100_000)
    folders = "launch" if "DIRECTORY urdf" in text else "launch urdf"
    files = [f"urdf/{'a' * 200}"] if folders == "launch" else []
    text += f"\ninstall(DIRECTORY {folders} DESTINATION share/bot)"
    assert set(BOTH) <= set(shared(read(tmp_path, text, files)))


@pytest.mark.slow
def test_a_loop_over_patterns_ends(tmp_path: Path) -> None:
    text = (
        f'set(long "{"ab" * 30_000}")\nforeach(one RANGE 3000)\n  if(long MATCHES "x${{one}}")\n'
        "  endif()\nendforeach()\ninstall(DIRECTORY launch DESTINATION share/bot)"
    )
    assert read(tmp_path, text).is_whole is False


def test_a_filter_knows_what_matches(tmp_path: Path) -> None:
    text = (
        'set(all launch urdf other)\nlist(FILTER all INCLUDE REGEX "^(launch|urdf)$")\n'
        "install(DIRECTORY ${all} DESTINATION share/bot)"
    )
    facts = read(tmp_path, text)
    assert shared(facts) == BOTH
    assert facts.is_whole
