"""A ROS that the user sourced, and ROS's variables."""

import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

from wsgen.errors import NotFoundError, RequestError
from wsgen.ros.environment import open_ros
from wsgen.ros.environment.available import MARKER, RCLPY, sourced_prefix, why_not
from wsgen.ros.environment.environment import variables_of

OURS = f"{sys.version_info.major}{sys.version_info.minor}"


def sourced(root: Path, *, python: str = OURS, distro: str = "jazzy") -> dict[str, str]:
    """Variables of a shell that sourced a ROS whose rclpy is for a Python, such as 312."""
    prefix = root / distro
    (prefix / RCLPY).parent.mkdir(parents=True)
    (prefix / RCLPY).touch()
    packages = prefix / "lib" / "python" / "site-packages"
    module = f"_rclpy_pybind11.cpython-{python}-x86_64-linux-gnu.so"
    (packages / "rclpy").mkdir(parents=True)
    (packages / "rclpy" / module).touch()
    return {
        "AMENT_PREFIX_PATH": f"/overlay:{prefix}",
        "PYTHONPATH": str(packages),
        "ROS_DISTRO": distro,
    }


@pytest.mark.skipif(sys.platform != "linux", reason="names of modules of Linux")
def test_a_sourced_ros_is_used(tmp_path: Path) -> None:
    found = open_ros(sourced(tmp_path), listener=lambda _: None)
    assert found.is_sourced
    assert found.distro == "jazzy"
    assert found.python == Path(sys.executable)
    assert found.variables == {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    assert found.prefixes == ()


@pytest.mark.skipif(sys.platform != "linux", reason="names of modules of Linux")
def test_discovery_stays_on_this_machine_unless_the_user_says_otherwise(tmp_path: Path) -> None:
    humble = sourced(tmp_path, distro="humble")
    assert open_ros(humble, listener=lambda _: None).variables == {"ROS_LOCALHOST_ONLY": "1"}
    for name in ("ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS"):
        assert not open_ros({**humble, name: "SUBNET"}, listener=lambda _: None).variables


@pytest.mark.parametrize("domain", ["abc", "233", "-1", "1.0", " ", "9" * 5000, "0" * 5000])
def test_a_domain_that_no_node_can_be_in_is_refused(tmp_path: Path, domain: str) -> None:
    with pytest.raises(RequestError, match="and no number from 0 to 232"):
        open_ros({**sourced(tmp_path), "ROS_DOMAIN_ID": domain}, listener=lambda _: None)


@pytest.mark.skipif(sys.platform != "linux", reason="names of modules of Linux")
@pytest.mark.parametrize("domain", ["", "0", "232"])
def test_domains_that_nodes_can_be_in(tmp_path: Path, domain: str) -> None:
    assert open_ros({**sourced(tmp_path), "ROS_DOMAIN_ID": domain}, listener=lambda _: None)


def test_a_ros_for_another_python_is_refused(tmp_path: Path) -> None:
    with pytest.raises(NotFoundError) as caught:
        open_ros(sourced(tmp_path, python="38"), listener=lambda _: None)
    assert "is for Python 3.8; wsgen runs on" in caught.value.message
    assert "python3.8 -m venv" in caught.value.hint


def test_a_ros_without_its_python_path_is_refused(tmp_path: Path) -> None:
    variables = sourced(tmp_path)
    del variables["PYTHONPATH"]
    with pytest.raises(
        NotFoundError, match="neither PYTHONPATH nor the Python of wsgen has"
    ) as one:
        open_ros(variables, listener=lambda _: None)
    assert "setup.bash" in one.value.hint
    (tmp_path / "jazzy/bin").mkdir()
    (tmp_path / "jazzy/bin/python").touch()
    with pytest.raises(NotFoundError) as other:
        open_ros(variables, listener=lambda _: None)
    assert f"{tmp_path}/jazzy/bin/python -m pip install wsgen" in other.value.hint


def test_a_ros_of_conda_is_where_wsgen_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    variables = sourced(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path, variables.pop("PYTHONPATH")])
    assert open_ros(variables, listener=lambda _: None).is_sourced


def test_overlays_and_the_ros_of_pypi_are_not_sourced(tmp_path: Path) -> None:
    variables = sourced(tmp_path)
    assert sourced_prefix(variables) == tmp_path / "jazzy"
    (tmp_path / "jazzy" / MARKER).touch()
    assert sourced_prefix(variables) is None
    assert sourced_prefix({"AMENT_PREFIX_PATH": str(tmp_path)}) is None
    assert sourced_prefix({}) is None


def test_what_the_user_has_comes_first(tmp_path: Path) -> None:
    found = variables_of(
        [tmp_path / "messages", tmp_path / "ros"],
        {"PYTHONPATH": "/mine", "AMENT_PREFIX_PATH": f"/overlay:{tmp_path / 'ros'}"},
    )
    packages = f"lib/python{sys.version_info.major}.{sys.version_info.minor}/site-packages"
    assert found["AMENT_PREFIX_PATH"].split(":") == [
        "/overlay",
        f"{tmp_path}/ros",
        f"{tmp_path}/messages",
    ]
    assert found["PYTHONPATH"].split(":") == [
        "/mine",
        f"{tmp_path}/messages/{packages}",
        f"{tmp_path}/ros/{packages}",
    ]
    assert found["LD_LIBRARY_PATH"].split(":") == [
        f"{tmp_path}/messages/lib",
        f"{tmp_path}/ros/lib",
    ]
    assert found["ROS_DISTRO"] == "kilted"
    assert found["ROS_AUTOMATIC_DISCOVERY_RANGE"] == "LOCALHOST"


def test_nothing_is_downloaded_without_the_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if why_not() is not None:
        pytest.skip("PyPI has no ROS for this machine, which is reported first")
    monkeypatch.setattr(
        "wsgen.ros.environment.environment.find_spec",
        lambda name: None if name == "mcap" else find_spec(name),
    )
    with pytest.raises(NotFoundError) as caught:
        open_ros({"XDG_CACHE_HOME": str(tmp_path)}, listener=lambda _: None)
    assert "pip install 'wsgen[ros]'" in caught.value.hint
    assert not [*tmp_path.rglob("kilted*")]


@pytest.mark.parametrize(
    ("machine", "said"),
    [
        (("win32", "AMD64", (3, 12)), "PyPI has no ROS 2 for Windows"),
        (("darwin", "arm64", (3, 12)), "this is macOS on arm64"),
        (("linux", "aarch64", (3, 12)), "this is Linux on aarch64"),
        (("linux", "x86_64", (3, 14)), "Python 3.10 to 3.13; wsgen runs on Python 3.14"),
        (("linux", "x86_64", (3, 9)), "wsgen runs on Python 3.9"),
    ],
)
def test_machines_without_wheels_are_reported(
    machine: tuple[str, str, tuple[int, int]], said: str
) -> None:
    reason = why_not(*machine)
    assert reason is not None
    assert said in reason.message
    assert reason.hint


def test_machines_with_wheels() -> None:
    for minor in range(10, 14):
        assert why_not("linux", "x86_64", (3, minor), "cpython") is None
    reason = why_not("linux", "x86_64", (3, 11), "pypy")
    assert reason is not None
    assert "wsgen runs on pypy 3.11" in reason.message
