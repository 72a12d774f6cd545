"""What tests start with ROS has a network of its own, in which nodes find each other."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import own_network
from own_network import outside, ros_domain
from ros_for_tests import variables_for
from wsgen.isolation import system
from wsgen.live import resources
from wsgen.live.resources import FIRST_PORT, LOCK, PORTS

if TYPE_CHECKING:
    from wsgen.ros.environment import RosEnvironment

INTERFACES = "import socket; print([name for _, name in socket.if_nameindex()])"
# A node that hears what another process publishes, and tells the interfaces that it had.
HEAR = """
import json, socket, sys
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("hearer")
heard = []
node.create_subscription(String, "said", heard.append, 10)
while not heard:
    rclpy.spin_once(node, timeout_sec=0.05)
print(json.dumps([heard[0].data, [name for _, name in socket.if_nameindex()]]), flush=True)
sys.stdin.read()
"""
SAY = """
import rclpy
from std_msgs.msg import String

rclpy.init()
node = rclpy.create_node("sayer")
publisher = node.create_publisher(String, "said", 10)
while True:
    publisher.publish(String(data="hello"))
    rclpy.spin_once(node, timeout_sec=0.05)
"""
TAKE = """
import sys
from contextlib import ExitStack
from wsgen.errors import NotReadableError
from wsgen.isolation import system
from wsgen.live.resources import take_domain
with ExitStack() as taken:
    try:
        while True:
            print(taken.enter_context(take_domain()).number)
    except NotReadableError:
        pass
"""


@pytest.fixture
def own() -> own_network.Network:
    found = own_network.network()
    if found.refused:
        pytest.skip(f"tests have the network of the machine: {found.refused}")
    return found


def _printed(script: str) -> str:
    command = [sys.executable, "-c", script]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def test_only_what_is_started_has_it(own: own_network.Network) -> None:
    assert _printed(INTERFACES) == "['lo']\n"
    with outside():
        assert _printed(INTERFACES) == f"{_interfaces()}\n"
    assert _printed(INTERFACES) == "['lo']\n"


def test_programs_are_those_that_are_started(own: own_network.Network, tmp_path: Path) -> None:
    """With their number, group, folder, streams, open files and exit code."""
    script = (
        "import json, os; os.write({}, json.dumps([os.getpid(), os.getsid(0), os.getuid(),"
        " os.getgid(), os.getcwd(), os.environ['MINE']]).encode()); os._exit(7)"
    )
    ours, theirs = os.pipe()
    program = subprocess.Popen(
        [sys.executable, "-c", script.format(theirs)],
        cwd=tmp_path,
        env={**os.environ, "MINE": "yes"},
        pass_fds=[theirs],
        start_new_session=True,
    )
    os.close(theirs)
    with os.fdopen(ours) as stream:
        seen = json.load(stream)
    assert program.wait() == 7
    mine = [os.getuid(), os.getgid(), str(tmp_path), "yes"]
    assert seen == [program.pid, program.pid, *mine]


def test_domains_are_those_that_are_taken_outside(own: own_network.Network) -> None:
    numbers = [int(word) for word in _printed(TAKE).split()]
    assert sorted(numbers) == sorted(own.of_live)
    assert own.domain not in numbers
    for number in (own.domain, *numbers):
        with socket.socket(socket.AF_UNIX) as lock, pytest.raises(OSError, match="in use"):
            lock.bind(LOCK.format(number))


@pytest.mark.skipif(not system.has_guards(), reason=own_network.LINUX_ONLY)
@pytest.mark.parametrize(
    ("workers", "taken", "number"), [(2, 0, 4), (24, 0, 1), (2, 88, 2), (2, 100, 1), (2, 101, 0)]
)
def test_domains_of_sessions_leave_some_to_others(
    workers: int, taken: int, number: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    name = f"wsgen-{os.getpid()}-domain"  # nobody else has locks of that name
    for module in (own_network, resources):
        monkeypatch.setattr(module, "LOCK", f"\0{name}-{{}}")
    monkeypatch.setattr(resources, "_used_ports", set)
    with ExitStack() as stack:
        monkeypatch.setattr(own_network, "_kept", stack)
        for _ in range(taken):
            stack.enter_context(resources.take_domain())
        assert len(own_network._domains_of_live(workers)) == number


@pytest.mark.slow
def test_nodes_find_each_other_in_it(own: own_network.Network, ros: RosEnvironment) -> None:
    # By UDP alone: shared memory is the same in all networks.
    variables = variables_for(ros, {"FASTDDS_BUILTIN_TRANSPORTS": "UDPv4"})
    pipes: Any = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
    with (
        subprocess.Popen([sys.executable, "-c", SAY], env=variables) as sayer,
        subprocess.Popen([sys.executable, "-c", HEAR], env=variables, **pipes) as hearer,
    ):
        try:
            assert hearer.stdout is not None
            assert json.loads(hearer.stdout.readline()) == ["hello", ["lo"]]
            assert _ports(own.tables)
            assert not _ports(Path("/proc/net"))
        finally:
            sayer.kill()
            hearer.kill()


def _ports(tables: Path) -> set[int]:
    """The UDP ports of the domain of these tests."""
    first = FIRST_PORT + PORTS * int(ros_domain())
    lines = (tables / "udp").read_text(encoding="ascii").splitlines()[1:]
    ports = {int(line.split()[1].rpartition(":")[2], 16) for line in lines}
    return ports.intersection(range(first, first + PORTS))


@pytest.mark.skipif(not system.has_guards(), reason=own_network.LINUX_ONLY)
@pytest.mark.parametrize("way", ["platform", "nsenter", "unshare"])
def test_without_it_programs_have_the_network_of_the_machine(
    way: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    if way == "platform":
        monkeypatch.setattr(system, "has_guards", lambda: False)
        reason = own_network.LINUX_ONLY
    elif way == "nsenter":
        monkeypatch.setenv("PATH", str(tmp_path))
        reason = "`nsenter` is not installed"
    else:
        keeper = tmp_path / "keeper.py"
        text = own_network.KEEPER.read_text(encoding="utf-8")
        keeper.write_text(text.replace("libc.unshare(", "libc.close("), encoding="utf-8")
        monkeypatch.setattr(own_network, "KEEPER", keeper)
        reason = "the system refuses it: "
    refused = own_network.why_refused()
    assert reason in refused
    monkeypatch.setattr(own_network, "network", lambda: own_network.Network(7, None, (), refused))
    with own_network.own_network():
        assert _printed(INTERFACES) == f"{_interfaces()}\n"
        assert ros_domain() == "7"
    assert own_network.network().tables == Path("/proc/self/net")
    with outside(), pytest.raises(AssertionError, match="from ros_for_tests"):
        ros_domain()


def _interfaces() -> list[str]:
    return [name for _, name in socket.if_nameindex()]
