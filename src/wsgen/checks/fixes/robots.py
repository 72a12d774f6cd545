"""Fixes in URDF, xacro and SDF."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

from wsgen.checks.fixes.source import Edit, children, find_tag, is_surely, read_tags
from wsgen.text.suggestions import suggested

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from wsgen.checks.fixes.source import SourceText, Span, Tag
    from wsgen.diagnostics import Diagnostic


NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
DECIMAL_COMMA = re.compile(r"[+-]?\d+,\d+")
COMPUTED = re.compile(r"\$\{|\$\(|&\w+;")  # by xacro, or an entity
# How many numbers an attribute or element has; others have one.
COUNTS = {"xyz": 3, "rpy": 3, "size": 3, "scale": 3, "rgba": 4, "fdir1": 3}
TRUE = frozenset(("true", "on", "yes", "1"))
FALSE = frozenset(("false", "off", "no", "0"))
BYTE = 255
URDF_VERSION = "1.0"
SDF_VERSION = "1.6"  # the oldest that all supported Gazebos read without a conversion


def _replace(span: Span, text: str) -> list[Edit]:
    return [Edit(start=span.start, end=span.end, text=text)]


def _value(diagnostic: Diagnostic, source: SourceText, attribute: str = "") -> Span | None:
    """Where the value is that a diagnostic is about: an attribute or the text of an element."""
    found = find_tag(source, diagnostic.line, diagnostic.element)
    if found is None:
        return None
    tag, last = found
    written = tag.attributes.get(attribute or last)
    if written is not None:
        span = written.value
    elif attribute or last or tag.end is None:
        return None
    else:
        span = tag.content()
    text = source.text[span.start : span.end]
    return None if COMPUTED.search(text) or "<" in text else _stripped(span, text)


def _stripped(span: Span, text: str) -> Span:
    start = span.start + len(text) - len(text.lstrip())
    return span._replace(start=start, end=max(start, span.end - (len(text) - len(text.rstrip()))))


def fix_axis(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Divide an axis by its length."""
    span = _value(diagnostic, source, "xyz") or _value(diagnostic, source)
    numbers = span and source.text[span.start : span.end].split()
    if not span or not numbers or not all(map(NUMBER.fullmatch, numbers)):
        return []
    values = [float(number) for number in numbers]
    length = math.hypot(*values)
    if len(values) != COUNTS["xyz"] or not 0 < length < math.inf:
        return []
    return _replace(span, " ".join(f"{value / length + 0.0:.6g}" for value in values))


def fix_limits(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Swap the lower and the upper limit."""
    found = find_tag(source, diagnostic.line, diagnostic.element)
    if found is None:
        return []
    tags = {tag.name: tag for tag in children(read_tags(source.text), found[0])}
    spans = [
        attribute.value if (attribute := found[0].attributes.get(name)) else tags[name].content()
        for name in ("lower", "upper")
        if name in found[0].attributes or name in tags
    ]
    texts = [source.text[span.start : span.end] for span in spans]
    if len(spans) != len(("lower", "upper")) or not all(map(_is_number, texts)):
        return []
    return [*_replace(spans[0], texts[1]), *_replace(spans[1], texts[0])]


def _is_number(text: str) -> bool:
    return NUMBER.fullmatch(text.strip()) is not None


def fix_color(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Divide a color by 255 if its components are bytes."""
    span = _value(diagnostic, source, "rgba") or _value(diagnostic, source)
    words = source.text[span.start : span.end].split() if span else []
    if span is None or len(words) != COUNTS["rgba"] or not all(map(_is_number, words)):
        return []
    *rgb, alpha = (float(word) for word in words)
    # 1 and less could be meant as it is; what is above 1 and whole can only be a byte.
    if max(rgb) <= 1 or any(one != int(one) or not 0 <= one <= BYTE for one in rgb):
        return []
    last = words[-1] if 0 <= alpha <= 1 else f"{round(alpha / BYTE, 3):g}"
    if not 0 <= alpha <= BYTE:
        return []
    return _replace(span, " ".join([*(f"{round(one / BYTE, 3):g}" for one in rgb), last]))


def fix_number(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write decimal commas as points, and commas between numbers as blanks."""
    found = find_tag(source, diagnostic.line, diagnostic.element)
    span = _value(diagnostic, source)
    if found is None or span is None:
        return []
    tag, attribute = found
    text = source.text[span.start : span.end]
    count = COUNTS.get(attribute or tag.name, 1)
    words = text.split()
    if len(words) == count:
        fixed = [
            word.replace(",", ".") if DECIMAL_COMMA.fullmatch(word) else word.rstrip(",;")
            for word in words
        ]
    else:  # with blanks as well, the commas could be either
        fixed = re.split(r"[,;]", text) if len(words) == 1 else words
    if len(fixed) != count or not all(map(NUMBER.fullmatch, fixed)) or fixed == words:
        return []
    return _replace(span, " ".join(fixed))


def fix_boolean(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write `true` or `false` for what means it."""
    span = _value(diagnostic, source)
    word = source.text[span.start : span.end].casefold() if span else ""
    if span is None or word not in TRUE | FALSE:
        return []
    return _replace(span, "true" if word in TRUE else "false")


def rename_value(attribute: str = "") -> Callable[[Diagnostic, SourceText], Sequence[Edit]]:
    """The fix that writes the suggested name as the value of an attribute, or as the text."""

    def fix(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
        meant = suggested(diagnostic.hint)
        span = _value(diagnostic, source, attribute)
        if meant is None or span is None:
            return []
        written = source.text[span.start : span.end]
        return _replace(span, meant) if written != meant and is_surely(written, meant) else []

    return fix


_NAMED_END = re.compile(r"The (parent|child) of the joint `[^`]*` is `([^`]+)`")


def fix_link(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested link where a joint names one that does not exist."""
    meant = suggested(diagnostic.hint)
    found = find_tag(source, diagnostic.line, diagnostic.element)
    named = _NAMED_END.search(diagnostic.message)
    if meant is None or found is None or named is None or not is_surely(named[2], meant):
        return []
    for tag in children(read_tags(source.text), found[0]):
        written = tag.attributes.get("link")
        if tag.name == named[1] and written is not None and written.text == named[2]:
            return _replace(written.value, meant)
    return []


_NAMED_JOINT = re.compile(r"names the joint `([^`]+)`")
_INTERFACE = re.compile(r"has the (\w+) interface `([^`]+)`")
_WRITE_NAME = re.compile(r'Write <\w+ name="([^"]+)"/>')
_WRITE_TEXT = re.compile(r"Write <(\w+)>([^<]+)</\1>")


def fix_joint(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the suggested joint in <ros2_control> and <transmission>."""
    named, meant = _NAMED_JOINT.search(diagnostic.message), suggested(diagnostic.hint)
    if named is None or meant is None or not is_surely(named[1], meant):
        return []
    found = [
        written
        for tag in read_tags(source.text)
        if tag.name == "joint" and {"ros2_control", "transmission"} & {one.name for one in tag.path}
        if (written := tag.attributes.get("name")) is not None and written.text == named[1]
    ]
    return _replace(found[0].value, meant) if len(found) == 1 else []


def fix_interface(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the interface that the hint names, for the joint of <ros2_control> on the line."""
    named, meant = _INTERFACE.search(diagnostic.message), _WRITE_NAME.search(diagnostic.hint or "")
    if named is None or meant is None or not is_surely(named[2], meant[1]):
        return []
    found = [
        written
        for tag in read_tags(source.text)
        if tag.name == f"{named[1]}_interface" and tag.path
        if source.line_at(tag.path[-1].start.start) <= (diagnostic.line or 0)
        if source.line_at(tag.start.end) >= (diagnostic.line or 0)
        if (written := tag.attributes.get("name")) is not None and written.text == named[2]
    ]
    return _replace(found[0].value, meant[1]) if len(found) == 1 else []


def fix_inner_text(tag_name: str) -> Callable[[Diagnostic, SourceText], Sequence[Edit]]:
    """The fix that writes what the hint says as the text of the element meant, or of one in it."""

    def fix(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
        found = find_tag(source, diagnostic.line, diagnostic.element)
        meant = _WRITE_TEXT.search(diagnostic.hint or "")
        if found is None or meant is None or meant[1] != tag_name:
            return []
        inner = [
            tag
            for tag in read_tags(source.text)
            if tag.name == tag_name and any(one.start == found[0].start for one in (*tag.path, tag))
        ]
        if len(inner) != 1 or inner[0].end is None:
            return []
        span = inner[0].content()
        text = source.text[span.start : span.end]
        is_plain = not COMPUTED.search(text) and "<" not in text
        return _replace(_stripped(span, text), meant[2]) if is_plain else []

    return fix


_PLUGINS = re.compile(r"<plugin [^<>]*/>")


def add_system_plugins(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Add the plugins that the hint writes out in front of the first one of the world.

    Where it has none, they come first in it.
    """
    plugins = _PLUGINS.findall(diagnostic.hint or "")
    line = diagnostic.line or 0
    first = [
        tag
        for tag in read_tags(source.text)
        if (
            tag.path and tag.path[-1].name == "world"
            if tag.name == "plugin"
            else tag.name == "world"
        )
        if source.line_at(tag.start.start) <= line <= source.line_at(tag.start.end)
    ]
    if not plugins or not first:
        return []
    tag = first[-1]
    is_empty = tag.name == "world"
    place = tag.start.end if is_empty else tag.start.start
    if is_empty and tag.end is None:
        return []
    between = source.newline + source.indent_at(tag.start.start)
    added = (f"{between}  {one}" if is_empty else one + between for one in plugins)
    return [Edit(start=place, end=place, text="".join(added))]


def fix_element_name(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Rename an element, its end tag too."""
    found = find_tag(source, diagnostic.line, diagnostic.element)
    meant = suggested(diagnostic.hint)
    if found is None or meant is None or not is_surely(found[0].name, meant):
        return []
    tag = found[0]
    starts = [tag.start.start + len("<"), *([tag.end.start + len("</")] if tag.end else [])]
    return [Edit(start=place, end=place + len(tag.name), text=meant) for place in starts]


_PREFIXED = re.compile(r"Write <(xacro:[\w.]+)>")


def add_prefix(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Give an element of xacro the prefix without which it is none."""
    found = find_tag(source, diagnostic.line, diagnostic.element)
    meant = _PREFIXED.search(diagnostic.hint or "")
    if found is None or meant is None or "xmlns:xacro" not in source.text:
        return []
    tag = found[0]
    if f"xacro:{tag.name}" != meant[1]:
        return []
    starts = [tag.start.start + len("<"), *([tag.end.start + len("</")] if tag.end else [])]
    return [Edit(start=place, end=place, text="xacro:") for place in starts]


_WRITE_ATTRIBUTE = re.compile(r'Write (\w+)="([^"]+)"\.')


def fix_attribute(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the attribute as the hint has it, if the value is misspelled."""
    found = find_tag(source, diagnostic.line, diagnostic.element)
    meant = _WRITE_ATTRIBUTE.search(diagnostic.hint or "")
    written = found[0].attributes.get(meant[1]) if found and meant else None
    if meant is None or written is None or not is_surely(written.text, meant[2]):
        return []
    return _replace(written.value, meant[2])


def fix_attribute_name(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Rename an attribute."""
    found = find_tag(source, diagnostic.line, diagnostic.element)
    meant = suggested(diagnostic.hint)
    if found is None or meant is None:
        return []
    tag, name = found
    name = name or _quoted(diagnostic.message)
    written = tag.attributes.get(name)
    if written is None or meant in tag.attributes or not is_surely(name, meant):
        return []
    return _replace(written.name, meant)


def _quoted(message: str) -> str:
    found = re.search(r"`([^`]+)`", message)
    return found[1] if found else ""


def fix_urdf_version(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Write the only version that URDF has."""
    root = _root(source, "robot")
    written = root and root.attributes.get("version")
    return _replace(written.value, URDF_VERSION) if written else []


def fix_robot_name(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Name the robot like its file."""
    root = _root(source, "robot")
    name = re.sub(r"\W+", "_", source.file.name.partition(".")[0]).strip("_")
    if root is None or not name:
        return []
    written = root.attributes.get("name")
    if written is not None:
        return [] if written.text.strip() else _replace(written.value, name)
    return _with_attribute(root, "name", name)


def fix_sdf_version(_: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Give `<sdf>` a version."""
    root = _root(source, "sdf")
    if root is None:
        return []
    written = root.attributes.get("version")
    if written is not None:
        return _replace(written.value, SDF_VERSION)
    return _with_attribute(root, "version", SDF_VERSION)


def _root(source: SourceText, name: str) -> Tag | None:
    root = next(iter(read_tags(source.text)), None)
    return root if root is not None and root.name == name else None


def _with_attribute(tag: Tag, name: str, value: str) -> list[Edit]:
    place = tag.start.start + len("<") + len(tag.name)
    return [Edit(start=place, end=place, text=f' {name}="{value}"')]


def remove_repeated_material(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Remove a material that is defined a second time in the same words."""
    found = find_tag(source, diagnostic.line, diagnostic.element)
    if found is None:
        return []
    tag = found[0]
    words = _words(source, tag)
    same = [
        other
        for other in read_tags(source.text)
        if other.name == tag.name
        and other.start != tag.start
        and len(other.path) == len(tag.path)
        and _words(source, other) == words
    ]
    if not same:
        return []
    start, end = source.whole_lines(tag.start.start, (tag.end or tag.start).end)
    return [Edit(start=start, end=end, text="")]


def _words(source: SourceText, tag: Tag) -> list[str]:
    text = source.text[tag.start.start : (tag.end or tag.start).end]
    return re.sub(r"\s+", " ", re.sub(r">\s+<", "><", text)).split()


# Of messages about XML that is not well-formed.
_ALONE = re.compile(r"`&` stands alone")
_CLOSED_BY = re.compile(r"<([^>]+)> is closed by </([^>]+)>")
_BEFORE_DECLARATION = "is not at the very beginning"
_HYPHENS = "a comment contains `--`"


def fix_xml(diagnostic: Diagnostic, source: SourceText) -> Sequence[Edit]:
    """Correct the mistakes in XML that have one sure correction."""
    message, line = diagnostic.message, diagnostic.line or 0
    start, end = source.start_of(line), source.start_of(line + 1)
    text = source.text[start:end]
    closed = _CLOSED_BY.search(message)
    if _ALONE.search(message):
        return [
            Edit(start=start + one.start(), end=start + one.end(), text="&amp;")
            for one in re.finditer(r"&(?!#?\w+;)", text)
        ]
    if closed is not None and is_surely(closed[2], closed[1]):
        ends = list(re.finditer(rf"(?<=</){re.escape(closed[2])}(?=\s*>)", text))
        if len(ends) == 1:
            return [Edit(start=start + ends[0].start(), end=start + ends[0].end(), text=closed[1])]
    comma = _WITH_COMMA.search(message)
    if comma is not None:
        return _decimal_point(source, comma[1], comma[2])
    if _BEFORE_DECLARATION in message:
        place = source.text.find("<?xml")
        if place > 0 and not source.text[:place].strip():
            return [Edit(start=0, end=place, text="")]
    if _HYPHENS in message:
        return _single_hyphens(source, start, end)
    return []


_WITH_COMMA = re.compile(r"the value of `(\w+)` is the text '(-?\d*,\d+)', not a number")


def _decimal_point(source: SourceText, name: str, value: str) -> list[Edit]:
    """Write the value of a property with a decimal point, where the file has it once."""
    found = [
        attribute
        for tag in read_tags(source.text)
        if tag.name == "xacro:property"
        and (named := tag.attributes.get("name")) is not None
        and named.text == name
        and (attribute := tag.attributes.get("value")) is not None
    ]
    if len(found) != 1 or found[0].text.strip() != value:
        return []
    span = found[0].value
    return [Edit(start=span.start, end=span.end, text=found[0].text.replace(",", "."))]


def _single_hyphens(source: SourceText, start: int, end: int) -> list[Edit]:
    """Write one hyphen for several in the comment that the line has."""
    begin = source.text.rfind("<!--", 0, end)
    stop = source.text.find("-->", begin + len("<!--"))
    if begin < 0 or stop < start:
        return []
    inside = source.text[begin + len("<!--") : stop]
    if "<!--" in inside:  # the comment before has no end: two are one here
        return []
    offset = begin + len("<!--")
    return [
        Edit(start=offset + one.start(), end=offset + one.end(), text=_hyphen(one, inside))
        for one in re.finditer(r"-{2,}|-\Z", inside)
    ]


def _hyphen(hyphens: re.Match[str], comment: str) -> str:
    """None in front of the end of the comment, which begins with two."""
    return "" if hyphens.end() == len(comment) else "-"
