"""Open ROS for processes that speak it: the one that the user sourced, or PyPI's."""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from wsgen.errors import NotFoundError
from wsgen.ros_environment.private import DISTRO, library_folders, make_private, private_prefix
from wsgen.ros_environment.sourced import check_rclpy, sourced_prefix
from wsgen.ros_environment.wheels import EXTRA, site_packages
from wsgen.values import dataclass

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from wsgen.events import Listener
    from wsgen.ros_environment.compiler import Compiler

ALWAYS = "tf2_msgs"  # nearly every robot has frames
DISCOVERY = "ROS_AUTOMATIC_DISCOVERY_RANGE"
DISCOVERY_VARIABLES = (DISCOVERY, "ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS", "ROS_DISCOVERY_SERVER")
OLD_DISCOVERY = ("foxy", "galactic", "humble")  # from Iron on they have DISCOVERY
SHIM = Path(__file__).parents[1] / "ros_shim"
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
    """
    if (sourced := sourced_prefix(environment)) is not None:
        return _sourced(sourced, environment)
    return open_private(environment, messages={ALWAYS, *messages}, listener=listener)


def open_private(
    environment: Mapping[str, str], *, messages: Collection[str], listener: Listener
) -> RosEnvironment:
    """Open the ROS of PyPI, whether one is sourced or not; see `open_ros`."""
    from wsgen.ros_environment.interfaces import buildable  # noqa: PLC0415  a sourced ROS has them
    from wsgen.ros_environment.messages import make_messages  # noqa: PLC0415  as above

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
    from wsgen.ros_environment.compiler import system_compiler  # noqa: PLC0415  once in a cache
    from wsgen.ros_environment.zig import make_zig  # noqa: PLC0415  as above

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


def variables_of(prefixes: list[Path], environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that differ from those of an environment.

    Args:
        prefixes: of messages, and of ROS at the end; they come after those of the user.
        environment: the user's.
    """

    def joined(name: str, added: list[Path]) -> str:
        given = [entry for entry in environment.get(name, "").split(os.pathsep) if entry]
        return os.pathsep.join(dict.fromkeys([*given, *map(str, added)]))

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
    """Return the variables of a ROS with what PyPI lacks: the Python packages in `ros_shim`.

    They come after all that the user has. A sourced ROS has the real ones.
    """
    variables = dict(ros.variables)
    if not ros.is_sourced:
        path = variables.get("PYTHONPATH", environment.get("PYTHONPATH", ""))
        entries = [entry for entry in path.split(os.pathsep) if entry]
        variables["PYTHONPATH"] = os.pathsep.join([*entries, str(SHIM)])
    return variables


def _discovery(environment: Mapping[str, str], distro: str) -> dict[str, str]:
    """Keep nodes on this machine, unless the user says otherwise."""
    if any(environment.get(name) for name in DISCOVERY_VARIABLES):
        return {}
    if distro in OLD_DISCOVERY:
        return {"ROS_LOCALHOST_ONLY": "1"}
    return {DISCOVERY: "LOCALHOST"}
