"""Worlds in which everything comes to rest: what stands, leans, hangs, tips over or is stacked.

Each is the models of a world with Gazebo's ground plane, as SDF 1.6. Lengths in m, angles in rad,
masses in kg.
"""

from __future__ import annotations

from wsgen.model.inertia import of_solid
from wsgen.model.robot import Box, Cylinder, Sphere

Shape = Box | Cylinder | Sphere

CUBE = Box(size=(0.2, 0.2, 0.2))
PLATE = Box(size=(0.6, 0.4, 0.05))
ROD = Box(size=(0.05, 0.05, 0.6))
BALL = Sphere(radius=0.1)
CAN = Cylinder(radius=0.1, length=0.3)
WHEEL = Cylinder(radius=0.1, length=0.04)


def link(
    name: str,
    shape: Shape,
    at: str = "0 0 0 0 0 0",
    *,
    mass: float = 1.0,
    center: str = "0 0 0",
    mu: float = 1.0,
    more: str = "",
) -> str:
    """A link of one shape, evenly filled but for where its center of mass is."""
    moments = of_solid(shape, mass)
    assert moments is not None
    x, y, z = moments
    match shape:
        case Box():
            geometry = f"<box><size>{' '.join(map(str, shape.size))}</size></box>"
        case Sphere():
            geometry = f"<sphere><radius>{shape.radius}</radius></sphere>"
        case Cylinder():
            size = f"<radius>{shape.radius}</radius><length>{shape.length}</length>"
            geometry = f"<cylinder>{size}</cylinder>"
    return f"""<link name="{name}"><pose>{at}</pose>
  <inertial><pose>{center} 0 0 0</pose><mass>{mass}</mass>
    <inertia><ixx>{x}</ixx><iyy>{y}</iyy><izz>{z}</izz></inertia></inertial>
  <collision name="c"><geometry>{geometry}</geometry>
    <surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface></collision>
  {more}</link>"""


def joint(
    child: str,
    kind: str = "revolute",
    axis: str = "0 1 0",
    *,
    parent: str = "base",
    limits: str = "",
    dynamics: str = "",
    at: str = "0 0 0",
) -> str:
    return f"""<joint name="{child}" type="{kind}"><pose>{at} 0 0 0</pose>
  <parent>{parent}</parent><child>{child}</child>
  <axis><xyz>{axis}</xyz><limit>{limits}</limit><dynamics>{dynamics}</dynamics></axis></joint>"""


def fixed(child: str) -> str:
    return f'<joint name="{child}" type="fixed"><parent>base</parent><child>{child}</child></joint>'


def model(*parts: str, at: str = "0 0 0.1 0 0 0", name: str = "one", static: bool = False) -> str:
    first = "<static>true</static>" if static else ""
    return f'<model name="{name}">{first}<pose>{at}</pose>{"".join(parts)}</model>'


def single(
    shape: Shape, at: str, *, name: str = "one", static: bool = False, **more: object
) -> str:
    return model(link("base", shape, **more), at=at, name=name, static=static)  # type: ignore[arg-type]


def limits(lower: float, upper: float) -> str:
    return f"<lower>{lower}</lower><upper>{upper}</upper>"


def cart(*casters: str, wheels: tuple[tuple[float, float], ...], mass: float = 5.0) -> str:
    """A plate on wheels at these places, and what else carries it."""
    parts = [link("base", PLATE, mass=mass), *casters]
    for number, (x, y) in enumerate(wheels):
        name = f"wheel{number}"
        parts += [link(name, WHEEL, f"{x} {y} 0 1.5707963 0 0"), joint(name, axis="0 0 1")]
    return model(*parts, at="0 0 0.105 0 0 0")


def caster(x: float, z: float, mu: float = 0.0, radius: float = 0.04) -> str:
    name = f"caster{'' if x < 0 else '_front'}"
    return link(name, Sphere(radius=radius), f"{x} 0 {z} 0 0 0", mass=0.2, mu=mu) + fixed(name)


def rim(x: int, y: int) -> str:
    """A side of a tray, in that direction."""
    name = f"rim{x}{y}"
    bar = Box(size=(0.02 + 0.5 * abs(y), 0.02 + 0.5 * abs(x), 0.1))
    return link(name, bar, f"{x * 0.26} {y * 0.26} 0.05 0 0 0") + fixed(name)


FOUR = ((0.2, 0.25), (0.2, -0.25), (-0.2, 0.25), (-0.2, -0.25))
TWO = ((0.0, 0.25), (0.0, -0.25))
STILL_LIFES = {
    "cube": single(CUBE, "0 0 0.1 0 0 0"),
    "cube, dropped from 5 cm": single(CUBE, "0 0 0.15 0 0 0"),
    "cube, turned": single(CUBE, "0.5 0.5 0.1 0 0 0.7"),
    "cube, tilted by 0.3": single(CUBE, "0 0 0.13 0.3 0 0"),
    "cube, in the ground": single(CUBE, "0 0 0.097 0 0 0"),
    "cube of 1 g": single(CUBE, "0 0 0.1 0 0 0", mass=0.001),
    "cube of 1 t": single(CUBE, "0 0 0.1 0 0 0", mass=1000.0),
    "rod, upright": single(ROD, "0 0 0.3 0 0 0"),
    "rod, tips": single(ROD, "0 0 0.31 0.2 0 0"),
    "rod, flat": single(ROD, "0 0 0.03 0 1.5707963 0"),
    "can, upright": single(CAN, "0 0 0.15 0 0 0"),
    "can, tilted by 0.2": single(CAN, "0 0 0.17 0.2 0 0"),
    "can, lying": single(CAN, "0 0 0.1 1.5707963 0 0"),
    "ball": single(BALL, "0 0 0.1 0 0 0"),
    "ball with a low center": single(BALL, "0 0 0.1 0 0 0", center="0 0 -0.05"),
    "cube with its center beside": single(CUBE, "0 0 0.1 0 0 0", center="0.06 0 0"),
    "cube with its center outside, tips": single(CUBE, "0 0 0.1 0 0 0", center="0.13 0 0.02"),
    "stack of three": "".join(
        single(CUBE, f"0 0 {0.1 + 0.2 * place} 0 0 0", name=f"cube{place}") for place in range(3)
    ),
    "stack of three, shifted": "".join(
        single(CUBE, f"{0.04 * place} 0 {0.1 + 0.2 * place} 0 0 0", name=f"cube{place}")
        for place in range(3)
    ),
    "plate across two cubes": single(CUBE, "0.2 0 0.1 0 0 0", name="right")
    + single(CUBE, "-0.2 0 0.1 0 0 0", name="left")
    + single(PLATE, "0 0 0.225 0 0 0"),
    "light on heavy": single(CUBE, "0 0 0.1 0 0 0", name="below", mass=50)
    + single(CUBE, "0 0 0.3 0 0 0", mass=0.1),
    "on a static table": single(PLATE, "0 0 0.5 0 0 0", name="table", static=True)
    + single(CUBE, "0.1 0 0.625 0 0 0"),
    "leans against a wall": single(
        Box(size=(0.1, 2.0, 1.0)), "0.3 0 0.5 0 0 0", name="wall", static=True
    )
    + single(ROD, "0.14 0 0.29 0 0.3 0", mu=2),
    "on a ramp of 0.3": single(
        Box(size=(2.0, 1.0, 0.1)), "0 0 0.5 0 0.3 0", name="ramp", static=True
    )
    + single(CUBE, "0.0443 0 0.6433 0 0.3 0"),
    "in a corner": single(Box(size=(2, 0.1, 1)), "0 0.2 0.5 0 0 0", name="wall", static=True)
    + single(Box(size=(0.1, 2, 1)), "0.2 0 0.5 0 0 0", name="other", static=True)
    + single(BALL, "0.05 0.05 0.1 0 0 0"),
    "ball on a tray": model(
        link("base", Box(size=(0.6, 0.6, 0.02)), "0 0 0.01 0 0 0"),
        *(rim(x, y) for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))),
        at="0 0 0 0 0 0",
        name="tray",
    )
    + single(BALL, "0 0 0.12 0 0 0"),
    "cart on four wheels": cart(wheels=FOUR),
    "heavy cart on four wheels": cart(wheels=FOUR, mass=200),
    "cart, two wheels and a caster": cart(
        caster(-0.2, -0.06), wheels=((0.15, 0.25), (0.15, -0.25))
    ),
    "cart, two wheels and a high caster": cart(
        caster(-0.2, -0.04), wheels=((0.15, 0.25), (0.15, -0.25))
    ),
    "cart, two wheels and a low caster": cart(
        caster(-0.2, -0.08), wheels=((0.15, 0.25), (0.15, -0.25))
    ),
    "cart, two wheels and two casters": cart(caster(-0.2, -0.06), caster(0.2, -0.06), wheels=TWO),
    "cart, two wheels alone, tips": cart(wheels=((0.05, 0.25), (0.05, -0.25))),
    "cart, three wheels": cart(wheels=((0.2, 0.0), (-0.2, 0.25), (-0.2, -0.25))),
    "cart on springs": model(
        link("base", PLATE, mass=5),
        *(
            link(f"foot{number}", Sphere(radius=0.05), f"{x} {y} -0.05 0 0 0", mass=0.5, mu=0)
            + joint(
                f"foot{number}",
                "prismatic",
                "0 0 1",
                limits=limits(-0.1, 0.1),
                dynamics="<damping>50</damping><spring_stiffness>2000</spring_stiffness>",
            )
            for number, (x, y) in enumerate(FOUR)
        ),
    ),
    "hinge at its stop": model(
        link("base", Box(size=(0.5, 0.5, 0.1)), "0 0 0.05 0 0 0", mass=20),
        link("lid", Box(size=(0.3, 0.2, 0.02)), "0.15 0 0.3 0 0 0"),
        joint("lid", at="-0.15 0 0", limits=limits(-0.5, 0.4)),
        at="0 0 0 0 0 0",
    ),
    "pendulum, damped": model(
        link("base", Box(size=(0.5, 0.5, 0.1)), "0 0 0.05 0 0 0", mass=20),
        link("arm", ROD, "0.4 0 0.8 0 0.5 0"),
        joint("arm", at="0 0 0.3", dynamics="<damping>1.5</damping>"),
        at="0 0 0 0 0 0",
    ),
    "slider falls to its stop": model(
        link("base", Box(size=(0.5, 0.5, 0.1)), "0 0 0.05 0 0 0", mass=20),
        link("slider", CUBE, "0 0 0.6 0 0 0"),
        joint("slider", "prismatic", "0 0 1", limits=limits(-0.2, 0.2)),
        at="0 0 0 0 0 0",
    ),
    "arm that friction holds": model(
        link("base", Box(size=(0.5, 0.5, 0.1)), "0 0 0.05 0 0 0", mass=20),
        link("arm", ROD, "0 0 0.5 0 0.1 0"),
        joint("arm", at="0 0 -0.3", dynamics="<friction>5</friction>"),
        at="0 0 0 0 0 0",
    ),
    "without gravity": single(CUBE, "0 0 1 0 0 0", more="<gravity>false</gravity>"),
    "static": single(CUBE, "0 0 1 0.3 0.2 0", static=True),
    "seesaw": single(Box(size=(0.1, 0.4, 0.3)), "0 0 0.15 0 0 0", name="block", static=True)
    + single(PLATE, "0.02 0 0.325 0 0 0", center="0.1 0 0"),
}


def world_of(models: str) -> str:
    """The file of a world with these models."""
    return f"""<?xml version="1.0"?>
<sdf version="1.6"><world name="w">
<include><uri>model://ground_plane</uri></include>
{models}
</world></sdf>
"""
