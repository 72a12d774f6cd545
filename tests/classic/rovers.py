"""Rovers of our own that the real Gazebo Classic drives: URDF, and what drives them.

Lengths are in sizes, half of the length of the box, so that all are alike.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from wsgen.model.behavior import Bounds, DiffDrive, WheelPair

ACCELERATION = 2.0  # m/s², that the plugin gives the wheels' rims


class Rover(NamedTuple):
    """A box on wheels and casters."""

    mass: float = 5.0  # kg, of the box; a wheel has a twentieth of it
    size: float = 0.2  # m
    width: float = 0.02  # of wheels
    casters: tuple[float, ...] = (-0.8,)  # before the middle
    slip: float | None = 0.1  # friction of casters; None: Gazebo's default
    grip: float | None = None  # of wheels, likewise
    axles: tuple[float, ...] = (0.0,)
    has_balls: bool = False  # for wheels
    direction: str = ""  # of friction, <fdir1>
    push: float = 5.0  # m/s², that each wheel's motor could give the box

    @property
    def height(self) -> float:
        """At which it is spawned, m."""
        return 0.5 * self.size + 0.002

    @property
    def drive(self) -> DiffDrive:
        """As a plugin for Gazebo Classic has it."""
        radius = 0.2 * self.size
        return DiffDrive(
            simulator="classic",
            pairs=tuple(
                WheelPair(
                    left=f"left{number}_joint",
                    right=f"right{number}_joint",
                    separation=1.1 * self.size,
                    radius=radius,
                )
                for number in range(len(self.axles))
            ),
            torque=self.push * self.mass * radius,
            rim=Bounds(braking=-ACCELERATION, acceleration=ACCELERATION),
        )

    @property
    def urdf(self) -> str:
        size, radius = self.size, 0.2 * self.size
        x, y, z = 2 * size, size, 0.3 * size
        xx, yy, zz = (self.mass / 12 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y)))
        middle = -0.25 * size if self.casters == (-0.8,) else 0.0
        base = _inertial(self.mass, (xx, yy, zz), f"xyz='{middle} 0 0'")
        parts = [_link("base", base, f"<box size='{x} {y} {z}'/>")]
        for number, at in enumerate(self.casters):
            mass = self.mass / 50
            moment = 0.4 * mass * radius**2
            solid = _inertial(mass, (moment, moment, moment))
            parts.append(_link(f"ball{number}", solid, f"<sphere radius='{radius}'/>"))
            parts.append(_joint(f"ball{number}", "fixed", (at * size, 0.0, -0.3 * size)))
            parts.append(_surface(f"ball{number}", self.slip))
        for number, at in enumerate(self.axles):
            for side, way in (("left", 0.55), ("right", -0.55)):
                name, mass = f"{side}{number}", self.mass / 20
                across, along = mass * radius**2 / 4, mass * radius**2 / 2
                turned = f"xyz='0 0 0' rpy='{math.pi / 2} 0 0'"
                shape = f"<cylinder radius='{radius}' length='{self.width * size}'/>"
                if self.has_balls:
                    shape = f"<sphere radius='{radius}'/>"
                solid = _inertial(mass, (across, across, along), turned)
                parts.append(_link(name, solid, shape, turned))
                parts.append(_joint(name, "continuous", (at * size, way * size, -0.3 * size)))
                parts.append(_surface(name, self.grip, self.direction))
        return f"<robot name='rover'>{''.join(parts)}</robot>"


def _inertial(mass: float, moments: tuple[float, float, float], origin: str = "xyz='0 0 0'") -> str:
    xx, yy, zz = moments
    return (
        f"<inertial><origin {origin}/><mass value='{mass}'/><inertia ixx='{xx}' iyy='{yy}' "
        f"izz='{zz}' ixy='0' ixz='0' iyz='0'/></inertial>"
    )


def _link(name: str, inertial: str, shape: str, origin: str = "xyz='0 0 0'") -> str:
    collision = f"<collision><origin {origin}/><geometry>{shape}</geometry></collision>"
    return f"<link name='{name}'>{inertial}{collision}</link>"


def _joint(child: str, kind: str, at: tuple[float, float, float]) -> str:
    return (
        f"<joint name='{child}_joint' type='{kind}'><parent link='base'/><child link='{child}'/>"
        f"<origin xyz='{at[0]} {at[1]} {at[2]}'/><axis xyz='0 1 0'/></joint>"
    )


def _surface(link: str, mu: float | None, direction: str = "") -> str:
    said = "" if mu is None else f"<mu1>{mu}</mu1><mu2>{mu}</mu2>"
    said += f"<fdir1>{direction}</fdir1>" if direction else ""
    return f"<gazebo reference='{link}'>{said}</gazebo>" if said else ""


FOUR = Rover(35.0, 0.5, 0.1, (), axles=(0.4, -0.4))
ROVERS = {
    "smooth caster": Rover(slip=0.0),
    "two casters": Rover(casters=(0.8, -0.8)),
    "thin wheels": Rover(width=0.005),
    "wide wheels": Rover(width=0.2),
    "balls for wheels": Rover(has_balls=True),
    "heavy": Rover(500.0, 1.0),
    "light": Rover(0.5, 0.06),
    "wheels of little friction": Rover(grip=0.3),
    "wheels of much friction": Rover(grip=100.0),
    "four wheels": FOUR,
    "four strong wheels": FOUR._replace(push=50.0),
    "four wheels of little friction": FOUR._replace(grip=0.3),
    "four wheels with a direction": FOUR._replace(direction="1 0 0"),
}
