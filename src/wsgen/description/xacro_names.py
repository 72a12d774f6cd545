"""Explain wrong names and values in xacro files: of properties, arguments and macros."""

from __future__ import annotations

import contextlib
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.suggestions import advice, did_you_mean, nearest

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from wsgen.description.xacro_place import Sources
    from wsgen.description.xacro_trace import Trace

Fault = dict[str, Any]  # see `wsgen.description.xacro_fault`

# The elements that xacro itself knows, and their attributes.
OWN_ELEMENTS = {
    "arg": ("name", "default"),
    "attribute": ("name", "value"),
    "call": ("macro",),
    "element": ("xacro:name",),
    "if": ("value",),
    "include": ("filename", "ns", "optional"),
    "insert_block": ("name",),
    "macro": ("name", "params"),
    "property": ("name", "value", "default", "remove", "scope", "lazy_eval"),
    "unless": ("value",),
}
TOLD = 60  # characters of an expression or a value
USUAL = "Mend the xacro file; `xacro FILE` shows the same error."


def message_of(found: Trace) -> str:
    """What the first exception says, and about which expression."""
    text = " ".join(str(found.cause).split()) or repr(found.cause)
    return text if found.expression is None else f"{text}, in {_told(found)}"


def _told(found: Trace) -> str:
    return f"`${{{_short(found.expression)}}}`"


def _short(value: object) -> str:
    text = " ".join(str(value).split())
    return text if len(text) <= TOLD else f"{text[: TOLD - 3]}..."


def of_name(found: Trace, sources: Sources) -> Fault | None:
    """A name in an expression that is not defined."""
    undefined = re.match(r"name '(\w+)' is not defined", str(found.cause))
    if not undefined:
        return None
    name = undefined[1]
    later = next(sources.defining("property", name), None)
    plain = next(sources.defining("property", name, prefix=""), None)
    slip = None if later is None else _misspelt(later.tag, later.attributes)
    if later is not None and slip is not None:
        return {
            "message": f"the property `{name}` has no value: <{later.tag}> knows no attribute "
            f"`{slip[0]}`",
            "file": str(later.file),
            "line": later.line_of(slip[0]),
            "element": f"xacro:property[@name='{name}']",
            "hint": did_you_mean(slip[1]),
        }
    if later is None and plain is not None:
        hint = f"Line {plain.line} of {plain.file.name} says <property>: write <xacro:property>."
    elif later is None:
        define = f'<xacro:property name="{name}" value="..."/>'
        hint = advice(name, found.names, f"Define it before its first use: {define}.")
    else:
        hint = (
            f"Line {later.line} of {later.file.name} defines `{name}`, and it is not known here: "
            "define it above its first use, and not inside of a macro."
        )
    return {"message": message_of(found), "hint": hint}


def of_attribute(found: Trace, _: Sources) -> Fault | None:
    """An attribute that an element of xacro must have."""
    missing = re.search(r"missing attribute '([\w:]+)'", str(found.cause))
    tag = getattr(found.node, "tagName", None)
    if not missing or tag is None:
        return None
    slip = _misspelt(tag, dict(found.node.attributes.items()))
    write = f'Write <{tag} {missing[1]}="...">.'
    return {
        "message": f"<{tag}> has no attribute `{missing[1]}`"
        + ("" if slip is None else f", and knows none called `{slip[0]}`"),
        "hint": write if slip is None else did_you_mean(slip[1]),
    }


def _misspelt(tag: str, attributes: Mapping[str, str]) -> tuple[str, str] | None:
    """An attribute that an element of xacro does not know, and the one that must be meant."""
    known = OWN_ELEMENTS.get(tag.removeprefix("xacro:"), ())
    for name in attributes:
        near = nearest(name, set(known) - attributes.keys())
        if name not in known and near is not None:
            return name, near
    return None


def of_command(found: Trace, _: Sources) -> Fault | None:
    """A command in $(…) that xacro does not know."""
    unknown = re.match(r"Unknown substitution command \[(.*?)\].*\[(.*?)\]", str(found.cause))
    if not unknown:
        return None
    command = unknown[1].partition(" ")[0]
    known = re.findall(r"'(\w+)'", unknown[2])
    return {
        "message": f"`$({_short(unknown[1])})`: xacro knows no command `{command}`",
        "hint": advice(command, known, f"Write one of {', '.join(known)}."),
    }


def of_argument(found: Trace, sources: Sources) -> Fault | None:
    """An argument that is neither declared nor given."""
    if type(found.cause).__name__ != "ArgException":
        return None
    name = str(found.cause)
    declare = (
        f'Declare it above its first use: <xacro:arg name="{name}" default="..."/>, or give it: '
        f"{name}:=VALUE."
    )
    return {
        "message": f"Undefined substitution argument {name}",
        "element": f"$(arg {name})",
        "hint": advice(name, sources.names("arg"), declare),
    }


def unused_arguments(
    unused: Iterable[str], declared: Iterable[str], files: Iterable[str | None]
) -> list[dict[str, str]]:
    """Those of the names that no file has as an argument: each with name, message and hint.

    `declared` are arguments that the files are known to have.
    """
    declared = sorted(declared)
    texts = []
    for file in dict.fromkeys(filter(None, files)):
        with contextlib.suppress(OSError):
            texts.append(Path(file).read_text(encoding="utf-8", errors="replace"))
    written = "\n".join(texts)
    # A condition may leave out the place that declares or uses an argument.
    places = r"""(?:xacro:arg\s[^>]*name\s*=\s*["']|\(\s*arg\s+|arg\(\s*["']){}\b"""
    has = "It has " + (", ".join(f"`{name}`" for name in declared) or "no arguments") + "."
    return [
        {
            "name": name,
            "message": f"The xacro file has no argument `{name}`: xacro ignores the value that is "
            "given for it.",
            "hint": advice(
                name,
                declared,
                f'Remove it, or declare it in the file: <xacro:arg name="{name}" '
                f'default="..."/>. {has}',
            ),
        }
        for name in unused
        if not re.search(places.format(re.escape(name)), written)
    ]


def of_macro(found: Trace, sources: Sources) -> Fault | None:
    """A macro that is not defined, or is called with other parameters than it has."""
    text = str(found.cause)
    tag = getattr(found.node, "tagName", "")
    name = tag.removeprefix("xacro:")
    if text.startswith("unknown macro"):
        return _unknown_macro(found, sources, name)
    missing = re.match(r"Undefined parameters \[(.*)\]", text)
    if missing:
        given = " ".join(f'{parameter}="..."' for parameter in missing[1].split(","))
        return {
            "message": f"Undefined parameters [{missing[1]}]: the macro `{name}` needs them, and "
            "this call does not give them",
            "hint": f"Write <xacro:{name} {given} ...>, or give defaults in the macro's params.",
        }
    wrong = re.match(r'Invalid parameter "(.*)"', text)
    if wrong:
        parameters = [
            parameter
            for macro in sources.defining("macro", name)
            for parameter in re.findall(r"(?:^|\s)(\w+)", macro.attributes.get("params", ""))
        ]
        return {
            "message": f'Invalid parameter "{wrong[1]}": the macro `{name}` has no such one',
            "hint": advice(wrong[1], parameters, "Look at the macro's params: they name them."),
        }
    return None


def _unknown_macro(found: Trace, sources: Sources, name: str) -> Fault:
    later = next(sources.defining("macro", name), None)
    include = "Include the file that defines the macro, before its first use."
    return {
        "message": f"unknown macro name: xacro:{name}",
        "hint": advice(name, (*OWN_ELEMENTS, *found.macros), include)
        if later is None
        else f"Line {later.line} of {later.file.name} defines it: move that above its first use.",
    }


def of_expression(found: Trace, sources: Sources) -> Fault | None:
    """An expression that is none, or that its values do not suit."""
    text = str(found.cause)
    if text.startswith("invalid expression: "):
        rest = text.partition(": ")[2]
        return {
            "message": f"invalid expression: `{_short(rest)}` does not end",
            "element": _short(rest),
            "hint": "Close it with " + ("`}`." if rest.startswith("${") else "`)`."),
        }
    if text.startswith("circular variable definition"):
        return {
            "message": text.partition("\n")[0],
            "hint": "The value of a property is computed where it is used: give one of them "
            "another name.",
        }
    if found.expression is None:
        return None
    return _text_for_number(found, sources) or _with_values(found)


def _text_for_number(found: Trace, sources: Sources) -> Fault | None:
    texts = [(name, value) for name, value in found.values.items() if isinstance(value, str)]
    if not texts or not isinstance(found.cause, (TypeError, ValueError)):
        return None
    name, value = texts[0]
    number = value.strip().replace(",", ".")
    fault: Fault = {
        "message": f"the value of `{name}` is the text '{_short(value)}', not a number, in "
        f"{_told(found)}",
        "hint": f"Write {number}: decimals come after a point."
        if _is_number(number)
        else f"Give `{name}` a number.",
    }
    written = [
        (element, attribute)
        for element in sources.elements
        for attribute, text in element.attributes.items()
        if text == value and element.tag.startswith("xacro:")
    ]
    if len(written) == 1:
        element, attribute = written[0]
        fault |= {"file": str(element.file), "line": element.line_of(attribute)}
        fault |= {"element": f'{attribute}="{_short(value)}"'}
    return fault


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _with_values(found: Trace) -> Fault | None:
    values = ", ".join(f"{name} = {_short(repr(value))}" for name, value in found.values.items())
    if not values:
        return None
    return {"message": f"{message_of(found)} with {values}", "hint": USUAL}
