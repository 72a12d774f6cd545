"""Read the name, the build type and the test dependencies from a package.xml.

It uses only expat of the standard library and takes a millisecond, which is enough to list the
packages of a workspace. `package_xml` checks with catkin_pkg whether ROS accepts the manifest.
"""

from __future__ import annotations

from dataclasses import field
from typing import TYPE_CHECKING, Any
from xml.parsers import expat

from wsgen.diagnostics import Diagnostic, Rule, Severity
from wsgen.values import dataclass
from wsgen.xmlsyntax import find_mistake

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path


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
        """Return the line on which the element begins; None if it is missing."""
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
    """Read a package.xml, or report why it cannot be read."""
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
        return UNREADABLE_MANIFEST.at(
            file,
            message=f"package.xml cannot be read: {error.strerror or error}.",
            hint="Check that it is a file and that you may read it (ls -l).",
        )
    except UnicodeDecodeError as error:
        return UNREADABLE_MANIFEST.at(
            file,
            data.count(b"\n", 0, error.start) + 1,
            message="package.xml is not UTF-8 text.",
            hint="Save it as UTF-8.",
        )
    except expat.ExpatError as error:
        mistake = find_mistake(data)
        return MALFORMED_MANIFEST.at(
            file,
            mistake.line if mistake else error.lineno,
            message=f"package.xml is not well-formed XML: {mistake.message if mistake else error}.",
            hint=mistake.hint if mistake else "",
        )
    except _EntityError:
        return MALFORMED_MANIFEST.at(
            file,
            parser.CurrentLineNumber,
            message="package.xml declares an XML entity.",
            hint="Replace the entity by its text.",
        )
    return _make_manifest(handler, file)


def _make_manifest(handler: _Handler, file: Path) -> Manifest | Diagnostic:
    if handler.root != "package":
        return FOREIGN_MANIFEST.at(
            file,
            1,
            message=f"package.xml is not a ROS manifest: its root element is <{handler.root}>.",
            hint="Make <package> the root element if this is a ROS package.",
        )
    name = next(iter(handler.texts.get(("name",), [])), "")
    if not name:
        return UNNAMED_PACKAGE.at(
            file,
            element="package/name",
            message="package.xml does not name the package.",
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
