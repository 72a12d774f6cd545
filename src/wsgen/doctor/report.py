"""A machine compared with a target: what `wsgen doctor` tells."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.doctor.requirements import SYSTEM, find_own_needs, find_ros_needs
from wsgen.model.installation import apt_install
from wsgen.model.target import end_of_life_note

if TYPE_CHECKING:
    from wsgen.doctor.machine import Finding, Machine
    from wsgen.model.target import Target


class Examination(NamedTuple):
    """What a machine has and lacks for a target."""

    target: Target
    notes: tuple[str, ...]  # a sentence each
    own: tuple[Finding, ...]  # what wsgen's own commands use, without ROS
    ros: tuple[Finding, ...]  # what only ROS needs
    apt: str  # the command that installs all of what the tutorial's steps 1 and 2 install

    @property
    def takes_apt(self) -> bool:
        """Whether the target's packages are for this machine's system."""
        return any(found.name == SYSTEM and found.is_met for found in self.ros)

    @property
    def passed(self) -> bool:
        """Whether `wsgen new`, `build` and `validate` can work there."""
        return all(found.is_met or not found.is_needed for found in self.own)


def examine(machine: Machine, target: Target, *, today: str) -> Examination:
    """Compare a machine with a target; `today` (YYYY-MM-DD) says what has ended."""
    notes = [end_of_life_note(target, today)]
    if not machine.environment.get("PATH"):
        notes.append("PATH is empty: no program was found on it.")
    return Examination(
        target=target,
        notes=tuple(filter(None, notes)),
        own=tuple(find_own_needs(machine)),
        ros=tuple(find_ros_needs(machine, target)),
        apt=apt_install(target),
    )
