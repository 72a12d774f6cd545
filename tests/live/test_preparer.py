"""Entities that a live run spawns and the launch file does not name."""

from __future__ import annotations

import json
import socket
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from wsgen.errors import RequestError
from wsgen.isolation.codec import decode, encode
from wsgen.live.prepare import Preparer, serve
from wsgen.model.plan import LaunchPlan
from wsgen.model.transform import Pose
from wsgen.packages.workspace.overlay import Overlay
from wsgen.pipeline.package_validation import Validation
from wsgen.pipeline.requests import SelectedPackage, ValidateRequest
from wsgen.pipeline.started import Started
from wsgen.simulation.live_runs import NewEntity, PreparedEntity, preparer_path, short_name

if TYPE_CHECKING:
    from pathlib import Path

    from wsgen.diagnostics import Diagnostic


def _ask(folder: Path, text: str) -> PreparedEntity:
    with socket.socket(socket.AF_UNIX) as client:
        with short_name(preparer_path(folder)) as name:
            client.connect(name)
        with client.makefile("rwb") as stream:
            stream.write(text.encode() + b"\n")
            stream.flush()
            return decode(json.loads(stream.readline()), PreparedEntity)


def test_requests_are_answered_one_after_the_other(tmp_path: Path) -> None:
    def prepare(new: NewEntity) -> PreparedEntity:
        if new.entity == "wrong":
            raise RequestError("It is wrong.", hint="Put it right.")
        if new.entity == "bug":
            raise ZeroDivisionError("no robot")
        return PreparedEntity(problem=new.entity)

    with serve(tmp_path, prepare):
        for _ in range(2):
            assert _ask(tmp_path, encode(NewEntity(entity="box"))).problem == "box"
        wrong = _ask(tmp_path, encode(NewEntity(entity="wrong")))
        assert (wrong.problem, wrong.hint) == ("It is wrong.", "Put it right.")
        assert (
            "ZeroDivisionError: no robot" in _ask(tmp_path, encode(NewEntity(entity="bug"))).problem
        )
        assert "cannot be read" in _ask(tmp_path, "[]").problem
    with pytest.raises(OSError):  # noqa: PT011  refused or not there
        _ask(tmp_path, "{}")


BOX = """<sdf version="1.7"><model name="crate"><link name="body">
<inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.4 0.4 0.4</size></box></geometry></collision>
</link></model></sdf>"""
ROBOT = """<robot name="cart"><link name="base"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>
<gazebo><plugin name="p" filename="libgazebo_ros_planar_move.so"/></gazebo></robot>"""


@pytest.fixture
def preparer(tmp_path: Path) -> Preparer:
    """One of a run that has been prepared."""
    selected = SelectedPackage(name="p", source=None, share=None)
    subject = Validation(
        selected,
        Overlay(install=tmp_path, environment={}, prefixes=()),
        ValidateRequest(is_live=True),
        None,
    )
    plan = LaunchPlan(package="p", launch_file=tmp_path / "a.launch.py")
    subject.started = Started(plan, None, (), (), False, 0.0, True)
    shown: list[tuple[Diagnostic, ...]] = []
    made = Preparer(subject, tmp_path, lambda found: shown.append(tuple(found)))
    made.shown = shown  # type: ignore[attr-defined]
    return made


def test_a_description_becomes_what_an_engine_takes(preparer: Preparer) -> None:
    there = Pose(xyz=(1.0, 2.0, 3.0))
    box = preparer.prepare(NewEntity(entity="one", text=BOX, pose_in_world=there))
    assert box.robot is not None
    assert (box.robot.entity, box.robot.pose_in_world) == ("one", there)
    unnamed = preparer.prepare(NewEntity(text=BOX)).robot
    assert unnamed is not None
    assert unnamed.entity == "crate"
    cart = preparer.prepare(NewEntity(text=ROBOT))
    assert cart.robot is not None
    assert cart.devices is not None
    assert cart.description == ROBOT
    assert [one.attributes["name"] for one in cart.devices.plugins] == ["p"]
    assert preparer.shown == []  # type: ignore[attr-defined]


@pytest.mark.slow
def test_what_is_wrong_with_a_description_is_answered_and_shown_once(preparer: Preparer) -> None:
    text = ROBOT.replace(
        "</robot>",
        '<joint name="j" type="fixed"><parent link="base"/><child link="lid"/></joint></robot>',
    )
    for _ in range(2):
        answer = preparer.prepare(NewEntity(text=text))
        assert answer.robot is None
        assert "`lid`" in answer.problem
        assert answer.hint
    assert len(preparer.shown) == 1  # type: ignore[attr-defined]
    assert preparer.prepare(NewEntity(text="hello")).problem
    assert preparer.prepare(NewEntity(text="")).problem
    assert (
        "not in the workspace" in preparer.prepare(NewEntity(model_uri="model://nothing")).problem
    )


@pytest.mark.parametrize("uri", ["crate", "model://crate"])
def test_a_model_is_found_by_its_name_among_those_of_packages(
    preparer: Preparer, tmp_path: Path, uri: str
) -> None:
    model = tmp_path / "share" / "my_models" / "crate" / "model.sdf"
    model.parent.mkdir(parents=True)
    model.write_text(BOX)
    overlay = preparer._subject.overlay
    environment = {**overlay.environment, "AMENT_PREFIX_PATH": str(tmp_path)}
    preparer._subject.overlay = replace(overlay, environment=environment)
    found = preparer.prepare(NewEntity(model_uri=uri)).robot
    assert found is not None
    assert found.entity == "crate"
