"""What `ros2 launch` of a package needs of a machine: the target's Ubuntu, its ROS, its Gazebo."""

from __future__ import annotations

from typing import TYPE_CHECKING

from wsgen.model.facts import DISTROS, RELEASED_FOR
from wsgen.model.installation import (
    APT_HOSTS,
    COLCON,
    SIMULATOR_PACKAGES,
    VARIANTS,
    apt_install,
    apt_source,
    debian_name,
    image,
    ros_packages,
)
from wsgen.model.target import Target
from wsgen.workspace.machine import Finding, names_in_apt, read_os_release, ros_prefixes

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from wsgen.workspace.machine import Machine

SYSTEM = "Ubuntu"  # the name of the finding about it


def find_ros_needs(machine: Machine, target: Target) -> Iterator[Finding]:
    """Say of each thing that the target needs beyond wsgen whether it is there."""
    ubuntu = _ubuntu(machine, target)
    yield ubuntu
    yield _python(machine, target)
    ros = _ros(machine, target, can_install=ubuntu.is_met)
    is_installed = _setup_file(machine, target).is_file() or ros.is_met
    if ubuntu.is_met and not is_installed:
        yield _apt(machine, target)
    yield ros
    if is_installed:
        yield _packages(machine, target)
    yield _gazebo(machine, target, can_install=ubuntu.is_met)
    yield _colcon(machine, can_install=ubuntu.is_met)


def _ubuntu(machine: Machine, target: Target) -> Finding:
    wanted = f"Ubuntu {target.ubuntu}"
    is_met = False
    mend = _container(target)
    if machine.system != "linux":
        text = (
            f"this is {machine.system_name}; {target.ros} is packaged for {wanted}."
            " wsgen tries packages here, a container or another machine runs them"
        )
        return Finding(SYSTEM, is_met=False, text=text, mend=mend)
    try:
        release = read_os_release(machine.root)
    except OSError as error:
        text = f"not known: {error.filename}: {error.strerror}; {target.ros} is for {wanted}"
        return Finding(SYSTEM, is_met=False, text=text, mend=mend)
    name = release.get("PRETTY_NAME") or release.get("NAME") or "a Linux without a name"
    is_ubuntu = release.get("ID") == "ubuntu"
    codename = release.get("UBUNTU_CODENAME", release.get("VERSION_CODENAME") if is_ubuntu else "")
    if is_ubuntu and release.get("VERSION_ID") == target.ubuntu:
        is_met, text, mend = True, name, ""
    elif codename == target.fact("ubuntu_codename"):
        is_met, mend = True, ""
        text = f"{name}, made from {wanted}: its packages are for this, and nobody tests them here"
    else:
        text = f"this is {name}; {target.ros} is packaged for {wanted}"
        fitting = _distro_for(codename or "")
        if fitting:
            mend = f"wsgen doctor --distro {fitting}"
    return Finding(SYSTEM, is_met=is_met, text=text, mend=mend)


def _distro_for(codename: str) -> str | None:
    """The distribution that lasts longest of those for an Ubuntu."""
    fitting = [
        target
        for target in (Target(distro=name, simulator="gz") for name in DISTROS)
        if target.fact("ubuntu_codename") == codename and not target.has_ended
    ]
    fitting.sort(key=lambda target: target.end_of_life or "")
    return fitting[-1].distro if fitting else None


def _python(machine: Machine, target: Target) -> Finding:
    wanted = target.fact("python")
    ours = ".".join(map(str, machine.python))
    text = f"{wanted}, as wsgen's own"
    if ours != wanted:
        text = f"{target.ros} runs launch files with {wanted}, wsgen evaluates them with {ours}"
    return Finding("Python", is_met=ours == wanted, text=text)


def _apt(machine: Machine, target: Target) -> Finding:
    is_met = names_in_apt(machine.root, APT_HOSTS)
    return Finding(
        "apt repository",
        is_met=is_met,
        text="of ROS, known to apt" if is_met else "of ROS, not known to apt",
        mend="" if is_met else apt_source(target),
    )


def _ros(machine: Machine, target: Target, *, can_install: bool) -> Finding:
    sourced = machine.environment.get("ROS_DISTRO", "")
    has_prefix = bool(machine.environment.get("AMENT_PREFIX_PATH"))
    setup = _setup_file(machine, target)
    if sourced == target.distro and has_prefix:
        return Finding(target.ros, is_met=True, text="sourced")
    if sourced and has_prefix:
        others = f"{sourced} is sourced"
    else:
        found = sorted(path.parent.name for path in machine.root.glob("opt/ros/*/setup.bash"))
        others = f"there is {', '.join(found)}" if found else ""
    if setup.is_file():
        text = f"in {setup.parent}, not sourced"
        if sourced and has_prefix:
            text += f": {others}, so open a new terminal first"
        return Finding(target.ros, is_met=False, text=text, mend=f"source {setup}")
    text = f"not installed; {others}" if others else "not installed"
    mend = apt_install(target) if can_install else _container(target)
    return Finding(target.ros, is_met=False, text=text, mend=mend)


def _packages(machine: Machine, target: Target) -> Finding:
    """Packages that hold others leave no trace that is sure: their simulator's package does."""
    wanted = [name for name in ros_packages(target) if name not in VARIANTS]
    wanted.append(target.programs["package"])
    prefixes = ros_prefixes(machine, target.distro)
    missing = [
        name
        for name in wanted
        if not any((prefix / "share" / name / "package.xml").is_file() for prefix in prefixes)
    ]
    names = " ".join(debian_name(name, target.distro) for name in missing)
    return Finding(
        "ROS packages",
        is_met=not missing,
        text=f"missing: {', '.join(missing)}" if missing else ", ".join(wanted),
        mend=f"sudo apt install {names}" if missing else "",
    )


def _gazebo(machine: Machine, target: Target, *, can_install: bool) -> Finding:
    if target.simulator == "classic":
        found = machine.find("gazebo")
    elif target.distro in RELEASED_FOR["gz_sim_vendor"]:
        # A ROS package since Jazzy; `gz` is on the PATH once ROS is sourced.
        found = next(
            (
                str(prefix)
                for prefix in ros_prefixes(machine, target.distro)
                if (prefix / "share" / "gz_sim_vendor" / "package.xml").is_file()
            ),
            None,
        )
    else:
        found = machine.find("ign")  # so its program is called up to Fortress
    if found:
        return Finding(target.gazebo, is_met=True, text=found)
    name = debian_name(SIMULATOR_PACKAGES[target.simulator], target.distro)
    mend = f"sudo apt install {name}" if can_install else ""
    return Finding(target.gazebo, is_met=False, text="missing", mend=mend)


def _colcon(machine: Machine, *, can_install: bool) -> Finding:
    found = machine.find("colcon")
    if found:
        return Finding("colcon", is_met=True, text=found)
    mend = f"sudo apt install {COLCON}" if can_install else ""
    text = "not on the PATH; `wsgen build` has its own"
    return Finding("colcon", is_met=False, text=text, mend=mend)


def _setup_file(machine: Machine, target: Target) -> Path:
    return machine.root / "opt" / "ros" / target.distro / "setup.bash"


def _container(target: Target) -> str:
    return f'docker run -it --rm -v "$PWD":/ws -w /ws {image(target)}'
