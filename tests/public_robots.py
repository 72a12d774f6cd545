"""Robots that other people have published on PyPI, and what Gazebo's parser refuses of them."""

from __future__ import annotations

import functools
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

PREFIXES = {
    "pybullet": "pybullet_data/",
    "example-robot-data": "cmeel.prefix/share/example-robot-data/robots/",
    "gym-ignition-models": "gym_ignition_models/",
    "icub_models": "../../../share/iCub/robots/",
    "jvrc_description": "jvrc_description/",
    "rtb-data": "rtbdata/",
    "upkie_description": "upkie_description/",
}

# Half of the time is for these; others of the same makers and kinds are compared in any case.
MANY_PARTS = {
    "alex_psyonic_hands",
    "alex_sake_hands",
    "anymal_b_kinova",  # anymal_b and kinova
    "b1_z1",
    "character",
    "g1_29dof_with_hand_rev_1_0",
    "icub_simple_collisions",
    "icubdarmstadt01",
    "icubgazebov2_7",
    "tiago",
}

ROBOTS = (
    ("pybullet", "TwoJointRobot_w_fixedJoints.urdf", "twojointrobot_w_fixedjoints"),
    ("pybullet", "a1/a1.urdf", "a1"),
    ("pybullet", "aliengo/aliengo.urdf", "aliengo"),
    ("pybullet", "bicycle/bike.urdf", "bicycle"),
    ("pybullet", "biped/biped2d_pybullet.urdf", "biped2d_pybullet"),
    ("pybullet", "cartpole.urdf", "cartpole"),
    ("pybullet", "differential/diff_ring.urdf", "diff_ring"),
    ("pybullet", "franka_panda/panda.urdf", "panda"),
    (
        "pybullet",
        "gripper/wsg50_one_motor_gripper_left_finger.urdf",
        "wsg50_one_motor_gripper_left_finger",
    ),
    ("pybullet", "humanoid/humanoid.urdf", "humanoid"),
    ("pybullet", "husky/husky.urdf", "husky"),
    ("pybullet", "kuka_iiwa/model.urdf", "kuka_iiwa"),
    ("pybullet", "laikago/laikago.urdf", "laikago"),
    ("pybullet", "mini_cheetah/mini_cheetah.urdf", "mini_cheetah"),
    ("pybullet", "pendulum5.urdf", "pendulum5"),
    ("pybullet", "plane.urdf", "plane"),
    ("pybullet", "pr2_gripper.urdf", "pr2_gripper"),
    ("pybullet", "quadruped/microtaur/microtaur.urdf", "microtaur"),
    ("pybullet", "quadruped/minitaur.urdf", "minitaur"),
    ("pybullet", "quadruped/quadruped.urdf", "quadruped"),
    ("pybullet", "quadruped/spirit40newer.urdf", "spirit40newer"),
    ("pybullet", "quadruped/vision60.urdf", "vision60"),
    ("pybullet", "r2d2.urdf", "r2d2"),
    ("pybullet", "racecar/racecar.urdf", "racecar"),
    ("pybullet", "racecar/racecar_differential.urdf", "racecar_differential"),
    ("pybullet", "samurai.urdf", "samurai"),
    ("pybullet", "spherical_joint_limit.urdf", "spherical_joint_limit"),
    ("pybullet", "table/table.urdf", "table"),
    ("pybullet", "xarm/xarm6_robot.urdf", "xarm6_robot"),
    ("pybullet", "xarm/xarm6_with_gripper.urdf", "xarm6_with_gripper"),
    ("example-robot-data", "a1_description/urdf/a1.urdf", "erd_a1"),
    ("example-robot-data", "alex_description/urdf/alex_psyonic_hands.urdf", "alex_psyonic_hands"),
    ("example-robot-data", "alex_description/urdf/alex_sake_hands.urdf", "alex_sake_hands"),
    (
        "example-robot-data",
        "alexander_description/urdf/alexander_v1.lowerBodyOnly.urdf",
        "alexander_v1_lowerbodyonly",
    ),
    (
        "example-robot-data",
        "allegro_hand_description/urdf/allegro_left_hand.urdf",
        "allegro_left_hand",
    ),
    (
        "example-robot-data",
        "anymal_b_simple_description/robots/anymal-kinova.urdf",
        "anymal_b_kinova",
    ),
    ("example-robot-data", "anymal_b_simple_description/robots/anymal.urdf", "anymal_b"),
    ("example-robot-data", "anymal_c_simple_description/urdf/anymal.urdf", "anymal_c"),
    ("example-robot-data", "asr_twodof_description/urdf/TwoDofs.urdf", "twodofs"),
    ("example-robot-data", "b1_description/urdf/b1-z1.urdf", "b1_z1"),
    ("example-robot-data", "b1_description/urdf/b1.urdf", "b1"),
    ("example-robot-data", "baxter_description/urdf/baxter.urdf", "baxter"),
    ("example-robot-data", "bolt_description/robots/bolt.urdf", "bolt"),
    (
        "example-robot-data",
        "borinot_description/urdf/borinot_flying_arm_2.urdf",
        "borinot_flying_arm_2",
    ),
    ("example-robot-data", "centauro_description/urdf/centauro.urdf", "centauro"),
    (
        "example-robot-data",
        "double_pendulum_description/urdf/double_pendulum.urdf",
        "double_pendulum",
    ),
    (
        "example-robot-data",
        "double_pendulum_description/urdf/double_pendulum_continuous.urdf",
        "double_pendulum_continuous",
    ),
    ("example-robot-data", "finger_edu_description/robots/finger_edu.urdf", "finger_edu"),
    (
        "example-robot-data",
        "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf",
        "g1_29dof_with_hand_rev_1_0",
    ),
    ("example-robot-data", "go1_description/urdf/go1.urdf", "go1"),
    ("example-robot-data", "go2_description/urdf/go2.urdf", "go2"),
    ("example-robot-data", "hector_description/robots/quadrotor_base.urdf", "quadrotor_base"),
    (
        "example-robot-data",
        "hextilt_description/urdf/hextilt_flying_arm_5.urdf",
        "hextilt_flying_arm_5",
    ),
    ("example-robot-data", "human_description/robots/human.urdf", "human"),
    ("example-robot-data", "hyq_description/robots/hyq_no_sensors.urdf", "hyq_no_sensors"),
    ("example-robot-data", "icub_description/robots/icub.urdf", "icub"),
    ("example-robot-data", "iris_description/robots/iris.urdf", "iris"),
    ("example-robot-data", "kinova_description/robots/kinova.urdf", "kinova"),
    ("example-robot-data", "laikago_description/urdf/laikago.urdf", "erd_laikago"),
    ("example-robot-data", "panda_description/urdf/panda.urdf", "erd_panda"),
    ("example-robot-data", "pr2_description/urdf/pr2.urdf", "pr2"),
    ("example-robot-data", "quadruped_description/urdf/quadruped.urdf", "erd_quadruped"),
    ("example-robot-data", "romeo_description/urdf/romeo.urdf", "romeo"),
    ("example-robot-data", "romeo_description/urdf/romeo_small.urdf", "romeo_small"),
    (
        "example-robot-data",
        "simple_humanoid_description/urdf/simple_humanoid.urdf",
        "simple_humanoid",
    ),
    ("example-robot-data", "so_arm_description/urdf/so100.urdf", "so100"),
    ("example-robot-data", "solo_description/robots/solo12.urdf", "solo12"),
    ("example-robot-data", "talos_data/robots/talos_full_v2.urdf", "talos_full_v2"),
    ("example-robot-data", "talos_data/robots/talos_left_arm.urdf", "talos_left_arm"),
    ("example-robot-data", "tiago_description/robots/tiago.urdf", "tiago"),
    ("example-robot-data", "tiago_description/robots/tiago_dual.urdf", "tiago_dual"),
    ("example-robot-data", "tiago_pro_description/robots/tiago_pro.urdf", "tiago_pro"),
    ("example-robot-data", "ur_description/urdf/ur10_robot.urdf", "ur10_robot"),
    ("example-robot-data", "ur_description/urdf/ur3.urdf", "ur3"),
    ("example-robot-data", "ur_description/urdf/ur5_gripper.urdf", "ur5_gripper"),
    ("example-robot-data", "ur_description/urdf/ur5_robot.urdf", "ur5_robot"),
    ("example-robot-data", "xarm_description/urdf/xarm7.urdf", "xarm7"),
    ("example-robot-data", "z1_description/urdf/z1.urdf", "z1"),
    ("gym-ignition-models", "cartpole/cartpole.urdf", "gym_cartpole"),
    ("gym-ignition-models", "character/character.urdf", "character"),
    (
        "gym-ignition-models",
        "iCubGazeboSimpleCollisionsV2_5/icub_simple_collisions.urdf",
        "icub_simple_collisions",
    ),
    ("gym-ignition-models", "panda/panda.urdf", "gym_panda"),
    ("gym-ignition-models", "pendulum/pendulum.urdf", "pendulum"),
    ("icub_models", "iCubDarmstadt01/model.urdf", "icubdarmstadt01"),
    ("icub_models", "iCubGazeboV2_7/model.urdf", "icubgazebov2_7"),
    ("icub_models", "iCubGenova03/model.urdf", "icubgenova03"),
    ("icub_models", "iCubNancy01/model.urdf", "icubnancy01"),
    ("icub_models", "left_hand_mk3/model.urdf", "left_hand_mk3"),
    ("icub_models", "left_wrist_mk2/model.urdf", "left_wrist_mk2"),
    ("jvrc_description", "urdf/jvrc1.urdf", "jvrc1"),
    ("rtb-data", "data/test.urdf", "rtb_test"),
    ("rtb-data", "xacro/abb_irb140_description/urdf/irb140.urdf", "irb140"),
    ("rtb-data", "xacro/kuka_description/kuka_kr120/urdf/kr120r2500pro.urdf", "kr120r2500pro"),
    ("rtb-data", "xacro/kuka_description/kuka_kr210/urdf/kr210l150.urdf", "kr210l150"),
    (
        "rtb-data",
        "xacro/kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.urdf",
        "lbr_iiwa_14_r820",
    ),
    ("rtb-data", "xacro/lynxmotion_al5d_description/urdf/al5d_robot.urdf", "al5d_robot"),
    ("rtb-data", "xacro/unimation_puma560_description/urdf/puma560_robot.urdf", "puma560_robot"),
    ("upkie_description", "urdf/upkie.urdf", "upkie"),
)

# What Gazebo refuses, and the errors that say why.
REFUSED = {
    "twojointrobot_w_fixedjoints": {"ROB037"},
    "bicycle": {"ROB016"},
    "biped2d_pybullet": {"ROB016"},
    "cartpole": {"ROB040"},
    "humanoid": {"ROB015", "ROB024"},
    "kuka_iiwa": {"ROB040"},
    "mini_cheetah": {"ROB037"},
    "plane": {"ROB040"},
    "microtaur": {"ROB016"},
    "samurai": {"ROB040"},
    "spherical_joint_limit": {"ROB015", "ROB037"},
    "table": {"ROB040"},
    "xarm6_robot": {"ROB037"},
    "xarm6_with_gripper": {"ROB037"},
    "anymal_c": {"ROB041"},
    "icub": {"ROB037"},
    "romeo_small": {"ROB037"},
    "talos_full_v2": {"ROB151", "ROB041"},
    "ur3": {"ROB004", "ROB005"},
    "icubgenova03": {"ROB037", "ROB040"},
    "rtb_test": {"ROB001"},
    "irb140": {"ROB040"},
    "lbr_iiwa_14_r820": {"ROB040"},
    "puma560_robot": {"ROB040"},
}

# What Gazebo takes, and the errors that say what it silently makes of it.
CUT = {
    "racecar_differential": {"ROB016"},
    "centauro": {"ROB151"},
    "human": {"ROB040"},
    "romeo": {"ROB040"},
    "tiago_dual": {"ROB151"},
    "tiago_pro": {"ROB151"},
    "icubnancy01": {"ROB037", "ROB040"},
}


@functools.cache
def _files_of(distribution: str) -> dict[str, Path]:
    try:
        found = files(distribution) or []
    except PackageNotFoundError:
        return {}
    return {str(file): Path(str(file.locate())) for file in found if file.name.endswith(".urdf")}


def find_robot(distribution: str, path: str) -> Path | None:
    """The file of a robot; None where its package is not installed."""
    there = _files_of(distribution)
    return there[PREFIXES[distribution] + path].resolve() if there else None
