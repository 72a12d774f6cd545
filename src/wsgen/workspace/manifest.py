"""What is needed of a package.xml, read in a millisecond.

Only expat of the standard library: enough to list a workspace's packages. Whether ROS accepts the
manifest is for `package_xml` to say, which asks catkin_pkg.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from xml.parsers import expat

from wsgen.diagnostics import Diagnostic, Severity
from wsgen.xmlsyntax import find_mistake

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path


MALFORMED_MANIFEST = "PKG001"
UNREADABLE_MANIFEST = "PKG002"
FOREIGN_MANIFEST = "PKG003"
UNNAMED_PACKAGE = "PKG004"

DEFAULT_BUILD_TYPE = "catkin"  # what colcon and catkin_pkg take where none is exported


@dataclass(frozen=True, kw_only=True)
class Manifest:
    """The parts of a package.xml that say how the package is built."""

    name: str
    build_type: str  # ament_cmake, ament_python, cmake, catkin, ...
    test_dependencies: frozenset[str]  # of <test_depend>
    # 1-based, of the first element at each path below <package>
    lines: Mapping[tuple[str, ...], int] = field(default_factory=dict, compare=False)

    def line_of(self, *path: str) -> int | None:
        """Give the line on which the element begins; None if there is none."""
        return self.lines.get(path)


@dataclass
class _Handler:
    """Collects the texts and lines of the elements by their path below the root."""

    parser: Any  # expat's
    root: str | None = None
    texts: dict[tuple[str, ...], list[str]] = field(default_factory=dict)
    lines: dict[tuple[str, ...], int] = field(default_factory=dict)
    opened: list[tuple[str, int]] = field(default_factory=list)  # and not closed yet
    _text: str = ""

    def start(self, tag: str, _attributes: dict[str, str]) -> None:
        self.opened.append((tag, self.parser.CurrentLineNumber))
        self._text = ""
        self.lines.setdefault(self._path, self.parser.CurrentLineNumber)
        if self.root is None:
            self.root = tag

    def text(self, data: str) -> None:
        self._text += data

    def end(self, _tag: str) -> None:
        self.texts.setdefault(self._path, []).append(self._text.strip())
        self.opened.pop()
        self._text = ""

    @property
    def _path(self) -> tuple[str, ...]:
        """Where the parser is, below the root."""
        return tuple(tag for tag, _ in self.opened[1:])


def read_manifest(file: Path) -> Manifest | Diagnostic:
    """Read a package.xml, or say what keeps it from being read."""
    parser = expat.ParserCreate()
    handler = _Handler(parser)
    parser.StartElementHandler = handler.start
    parser.EndElementHandler = handler.end
    parser.CharacterDataHandler = handler.text
    parser.EntityDeclHandler = _refuse_entity  # no bombs: ROS manifests declare none
    data = b""
    try:
        data = file.read_bytes()
        parser.Parse(data, True)
        if handler.root == "package":
            data.decode("utf-8")  # as colcon and CMake read it, whatever encoding it declares
    except OSError as error:
        return Diagnostic(
            code=UNREADABLE_MANIFEST,
            severity=Severity.ERROR,
            message=f"package.xml cannot be read: {error.strerror or error}.",
            file=file,
            hint="Check what it is (ls -l) and that you may read it.",
        )
    except UnicodeDecodeError as error:
        return Diagnostic(
            code=UNREADABLE_MANIFEST,
            severity=Severity.ERROR,
            message="package.xml is not UTF-8 text.",
            file=file,
            line=data.count(b"\n", 0, error.start) + 1,
            hint="Save it in the encoding UTF-8.",
        )
    except expat.ExpatError as error:
        mistake = find_mistake(data)
        return Diagnostic(
            code=MALFORMED_MANIFEST,
            severity=Severity.ERROR,
            message=f"package.xml is not well-formed XML: {mistake.message if mistake else error}.",
            file=file,
            line=mistake.line if mistake else error.lineno,
            hint=mistake.hint if mistake else "",
        )
    except _EntityError:
        return Diagnostic(
            code=MALFORMED_MANIFEST,
            severity=Severity.ERROR,
            message="package.xml declares an XML entity.",
            file=file,
            line=parser.CurrentLineNumber,
            hint="Write the text itself in the place of the entity.",
        )
    return _make_manifest(handler, file)


def _make_manifest(handler: _Handler, file: Path) -> Manifest | Diagnostic:
    if handler.root != "package":
        return Diagnostic(
            code=FOREIGN_MANIFEST,
            severity=Severity.WARNING,
            message=f"package.xml is no ROS manifest: its root element is <{handler.root}>.",
            file=file,
            line=1,
            hint="The root element of a ROS package's manifest is <package>.",
        )
    name = next(iter(handler.texts.get(("name",), [])), "")
    if not name:
        return Diagnostic(
            code=UNNAMED_PACKAGE,
            severity=Severity.ERROR,
            message="package.xml names no package.",
            file=file,
            element="package/name",
            hint=f"Add <name>{file.parent.name}</name> below <package>.",
        )
    build_types = handler.texts.get(("export", "build_type"), [])
    return Manifest(
        name=name,
        build_type=next(iter(build_types), DEFAULT_BUILD_TYPE),
        test_dependencies=frozenset(handler.texts.get(("test_depend",), [])),
        lines=handler.lines,
    )


class _EntityError(Exception):
    """Stops the parser; it does not leave this module."""


def _refuse_entity(*_declaration: object) -> None:
    raise _EntityError
