"""Read a package.xml: its name, its build type, its dependencies, and where they are written.

It uses only expat of the standard library and takes a millisecond, which is enough to list the
packages of a workspace. `package_xml` checks with catkin_pkg whether ROS accepts the manifest.
"""

from __future__ import annotations

import errno
import operator
from dataclasses import field
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.parsers import expat

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.text.files import read_regular
from wsgen.text.values import dataclass, lazy_pattern
from wsgen.text.xmlsyntax import (
    DEEPEST,
    MOST_ATTRIBUTES,
    Mistake,
    find_mistake,
    read_with,
    too_deep,
    too_many_attributes,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping
    from pathlib import Path


_TOKEN = lazy_pattern(r"""\s*(?:(\(|\)|<=|>=|==|!=|<|>)|\$(\w+)|"([^"]*)"|'([^']*)'|([\w./+-]+))""")
_COMPARISONS: dict[str, Callable[[str, str], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
}


class _SyntaxError(Exception):
    """Not a condition; it does not leave this module."""


def holds(condition: str, distro: str | None) -> bool | None:
    """Whether a condition holds in ROS 2; None where that depends on what is not known.

    Args:
        condition: the value of the attribute, such as `$ROS_DISTRO == humble`.
        distro: the distribution; None where it is not known.
    """
    known = {"ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3"}
    if distro is not None:
        known["ROS_DISTRO"] = distro
    try:
        reader = _Reader(_tokens(condition), known)
        value = reader.alternatives()
    except _SyntaxError:
        return None
    return None if reader.tokens else value


def _tokens(condition: str) -> list[tuple[str, str]]:
    """Its tokens in reversed order: kind (`sign`, `variable`, `value` or `word`) and text."""
    found: list[tuple[str, str]] = []
    text = condition.rstrip()
    place = 0
    while place < len(text):
        match = _TOKEN.match(text, place)
        if match is None:
            raise _SyntaxError
        place = match.end()
        kind = ("sign", "variable", "value", "value", "word")[(match.lastindex or 1) - 1]
        found.append((kind, match[match.lastindex or 1]))
    return found[::-1]


class _Reader:
    """Evaluates while it parses; a value is None where it is not known."""

    def __init__(self, tokens: list[tuple[str, str]], known: dict[str, str]) -> None:
        self.tokens = tokens
        self._known = known

    def alternatives(self) -> bool | None:
        values = [self._conjunction()]
        while self._take(("word", "or")):
            values.append(self._conjunction())
        return True if True in values else None if None in values else False

    def _conjunction(self) -> bool | None:
        values = [self._comparison()]
        while self._take(("word", "and")):
            values.append(self._comparison())
        return False if False in values else None if None in values else True

    def _comparison(self) -> bool | None:
        if self._take(("sign", "(")):
            value = self.alternatives()
            if not self._take(("sign", ")")):
                raise _SyntaxError
            return value
        left = self._operand()
        kind, sign = self._next()
        if kind != "sign" or sign not in _COMPARISONS:
            raise _SyntaxError
        right = self._operand()
        return None if left is None or right is None else _COMPARISONS[sign](left, right)

    def _operand(self) -> str | None:
        kind, text = self._next()
        if kind == "sign":
            raise _SyntaxError
        return self._known.get(text) if kind == "variable" else text

    def _next(self) -> tuple[str, str]:
        if not self.tokens:
            raise _SyntaxError
        return self.tokens.pop()

    def _take(self, token: tuple[str, str]) -> bool:
        if self.tokens and self.tokens[-1] == token:
            self.tokens.pop()
            return True
        return False


MALFORMED_MANIFEST = Rule(
    code="PKG001",
    name="malformed-manifest",
    severity=Severity.ERROR,
    summary="`package.xml` is not well-formed XML.",
    what="Parses package.xml, and refuses entities, which no manifest of ROS declares.",
    why="`colcon` cannot read the name and the dependencies of the package.",
    example="""<package format="3">
  <name>my_robot<name>
</package>""",
    instead="""<package format="3">
  <name>my_robot</name>
</package>""",
)
UNREADABLE_MANIFEST = Rule(
    code="PKG002",
    name="unreadable-manifest",
    severity=Severity.ERROR,
    summary="`package.xml` cannot be read, or is not UTF-8 text.",
    why="`colcon` and CMake read package.xml as UTF-8, whatever encoding it declares.",
    example="""<?xml version="1.0" encoding="ISO-8859-1"?>
<package format="3">...""",
    instead="Save package.xml as UTF-8, and make it readable for your user.",
)
FOREIGN_MANIFEST = Rule(
    code="PKG003",
    name="foreign-manifest",
    severity=Severity.WARNING,
    summary="`package.xml` is not the manifest of a ROS package.",
    what="Looks at the root element of package.xml, which is `<package>` in ROS.",
    why="Other tools, such as Dynamics 365, also name a file package.xml. colcon does not take its "
    "folder for a ROS package.",
    example='<ImportExportXml version="1.0">...</ImportExportXml>',
    instead='<package format="3">...</package>',
)
UNNAMED_PACKAGE = Rule(
    code="PKG004",
    name="unnamed-package",
    severity=Severity.ERROR,
    summary="`package.xml` does not name the package.",
    why="`colcon`, `ros2 launch` and `$(find ...)` know a package by the name in package.xml.",
    example="""<package format="3">
  <version>0.0.0</version>
</package>""",
    instead="""<package format="3">
  <name>my_robot</name>
  <version>0.0.0</version>
</package>""",
)

SIZE_LIMIT = 2**20  # bytes; manifests are written by hand
DEEPEST_KNOWN = 8  # elements inside of each other; ROS knows four
DEFAULT_BUILD_TYPE = "catkin"  # what colcon and catkin_pkg take where none is exported

# What a dependency is for, by the element that declares it (REP 149; run_depend: REP 127).
BUILD_TAGS = frozenset({"depend", "build_depend", "buildtool_depend"})
EXPORT_TAGS = frozenset({"depend", "build_export_depend", "buildtool_export_depend"})
RUN_TAGS = frozenset({"depend", "exec_depend", "run_depend"})
TEST_TAGS = frozenset({"test_depend"})
DEPENDENCY_TAGS = BUILD_TAGS | EXPORT_TAGS | RUN_TAGS | TEST_TAGS | {"doc_depend"}


@dataclass(frozen=True, kw_only=True)
class Dependency:
    """A package that another one declares to need."""

    tag: str  # depend, exec_depend, ...
    name: str
    line: int  # 1-based, of the element
    condition: str | None = None  # as written; None: always

    def holds(self, distro: str | None) -> bool | None:
        """Whether it counts in ROS 2 and a distribution; None where that is not known."""
        return self.condition is None or holds(self.condition, distro)


class Entry(NamedTuple):
    """An element below <package>."""

    text: str
    line: int  # 1-based
    attributes: Mapping[str, str]


@dataclass(frozen=True, kw_only=True)
class Manifest:
    """What a package.xml says."""

    name: str
    build_type: str  # ament_cmake, ament_python, cmake, catkin, ...
    dependencies: tuple[Dependency, ...] = ()  # in the order of the file
    file: Path | None = field(default=None, compare=False)
    # All elements by their paths below <package>; the empty path is that of <package>.
    entries: Mapping[tuple[str, ...], tuple[Entry, ...]] = field(
        default_factory=dict, compare=False
    )

    @cached_property
    def dependency_names(self) -> frozenset[str]:
        """All that it names; each package of a workspace is asked about each other one."""
        return frozenset(one.name for one in self.dependencies)

    @property
    def test_dependencies(self) -> frozenset[str]:
        """The names in <test_depend>."""
        return frozenset(one.name for one in self.dependencies if one.tag in TEST_TAGS)

    @property
    def format(self) -> int | None:
        """The format, 1 where none is given; None where it is not a number."""
        text = self.entries[()][0].attributes.get("format", "1") if () in self.entries else "1"
        return int(text) if text.isdecimal() else None

    def line_of(self, *path: str) -> int | None:
        """Return the line on which the first such element begins; None if it is missing."""
        found = self.entries.get(path)
        return found[0].line if found else None

    def names(self, tags: Collection[str], distro: str | None = None) -> frozenset[str]:
        """The packages that elements with one of these tags name, unless they surely do not count.

        `distro` is what the package is for, None where that is not known.
        """
        return frozenset(
            one.name
            for one in self.dependencies
            if one.tag in tags and one.holds(distro) is not False
        )


class _Handler:
    """Collects the elements by their path below the root."""

    def __init__(self, parser: Any) -> None:
        self.parser = parser  # expat's
        self.root: str | None = None
        self.entries: dict[tuple[str, ...], list[Entry]] = {}
        self.dependencies: list[Dependency] = []
        # And not closed yet: path, line, attributes, text.
        self.opened: list[tuple[tuple[str, ...], int, dict[str, str], list[str]]] = []
        parser.buffer_text = True  # one call for a text
        parser.StartElementHandler = self.start
        parser.EndElementHandler = self.end
        parser.CharacterDataHandler = self.text

    def leave(self) -> None:
        """Let the parser go, which holds this: only the garbage collector would free both."""
        self.parser.StartElementHandler = self.parser.EndElementHandler = None
        self.parser.CharacterDataHandler = None

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        if self.root is None:
            self.root = tag
            path: tuple[str, ...] = ()
        else:
            path = self.opened[-1][0]
            # What lies deeper than any element of a manifest is not looked up by its path.
            if len(self.opened) < DEEPEST_KNOWN:
                path = (*path, tag)
        line = self.parser.CurrentLineNumber
        self.opened.append((path, line, attributes, []))
        if len(self.opened) > DEEPEST:
            raise _ExcessError(too_deep(line))
        if len(attributes) > MOST_ATTRIBUTES:
            raise _ExcessError(too_many_attributes(line))

    def text(self, data: str) -> None:
        self.opened[-1][3].append(data)

    def end(self, tag: str) -> None:
        path, line, attributes, texts = self.opened.pop()
        text = "".join(texts).strip()
        self.entries.setdefault(path, []).append(Entry(text, line, attributes))
        if len(path) == 1 and tag in DEPENDENCY_TAGS and text:
            condition = attributes.get("condition")
            self.dependencies.append(Dependency(tag=tag, name=text, line=line, condition=condition))


def read_manifest(file: Path) -> Manifest | Diagnostic:
    """Read a package.xml, or report why it cannot be read."""
    parser = expat.ParserCreate()
    handler = _Handler(parser)
    parser.EntityDeclHandler = _refuse_entity  # no bombs: ROS manifests declare none
    try:
        return _read_manifest(file, parser, handler)
    finally:
        handler.leave()


def _read_manifest(file: Path, parser: Any, handler: _Handler) -> Manifest | Diagnostic:
    data = b""
    try:
        data = _read(file)
        read_with(parser, data)
        if handler.root == "package":
            data.decode("utf-8")  # as colcon and CMake read it, whatever encoding it declares
    except OSError as error:
        return UNREADABLE_MANIFEST.at(
            file,
            message=f"package.xml cannot be read: {error.strerror or error}.",
            hint="Remove what is not needed in it."
            if error.errno == errno.EFBIG
            else "Check that it is a file and that you may read it (ls -l).",
        )
    except UnicodeDecodeError as error:
        return UNREADABLE_MANIFEST.at(
            file,
            data.count(b"\n", 0, error.start) + 1,
            message="package.xml is not UTF-8 text.",
            hint="Save it as UTF-8.",
        )
    except expat.ExpatError as error:
        return _malformed(file, find_mistake(data) or Mistake(str(error), error.lineno, ""))
    except _ExcessError as error:
        return _malformed(file, error.mistake)
    except _EntityError:
        return MALFORMED_MANIFEST.at(
            file,
            parser.CurrentLineNumber,
            message="package.xml declares an XML entity.",
            hint="Replace the entity by its text.",
        )
    return _make_manifest(handler, file)


def _malformed(file: Path, mistake: Mistake) -> Diagnostic:
    return MALFORMED_MANIFEST.at(
        file,
        mistake.line,
        message=f"package.xml is not well-formed XML: {mistake.message}.",
        hint=mistake.hint,
    )


def _read(file: Path) -> bytes:
    data = read_regular(file, SIZE_LIMIT)
    if len(data) > SIZE_LIMIT:
        raise OSError(errno.EFBIG, "it is too large", str(file))
    return data


def _make_manifest(handler: _Handler, file: Path) -> Manifest | Diagnostic:
    if handler.root != "package":
        return FOREIGN_MANIFEST.at(
            file,
            1,
            message=f"package.xml is not a ROS manifest: its root element is <{handler.root}>.",
            hint="Make <package> the root element if this is a ROS package.",
        )
    entries = {path: tuple(found) for path, found in handler.entries.items()}
    name = next((entry.text for entry in entries.get(("name",), ())), "")
    if not name:
        return UNNAMED_PACKAGE.at(
            file,
            element="package/name",
            message="package.xml does not name the package.",
            hint=f"Add <name>{file.parent.name}</name> below <package>.",
        )
    if not name.isprintable() or "/" in name or "\\" in name or name in {".", ".."}:
        # Folders and files get this name, and must not be elsewhere.
        return UNNAMED_PACKAGE.at(
            file,
            entries[("name",)][0].line,
            element="package/name",
            message=f"package.xml does not name the package: `{name}` cannot be the name of a "
            f"folder.",
            hint="Write lower-case letters, digits and _, beginning with a letter.",
        )
    return Manifest(
        name=name,
        build_type=_build_type(entries.get(("export", "build_type"), ())),
        dependencies=tuple(handler.dependencies),
        file=file,
        entries=entries,
    )


def _build_type(found: tuple[Entry, ...]) -> str:
    """The first one that counts in ROS 2."""
    for entry in found:
        condition = entry.attributes.get("condition")
        if condition is None or holds(condition, None) is not False:
            return entry.text
    return DEFAULT_BUILD_TYPE


class _EntityError(Exception):
    """Stops the parser; it does not leave this module."""


class _ExcessError(Exception):
    """Stops the parser where a manifest is larger than any; it does not leave this module."""

    def __init__(self, mistake: Mistake) -> None:
        super().__init__(mistake.message)
        self.mistake = mistake


def _refuse_entity(*_declaration: object) -> None:
    raise _EntityError


def way_between(
    start: str, end: str, needed: Callable[[str], Collection[str]]
) -> tuple[str, ...] | None:
    """The shortest way from a package to one that it needs, itself or by others; both included."""
    ways: dict[str, tuple[str, ...]] = {start: (start,)}
    todo = [start]
    for name in todo:
        if name == end:
            return ways[name]
        for other in sorted(needed(name)):
            if other not in ways:
                ways[other] = (*ways[name], other)
                todo.append(other)
    return None
