"""Expand a xacro file in a child process; say in which file and line what is wrong is written.

xacro keeps no line numbers: an element of the expanded text is looked up by its name in the file
that was expanded and in those that it includes. A name that xacro puts together is found by its
pattern, for example `${prefix}base_link`.
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wsgen.descriptions.rules import NOT_A_NUMBER
from wsgen.descriptions.xacro.result import Expansion, ExpansionError, ExpansionRequest
from wsgen.diagnostics import Rule, Severity
from wsgen.isolation import parent
from wsgen.isolation.codec import decode
from wsgen.isolation.result import Died, Limits
from wsgen.launching.launch_warnings import UNUSED_XACRO_ARGUMENT
from wsgen.packages.source_shares import name_sources
from wsgen.text.markup import elements, read_text
from wsgen.text.values import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from wsgen.diagnostics import Diagnostic
    from wsgen.isolation.parent import Run
    from wsgen.isolation.result import Answered
    from wsgen.model.package import ShareOf
    from wsgen.text.markup import Written


FIND = lazy_pattern(r"\$\(find\s+([\w-]+)\s*\)")
COMPUTED = lazy_pattern(r"\$\{[^}]*\}|\$\([^)]*\)")  # by xacro
NAMED = lazy_pattern(r"(\w+)\[@(\w+)='([^']*)'\]")  # link[@name='base_link']
ONE_NAME = lazy_pattern(r"\s*\$\{\s*(\w+)\s*\}\s*")  # the value of a property, and nothing else
USED = lazy_pattern(r"\$\{\s*(\w+)\s*\}|\$\(arg\s+(\w+)\s*\)")  # a property or an argument
STEP = lazy_pattern(r"(?:[^/'\[]|\[@\w+='[^']*'\])+")
PROPERTY = "xacro:property"
MACRO = "xacro:macro "  # before its name, in a path
PARTS = frozenset(("link", "joint"))
CALLED = lazy_pattern(r" The macro `[^`]*` is called in line \d+(?: of \S+)?\.$")
OTHERS = frozenset(("ros2_control", "transmission", "gazebo"))  # have parts of the same names
MOST_FILES = 100  # a description in more files than this includes itself


def place_in_source(
    diagnostics: Iterable[Diagnostic],
    *,
    text: str,
    file: Path | None,
    share_of: ShareOf,
    written: list[Written] | None = None,
) -> tuple[Diagnostic, ...]:
    """Give diagnostics about `text`, which `file` expanded to, their places in the edited files.

    A file that holds the text itself keeps the lines. Where an element is not found by its name,
    or several could be meant, the diagnostic names the file only. `written` are the elements of
    the file and of what it includes, if they are known.
    """
    found = tuple(diagnostics)
    if not found or file is None:
        return tuple(replace(diagnostic, line=None) for diagnostic in found)
    if read_text(file) == text:
        return found
    written = written_elements(file, share_of) if written is None else written
    expanded = elements(file, text)
    placed = (_placed(diagnostic, written, expanded) for diagnostic in found)
    # A mistake in a property is found wherever the property is used.
    return tuple(
        {
            (one.code, one.file, one.line, one.element)
            if (one.element or "").startswith(PROPERTY)
            else one: one
            for one in placed
        }.values()
    )


def _placed(diagnostic: Diagnostic, written: list[Written], expanded: list[Written]) -> Diagnostic:
    path = diagnostic.element or ""
    for named in NAMED.finditer(path):
        tag, attribute, value = named.groups()
        # A joint in <ros2_control> has the name of one outside.
        candidates = [
            element for element in written if element.tag == tag and not _is_in_another(element)
        ]
        element = _most_like(value, attribute, candidates, written)
        if element is None:
            continue
        tags = _steps(path[named.end() :])
        last = tags.pop()[1:] if tags and tags[-1].startswith("@") else ""
        alike = _alike(tag, attribute, element.attributes.get(attribute), written)
        owns = _alike(tag, attribute, value, expanded)
        if len(alike) != len(owns):
            alike, owns = [element], owns[:1]
        inner = [inside for one in alike for inside in _inside(one, tags, written)]
        origins = [inside for one in owns for inside in _inside(one, tags, expanded)]
        # Of several alike, that with the same number, if xacro made none and left none out.
        place, origin = element, None
        for at, one in enumerate(origins):
            if (one.line == diagnostic.line or len(origins) == 1) and len(inner) == len(origins):
                place, origin = inner[at], one
        called = _with_call(diagnostic, element, attribute, value, written)
        if tags and not inner and (there := _in_called_macro(element, tags, written)) is not None:
            place, call = there
            return replace(
                called,
                message=f"{diagnostic.message} {_of_call(call, place)}",
                file=place.file,
                line=place.line_of(last) if last else place.line,
            )
        if last and origin is not None:
            return _at_attribute(called, last, place, origin, written)
        return replace(called, file=place.file, line=place.line)
    alone = [one for one in written if path and "[" not in path and _plain_path(one) == path]
    if len(alone) == 1:
        return replace(diagnostic, file=alone[0].file, line=alone[0].line)
    return replace(diagnostic, line=None)


def _plain_path(element: Written) -> str:
    """The path of an element in a robot, below what xacro makes of it."""
    steps = [step for step in element.path if not step.startswith("xacro:")]
    return "/".join(step for step in steps[1:] if step)


def without_call(diagnostic: Diagnostic) -> Diagnostic:
    """The diagnostic without the call of a macro, of which several robots may have one each."""
    return replace(diagnostic, message=CALLED.sub("", diagnostic.message))


def _with_call(
    diagnostic: Diagnostic, element: Written, attribute: str, value: str, written: list[Written]
) -> Diagnostic:
    """The diagnostic with the call of the macro that the element is in, if one call gives it."""
    macro = _macro_of(element)
    pattern = element.attributes.get(attribute, "")
    calls = [one for one in _calls(macro, written) if _gives(pattern, one.attributes, value)]
    if len(calls) != 1:
        return diagnostic
    return replace(diagnostic, message=f"{diagnostic.message} {_of_call(calls[0], element)}")


def _of_call(call: Written, element: Written) -> str:
    """Where the macro is called that the element is in."""
    where = "" if call.file == element.file else f" of {call.file.name}"
    return f"The macro `{_called(call)}` is called in line {call.line}{where}."


def _macro_of(element: Written) -> str | None:
    """The macro that the element is written in."""
    macros = [step for step in element.path[:-1] if step.startswith(MACRO)]
    return macros[-1].removeprefix(MACRO) if macros else None


def _calls(macro: str | None, written: Iterable[Written]) -> list[Written]:
    """The calls of a macro."""
    return [one for one in written if one.tag.startswith("xacro:") and _called(one) == macro]


def _called(call: Written) -> str:
    """The name of the macro, without that of its file's namespace."""
    return call.tag.rpartition(":")[2].rpartition(".")[2]


def _in_called_macro(
    element: Written, tags: list[str], written: list[Written]
) -> tuple[Written, Written] | None:
    """What a path leads to in a macro that is called in the element, and the call, if it is one."""
    found = []
    for call in _below(element, written):
        between = [step for step in call.path[len(element.path) : -1] if ":" not in step]
        if not call.tag.startswith("xacro:") or tags[: len(between)] != between:
            continue
        for macro in written:
            if macro.tag == "xacro:macro" and macro.attributes.get("name") == _called(call):
                inside = _inside(macro, tags[len(between) :], written)
                found += [(one, call) for one in inside if one is not macro]
    return found[0] if len(found) == 1 else None


def _is_made(element: Written, attribute: str, value: str, written: Iterable[Written]) -> bool:
    """Whether a call of its macro surely gives an element this value."""
    pattern = element.attributes.get(attribute, "")
    used = [ONE_NAME.fullmatch(one[0]) for one in COMPUTED.finditer(pattern)]
    names = {one[1] for one in used if one is not None}
    return len(used) > 0 and any(
        all("$" not in call.attributes.get(name, "$") for name in names)
        and None not in used
        and _gives(pattern, call.attributes, value)
        for call in _calls(_macro_of(element), written)
    )


def _gives(pattern: str, arguments: Mapping[str, str], value: str) -> bool:
    """Whether a name in a macro can become the value with these arguments of its call."""
    pieces, end = [], 0
    for computed in COMPUTED.finditer(pattern):
        pieces.append(re.escape(pattern[end : computed.start()]))
        used = ONE_NAME.fullmatch(computed[0])
        argument = arguments.get(used[1]) if used else None
        is_known = argument is not None and "$" not in argument
        pieces.append(re.escape(argument or "") if is_known else ".*")
        end = computed.end()
    pieces.append(re.escape(pattern[end:]))
    return re.fullmatch("".join(pieces), value, re.DOTALL) is not None


def _alike(tag: str, attribute: str, value: str | None, document: list[Written]) -> list[Written]:
    """The elements with this value; several `<gazebo>` may refer to the same link."""
    return [one for one in document if one.tag == tag and one.attributes.get(attribute) == value]


def _is_in_another(element: Written) -> bool:
    return element.tag in PARTS and any(tag in OTHERS for tag in element.path[:-1])


def _steps(path: str) -> list[str]:
    """The steps of a path, of which those with names may have slashes in them."""
    return STEP.findall(path)


def _inside(element: Written, steps: list[str], document: list[Written]) -> list[Written]:
    """The elements that a path leads to from an element; itself if there are no steps.

    A name in the last step distinguishes elements.
    """
    depth = len(element.path)
    tags = [step.partition("[")[0] for step in steps]
    named = NAMED.fullmatch(steps[-1]) if steps else None
    found = [
        one
        for one in (element, *_below(element, document))
        if [tag for tag in one.path[depth:] if not tag.startswith("xacro:")] == tags
    ]
    if named is None:
        return found
    _, attribute, value = named.groups()
    meant = _most_like(value, attribute, found, document)
    return [] if meant is None else [meant]


def _below(element: Written, document: list[Written]) -> Iterator[Written]:
    """The elements in an element."""
    start = next(place for place, one in enumerate(document) if one is element)
    for one in document[start + 1 :]:
        if len(one.path) <= len(element.path) or one.file != element.file:
            return
        yield one


def _at_attribute(
    diagnostic: Diagnostic, attribute: str, place: Written, origin: Written, written: list[Written]
) -> Diagnostic:
    """The diagnostic at the attribute, or at the property that its whole value is."""
    raw = place.attributes.get(attribute, "")
    used = ONE_NAME.fullmatch(raw) if diagnostic.code == NOT_A_NUMBER.code else None
    value = origin.attributes.get(attribute)
    defined = [
        (one, key)
        for one in written
        for key in ("value", "default")
        if used
        and one.tag == PROPERTY
        and one.attributes.get("name") == used[1]
        and one.attributes.get(key) == value
    ]
    if len(defined) != 1:
        return replace(diagnostic, file=place.file, line=place.line_of(attribute))
    definition, key = defined[0]
    return replace(
        diagnostic,
        file=definition.file,
        line=definition.line_of(key),
        element=f"{PROPERTY}[@name='{definition.attributes.get('name')}']/@{key}",
    )


def _most_like(
    value: str, attribute: str, candidates: list[Written], written: list[Written]
) -> Written | None:
    """The element whose name is the value, or can become it with the fewest letters computed.

    Of several, it is the one in a macro of which a call gives that name.
    """
    likeness: dict[int, list[Written]] = {}
    for element in candidates:
        name = element.attributes.get(attribute, "")
        if name == value:
            return element
        literal = COMPUTED.split(name)
        letters = sum(map(len, literal))
        if len(literal) > 1 and re.fullmatch(".*".join(map(re.escape, literal)), value, re.DOTALL):
            likeness.setdefault(letters, []).append(element)
    for letters in sorted(likeness, reverse=True):
        best = likeness[letters]
        if letters and len(best) == 1:
            return best[0]
        made = [one for one in best if _is_made(one, attribute, value, written)]
        if made or letters:
            return made[0] if len(made) == 1 else None
    return None


def written_elements(main: Path, share_of: ShareOf) -> list[Written]:
    """The elements of the file and of what it includes, as far as the addresses are known."""
    written: list[Written] = []
    waiting = [main]
    seen: set[Path] = set()
    while waiting and len(seen) < MOST_FILES:
        file = waiting.pop(0)
        text = None if file in seen else read_text(file)
        seen.add(file)
        if text is None:
            continue
        here = elements(file, text)
        written += here
        addresses = [
            element.attributes.get("filename", "")
            for element in here
            if element.tag == "xacro:include"
        ]
        values = {
            one.attributes.get("name"): one.attributes.get("value", one.attributes.get("default"))
            for one in written
            if one.tag in (PROPERTY, "xacro:arg")
        }
        known = (_with_values(uri, values) for uri in addresses)
        waiting += filter(None, (_included(uri, file, share_of) for uri in known))
    return written


def _with_values(uri: str, values: Mapping[str | None, str | None]) -> str:
    """An address with the properties and the arguments in it, as far as they are known."""
    return USED.sub(lambda used: values.get(used[1] or used[2]) or used[0], uri)


def _included(uri: str, by: Path, share_of: ShareOf) -> Path | None:
    package = FIND.match(uri)
    if package is not None:
        share = share_of(package.group(1))
        uri = uri[package.end() :].lstrip("/")
        return None if share is None or "$" in uri else share / uri
    return None if "$" in uri else by.parent / uri


TASK = "wsgen.descriptions.xacro.expansion:expand_for_parent"
ANSWER: Any = Expansion | ExpansionError
LIMITS = Limits(seconds=30.0, memory=2 * 2**30)

XACRO_FILE_FAILS = Rule(
    code="ROB071",
    name="xacro-file-fails",
    severity=Severity.ERROR,
    summary="`xacro` cannot expand the file.",
    why=("The launch file stops with the same error, and the robot is not spawned."),
    example='<xacro:property name="radius" value="0,1"/>\n'
    '<cylinder radius="${radius / 2}" length="0.1"/>',
    instead='<xacro:property name="radius" value="0.1"/>',
)


def expand_file(
    file: Path,
    arguments: Mapping[str, str],
    *,
    environment: Mapping[str, str],
    run: Run = parent.run,
) -> tuple[str | None, tuple[Diagnostic, ...]]:
    """The URDF that a xacro file expands to with these arguments; None where it does not.

    A xacro file may hold expressions that never end, and its expressions are Python: it is expanded
    in a child process with limits.
    """
    outcome = _expand(file, arguments, environment, run)
    if isinstance(outcome, Died):
        hint = outcome.hint("Check the file for an endless recursion or a huge expression.")
        error = ExpansionError(message=f"Expanding the file {outcome.reason}", hint=hint)
        return None, (_diagnostic(file, error),)
    answer: Expansion | ExpansionError = decode(name_sources(outcome.value, environment), ANSWER)
    if isinstance(answer, ExpansionError):
        return None, (_diagnostic(file, answer),)
    return answer.urdf, tuple(
        UNUSED_XACRO_ARGUMENT.at(
            file, element=unused.name, message=unused.message, hint=unused.hint
        )
        for unused in answer.unused
    )


def read_arguments(
    file: Path,
    arguments: Mapping[str, str],
    *,
    environment: Mapping[str, str],
    run: Run = parent.run,
) -> Mapping[str, str]:
    """The `<xacro:arg>`s of a file and of what it includes, with the values that they then have.

    They are those that an expansion with these arguments comes by; none where that fails.
    """
    outcome = _expand(file, arguments, environment, run)
    if isinstance(outcome, Died):
        return {}
    answer: Expansion | ExpansionError = decode(name_sources(outcome.value, environment), ANSWER)
    return answer.arguments if isinstance(answer, Expansion) else {}


def _expand(
    file: Path, arguments: Mapping[str, str], environment: Mapping[str, str], run: Run
) -> Answered | Died:
    return run(
        TASK,
        ExpansionRequest(file=str(file.absolute()), arguments=dict(arguments)),
        limits=LIMITS,
        environment=environment,
        folder=file.parent,
    )


def _diagnostic(file: Path, error: ExpansionError) -> Diagnostic:
    message = error.message.rstrip(".")
    hint = error.hint or "Set arguments of the file with --arg name:=value."
    if "AMENT_PREFIX_PATH" in message:
        hint = "Build and source a workspace that contains the packages of $(find …)."
        message = "a package of $(find …) was not found: no workspace is sourced"
    return XACRO_FILE_FAILS.at(
        Path(error.file) if error.file else file,
        error.line,
        error.element,
        message=f"xacro cannot expand the file: {message}.",
        hint=hint,
    )
