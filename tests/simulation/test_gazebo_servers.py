"""What the tools of Gazebo print of a model is read, whatever else they print."""

from __future__ import annotations

import pytest

from wsgen.simulation.real_gazebo import read_model

# As tutorials/model_command.md of gz-sim shows it, with a line in brackets that no pose is.
PRINTED = """Requesting state for world [diff_drive]...

Model: [8]
  - Name: vehicle_blue
  - Pose [ XYZ (m) ] [ RPY (rad) ]:
      [0.000000 2.000000 0.325000]
      [0.000000 -0.000000 0.000000]
  - Link [9]
    - Name: chassis
    - Parent: vehicle_blue [8]
    - Mass (kg): 1.143950
    - Shapes:
      [a box here]
    - Pose [ XYZ (m) ] [ RPY (rad) ]:
      [-0.151427 0.000000 0.175000]
      [0.000000 0.000000 0.000000]
  - Joint [20]
    - Name: left_wheel_joint
    - Parent: vehicle_blue [8]
    - Type: revolute
"""


def test_what_gazebo_sim_prints_of_a_model() -> None:
    state = read_model(PRINTED)
    assert state is not None
    assert state.pose.xyz == (0.0, 2.0, 0.325)
    assert state.links["chassis"].xyz == pytest.approx((-0.151427, 2.0, 0.5))
    assert (state.mass, state.movable_joints) == (1.14395, 1)


def test_a_model_that_is_not_there() -> None:
    assert read_model("No model named <crate> was found.\n") is None
