"""The shortest script that does what `wsgen validate` is measured against.

    python by_hand.py ROBOT.xacro

Expands the xacro in this process and steps PyBullet 3 s at 1 ms with the robot its loader makes.
"""

import sys
import tempfile

import pybullet
import xacro

urdf = xacro.process_file(sys.argv[1]).toxml()
pybullet.connect(pybullet.DIRECT)
pybullet.setGravity(0, 0, -9.8)
pybullet.setTimeStep(0.001)
pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE))
with tempfile.NamedTemporaryFile("w", suffix=".urdf") as file:
    file.write(urdf)
    file.flush()
    robot = pybullet.loadURDF(file.name, [0, 0, 0.26])
for _ in range(3000):
    pybullet.stepSimulation()
print(pybullet.getBasePositionAndOrientation(robot))
