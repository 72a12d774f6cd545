"""What people write to try robots in PyBullet: load each over a plane, step for three seconds.

python robots_by_hand.py FILE.urdf ...
"""

import sys

import pybullet
import pybullet_data

pybullet.connect(pybullet.DIRECT)
for file in sys.argv[1:]:
    pybullet.resetSimulation()
    pybullet.setAdditionalSearchPath(pybullet_data.getDataPath())
    pybullet.setGravity(0, 0, -9.8)
    pybullet.setTimeStep(0.001)
    pybullet.loadURDF("plane.urdf")
    robot = pybullet.loadURDF(file, basePosition=(0, 0, 1))
    for joint in range(pybullet.getNumJoints(robot)):
        pybullet.setJointMotorControl2(robot, joint, pybullet.VELOCITY_CONTROL, force=0)
    for _ in range(3000):
        pybullet.stepSimulation()
