"""From the text of a URDF to the robot that Gazebo would simulate.

`expand` runs xacro, `reader` turns the text into a `Robot` and says what is wrong in it, `meshes`
finds the files, `lump` does what Gazebo's parser does before the physics engine sees the robot.
"""
