"""What people write to vary a robot in PyBullet: load it again and again, step for three seconds.

    python sweep_by_hand.py FILE.urdf RUNS [SETTINGS.json]

The friction of all links is what varies. SETTINGS has what wsgen tells PyBullet about the links and
joints of the robot, by index, so that it moves as in Gazebo; without it, all is as PyBullet has it.
"""

import json
import sys
from pathlib import Path

import pybullet

file, runs, *files = sys.argv[1:]
settings = json.loads(Path(files[0]).read_text()) if files else {}
pybullet.connect(pybullet.DIRECT)
for number in range(int(runs)):
    pybullet.resetSimulation()
    pybullet.setGravity(0, 0, -9.8)
    pybullet.setTimeStep(0.001)
    pybullet.setPhysicsEngineParameter(**settings.get("engine", {}))
    box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=(500, 500, 5))
    pybullet.createMultiBody(0, box, -1, (0, 0, -5))
    robot = pybullet.loadURDF(
        file,
        basePosition=settings.get("position", (0, 0, 0.1)),
        flags=settings.get("flags", 0),
    )
    links = {int(link): given for link, given in settings.get("links", {}).items()}
    for link in range(-1, pybullet.getNumJoints(robot)):
        given = dict(links.get(link, {}))
        own = given.pop("lateralFriction", 1.0)
        ground = 0.5 + 0.4 * number / int(runs)
        pybullet.changeDynamics(robot, link, lateralFriction=min(own, ground), **given)
    for joint in range(pybullet.getNumJoints(robot)):
        force = settings.get("forces", {}).get(str(joint), 0)
        pybullet.setJointMotorControl2(robot, joint, pybullet.VELOCITY_CONTROL, force=force)
    for _ in range(3000):
        pybullet.stepSimulation()
    print(*pybullet.getBasePositionAndOrientation(robot)[0])
