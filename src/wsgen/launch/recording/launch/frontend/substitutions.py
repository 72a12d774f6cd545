"""The substitutions that XML and YAML know by name."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from launch.substitution import Substitution

    Arguments = list[list[Substitution]]


class _Form(NamedTuple):
    """A substitution: where its class is, and the keywords of its arguments."""

    module: str
    name: str
    keywords: tuple[str, ...] = ()
    required: int | None = None  # how many of them; None: all
    takes_list: bool = False  # the arguments, however many, are one parameter


_LAUNCH = "launch.substitutions"
_ROS = "launch_ros.substitutions"

FORMS = {
    "all": _Form(_LAUNCH, "AllSubstitution", takes_list=True),
    "and": _Form(_LAUNCH, "AndSubstitution", ("left", "right")),
    "anon": _Form(_LAUNCH, "AnonName", ("name",)),
    "any": _Form(_LAUNCH, "AnySubstitution", takes_list=True),
    "command": _Form(_LAUNCH, "Command", ("command", "on_stderr"), 1),
    "dirname": _Form(_LAUNCH, "ThisLaunchFileDir"),
    "env": _Form(_LAUNCH, "EnvironmentVariable", ("name", "default_value"), 1),
    "equals": _Form(_LAUNCH, "EqualsSubstitution", ("left", "right")),
    "eval": _Form(_LAUNCH, "PythonExpression", ("expression", "python_modules"), 1),
    "exec-in-pkg": _Form(_ROS, "ExecutableInPackage", ("executable", "package")),
    "file-content": _Form(_LAUNCH, "FileContent", ("path",)),
    "filename": _Form(_LAUNCH, "ThisLaunchFile"),
    "find-exec": _Form(_LAUNCH, "FindExecutable", ("name",)),
    "find-pkg-prefix": _Form(_ROS, "FindPackagePrefix", ("package",)),
    "find-pkg-share": _Form(_ROS, "FindPackageShare", ("package",)),
    "for-var": _Form(_LAUNCH, "ForEachVar", ("name", "default_value"), 1),
    "if": _Form(_LAUNCH, "IfElseSubstitution", ("condition", "if_value", "else_value"), 2),
    "index": _Form(_LAUNCH, "ForLoopIndex", ("name",)),
    "launch_log_dir": _Form(_LAUNCH, "LaunchLogDir"),
    "log_dir": _Form(_LAUNCH, "LaunchLogDir"),
    "not": _Form(_LAUNCH, "NotSubstitution", ("value",)),
    "not-equals": _Form(_LAUNCH, "NotEqualsSubstitution", ("left", "right")),
    "or": _Form(_LAUNCH, "OrSubstitution", ("left", "right")),
    "path-join": _Form(_LAUNCH, "PathJoinSubstitution", takes_list=True),
    "var": _Form(_LAUNCH, "LaunchConfiguration", ("variable_name", "default"), 1),
}


def make(name: str, arguments: Arguments) -> Substitution:
    """The substitution of that name."""
    form = FORMS.get(name)
    if form is None:
        raise RuntimeError(f"Unknown substitution: {name}")
    made: Callable[..., Substitution] = getattr(importlib.import_module(form.module), form.name)
    if form.takes_list:
        return made(*arguments) if name in {"all", "any"} else made(arguments)
    required = len(form.keywords) if form.required is None else form.required
    if not required <= len(arguments) <= len(form.keywords):
        expected = " or ".join(str(n) for n in range(required, len(form.keywords) + 1))
        raise TypeError(
            f"{name} substitution expects {expected} argument(s), and is given {len(arguments)}"
        )
    keywords: dict[str, Any] = dict(zip(form.keywords, arguments, strict=False))
    if "python_modules" in keywords:
        keywords["python_modules"] = [keywords["python_modules"]]
    return made(**keywords)
