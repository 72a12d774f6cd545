"""Names and types that are given: of messages, fields, parameters, and of what is added."""

from __future__ import annotations

import contextlib
import json
import keyword
import re
from typing import TYPE_CHECKING, NamedTuple

from wsgen.errors import RequestError
from wsgen.model.package import CMAKE_TARGETS, CPP_KEYWORDS
from wsgen.ros.environment.interfaces import common_packages, fields_of
from wsgen.ros.names import is_released, released_packages
from wsgen.text.suggestions import advice

if TYPE_CHECKING:
    from collections.abc import Iterable

    from wsgen.porting.adding.addition import Addition

_NAME = re.compile(r"[a-z](?:_?[a-z0-9])*")
_TYPE_NAME = re.compile(r"[A-Z][A-Za-z0-9]*")
_TOPIC = re.compile(r"[~/]?/?[A-Za-z_]\w*(?:/[A-Za-z_]\w*)*")
_FIELD = re.compile(r"(?P<base>[\w/]+)(?:<=\d+)?(?:\[(?:<=)?\d*\])?")
_PRIMITIVES = frozenset(
    (
        *("bool", "byte", "char", "float32", "float64", "string", "wstring"),
        *(f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)),
    )
)
_MEANT = {"float": "float32", "double": "float64", "int": "int32", "str": "string"}


class MessageType(NamedTuple):
    """The type of a topic."""

    package: str
    name: str

    def __str__(self) -> str:
        """As ROS writes it."""
        return f"{self.package}/msg/{self.name}"

    @property
    def cpp(self) -> str:
        """As C++ writes it."""
        return f"{self.package}::msg::{self.name}"

    @property
    def header(self) -> str:
        """The file that C++ includes."""
        words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", self.name)
        return f"{self.package}/msg/{words.lower()}.hpp"


class Topic(NamedTuple):
    """A topic of a node."""

    name: str
    type: MessageType

    @property
    def word(self) -> str:
        """What variables and functions for it are named by."""
        return re.sub(r"\W+", "_", self.name.strip("~/")).lower()


class Field(NamedTuple):
    """A field of a message."""

    name: str
    type: str  # as it is written
    package: str | None  # that its type is of; None: it is none of a message


class Parameter(NamedTuple):
    """A parameter of a node."""

    name: str
    value: bool | float | str | list[bool] | list[float] | list[str]

    @property
    def python(self) -> str:
        """Its value in Python."""
        return repr(self.value)

    @property
    def yaml(self) -> str:
        """Its value in YAML."""
        return json.dumps(self.value, ensure_ascii=False)

    @property
    def cpp_type(self) -> str:
        """Its type in C++."""
        kinds = {bool: "bool", int: "int64_t", float: "double", str: "std::string"}
        if isinstance(self.value, list):
            return f"std::vector<{kinds[type(self.value[0])]}>"
        return kinds[type(self.value)]

    @property
    def cpp(self) -> str:
        """Its value in C++."""
        written = json.dumps(self.value, ensure_ascii=False)
        return f"{{{written[1:-1]}}}" if isinstance(self.value, list) else written


def check_name(what: str, name: str, *, is_program: bool = False) -> None:
    """Refuse what cannot be the name of a file, and of a program and its node.

    Raises:
        RequestError: It cannot.
    """
    if _NAME.fullmatch(name) is None:
        plain = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name.rpartition("/")[2]).lower()
        plain = re.sub(r"\W+|__+", "_", plain.removesuffix(".py")).strip("_")
        near = f" such as `{plain}`" if _NAME.fullmatch(plain) else ""
        raise RequestError(
            f"{name!r} cannot be the name of a {what}: it has other characters than a to z, digits "
            "and single underscores, or does not begin with a letter.",
            hint=f"Choose a name{near}.",
        )
    if is_program and (keyword.iskeyword(name) or name in CPP_KEYWORDS or name in CMAKE_TARGETS):
        raise RequestError(
            f"`{name}` cannot be the name of a {what}: it is a word of Python, C++ or CMake.",
            hint=f"Choose another name, for example `{name}_node`.",
        )


def check_type_name(what: str, name: str) -> None:
    """Refuse what cannot be the name of a message, service or action.

    Raises:
        RequestError: It cannot.
    """
    if _TYPE_NAME.fullmatch(name) is None:
        words = re.split(r"\W+|_+", name.rpartition("/")[2].partition(".")[0])
        plain = "".join(word[:1].upper() + word[1:] for word in words)
        near = f" such as {plain}" if _TYPE_NAME.fullmatch(plain) else ""
        raise RequestError(
            f"{name!r} cannot be the name of a {what}: it must be in CamelCase, of letters and "
            "digits.",
            hint=f"Choose a name{near}.",
        )


def read_topics(words: Iterable[str], option: str, addition: Addition) -> list[Topic]:
    """Read `TOPIC:TYPE`.

    Raises:
        RequestError: One has another form, or its type does not exist.
    """
    found = []
    for word in words:
        name, colon, written = word.partition(":")
        if not colon or _TOPIC.fullmatch(name) is None:
            raise RequestError(
                f"`{option} {word}` is not a topic with its type.",
                hint=f"Write for example {option} chatter:std_msgs/String",
            )
        found.append(Topic(name, read_type(written, addition)))
    return found


def read_type(written: str, addition: Addition) -> MessageType:
    """Read the type of a message, such as `std_msgs/String` or `std_msgs/msg/String`.

    Raises:
        RequestError: It does not exist, as far as it is known.
    """
    package, _, rest = written.partition("/")
    name = rest.removeprefix("msg/")
    if _TYPE_NAME.fullmatch(name) is None:
        raise RequestError(
            f"{written!r} is not the type of a message.",
            hint="Write for example std_msgs/String",
        )
    check_message(package, name, addition)
    return MessageType(package, name)


def check_message(package: str, name: str, addition: Addition) -> None:
    """Refuse a message that does not exist, as far as it is known.

    Raises:
        RequestError: It does not.
    """
    own = addition.workspace.get(package)
    if own is not None:
        known = [file.stem for file in (own.path / "msg").glob("*.msg")]
        # Those of packages of other languages may be made elsewhere.
        is_known = name in known or addition.will_have(own.path / "msg" / f"{name}.msg")
        if not is_known:
            raise RequestError(
                f"The package {package} has no message {name}: {own.path / 'msg'} has no "
                f"{name}.msg.",
                hint=advice(name, known, f"Add it: wsgen add message {name} --to {package}"),
            )
        return
    fields = fields_of(package)
    if fields is not None:
        known = [one[4:] for one in fields if one.startswith("msg/")]
        if name not in known:
            raise RequestError(
                f"{package} has no message {name}.",
                hint=advice(name, known, f"Look at those of {package}: ros2 interface package."),
            )
    elif not is_released(package):
        near = [one for one in released_packages() if one.endswith("_msgs")]
        raise RequestError(
            f"The package {package} is not in the workspace, and ROS has no such package.",
            hint=advice(package, {*near, *common_packages()}, "Clone it into the workspace."),
        )


def read_fields(words: Iterable[str], option: str, addition: Addition) -> list[Field]:
    """Read `NAME:TYPE` of fields.

    Raises:
        RequestError: One has another form, or its type does not exist.
    """
    found: list[Field] = []
    for word in words:
        name, colon, written = word.partition(":")
        form = _FIELD.fullmatch(written)
        if not colon or form is None or _NAME.fullmatch(name) is None:
            raise RequestError(
                f"`{option} {word}` is not a field with its type.",
                hint=f"Write for example {option} speed:float64 or {option} "
                "position:geometry_msgs/Point",
            )
        if name in {one.name for one in found}:
            raise RequestError(f"The field {name} is given twice.", hint="Rename one of them.")
        base = form["base"]
        if base in _PRIMITIVES:
            found.append(Field(name, written, None))
            continue
        if "/" not in base and _TYPE_NAME.fullmatch(base) is None:
            meant = (
                f"`{_MEANT[base]}`"
                if base in _MEANT
                else "one of " + ", ".join(sorted(_PRIMITIVES))
            )
            raise RequestError(
                f"`{base}` is not a type of fields.", hint=f"Write {meant}, or PACKAGE/MESSAGE."
            )
        package, _, rest = base.rpartition("/")
        package = package.removesuffix("/msg") or (
            "std_msgs" if base == "Header" else addition.name
        )
        check_message(package, rest, addition)
        whole = base if package == addition.name else f"{package}/{rest}"
        kind = rest if package == addition.name else whole
        found.append(Field(name, written.replace(base, kind, 1), package))
    return found


def read_parameters(words: Iterable[str]) -> list[Parameter]:
    """Read `NAME:=VALUE`, whose value is as YAML has it.

    Raises:
        RequestError: One has another form.
    """
    found: dict[str, Parameter] = {}
    for word in words:
        name, sign, written = word.partition(":=")
        if not sign or re.fullmatch(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*", name) is None:
            raise RequestError(
                f"`{word}` is not a parameter with its value.",
                hint="Write for example speed:=0.5",
            )
        found[name] = Parameter(name, _value(name, written))
    return list(found.values())


def _value(name: str, written: str) -> bool | float | str | list[bool] | list[float] | list[str]:
    value: object = written
    with contextlib.suppress(ValueError):
        value = float(written) if re.search(r"\d\.|\.\d", written) else value
    with contextlib.suppress(ValueError):
        value = json.loads(written) if value is written else value
    if isinstance(value, list) and value and len({type(one) for one in value}) == 1:
        if isinstance(value[0], (bool, int, float, str)):
            return value
    elif isinstance(value, (bool, int, float, str)):
        return value
    raise RequestError(
        f"The value {written!r} of the parameter {name} is not a number, a text, true, false or a "
        "list of one kind of them.",
        hint=f"Write for example {name}:=0.5 or {name}:='[0.0, 1.0]'",
    )
