"""Explain an error of xacro: which file and line, what is wrong, and what to do.

`explain` first reads from the frames of the exception what xacro was expanding (`_Trace`), then
looks that up in the files (`_find_place`), and asks the explainers, each of which knows one kind of
exception and gives None for the others.

xacro's messages name neither the element nor the line. The frames of its functions hold the
element that was expanded, the attribute as it is written, and the values known at that moment.
The names of functions and variables are those of xacro 2.0 and 2.1; where a frame does not have
them, less is known and nothing breaks.
"""

from __future__ import annotations

import ast
import contextlib
import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypedDict
from xml.parsers.expat import ExpatError

from wsgen.text.files import (
    irregular_kind,
    read_regular,
    read_regular_text,
    save_as_utf8,
    wide_encoding,
)
from wsgen.text.markup import SIZE_LIMIT, elements, label, line_with, read_text, without_comments
from wsgen.text.suggestions import advice, did_you_mean, nearest
from wsgen.text.xmlsyntax import NAMESPACES, find_mistake

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from wsgen.text.markup import Written


class Explanation(TypedDict, total=False):
    """What is wrong; at least `message` is there."""

    message: str
    file: str | None
    line: int | None
    element: str | None
    hint: str
    missing: str  # a file that does not exist, of a package of which nothing exists
    package: str  # one that is not found


Frame = tuple[str, "Mapping[str, Any]"]  # function, its variables
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
LONGEST_QUOTE = 60  # characters of an expression or a value
USUAL = "Fix the xacro file; `xacro FILE` shows the same error."
MOST_SCOPES = 100  # deeper ones are cycles
PREFIX = re.compile(r"[<\s]([\w.-]+):[\w.-]+")  # of an element or attribute
ROOT = re.compile(r"<([\w.-]+)((?:\s[^<>]*)?)>")
PACKAGES = Path("share", "ament_index", "resource_index", "packages")  # below a prefix


def explain(error: BaseException, files: Iterable[str | None]) -> Explanation | None:
    """What is wrong where xacro raised an exception; None where xacro did not raise it.

    `files` are those that xacro has read, the one being expanded first.
    """
    found = _trace(error, files)
    if found is None or isinstance(error, (SystemExit, KeyboardInterrupt)):
        return None
    sources = _Sources(found.files)
    place = _find_place(found, sources) or _Place(found.files[0] if found.files else None)
    explanation: Explanation = {
        "message": _message_of(found),
        "file": place.file,
        "line": place.line,
        "element": _element(found),
        "hint": USUAL,
    }
    explanations = (explainer(found, sources) for explainer in _EXPLAINERS)
    explanation.update(next(filter(None, explanations), Explanation()))
    return explanation


def _element(found: _Trace) -> str | None:
    if found.expression is not None:
        return f"${{{found.expression}}}"
    if found.name is not None:
        return f"xacro:property[@name='{found.name}']"
    return getattr(found.node, "tagName", None)


def _message_of(found: _Trace) -> str:
    """What the first exception says, and about which expression."""
    text = " ".join(str(found.cause).split()) or repr(found.cause)
    return text if found.expression is None else f"{text}, in {_quoted(found)}"


def _quoted(found: _Trace) -> str:
    return f"`${{{_short(found.expression)}}}`"


def _short(value: object) -> str:
    text = " ".join(str(value).split())
    return text if len(text) <= LONGEST_QUOTE else f"{text[: LONGEST_QUOTE - 3]}..."


def _encoding(found: _Trace, _: _Sources) -> Explanation | None:
    error = found.cause
    if not isinstance(error, (UnicodeDecodeError, ExpatError)) or not found.files:
        return None
    explanation: Explanation = {"file": found.files[0], "element": None}
    try:  # again, because the exception counts from the piece that was read
        data = read_regular(Path(found.files[0]), SIZE_LIMIT)
        wide = wide_encoding(data)
        if wide:
            message = f"it is encoded in {wide}, and xacro reads UTF-8 only"
            return {**explanation, "message": message, "line": 1, "hint": save_as_utf8(wide)}
        data.decode("utf-8")
    except UnicodeDecodeError as again:
        return {
            **explanation,
            "message": f"the byte 0x{again.object[again.start]:02x} is not valid UTF-8",
            "line": again.object.count(b"\n", 0, again.start) + 1,
            "hint": f"{save_as_utf8('ISO-8859-1')} Perhaps it is in Latin-1.",
        }
    except OSError:
        pass
    return None


def _markup(found: _Trace, _: _Sources) -> Explanation | None:
    error = found.cause
    if not isinstance(error, ExpatError):
        return None
    if "unbound prefix" in str(error) and found.files:
        return _undeclared_prefix(Path(found.files[0]), error.lineno)
    file = found.files[0] if found.files else None
    text = None if file is None else read_text(Path(file))
    mistake = None if text is None else find_mistake(text.encode(), "utf-8")
    return {
        "message": f"not well-formed XML: {mistake.message if mistake else error}",
        "file": file,
        "line": mistake.line if mistake else error.lineno,
        "element": None,
        "hint": mistake.hint
        if mistake
        else "Check this line and the one before it: tags, quotes, '&' and '<'.",
    }


def _undeclared_prefix(file: Path, line: int) -> Explanation | None:
    """A prefix that the root element does not declare; most often that of xacro itself."""
    text = without_comments(read_text(file) or "")
    used = PREFIX.search(text.split("\n", line - 1)[-1])
    root = ROOT.search(text)
    if used is None or root is None:
        return None
    prefix, root_line = used[1], text.count("\n", 0, root.start()) + 1
    rest = " ".join(root[2].split())
    address = NAMESPACES.get(prefix, prefix)
    start = f'<{root[1]} xmlns:{prefix}="{address}"' + (f" {rest}>" if rest else ">")
    return {
        "message": f"line {line} uses the prefix `{prefix}:`, but <{root[1]}> in line {root_line} "
        "does not declare it",
        "file": str(file),
        "line": root_line,
        "element": str(root[1]),
        "hint": f"Write line {root_line} as {start}",
    }


def _file(found: _Trace, _: _Sources) -> Explanation | None:
    """A file that is included or loaded, or the first one."""
    error = found.cause
    if not isinstance(error, OSError) or not error.filename:
        return None
    path = os.path.normpath(os.fspath(error.filename))
    kind = irregular_kind(path)
    if kind is not None:
        return {
            "message": f"'{path}' is {kind}, not a regular file",
            "element": _element(found),
            "hint": "Name a regular file.",
        }
    share = re.match(r".*/share/[^/]+(?=/)", path)
    if not found.inside or (share and not Path(share[0]).is_dir()):
        return {"message": str(error), "missing": path}
    folder, name = Path(path).parent, Path(path).name
    while not folder.is_dir() and folder != folder.parent:
        folder, name = folder.parent, folder.name
    install = (
        "Check the spelling. If it is right, check that CMakeLists.txt installs the file, "
        "and run `wsgen build`."
    )
    is_include = getattr(found.node, "tagName", None) == "xacro:include"
    return {
        "message": f"{(error.strerror or 'cannot be read').lower()}: '{path}'",
        "element": found.node.getAttribute("filename") if is_include else _element(found),
        "hint": advice(name, sorted(entry.name for entry in folder.iterdir()), install),
    }


def _package(found: _Trace, _: _Sources) -> Explanation | None:
    if type(found.cause).__name__ != "PackageNotFoundError":
        return None
    # ament_index_python's has a sentence about the package in the place of its name.
    text = str(getattr(found.cause, "name", found.cause))
    quoted = re.search(r"package '([^']*)' not found", text)
    name = quoted[1] if quoted else text
    add = (
        f"Check the spelling. If it is right, add <exec_depend>{name}</exec_depend> to "
        "package.xml, and add the package to this workspace or install it."
    )
    return {
        "message": f"the package '{name}' is not found",
        "package": name,
        "element": name,
        "hint": advice(name, _packages(), add),
    }


def _packages() -> list[str]:
    """The packages that the environment has."""
    names: list[str] = []
    for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        index = Path(prefix, PACKAGES)
        if index.is_dir():
            names += sorted(entry.name for entry in index.iterdir())
    return names


def _recursion(found: _Trace, _: _Sources) -> Explanation | None:
    if not isinstance(found.cause, RecursionError):
        return None
    return {
        "message": "infinite recursion: a macro calls itself, or a file includes itself",
        "hint": "Wrap the call in <xacro:if> with a condition that becomes false.",
    }


def _attribute(found: _Trace, _: _Sources) -> Explanation | None:
    """An attribute that an element of xacro must have."""
    missing = re.search(r"missing attribute '([\w:]+)'", str(found.cause))
    tag = getattr(found.node, "tagName", None)
    if not missing or tag is None:
        return None
    misspelled = _misspelled(tag, dict(found.node.attributes.items()))
    write = f'Write <{tag} {missing[1]}="...">.'
    return {
        "message": f"<{tag}> has no attribute `{missing[1]}`"
        + ("" if misspelled is None else f", and does not know `{misspelled[0]}`"),
        "hint": write if misspelled is None else did_you_mean(misspelled[1]),
    }


def _misspelled(tag: str, attributes: Mapping[str, str]) -> tuple[str, str] | None:
    """An attribute that an element of xacro does not know, and the one that must be meant."""
    known = OWN_ELEMENTS.get(tag.removeprefix("xacro:"), ())
    for name in attributes:
        near = nearest(name, set(known) - attributes.keys())
        if name not in known and near is not None:
            return name, near
    return None


def _command(found: _Trace, _: _Sources) -> Explanation | None:
    """A command in $(…) that xacro does not know."""
    unknown = re.match(r"Unknown substitution command \[(.*?)\].*\[(.*?)\]", str(found.cause))
    if not unknown:
        return None
    command = unknown[1].partition(" ")[0]
    known = re.findall(r"'(\w+)'", unknown[2])
    return {
        "message": f"`$({_short(unknown[1])})`: xacro does not know the command `{command}`",
        "hint": advice(command, known, f"Write one of {', '.join(known)}."),
    }


def _name(found: _Trace, sources: _Sources) -> Explanation | None:
    """A name in an expression that is not defined."""
    undefined = re.match(r"name '(\w+)' is not defined", str(found.cause))
    if not undefined:
        return None
    name = undefined[1]
    later = next(sources.defining("property", name), None)
    plain = next(sources.defining("property", name, prefix=""), None)
    misspelled = None if later is None else _misspelled(later.tag, later.attributes)
    if later is not None and misspelled is not None:
        return {
            "message": f"the property `{name}` has no value: <{later.tag}> has no attribute "
            f"`{misspelled[0]}`",
            "file": str(later.file),
            "line": later.line_of(misspelled[0]),
            "element": f"xacro:property[@name='{name}']",
            "hint": did_you_mean(misspelled[1]),
        }
    if later is None and plain is not None:
        hint = f"Write <xacro:property> for <property> in line {plain.line} of {plain.file.name}."
    elif later is None:
        define = f'<xacro:property name="{name}" value="..."/>'
        hint = advice(name, found.names, f"Define it before its first use: {define}.")
    else:
        hint = (
            f"Define `{name}` above its first use and outside of macros: line {later.line} of "
            f"{later.file.name} does it too late, or where it is not known here."
        )
    return {"message": _message_of(found), "hint": hint}


def _argument(found: _Trace, sources: _Sources) -> Explanation | None:
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


def _macro(found: _Trace, sources: _Sources) -> Explanation | None:
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
            "message": f"Undefined parameters [{missing[1]}]: the macro `{name}` requires "
            "them, and this call does not set them",
            "hint": f"Write <xacro:{name} {given} ...>, or give defaults in the macro's params.",
        }
    wrong = re.match(r'Invalid parameter "(.*)"', text)
    if wrong:
        parameters = [
            parameter
            for macro in sources.defining("macro", name)
            for parameter in re.findall(r"(?:^|\s)([^\W\d]\w*)", macro.attributes.get("params", ""))
        ]
        return {
            "message": f'Invalid parameter "{wrong[1]}": the macro `{name}` has no such parameter',
            "hint": advice(
                wrong[1], parameters, f"Use one of its parameters: {', '.join(parameters)}."
            )
            if parameters
            else "Remove it.",
        }
    return None


def _unknown_macro(found: _Trace, sources: _Sources, name: str) -> Explanation:
    later = next(sources.defining("macro", name), None)
    include = "Include the file that defines the macro before its first use."
    return {
        "message": f"unknown macro name: xacro:{name}",
        "hint": advice(name, (*OWN_ELEMENTS, *found.macros), include)
        if later is None
        else f"Move line {later.line} of {later.file.name}, which defines it, above its first use.",
    }


def _expression_or_value(found: _Trace, sources: _Sources) -> Explanation | None:
    """An invalid expression, or one whose values do not fit."""
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
            "hint": "Rename one of them: xacro evaluates a property where it is used.",
        }
    if found.expression is None:
        return None
    return _text_for_number(found, sources) or _with_values(found)


def _text_for_number(found: _Trace, sources: _Sources) -> Explanation | None:
    texts = [(name, value) for name, value in found.values.items() if isinstance(value, str)]
    if not texts or not isinstance(found.cause, (TypeError, ValueError)):
        return None
    name, value = texts[0]
    number = value.strip().replace(",", ".")
    explanation: Explanation = {
        "message": f"the value of `{name}` is the text '{_short(value)}', not a number, in "
        f"{_quoted(found)}",
        "hint": f"Write {number}: with a decimal point."
        if _is_number(number)
        else f"Set `{name}` to a number.",
    }
    written = [
        (element, attribute)
        for element in sources.elements
        for attribute, text in element.attributes.items()
        if text == value and element.tag.startswith("xacro:")
    ]
    if len(written) == 1:
        element, attribute = written[0]
        explanation |= {"file": str(element.file), "line": element.line_of(attribute)}
        explanation |= {"element": f'{attribute}="{_short(value)}"'}
    return explanation


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _with_values(found: _Trace) -> Explanation | None:
    values = ", ".join(f"{name} = {_short(repr(value))}" for name, value in found.values.items())
    if not values:
        return None
    is_power = "for ^" in str(found.cause)
    return {
        "message": f"{_message_of(found)} with {values}",
        "hint": "Write `**` for a power: `x**2`." if is_power else USUAL,
    }


_EXPLAINERS: tuple[Callable[[_Trace, _Sources], Explanation | None], ...] = (
    _encoding,
    _markup,
    _file,
    _package,
    _recursion,
    _attribute,
    _command,
    _name,
    _argument,
    _macro,
    _expression_or_value,
)


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
            texts.append(read_regular_text(Path(file), errors="replace"))
    written = "\n".join(texts)
    # A condition may leave out the place that declares or uses an argument.
    places = r"""(?:xacro:arg\s[^>]*name\s*=\s*["']|\(\s*arg\s+|arg\(\s*["']){}\b"""
    has = "It has " + (", ".join(f"`{name}`" for name in declared) or "no arguments") + "."
    return [
        {
            "name": name,
            "message": f"The xacro file has no argument `{name}`: xacro ignores the value.",
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


class _Place(NamedTuple):
    """A line of a file."""

    file: str | None
    line: int | None = None  # 1-based


class _Sources:
    """The files that xacro read, and the elements that are written in them."""

    def __init__(self, files: tuple[str, ...]) -> None:
        self.files = files
        self.texts = {file: text for file in files if (text := read_text(Path(file))) is not None}
        self.elements = [
            element for file, text in self.texts.items() for element in elements(Path(file), text)
        ]

    def defining(self, tag: str, name: str, prefix: str = "xacro:") -> Iterator[Written]:
        """The elements `<xacro:tag name="…">` that define a name."""
        for element in self.elements:
            if element.tag == f"{prefix}{tag}" and element.attributes.get("name") == name:
                yield element

    def names(self, tag: str) -> list[str]:
        """What is defined by elements `<xacro:tag name="…">`."""
        return [
            element.attributes.get("name", "")
            for element in self.elements
            if element.tag == f"xacro:{tag}"
        ]


def _find_place(found: _Trace, sources: _Sources) -> _Place | None:
    """The line of what xacro was at; None where it is not known, rather than a wrong one.

    Elements that are written alike are taken for the first of them.
    """
    if found.name is not None:
        return _property(found, sources)
    if getattr(found.node, "data", None) is not None:
        wanted = found.node.data.strip()
        for file, text in sources.texts.items():
            line = line_with(text, wanted)
            if line is not None:
                into = wanted[: max(0, wanted.find("$"))].count("\n")
                return _Place(file, line + into)
        return None
    if getattr(found.node, "tagName", None) is None:
        return None
    # Of those that may be it, the one whose attributes are those of the element, if there is one.
    now = found.node.attributes
    alike = [element for element in sources.elements if _is_written_as(found, element)]
    element = max(
        alike,
        key=lambda one: sum(
            name in now and now[name].value == text for name, text in one.attributes.items()
        ),
        default=None,
    )
    if element is None:
        return None
    line = element.line if found.attribute is None else element.line_of(found.attribute)
    return _Place(str(element.file), line)


def _property(found: _Trace, sources: _Sources) -> _Place | None:
    for element in sources.defining("property", str(found.name)):
        for attribute in ("value", "default"):
            if element.attributes.get(attribute) == found.raw:
                return _Place(str(element.file), element.line_of(attribute))
    return None


def _is_written_as(found: _Trace, element: Written) -> bool:
    """Whether a DOM element, some of whose attributes are values already, is this one."""
    node = found.node
    path = _path(node)
    if element.path[-len(path) :] != path:
        return False
    if found.raw is not None and element.attributes.get(str(found.attribute)) != found.raw:
        return False
    now = _without_own(dict(node.attributes.items()))
    written = _without_own(element.attributes)
    return now.keys() == written.keys() and all(
        "$" in text or now[name] in {text, ""}  # xacro empties what it has given to a macro
        for name, text in written.items()
    )


def _without_own(attributes: Mapping[str, str]) -> dict[str, str]:
    """The attributes without those that xacro itself takes away or moves."""
    own = ("xacro:", "xmlns")
    return {name: text for name, text in attributes.items() if not name.startswith(own)}


def _path(node: Any) -> tuple[str, ...]:
    path = []
    while getattr(node, "tagName", None) is not None:
        path.append(label(node.tagName, node.getAttribute("name")))
        node = node.parentNode
    return tuple(reversed(path))


class _Trace(NamedTuple):
    """What xacro was at."""

    cause: BaseException  # the first exception
    inside: bool  # a document was being expanded, not only opened
    files: tuple[str, ...]  # that the element may be written in, likeliest first
    node: Any = None  # DOM element or text that was expanded; its attributes partly are values
    attribute: str | None = None  # of the element
    raw: str | None = None  # that attribute, or the value of `name`, as written
    name: str | None = None  # the property whose value was looked for
    expression: str | None = None  # the innermost one, without ${}
    values: Mapping[str, Any] = {}  # of the names in the expression
    names: tuple[str, ...] = ()  # all that an expression may use here
    macros: tuple[str, ...] = ()  # that are defined here


def _trace(error: BaseException, files: Iterable[str | None]) -> _Trace | None:
    """What xacro was at when it raised `error`; None where the error is not from xacro.

    `files` are those that xacro has read, the one being expanded first.
    """
    frames = list(_frames(error))
    if not frames:
        return None
    place = next((place for frame in reversed(frames) if (place := _place(*frame))), {})
    return _Trace(
        cause=_first(error),
        inside=any(function == "eval_all" for function, _ in frames),
        files=tuple(dict.fromkeys(_files(frames, place.get("node"), files))),
        **place,
        **_expression(frames),
        macros=_keys(next(_all(frames, "macros"), None)),
    )


def _first(error: BaseException) -> BaseException:
    """The exception that the first XacroException was made of."""
    while isinstance(getattr(error, "exc", None), BaseException):
        error = error.exc  # type: ignore[attr-defined]  # as the line before says
    return error


def _frames(error: BaseException) -> Iterator[Frame]:
    """The calls inside xacro that led to the first exception, outermost first."""
    while True:
        step = error.__traceback__
        while step is not None:
            frame = step.tb_frame
            if frame.f_globals.get("__name__") == "xacro":
                yield frame.f_code.co_name, frame.f_locals
            step = step.tb_next
        wrapped = getattr(error, "exc", None)
        if not isinstance(wrapped, BaseException):
            return
        error = wrapped


def _place(function: str, known: Mapping[str, Any]) -> dict[str, Any]:
    """What a call was expanding; empty where this function does not know."""
    if function == "_resolve_" and isinstance(known.get("self"), dict):
        raw = dict.get(known["self"], known.get("key"))
        return {"name": known.get("key"), "raw": raw if isinstance(raw, str) else None}
    if function == "eval_default_arg" and known.get("macro") is not None:
        return {"node": known["macro"].body, "attribute": "params"}
    if function in {"grab_property", "grab_macro", "process_include"}:
        return {"node": known.get("elt")}
    if function == "handle_macro_call":
        in_parameters = "block" not in known and known.get("params") is not None
        return _of_attribute(known) if in_parameters else {"node": known.get("node")}
    if function == "eval_all":  # which evaluates the attributes first, then what is inside
        return {"node": known.get("node")} if "next" in known else _of_attribute(known)
    return {}


def _of_attribute(known: Mapping[str, Any]) -> dict[str, Any]:
    return {"node": known.get("node"), "attribute": known.get("name"), "raw": known.get("value")}


def _expression(frames: list[Frame]) -> dict[str, Any]:
    """The innermost expression with the values of its names, and all names that it may use."""
    for function, known in reversed(frames):
        if function == "handle_expr":
            expression, symbols = known.get("s"), known.get("symbols")
            return {
                "expression": expression,
                "values": {
                    name: dict.__getitem__(scope, name)
                    for name in _names_in(str(expression))
                    for scope in [_scope_of(name, symbols)]
                    if scope is not None
                },
                "names": (*_keys(symbols), *map(str, getattr(symbols, "root", ()))),
            }
    return {}


def _names_in(expression: str) -> list[str]:
    try:
        tree = ast.parse(expression.strip(), mode="eval")
    except (SyntaxError, ValueError):
        return []
    found = [(node.col_offset, node.id) for node in ast.walk(tree) if isinstance(node, ast.Name)]
    return [name for _, name in dict.fromkeys(sorted(found))]


def _scopes(symbols: Any) -> Iterator[dict[str, Any]]:
    """The tables of a name's scope and of those around it, without xacro's own symbols."""
    for _ in range(MOST_SCOPES):
        if not isinstance(symbols, dict) or not hasattr(symbols, "parent"):
            return
        yield symbols
        symbols = symbols.parent


def _scope_of(name: str, symbols: Any) -> dict[str, Any] | None:
    return next((scope for scope in _scopes(symbols) if dict.__contains__(scope, name)), None)


def _keys(table: Any) -> tuple[str, ...]:
    names = [str(name) for scope in _scopes(table) for name in dict.keys(scope)]
    return tuple(name for name in dict.fromkeys(names) if not name.startswith("*"))


def _all(frames: list[Frame], variable: str) -> Iterator[Any]:
    """The values of a variable, innermost call first."""
    for _, known in reversed(frames):
        if known.get(variable) is not None:
            yield known[variable]


def _files(frames: list[Frame], node: Any, read: Iterable[str | None]) -> Iterator[str]:
    """Files that the node may be written in, likeliest first."""
    top = node
    while getattr(top, "parentNode", None) is not None:
        top = top.parentNode
    for opened in _all(frames, "inp"):  # that could not be read
        name = getattr(opened, "name", None)
        if isinstance(name, (str, os.PathLike)):
            yield os.fspath(name)
    for known in (node, *_all(frames, "node")):
        file = getattr(getattr(known, "ownerDocument", None), "wsgen_file", None)  # see `Watch`
        if file is not None:
            yield file
    if getattr(top, "tagName", None) == "xacro:macro":
        for macro in _all(frames, "m"):
            yield from (file for file in getattr(macro, "history", [[]])[-1][-1:] if file)
    yield from (file for file in read if file)
