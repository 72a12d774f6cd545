from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest
from lxml import etree

from wsgen.ros.environment import RosEnvironment, variables_of_nodes
from wsgen.ros.environment.environment import (
    ANNOUNCEMENTS,
    DISCOVERY,
    LARGEST_SEGMENT,
    LOCALHOST_ONLY,
    LOOPBACK,
    PROFILES,
    PROFILES_HERE,
    SEGMENT_BYTES,
    SIMULATOR,
    TRANSPORTS,
    WITHOUT_SHARED_MEMORY,
    profiles_of,
    variables_of_simulator,
)

ROS = RosEnvironment(distro="kilted", is_sourced=False, python=Path("python3"), variables={})


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("wsgen.ros.environment.environment.SHARED_MEMORY", tmp_path)
    return tmp_path


def test_nodes_announce_themselves_often() -> None:
    assert variables_of_nodes(ROS, {})[PROFILES] == str(ANNOUNCEMENTS)
    period = etree.parse(ANNOUNCEMENTS).find(".//{*}leaseAnnouncement/{*}nanosec")
    assert period is not None
    assert 0 < int(period.text or 0) < 1e9  # Fast DDS takes 3 s otherwise


def test_the_profiles_of_the_user_count(folder: Path) -> None:
    assert PROFILES not in variables_of_nodes(ROS, {PROFILES: "mine.xml"})
    assert PROFILES not in variables_of_nodes(replace(ROS, is_sourced=True), {})
    (folder / PROFILES_HERE).touch()
    assert PROFILES not in variables_of_nodes(ROS, {})


@pytest.mark.parametrize(
    ("variables", "stays"),
    [
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}, True),
        ({"ROS_LOCALHOST_ONLY": "1"}, True),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}, False),
        ({"ROS_LOCALHOST_ONLY": "0"}, False),
        ({"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "ROS_STATIC_PEERS": "robot"}, False),
        ({"ROS_DISCOVERY_SERVER": "robot:11811"}, False),
        # Who chooses other transports has them.
        (
            {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST", "FASTDDS_BUILTIN_TRANSPORTS": "UDPv6"},
            False,
        ),
        ({}, False),
    ],
)
def test_nodes_that_stay_here_have_ports_of_loopback(
    variables: dict[str, str], stays: bool
) -> None:
    expected = str(LOOPBACK if stays else ANNOUNCEMENTS)
    assert variables_of_nodes(ROS, variables)[PROFILES] == expected
    # What a launch file sets counts for its nodes, what the user has for all.
    assert profiles_of({**variables, PROFILES: str(LOOPBACK)})[PROFILES] == expected
    assert profiles_of({**variables, PROFILES: "mine.xml"}) == {}


def test_all_nodes_announce_themselves_alike() -> None:
    found = [
        etree.parse(path).find(".//{*}discovery_config")
        for path in (ANNOUNCEMENTS, SIMULATOR, LOOPBACK, WITHOUT_SHARED_MEMORY)
    ]
    texts = {tuple(one.itertext()) for one in found if one is not None}
    assert (None in found, len(texts)) == (False, 1)


def test_what_profiles_have_in_common_is_alike() -> None:
    """Loopback is the simulator on this machine alone, and the third one lacks shared memory."""
    simulator, loopback, without = map(_content, (SIMULATOR, LOOPBACK, WITHOUT_SHARED_MEMORY))
    ports = [one for one in loopback if one not in simulator]
    assert ports == [("address", "127.0.0.1")]
    assert [one for one in loopback if one not in ports] == simulator
    memory = [one for one in loopback if one not in without]
    assert memory == [
        ("transport_id", "wsgen_shared_memory"),
        ("type", "SHM"),
        ("segment_size", f"${{{SEGMENT_BYTES}}}"),
        ("transport_id", "wsgen_shared_memory"),
    ]
    assert {name for name, _ in without if (name, _) not in loopback} == {"maxInitialPeersRange"}


def _content(path: Path) -> list[tuple[str, str]]:
    """What the elements of a profile say, in order."""
    root = etree.parse(path).getroot()
    found = [(etree.QName(one), (one.text or "").strip()) for one in root.iter(tag=etree.Element)]
    return [(name.localname, text) for name, text in found if text]


def _no_room(folder: Path, monkeypatch: pytest.MonkeyPatch, reason: str) -> None:
    """Take the room of shared memory from nodes."""
    at = "wsgen.ros.environment.environment"
    if reason == "it is full":
        monkeypatch.setattr(f"{at}.disk_usage", lambda _folder: SimpleNamespace(free=1 << 20))
    elif reason == "it is read-only":
        monkeypatch.setattr(f"{at}.os.access", lambda _folder, _mode: False)
    else:
        monkeypatch.setattr(f"{at}.SHARED_MEMORY", folder / "nowhere")


@pytest.mark.parametrize("reason", ["it is full", "it is read-only", "it does not exist"])
def test_nodes_have_udp_alone_without_shared_memory(
    reason: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    _no_room(folder, monkeypatch, reason)
    for stays in ({DISCOVERY: "LOCALHOST"}, {LOCALHOST_ONLY: "1"}):
        variables = {**stays, **variables_of_nodes(ROS, stays)}
        # With LOCALHOST, rmw_fastrtps would add shared memory.
        assert (variables[DISCOVERY], variables[LOCALHOST_ONLY]) == ("SYSTEM_DEFAULT", "")
        assert variables[PROFILES] == str(WITHOUT_SHARED_MEMORY)
        assert variables_of_simulator(variables) == {}
        assert {**variables, **profiles_of(variables)} == variables
        # A launch file may set it for its nodes.
        wide = {**variables, DISCOVERY: "SUBNET"}
        assert profiles_of(wide) == {PROFILES: str(ANNOUNCEMENTS), TRANSPORTS: "UDPv4"}
    found = variables_of_nodes(ROS, {DISCOVERY: "SUBNET"})
    assert (found[PROFILES], found[TRANSPORTS]) == (str(ANNOUNCEMENTS), "UDPv4")
    assert TRANSPORTS not in variables_of_nodes(ROS, {DISCOVERY: "SUBNET", TRANSPORTS: "UDPv6"})


@pytest.mark.parametrize(
    ("free", "segment"), [(8 << 30, LARGEST_SEGMENT), (64 << 20, 16 << 20), (2 << 20, None)]
)
def test_images_get_room_of_what_is_free(
    free: int, segment: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "wsgen.ros.environment.environment.disk_usage", lambda _folder: SimpleNamespace(free=free)
    )
    found = variables_of_simulator({PROFILES: str(ANNOUNCEMENTS)})
    expected = {PROFILES: str(SIMULATOR), SEGMENT_BYTES: str(segment)}
    assert found == (expected if segment else {})
    found = variables_of_simulator({PROFILES: str(LOOPBACK)})
    assert found == ({**expected, PROFILES: str(LOOPBACK)} if segment else {})


def test_the_simulator_keeps_profiles_of_the_user() -> None:
    assert variables_of_simulator({PROFILES: "mine.xml"}) == {}
    assert variables_of_simulator({}) == {}


@pytest.mark.parametrize("transports", ["UDPv6", "UDPv4", "LARGE_DATA", "SHM"])
def test_the_simulator_has_the_transports_that_other_nodes_have(transports: str) -> None:
    variables = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET", TRANSPORTS: transports}
    variables |= variables_of_nodes(ROS, variables)
    assert variables[PROFILES] == str(ANNOUNCEMENTS)  # which names none
    assert variables_of_simulator(variables) == {}


def test_room_that_nobody_knows_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wsgen.ros.environment.environment.SHARED_MEMORY", Path("/nowhere"))
    assert variables_of_simulator({PROFILES: str(ANNOUNCEMENTS)}) == {}
