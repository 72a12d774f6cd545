"""A Gazebo is asked as wsgen does, but that its messages count as lost after two seconds."""

from wsgen.simulation import real_gazebo

real_gazebo.SECONDS_TO_SPAWN = real_gazebo.SECONDS_AFTER_ERROR = 2.0
simulate = real_gazebo.simulate
