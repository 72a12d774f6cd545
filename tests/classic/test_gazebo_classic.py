"""The real Gazebo Classic answers, and says what it refuses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from classic.gazebo_classic import NEEDS_CLASSIC, GazeboClassic
from urdf_texts import link, robot

if TYPE_CHECKING:
    from pathlib import Path

pytestmark = [
    pytest.mark.oracle,
    pytest.mark.slow,
    NEEDS_CLASSIC,
]
WORLD = (
    "<sdf version='1.6'><world name='default'><include><uri>model://ground_plane</uri></include>"
    "</world></sdf>"
)
BOX = (
    "<link name='box'><inertial><mass value='2'/>"
    "<inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/></inertial>"
    "<collision><geometry><box size='1 1 0.5'/></geometry></collision></link>"
)


@pytest.fixture
def world(tmp_path: Path) -> Path:
    file = tmp_path / "flat.world"
    file.write_text(WORLD)
    return file


def test_a_box_falls_and_rests(world: Path, tmp_path: Path) -> None:
    (tmp_path / "box.urdf").write_text(robot(BOX))
    with GazeboClassic(world) as gazebo:
        gazebo.spawn(tmp_path / "box.urdf", "box", z=0.5)
        gazebo.run(0.1)
        falling = gazebo.state()["box"]["links"]["box::box"]
        assert falling["linear"][2] == pytest.approx(-0.98, abs=0.02)
        gazebo.run(3)
        resting = gazebo.state()["box"]["links"]["box::box"]
    assert resting["pose"][2] == pytest.approx(0.25, abs=2e-5)
    assert resting["mass"] == [2]


def test_what_it_refuses_is_a_refusal(world: Path, tmp_path: Path) -> None:
    (tmp_path / "two_roots.urdf").write_text(robot(link("a") + link("b")))
    with GazeboClassic(world) as gazebo, pytest.raises(ValueError, match="refused by sdformat"):
        gazebo.spawn(tmp_path / "two_roots.urdf", "none")


def test_a_link_without_mass_is_nothing_there(world: Path, tmp_path: Path) -> None:
    (tmp_path / "light.urdf").write_text(robot("<link name='light'/>"))
    with GazeboClassic(world) as gazebo:
        gazebo.spawn(tmp_path / "light.urdf", "none")
        assert gazebo.state()["none"]["links"] == {}


def test_an_altimeter_publishes_nothing(tmp_path: Path) -> None:
    """A sonar beside it does: the topics are those of other sensors."""
    world, models = tmp_path / "w.world", ""
    for kind in ("altimeter", "sonar"):
        inside = "<sonar><min>0</min><max>9</max></sonar>" if kind == "sonar" else "<altimeter/>"
        rate = "<update_rate>100</update_rate>"
        models += f"<sensor name='{kind[0]}' type='{kind}'>{rate}{inside}</sensor>"
    world.write_text(
        "<sdf version='1.6'><world name='w'><model name='m'><pose>0 0 5 0 0 0</pose><link name='l'>"
        f"<inertial><mass>1</mass></inertial>{models}</link></model></world></sdf>"
    )
    topics = {
        "~/m/l/a/altimeter": "Altimeter",
        "~/m/l/a": "Altimeter",
        "~/m/l/s/sonar": "SonarStamped",
    }
    with GazeboClassic(world) as gazebo:
        for topic, kind in topics.items():
            gazebo.ask("listen", topic, f"gazebo.msgs.{kind}")
        for _ in range(2):
            gazebo.run(0.1)
            gazebo.ask("sensors")
        counts = [gazebo.ask("heard", topic)["count"] for topic in topics]
    assert counts[:2] == [0, 0]
    assert counts[2] > 0
