"""Truth values and numbers, which are read without YAML, are what YAML reads."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest
import yaml

from wsgen.launching import worker

SCRIPT = """
import json, sys
sys.path.insert(0, sys.argv[1])
from launch._utilities import read_plain_yaml
loaded = "yaml" in sys.modules
print(json.dumps([loaded, [read_plain_yaml(text) for text in json.loads(sys.argv[2])]]))
"""
PLAIN = ["true", "false", "0", "-0", "7", "-12", "0.0", "-0.0", "3.50", "-12.25"]
OTHERS = (
    *(
        "",
        " ",
        "null",
        "~",
        "yes",
        "Off",
        "TRUE",
        "010",
        "0x1f",
        "1_000",
        "1:30",
        "1e3",
        ".5",
        "1.",
    ),
    *("+1", "00.5", "1 ", "[1]", "{a: 1}", "robot", "2001-01-01", "1.0.0", "٣", "-", "1\n"),
)


def read(texts: list[str]) -> tuple[bool, list[object]]:
    run = subprocess.run(
        [sys.executable, "-c", SCRIPT, worker._SHIM, json.dumps(texts)],
        capture_output=True,
        text=True,
        check=True,
    )
    loaded, values = json.loads(run.stdout)
    return loaded, values


@pytest.fixture(scope="module")
def values() -> dict[str, object]:
    texts = [*PLAIN, *OTHERS]
    loaded, found = read(texts)
    assert not loaded
    return dict(zip(texts, found, strict=True))


@pytest.mark.parametrize("text", PLAIN)
def test_they_are_what_yaml_reads(values: dict[str, object], text: str) -> None:
    expected = yaml.safe_load(text)
    assert repr(values[text]) == repr(expected)


@pytest.mark.parametrize("text", OTHERS)
def test_all_else_is_left_to_yaml(values: dict[str, object], text: str) -> None:
    assert values[text] is None
