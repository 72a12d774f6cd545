"""Files of parameters."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from launch.utilities.perform_substitutions_impl import perform_substitutions
from wsgen.launch import codes
from wsgen.launch.record import RECORD

if TYPE_CHECKING:
    from launch.launch_context import LaunchContext
    from launch_ros.parameter_descriptions import ParameterFile


def read(
    context: LaunchContext,
    parameter_file: ParameterFile,
    *,
    node: str,
    location: tuple[str, int] | None,
) -> dict[str, Any]:
    """What a file says for a node, given by its full name; nothing where there is no file."""
    path = parameter_file.evaluate(context)
    if RECORD.is_unknown(str(path)):
        return {}
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        RECORD.note_diagnostic(
            codes.PARAMETER_FILE_MISSING,
            "warning",
            f"The parameter file '{path}' cannot be read; the node starts without it.",
            location,
            hint="Check the path, and that CMakeLists.txt installs the folder: "
            "install(DIRECTORY config DESTINATION share/${PROJECT_NAME}).",
        )
        return {}
    if parameter_file.may_have_substitutions(context):
        from launch.frontend.template import parse_substitution

        text = perform_substitutions(context, parse_substitution(text))
    import yaml  # see launch.utilities.type_utils

    try:
        content = yaml.safe_load(text)
    except yaml.YAMLError as error:
        RECORD.note_unresolved(str(path), f"it is no YAML: {error}", location)
        return {}
    found: dict[str, Any] = {}
    for name, section in (content or {}).items() if isinstance(content, dict) else ():
        if _is_meant(str(name), node) and isinstance(section, dict):
            found.update(_flatten(section.get("ros__parameters") or {}, ""))
    return found


def _is_meant(pattern: str, node: str) -> bool:
    """Whether a section is for the node; `*` stands for one part of a name, `**` for several."""
    wanted = "/" + pattern.strip("/")
    return wanted in {"/**", node} or (wanted == "/*" and node.count("/") == 1)


def _flatten(values: dict[Any, Any], prefix: str) -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, dict):
            flat.update(_flatten(value, f"{prefix}{name}."))
        else:
            flat[f"{prefix}{name}"] = _plain(value)
    return flat


def _plain(value: Any) -> Any:
    """The value as the node sees it: what is a date to Python is a text to it."""
    if isinstance(value, list):
        return [_plain(item) for item in value]
    return value if isinstance(value, (str, int, float, bool, type(None))) else str(value)
