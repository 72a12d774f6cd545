"""Rules about the materials of a robot in the simulator that it is for.

The parameters of a check are facts; a check yields what it reports.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.diagnostics import Rule, Severity
from wsgen.model.robot import GAZEBO_COLORS
from wsgen.text.suggestions import some_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic
    from wsgen.model.robot import GazeboTag, Link


# The distributions whose Gazebo Sim does not know names such as Gazebo/Red.
WITHOUT_COLOR_NAMES = ("humble", "iron")
OGRE_MATERIAL = Rule(
    code="ROB125",
    name="ogre-material",
    severity=Severity.INFO,
    summary="A robot for Gazebo Sim uses an Ogre material script.",
    what="Looks for `<material>` in `<gazebo>` elements of links whose visuals do not have a "
    "color. The names `Gazebo/NAME` are reported only for Humble and Iron: later releases know "
    "them as colors.",
    why="Gazebo Sim does not read Ogre material scripts, and draws the link in white or gray.",
    example='<gazebo reference="base_link">\n  <material>Gazebo/Red</material>\n</gazebo>',
    instead="""
<link name="base_link">
  <visual>
    <geometry>…</geometry>
    <material name="red"><color rgba="1 0 0 1"/></material>
  </visual>
</link>
""",
)
# Where sdformat has the name of a script: its own key, and that of SDF which it copies.
_SCRIPTS = ("material", "visual/material/script/name")
_COLORS = ("visual/material/ambient", "visual/material/diffuse", "visual/material/pbr")


def ogre_materials(
    links: Iterable[Link],
    tags: Iterable[GazeboTag],
    file: Path | None,
    *,
    simulator: str | None,
    distro: str | None,
) -> Iterator[Diagnostic]:
    """Report material scripts in a robot for Gazebo Sim, each once."""
    if simulator != "gz":
        return
    tags = tuple(tags)
    colored = {tag.reference for tag in tags if any(key.startswith(_COLORS) for key in tag.values)}
    plain = {
        link.name
        for link in links
        if any(visual.rgba is None and visual.texture is None for visual in link.visuals)
        and link.is_as_meant
    }
    uses: dict[str, list[tuple[GazeboTag, str]]] = {}
    for tag in tags:
        key = next((key for key in _SCRIPTS if tag.values.get(key)), None)
        if key is None or tag.reference not in plain or tag.reference in colored:
            continue
        if _is_script(tag.values[key], distro):
            uses.setdefault(tag.values[key], []).append((tag, key))
    for name, places in uses.items():
        tag, key = places[0]
        about = list(dict.fromkeys(f"`{one.reference}`" for one, _ in places))
        yield OGRE_MATERIAL.at(
            file,
            tag.line,
            f"gazebo[@reference='{tag.reference}']/{key}",
            message=f"Gazebo Sim does not read the material script `{name}`: it draws "
            f"{some_of(about)} in white or gray.",
            hint=f"Write in each <visual> of {some_of(about)}: {_instead(name)}",
        )


def _is_script(name: str, distro: str | None) -> bool:
    """Whether Gazebo Sim does not know the name; one that no Gazebo knows is reported as such."""
    if "$" in name:
        return False  # not resolved
    if name.startswith("Gazebo/"):
        return distro in WITHOUT_COLOR_NAMES and name in GAZEBO_COLORS
    return True


def _instead(name: str) -> str:
    """The color of a URDF that is meant."""
    word = name.rpartition("/")[2]
    rgba = GAZEBO_COLORS.get(f"Gazebo/{word}")
    numbers = "R G B 1" if rgba is None else " ".join(f"{part:g}" for part in rgba)
    return f'<material name="{word.lower()}"><color rgba="{numbers}"/></material>'
