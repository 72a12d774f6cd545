"""The rule about files of parameters that no node can read."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.text import yamlfile
from wsgen.text.markup import read_text
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic


MALFORMED_PARAMETER_FILE = Rule(
    code="LCH099",
    name="malformed-parameter-file",
    severity=Severity.ERROR,
    severity_varies="a warning about a misspelled `ros__parameters`",
    summary="A parameter file or the configuration file of a bridge is not valid.",
    what="Reads the YAML files of a package that contain `ros__parameters`, or topics of a bridge.",
    why="The node that reads the file exits with an error, or gets none of the parameters.",
    example="""
diff_drive_controller:
  ros_parameters:
    wheel_radius: 0.1
""",
    instead="""
diff_drive_controller:
  ros__parameters:
    wheel_radius: 0.1
""",
)

_OF_NODES = (b"ros__param", b"ros_param", b"gz_topic_name", b"ros_topic_name", b"gz_type_name")
_MISSPELLED = lazy_pattern(r"ros_*param(?:eter)?s?")
_TEMPLATE = lazy_pattern(r"\{\{|\{%")
DEEPEST = 8  # namespaces


def malformed_parameter_files(file: Path, content: bytes | None = None) -> Iterator[Diagnostic]:
    """Report a YAML file that a node cannot read.

    `content` is what is in it, where it is not known that a node reads it.
    """
    if content is not None and not any(sign in content for sign in _OF_NODES):
        return
    found = yamlfile.load_parameters(file)
    if isinstance(found, yamlfile.Value):
        yield from _misspelled_sections(file, found)
        return
    if not isinstance(found, yamlfile.NotYaml):
        return
    text = read_text(file) or ""
    if _TEMPLATE.search(text):
        return  # something makes YAML of it
    lines = text.splitlines()
    line = next(
        (
            number
            for number, one in enumerate(lines, 1)
            if "\t" in one[: len(one) - len(one.lstrip())]
        ),
        None,
    )
    yield MALFORMED_PARAMETER_FILE.at(
        file,
        line or found.line,
        message=f"{file.name} is not valid YAML: "
        + ("this line is indented with a tab." if line else f"{found.message.rstrip('.')}."),
        hint="Indent it with spaces, like the lines around it."
        if line
        else "Check indentation, colons, quotes and brackets in this line and the one before.",
    )


def _misspelled_sections(file: Path, value: yamlfile.Value, level: int = 0) -> Iterator[Diagnostic]:
    for key, inner in value.items():
        if key == "ros__parameters":
            continue
        if _MISSPELLED.fullmatch(key) and isinstance(inner.content, dict):
            yield MALFORMED_PARAMETER_FILE.at(
                file,
                inner.line - 1,
                key,
                message=f"ROS does not read parameters below `{key}`: the node does not get them.",
                hint="Write `ros__parameters`, with two underscores.",
                severity=Severity.WARNING,
            )
        elif level < DEEPEST:
            yield from _misspelled_sections(file, inner, level + 1)
