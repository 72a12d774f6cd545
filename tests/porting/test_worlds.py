"""What becomes of worlds, to the letter."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from wsgen.checks.fixes.source import SourceText, apply
from wsgen.model.target import Target
from wsgen.porting.worlds import model_names, new_world, port_world

JAZZY = Target(distro="jazzy", simulator="gz")
LOADED = """    <plugin filename="gz-sim-physics-system" name="gz::sim::systems::Physics"/>
    <plugin filename="gz-sim-user-commands-system" name="gz::sim::systems::UserCommands"/>
    <plugin filename="gz-sim-scene-broadcaster-system" name="gz::sim::systems::SceneBroadcaster"/>
"""
SENSORS = """    <plugin filename="gz-sim-sensors-system" name="gz::sim::systems::Sensors">
      <render_engine>ogre2</render_engine>
    </plugin>
"""
GROUND = """    <model name="{name}">
      <static>true</static>{pose}
      <link name="link">
        <collision name="collision">
          <geometry>
            <plane>
              <normal>0 0 1</normal>
              <size>100 100</size>
            </plane>
          </geometry>
          <surface>
            <friction>
              <ode>
                <mu>100</mu>
                <mu2>50</mu2>
              </ode>
            </friction>
          </surface>
        </collision>
        <visual name="visual">
          <cast_shadows>false</cast_shadows>
          <geometry>
            <plane>
              <normal>0 0 1</normal>
              <size>100 100</size>
            </plane>
          </geometry>
          <material>
            <ambient>0.3 0.3 0.3 1</ambient>
            <diffuse>0.7 0.7 0.7 1</diffuse>
            <specular>0.01 0.01 0.01 1</specular>
          </material>
        </visual>
      </link>
    </model>
"""
SUN = """    <light name="{name}" type="directional">
      <cast_shadows>true</cast_shadows>
      <pose>{pose}</pose>
      <diffuse>0.8 0.8 0.8 1</diffuse>
      <specular>0.2 0.2 0.2 1</specular>
      <attenuation>
        <range>1000</range>
        <constant>0.9</constant>
        <linear>0.01</linear>
        <quadratic>0.001</quadratic>
      </attenuation>
      <direction>-0.5 0.1 -0.9</direction>
    </light>
"""


def world(*parts: str) -> str:
    return f'<sdf version="1.6">\n  <world name="w">\n{"".join(parts)}  </world>\n</sdf>\n'


def ported(
    text: str, *, systems: tuple[str, ...] = (), models: tuple[str, ...] = ()
) -> tuple[str, list[str]]:
    """The text afterwards, which a second port leaves as it is, and what is listed."""

    def port(before: str) -> tuple[str, list[str]]:
        source = SourceText(Path("/nowhere/w.world"), before)
        found = port_world(source, JAZZY, frozenset(systems), models=models)
        return apply(before, found.edits), [f"{one.line}: {one.what}" for one in found.unported]

    after, listed = port(text)
    assert port(after)[0] == after
    return after, listed


@pytest.mark.parametrize(
    ("before", "after"),
    [
        pytest.param("", "", id="nothing"),
        pytest.param(
            "    <!-- here -->\n    <include>\n      <uri>model://sun</uri>\n    </include>\n",
            f"    <!-- here -->\n{SUN.format(name='sun', pose='0 0 10 0 0 0')}",
            id="sun",
        ),
        pytest.param(
            "    <include>\n      <uri>model://sun</uri>\n      <name>day</name>\n"
            "      <pose>1 0 5 0 0 0</pose>\n    </include>\n",
            SUN.format(name="day", pose="1 0 5 0 0 0"),
            id="another sun",
        ),
        pytest.param(
            "    <include><uri>model://ground_plane</uri></include>\n",
            GROUND.format(name="ground_plane", pose=""),
            id="ground plane",
        ),
        pytest.param(
            "    <include>\n      <!-- below -->\n      <uri>model://ground_plane</uri>\n"
            "      <pose>0 0 -1 0 0 0</pose>\n      <name>floor</name>\n    </include>\n",
            "    <!-- below -->\n"
            + GROUND.format(name="floor", pose="\n      <pose>0 0 -1 0 0 0</pose>"),
            id="another ground plane",
        ),
        pytest.param(
            "    <include>\n      <uri>model://cafe_table</uri>\n    </include>\n"
            "    <include>\n      <uri>model://shelf</uri>\n    </include>\n",
            "    <include>\n      <uri>https://fuel.gazebosim.org/1.0/OpenRobotics/models/"
            "Cafe table</uri>\n    </include>\n"
            "    <include>\n      <uri>model://shelf</uri>\n    </include>\n",
            id="models of Fuel",
        ),
        pytest.param(
            '    <plugin name="i" filename="libgazebo_ros_init.so">\n'
            "      <ros/>\n    </plugin>\n"
            '    <plugin name="f" filename="libgazebo_ros_factory.so"/>\n',
            "",
            id="plugins without which nothing is lost",
        ),
        pytest.param(
            '    <physics type="ode">\n      <max_step_size>0.002</max_step_size>\n'
            "      <real_time_factor>1</real_time_factor>\n"
            "      <real_time_update_rate>250</real_time_update_rate>\n    </physics>\n",
            '    <physics type="ode">\n      <max_step_size>0.002</max_step_size>\n'
            "      <real_time_factor>0.5</real_time_factor>\n    </physics>\n",
            id="how fast time passes",
        ),
        pytest.param(
            "    <physics type='ode'>\n"
            "      <real_time_update_rate>1000.0</real_time_update_rate>\n    </physics>\n",
            "    <physics type='ode'>\n"
            "      <real_time_factor>1</real_time_factor>\n    </physics>\n",
            id="how fast time passes, by the rate alone",
        ),
    ],
)
def test_what_is_in_a_world(before: str, after: str) -> None:
    assert ported(world(before)) == (world(LOADED, after), [])
    dos = world(before).replace("\n", "\r\n")
    assert ported(dos)[0] == world(LOADED, after).replace("\n", "\r\n")


def test_a_mesh_of_the_database() -> None:
    """Worlds that are saved have the models of the database in them."""
    uri = "      <m><uri>model://{}/meshes/construction_cone.dae</uri></m>\n"
    address = "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Construction Cone/tip/files"
    text = f'    <model name="c">\n{uri.format("construction_cone")}    </model>\n'
    assert ported(world(text))[0] == world(
        LOADED, text.replace("model://construction_cone", address)
    )


def test_models_of_the_workspace_stay(tmp_path: Path) -> None:
    (tmp_path / "models" / "table").mkdir(parents=True)
    (tmp_path / "models" / "table" / "model.config").write_text("<model/>")
    text = world("    <include><uri>model://table</uri></include>\n")
    names = (*model_names(tmp_path),)
    assert ported(text, models=names)[0] == text.replace('"w">\n', f'"w">\n{LOADED}')


def test_models_that_fuel_may_lack_are_listed() -> None:
    text = world("    <include><uri>model://gas_station</uri></include>\n")
    what = "3: Gazebo Classic downloads the model `gas_station` from its database"
    assert ported(text)[1] == [f"{what}; Gazebo Sim does not."]


def test_plain_models_are_shapes_of_their_size() -> None:
    """Of a model that Fuel may lack, what it is run into by stays."""
    after, listed = ported(
        world(
            "    <include>\n"
            "      <uri>model://disk_part</uri>\n"
            "      <name>d</name>\n"
            "      <pose>1 2 0 0 0 0</pose>  <!-- there -->\n"
            "    </include>\n"
        )
    )
    assert "model://" not in after
    assert (
        '    <model name="d">\n'
        "      <pose>1 2 0 0 0 0</pose>\n"
        '      <link name="link">\n'
        "        <inertial>\n"
        "          <mass>0.5</mass>\n"
        "          <pose>0 0 0.02895 0 0 0</pose>\n"
        "          <inertia>\n"
        "            <ixx>0.00321218</ixx>\n"
        "            <iyy>0.00321218</iyy>\n"
        "            <izz>0.00614499</izz>\n"
    ) in after
    shape = "<radius>0.15678</radius>\n              <length>0.0579</length>"
    assert after.count(shape) == len(("collision", "visual"))
    assert "<!-- there -->" in after
    assert [one.partition("; ")[2] for one in listed] == [
        "a plain shape of its size is in its place."
    ]
    static, _ = ported(world("    <include><uri>model://grey_wall</uri></include>\n"))
    assert "<static>true</static>" in static
    assert "<pose>0 0 1.4 0 0 0</pose>" in static


@pytest.mark.parametrize(
    ("around", "becomes"),
    [
        (
            "<pose>1 0 0 0 0 1.5707963268</pose><geometry>{mesh}</geometry>",
            # The mesh begins at the bottom, and its center is beside its origin.
            "<pose>1.030541 0 0.525 0 0 1.570796</pose><geometry>{shape}</geometry>",
        ),
        (
            "<geometry>{mesh}</geometry>",
            "<pose>0 -0.0305 0.525 0 0 0</pose><geometry>{shape}</geometry>",
        ),
    ],
)
def test_meshes_of_plain_models(around: str, becomes: str) -> None:
    """A saved world names them; the shape is where the mesh was, as large."""
    mesh = "<mesh><uri>model://drc_practice_white_jersey_barrier/meshes/jersey_barrier.dae</uri>"
    text = f'<model name="m"><link name="l"><visual name="v">{around}</visual></link></model>'
    after, _ = ported(world(text.format(mesh=f"{mesh}</mesh>")))
    shape = "<box><size>0.6082 1.8014 1.05</size></box>"
    flat = re.sub(r">\s+<", "><", after)
    assert becomes.replace("1.030541", "1.0305").format(shape=shape) in flat


def test_meshes_of_plain_models_that_are_scaled() -> None:
    mesh = "<mesh><uri>model://cube_20k/meshes/cube_20k.stl</uri><scale>0.5 1 -2</scale></mesh>"
    text = f'<model name="m"><link name="l"><visual name="v"><geometry>{mesh}</geometry></visual>'
    after, _ = ported(world(f"{text}</link></model>"))
    assert "<size>1 2 4</size>" in after
    wrong = text.replace("0.5 1 -2", "1 1")
    after, listed = ported(world(f"{wrong}</link></model>"))
    assert wrong in after
    assert len(listed) == 1


def test_sounds_that_nobody_hears() -> None:
    """Each world that Gazebo Classic has saved has a device for them."""
    device = "    <audio>\n      <device>default</device>\n    </audio>\n"
    assert ported(world(device)) == (world(LOADED), [])
    source = '    <model name="m"><link name="l"><audio_source/></link></model>\n'
    assert len(ported(world(device, source))[1]) == 1


@pytest.mark.parametrize(
    ("there", "stop", "is_listed"),
    [
        ("1.0005 0 0.2 0 0 0", "<lower>-1</lower>", False),
        ("1 0 0.5 0 0 0", "<lower>-1</lower>", True),
        ("1 0 0.2 0 0 0.5", "<lower>-1</lower>", True),
        ("1 0 0.2 0 0 0.5", "<lower>-1e16</lower>", False),
        ("1 0 0.2 0 0 0.5", "", False),
    ],
)
def test_saved_positions_of_joints(there: str, stop: str, is_listed: bool) -> None:
    """They are lost where a joint is not where its model has it, but for wheels."""
    model = (
        '    <model name="m">\n      <pose>1 0 0 0 0 0</pose>\n      <link name="a"/>\n'
        '      <link name="b"><pose>0 0 0.2 0 0 0</pose></link>\n'
        '      <joint name="j" type="revolute"><child>b</child>'
        f"<axis><limit>{stop}</limit></axis></joint>\n    </model>\n"
    )
    state = (
        '    <state world_name="w">\n      <model name="m">\n        <pose>1 0 0 0 0 0</pose>\n'
        '        <link name="a"><pose>1 0 0 0 0 0</pose></link>\n'
        f'        <link name="b"><pose>{there}</pose></link>\n      </model>\n'
        "    </state>\n"
    )
    after, listed = ported(world(model, state))
    assert after == world(LOADED, model)
    assert bool(listed) == is_listed


def test_systems() -> None:
    """Those that a world has stay; what else is needed comes behind them."""
    assert ported(world(), systems=("Sensors", "Physics")) == (world(LOADED, SENSORS), [])
    own = '    <plugin filename="ignition-gazebo-physics-system" name="P"/>  <!-- own -->\n'
    assert ported(world(own)) == (world(own), [])
    after, _ = ported(world(own), systems=("Sensors",))
    spawning = next(line for line in LOADED.splitlines() if "user-commands" in line)
    added = f"{spawning}\n{SENSORS.rstrip()}"
    assert after == world(own.replace("  <!-- own -->\n", f"\n{added}  <!-- own -->\n"))


def test_plugins_of_classic() -> None:
    after, listed = ported(
        world(
            '    <plugin name="s" filename="libgazebo_ros_state.so">\n'
            "      <!-- often -->\n"
            "      <update_rate>1.0</update_rate>\n"
            "    </plugin>\n",
            '    <plugin name="f" filename="libgazebo_ros_force_system.so"/>\n',
            '    <plugin name="o" filename="libown.so">\n      <speed>1</speed>\n    </plugin>\n',
        )
    )
    wrench = "gz::sim::systems::ApplyLinkWrench"
    assert after == world(
        LOADED,
        f'    <plugin filename="gz-sim-apply-link-wrench-system" name="{wrench}"/>\n',
        "    <!-- often -->\n",
        '    <!-- <plugin name="o" filename="libown.so">\n      <speed>1</speed>\n'
        "    </plugin> -->\n",
    )
    assert [line.partition(":")[0] for line in listed] == ["3", "7", "8"]


def test_the_window() -> None:
    text = (
        "    <gui fullscreen='0'>\n      <camera name='user_camera'>\n"
        "        <pose>1 0 0 0 0 0</pose>\n      </camera>\n    </gui>\n"
    )
    after, listed = ported(world(text))
    assert after == world(LOADED)
    assert listed == ["4: Gazebo Sim does not read the view of the window from <camera>."]
    sim = '    <gui>\n      <plugin filename="MinimalScene" name="3D View"/>\n    </gui>\n'
    assert ported(world(sim)) == (world(LOADED, sim), [])


def test_a_saved_state_moves_its_models() -> None:
    """Gazebo Classic moves models and lights to where the state has them."""
    box = "    <model name='box'>\n      <pose frame=''>{}</pose>\n    </model>\n"
    rest = (
        "    <model name='still'>\n      <pose>0 0 1 0 0 0</pose>\n    </model>\n"
        "    <light name='lamp' type='point'>\n{}    </light>\n"
    )
    state = (
        "    <state world_name='w'>\n      <sim_time>10 0</sim_time>\n"
        "      <model name='box'>\n        <pose>5 6 2 0 -0 0</pose>\n      </model>\n"
        "      <model name='still'>\n        <pose>0 0 1.0 0 -0 0</pose>\n      </model>\n"
        "      <light name='lamp'>\n        <pose>1 2 3 0 0 0</pose>\n      </light>\n"
        "    </state>\n"
    )
    after, listed = ported(world(box.format("0 0 1 0 0 0"), rest.format(""), state))
    assert after == world(
        LOADED,
        box.format("5 6 2 0 -0 0"),
        rest.format("      <pose>1 2 3 0 0 0</pose>\n"),
    )
    assert listed == []


@pytest.mark.parametrize(
    ("name", "more", "is_left"),
    [("m", "", True), ("m", "<static>1</static>", False), ("spawned", "", False)],
)
def test_a_saved_state_of_what_moved_is_left_to_the_author(
    name: str, more: str, *, is_left: bool
) -> None:
    links = '<link name="a"/><link name="b"><pose>{} 0 0 0 0 0</pose></link>'
    pose = "<pose>1 0 0 0 0 0</pose>"
    joint = '<joint name="j" type="prismatic"><child>b</child></joint>'
    model = f'<model name="m">{links.format(1)}{joint}{more}</model>'
    saved = f'<model name="{name}">{pose}{links.format(5)}</model>'
    other = f'<light name="l"/><state world_name="w">{saved}<light name="l">{pose}</light></state>'
    source = SourceText(Path("/nowhere/w.world"), world(f"{model}{other}"))
    found = port_world(source, JAZZY, frozenset()).unported
    assert bool(found) == is_left


def test_a_saved_state_moves_links_that_no_joint_holds() -> None:
    """Walls of a building, which somebody has moved one by one."""
    wall = "      <link name='{}'>\n        <pose>{} 0 0 0</pose>\n      </link>\n"
    model = "    <model name='m'>\n      <pose>1 2 0 0 0 0</pose>\n{}{}    </model>\n"
    saved = model.format(wall.format("a", "1 2 0"), wall.format("b", "2 2.25 0"))
    before = model.format(wall.format("a", "0 0 0"), wall.format("b", "0.5 0 0"))
    after, listed = ported(world(before, f"    <state world_name='w'>\n{saved}    </state>\n"))
    assert listed == []
    assert after == world(LOADED, before.replace("0.5 0 0 0", "1 0.25 0 0"))


def test_actors() -> None:
    text = (
        "    <actor name='a'>\n      <skin>\n        <filename>walk.dae</filename>\n      </skin>\n"
        "      <animation name='run'>\n        <filename>run.dae</filename>\n      </animation>\n"
        "{}    </actor>\n"
    )
    plugin = '      <plugin name="p" filename="libActorPlugin.so"/>\n'
    address = "https://fuel.gazebosim.org/1.0/Mingfei/models/actor/tip/files/meshes/walk.dae"
    after, listed = ported(world(text.format(plugin)))
    assert after == world(LOADED, text.format("").replace("walk.dae", address))
    assert [line.partition(":")[0] for line in listed] == ["10", "8"]


def test_what_gazebo_sim_does_not_have_stays_as_a_comment() -> None:
    road = "<road name='r'>\n      <!-- wide -->\n      <width>3</width>\n    </road>"
    after, listed = ported(world(f"    {road}\n"))
    inner = road.replace("<!-- wide -->", "--><!-- wide --><!--")
    assert after == world(LOADED, f"    <!-- {inner} -->\n")
    assert listed == ["3: Gazebo Sim does not have <road>, which draws a road."]


def test_a_new_world_is_classics_empty_one() -> None:
    sun, ground = SUN.format(name="sun", pose="0 0 10 0 0 0"), GROUND
    assert new_world("empty", JAZZY, ("Sensors",)) == (
        '<?xml version="1.0"?>\n<sdf version="1.11">\n  <world name="empty">\n'
        f"{LOADED}{SENSORS}{sun}\n{ground.format(name='ground_plane', pose='')}  </world>\n</sdf>\n"
    )
