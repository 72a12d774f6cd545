"""Requests of services are read from command lines."""

from __future__ import annotations

from typing import Any

import pytest

from wsgen.launching.commands import read_request


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("{name: r, xml: '<robot/>'}", {"name": "r", "xml": "<robot/>"}),
        (
            r'{name: "r", xml: "<robot name=\"r\"/>' + "\\n" + '"}',
            {"name": "r", "xml": '<robot name="r"/>\n'},
        ),
        ("{'name': r}", {"name": "r"}),
        ("{xml: 'it''s'}", {"xml": "it's"}),
        (
            "{name: r, initial_pose: {position: {x: 1.0, y: -2}, orientation: {w: 1}}}",
            {
                "name": "r",
                "initial_pose": {"position": {"x": "1.0", "y": "-2"}, "orientation": {"w": "1"}},
            },
        ),
        ('sdf_filename: "/m/r.sdf", name: "r"', {"sdf_filename": "/m/r.sdf", "name": "r"}),
        (
            'sdf_filename: "r.sdf" name: "r" pose { position { z: 0.5 } } allow_renaming: true',
            {
                "sdf_filename": "r.sdf",
                "name": "r",
                "pose": {"position": {"z": "0.5"}},
                "allow_renaming": "true",
            },
        ),
        ("{file: /a/b.sdf}", {"file": "/a/b.sdf"}),
        ("{uri: model://a}", {"uri": "model://a"}),
        ("{}", {}),
    ],
)
def test_fields(text: str, fields: dict[str, Any]) -> None:
    assert read_request(text) == fields


@pytest.mark.parametrize(
    "text",
    [
        "{",
        "{a: b",
        '{xml: "<robot name="r"/>"}',
        "{a: 'b}",
        "a",
        "a:",
        "{a: {b: c}",
        "[1, 2]",
        "\\",
    ],
)
def test_what_is_no_request(text: str) -> None:
    assert read_request(text) is None
