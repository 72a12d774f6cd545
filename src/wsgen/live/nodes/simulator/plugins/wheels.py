"""Where a robot is by its wheels, and robots that these do not take along. SI units.

Commands, odometry of the wheels and joint states look as they should then, and no node can see why
the robot stays where it is.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from wsgen.live.nodes.simulator.messages import yaw_of
from wsgen.model.robot import LITTLE_GRIP
from wsgen.model.transform import compose, invert
from wsgen.simulation.surfaces import UnreadError, reach_down, there

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from wsgen.live.nodes.simulator.host import Host, RobotHandle
    from wsgen.model.behavior import WheelPair


STRAIGHT = 1e-6  # rad, of an arc that is as good as straight


class WheelOdometry:
    """Where a robot is by how far its two wheels have turned, as `gz::math::DiffDriveOdometry`.

    Attributes:
        x: m, where it began to the front.
        y: m, to the left.
        heading: rad, whole turns included.
        linear: m/s, in the last update.
        angular: rad/s, likewise.
    """

    def __init__(self, separation: float, left_radius: float, right_radius: float) -> None:
        self._separation = separation
        self._radii = left_radius, right_radius
        self._last: tuple[float, float, float] | None = None
        self.x = self.y = self.heading = self.linear = self.angular = 0.0

    def update(self, left: float, right: float, now: float) -> None:
        """Take in the positions of the wheels (rad) at a time (s)."""
        last, self._last = self._last, (left, right, now)
        if last is None or now <= last[2]:
            return
        ways = (left - last[0]) * self._radii[0], (right - last[1]) * self._radii[1]
        way, turn = (ways[0] + ways[1]) / 2, (ways[1] - ways[0]) / self._separation
        if abs(turn) < STRAIGHT:
            direction = self.heading + turn / 2
            self.x += way * math.cos(direction)
            self.y += way * math.sin(direction)
        else:
            radius, after = way / turn, self.heading + turn
            self.x += radius * (math.sin(after) - math.sin(self.heading))
            self.y -= radius * (math.cos(after) - math.cos(self.heading))
        self.heading += turn
        self.linear, self.angular = way / (now - last[2]), turn / (now - last[2])

    def reset(self) -> None:
        """Begin again where it is."""
        self._last = None
        self.x = self.y = self.heading = self.linear = self.angular = 0.0


WINDOW = 2.0  # s, simulated
LEAST_WAY = 0.2  # m in a window, that the wheels have turned; less is too little to judge
LEAST_TURN = 1.0  # rad, likewise
SLIPPING = 0.5  # of the way by the wheels
TURNING = 0.2  # of the turn by the wheels; those of skid steering slip by more than half
DRAGGING = 0.1  # friction coefficient; what has less hardly holds a robot
HANGING = 0.002  # m above the lowest point of the robot; engines have margins of 1 mm
NAMED = 2  # at most so many wheels are named
CLEAR = 0.02  # m above the lowest point of the wheels; what is higher does not drag on flat ground


class SlipWatch:
    """Compares twice in four seconds how a robot has moved with how its wheels have turned."""

    def __init__(
        self, host: Host, robot: RobotHandle, wheels: WheelPair, driven: Collection[str]
    ) -> None:
        """Watch two wheels of a robot, of all `driven` joints; `host` reports their slip."""
        self._host, self._robot, self._wheels = host, robot, wheels
        self._driven = driven
        self._is_over = False
        self._begin()

    def _begin(self) -> None:
        self._due = self._host.now + WINDOW
        self._placed = self._robot.times_placed
        self._turned = self._positions()
        self._state = self._robot.state()

    def _positions(self) -> tuple[float, float]:
        positions = self._robot.joint_positions()
        return positions[self._wheels.left], positions[self._wheels.right]

    def look(self) -> None:
        """Compare, if it is time to; costs nothing before."""
        if self._host.now < self._due or self._is_over:
            return
        turned, placed, state = self._turned, self._placed, self._state
        self._begin()
        if placed == self._placed:
            left, right = (
                (new - old) * self._wheels.radius
                for new, old in zip(self._turned, turned, strict=True)
            )
            heading = math.remainder(yaw_of(self._state.xyzw) - yaw_of(state.xyzw), math.tau)
            moved = math.dist(self._state.xyz[:2], state.xyz[:2])
            self._compare(
                (left + right) / 2, (right - left) / self._wheels.separation, moved, heading
            )

    def _compare(self, way: float, turn: float, moved: float, heading: float) -> None:
        # The ends of an arc are nearer to each other than it is long.
        half = turn / 2
        expected = abs(way * math.sin(half) / half) if half else abs(way)
        if expected > LEAST_WAY and moved < SLIPPING * expected:
            self._notify(f"{expected:.2f} m", f"{moved:.2f} m")
        # Half a turn to the left cannot be told from one to the right.
        elif LEAST_TURN < abs(turn) < math.pi and abs(heading) < TURNING * abs(turn):
            self._notify(f"{abs(turn):.2f} rad", f"{abs(heading):.2f} rad")

    def _notify(self, by_wheels: str, moved: str) -> None:
        self._is_over = True
        self._host.warn(
            f"`{self._robot.entity}`: its wheels slip: in {WINDOW:g} s they have turned for "
            f"{by_wheels}, and it has moved {moved}. {self._why()}"
        )

    def _why(self) -> str:
        """What can be the reason, the likely one first."""
        hanging = self._hanging()
        if hanging:
            return hanging
        grip = self._robot.robot.least_grip(self._driven)
        drags = self._has_dragging()
        if grip < LITTLE_GRIP:
            casters = ", and casters of 0.001" if drags else ""
            return (
                f"The friction of its wheels is {grip:g}: give wheels <mu1> and <mu2> of 1"
                f"{casters}. Or something is in its way."
            )
        if drags:
            return (
                "What drags over the ground holds it as much as its wheels grip: give casters "
                "<mu1> and <mu2> of 0.001, or try another --engine. Or something is in its way."
            )
        return "Little of its weight is on these wheels, or something is in its way."

    def _hanging(self) -> str | None:
        """Which driven wheels touch nothing and end above what the robot stands on."""
        wheels = self._links_of_wheels()
        touching = {contact.link for contact in self._robot.contacts()}
        found = list(self._lowest_points())
        ground, lowest = min(((z, link) for link, _, z in found), default=(0.0, ""))
        ends: dict[str, float] = {}
        for link, _, z in found:
            if link in wheels - touching:
                ends[link] = min(z, ends.get(link, z))
        hanging = [link for link, z in ends.items() if z > ground + HANGING]
        if not hanging:
            return None
        high = max(ends[link] - ground for link in hanging)
        names = " and ".join(f"`{link}`" for link in hanging[:NAMED])
        names += f" and {len(hanging) - NAMED} more" if len(hanging) > NAMED else ""
        return (
            f"{names} {'does' if len(hanging) == 1 else 'do'} not touch the ground: "
            f"`{lowest}` reaches {1000 * high:.0f} mm lower. Raise that, or lower the wheels."
        )

    def _links_of_wheels(self) -> set[str]:
        """The links that the driven joints turn."""
        return {joint.child for joint in self._robot.robot.joints if joint.name in self._driven}

    def _has_dragging(self) -> bool:
        """Whether something beside the wheels is as low as these, and has friction.

        Heights are those in the frame of the root, which stands level on a ramp, too.
        """
        wheels = self._links_of_wheels()
        found = list(self._lowest_points())
        ground = min((z for link, _, z in found if link in wheels), default=math.inf)
        return any(
            z < ground + CLEAR and grip > DRAGGING for link, grip, z in found if link not in wheels
        )

    def _lowest_points(self) -> Iterator[tuple[str, float, float]]:
        """The links of collisions, their friction, and the z of their lowest points, m."""
        poses = self._robot.link_poses()
        into_root = invert(poses[self._robot.robot.root])
        for link in self._robot.robot.links:
            for geometry, collision in there(link):
                pose = compose(compose(into_root, poses[link.name]), collision.pose_in_link)
                try:
                    lowest = pose.xyz[2] - reach_down(geometry, pose)
                except UnreadError:  # the engine has no such mesh, either
                    continue
                yield link.name, collision.surface.grip, lowest

    def reset(self) -> None:
        """Begin again where it is."""
        self._begin()
