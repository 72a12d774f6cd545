"""Compare a machine with a target, for `wsgen doctor`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from wsgen.doctor.requirements import SYSTEM, check_ros, check_wsgen
from wsgen.model.installation import apt_install
from wsgen.model.target import end_of_life_note

if TYPE_CHECKING:
    from wsgen.doctor.machine import Machine, Requirement
    from wsgen.model.target import Target


class DoctorReport(NamedTuple):
    """What a machine has and lacks for a target."""

    target: Target
    notes: tuple[str, ...]  # a sentence each
    wsgen: tuple[Requirement, ...]  # of wsgen's own commands, without ROS
    ros: tuple[Requirement, ...]  # of ROS alone
    apt: str  # the command that installs what steps 1 and 2 of the tutorial install

    @property
    def takes_apt(self) -> bool:
        """Whether the target's packages are made for this machine's system."""
        return any(one.name == SYSTEM and one.is_met for one in self.ros)

    @property
    def passed(self) -> bool:
        """Whether `wsgen new`, `build` and `validate` can run on the machine."""
        return all(one.is_met or not one.is_required for one in self.wsgen)


def check_machine(machine: Machine, target: Target, *, today: str) -> DoctorReport:
    """Compare a machine with a target; `today` (YYYY-MM-DD) decides what has reached its end."""
    notes = [end_of_life_note(target, today)]
    if not machine.environment.get("PATH"):
        notes.append("PATH is empty, so no program was found.")
    return DoctorReport(
        target=target,
        notes=tuple(filter(None, notes)),
        wsgen=tuple(check_wsgen(machine)),
        ros=tuple(check_ros(machine, target)),
        apt=apt_install(target),
    )
