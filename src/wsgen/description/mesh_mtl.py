"""Material libraries of OBJ files (`.mtl`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.mesh_content import Complaint, Material
from wsgen.files import read_regular

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

SIZE_LIMIT = 10**6  # bytes
TEXTURED = 0.6  # grey that Gazebo takes for a texture to which no colour is given
# Options of a texture, and how many values they have; of numbers fewer may be given.
WORD_OPTIONS = {"-blendu", "-blendv", "-cc", "-clamp", "-imfchan", "-type"}
NUMBER_OPTIONS = {"-bm": 1, "-boost": 1, "-texres": 1, "-mm": 2, "-o": 3, "-s": 3, "-t": 3}


def read_materials(
    names: Iterable[str], folder: Path
) -> tuple[dict[str, Material], tuple[Complaint, ...]]:
    """The materials of an OBJ file by name.

    Args:
        names: What stands behind each `mtllib`: a file, or several.
        folder: Where the OBJ file is.
    """
    materials: dict[str, Material] = {}
    complaints = []
    for name in names:
        tried = [_read(folder / one) for one in dict.fromkeys((name, *name.split()))]
        text = next((text for text, _ in tried if text is not None), None)
        if text is not None:
            materials |= _parse(text)
            continue
        complaints.append(
            Complaint(
                "ROB075",
                f"has no colours, as its material library `{name}` {tried[0][1]}",
                "Put the .mtl file next to the .obj, and let CMakeLists.txt install it.",
            )
        )
    return materials, tuple(complaints)


def _read(file: Path) -> tuple[str | None, str]:
    """The text of a file, or what keeps it from being read."""
    try:
        data = read_regular(file, SIZE_LIMIT)
    except FileNotFoundError:
        return None, "is not there"
    except (OSError, ValueError) as error:  # ValueError: a null byte in the name
        return None, f"cannot be read ({getattr(error, 'strerror', None) or error})"
    if len(data) > SIZE_LIMIT:
        return None, f"has more than {SIZE_LIMIT / 1e6:.0f} MB"
    return data.decode("utf-8", errors="replace"), ""


def _parse(text: str) -> dict[str, Material]:
    parts: dict[str, dict[str, str]] = {}
    current: dict[str, str] = {}
    for line in text.splitlines():
        keyword, _, rest = line.strip().partition(" ")
        if keyword == "newmtl":
            current = parts.setdefault(rest.strip(), {})
        else:
            current[keyword] = rest.strip()
    return {name: _material(lines) for name, lines in parts.items()}


def _material(lines: dict[str, str]) -> Material:
    image = _file_name(lines.get("map_Kd", ""))
    rgb = _numbers(lines.get("Kd", "").split()[:3])
    if len(rgb) == 1:  # a grey
        rgb *= 3
    if len(rgb) != len("rgb"):
        if not image:
            return Material()
        rgb = [TEXTURED] * 3
    opacity = _numbers([lines["d"].split()[-1]] if lines.get("d") else [])
    if not opacity:
        opacity = [1 - part for part in _numbers(lines.get("Tr", "").split()[:1])] or [1.0]
    red, green, blue, alpha = (min(1.0, max(0.0, part)) for part in (*rgb, *opacity))
    return Material(rgba=(red, green, blue, alpha), image=image or None)


def _file_name(text: str) -> str:
    """What stands behind the options of a texture; it may have blanks in it."""
    words = text.split(" ")
    while words and words[0] in WORD_OPTIONS | NUMBER_OPTIONS.keys():
        option = words.pop(0)
        for _ in range(NUMBER_OPTIONS.get(option, 1)):
            if words and (option in WORD_OPTIONS or _numbers(words[:1])):
                words.pop(0)
    return " ".join(words).strip()


def _numbers(words: Sequence[str]) -> list[float]:
    """Finite numbers; none where anything else is among the words."""
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        return []
    return numbers if all(abs(number) < float("inf") for number in numbers) else []
