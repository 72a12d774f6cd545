"""The arguments of the spawner, and what it asks the controller manager for."""

from __future__ import annotations

import os
import signal
import sys
import time
from types import ModuleType, SimpleNamespace
from typing import TYPE_CHECKING, Any

import pytest

from wsgen.checks.rules.controllers import _names
from wsgen.live.nodes.controller_spawner import (
    Wanted,
    full_manager,
    main,
    read_arguments,
    refused_in,
    spawn,
    unspawn,
)
from wsgen.live.nodes.signals import ignore_ends

if TYPE_CHECKING:
    from pathlib import Path


def test_names_and_options() -> None:
    order = read_arguments(
        ["a", "b", "-c", "/arm/controller_manager", "--inactive", "-p", "x.yaml"], ["y.yaml"]
    )
    assert order.controllers == (
        Wanted("a", ("x.yaml", "y.yaml"), stays_inactive=True),
        Wanted("b", ("x.yaml", "y.yaml"), stays_inactive=True),
    )
    assert order.controller_manager == "/arm/controller_manager"


def test_options_of_former_and_newer_releases() -> None:
    order = read_arguments(["a", "--stopped", "-t", "some/Type", "-n", "/arm"])
    assert order.controllers[0].stays_inactive
    assert (order.controller_type, order.namespace, order.stopped) == ("some/Type", "/arm", True)
    order = read_arguments(["a", "--controller-ros-args", "-r a:=b", "--activate-as-group"])
    assert order.controllers[0].ros_arguments == ("-r", "a:=b")
    assert order.activate_as_group


def test_checks_know_all_options() -> None:
    words = ["a", "--no-switch-asap", "--switch-timeout", "3", "-u", "--controller-ros-args", "x"]
    assert [one.name for one in read_arguments(words).controllers] == _names(words) == ["a"]


def test_each_controller_may_have_options_of_its_own() -> None:
    order = read_arguments(
        ["-c", "/cm", "--controller", "a", "--inactive", "--controller", "b", "-p", "x.yaml"]
    )
    assert order.controller_manager == "/cm"
    assert order.controllers == (Wanted("a", stays_inactive=True), Wanted("b", ("x.yaml",)))


def test_names_and_files_are_looked_at_before_there_is_a_node(tmp_path: Path) -> None:
    """rclpy raises an exception on the name of a spawner's node, which has that of a controller."""
    file = tmp_path / "controllers.yaml"
    file.touch()
    assert refused_in(read_arguments(["arm_1", "2nd", "-p", str(file)])) is None
    for name in ("my-controller", "/arm/wheels", "", "b\u00e4r", "a\n"):
        assert "no node can have" in (refused_in(read_arguments(["arm", name])) or "")
    missing = refused_in(read_arguments(["arm", "-p", str(file), "-p", "x.yaml"]))
    assert missing == "FileNotFoundError: No such file or directory: 'x.yaml'"


def test_wrong_arguments_end_as_with_argparse(capsys: pytest.CaptureFixture[str]) -> None:
    for arguments, code in (([], 2), (["a", "--nonsense"], 2), (["--controller"], 1)):
        with pytest.raises(SystemExit) as ended:
            read_arguments(arguments)
        assert ended.value.code == code
    assert "--nonsense" in capsys.readouterr().err


def test_names_of_managers() -> None:
    assert full_manager("controller_manager", "/") == "/controller_manager"
    assert full_manager("controller_manager", "/arm") == "/arm/controller_manager"
    assert full_manager("/controller_manager", "/arm") == "/controller_manager"


class Client:
    """A controller manager that does as it is told, but for one thing."""

    def __init__(self, refuses: str = "") -> None:
        self.asked: list[tuple[Any, ...]] = []
        self.refuses = refuses

    def controllers(self) -> list[Any]:
        return [SimpleNamespace(name="there")]

    def switch(self, activate: Any = (), deactivate: Any = (), **_: Any) -> Any:
        self.asked.append(("switch", list(activate), list(deactivate)))
        return SimpleNamespace(ok=self.refuses != "switch")

    def __getattr__(self, name: str) -> Any:
        def do(*arguments: Any) -> bool:
            if name not in {"info", "warn", "error", "fatal"}:
                self.asked.append((name, *arguments))
            return name != self.refuses

        return do


def asked_by(*arguments: str, refuses: str = "") -> tuple[int, list[tuple[Any, ...]]]:
    client = Client(refuses)
    code = spawn(read_arguments(arguments), client, "/")  # type: ignore[arg-type]
    return code, client.asked


def test_controllers_are_loaded_configured_and_activated_one_by_one() -> None:
    assert asked_by("a", "b") == (
        0,
        [
            *[("load", "a"), ("configure", "a"), ("switch", ["a"], [])],
            *[("load", "b"), ("configure", "b"), ("switch", ["b"], [])],
        ],
    )


def test_as_a_group_they_are_activated_together() -> None:
    assert asked_by("a", "b", "--activate-as-group")[1][-1] == ("switch", ["a", "b"], [])


def test_what_is_loaded_is_not_loaded_again() -> None:
    assert asked_by("there")[1][0] == ("configure", "there")


def test_less_may_be_wanted() -> None:
    assert asked_by("a", "--load-only")[1] == [("load", "a")]
    assert asked_by("a", "--inactive")[1] == [("load", "a"), ("configure", "a")]


def test_type_arguments_and_files_are_set_before() -> None:
    _, asked = asked_by("a", "-t", "x/Y", "-p", "f.yaml", "--controller-ros-args", "-r c:=d")
    assert asked[:3] == [
        ("set_parameter", "a", "type", "x/Y"),
        ("set_parameter", "a", "node_options_args", ["-r", "c:=d"]),
        ("set_from_files", "a", ("f.yaml",), "/"),
    ]


@pytest.mark.parametrize("refuses", ["load", "configure", "switch"])
def test_a_refusal_ends_with_1(refuses: str) -> None:
    code, asked = asked_by("a", "b", refuses=refuses)
    assert code == 1
    assert asked[-1][0] == refuses
    assert ("load", "b") not in asked


def test_unspawning_deactivates_and_unloads() -> None:
    client = Client()
    assert unspawn(["a"], client, 5.0) == 0  # type: ignore[arg-type]
    assert client.asked == [("switch", [], ["a"]), ("unload", "a")]
    assert unspawn(["a"], Client("unload"), 5.0) == 1  # type: ignore[arg-type]


def test_a_signal_while_it_begins_ends_it_without_a_word(monkeypatch: pytest.MonkeyPatch) -> None:
    ended: list[str] = []

    def interrupt(_name: str) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1.0)

    modules = {
        "rclpy": {"init": lambda **_: None, "try_shutdown": lambda: ended.append("ROS")},
        "rclpy.node": {"Node": interrupt},
        "rclpy.signals": {"SignalHandlerOptions": SimpleNamespace(NO=0)},
        "rclpy.utilities": {"remove_ros_args": lambda args: args},
        "controller_manager_msgs": {},
        "wsgen.live.nodes.controller_services": {
            "ManagerClient": None,
            "ServiceMissingError": ValueError,
        },
    }
    for name, content in modules.items():
        module: Any = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    monkeypatch.setattr(sys, "argv", ["spawner", "a"])
    try:
        assert main() == 0
    except KeyboardInterrupt:
        pytest.fail("it is not caught")
    else:
        assert signal.getitimer(signal.ITIMER_REAL)[0] == 0.0  # it is not raised again
    finally:
        ignore_ends()
    assert ended == ["ROS"]
