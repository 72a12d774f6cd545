"""Robots that are broken, absurd or huge, each with the findings that must be among those told.

A robot with no codes is fine, however odd it looks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from urdf_texts import MASS, SPHERE, TWO, joint, link, robot, shape

if TYPE_CHECKING:
    from collections.abc import Callable

TOUCH = shape("collision", SPHERE)
WHOLE = MASS + TOUCH + shape("visual", SPHERE)


class Broken(NamedTuple):
    """A robot, as a file or as a text, and what must be said of it."""

    text: str | bytes
    codes: frozenset[str]
    is_error: bool = True


def broken(text: str | bytes, *codes: str) -> Broken:
    """A robot with errors."""
    return Broken(text, frozenset(codes))


def odd(text: str | bytes, *codes: str) -> Broken:
    """A robot with warnings, or with nothing to say of it."""
    return Broken(text, frozenset(codes), is_error=False)


def mass(number: str) -> str:
    """A link of that mass, with a moving neighbor."""
    return robot(
        link("a")
        + link("b", MASS.replace('mass value="1"', f'mass value="{number}"'))
        + joint("j", "a", "b", kind="continuous")
    )


def inertia(moments: str) -> str:
    """One link of 1 kg with these moments."""
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    reported = " ".join(
        f'{name}="{moment}"' for name, moment in zip(names, moments.split(), strict=True)
    )
    return robot(link("a", f'<inertial><mass value="1"/><inertia {reported}/></inertial>'))


def box(size: str) -> str:
    """One link with a box."""
    return robot(link("a", MASS + shape("collision", f'<box size="{size}"/>')))


def chain(count: int, kind: str = "continuous", body: str = WHOLE) -> str:
    """Links, one behind the other."""
    step = '<origin xyz="0.001 0 0"/>'
    return robot(
        "".join(link(f"l{index}", body) for index in range(count))
        + "".join(
            joint(f"j{index}", f"l{index}", f"l{index + 1}", step, kind)
            for index in range(count - 1)
        )
    )


def star(count: int, kind: str = "continuous", body: str = WHOLE) -> str:
    """Links around the first one."""
    return robot(
        link("l0")
        + "".join(link(f"l{index}", body) for index in range(1, count))
        + "".join(joint(f"j{index}", "l0", f"l{index}", "", kind) for index in range(1, count))
    )


ONE = robot(link("a", WHOLE))
LAUGHS = "".join(f'<!ENTITY lol{level} "{f"&lol{level - 1};" * 10}">' for level in range(1, 10))

MODELS = {
    # masses and moments
    "mass not a number": broken(mass("nan"), "ROB016"),
    "infinite mass": broken(mass("inf"), "ROB016"),
    "mass in words": broken(mass("heavy"), "ROB016"),
    "mass with unit": broken(mass("1kg"), "ROB016"),
    "mass too large for a number": broken(mass("1e400"), "ROB016"),
    "mass of 1e308 kg": broken(mass("1e308"), "ROB056"),
    "two masses of 1e308 kg": broken(
        robot(
            link("a", MASS.replace('mass value="1"', 'mass value="1e308"'))
            + link("b", MASS.replace('mass value="1"', 'mass value="1e308"'))
            + joint("j", "a", "b")
        ),
        "ROB056",
    ),
    "mass of 1e-400 kg": broken(mass("1e-400"), "ROB040"),
    "mass of a microgram": odd(mass("1e-9"), "ROB049"),
    "mass of a mountain": odd(mass("1e9"), "ROB049"),
    "negative mass": broken(mass("-1"), "ROB022"),
    "mass of 0": broken(mass("0"), "ROB040"),
    "mass of -0": broken(mass("-0"), "ROB040"),
    "no mass anywhere": broken(chain(3, body=TOUCH), "ROB040"),
    "inertia of 0": odd(inertia("0 0 0 0 0 0"), "ROB037"),
    "inertia of ones": broken(inertia("1 1 1 1 1 1"), "ROB037"),
    "triangle inequality": broken(inertia("1 0 0 1 0 9"), "ROB037"),
    "negative moment": broken(inertia("-1 0 0 1 0 1"), "ROB037"),
    "not a number in the inertia": broken(inertia("1 nan 0 1 0 1"), "ROB016"),
    "inertia of 1e308": broken(inertia("1e308 0 0 1e308 0 1e308"), "ROB056"),
    # the tree
    "circle": broken(robot(TWO + joint("j", "a", "b") + joint("k", "b", "a")), "ROB010"),
    "circle beside the tree": broken(
        robot(link("r") + TWO + joint("j", "a", "b") + joint("k", "b", "a")), "ROB010"
    ),
    "orphans": broken(robot(TWO + link("c")), "ROB009"),
    "two roots": broken(robot(TWO + link("c") + joint("j", "a", "c")), "ROB009"),
    "two parents": broken(
        robot(TWO + link("c") + joint("j", "a", "c") + joint("k", "b", "c")), "ROB011"
    ),
    "missing parent": broken(robot(TWO + joint("j", "x", "b")), "ROB013"),
    "missing child": broken(robot(TWO + joint("j", "a", "x")), "ROB013"),
    "joined to itself": broken(robot(TWO + joint("j", "a", "a")), "ROB012"),
    "two links of one name": broken(robot(link("a") + link("a")), "ROB007"),
    "two joints of one name": broken(
        robot(TWO + link("c") + joint("j", "a", "b") + joint("j", "a", "c")), "ROB008"
    ),
    "joint of no type": broken(robot(TWO + joint("j", "a", "b", kind="")), "ROB015"),
    "joint of unknown type": broken(robot(TWO + joint("j", "a", "b", kind="ball")), "ROB015"),
    "only joints": broken(robot(joint("j", "a", "b")), "ROB005"),
    "no link": broken(robot(""), "ROB005"),
    "world in the middle": broken(
        robot(link("a") + link("world") + joint("j", "a", "world", kind="continuous")), "ROB043"
    ),
    "only the world": broken(robot(link("world", "")), "ROB005"),
    # sizes
    "robot of a nanometre": odd(box("1e-9 1e-9 1e-9"), "ROB048"),
    "robot of a kilometer": odd(box("1000 1000 1000"), "ROB048"),
    "robot a light year away": broken(
        robot(TWO + joint("j", "a", "b", '<origin xyz="1e16 0 0"/>')), "ROB056"
    ),
    "size of 1e308": broken(box("1e308 1 1"), "ROB056"),
    "size of 0": odd(box("0 1 1"), "ROB028"),
    "size of -1": broken(box("1 -1 1"), "ROB028"),
    "size not a number": broken(box("nan 1 1"), "ROB016"),
    "scale of 0": broken(
        robot(link("a", MASS + shape("collision", '<mesh filename="a.stl" scale="0 0 0"/>'))),
        "ROB028",
    ),
    # the text
    "empty file": broken(b"", "ROB001"),
    "only blanks": broken(" \n\t\n", "ROB001"),
    "only a comment": broken("<!-- robot -->", "ROB001"),
    "binary file": broken(bytes(range(256)) * 64, "ROB057"),
    "picture": broken(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR", "ROB057"),
    "UTF-16": broken(ONE.encode("utf-16-be"), "ROB057"),
    "UTF-32": broken(ONE.encode("utf-32"), "ROB057"),
    "UTF-8 with its mark": odd(b"\xef\xbb\xbf" + ONE.encode()),
    "Latin-1 in a comment": odd(b"<!-- f\xfcr -->" + ONE.encode(), "ROB057"),
    "half a character": odd(ONE.replace('"a"', '"a\ud800"')),
    "null characters behind": odd(ONE.encode() + b"\0\0"),
    "null character": broken(ONE.replace('"a"', '"a\0"'), "ROB001"),
    "JSON": broken('{"robot": 1}', "ROB001"),
    "HTML": broken("<html><body>404</body></html>", "ROB003"),
    "SDF": broken("<sdf version='1.9'><model name='m'/></sdf>", "ROB003"),
    "other root": broken("<u:robot xmlns:u='http://x' name='r'/>", "ROB003"),
    "comments in between": odd(
        "<!-- a -->"
        + ONE.replace("<link", "<!-- b --><link").replace("</link>", "</link><!-- c -->")
    ),
    "instruction before": odd("<?xml version='1.0'?><?xml-model href='x'?>" + ONE),
    "instruction in between": broken(ONE.replace("<link", "<?php 1 ?><link"), "ROB001"),
    "default namespace": odd(ONE.replace("<robot", "<robot xmlns='http://www.ros.org'")),
    "other elements": odd(robot(link("a", WHOLE) + "<m:x xmlns:m='http://m'><m:y/></m:x>")),
    "deep nesting": broken(robot("<x>" * 100_000 + "</x>" * 100_000 + link("a")), "ROB001"),
    "deep nesting of gazebo elements": odd(
        robot(link("a", WHOLE) + "<gazebo>" + "<x>" * 200 + "</x>" * 200 + "</gazebo>")
    ),
    "billion laughs": broken(
        f'<!DOCTYPE r [<!ENTITY lol0 "lol">{LAUGHS}]>' + robot("&lol9;" + link("a")), "ROB002"
    ),
    "outer entity": broken(
        '<!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]>' + robot("&x;" + link("a")),
        "ROB002",
    ),
    "never closed": broken(ONE[:-9], "ROB001"),
    "cut off": broken(ONE[: len(ONE) // 2], "ROB001"),
    "left over of xacro": broken(
        robot('<xacro:include filename="x"/>' + link("${prefix}a", WHOLE)), "ROB143"
    ),
    # names
    "Greek": odd(ONE.replace('"a"', '"βάση"').replace('"r"', '"ρομπότ"')),
    "emoji": odd(ONE.replace('"a"', '"🤖"')),
    "right to left": odd(ONE.replace('"a"', '"\u202eabc"')),
    "blanks and slashes": odd(ONE.replace('"a"', '"a / b\\c"')),
    "a name of 100,000 letters": odd(ONE.replace('"a"', f'"{"a" * 100_000}"')),
    "a name of blanks": broken(ONE.replace('"a"', '"  "'), "ROB006"),
    "name of a path": odd(ONE.replace('"a"', '"../../etc/passwd"')),
}

# Each is made when it is asked for: together they are 150 MB.
HUGE: dict[str, Callable[[], Broken]] = {
    "4,000 links in a chain": lambda: odd(chain(4_000)),
    "4,000 links in a rigid chain": lambda: odd(chain(4_000, "fixed")),
    "4,000 links in a star": lambda: odd(star(4_000)),
    "4,000 links without mass": lambda: broken(star(4_000, body=TOUCH), "ROB040"),
    "4,000 loose links": lambda: odd(chain(4_000, "floating"), "ROB055"),
    "4,000 links in a circle": lambda: broken(
        chain(4_000).replace("</robot>", joint("z", "l3999", "l0") + "</robot>"), "ROB010"
    ),
    "4,000 tags about a rigid chain": lambda: odd(
        chain(4_000, "fixed").replace(
            "</robot>",
            "".join(f'<gazebo reference="l{n}"><mu1>1</mu1></gazebo>' for n in range(4_000))
            + "</robot>",
        )
    ),
    "2,000 misspelt links": lambda: broken(
        star(2_000).replace('parent link="l0"', 'parent link="l_0"'), "ROB013"
    ),
    "2,000 misspelt references": lambda: odd(
        star(2_000).replace(
            "</robot>",
            "".join(f'<gazebo reference="link{n}"><mu1>1</mu1></gazebo>' for n in range(2_000))
            + "</robot>",
        ),
        "ROB030",
    ),
    "30 MB of links": lambda: broken(chain(80_000), "ROB002"),
    "30 MB of a comment": lambda: broken(
        robot("<!--" + "x " * 15_000_000 + "-->" + link("a")), "ROB002"
    ),
    "nearly as large as may be": lambda: broken(
        robot("<x>" * 50 + "y" * 7_000_000 + "</x>" * 50 + "<x " * 100_000), "ROB001"
    ),
}
