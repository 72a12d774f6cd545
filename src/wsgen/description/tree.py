"""Whether links and joints make one tree.

This is looked at before any engine or tool sees the file: PyBullet ends with SIGSEGV on two
roots, a cycle or two joints of one name, and check_urdf and sdformat print without end on a cycle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.description.findings import line_of
from wsgen.description.spelling import nearest
from wsgen.suggestions import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Sequence

    from wsgen.description.findings import Findings
    from wsgen.model.robot import Joint
    from wsgen.xmltree import Element

NAMED = 5  # so many names are told in a message


def unique_names(findings: Findings, elements: Sequence[Element], code: str) -> dict[str, Element]:
    """The elements by their names; a missing or a repeated name is reported and left out."""
    named: dict[str, Element] = {}
    for element in elements:
        name = element.get("name") or ""
        if not name.strip():
            findings.missing(
                "ROB006",
                f"A {element.tag} has no name.",
                hint=f'Write <{element.tag} name="NAME">.',
                at=element,
                path=str(element.tag),
                name="name",
            )
        elif name in named:
            findings.error(
                code,
                f"Two {element.tag}s are called `{name}` (the other one is in line "
                f"{line_of(named[name])}).",
                hint="Give each its own name; in a xacro macro, put a prefix parameter before it.",
                at=element,
                path=f"{element.tag}[@name='{name}']",
            )
        else:
            named[name] = element
    return named


def find_root(
    findings: Findings,
    robot: Element,
    links: dict[str, Element],
    joints: Sequence[tuple[Joint, Element]],
) -> str | None:
    """The link that every other one hangs on; None where there is no tree, which is reported."""
    before = len(findings.errors)
    parent_of: dict[str, tuple[Joint, Element]] = {}
    for joint, element in joints:
        path = f"joint[@name='{joint.name}']"
        if _check_ends(findings, joint, element, path, links, robot):
            if joint.child in parent_of:
                other = parent_of[joint.child][0]
                findings.error(
                    "ROB011",
                    f"The link `{joint.child}` has two parents: `{other.parent}` by the joint "
                    f"`{other.name}`, and `{joint.parent}`.",
                    hint="A URDF is a tree: remove one of the joints. Closed chains need SDF.",
                    at=element,
                    path=path,
                )
            else:
                parent_of[joint.child] = (joint, element)
    if len(findings.errors) > before:
        return None
    roots = [name for name in links if name not in parent_of]
    _report_cycle(findings, parent_of)
    many = f"{len(roots)} links have no parent ({_some(roots)}): there must be exactly one root."
    if len(roots) > 1 and not findings.blame_misspelt(robot, "joint", many):
        findings.error(
            "ROB009",
            many,
            hint=f"Join `{roots[1]}` to the rest with a joint whose child it is.",
            at=links[roots[1]],
            path=f"link[@name='{roots[1]}']",
        )
    return roots[0] if len(findings.errors) == before else None


def _check_ends(  # noqa: PLR0913, PLR0917  a joint, and what it is in
    findings: Findings,
    joint: Joint,
    element: Element,
    path: str,
    links: dict[str, Element],
    robot: Element,
) -> bool:
    for end, name in (("parent", joint.parent), ("child", joint.child)):
        message = f"The {end} of the joint `{joint.name}` is `{name}`, and no link is called so."
        if name not in links and not findings.blame_misspelt(robot, f"link {name}", message):
            near = nearest(findings, name, links)
            findings.error(
                "ROB013",
                message,
                hint=did_you_mean(near) if near else f'Add <link name="{name}">.',
                at=element,
                path=path,
            )
    if joint.parent == joint.child:
        findings.error(
            "ROB012",
            f"The joint `{joint.name}` joins the link `{joint.parent}` to itself.",
            hint="Name two different links as parent and child.",
            at=element,
            path=path,
        )
    return joint.parent in links and joint.child in links and joint.parent != joint.child


def _report_cycle(findings: Findings, parent_of: dict[str, tuple[Joint, Element]]) -> None:
    """Report one cycle, if any: following parents from a link leads back to a link on the way."""
    harmless: set[str] = set()
    for start in parent_of:
        way: dict[str, None] = {}
        link = start
        while link in parent_of and link not in harmless and link not in way:
            way[link] = None
            link = parent_of[link][0].parent
        if link in way:
            names = list(way)
            cycle = names[names.index(link) :][::-1]
            joint, element = parent_of[link]
            findings.error(
                "ROB010",
                f"The links go in a circle: {_some(cycle)}, and back to `{cycle[0]}`.",
                hint="A URDF is a tree: remove the joint that closes the circle.",
                at=element,
                path=f"joint[@name='{joint.name}']",
            )
            return
        harmless.update(way)


def _some(names: Sequence[str]) -> str:
    told = ", ".join(f"`{name}`" for name in names[:NAMED])
    return told if len(names) <= NAMED else f"{told} and {len(names) - NAMED} more"
