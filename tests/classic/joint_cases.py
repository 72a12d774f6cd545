"""Robots whose joints the real Gazebo Classic moves: each says what it is about."""

from __future__ import annotations

WORLD = "<link name='world'/>"


def link(name: str, mass: float = 1.0, *, at: str = "0.25 0 0", shape: str = "") -> str:
    """A link with its center of mass there, and the moments of a ball of its mass."""
    moment = 0.02 * mass
    inertia = f"ixx='{moment}' iyy='{moment}' izz='{moment}' ixy='0' ixz='0' iyz='0'"
    collision = f"<collision><geometry><box size='{shape}'/></geometry></collision>"
    return (
        f"<link name='{name}'><inertial><origin xyz='{at}'/><mass value='{mass}'/>"
        f"<inertia {inertia}/></inertial>{collision if shape else ''}</link>"
    )


def joint(
    name: str,
    parent: str,
    child: str,
    more: str = "",
    *,
    kind: str = "continuous",
    axis: str = "0 1 0",
    origin: str = "xyz='0 0 0'",
) -> str:
    return (
        f"<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/>"
        f"<origin {origin}/><axis xyz='{axis}'/>{more}</joint>"
    )


def robot(*parts: str) -> str:
    return f"<robot name='r'>{''.join(parts)}</robot>"


def limit(lower: float, upper: float, effort: float = 100, velocity: float = 100) -> str:
    return f"<limit lower='{lower}' upper='{upper}' effort='{effort}' velocity='{velocity}'/>"


def dynamics(damping: float = 0.0, friction: float = 0.0) -> str:
    return f"<dynamics damping='{damping}' friction='{friction}'/>"


def of(name: str, **keys: object) -> str:
    """The `<gazebo>` of a link or a joint."""
    said = "".join(f"<{key}>{value}</{key}>" for key, value in keys.items())
    return f"<gazebo reference='{name}'>{said}</gazebo>"


def bar(more: str = "", *parts: str, **other: str) -> str:
    """A pendulum that is held out sideways: the joint j, 1 kg at 0.5 m, 0.27 kg m²."""
    pivot = joint("j", "world", "bar", more, **other)
    return robot(WORLD, link("bar", at="0.5 0 0"), pivot, *parts)


def lift(more: str, mass: float = 1.0) -> str:
    """A body on a vertical slide."""
    slide = joint("j", "world", "cabin", more, kind="prismatic", axis="0 0 1")
    return robot(WORLD, link("cabin", mass, at="0 0 0"), slide)


def two(first: str, second: str, *parts: str, kind: str = "continuous", mass: float = 1.0) -> str:
    """Two pendulums, one at the end of the other, held out sideways."""
    return robot(
        *(WORLD, link("a", mass), link("b")),
        joint("j", "world", "a", first, kind=kind),
        joint("k", "a", "b", second, kind=kind, origin="xyz='0.5 0 0'"),
        *parts,
    )


def crossing(*parts: str) -> str:
    """Two bars on joints of their own, of which one falls onto the other."""
    return robot(
        *(WORLD, link("a", shape="0.1 0.1 0.1"), link("b", shape="1 0.1 0.1")),
        joint("j", "world", "a", dynamics(0.5), origin="xyz='0 0 0.3'"),
        joint("k", "world", "b", dynamics(1)),
        *parts,
    )


TURNED = robot(
    *(WORLD, link("a", at="0.25 0.1 0"), link("b", at="0.25 0 0.2")),
    joint("j", "world", "a", dynamics(0.3), axis="1 1 0", origin="rpy='0.3 0 0.5'"),
    joint("k", "a", "b", dynamics(0.3), axis="0 1 2", origin="xyz='0.5 0 0' rpy='0 0.7 0'"),
)
SPRING = of("j", springStiffness=20, springReference=0.3)
HELD = of("j", implicitSpringDamper="true")
CASES = {
    # Passive, damped, with friction.
    "passive": bar(),
    "damping": bar(dynamics(0.5)),
    "strong damping": bar(dynamics(100)),
    "almost too strong damping": bar(dynamics(500)),
    "too strong damping": bar(dynamics(600)),
    "too strong damping, implicit": bar(dynamics(600), HELD),
    "friction": bar(dynamics(friction=1)),
    "friction that holds": bar(dynamics(friction=6)),
    "friction and damping": bar(dynamics(1, 1)),
    "slide with friction": lift(limit(-2, 1) + dynamics(friction=5)),
    "slide with damping": lift(limit(-2, 1) + dynamics(20)),
    "damping of links": bar("", of("bar", dampingFactor=0.01)),
    "damping of turned links": TURNED.replace(
        "</robot>", of("a", dampingFactor=0.004) + of("b", dampingFactor=0.02) + "</robot>"
    ),
    # Limits.
    "stop": bar(limit(-0.2, 0.5), kind="revolute"),
    "stop, damped": bar(limit(-0.2, 0.5) + dynamics(1), kind="revolute"),
    "slide to a stop": lift(limit(-0.2, 1)),
    "heavy slide to a stop": lift(limit(-0.2, 1), mass=500),
    "no effort and no speed": bar(limit(-3, 3, 0, 0) + dynamics(0.5), kind="revolute"),
    "limits of a continuous joint": bar(limit(-0.2, 0.5) + dynamics(0.5)),
    "two stops": two(limit(-0.3, 0.6), limit(-0.2, 0.4), kind="revolute"),
    "begins beyond its limit": bar(limit(0.05, 3) + dynamics(1), kind="revolute"),
    "soft stop": bar(limit(-0.2, 0.5), of("j", stopErp=0.8, stopCfm=0.1), kind="revolute"),
    # Springs.
    "spring": bar("", SPRING),
    "spring with damping": bar(dynamics(2), SPRING),
    "spring with damping, implicit": bar(dynamics(2), SPRING, HELD),
    "spring, implicit": bar("", SPRING, HELD),
    "spring of a body in the air": robot(link("a"), link("b"), joint("j", "a", "b"), SPRING),
    "too stiff spring": bar("", of("j", springStiffness=2e6)),
    # Several joints.
    "two pendulums": two(dynamics(0.1), dynamics(0.1)),
    "two pendulums, damped": two(dynamics(0.5), dynamics(0.2, 0.1)),
    "turned axes": TURNED,
    "mimic": two(
        limit(-3, 3) + dynamics(0.5),
        limit(-3, 3) + dynamics(0.2) + "<mimic joint='j' multiplier='-1'/>",
        kind="revolute",
    ),
    "kept fixed": two(
        dynamics(1), "", of("k", preserveFixedJoint="true"), kind="continuous"
    ).replace("'k' type='continuous'", "'k' type='fixed'"),
    "not lumped": two(
        dynamics(1), "", of("k", disableFixedJointLumping="true"), kind="continuous"
    ).replace("'k' type='continuous'", "'k' type='fixed'"),
    # Flags.
    "no gravity": bar("", of("bar", turnGravityOff="true")),
    "no gravity of one": two(dynamics(0.5), dynamics(0.2), of("b", turnGravityOff="true")),
    "body without gravity": robot(
        link("a"), link("b"), joint("j", "a", "b", dynamics(0.1)), of("a", turnGravityOff="true")
    ),
    "feedback": bar(dynamics(0.5), of("j", provideFeedback="true")),
    "kinematic": two("", "", of("a", kinematic="true")),
    "crossing": crossing(),
    "self-collide": crossing(of("a", selfCollide="true"), of("b", selfCollide="true")),
    "self-collide of one": crossing(of("a", selfCollide="true")),
    "self-collide of the model": crossing("<gazebo><self_collide>true</self_collide></gazebo>"),
}
