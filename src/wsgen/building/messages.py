"""Messages of packages of the workspace, where no ROS is sourced: with the generators of PyPI's."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from wsgen.errors import WsgenError
from wsgen.packages.build_files.cmake_text import read_calls
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.events import Listener
    from wsgen.packages.workspace.layout import PackageFolder

GENERATE = "rosidl_generate_interfaces"
VARIABLE = "WSGEN_ROS"  # which cmake/interfaces.cmake reads


@dataclass(frozen=True, kw_only=True)
class MessageSupport:
    """What generates messages, or why nothing does."""

    variables: Mapping[str, str]  # for CMake
    arguments: tuple[str, ...] = ()  # of CMake: other ones make colcon configure again
    why_not: str = ""  # what to do to have messages


def message_support(
    packages: Iterable[PackageFolder], environment: Mapping[str, str], listener: Listener | None
) -> MessageSupport:
    """Bring what generates messages, if a package has some and wsgen[ros] is installed.

    Args:
        packages: of the workspace.
        environment: the user's variables.
        listener: receives progress.
    """
    called: set[str] = set()
    has_messages = False
    for package in packages:
        if package.build_type == "ament_cmake":
            calls = read_calls(package.path / "CMakeLists.txt")
            if any(call.command == GENERATE for call in calls):
                has_messages = True
                called.update(word for call in calls for word in call.arguments)
    if not has_messages:
        return MessageSupport(variables={VARIABLE: ""})
    from wsgen.ros.environment.environment import find_compiler, open_private  # noqa: PLC0415  rare

    def listen(event: object) -> None:
        if listener is not None:
            listener(event)  # type: ignore[arg-type]  # whatever events are

    try:
        ros = open_private(environment, messages=called, listener=listen)
        find_compiler(environment, listen)
    except WsgenError as error:
        return MessageSupport(
            variables={VARIABLE: ""}, why_not=f"{error.message} {error.hint}".replace("\n", " ")
        )
    *messages, prefix = map(str, ros.prefixes)
    value = os.pathsep.join([prefix, *messages])
    return MessageSupport(variables={VARIABLE: value}, arguments=(f"-D{VARIABLE}={prefix}",))
