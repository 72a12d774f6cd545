"""The values of a module that is not installed.

Such a thing can stand anywhere: it can be called, be subscripted, be a base class, a text, an
action, a parameter. Whatever comes of it is unknown too. When its value is needed, that is noted
with the line that made it, and a text stands in for it: `$(module.name)`.
"""

from __future__ import annotations

import dis
import functools
import sys
from typing import TYPE_CHECKING, Any

from launch._events import ProcessExited, ProcessStarted
from launch.base import Action, Substitution
from wsgen.launching.record import RECORD, UnknownText, caller
from wsgen.model.plan import OF_ABSENT_MODULE, STARTS_UNKNOWN

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import FrameType

    from launch.base import LaunchDescriptionEntity
    from launch.launch_context import LaunchContext


def _unpacked(frame: FrameType) -> int:
    """To how many names a line of foreign code assigns the items of a value; else none."""
    code, position = frame.f_code.co_code, frame.f_lasti
    is_unpacking = dis.opname[code[position]] == "UNPACK_SEQUENCE"
    return code[position + 1] if is_unpacking else 0


def _let_be_written() -> None:
    """Let YAML and JSON write what is unknown as the text that stands for it."""
    import json

    import yaml

    for representer in (yaml.representer.SafeRepresenter, yaml.representer.Representer):
        for kind in (Unknown, UnknownText):
            representer.add_representer(kind, lambda dumper, it: dumper.represent_str(str(it)))
    refuse = json.JSONEncoder.default

    def default(self: json.JSONEncoder, value: Any) -> Any:
        return str(value) if isinstance(value, Unknown) else refuse(self, value)

    json.JSONEncoder.default = default  # type: ignore[assignment, method-assign]  # foreign code writes, too


def _let_be_read() -> None:
    """Let YAML and JSON read such a text as what is unknown again."""
    import json

    import yaml

    def reading(read: Callable[..., Any]) -> Callable[..., Any]:
        def read_unknown(text: Any, *arguments: Any, **keywords: Any) -> Any:
            # Readers go through the characters, which have to be those of the text.
            plain = str(text) if isinstance(text, UnknownText) else text
            value = read(plain, *arguments, **keywords)
            is_unknown = isinstance(value, str) and value in RECORD.unknown_texts
            return Unknown(value[2:-1]) if is_unknown else value

        return functools.wraps(read)(read_unknown)

    yaml.load = reading(yaml.load)
    json.loads = reading(json.loads)


class Unknown(Action, Substitution):
    """A value that only the module itself could give."""

    wsgen_is_unknown = True

    def __init__(self, what: Any = "?", *_arguments: Any, **keywords: Any) -> None:
        super().__init__(condition=keywords.get("condition"))
        self.wsgen_what = str(what)
        self.wsgen_added: list[LaunchDescriptionEntity] = []

    def add_action(self, action: LaunchDescriptionEntity) -> None:
        """Take it for a description: what is added to it is known."""
        self.wsgen_added.append(action)

    add_entity = add_action

    def wsgen_text(self) -> str:
        """The text that stands for it."""
        location = self.wsgen_location or caller()
        return RECORD.note_unknown(self.wsgen_what, OF_ABSENT_MODULE, location)

    def perform(self, context: LaunchContext) -> str:
        """See `wsgen_text`."""
        del context
        return self.wsgen_text()

    def describe(self) -> str:
        """Itself in words."""
        return f"$({self.wsgen_what})"

    def execute(self, context: LaunchContext) -> list[LaunchDescriptionEntity]:
        """Note that something would start, and let happen what waits for it."""
        RECORD.note_unresolved(self.wsgen_what, STARTS_UNKNOWN, self.wsgen_location or caller())
        details: dict[str, Any] = {"action": self, "name": self.wsgen_what, "cmd": []}
        for event in (ProcessStarted(**details), ProcessExited(**details)):
            kind = "start" if isinstance(event, ProcessStarted) else "exit"
            event.wsgen_cause = f"{kind} of {self.wsgen_what}"
            context.timeline.post(event)
        return self.wsgen_added

    def _more(self, suffix: str) -> Unknown:
        return Unknown(f"{self.wsgen_what}{suffix}")

    def __getattr__(self, name: str) -> Any:
        # Names that Python or wsgen look up on everything must stay absent.
        if name.startswith(("__", "wsgen_", "_Action")):
            raise AttributeError(name)
        return self._more(f".{name}")

    def __call__(self, *arguments: Any, **keywords: Any) -> Any:
        made = Unknown(f"{self.wsgen_what}()", **keywords)
        is_decorator = len(arguments) == 1 and not keywords and callable(arguments[0])
        return arguments[0] if is_decorator and not isinstance(arguments[0], Unknown) else made

    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, int):
            raise IndexError(key)  # so that loops over it come to an end
        return self._more(f"[{key!r}]")

    def __setitem__(self, key: Any, value: Any) -> None:
        """Keeps nothing."""

    def __iter__(self) -> Iterator[Any]:
        self.wsgen_text()
        return iter([self] * _unpacked(sys._getframe(1)))  # noqa: SLF001  no stack is needed

    def keys(self) -> Any:
        """So that it can be unpacked."""
        return ()

    def __len__(self) -> int:
        return 0

    def __bool__(self) -> bool:
        return True

    def __contains__(self, item: Any) -> bool:
        return False

    def __str__(self) -> str:
        return self.wsgen_text()

    def __repr__(self) -> str:
        return f"$({self.wsgen_what})"

    def __fspath__(self) -> str:
        return self.wsgen_text()

    def __format__(self, specification: str) -> str:
        return self.wsgen_text()

    def __int__(self) -> int:
        self.wsgen_text()
        return 0

    def __float__(self) -> float:
        self.wsgen_text()
        return 0.0

    def __enter__(self) -> Any:
        return self

    def __exit__(self, *_error: object) -> None:
        """Nothing was opened."""

    def __hash__(self) -> int:
        return id(self)

    def __eq__(self, other: object) -> bool:
        return self is other

    def __instancecheck__(self, instance: Any) -> bool:
        return False

    def __mro_entries__(self, _bases: tuple[Any, ...]) -> tuple[type, ...]:
        return (Unknown,)

    def _combine(self, other: Any) -> Any:
        # Of lists that are put together, what is known stays in the plan.
        return [self, *other] if isinstance(other, list) else self._more(" ...")

    def _compare(self, _other: Any) -> bool:
        self.wsgen_text()
        return False

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = _combine
    __truediv__ = __rtruediv__ = __or__ = __ror__ = __and__ = __rand__ = __mod__ = _combine
    __lt__ = __le__ = __gt__ = __ge__ = _compare


_let_be_written()
_let_be_read()
