"""Interfaces of packages that PyPI lacks: types, names, order and constants of their fields.

`interfaces/PACKAGE.txt` has a line `msg/NAME`, `srv/NAME` or `action/NAME` for each interface, and
below it, indented, what its file says. Comments of the originals are not there: the hash of a type,
by which nodes recognize each other, is made of names and types alone.
"""

from __future__ import annotations

import hashlib
import re
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).with_name("interfaces")
# What the generators add to a service and to an action.
ADDED = {
    "srv": ("service_msgs", "builtin_interfaces"),
    "action": ("action_msgs", "unique_identifier_msgs", "service_msgs", "builtin_interfaces"),
}
OTHER_PACKAGE = re.compile(r"^([a-z][a-z0-9_]*)/[A-Z]")
COMMON = Path(__file__).with_name("common_interfaces.txt")
FIELD = re.compile(
    r"(?P<type>[\w/]+)(?P<array>(?:<=\d+)?\[[^\]]*\])?(?:<=\d+)?\s+(?P<name>[a-z]\w*)\b(?!\s*=)"
)
PARTS = {"srv": ("Request", "Response"), "action": ("Goal", "Result", "Feedback")}


def buildable() -> tuple[str, ...]:
    """Name the packages that can be built."""
    return tuple(sorted(file.stem for file in FOLDER.glob("*.txt")))


def read_interfaces(package: str) -> dict[str, list[str]]:
    """Return the lines of each interface of a package by its name, such as msg/TFMessage."""
    interfaces: dict[str, list[str]] = {}
    lines: list[str] = []
    for line in (FOLDER / f"{package}.txt").read_text(encoding="utf-8").splitlines():
        if line.startswith("  "):
            lines.append(line.strip())
        elif line and not line.startswith("#"):
            lines = interfaces[line] = []
    return interfaces


@cache
def common_packages() -> tuple[str, ...]:
    """Name the packages whose interfaces all distributions have alike."""
    return tuple(re.findall(r"^(\w+):$", COMMON.read_text(encoding="utf-8"), re.MULTILINE))


@cache
def fields_of(package: str) -> dict[str, dict[str, str]] | None:
    """The fields of each message of a package, by names such as msg/Twist and srv/Trigger.Request.

    A field has its type, such as geometry_msgs/Vector3, or an empty one if that is no message.
    None of packages whose interfaces are not known.
    """
    if package in buildable():
        written = {name: _fields_in(lines) for name, lines in read_interfaces(package).items()}
    else:
        block = re.search(
            rf"^{package}:\n((?:.+\n)+)", COMMON.read_text(encoding="utf-8"), re.MULTILINE
        )
        if block is None:
            return None
        written = {name: fields for name, *fields in map(str.split, block[1].splitlines())}
    found: dict[str, dict[str, str]] = {}
    for name, fields in written.items():
        kind = name.partition("/")[0]
        whole = " ".join(fields).split("---")
        if kind in PARTS:
            found[name] = {}
        for part, text in zip(PARTS.get(kind, ("",)), whole, strict=False):
            found[f"{name}.{part}" if part else name] = {
                field: _whole_type(type_, package)
                for field, _, type_ in (one.partition("=") for one in text.split())
            }
    return found


def _fields_in(lines: list[str]) -> list[str]:
    """The fields as COMMON has them."""
    found = []
    for line in lines:
        field = FIELD.match(line)
        if field is not None:
            found.append(f"{field['name']}={'' if field['array'] else field['type']}")
        elif line == "---":
            found.append(line)
    return found


def _whole_type(type_: str, package: str) -> str:
    """The type of a field, with its package; empty where it is no message."""
    if not type_.rpartition("/")[2][:1].isupper():
        return ""
    return type_ if "/" in type_ else f"{package}/{type_}"


def dependencies(package: str) -> set[str]:
    """Name the packages whose types those of a package use."""
    used: set[str] = set()
    for name, lines in read_interfaces(package).items():
        used.update(ADDED.get(name.partition("/")[0], ()))
        used.update(match[1] for line in lines if (match := OTHER_PACKAGE.match(line)))
    return used - {package}


def in_order(packages: set[str]) -> list[str]:
    """List packages that can be built and those of them that they use; used ones come first."""
    ordered: list[str] = []

    def add(package: str) -> None:
        for used in sorted(dependencies(package).intersection(buildable())):
            add(used)
        if package not in ordered:
            ordered.append(package)

    for package in sorted(packages):
        add(package)
    return ordered


def digest(package: str) -> str:
    """Return a hash of the interfaces of a package and of those that it uses."""
    made = hashlib.sha256()
    for name in in_order({package}):
        for interface, lines in sorted(read_interfaces(name).items()):
            made.update("\n".join([name, interface, *lines, ""]).encode())
    return made.hexdigest()[:10]


def write_interfaces(package: str, folder: Path) -> None:
    """Write the files of a package, with its package.xml, as its sources have them."""
    for name, lines in read_interfaces(package).items():
        file = folder / f"{name}.{name.partition('/')[0]}"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("".join(f"{line}\n" for line in lines), encoding="utf-8")
    needs = "".join(f"  <depend>{name}</depend>\n" for name in sorted(dependencies(package)))
    (folder / "package.xml").write_text(
        '<?xml version="1.0"?>\n<package format="3">\n'
        f"  <name>{package}</name>\n  <version>0.0.0</version>\n"
        f"  <description>Interfaces of {package}, built by wsgen</description>\n"
        '  <maintainer email="nobody@example.org">wsgen</maintainer>\n'
        f"  <license>Apache-2.0</license>\n{needs}"
        "  <member_of_group>rosidl_interface_packages</member_of_group>\n</package>\n",
        encoding="utf-8",
    )
